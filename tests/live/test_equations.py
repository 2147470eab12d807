"""Our mechanics under integrators of SciPy, and forces that a user adds."""

from pathlib import Path

import numba
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import tautline
from tautline.live.errors import SimulationError

DATA = Path(__file__).parents[2] / "data"
HANGING = """
title: A rope that is let go
rope: {mass_per_length: 2.0, axial_stiffness: 2.0e4, damping: 2.0e-3, diameter: 22 mm, breaking_load: 0.4 MN}
path:
  - anchor: {name: left, position: [0, 0, 0]}
  - anchor: {name: right, position: [10, 0, 0]}
mesh: {elements_per_span: 8}
start: as drawn
solver: {method: generalized-alpha, rho_inf: 1, step: 0.2 ms, end: 1 s}
output: {interval: 10 ms}
"""


def driven_by(method, scene, end, relative, absolute, **more):
    equations = tautline.Simulation(scene, keep=False).equations
    t, q, v = equations.state()
    start = np.concatenate((q, v))
    found = solve_ivp(equations.first_order, (t, end), start, method=method, rtol=relative, atol=absolute, **more)
    assert found.success, found.message
    return found.y[: equations.size, -1], equations


def ours(scene, end, step=None):
    read = tautline.read(scene)
    sim = tautline.Simulation(read, keep=False)
    if step is not None:
        sim._checked.step = step
    sim.advance_to(end)
    return sim._state.q.copy()


@pytest.mark.parametrize("method", ["DOP853", "Radau", "BDF"])
def test_scipy_drives_the_hammer_bar_to_where_our_rk4_does(method):
    tolerance = {"DOP853": 1e-10, "Radau": 1e-8, "BDF": 1e-7}[method]
    q, _ = driven_by(method, DATA / "cantilever_bar.yaml", 0.4, tolerance, 1e-3 * tolerance)
    assert np.abs(q - ours(DATA / "cantilever_bar.yaml", 0.4, 1e-3)).max() < max(1e-9, 50.0 * tolerance)


@pytest.mark.parametrize("method", ["DOP853", "Radau", "BDF"])
def test_scipy_drives_a_hanging_rope_to_where_ours_does(method):
    tolerance = {"DOP853": 1e-8, "Radau": 1e-6, "BDF": 1e-6}[method]
    q, _ = driven_by(method, HANGING, 0.2, tolerance, 1e-2 * tolerance)
    fine = ours(HANGING, 0.2, 5e-5)
    assert np.abs(q - fine).max() < max(2e-5, 100.0 * tolerance)


@pytest.mark.parametrize("method", ["Radau", "BDF"])
def test_scipy_drives_a_hose_with_its_tangent_to_where_ours_does(method):
    scene, end = DATA / "hose.yaml", 0.02
    equations = tautline.Simulation(scene, keep=False).equations
    q, _ = driven_by(method, scene, end, 1e-7, 1e-10, jac=equations.first_order_tangent)
    assert np.abs(q - ours(scene, end, 2e-5)).max() < 2e-6


@pytest.mark.parametrize("begin", [0.0, 0.3])
def test_scipy_drives_a_lift_to_where_ours_does_with_the_rope_that_the_static_start_found(begin):
    """The start adds as much rope as makes the load hang where it is drawn; the equations are those of that rope."""
    keys = {"path[1].sheave.bearing.friction": 0.0, "solver.control": "fixed", "solver.step": "0.5 ms"}
    scene = tautline.read(DATA / "hoist.yaml").replace(keys)
    end = 0.5  # of the first second, in which the winch is started: earlier next to nothing has moved
    sim = tautline.Simulation(scene, keep=False)
    if begin > 0.0:
        sim.advance_to(begin)
    equations = sim.equations
    t, q, v = equations.state()
    assert np.abs(equations.residual(t, q, v, sim._state.a)).max() < 1e-6 * equations.scale.max()
    found = solve_ivp(equations.first_order, (t, end), np.concatenate((q, v)), "DOP853", rtol=1e-8, atol=1e-11)
    sim.advance_to(end)
    assert np.abs(found.y[: equations.size, -1] - sim._state.q).max() < 2e-6


