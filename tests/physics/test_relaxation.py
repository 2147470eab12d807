"""Dynamic relaxation comes to the equilibrium that Newton's method finds, and to rest where that cannot look."""

import numpy as np
import pytest
from physics.cables.tied_cables import PINNED, element, model_of, node, scene
from physics.wells.strings import shipped
from scipy.integrate import solve_bvp

from drillstring.model.build import build
from tautline.integrators.method import method_for
from tautline.integrators.state import new_state
from tautline.integrators.statics.equilibrium import find_equilibrium
from tautline.integrators.statics.relaxation import relax
from tautline.integrators.status import Status, StoppedEarly
from tautline.simulation import simulate

GRAVITY = (0, 0, -9.81)
CLAMPED = (1,) * 7


def chain(n=8, **solver):
    """A rope of 1 kg/m that begins in a straight line between two pins."""
    nodes = [node(i, (8.0 * i / n, 0, 0), PINNED if i in (0, n) else (0,) * 6 + (1,)) for i in range(n + 1)]
    return scene([*nodes, *(element(i, i, i + 1, EA=1e4) for i in range(n))], GRAVITY, **solver)


def cantilever(n=4, **solver):
    """A beam that hangs far down: P L / EJ of its own weight is 40."""
    nodes = [node(i, (i / n, 0, 0), CLAMPED if i == 0 else (0,) * 6 + (1,)) for i in range(n + 1)]
    return scene([*nodes, *(element(i, i, i + 1, EA=1e4, EJ=0.25) for i in range(n))], GRAVITY, **solver)


IMPLICIT = {"type": "G-alpha", "rho_inf": 0.8, "time_step": 2e-3}


def relaxed(text, **limits):
    model = model_of(text)
    state = new_state(model.system)
    found = relax(model.system, state, method_for(model.system, model.solver), model.solver.step, **limits)
    return model, state, found


@pytest.mark.parametrize(
    "text",
    [chain(**IMPLICIT), cantilever(**IMPLICIT), chain(4, type="RK4", time_step=1e-3)],
    ids=["chain", "beam", "rk4"],
)
def test_relaxation_ends_where_newton_does(text):
    model, state, found = relaxed(text)
    newton = new_state(model.system)
    find_equilibrium(model.system, newton, model.step_limit)
    # imbalance 1e-7 of the largest force: the softest mode is off by about as much of the length
    assert np.abs(state.full_q - newton.full_q).max() < 1e-5
    assert found.imbalance <= 1e-7
    assert not state.v.any() and not state.ledger.any()


def test_a_relaxed_start_is_at_rest_when_the_run_begins():
    result = simulate(model_of(chain(**IMPLICIT, start="relaxed", time_end=0.5)))
    assert np.abs(result["position"] - result["position"][0]).max() < 1e-5
    assert result.attributes["steps"] == 250


def test_a_scene_that_never_comes_to_rest_is_stopped_by_name():
    falling = [node(0, (0, 0, 0)), node(1, (1, 0, 0)), element(0, 0, 1, EA=1e4)]
    with pytest.raises(StoppedEarly) as stop:
        relaxed(scene(falling, GRAVITY, **IMPLICIT), most=400)
    assert stop.value.status == Status.NO_EQUILIBRIUM
    assert "400 steps" in str(stop.value)


def test_a_column_beyond_its_buckling_length_comes_to_rest_hanging_over_as_the_heavy_elastica_does(n=24):
    """EJ theta'' = -w (L - s) sin theta from the vertical; Greenhill's w L^3 / EJ = 7.84 is passed 125 times."""
    weight, EJ, length = 9.81, 10.0, 5.0
    up, free = (0, 0, 1), (0,) * 6 + (1,)
    nodes = [node(i, (0, 0, length * i / n), CLAMPED if i == 0 else free, up) for i in range(n + 1)]
    column = [element(i, i, i + 1, EA=1e7, EJ=EJ, rhoA=1.0) for i in range(n)]
    # It falls over in thousands of steps of 2 ms, in which the relaxation has its own time for every degree of freedom.
    steps = IMPLICIT | {"time_step": 1e-2, "time_end": 0.1}
    result = simulate(model_of(scene([*nodes, *column], GRAVITY, **steps, start="relaxed")))
    s = np.linspace(0.0, length, 400)
    bent = solve_bvp(
        lambda s, y: np.array([y[1], -weight / EJ * (length - s) * np.sin(y[0])]),
        lambda at, end: np.array([at[0], end[1]]),
        s,
        np.array([3.1 * (1 - np.exp(-3 * s)), 9.3 * np.exp(-3 * s)]),
        tol=1e-8,
    )
    theta = bent.sol(s)[0]
    across, height = np.trapezoid(np.sin(theta), s), np.trapezoid(np.cos(theta), s)
    assert bent.success and height < -3.0
    tip = result["position"][0, -1]
    assert np.hypot(tip[0], tip[1]) == pytest.approx(across, abs=2e-3 * length)
    assert tip[2] == pytest.approx(height, abs=2e-3 * length)
    assert np.abs(result["position"][-1] - result["position"][0]).max() < 1e-4
    assert any("It was perturbed" in told for told in result.warnings)


def test_a_scene_in_stable_balance_is_not_pushed():
    result = simulate(model_of(chain(**IMPLICIT, start="relaxed", time_end=0.01)))
    assert not any("pushed" in told or "unstable" in told for told in result.warnings)


def test_a_relaxed_string_is_held_by_friction_where_a_static_one_is_not():
    # lowered into the hole a string keeps part of its weight on the wall: it hangs shorter than without friction
    ends = {}
    for start in ("static", "relaxed"):
        top = {"block": 0.0, "rotation": 0.0}
        scene_ = shipped("jwell", start=start, top=top, solver__end=0.5, output__interval=0.1)
        ends[start] = simulate(build(scene_))
    moved = {start: np.ptp(result["bit_depth"]) for start, result in ends.items()}
    assert moved["relaxed"] < 1e-6
    friction = np.abs(ends["relaxed"]["friction_force"][0])
    limit = 0.3 * ends["relaxed"]["contact_force"][0]
    assert friction.max() > 100.0
    assert (friction <= limit * (1.0 + 1e-6) + 1e-6).all()
