"""A method of one file and one registration works with every verb: the explicit midpoint rule of `midpoint.py`."""

import importlib
import json
import math
from pathlib import Path

import numpy as np
import pytest
from order import two_masses
from study import oscillators

from tautline.application.installed import Installed
from tautline.cli.run import run
from tautline.cli.verbs import make_app
from tautline.integrators.linearise import start_moving
from tautline.integrators.method import METHODS
from tautline.integrators.period import lag_of_step
from tautline.integrators.state import new_state
from tautline.integrators.status import Status
from tautline.integrators.time_loop import new_frames, run_steps
from tautline.integrators.vibration.critical_step import critical_step
from tautline.scene import methods
from tautline.study.robustness.critical import critical_steps
from tautline.system.model import SolverSettings

OMEGA, ZETA = 10.0, 0.2
DATA = Path(__file__).parents[2] / "data"


@pytest.fixture(autouse=True)
def midpoint(monkeypatch):
    """Known for one test, as if a script had imported its file.

    It is the file of docs/extending.md by the same name: of the two, the later finds its loop in the cache.
    """
    monkeypatch.setattr(methods, "_known", dict(methods._known))
    monkeypatch.syspath_prepend(Path(__file__).parent)
    record = importlib.import_module("midpoint").MIDPOINT
    return methods.register(record)


def tautline(*words, code=0):
    with pytest.raises(SystemExit) as left:
        run(make_app(Installed()), [str(word) for word in words])
    assert left.value.code == code


def test_its_error_falls_with_the_square_of_the_step():
    exact, found = two_masses.reference(2.0), []
    for count in (40, 80, 160, 320):
        system = two_masses.system()
        state = new_state(system)
        start_moving(system, state, 1e-3)
        frames = new_frames(1, 3, 0)
        made = METHODS["midpoint"](system, SolverSettings("midpoint", 0.0, 2.0, 2.0, 0.0, 0.0))
        status, filled, _ = run_steps(made, system, state, np.array([2.0]), np.array([count]), 0.0, frames)
        assert (Status(status), filled) == (Status.DONE, 1)
        found.append(np.abs(frames.q[-1, :2] - exact[0]).max())
    assert np.log2(np.array(found[:-1]) / found[1:]) == pytest.approx([2.0] * 3, abs=0.15)


@pytest.mark.parametrize("turn", [0.01, 0.1, 0.5])
def test_its_error_of_phase_is_that_of_its_polynomial(turn):
    """The phase of 1 + i x - x^2/2 is x + x^3/6 - ...: it runs ahead by x^3/6 in a step."""
    system = two_masses.system()
    made = METHODS["midpoint"](system, SolverSettings("midpoint", 0.0, 1.0, 1.0, 0.0, 0.0))
    exact = math.atan2(turn, 1.0 - 0.5 * turn**2)
    assert lag_of_step(made, turn) == pytest.approx(turn - exact, rel=1e-9)
    assert lag_of_step(made, turn) == pytest.approx(-(turn**3) / 6.0, rel=0.2)


def test_its_critical_step_is_that_of_its_polynomial_and_of_runs():
    """x.. + 2 zeta omega x. + omega^2 x: |1 + z + z^2/2| = 1 at z = h lambda, found here by a root of its own."""
    root = complex(-ZETA * OMEGA, OMEGA * math.sqrt(1.0 - ZETA**2))
    sizes = np.linspace(1e-3, 1.0, 100_000)
    z = sizes * root
    exact = sizes[np.argmax(np.abs(1.0 + z + 0.5 * z**2) > 1.0)]
    assert critical_step(OMEGA**2, 2.0 * ZETA * OMEGA, methods.method_of("midpoint")) == pytest.approx(exact, rel=2e-3)
    text = oscillators.oscillator(omega=OMEGA, zeta=ZETA, type="midpoint", rho_inf=None, time_step=0.01)
    found = critical_steps(oscillators.subject(text))
    assert found.eigenvalue == pytest.approx(exact, rel=2e-3)
    stable, unstable = found.bisection
    # Runs are judged by the energy that they create too, which ends a little before growth does.
    assert 0.9 * exact < stable < unstable < 1.02 * exact


def test_every_verb_takes_it_by_name(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    text = oscillators.oscillator(omega=OMEGA, zeta=ZETA, type="midpoint", rho_inf=None, time_step=0.005, time_end=1.0)
    Path("scene.yaml").write_text(text, encoding="utf8")
    tautline("check", "scene.yaml")
    capsys.readouterr()
    tautline("simulate", "scene.yaml", "--json", "--quiet")
    report = json.loads(capsys.readouterr().out)
    assert report["method"] == "midpoint" and report["status"] == "done"
    bar = DATA / "cantilever_bar.yaml"
    tautline("simulate", bar, "--method", "midpoint", "--step", "0.001", "--end", "1", "--quiet")
    tautline("study", "scene.yaml", "--quick", "--methods", "midpoint,newmark", "--json")
    runs = json.loads(capsys.readouterr().out.splitlines()[-1])["runs"]
    assert {one["method"] for one in runs if one["status"] == "done"} >= {"midpoint", "newmark"}
    tautline("stability", "scene.yaml", "--quick", "--json")
    found = json.loads(capsys.readouterr().out.splitlines()[-1])["critical_step"]
    assert found["eigenvalue"] == pytest.approx(found["bisection"], rel=0.1)


def test_a_word_that_is_no_method_is_refused_with_the_new_one_among_those_that_are(tmp_path, capsys):
    path = tmp_path / "scene.yaml"
    path.write_text(oscillators.oscillator(type="midpiont", rho_inf=None), encoding="utf8")
    tautline("check", path, code=2)
    assert "did you mean 'midpoint'?" in "".join(capsys.readouterr())


def test_two_methods_cannot_go_by_one_name():
    with pytest.raises(ValueError, match="goes by the name"):
        methods.register(methods.Method("RK4", "nowhere:NOTHING", order=1))
