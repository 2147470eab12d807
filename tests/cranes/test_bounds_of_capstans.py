"""Groove or bearing of a capstan without inertia: changing a parameter never makes the stronger of both give way.

References: Euler-Eytelwein exp(mu theta), and of a bearing T_2 - T_1 = c |F| with c = mu_b r_b / R.
"""

import math

import numpy as np
import pytest
from references import crane as reference

import tautline
from crane.assembly.estimates import estimate
from tautline.live.errors import SimulationError, UnknownName
from tautline.twin.twin import Twin

TEXT = """
rope: {mass_per_length: 0.001, axial_stiffness: 40 MN, damping: 20 ms}
bodies: [{name: load, mass: 6000, position: [10.3, 0, 0], guide: [x, y]}]
path:
  - drum: {name: A, center: [0, 0, 20], radius: 0.5, axis: [0, 1, 0], wrap: over,
      pay_out: {ramp: {to: -0.5, over: 1 s}}}
  - sheave: {name: tip, center: [10, 0, 30], radius: 0.3, axis: [0, 1, 0], wrap: over, law: capstan, friction: GROOVE,
      bearing: {friction: BEARING, radius: 0.1}MORE}
  - end: {name: hook, body: load}
mesh: {elements_per_span: 1}
solver: {step: 10 ms, end: 4 s}
output: {interval: 50 ms}
"""
MAP = "sensors: [{column: T, output: A.tension, sd: 500}]\nestimate: [{parameter: NAME, REST}]\nwindow: 1 s\n"


def scene(groove, bearing=0.2, more=""):
    text = TEXT.replace("GROOVE", str(groove)).replace("BEARING", str(bearing)).replace("MORE", more)
    return tautline.read(text)


def ratio(of, name, value):
    sim = tautline.Simulation(of, parameters={name: value})
    sim.advance(3.0)
    far, near = np.asarray(sim.result["tension"])[-1, [0, 1], [1, 0]]
    return float(far / near)


def wrap():
    return float(estimate(scene(0.1)).path.wraps[1])


def bound(name):
    """Bound of a friction in closed form: the bearing's by bisection of its ratio."""
    if name == "tip.groove_friction":
        return -math.log(reference.bearing_efficiency(0.2, 0.1, 0.3, wrap())) / wrap()
    low, high = 0.0, 2.9
    for _ in range(60):
        mid = 0.5 * (low + high)
        over = 1.0 / reference.bearing_efficiency(mid, 0.1, 0.3, wrap()) > reference.capstan_ratio(0.1, wrap())
        low, high = (low, mid) if over else (mid, high)
    return low


CASES = [(0.1, "tip.bearing_friction"), (0.01, "tip.groove_friction")]


@pytest.mark.parametrize(("groove", "name"), CASES)
def test_a_friction_that_governs_is_bounded_where_the_other_one_would_give_way(groove, name):
    most = bound(name)
    of, parameter = scene(groove), tautline.Simulation(scene(groove)).parameters
    assert parameter.handle(name).most == pytest.approx(most, rel=1e-9)
    told = parameter.describe()[name]["text"]
    assert f"at most {most:.3g}"[:12] in told and "would give way first" in told
    with pytest.raises(SimulationError, match=r"cannot be; give at least 0, at most 0\.") as refused:
        tautline.Simulation(of, parameters={name: 1.001 * most})
    # What is printed can be given, and both give way there together.
    printed = float(str(refused.value).split("at most ")[1].split()[0])
    limit = {"tip.bearing_friction": reference.capstan_ratio(0.1, wrap())}.get(
        name, 1.0 / reference.bearing_efficiency(0.2, 0.1, 0.3, wrap())
    )
    assert ratio(of, name, printed) == pytest.approx(limit, rel=1e-3)


@pytest.mark.parametrize("name", ["tip.bearing_friction", "tip.groove_friction"])
def test_with_an_inertia_both_act_and_no_friction_is_bounded(name):
    sim = tautline.Simulation(scene(0.1, more=", inertia: 0.01"))
    assert sim.parameters.handle(name).most == math.inf
    assert "at most" not in sim.parameters.describe()[name]["text"]


@pytest.mark.parametrize(
    ("rest", "key"),
    [
        ("start: 2.0, sd: 0.1", "estimate[0].start"),
        ("start: 0.2, sd: 0.1, range: [0.01, 2.0]", "estimate[0].range[1]"),
        ("start: 0.2, sd: 0.1, range: [-0.1, 0.3]", "estimate[0].range[0]"),
    ],
)
def test_a_twin_whose_start_or_range_is_beyond_what_a_parameter_may_be_is_refused_at_its_line(rest, key):
    with pytest.raises(tautline.SceneError) as refused:
        Twin(scene(0.1), MAP.replace("NAME", "tip.bearing_friction").replace("REST", rest))
    (one,) = refused.value.problems
    assert one.key == key and "cannot be" in one.cause and one.cure.startswith("give at least 0, at most 0.")


def test_a_range_may_end_where_the_parameter_does_and_without_one_no_estimate_goes_beyond():
    most = bound("tip.bearing_friction")
    for more in (f", range: [0, {0.999 * most}]", ""):
        text = MAP.replace("NAME", "tip.bearing_friction").replace("REST", f"start: 0.2, sd: 0.1{more}")
        twin = Twin(scene(0.1), text)
        (unknown,) = twin.plan.unknowns
        high = unknown.high
        assert high == pytest.approx(0.999 * most if more else most)


@pytest.mark.parametrize(
    ("groove", "name", "why"),
    [
        (0.01, "tip.bearing_friction", "tip stands still: its groove gives way before its bearing"),
        (0.1, "tip.groove_friction", "tip turns: its bearing gives way before its groove"),
    ],
)
def test_who_asks_for_the_friction_that_never_acts_is_told_why_it_is_no_parameter(groove, name, why):
    with pytest.raises(UnknownName) as refused:
        tautline.Simulation(scene(groove), parameters={name: 0.1})
    assert why in str(refused.value)
    with pytest.raises(tautline.SceneError) as refused:
        Twin(scene(groove), MAP.replace("NAME", name).replace("REST", "start: 0.1, sd: 0.05"))
    (one,) = refused.value.problems
    assert one.cause == f"there is no parameter '{name}'" and why in one.cure
