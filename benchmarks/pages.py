"""Measure everything anew: run all scripts that write tables and figures into the docs, one after the other.

Each has a process of its own, for it measures what else is not done in it. With --quick nothing is written but by the
gallery, into a temporary folder, and by the tables of statuses and of ranges, which are as quick as they are.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from page import quick_asked

SCRIPTS = ("validation", "report", "hose", "two_models", "gallery", "statuses", "plausible_ranges", "architecture")
"""Of docs/validation.md, docs/performance.md and the README's table, docs/hose_validation.md, a part of
docs/drillstring.md, docs/gallery.md, parts of docs/solver.md and docs/ranges.md, and docs/architecture.md."""
ALWAYS_QUICK = ("statuses", "plausible_ranges", "architecture")
FOLDER = Path(__file__).parent


def main() -> None:
    quick = quick_asked(__doc__)
    failed = []
    for name in SCRIPTS:
        options = ["--quick"] if quick and name not in ALWAYS_QUICK else []
        print(f"benchmarks/{name}.py", flush=True)
        if subprocess.run([sys.executable, FOLDER / f"{name}.py", *options], stdout=subprocess.DEVNULL).returncode:
            failed.append(name)
    if failed:
        sys.exit(f"failed: {', '.join(failed)}")


if __name__ == "__main__":
    main()
