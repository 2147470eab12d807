"""The same as `python -m benchmarks.speed.storm`, under the name that it has had from the beginning."""

import runpy
import sys
from pathlib import Path

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[1])
    runpy.run_module("benchmarks.speed.storm", run_name="__main__", alter_sys=True)