def test_mass_tangent_and_residual_are_of_one_piece():
    equations = tautline.Simulation(HANGING, keep=False).equations
    t, q, v = equations.state()
    rng = np.random.default_rng(1)
    q, v, a = q + 1e-3 * rng.normal(size=q.size), rng.normal(size=q.size), rng.normal(size=q.size)
    r = equations.residual(t, q, v, a)
    mass = equations.mass(q, t)
    assert np.allclose(equations.residual(t, q, v, 0 * a) + mass @ a, r, rtol=1e-12, atol=1e-9 * np.abs(r).max())
    wanted = mass.toarray()
    tangent = equations.tangent(t, q, v, a, 1.0, 0.0, 0.0).toarray()
    assert np.abs(tangent - wanted).max() < 1e-12 * np.abs(wanted).max()
    for part, x in (((0.0, 1.0, 0.0), v), ((0.0, 0.0, 1.0), q)):
        d = rng.normal(size=q.size)
        h = 1e-6
        moved = [x + s * h * d for s in (1.0, -1.0)]
        pairs = [(q, y) if part[1] else (y, v) for y in moved]
        difference = (equations.residual(t, *pairs[0], a) - equations.residual(t, *pairs[1], a)) / (2.0 * h)
        exact = equations.tangent(t, q, v, a, *part) @ d
        assert np.abs(difference - exact).max() < 1e-6 * np.abs(exact).max()
    assert np.allclose(equations.residual(t, q, v, equations.acceleration(t, q, v)), 0.0, atol=1e-8 * np.abs(r).max())


WINCHES = {
    "torque": "torque: 28 kN m",
    "tension with gains": "tension: {ramp: {to: 60 kN, over: 2}}, gains: {proportional: 5, integral: 1}",
}


@pytest.mark.parametrize("axial", ["8.0e7", "1.0e6"], ids=["wire", "soft"])
@pytest.mark.parametrize("drive", WINCHES)
def test_the_tangent_of_a_winch_knows_its_gain_and_the_stretch_of_its_rope(drive, axial):
    """Against central differences: a gain of 5 that is left out puts 83 % into the winch's row."""
    text = (DATA / "hoist.yaml").read_text().replace("8.0e7", axial).replace("6.5 ", "0.5 ")
    begin, end = text.index("pay_out:"), text.index("}}}", text.index("pay_out:"))
    scene = text[:begin] + WINCHES[drive] + ", inertia: 400" + text[end + 2 :]
    sim = tautline.Simulation(scene, keep=False)
    sim.advance_to(1.0)
    equations = sim.equations
    t, q, v = equations.state()
    y, n = np.concatenate((q, v)), equations.size
    tangent = equations.first_order_tangent(t, y)
    tangent = np.asarray(tangent.todense() if hasattr(tangent, "todense") else tangent)
    row = n + next(k for k, name in enumerate(equations.names) if name == "winch: material")
    found = np.zeros(2 * n)
    for i in range(2 * n):
        step = np.zeros(2 * n)
        step[i] = 1.0e-6 * max(1.0, abs(y[i]))
        ends = equations.first_order(t, y + step), equations.first_order(t, y - step)
        found[i] = (ends[0][row] - ends[1][row]) / (2.0 * step[i])
    assert np.linalg.norm(tangent[row] - found) < 1.0e-2 * np.linalg.norm(found)


def test_equations_refuse_vectors_of_another_size_and_do_not_touch_the_simulation():
    sim = tautline.Simulation(HANGING)
    sim.advance(0.1)
    before = sim.save()
    equations = sim.equations
    with pytest.raises(SimulationError, match="unknowns"):
        equations.residual(0.0, np.zeros(3), np.zeros(3), np.zeros(3))
    equations.acceleration(0.3, *equations.state()[1:])
    assert np.array_equal(before.block, sim.save().block)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (lambda one, t, q, v: one.residual("x", q, v, v), "'x' is no time"),
        (lambda one, t, q, v: one.residual(np.nan, q, v, v), "nan is no time"),
        (lambda one, t, q, v: one.residual(t, q * np.nan, v, v), "number 0 of a vector is nan"),
        (lambda one, t, q, v: one.residual(t, q, v, v + np.inf), "is inf, which is not finite"),
        (lambda one, t, q, v: one.residual(t, q, v + 1j, v), "complex numbers"),
        (lambda one, t, q, v: one.residual(t, q, ["x"] * q.size, v), "has no numbers"),
        (lambda one, t, q, v: one.residual(t, q, [[1.0], [1.0, 2.0]], v), "no vector of numbers"),
        (lambda one, t, q, v: one.acceleration(t, q * np.nan, v), "not finite"),
        (lambda one, t, q, v: one.mass(q * np.nan), "not finite"),
        (lambda one, t, q, v: one.mass(q, t="x"), "'x' is no time"),
        (lambda one, t, q, v: one.tangent(t, q, v, v, ck="x"), "'x' is no factor ck"),
        (lambda one, t, q, v: one.tangent(t, q, v, v, cm=np.nan), "nan is no factor cm"),
        (lambda one, t, q, v: one.first_order(0, None), "has no numbers"),
        (lambda one, t, q, v: one.first_order(0, q), "positions and velocities"),
        (lambda one, t, q, v: one.first_order_tangent(0, q), "positions and velocities"),
    ],
)
def test_equations_refuse_what_is_no_finite_real_number(wrong, words):
    equations = tautline.Simulation(HANGING).equations
    with pytest.raises(SimulationError, match=words):
        wrong(equations, *equations.state())


