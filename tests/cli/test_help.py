"""Help comes at once: nothing heavy is imported for it."""

import os
import subprocess
import sys
from pathlib import Path

import fake_application
import pytest

from tautline.cli.run import run
from tautline.cli.verbs import make_app

FAKE = Path(__file__).with_name("fake_application.py")
# typer itself loads pydantic for a verb's options, so it is not in this list.
HEAVY = "numpy pint numba h5py h5netcdf xarray pandas matplotlib scipy yaml sympy".split()
VERBS = ("", "check", "simulate", "plot", "new", "schema")
ASK = """
import sys
sys.path.insert(0, {folder!r})
from {module} import main
for verb in {verbs!r}:
    sys.argv = ["command", *verb.split(), "--help"]
    try:
        main()
    except SystemExit as ended:
        assert not ended.code, verb
    print(verb, "imported", *{{name.partition(".")[0] for name in sys.modules}}, file=sys.stderr)
"""


def imported(arguments):
    done = subprocess.run([sys.executable, "-X", "importtime", *arguments], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    lines = [line for line in done.stderr.splitlines() if line.startswith("import time:")]
    return {line.rpartition("|")[2].strip().partition(".")[0] for line in lines}


@pytest.mark.parametrize("module", ["fake_application", "tautline.cli.main"])
def test_help_of_every_verb_imports_nothing_heavy(module):
    """One after another in one process: what one of them imports shows in its own line first."""
    ask = ASK.format(folder=str(FAKE.parent), module=module, verbs=VERBS)
    done = subprocess.run([sys.executable, "-c", ask], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    lines = [line.partition(" imported ") for line in done.stderr.splitlines() if " imported " in line]
    assert [(verb, sorted(set(names.split()) & set(HEAVY))) for verb, _, names in lines] == [(v, []) for v in VERBS]
    assert done.stdout.count("Usage") == len(VERBS)


def test_help_names_every_verb_and_option(capsys):
    def help_of(*verb):
        with pytest.raises(SystemExit) as ended:
            run(make_app(fake_application.FakeApplication()), [*verb, "--help"])
        assert not ended.value.code
        return capsys.readouterr().out

    text = help_of()
    assert all(verb in text for verb in ("check", "simulate", "plot", "new", "schema"))
    text = help_of("simulate")
    assert all(option in text for option in ("SCENE", "--method", "--step", "--end", "--rho-inf", "--json", "--quiet"))


def test_a_run_imports_no_plotting_and_no_xarray(tmp_path):
    (tmp_path / "good.yaml").write_text("fake: true\n")
    arguments = [str(FAKE), "simulate", str(tmp_path / "good.yaml"), "-o", str(tmp_path / "good.nc"), "--quiet"]
    assert imported(arguments).isdisjoint({"matplotlib", "xarray", "pandas", "pyvista", "sympy"})


@pytest.mark.parametrize("arguments", [["--help"], ["simulate", "--help"], ["schema"]], ids=" ".join)
def test_a_command_whose_words_nobody_reads_on_ends_well(arguments):
    """As in `crane --help | head -1`."""
    nobody, into = os.pipe()
    os.close(nobody)
    try:
        code = "from crane.main import main; main()"
        done = subprocess.run([sys.executable, "-c", code, *arguments], stdout=into, stderr=subprocess.PIPE, text=True)
    finally:
        os.close(into)
    assert (done.returncode, done.stderr) == (0, "")
