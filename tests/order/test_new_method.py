"""A method of one file and one registration works with every verb: the explicit midpoint rule of `midpoint.py`."""

import importlib
import json
import math
from pathlib import Path

import numpy as np
import pytest
from order import two_masses
from scipy.integrate import solve_ivp
from study import oscillators

from tautline.application.installed import Installed
from tautline.cable.input.scene import parse
from tautline.cable.model.build import build
from tautline.cli.run import run
from tautline.cli.verbs import make_app
from tautline.integrators.method import METHODS
from tautline.integrators.period import lag_of_step
from tautline.integrators.vibration.critical_step import critical_step
from tautline.scene import methods
from tautline.simulation import simulate
from tautline.study.robustness.critical import critical_steps
from tautline.system.model import SolverSettings

OMEGA, ZETA = 10.0, 0.2


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
    given = [str(word) for word in words]
    with pytest.raises(SystemExit) as left:
        run(make_app(Installed(), given), given)
    assert left.value.code == code


PULLED = np.array([0.9, 0.0, -0.7])
"""Where the mass of an elastic pendulum is let go, m; its spring has 100 N/m, its length is the distance."""


def elastic_pendulum(**solver):
    """Text of a mass of 1 kg on a spring that is pinned at the origin: nonlinear, for the spring turns."""
    held = "Node4Dof: {id: 0, xyz: [0, 0, 0], BC: [1, 1, 1, 1], p: 0}"
    free = f"Node4Dof: {{id: 1, xyz: {PULLED.tolist()}, BC: [0, 0, 0, 1], p: 1}}"
    mass = "PointMass: {id: 0, nodes4: [1], mass: 1.0}"
    items = [held, free, oscillators.spring(0, (0, 1), 100.0), mass]
    return oscillators.text_of(items, gravity=(0, 0, -9.81), type="midpoint", rho_inf=None, **solver)


def where_it_swings_to(end):
    """Position (3,) of the pendulum, by DOP853 of its equations in plain numpy."""

    def slope(t, y):
        length = np.linalg.norm(y[:3])
        return np.concatenate([y[3:], -100.0 * (length - 1.0) / length * y[:3] - [0.0, 0.0, 9.81]])

    start = np.concatenate([PULLED, np.zeros(3)])
    return solve_ivp(slope, (0.0, end), start, method="DOP853", rtol=1e-13, atol=1e-14).y[:3, -1]


def test_its_error_falls_with_the_square_of_the_step():
    exact, found = where_it_swings_to(1.0), []
    for step in (0.01, 0.005, 0.0025, 0.00125):
        result = simulate(build(parse(elastic_pendulum(time_step=step, time_end=1.0, plotpoints=1))))
        assert result.attributes["status"] == "done"
        found.append(np.abs(result["position"][-1, 1] - exact).max())
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
    # A scene of another method that is told to take this one.
    Path("other.yaml").write_text(oscillators.oscillator(**oscillators.rk4(time_end=2.0)), encoding="utf8")
    tautline("simulate", "other.yaml", "--method", "midpoint", "--step", "0.002", "--end", "1", "--json", "--quiet")
    report = json.loads(capsys.readouterr().out)
    assert [report[key] for key in ("method", "status", "steps")] == ["midpoint", "done", 500]
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
