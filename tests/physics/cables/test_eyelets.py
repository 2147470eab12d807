"""A rope that turns across all that holds a node of free p is stopped by name, and no other."""

import numpy as np
import pytest
from physics.cables.tied_cables import PINNED, element, model_of, node, run, scene

from tautline.elements.nodal.eyelet import Eyelets
from tautline.integrators.status import Status, StoppedEarly

SOLVERS = [{"type": "G-alpha", "time_step": 1e-3}, {"type": "RK4", "time_step": 4e-4}]


def rate(id, pos0, speed):
    times, speeds = [0, 0.2, 2.2, 2.4, 100], [0, speed, speed, 0, 0]
    return f"Function_VelocityDefined: {{id: {id}, pos0: {pos0}, timeList: {times}, velocityList: {speeds}}}"


def turning(part=1.0, **solver):
    """A rope through a slot that holds it up and down only; its ends are moved from above one another to one height."""
    down, v = (0, 0, -1), part / 2.2
    items = [
        node(0, (0, 0, 1), PINNED, down, (1, 0, 2, 0, 0, 0, 0)),
        node(1, (0, 0, 0), (0, 1, 1, 0, 0, 0, 0), down),
        node(2, (0, 0, -1), PINNED, down, (3, 0, 4, 0, 0, 0, 0)),
        *(element(i, i, i + 1, EA=100) for i in range(2)),
        rate(1, 0, -v), rate(2, 1, -v), rate(3, 0, v), rate(4, -1, v),
    ]  # fmt: skip
    return scene(items, **{"time_end": 4.0} | solver)


@pytest.mark.parametrize("solver", SOLVERS, ids=["implicit", "rk4"])
def test_a_rope_that_turns_across_its_eyelet_is_stopped_as_a_null_motion(solver):
    with pytest.raises(StoppedEarly) as stop:
        run(turning(**solver))
    assert stop.value.status == Status.NULL_MOTION
    assert stop.value.part == "node 1: p"
    slope = stop.value.result["slope"][-1, 1]
    assert abs(slope[2]) / np.linalg.norm(slope) < 0.05
    assert 1.5 < stop.value.time < 4.0


@pytest.mark.parametrize("solver", SOLVERS, ids=["implicit", "rk4"])
def test_one_that_turns_less_far_is_not(solver):
    result = run(turning(0.4, **solver))
    assert result.attributes["status"] == "done"
    assert result.attributes["energy_error"] < 1e-3


def test_only_free_material_is_watched():
    held = [node(0, (0, 0, 0), PINNED), node(1, (1, 0, 0), PINNED), element(0, 0, 1, EA=100)]
    assert not any(isinstance(g, Eyelets) for g in model_of(scene(held)).system.groups)
    assert any(isinstance(g, Eyelets) for g in model_of(turning()).system.groups)
