"""Cases of a sweep of strings a core and second, and long strings beside real time: a checkout beside another.

    python -m benchmarks.speed.strings [BEFORE] [--quick]

prints a table. BEFORE is a checkout of the project with an environment of its own in ``.venv``, as
``git worktree add BEFORE COMMIT`` and ``pip install -e`` make it; both run in turn, so that a busy minute strikes both,
and the ratio is the median of the pairs. Without it only this checkout runs. All times are processor times.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path
from statistics import median
from typing import Any

from benchmarks import ROOT
from benchmarks.page import number, table

SWEEPS = (("sweep, 12 lumps", 12, 40.0, 6), ("sweep, 24 lumps", 24, 40.0, 4), ("sweep, 64 lumps", 64, 40.0, 2))
"""Name; lumps; simulated time, s; cases with friction from 0.22 to 0.32."""
STRINGS = (("200 lumps", "lumped", 200, 60.0, 0.06), ("24 elements of a beam", "ale-ancf", 24, 20.0, 0.1))
"""Name; model; elements; simulated time, s; and the real-time factor that was asked for."""
SHORT, PAIRS, QUICK_PAIRS = 0.05, 7, 1


def _string(kind: str, elements: int, end: float) -> dict[str, Any]:
    import tautline

    scene = tautline.read(ROOT / "data" / "jwell.yaml")
    return scene.replace({"model.kind": kind, "model.elements": elements, "solver.end": end})


def work() -> None:
    """Run what is asked for on standard input, a line each, and print the processor time and what came of it."""
    import time

    import tautline

    for line in sys.stdin:
        what, kind, elements, end, cases = json.loads(line)
        scene, began = _string(kind, elements, end), time.process_time()
        if what == "sweep":
            factors = [0.22 + 0.1 * k / max(1, cases - 1) for k in range(cases)]
            key = "well.wall.friction.static"
            data = tautline.sweep(scene, {key: factors}, collect=["hook_load_min", "bit_displacement"], jobs=1)
            found = [float(x) for name in ("hook_load_min", "bit_displacement") for x in data[name].values.ravel()]
            answer = [time.process_time() - began, found]
        else:
            result = tautline.simulate(scene)
            found = [float(result["hook_load"][-1]), float(result["bit_depth"][-1])]
            answer = [float(result.attributes["cpu_time"]), found]
        print(json.dumps(answer), flush=True)


def _path(checkout: Path) -> str:
    """Where a worker looks for modules: this checkout's code may come from the path that this process was given."""
    given = os.environ.get("PYTHONPATH", "") if checkout == ROOT else ""
    return os.pathsep.join([str(ROOT), *([given] if given else [])])


class Worker:
    """A process with the code of a checkout."""

    def __init__(self, checkout: Path) -> None:
        python = checkout / ".venv" / "bin" / "python" if checkout != ROOT else Path(sys.executable)
        # The other checkout has its code from its own environment: this file is run as it stands here, with the
        # benchmarks that are here.
        self.process = subprocess.Popen(
            [str(python), str(Path(__file__).resolve()), "--work"], cwd=checkout,
            env=os.environ | {"PYTHONPATH": _path(checkout)}, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )  # fmt: skip

    def run(self, *task: Any) -> tuple[float, list[float]]:
        """Processor time, s, and figures of a task."""
        assert self.process.stdin is not None and self.process.stdout is not None
        self.process.stdin.write(json.dumps(task) + "\n")
        self.process.stdin.flush()
        return tuple(json.loads(self.process.stdout.readline()))

    def close(self) -> None:
        """End the process."""
        assert self.process.stdin is not None
        self.process.stdin.close()
        self.process.wait()


def _apart(rounds: list[list[tuple[float, list[float]]]]) -> str:
    """Largest relative difference of figures between both checkouts."""
    if len(rounds[0]) == 1:
        return "–"
    pairs = [pair for one in rounds for pair in zip(one[0][1], one[1][1], strict=True)]
    return f"{max(abs(b - a) / max(abs(a), 1e-12) for a, b in pairs):.1e}"


def measure(workers: list[Worker], pairs: int, quick: bool) -> str:
    """The table; the last of the workers is this checkout."""
    tasks = [(name, ("sweep", "lumped", n, SHORT if quick else end, cases), None) for name, n, end, cases in SWEEPS]
    tasks += [(name, ("run", kind, n, SHORT if quick else end, 1), goal) for name, kind, n, end, goal in STRINGS]
    rows = []
    for name, task, goal in tasks:
        for worker in workers:
            worker.run(*task[:3], SHORT, min(2, task[4]))
        rounds = [[worker.run(*task) for worker in workers] for _ in range(pairs)]
        ratios = sorted(one[0][0] / one[-1][0] for one in rounds)
        times = [median(one[k][0] for one in rounds) for k in range(len(workers))]
        figures = [task[4] / t if goal is None else t / task[3] for t in times]
        unit = "cases a core and second" if goal is None else f"real-time factor (asked: {goal:g})"
        rows.append(
            (
                name, unit, number(figures[0], 3) if len(workers) > 1 else "–", number(figures[-1], 3),
                number(median(ratios), 3) if len(workers) > 1 else "–",
                f"{number(ratios[0], 3)} to {number(ratios[-1], 3)}" if len(workers) > 1 else "–", _apart(rounds),
            )
        )  # fmt: skip
        print(f"{name}: {times}", file=sys.stderr, flush=True)
    head = ("string", "figure", "before", "now", "times as fast", "smallest to largest", "figures apart, relative")
    return table(head, rows)


def main() -> None:
    """Print the table, or serve the one who does."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", nargs="?", type=Path)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--pairs", type=int)
    parser.add_argument("--work", action="store_true")
    asked = parser.parse_args()
    if asked.work:
        work()
        return
    workers = [Worker(checkout) for checkout in (*([asked.before.resolve()] if asked.before else []), ROOT)]
    print(measure(workers, asked.pairs or (QUICK_PAIRS if asked.quick else PAIRS), asked.quick))
    for worker in workers:
        worker.close()


if __name__ == "__main__":
    main()
