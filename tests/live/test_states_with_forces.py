"""States of simulations that forces were added to: which of them take one another's."""

from pathlib import Path

import numpy as np
import pytest

import tautline
from tautline.live.errors import SimulationError
from tautline.live.memory import Memory

DATA = Path(__file__).parents[2] / "data"


def upwards(t, q, v):
    return [0.0, 0.0, 100.0]


def sideways(t, q, v):
    return [100.0, 0.0, 0.0]


def with_force(force):
    sim = tautline.Simulation(DATA / "hoist.yaml", keep=False)
    sim.add_force(force, on="payload.position")
    return sim


def test_a_state_is_refused_where_another_force_was_added_to_the_same_places():
    sim = with_force(upwards)
    saved = sim.save()
    sim.copy().restore(saved)
    with pytest.raises(SimulationError, match="other forces or forces in another order"):
        with_force(sideways).restore(saved)


def test_forces_in_another_order_make_another_layout():
    arrays = [("groups.0.f", np.zeros(3)), ("groups.1.f", np.zeros(3))]
    layouts = {Memory(arrays, names).layout for names in (("c", "d"), ("d", "c"), ("c", "c"), ())}
    assert len(layouts) == 4 and Memory(arrays, ("c", "d")).layout in layouts
