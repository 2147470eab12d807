"""What matplotlib logs of a home that it cannot write to is one plain sentence."""

import os
import subprocess
import sys

import pytest

DRAWING = "import tautline.view.{} as drawing"
COMMAND = """
import sys
from tautline.cli.main import main
sys.argv = ["tautline", "--version"]
try:
    main()
except SystemExit:
    pass
"""


@pytest.mark.parametrize("module", ["space.stage", "figures.figure"])
def test_a_command_tells_that_matplotlib_has_no_folder_in_one_sentence_with_a_cure(tmp_path, module):
    (tmp_path / "file").touch()
    home = {"HOME": str(tmp_path / "file" / "none"), "USERPROFILE": str(tmp_path / "file" / "none")}
    left = {name: value for name, value in os.environ.items() if name not in ("MPLCONFIGDIR", "LOCALAPPDATA")}
    hidden = {name: value for name, value in left.items() if not name.startswith("XDG_")}
    code = [sys.executable, "-c", COMMAND + DRAWING.format(module)]
    said = subprocess.run(code, env=hidden | home, capture_output=True, text=True, check=True, timeout=60).stderr
    assert said.count("matplotlib has no folder to keep its list of fonts in") == 1 and "MPLCONFIGDIR" in said
    assert "mkdir -p failed" not in said and "temporary cache directory" not in said


def test_whoever_imports_the_pictures_keeps_the_log_of_matplotlib_as_it_is():
    code = f"import logging; {DRAWING.format('figures.figure')}; print(logging.getLogger('matplotlib').filters)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60)
    assert run.stdout.strip() == "[]"
