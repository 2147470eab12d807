"""A force along a rope that begins at once: d'Alembert's bar, and a bar whose damping is integrated by SciPy."""

import numpy as np
import pytest
from physics.cables.rope_text import numbers
from scipy.integrate import solve_ivp
from scipy.sparse import bmat, diags, identity

import tautline
from tautline.cable.application import Cable
from tautline.cable.input.scene import parse

LENGTH, EA, DENSITY, FORCE = 10.0, 1e4, 1.0, 10.0
TRANSIT = LENGTH * float(np.sqrt(DENSITY / EA))
HELD, FREE = [1, 1, 1, 0, 1, 1, 1], [0, 1, 1, 0, 1, 1, 1]


def bar(elements=20, damping=0.0, force=FORCE, more="", interval=None, stretch=0.0, gravity=0.0, along=0, **solver):
    """Text of a bar along x that is held at its root and pulled at its tip."""
    pull = [0.0, 0.0, 0.0]
    pull[along] = force
    items = "".join(
        f"  - Node7Dof: {{id: {i}, xyz: [{LENGTH * (1.0 + stretch) * i / elements!r}, 0, 0], xyz_d: [{1.0 + stretch}, "
        f"0, 0], p: {LENGTH * i / elements!r}, BC: {FREE if i else HELD}}}\n"
        for i in range(elements + 1)
    ) + "".join(
        f"  - CableALEelement: {{id: {i}, nodes7: [{i}, {i + 1}], EA: {EA}, EJ: 0, rhoA: {DENSITY}, "
        f"cDamp: {damping}}}\n"
        for i in range(elements)
    )
    timed = "" if interval is None else f", timeInterval: {numbers(interval)}"
    items += f"  - PointForce: {{id: 0, nodes7: [{elements}], force: {numbers(pull)}{timed}}}\n{more}"
    settings = {"type": "G-alpha", "rho_inf": 0.8, "maxIter": 30, "eps_energy": 1e-10, "time_step": 1e-4}
    settings |= {"time_end": 2.9 * TRANSIT, "plotpoints": 10000} | solver
    written = ", ".join(f"{key}: {value}" for key, value in settings.items())
    heading = f"CableModelMaterial: {{Gravity: [{gravity}, 0, 0]}}"
    return f"{heading}\nCableModel:\n{items}GeneralizedAlpha: {{{written}}}\n"


def told(**changes):
    return [one for one in Cable().warnings(parse(bar(**changes))) if "at once" in one.text]


def simulated(tmp_path, verify=False, **changes):
    path = tmp_path / "bar.yaml"
    path.write_text(bar(**changes), encoding="utf8")
    return tautline.simulate(path, verify=verify)


@pytest.mark.parametrize("elements", [20, 40])
def test_a_force_that_begins_at_once_is_warned_of_where_the_root_does_not_bear_twice_of_it(elements, tmp_path):
    """The front doubles at the root: 2 F until it has been at the tip and back again. Green's strain adds 0.1 %."""
    most = float(simulated(tmp_path, elements=elements)["end_force"].max())
    assert 1.15 * 2.0 * FORCE < most < 1.35 * 2.0 * FORCE
    (one,) = told(elements=elements)
    assert ".PointForce.force (line " in one.where and "too large by about 25 %" in one.text


@pytest.mark.parametrize("elements", [20, 40])
def test_the_damping_that_the_warning_names_leaves_the_root_twice_the_force_and_nothing_to_warn_of(elements, tmp_path):
    cure = float(told(elements=elements)[0].text.partition("cDamp: ")[2].partition(",")[0])
    most = float(simulated(tmp_path, elements=elements, damping=cure)["end_force"].max())
    assert most == pytest.approx(2.0 * FORCE, rel=0.005)
    assert not told(elements=elements, damping=cure)


