"""Contacts that begin or end to slip one after the other, within one step, do not use up the iterations of a step."""

from math import radians, sin, sqrt
from types import SimpleNamespace

import numpy as np
import pytest
from physics.wells.strings import COLLAR, DENSITY, GRAVITY, E, area, straight_hole

from drillstring.model.build import build
from tautline.integrators.corrector import newton
from tautline.integrators.status import StoppedEarly
from tautline.kernels.changes import new_changed, note_change
from tautline.kernels.jit import entry
from tautline.simulation import simulate

LENGTH, FRICTION, RAISED, INCLINATION = 900.0, 0.3, 0.02, radians(60.0)


def run(iterations):
    """An inclined string that a block pulls up and then holds, with structural damping that spreads each change."""
    scene = straight_hole(
        INCLINATION, LENGTH, 60, 0.2032, FRICTION,
        damping={"structural": 0.05},
        top={"block": {"table": {"time": [0.0, 3.0, 8.0], "value": [0.0, -RAISED, -RAISED]}}},
        solver={
            "method": "generalized-alpha", "rho_inf": 0.3, "step": 0.01, "end": 3.4, "max_iterations": iterations,
        },
        output={"interval": 0.2},
    )  # fmt: skip
    return simulate(build(scene))


@pytest.fixture(scope="module")
def found():
    return run(4)


def test_a_chain_of_contacts_longer_than_the_iterations_of_a_step_is_solved_without_halving_it(found):
    assert found.attributes["halvings"] == 0
    assert float(found["time"][-1]) == pytest.approx(3.4)


def test_a_pull_raises_the_hook_load_by_that_of_the_length_that_slips(found):
    """A string that rested without friction slips over l where the block rises by q l^2 / 2 EA, at a load of q l."""
    per_length = FRICTION * DENSITY * area(*COLLAR) * GRAVITY * sin(INCLINATION)
    expected = sqrt(2.0 * E * area(*COLLAR) * per_length * RAISED)
    assert expected / per_length < LENGTH
    load = np.asarray(found["hook_load"])
    assert load[int(3.0 / 0.2)] - load[0] == pytest.approx(expected, rel=0.03)


def test_a_run_that_stops_while_contacts_change_names_the_limit_of_iterations():
    with pytest.raises(StoppedEarly, match=r"after 1 iteration it still .*solver\.max_iterations"):
        run(1)


def told(changed, last, free, most):
    """What is advised where laws changed last in an iteration, of which some did not count."""
    c = SimpleNamespace(changed=np.array([0, changed, 0, 0, 0]), chain=np.zeros(6, int), max_iterations=most)
    c.chain[newton.SINCE], c.chain[newton.FREE] = last, free
    return newton.advice(SimpleNamespace(corrector=c), newton.NOT_CONVERGED)


@pytest.mark.parametrize(
    ("last", "free", "most", "words"),
    [
        (24, 0, 25, "after 25 iterations it still changed"), (34, 10, 25, "after 25 iterations it still changed"),
        # Statuses were found, and three iterations were left for what follows from them: as in data/tripping.yaml.
        (2, 0, 5, "5 iterations were too few once"), (8, 6, 5, "5 iterations were too few once"),
        # Twenty iterations of the same statuses: what lacks is no iteration.
        (5, 0, 25, ""),
    ],
)  # fmt: skip
def test_more_iterations_are_advised_where_few_were_left_after_the_last_change(last, free, most, words):
    found = told(1, last, free, most)
    assert found.startswith(words) and ("solver.max_iterations may help" in found if words else found == "")
    assert told(0, last, free, most) == ""


@entry
def _follow(chain, changed, iteration):
    newton._follow_chain(chain, changed, iteration)


@pytest.mark.parametrize(
    ("places", "free"),
    [
        ([1, 2, 3, 4, 5], 3),  # the first step of a chain tells its way, and counts
        ([5, 4, 3, 2], 2),
        ([1, 2, 1, 2, 1, 2], 0),  # two statuses that chase each other
        ([1, 2, 3, 1, 2, 3, 1, 2, 3], 3),  # a round of three: each turn counts
        ([7, 7, 7, 7], 0),
        ([(1, 9), (2, 8), (3, 7), (4, 6)], 2),  # two chains that run towards each other
        ([(1, 9), (2, 8), (1, 9), (2, 8)], 0),
    ],
)
def test_changes_that_go_on_along_a_string_are_free_and_those_that_come_back_count(places, free):
    chain = np.zeros(6, np.int64)
    for iteration, place in enumerate(places):
        changed = new_changed()
        for each in place if isinstance(place, tuple) else (place,):
            note_change.py_func(changed, 4 * each, 4)
        _follow(chain, changed, iteration)
    assert chain[newton.FREE] == free
