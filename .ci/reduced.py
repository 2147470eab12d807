"""Study and stability of every scene, benchmarks, and studies of the tests, reduced: each must end well.

Two processes take from a list that begins with the longest. A study is run by the function that the script `tautline`
calls, in the process that takes it: to start another, to import and to load the same kernels takes longer than most.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path

os.environ["OPENBLAS_NUM_THREADS"] = "1"  # Before NumPy is loaded: two that take all cores would wait for one another.

from tautline.cli.main import main as tautline

VERBS = ("study", "stability")
SCRIPTS = (
    "-m benchmarks.thesis.validation", "-m benchmarks.pages.gallery", "-m benchmarks.speed.report",
    "-m benchmarks.pages.mutation", ".ci/studies.py",
)  # fmt: skip
LONGEST = (
    "-m benchmarks.thesis.validation", "-m benchmarks.pages.gallery", "-m benchmarks.speed.report", ".ci/studies.py",
    "stability landing", "-m benchmarks.pages.mutation", "stability tripping", "stability whirl", "study tripping",
    "study hose", "stability sixteen_falls", "study hookblock", "stability drilling",
)  # fmt: skip
"""What begins first; all else takes 15 s or less, and its order is of no account."""


def jobs() -> list[tuple[str, ...]]:
    """Commands in the order in which they begin."""
    scenes = [str(path) for path in sorted(Path("data").glob("*.yaml"))]
    found = [(name,) for name in SCRIPTS] + [(verb, scene) for scene in scenes for verb in VERBS]
    return sorted(found, key=lambda job: LONGEST.index(named(job)) if named(job) in LONGEST else len(LONGEST))


def named(job: tuple[str, ...]) -> str:
    """A script, or a verb and a scene."""
    return " ".join([*job[:-1], Path(job[-1]).stem]) if len(job) > 1 else job[0]


def run(job: tuple[str, ...], folder: str) -> tuple[int, str, float]:
    """Exit code, what was said, and the time it took, s."""
    begun = time.monotonic()
    code, said = (_studied if len(job) > 1 else _measured)(job, Path(folder))
    return code, said, time.monotonic() - begun


def _measured(job: tuple[str, ...], folder: Path) -> tuple[int, str]:
    """A script has a process of its own: it measures what else is not done in it."""
    done = subprocess.run(
        [sys.executable, *job[0].split(), "--quick"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    )
    return done.returncode, done.stderr


def _studied(job: tuple[str, ...], folder: Path) -> tuple[int, str]:
    verb, scene = job
    sys.argv = ["tautline", verb, scene, "--quick", "--json", "-o", str(folder / f"{Path(scene).stem}_{verb}")]
    said = StringIO()
    try:
        with redirect_stdout(StringIO()), redirect_stderr(said):
            tautline()
    except SystemExit as ended:
        return int(ended.code or 0), said.getvalue()
    except BaseException:
        return 1, said.getvalue() + traceback.format_exc()
    return 1, "it did not leave by an exit code"


def faults(folder: str) -> Iterator[str]:
    """Run all and tell of each as it ends; what did not end well."""
    with ProcessPoolExecutor(2) as pool:
        waiting = {pool.submit(run, job, folder): job for job in jobs()}
        for done in as_completed(waiting):
            job = waiting[done]
            code, said, seconds = done.result()
            if code:
                print(said)
                yield named(job)
            print(f"{named(job)}: {code} ({seconds:.0f} s)", flush=True)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        if failed := list(faults(folder)):
            sys.exit(f"failed: {', '.join(failed)}")