def test_only_a_force_that_sends_a_sharp_front_along_the_rope_is_warned_of():
    """Small beside the weight, borne by the stretch as drawn, across, in equilibrium at the start, on a heavy body."""
    assert not told(gravity=9.81 * 1.2) and told(gravity=5.0)
    # EA (l^2 - 1) / 2 is the pull of Green's strain: the force itself, as drawn.
    assert not told(stretch=FORCE / EA)
    assert not told(along=1)
    assert not told(start="static")
    assert told(start="static", interval=[0.0, 0.1]) and told(start="static", interval=[0.1, 1.0])
    assert not told(more="  - PointMass: {id: 1, nodes7: [20], mass: 0.3}\n")


def steps(number, apart, force=FORCE):
    """Items of equal steps in which the force at the tip grows, without the first: `bar` makes that."""
    return "".join(
        f"  - PointForce: {{id: {k}, nodes7: [20], force: [{force / number}, 0, 0], timeInterval: [{k * apart}, 9]}}\n"
        for k in range(1, number)
    )


def share_of(warned):
    return float(warned.text.partition("too large by about ")[2].partition(" %")[0]) / 100.0


@pytest.mark.parametrize("before", [{"start": "static"}, {"stretch": FORCE / EA}], ids=["static", "drawn"])
def test_a_bar_that_is_let_go_is_warned_of_where_its_root_swings_beyond_the_force_it_had(before, tmp_path):
    """By d'Alembert the root swings between F and -F; it is drawn with that stretch, or begins at rest under it."""
    changes = before | {"interval": [0.0, 0.5 * TRANSIT]}
    most = float(np.abs(simulated(tmp_path, **changes)["end_force"]).max())
    assert 1.25 * FORCE < most < 1.5 * FORCE
    (one,) = told(**changes)
    assert f"at t = {0.5 * TRANSIT:g} s" in one.text and share_of(one) >= most / FORCE - 1.0


def test_equal_blows_one_after_another_are_warned_of_however_many_they_are():
    apart = 6.0 * TRANSIT
    for number in (1, 2, 11, 25):
        more = "".join(
            f"  - PointForce: {{id: {k}, nodes7: [20], force: [{FORCE}, 0, 0], "
            f"timeInterval: [{k * apart!r}, {(k + 0.5) * apart!r}]}}\n"
            for k in range(1, number)
        )
        (one,) = told(more=more, interval=[0.0, 0.5 * apart], time_end=number * apart)
        assert share_of(one) == pytest.approx(0.25)


def test_forces_whose_sum_does_not_change_are_not_warned_of():
    """One hands over to the next, by rounding a little early or late; two that pull against each other; a late end."""
    assert not told(more=f"  - PointForce: {{id: 1, nodes7: [20], force: [{-FORCE}, 0, 0]}}\n")
    for begins in (0.1, np.nextafter(0.1, 0.0), np.nextafter(0.1, 1.0)):
        next_one = (
            f"  - PointForce: {{id: 1, nodes7: [20], force: [{FORCE}, 0, 0], timeInterval: [{float(begins)!r}, 1]}}\n"
        )
        assert not told(start="static", interval=[0.0, 0.1], more=next_one)
    assert not told(start="static", interval=[0.0, 2.9 * TRANSIT * (1.0 - 1e-6)])
    # A millionth of a second is short for the mesh, and the blow within it is none.
    assert told(interval=[0.0, 1e-6], force=1e4)


def test_as_many_steps_as_the_warning_names_leave_the_root_five_percent_and_nothing_to_warn_of(tmp_path):
    """Twice the whole force at the root, as all fronts are on their way before the first is back: 2 L / a."""
    (one,) = told()
    number = int(one.text.partition("let the force change in ")[2].partition(" ")[0])
    longest = float(one.text.partition("spread over up to ")[2].partition(" ")[0])
    assert longest == pytest.approx(2.0 * TRANSIT, rel=0.05) and number == 5
    apart = longest / number
    slow = {"force": FORCE / number, "more": steps(number, apart), "time_end": 3.9 * TRANSIT}
    assert not told(**slow)
    most = float(simulated(tmp_path, **slow)["end_force"].max())
    assert 1.01 * 2.0 * FORCE < most < 1.06 * 2.0 * FORCE
    few = {"force": FORCE / (number - 1), "more": steps(number - 1, apart)}
    assert told(**few)


