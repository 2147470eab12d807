"""An application of one file has every verb."""

import json
from pathlib import Path

import numpy as np
import pytest
from application.buoy import TEMPLATE, Buoys

import tautline
from tautline.application import installed
from tautline.application.installed import Installed
from tautline.cli.run import run
from tautline.cli.verbs import make_app
from tautline.results.result import Result


@pytest.fixture(autouse=True)
def scene(tmp_path, monkeypatch):
    """A registered application and a scene of it in the current folder."""
    monkeypatch.setattr(installed, "_registered", {})
    installed.register(Buoys)
    monkeypatch.chdir(tmp_path)
    Path("scene.yaml").write_text(TEMPLATE, encoding="utf8")


def command(*words, code=0):
    given = [str(word) for word in words]
    with pytest.raises(SystemExit) as left:
        run(make_app(Installed(), given), given)
    assert left.value.code == code, words


def test_check_takes_it_and_warns_of_a_slip_of_a_unit(capsys):
    command("check", "scene.yaml", "--json")
    assert json.loads(capsys.readouterr().out)["warnings"] == []
    Path("light.yaml").write_text(TEMPLATE.replace("mass: 2 t", "mass: -2 t"), encoding="utf8")
    command("check", "light.yaml", code=2)
    assert "light.yaml:2: buoy.mass = -2 t" in "".join(capsys.readouterr())


def test_simulate_gives_the_oscillation_of_the_closed_form(capsys):
    """m = 2000 kg, k = 8000 N/m: omega = 2 rad/s; c = 100 N s/m: x = 0.5 m exp(-0.025 t) (cos + ... sin)."""
    command("simulate", "scene.yaml", "--quiet")
    result = Result.read(Path("scene.nc"))
    decay, omega = 0.025, np.sqrt(4.0 - 0.025**2)
    t = result.time
    exact = 0.5 * np.exp(-decay * t) * (np.cos(omega * t) + decay / omega * np.sin(omega * t))
    assert result["position"][:, 0, 0] == pytest.approx(exact, abs=2e-3)
    assert tautline.simulate("scene.yaml")["position"] == pytest.approx(np.asarray(result["position"]), abs=0.0)


def test_plot_render_and_export_write_what_they_say(capsys):
    command("simulate", "scene.yaml", "--end", "2", "--quiet")
    command("plot", "scene.nc", "-o", "figures")
    command("plot", "scene.nc", "--what", "velocity", "-o", "figures")
    assert {file.name for file in Path("figures").iterdir()} >= {"scene_overview.png", "scene_energy.png"}
    command("render", "scene.nc", "--image", "last", "-o", "last.png", "--html", "page.html", "--size", "320x180")
    command("export", "scene.nc", "--csv", "--vtk", "-o", "out")
    for name in ("last.png", "page.html", "out.pvd"):
        assert Path(name).stat().st_size > 0
    assert list(Path().glob("out*position*.csv")) and Result.read(Path("scene.nc")).plot.energy() is not None


def test_study_and_stability_look_at_it(capsys):
    command("study", "scene.yaml", "--quick", "--json")
    report = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert report["reference"]["converged"]
    assert {one["method"] for one in report["runs"]} == {"generalized-alpha", "rk4"}
    command("stability", "scene.yaml", "--quick", "--json")
    found = json.loads(capsys.readouterr().out.splitlines()[-1])["critical_step"]
    assert found["eigenvalue"] == pytest.approx(1.4, rel=0.01)  # 2.8 / 2 rad/s


def test_new_writes_its_template_and_schema_knows_its_keys(capsys):
    command("new", "buoy", "-o", "fresh.yaml")
    assert Path("fresh.yaml").read_text(encoding="utf8") == TEMPLATE
    capsys.readouterr()
    with pytest.raises(SystemExit) as left:
        run(make_app(Buoys()), ["schema"])
    assert left.value.code == 0
    assert "displaced" in capsys.readouterr().out


def test_outputs_of_places_that_have_no_names_have_the_shapes_of_a_frame(tmp_path):
    sim = tautline.Simulation("scene.yaml")
    told = sim.outputs.describe()
    assert told["position"]["shape"] == (1, 3) and told["kinetic_energy"]["shape"] == ()
    sim.advance_to(0.2)
    plant = sim.linearise([], ["position", "velocity"])
    assert plant.outputs[:3] == ("position[0,0]", "position[0,1]", "position[0,2]")
    assert np.abs(plant.C - np.eye(6)).max() < 1e-9


def test_an_fmu_of_places_that_have_no_names_has_their_numbers(tmp_path):
    pytest.importorskip("pythonfmu", reason="PythonFMU is not installed")
    fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed")
    command("fmu", "scene.yaml", "--outputs", "position", "-o", "buoy.fmu")
    told = fmpy.read_model_description("buoy.fmu")
    outputs = [variable.name for variable in told.modelVariables if variable.causality == "output"]
    assert outputs == ["position[0,0]", "position[0,1]", "position[0,2]"]
