"""Axial force at the ends of elements, and what is judged by it, against closed forms that know of no elements."""

import numpy as np
import pytest
from physics.cables.rope_text import GRAVITY, chain, scene
from references.cables import catenary

import tautline

WEIGHT = GRAVITY
"""Of a bar of one metre and 1 kg/m, N."""
HELD = {"linear": (1, 1, 1, 1), "cubic": (1, 1, 1, 1, 1, 0, 1)}
ALONG = {"linear": (1, 1, 0, 1), "cubic": (1, 1, 0, 1, 1, 0, 1)}
EA = 1.0e4
KINDS = ("linear", "cubic")
NODES = {"linear": "nodes4", "cubic": "nodes7"}


def bar(kind, n, more="", **solver):
    """A bar that hangs from its first node, and swings along itself alone."""
    p = np.linspace(0, 1, n + 1)
    held = {i: ALONG[kind] if i else HELD[kind] for i in range(n + 1)}
    items = chain(np.stack([0 * p, 0 * p, -p], 1), p, held, EA=EA, linear=kind == "linear")
    return scene(items + more, **({"time_step": 0.01, "time_end": 0.02, "start": "static"} | solver))


def dropped(time):
    """Force at the root of a bar whose weight comes at once, N: the sum of its vibrations (speed of sound 100 m/s)."""
    k = 2 * np.arange(400) + 1
    return WEIGHT * (1 - (8 / (np.pi * k) ** 2 * np.cos(np.outer(time, k * np.pi / 2 * np.sqrt(EA)))).sum(axis=1))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("n", [1, 3])
def test_the_largest_axial_force_of_a_hanging_bar_is_its_whole_weight_on_any_mesh(kind, n):
    load = f"  - PointForce: {{id: 9, {NODES[kind]}: [{n}], force: [0, 0, -2.0]}}\n"
    run = tautline.simulate(bar(kind, n, load))
    assert run.headline["axial_force_max"]["value"] == pytest.approx(WEIGHT + 2.0, rel=1e-6)
    assert run.headline["axial_force_min"]["value"] == pytest.approx(2.0, rel=1e-6)


@pytest.mark.parametrize("kind", KINDS)
def test_a_mass_between_elements_jumps_the_force_at_their_ends_and_no_middle_is_needed(kind):
    mass = f"  - PointMass: {{id: 9, {NODES[kind]}: [1], mass: 3.0}}\n"
    force = tautline.simulate(bar(kind, 2, mass))["end_force"][-1]
    below, above = 0.5 * WEIGHT, 0.5 * WEIGHT + 3.0 * GRAVITY
    assert force.tolist() == pytest.approx(np.array([[above + below, above], [below, 0.0]]), abs=1e-5)


@pytest.mark.parametrize(("kind", "worst"), [("linear", 0.05), ("cubic", 0.012)])
def test_in_motion_the_force_at_an_end_follows_the_exact_one_closer_than_any_middle_and_is_none_at_a_free_end(
    kind, worst
):
    off = []
    for n in (4, 16):
        run = tautline.simulate(bar(kind, n, start='"as given"', time_step=2e-5, time_end=0.06, plotpoints=300))
        exact, force = dropped(run["time"]), run["end_force"]
        off.append(np.sqrt(np.mean((force[:, 0, 0] - exact) ** 2)))
        assert off[-1] < 0.7 * np.sqrt(np.mean((run["axial_force"][:, 0] - exact) ** 2))
        assert np.abs(force[1:, -1, 1]).max() < 1e-9
        assert np.abs(force[:, 1:, 0] - force[:, :-1, 1]).max() < 1e-9
    assert off[1] < 0.4 * off[0]
    assert off[1] < worst * 2 * WEIGHT


@pytest.mark.parametrize("linear", [False, True])
def test_the_force_at_the_support_of_a_rope_is_that_of_the_elastic_catenary(linear):
    span, rise, length, n = 100.0, 0.0, 110.0, 20
    x, p = np.linspace(0, 1, n + 1), np.linspace(0, length, n + 1)
    xyz = np.stack([span * x, 0 * x, -4 * np.sqrt(3 / 8 * span * 10.0) * x * (1 - x)], 1)
    pinned = (1, 1, 1, 0, 0, 0, 1)
    items = chain(xyz, p, {0: pinned, n: pinned}, EA=1e5, linear=linear)
    run = tautline.simulate(scene(items, start="static"))
    ends = np.linalg.norm(catenary(span, rise, length, 1e5, GRAVITY, "green").end_forces, axis=1)
    found = run["end_force"][-1]
    assert [found[0, 0], found[-1, 1]] == pytest.approx(ends, rel=2e-3 if linear else 2e-5)
    assert run["axial_force"].max() < 0.99 * ends.max()


@pytest.mark.parametrize("kind", KINDS)
def test_a_limit_on_axial_force_is_judged_at_the_ends_of_elements_too(kind):
    limits = (
        f"limits: [{{output: axial_force, above: {0.9 * WEIGHT}}}, {{output: axial_force, below: 1.0, name: low}}, "
        f"{{output: element 1.axial_force, below: 1.0, name: one}}]\n"
    )
    run = tautline.simulate(limits + bar(kind, 2))
    judged = {one["name"]: (one["passed"], one["value"]) for one in run.limits if one.get("output")}
    assert [passed for passed, _ in judged.values()] == [False, False, False]
    assert [value for _, value in judged.values()] == pytest.approx([WEIGHT, 0.0, 0.0], abs=1e-6)
    assert run["axial_force"].max() < 0.9 * WEIGHT


def test_a_rope_that_bears_no_push_has_none_at_its_slack_ends():
    p = np.linspace(0, 1, 3)
    items = chain(
        np.stack([0 * p, 0 * p, p], 1), p, {0: (1, 1, 1, 1), 2: (1, 1, 1, 1)}, EA=EA, linear=True,
        extra=", compression: false",
    )  # fmt: skip
    run = tautline.simulate(scene(items, start='"as given"', time_end=0.05, time_step=1e-4))
    assert run["end_force"].min() >= 0.0


@pytest.mark.parametrize("kind", KINDS)
def test_a_weight_that_comes_at_once_has_reached_no_section_in_the_first_frame(kind):
    bound = "limits: [{output: axial_force, below: 0.0, name: push}]\n"
    run = tautline.simulate(bound + bar(kind, 4, start='"as given"', time_step=1e-3, time_end=2e-3, massDamp=20.0))
    assert np.abs(run["end_force"][0]).max() == 0.0
    (push,) = (one for one in run.limits if one["name"] == "push")
    assert push["time"] != 0.0 or push["passed"]


@pytest.mark.parametrize("kind", KINDS)
def test_a_bar_that_is_given_at_rest_has_the_forces_of_rest_at_its_ends_in_the_first_frame(kind):
    """Without gravity, stretched between held ends by a force that all sections have."""
    p = np.linspace(0, 1, 4)
    items = chain(
        np.stack([1.01 * p, 0 * p, 0 * p], 1),
        p,
        {0: (1,) * len(HELD[kind]), 3: (1,) * len(HELD[kind])},
        EA=EA,
        linear=kind == "linear",
    )
    run = tautline.simulate(scene(items, gravity=(0, 0, 0), start='"as given"', time_step=1e-3, time_end=2e-3))
    assert np.ptp(run["axial_force"][0]) < 1e-9 * EA
    assert run["end_force"][0] == pytest.approx(np.full((3, 2), run["axial_force"][0, 0]), rel=1e-9)