@pytest.mark.parametrize("names", [(None, ["payload.position"]), (["winch.pay_out_speed"], None), ([3], [])])
def test_linearise_refuses_what_is_no_name(names):
    with pytest.raises(SimulationError, match="is no name; give names"):
        tautline.Simulation(rolling()).linearise(*names)


@pytest.mark.parametrize(
    ("returned", "words"),
    [
        ("text", "is str, which is no numbers"),
        (None, "is NoneType"),
        ([1j, 0, 0], "complex"),
        ([[1], [1, 2]], "no vec"),
    ],
)
def test_a_force_that_returns_no_real_numbers_is_refused_in_words(returned, words):
    sim = tautline.Simulation(rolling())
    with pytest.raises(SimulationError, match=words):
        sim.add_force(lambda t, q, v: returned, on="payload.position")
        sim.advance(0.1)


PLACE = np.array([12.4, 0.0, 5.0])


def spring(t, q, v):
    force = -1.0e4 * (q - PLACE) - 200.0 * v
    force[2] = 0.0
    return force


@numba.njit
def compiled_spring(t, q, v, force):
    force[0] = -1.0e4 * (q[0] - 12.4) - 200.0 * v[0]
    force[1] = -1.0e4 * q[1] - 200.0 * v[1]
    force[2] = 0.0


def rolling():
    return tautline.read(DATA / "hoist.yaml").replace(
        {"vessel.motion": {"roll": {"harmonic": {"amplitude": "3 deg", "period": 7, "ramp": 3}}}}
    )


def test_a_force_in_python_and_the_same_compiled_do_what_the_springs_of_the_scene_do():
    held = rolling().replace(
        {
            "bodies[0].spring": {"stiffness": [1.0e4, 1.0e4, 0], "damping": [200, 200, 0], "rest": [12.4, 0, 5]},
            "start": "as drawn",
        }
    )
    free = rolling().replace({"start": "as drawn"})
    built_in = tautline.Simulation(held)
    built_in.advance_to(5.0)
    for force in (spring, compiled_spring):
        sim = tautline.Simulation(free)
        sim.add_force(force, on="payload.position")
        sim.advance_to(5.0)
        assert np.abs(sim["payload.position"] - built_in["payload.position"]).max() < 1e-7
        other = sim.copy()
        other.advance(0.5)
        sim.advance(0.5)
        assert np.array_equal(other["payload.position"], sim["payload.position"])


def test_work_of_an_added_force_is_in_the_books():
    sim = tautline.Simulation(rolling())
    sim.add_force(compiled_spring, on="payload.position")
    sim.advance_to(6.0)
    assert abs(sim.result.attributes["energy_error"]) < 1e-3


def test_a_force_on_everything_is_a_function_of_all_places():
    sim = tautline.Simulation(rolling())
    n = sim.model.system.q.size
    sim.add_force(lambda t, q, v: np.zeros(n))
    other = tautline.Simulation(rolling())
    sim.advance_to(1.0)
    other.advance_to(1.0)
    assert np.allclose(sim["payload.position"], other["payload.position"], atol=1e-12)


def test_what_a_force_raises_comes_out_and_the_simulation_can_be_restored():
    def broken(t, q, v):
        if t > 0.5:
            raise ZeroDivisionError("no such thing")
        return 0.0 * q

    sim = tautline.Simulation(rolling())
    sim.add_force(broken, on="payload.position")
    sim.advance_to(0.4)
    state = sim.save()
    with pytest.raises(ZeroDivisionError, match="no such thing"):
        sim.advance_to(1.0)
    sim.restore(state)
    assert sim.time == pytest.approx(0.4)
    with pytest.raises(SimulationError, match="return 3 numbers"):
        sim.add_force(lambda t, q, v: np.zeros(2), on="payload.position")
        sim.advance(0.1)


@pytest.mark.parametrize(
    ("force", "on", "words"),
    [
        (3.0, None, "neither a function nor a registered group"),
        (spring, [10_000], "degrees of freedom"),
        (spring, "winch.tension", "is not the position of a thing"),
        (lambda: 0.0, "payload.position", r"takes \(\), and is called with \(t, q, v\)"),
        (lambda t, q, v, force: 0.0, "payload.position", r"is called with \(t, q, v\)"),
    ],
)
def test_what_is_no_force_or_no_place_is_refused(force, on, words):
    sim = tautline.Simulation(rolling())
    before = sim.save()
    with pytest.raises(SimulationError, match=words):
        sim.add_force(force, on=on)
    assert np.array_equal(before.block, sim.save().block)


def test_equations_refuse_positions_from_which_no_acceleration_follows():
    equations = tautline.Simulation(DATA / "hoist.yaml", keep=False).equations
    t, q, v = equations.state()
    with pytest.raises(tautline.TautlineError, match="acceleration"):
        equations.acceleration(t, 0.0 * q, v)
