"""Measure anew what can be in one go: run scripts that write tables and figures into the docs, one after the other.

Those that need more, or far longer, are named in docs/validation_index.md.

Each has a process of its own, for it measures what else is not done in it. With --quick nothing is written but by the
gallery, into a temporary folder, and by the tables of statuses and of ranges, which are as quick as they are.
"""

from __future__ import annotations

import subprocess
import sys

from benchmarks import ROOT
from benchmarks.page import quick_asked

SCRIPTS = (
    "thesis.validation", "speed.report", "hose.validation", "accuracy.two_models", "pages.gallery", "pages.statuses",
    "pages.plausible_ranges", "pages.architecture",
)  # fmt: skip
"""Of docs/validation.md, docs/performance.md and the README's table, docs/hose_validation.md, a part of
docs/two_models.md, docs/gallery.md, parts of docs/solver.md and docs/ranges.md, and docs/architecture.md."""
ALWAYS_QUICK = ("pages.statuses", "pages.plausible_ranges", "pages.architecture")


def main() -> None:
    quick = quick_asked(__doc__)
    failed = []
    for name in SCRIPTS:
        options = ["--quick"] if quick and name not in ALWAYS_QUICK else []
        command = [sys.executable, "-m", f"benchmarks.{name}", *options]
        print(f"benchmarks.{name}", flush=True)
        if subprocess.run(command, cwd=ROOT, stdout=subprocess.DEVNULL).returncode:
            failed.append(name)
    if failed:
        sys.exit(f"failed: {', '.join(failed)}")


if __name__ == "__main__":
    main()
