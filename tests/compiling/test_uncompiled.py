"""Every kernel also runs as plain Python: for coverage, and for a debugger."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parents[1] / "kernels"
SOME = {
    "test_string_groups.py": "spatial and 1 and not one and (power or difference and (damped or stiff))",
    "test_contact_groups.py": "(spatial and 1 and power) or drag or drive or load",
    "test_unknowns.py": "transpose or transformed",
    "test_band.py": "numpy",
    "test_matrix.py": "dense or singular",
    "test_cable_groups.py": "residual and anyhow",
}


@pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="is itself uncompiled")
def test_kernels_run_uncompiled(tmp_path):
    """In one process: to start one takes longer than most of the tests."""
    some = " or ".join(f"({Path(module).stem} and ({which}))" for module, which in SOME.items())
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-v", "-x", "-p", "no:cacheprovider", *(HERE / m for m in SOME), "-k", some],
        capture_output=True, text=True, cwd=HERE.parents[1],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1", "TAUTLINE_CACHE": str(tmp_path)},
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-3000:]
    assert [module for module in SOME if module not in done.stdout] == [], "no test of it was run"
    assert not list(tmp_path.rglob("*.nbi"))
