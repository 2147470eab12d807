"""An equilibrium at the start is taken only where it is stable."""

import numpy as np
import pytest
from physics.rope_text import PINNED, chain, model_of

from tautline.integrators.equilibrium import find_equilibrium
from tautline.integrators.stability import count_negative
from tautline.integrators.state import new_state
from tautline.integrators.status import Status, StoppedEarly
from tautline.simulation import simulate


def straight(span, length, n=4):
    """Linear elements of EA = 1e6 N without weight between two pins: taut or pressed."""
    xyz = np.outer(np.linspace(0.0, span, n + 1), [1.0, 0.0, 0.0])
    text = chain(xyz, np.linspace(0.0, length, n + 1), {0: PINNED, n: PINNED}, linear=True, EA=1e6)
    return text


@pytest.mark.parametrize("span, negative", [(8.1, 0), (7.9, 6)], ids=["taut", "pressed"])
def test_a_pressed_rope_has_a_negative_pivot_for_each_sideways_motion_of_its_inner_nodes(span, negative):
    model = model_of(straight(span, 8.0), gravity=(0.0, 0.0, 0.0))
    state = new_state(model.system)
    find_equilibrium(model.system, state, model.step_limit)
    assert count_negative(model.system, state).negative == negative


def test_a_run_that_begins_as_a_straight_strut_of_rope_is_refused_by_name():
    with pytest.raises(StoppedEarly) as stop:
        simulate(model_of(straight(7.9, 8.0), gravity=(0.0, 0.0, 0.0), start="static"))
    assert stop.value.status is Status.NO_EQUILIBRIUM
    assert "6 negative pivots" in stop.value.sentence and "buckling" in stop.value.sentence


def test_a_taut_rope_starts_and_says_that_nothing_is_unstable():
    result = simulate(model_of(straight(8.1, 8.0), gravity=(0.0, 0.0, 0.0), start="static"))
    assert result.attributes["start_negative_pivots"] == 0
