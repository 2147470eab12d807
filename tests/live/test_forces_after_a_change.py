"""The axial force of cables is that of the stiffness and damping with which it was computed, however they were given.

Reference: a scene that has these numbers from the begin.
"""

from __future__ import annotations

import numpy as np
import pytest
from live.swinging_bar import swinging_bar

import tautline
from tautline.twin.estimation.family import Family

GIVEN = {"axial_stiffness": 1e3, "bending_stiffness": 3.0, "damping": 0.05}


def bar(given):
    """A bar that swings about its clamp, with these numbers."""
    solver = {"rho_inf": 0.5, "time_step": 0.004, "time_end": 1.0, "plotpoints": 250}
    return swinging_bar(*given.values(), elements=4, load=7.5, **solver)


def hose(given):
    """A hose with water that falls from a level clamp."""
    EA, EJ, damping = given.values()
    return f"""
title: A hose that falls
hose: {{length: 0.5, elements: 4, axial_stiffness: {EA}, bending_stiffness: {EJ}, mass_per_length: 0.0031316,
  damping: {damping}, root: [0, 0, 0], direction: [1, 0, 0]}}
water: {{mass_per_length: 0.0007854, speed: 2}}
gravity: [0, 0, -9.81]
solver: {{method: generalized-alpha, rho_inf: 0.5, step: 4 ms, end: 1 s}}
output: {{interval: 4 ms}}
"""


def force(sim):
    return np.asarray(sim["axial_force"])


def changed(scene, thing, given, change):
    sim = tautline.Simulation(scene(given))
    for name in change:
        sim.parameters[f"{thing}.{name}"] = change[name]
    return sim


@pytest.mark.parametrize("name", list(GIVEN))
def test_an_element_tells_the_force_of_a_number_that_was_changed_as_of_one_in_the_scene(name):
    change = {name: 2.0 * GIVEN[name]}
    sim, same = changed(bar, "cables", GIVEN, change), tautline.Simulation(bar(GIVEN | change))
    other = tautline.Simulation(bar(GIVEN))
    for one in (sim, same, other):
        one.advance_to(0.3)
    expected = np.asarray(same.result["axial_force"])
    assert np.asarray(sim.result["axial_force"]) == pytest.approx(expected, abs=1e-9)
    assert np.abs(np.asarray(other.result["axial_force"]) - expected).max() > 0.1, "the change matters"
    strain, reference = (
        next(limit["value"] for limit in one.result.attributes["limits"] if limit["name"] == "strain")
        for one in (sim, same)
    )
    assert strain == pytest.approx(reference, rel=1e-9)


def test_the_strain_of_a_rope_is_judged_by_the_axial_stiffness_that_was_given_later():
    given = GIVEN | {"bending_stiffness": 0.0, "damping": 0.0}
    change = {"axial_stiffness": 4e3}
    found = []
    for sim in (changed(bar, "cables", given, change), tautline.Simulation(bar(given | change))):
        sim.advance_to(0.1)
        found.append(next(one["value"] for one in sim.result.attributes["limits"] if one["name"] == "strain"))
    assert found[0] == pytest.approx(found[1], rel=1e-9)


@pytest.mark.parametrize("name", list(GIVEN))
def test_a_hose_with_water_tells_the_force_of_a_number_that_was_changed(name):
    given = {"axial_stiffness": 100.0, "bending_stiffness": 0.004, "damping": 0.01}
    change = {name: 2.0 * given[name]}
    sim, same = changed(hose, "hose", given, change), tautline.Simulation(hose(given | change))
    for one in (sim, same):
        one.advance_to(0.1)
    # What of the corrector counts as solved follows from the numbers of the scene.
    assert force(sim) == pytest.approx(force(same), rel=0.01)


def test_copies_and_restored_states_tell_the_force_of_their_own_bending_stiffness():
    name = "cables.bending_stiffness"
    sim = changed(bar, "cables", GIVEN, {"bending_stiffness": 6.0})
    sim.advance_to(0.2)
    state, expected = sim.save(), force(sim)
    copy, fresh = sim.copy(), tautline.Simulation(bar(GIVEN))
    copy.parameters[name] = 3.0
    assert np.abs(force(copy) - expected).max() > 0.1 and np.array_equal(force(sim), expected)
    for one in (copy, fresh):
        one.restore(state)
        assert one.parameters[name] == 6.0 and force(one) == pytest.approx(expected, abs=1e-12)


def test_each_member_of_a_family_is_read_with_its_own_bending_stiffness():
    name, output = "cables.bending_stiffness", "element 0.axial_force"
    first = tautline.Simulation(bar(GIVEN))
    family = Family([first, first.copy()], [name])
    family.at[:], family.apart[:] = 3.0, 1.0
    family.set_parameters()
    family.advance(0.1, [])
    before = family.frames()
    family.advance(0.2, [])
    one_by_one = [float(sim[output]) for sim in family.simulations]
    (read,) = family.read([output])
    assert read == pytest.approx(one_by_one, abs=1e-12) and abs(read[1] - read[0]) > 0.01
    (many,) = family.read_frames(np.array([before, family.frames()]), [output])
    assert many.shape == (2, 2) and many[1] == pytest.approx(one_by_one, abs=1e-12)
