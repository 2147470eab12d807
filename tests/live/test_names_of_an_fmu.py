"""Names in an FMU: each once, whatever is asked for as input and as output."""

import zipfile
from pathlib import Path

import pytest

import tautline
from tautline.cli.run import run as run_command
from tautline.cli.verbs import make_app
from tautline.live.fmu.unit import Core, actual_of
from tautline.live.fmu.writing import write_fmu

fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed")
pytest.importorskip("pythonfmu", reason="PythonFMU is not installed")

DATA = Path(__file__).parents[2] / "data"
OUT = "winch.pay_out"
H = 0.1


@pytest.mark.parametrize("fmi", [2, 3])
def test_what_is_input_and_output_has_two_names_and_fmpy_finds_nothing_to_complain_of(fmi, tmp_path):
    pytest.importorskip("pythonfmu3", reason="PythonFMU3 is not installed")
    from fmpy.validation import validate_fmu

    path = tmp_path / "both.fmu"
    inputs, outputs = [OUT, "payload.force", "vessel.heave"], [OUT, OUT, "winch.tension", "payload.position"]
    write_fmu(DATA / "hoist.yaml", path, inputs, outputs, fmi=fmi)
    assert validate_fmu(str(path)) == []
    kinds = {one.name: one.causality for one in fmpy.read_model_description(str(path)).modelVariables}
    assert kinds[OUT] == "input" and kinds[f"{OUT}.actual"] == "output" and kinds["winch.tension"] == "output"


def test_the_input_reads_what_was_set_and_the_output_what_is(tmp_path):
    write_fmu(DATA / "hoist.yaml", tmp_path / "both.fmu", [OUT], [OUT])
    zipfile.ZipFile(tmp_path / "both.fmu").extractall(tmp_path)
    core, sim = Core(tmp_path / "resources"), tautline.Simulation(DATA / "hoist.yaml", keep=False)
    core.initialise()
    core.set(OUT, -0.02)
    assert core.get(OUT) == -0.02 and core.get(f"{OUT}.actual") == 0.0
    core.step(0.0, H)
    sim.inputs[OUT] = -0.02
    sim.advance(H)
    assert core.get(f"{OUT}.actual") == pytest.approx(sim[OUT], abs=1e-12) == pytest.approx(-0.02, abs=1e-9)


def test_an_input_named_twice_is_one(tmp_path):
    from fmpy.validation import validate_fmu

    write_fmu(DATA / "hoist.yaml", tmp_path / "twice.fmu", [OUT, OUT], ["payload.position", "payload.position[2]"])
    assert validate_fmu(str(tmp_path / "twice.fmu")) == []


@pytest.mark.parametrize(
    ("name", "inputs", "wanted"),
    [
        ("winch.tension", ["winch.tension"], "winch.tension.actual"),
        ("winch.tension", ["winch.torque"], "winch.tension"),
        ("load.force[2]", ["load.force"], "load.force.actual[2]"), ("load [a].x", ["load [a].y"], "load [a].x"),
        ("load.force[0]", ["load.force[1]"], "load.force.actual[0]"),
    ],
)  # fmt: skip
def test_the_name_of_an_output_differs_where_an_input_has_it(name, inputs, wanted):
    assert actual_of(name, inputs) == wanted


def test_the_verb_tells_the_name_of_an_output_that_is_an_input_too(tmp_path, capsys):
    from tautline.application.installed import Installed

    words = ["fmu", str(DATA / "hoist.yaml"), "-o", str(tmp_path / "x.fmu"), "--inputs", OUT, "--outputs", OUT]
    with pytest.raises(SystemExit) as left:
        run_command(make_app(Installed()), words)
    assert left.value.code == 0
    assert f"{OUT} is an input too: the output has the name {OUT}.actual" in capsys.readouterr().err
