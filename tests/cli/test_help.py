"""Help comes at once: nothing heavy is imported for it."""

import subprocess
import sys
from pathlib import Path

import pytest

FAKE = Path(__file__).with_name("fake_application.py")
# typer itself loads pydantic for a verb's options, so it is not in this list.
HEAVY = "numpy pint numba h5py h5netcdf xarray pandas matplotlib scipy yaml sympy".split()
COMMANDS = {"fake": [str(FAKE)], "tautline": ["-m", "tautline.cli.main"]}


def imported(arguments):
    done = subprocess.run([sys.executable, "-X", "importtime", *arguments], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    lines = [line for line in done.stderr.splitlines() if line.startswith("import time:")]
    return {line.rpartition("|")[2].strip().partition(".")[0] for line in lines}


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("verb", [[], ["check"], ["simulate"], ["plot"], ["new"], ["schema"]])
def test_help_imports_nothing_heavy(command, verb):
    assert imported([*COMMANDS[command], *verb, "--help"]).isdisjoint(HEAVY)


def test_help_names_every_verb_and_option():
    text = subprocess.run([sys.executable, FAKE, "--help"], capture_output=True, text=True).stdout
    assert all(verb in text for verb in ("check", "simulate", "plot", "new", "schema"))
    text = subprocess.run([sys.executable, FAKE, "simulate", "--help"], capture_output=True, text=True).stdout
    assert all(option in text for option in ("SCENE", "--method", "--step", "--end", "--rho-inf", "--json", "--quiet"))


def test_a_run_imports_no_plotting_and_no_xarray(tmp_path):
    (tmp_path / "good.yaml").write_text("fake: true\n")
    arguments = [str(FAKE), "simulate", str(tmp_path / "good.yaml"), "-o", str(tmp_path / "good.nc"), "--quiet"]
    assert imported(arguments).isdisjoint({"matplotlib", "xarray", "pandas", "pyvista", "sympy"})
