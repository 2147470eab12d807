"""How long a person waits: the first run ever, a warm run, the help."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

from benchmarks import jwell
from benchmarks.page import Section, number, show, table

SCRIPTS = Path(sys.executable).parent


def seconds(cache: Path, folder: Path, *arguments: str, command: str = "drillstring") -> tuple[float, float]:
    """Wall and CPU time of a command as a process of its own, s, which may keep Python's byte code as usual."""
    installed = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(
        [str(SCRIPTS / command), *arguments], cwd=folder, env=installed | {"TAUTLINE_CACHE": str(cache)}, check=True,
        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before[1].ru_utime - before[1].ru_stime
    return time.perf_counter() - before[0], cpu


def _row(times: list[tuple[float, float]]) -> tuple[str, str, str, int]:
    walls, cpus = zip(*times, strict=True)
    spread = f"{number(min(walls), 3)} to {number(max(walls), 3)}"
    return number(median(walls), 3), spread, number(median(cpus), 3), len(times)


def measure(quick: bool) -> Section:
    """Empty kernel cache, then the same cache again."""
    colds, warms = (1, 1) if quick else (3, 9)
    run = ("simulate", str(jwell.SCENE), "--end", "1")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        cold = [seconds(folder / str(i), folder, *run) for i in range(colds)]
        warm = [seconds(folder / "0", folder, *run) for _ in range(warms)]
        plain = [seconds(folder / "0", folder, "--help") for _ in range(warms)]
    rows = [
        (what, *_row(times))
        for what, times in (
            ("`drillstring simulate data/jwell.yaml --end 1`, empty kernel cache", cold),
            ("the same again", warm),
            ("`drillstring --help`", plain),
        )
    ]
    headline = [
        (what, f"{row[1]} s", beside)
        for row, what, beside in zip(
            rows,
            ("first run ever of 1 s simulated", "warm run of 1 s simulated", "`drillstring --help`"),
            ("compiles the solver, once", "as a process of its own", "as a process of its own"),
            strict=True,
        )
    ]
    text = (
        "Wall time of the whole process. The first run ever has an empty kernel cache (`TAUTLINE_CACHE` in a new "
        "folder); Python's own byte code is there, as `pip` leaves it.\n\n"
        + table(("what", "median, s", "smallest to largest, s", "CPU, median, s", "repetitions"), rows)
    )
    return Section("Waiting times", text, headline)


if __name__ == "__main__":
    show(measure, __doc__)
