"""What a sweep costs beside its compiled loops, how much faster two workers are, and whether its memory grows.

    python -m benchmarks.speed.sweeps [CASES]

prints a table. Processor time is that of all that took part, in a process of its own for each row; loads of the machine
before and after stand beside it: on a busy machine believe the first column only.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from benchmarks import ROOT

SWEEP = """\
scene: {scene}
vary:
  vessel.motion.heave.harmonic.period: {{linspace: [6, 12, 10]}}
  bodies[0].mass: {{linspace: [2 t, 8 t, {masses}]}}
collect: [max_tension, dynamic_amplification, slack_events, safety_factor]
"""


def measured(folder: Path, cases: int, jobs: int) -> dict[str, float]:
    """One sweep of `hoist.yaml` in a process of its own: what it says, and its largest memory, MB."""
    (folder / "s.yaml").write_text(SWEEP.format(scene=ROOT / "data" / "hoist.yaml", masses=cases // 10))
    command = [
        sys.executable,
        "-m",
        "crane.main",
        "sweep",
        "s.yaml",
        "--json",
        "-q",
        "-j",
        str(jobs),
        "-o",
        f"{cases}_{jobs}",
    ]
    process = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    told = json.loads(process.stdout.read())
    _, _, used = os.wait4(process.pid, 0)
    return told | {"memory": used.ru_maxrss / 1024.0, "process": used.ru_utime + used.ru_stime}


def main() -> None:
    """Print the table."""
    most = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    print("cases workers  overhead   wall s  process s  memory MB  load")
    for cases, jobs in ((max(10, most // 5), 1), (most, 1), (most, 2)):
        with tempfile.TemporaryDirectory() as folder:
            before = os.getloadavg()[0]
            one = measured(Path(folder), cases, jobs)
            print(
                f"{cases:5d} {jobs:7d} {100.0 * one['overhead']:8.1f} % {one['wall_time']:8.2f} {one['process']:10.2f} "
                f"{one['memory']:10.0f}  {before:.2f} to {os.getloadavg()[0]:.2f}",
                flush=True,
            )  # fmt: skip


if __name__ == "__main__":
    main()
