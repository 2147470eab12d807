"""The same as `python -m benchmarks.pages.notebooks`, under the name that it has had from the beginning."""

import runpy
import sys
from pathlib import Path

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[1])
    runpy.run_module("benchmarks.pages.notebooks", run_name="__main__", alter_sys=True)
