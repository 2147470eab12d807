"""The script for a cluster with Slurm in docs/sweep.md: its steps are run with stand-ins for the cluster's commands."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "sweep.md"
STAND_INS = {
    # The scheduler needs a moment before it writes its file.
    "dask": """sleep 0.5; echo '{"address": "tcp://new:1"}' > scheduler.json""",
    "srun": "cat scheduler.json >> workers.txt",
    "crane": 'echo "$@" > asked.txt',
    "python": f'exec {sys.executable} "$@"',
}


@pytest.mark.skipif(shutil.which("bash") is None, reason="the script is for bash")
def test_a_script_that_is_queued_again_uses_the_new_scheduler_and_not_that_of_the_job_before(tmp_path):
    (script,) = re.findall(r"^```sh\n(#!/bin/bash\n#SBATCH.*?)^```$", PAGE.read_text("utf8"), re.MULTILINE | re.DOTALL)
    commands = tmp_path / "bin"
    commands.mkdir()
    for name, text in STAND_INS.items():
        (commands / name).write_text(f"#!/bin/bash\n{text}\n")
        (commands / name).chmod(0o755)
    (tmp_path / "scheduler.json").write_text('{"address": "tcp://old:1"}')
    path = os.pathsep.join([str(commands), os.environ["PATH"]])
    words = ["bash", "-c", f"{script}\nwait"]
    done = subprocess.run(words, cwd=tmp_path, env=os.environ | {"PATH": path}, timeout=60, capture_output=True)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "asked.txt").read_text().split()[-2:] == ["--dask", "tcp://new:1"]
    assert (tmp_path / "workers.txt").read_text().split() == ['{"address":', '"tcp://new:1"}']
