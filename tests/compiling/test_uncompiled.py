"""Every kernel also runs as plain Python: for coverage, and for a debugger."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from of_the_suite import studies

import tautline
from tautline.results.result import Result

DATA = Path(__file__).parents[2] / "data"
HERE = Path(__file__).parents[1] / "kernels"
SOME = {
    "strings/test_string_groups.py": "spatial and 1 and not one and (power or difference and (damped or stiff))",
    "strings/test_contact_groups.py": "(spatial and 1 and power) or drag or drive or load",
    "matrices/test_unknowns.py": "transpose or transformed",
    "matrices/test_band.py": "numpy",
    "matrices/test_matrix.py": "dense or singular",
    "elements/test_cable_groups.py": "residual and anyhow and not gradient",
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
    assert not list(tmp_path.rglob("*.nbc"))


@pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="is itself uncompiled")
@pytest.mark.parametrize(
    "command, scene, end, of_interest",
    [
        ("drillstring", "jwell", 0.02, ("tension", "bit_speed")),
        ("crane", "hoist", 0.05, ("tension", "body_position")),
        *studies(("gardenhose", "hose", 0.01, ("position",))),
    ],
)
def test_a_command_run_uncompiled_finds_what_it_finds_compiled(command, scene, end, of_interest, tmp_path):
    """To rounding, where products and sums are fused in one of them only."""
    changes = {"solver.end": end, "output.interval": end}
    words = [word for key, value in changes.items() for word in ("--set", f"{key}={value}")]
    done = subprocess.run(
        [
            sys.executable, "-m", f"{command}.main", "simulate", str(DATA / f"{scene}.yaml"), "--no-verify", "-q",
            "-o", str(tmp_path / "r.nc"), *words,
        ],
        capture_output=True, text=True, env={**os.environ, "NUMBA_DISABLE_JIT": "1", "TAUTLINE_CACHE": str(tmp_path)},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-3000:]
    found = Result.read(tmp_path / "r.nc")
    compiled = tautline.simulate(tautline.read(DATA / f"{scene}.yaml").replace(changes))
    for name in of_interest:
        expected = np.asarray(compiled[name])
        assert np.abs(np.asarray(found[name]) - expected).max() <= 1e-7 * np.abs(expected).max()
    assert not list(tmp_path.rglob("*.nbc"))