def test_steps_that_follow_each_other_within_an_element_are_one_to_the_mesh(tmp_path):
    crossing = TRANSIT / 20
    for over, warned in ((crossing, True), (2.0 * crossing, False)):
        changes = {"force": FORCE / 20, "more": steps(20, over / 20)}
        most = float(simulated(tmp_path, **changes)["end_force"].max())
        assert (most > 1.05 * 2.0 * FORCE) == warned == bool(told(**changes))


def pulled(damping, end, cells=400):
    """Least and largest pull at the root of a Kelvin-Voigt bar of many cells, N, by SciPy's implicit method."""
    dx = LENGTH / cells
    middle, mass = np.full(cells, 2.0), np.full(cells, DENSITY * dx)
    middle[-1], mass[-1] = 1.0, 0.5 * mass[-1]
    aside = np.full(cells - 1, -1.0)
    stiff = diags([aside, middle, aside], [-1, 0, 1]).tocsr() * EA / dx
    push = np.zeros(cells)
    push[-1] = FORCE
    inverse = diags(1.0 / mass)
    tangent = bmat([[None, identity(cells)], [-inverse @ stiff, -damping * inverse @ stiff]]).tocsc()

    def rate(_, y):
        u, v = y[:cells], y[cells:]
        return np.r_[v, (push - stiff @ (u + damping * v)) / mass]

    found = solve_ivp(rate, (0.0, end), np.zeros(2 * cells), method="BDF", jac=tangent, rtol=1e-6, atol=1e-10)
    assert found.success
    pull = EA / dx * (found.y[0] + damping * found.y[cells])
    return float(pull.min()), float(pull.max())


@pytest.mark.parametrize("damping", [5e-4, 2e-2])
@pytest.mark.parametrize("step", [1e-3, 5e-3, 1e-2])
def test_the_force_at_the_root_is_not_much_farther_off_than_is_stated(damping, step, tmp_path):
    """What is stated is the error of the amplitude, half of the way from the least to the largest force."""
    run = simulated(tmp_path, verify=True, damping=damping, time_step=step, plotpoints=round(1.0 / step))
    force = run["end_force"][:, 0, 0]
    least, most = pulled(damping, float(run.time[-1]))
    off = 0.5 * abs(float(np.ptp(force)) - (most - least))
    stated = run.step_error["force"] * 0.5 * float(np.ptp(force))
    assert off < 1.5 * stated + 0.002 * most


@pytest.mark.parametrize("verify", [None, True])
def test_a_run_that_keeps_every_step_states_the_error_of_its_force(verify, tmp_path):
    """Its longer steps stand in no frame: the other runs keep fewer frames, and are compared in those."""
    path = tmp_path / "bar.yaml"
    path.write_text(bar(damping=5e-4, time_step=1e-3, plotpoints=1000), encoding="utf8")
    run = tautline.simulate(path, verify=verify)
    force = run["end_force"][:, 0, 0]
    assert abs(force.max() - 2.0 * FORCE) < run.step_error["force"] * float(np.ptp(force)) + 0.002 * FORCE
    assert run.step_error["steps"] != (1e-3,) and 1e-3 not in run.step_error["steps"]


def test_a_beam_without_axial_stiffness_has_no_front_that_rings():
    """No wave runs along it, whose speed the warning would divide by."""
    bent = bar().replace(f"EA: {EA}, EJ: 0", "EA: 0, EJ: 5")
    assert not [one for one in Cable().warnings(parse(bent)) if "at once" in one.text]
