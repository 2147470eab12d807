"""A body that turns needs a mass, at the start and after its load has dropped: else nothing says how it moves."""

import pytest

import tautline
from crane.application import Crane
from tautline import SceneError

MOMENTS = "inertia: [4, 4, 4]"
SCENE = """\
rope: {mass_per_length: 0.01, axial_stiffness: 8.0e7, damping: 1 ms}
bodies: [{name: load, position: [0, 0, 0], %s}]
path:
  - anchor: {name: top, position: [0, 0, 20]}
  - end: {name: hook, body: load, offset: %s}
mesh: {elements_per_span: 1}
%s
solver: {step: 2 ms, end: 0.1}
output: {interval: 10 ms}
"""
WATER = "water: {surface: 5, density: 1025}"


def scene(body, more="", offset="[0, 0, 0.2]"):
    return tautline.read(SCENE % (body, offset, more))


def remaining(kg):
    return f"mass: 5000, {MOMENTS}, release: {{at: 0.05, remaining: {kg}, inertia: [1, 1, 1]}}"


@pytest.mark.parametrize(
    ("body", "key"),
    [
        (f"mass: 0, {MOMENTS}", "bodies[0].mass = 0"),
        (f"mass: 0, {MOMENTS}, guide: [x, y]", "bodies[0].mass = 0"),
        (f"mass: 0, {MOMENTS}, spring: {{stiffness: [1, 1, 1]}}", "bodies[0].mass = 0"),
        (remaining(0), "bodies[0].release.remaining = 0"),
    ],
)
def test_a_body_that_turns_and_has_no_mass_is_refused_with_what_to_give(body, key):
    with pytest.raises(SceneError) as told:
        scene(body)
    assert f"{key}: is no mass of a body with `inertia`" in str(told.value)
    assert "give the mass of hook and shackle, or remove `inertia`" in str(told.value)


@pytest.mark.parametrize(
    ("body", "more"),
    [
        ("mass: 5000, release: {at: 0.05, remaining: 0}", ""),
        (f"mass: 0, {MOMENTS}, guide: [x, y, z]", ""),
        (f"mass: 0, {MOMENTS}, added_mass: [9, 9, 9]", WATER),
    ],
)
def test_a_point_a_guided_body_and_one_that_moves_water_are_not_refused_and_run(body, more):
    assert tautline.simulate(scene(body, more)).attributes["status"] == "done"


@pytest.mark.parametrize("body", [f"mass: 0, {MOMENTS}, force: [0, 0, -98.1]", remaining(0)])
def test_rope_that_ends_at_the_centre_of_a_body_without_mass_moves_it(body):
    assert tautline.simulate(scene(body, offset="[0, 0, 0]")).attributes["status"] == "done"


def test_a_release_from_a_body_without_mass_asks_for_the_mass():
    with pytest.raises(SceneError, match="mass = 0: is nothing that a release can drop"):
        scene("mass: 0, release: {at: 0.05, remaining: 0}")


def test_the_cure_of_a_load_that_grows_is_not_refused_when_it_is_followed():
    with pytest.raises(SceneError, match="such as the mass of hook and shackle"):
        scene(remaining(6000))
    with pytest.raises(SceneError, match="such as 0"):
        scene("mass: 5000, release: {at: 0.05, remaining: 6000}")
    scene("mass: 5000, release: {at: 0.05, remaining: 0}")


@pytest.mark.parametrize(("kg", "warns"), [(1e-3, True), (4e-3, True), (6e-3, False), (50, False)])
def test_what_swings_a_thousand_times_as_fast_as_the_whole_load_is_warned_of(kg, warns):
    """sqrt(5000/0.005) = 1000."""
    told = [one for one in Crane().warnings(scene(remaining(kg))) if one.where == "bodies[0].release.remaining"]
    assert bool(told) is warns
    if warns:
        assert f"{kg:g} kg remain of 5000 kg of load" in told[0].text
