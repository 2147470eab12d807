"""What a run says of its energy is what its method made or destroyed, and nothing else."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from physics.cables.rope_text import PINNED, chain, scene
from scipy.special import j1, jn_zeros

import tautline
from tautline.cable.input.scene import parse
from tautline.cable.model.build import build
from tautline.integrators.status import Status, StoppedEarly
from tautline.results.assessment.balance import Balance
from tautline.simulation import simulate

DATA = Path(__file__).parents[2] / "data"
LENGTH, ANGLE, G = 10.0, 0.02, 9.81


def hanging(damping, step, rho_inf, end=6.0, elements=10):
    """A rope that is let go unstretched, along a line that leans by `ANGLE`: it stretches at once, and swings."""
    along = np.array([np.sin(ANGLE), 0.0, -np.cos(ANGLE)])
    p = np.linspace(0.0, LENGTH, elements + 1)
    items = chain(p[:, None] * along, p, {0: PINNED}, EA=1.0e6, damping=damping)
    settings = {"rho_inf": rho_inf, "time_step": step, "time_end": end, "eps_energy": 1e-10, "plotpoints": 20}
    return simulate(build(parse(scene(items, maxIter=30, **settings))))


def swings(times):
    """Tip of a chain let go from a straight line, m: 8 theta L / (j^3 J1(j)) cos(j/2 sqrt(g/L) t), J0(j) = 0."""
    roots = jn_zeros(0, 60)
    amplitudes = 8.0 * ANGLE * LENGTH / (roots**3 * j1(roots))
    return amplitudes @ np.cos(0.5 * np.sqrt(G / LENGTH) * np.outer(roots, times))


@pytest.mark.parametrize("rho_inf", [0.5, 0.8, 1.0])
@pytest.mark.parametrize("step", [0.01, 0.03])
def test_a_rope_whose_release_rings_faster_than_the_step_is_not_called_wrong(step, rho_inf):
    # the stretch rings at 25 Hz and above; the swing, of 0.19 Hz, is right
    result = hanging(1.0e-3, step, rho_inf)
    times = np.asarray(result["time"])
    np.testing.assert_allclose(result["position"][:, -1, 0], swings(times), atol=0.04 * ANGLE * LENGTH)
    released = float(result["strain_energy"].max())
    lost = float(result["dissipated_energy"][-1] + result.attributes["numerical_dissipation"])
    # what the stretch sets free, rhoA^2 g^2 L^3 / (6 EA), is lost: to the damper, or to the method
    assert lost == pytest.approx(G**2 * LENGTH**3 / 6.0e6, rel=0.02) and released > lost
    assert result.attributes["energy_error"] < 0.1


@pytest.mark.parametrize(("damping", "step"), [(1e-4, 0.002), (1e-3, 0.01), (1e-3, 0.03), (1e-2, 0.03)])
def test_the_average_acceleration_neither_makes_nor_destroys_energy_of_a_damped_rope(damping, step):
    # for linear forces M dv.v = dq.F holds to rounding with the mean of the forces at both ends; the rope is nearly so
    result = hanging(damping, step, 1.0)
    assert abs(result.attributes["numerical_dissipation"]) < 2e-3 * float(result["dissipated_energy"][-1])


def test_energy_that_a_method_does_create_still_stops_the_run():
    # undamped, and three times too long a step for the average acceleration of a rope that turns: it explodes
    with pytest.raises(StoppedEarly) as stop:
        hanging(0.0, 0.03, 1.0, end=10.0)
    assert stop.value.status == Status.IMBALANCE


def test_a_damper_that_gives_energy_back_is_energy_from_nowhere():
    # kinetic, strain, potential, work, loss: the loss falls from 4 J to 1 J while the kinetic energy rises by 3 J
    balance = Balance(1.0, 0.0)
    balance.add(np.array([[5.0, 0, 0, 0, 0], [1.0, 0, 0, 0, 4.0], [4.0, 0, 0, 0, 1.0]]))
    assert balance.missing() == pytest.approx(3.0)
    assert balance.gained(0.0) > 0.05


def test_what_the_method_set_aside_at_the_start_is_not_from_nowhere():
    balance = Balance(0.0, 0.0)
    balance.add(np.array([[1.0, 0, 0, 0, 0], [1.5, 0, 0, 0, 0]]))
    assert balance.gained(8.5) == pytest.approx(0.5 / 9.5, rel=1e-5)
    assert balance.gained(8.5, aside=0.4) == pytest.approx(0.1 / 9.5, rel=1e-5)
    assert balance.gained(8.5, aside=0.6) == 0.0


SHIPPED = [("jwell", 3.0), ("hoist", 3.0), ("hose", 1.0), ("drilling", 2.0), ("reeled_span", 3.0), ("slewing", 3.0)]
OTHERS = [("tripping", 3.0), ("landing", 8.0), ("hookblock", 5.0), ("sixteen_falls", 2.0), ("whirl", 2.0)]


@pytest.mark.parametrize("factor", [0.1, 4.0])
@pytest.mark.parametrize(("name", "end"), [*SHIPPED, *(pytest.param(*c, marks=pytest.mark.study) for c in OTHERS)])
def test_no_shipped_scene_is_called_wrong_at_a_tenth_or_four_times_its_step(name, end, factor, tmp_path):
    text = (DATA / f"{name}.yaml").read_text(encoding="utf8")
    here = tmp_path / f"{name}.yaml"
    here.write_text(text, encoding="utf8")
    scene = tautline.read(here)
    step = factor * scene.solver.step
    for key, value in (("step", step), ("end", end * min(1.0, 5.0 * factor)), ("time_step", step), ("time_end", end)):
        text = re.sub(rf"\b{key}: [0-9.e+-]+( m?s\b)?", f"{key}: {value!r}", text)
    text = re.sub(r"\binterval: [0-9.e+-]+( m?s\b)?", f"interval: {max(step, 0.05)!r}", text)
    here.write_text(text, encoding="utf8")
    assert tautline.read(here).solver.step == pytest.approx(step)
    result = tautline.simulate(here)
    assert result.attributes["status"] == "done" and result.attributes["energy_error"] < 0.05


def test_what_was_gained_is_found_anew_when_frames_or_what_went_through_are_others():
    balance = Balance(1.0, 0.0)
    balance.add(np.array([[0.0, 0.0, 10.0, 0.0, 0.0], [11.0, 0.0, 0.0, 0.0, 0.0]]))
    first = balance.gained(20.0)
    assert balance.gained(20.0) == first > 0.0
    assert balance.gained(40.0) < first and balance.gained(20.0, 0.5) < first
    balance.add(np.array([[14.0, 0.0, 0.0, 0.0, 0.0]]))
    assert balance.gained(20.0) > first
