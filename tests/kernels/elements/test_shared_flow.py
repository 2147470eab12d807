"""Elements through which material flows at one rate: the row of that rate too, which a drive of a hose answers for."""

import numpy as np
import pytest
from kernels.elements import cable_groups as rope
from kernels.elements.cable_groups import CUBIC, STARTS, ask, close, new_state

from tautline.elements.cubic import MATERIAL
from tautline.elements.shared_flow import SharedFlow, unit_matrices


def shared_flow(damped):
    return SharedFlow(rope._inertias(CUBIC, damped), unit_matrices(), np.zeros((4, 3, 4)), np.zeros((14, 14)))


@pytest.mark.parametrize("damped", [True, False])
@pytest.mark.parametrize("shape", ["anyhow", "folded", "fast flow"])
def test_the_force_on_the_common_rate_of_both_nodes_is_the_sum_of_the_references(shape, damped):
    state = new_state(CUBIC, shape)
    for rates in (state.v, state.a):
        rates[rope.materials(CUBIC)] = rates[rope.materials(CUBIC)[0]]
    expected = np.zeros(state.q.size)
    for element in range(2):
        rows = rope.rows_of(CUBIC, element)
        force = rope.inertial(element, *(x[rows] for x in state), False, damped)
        force[MATERIAL] += force[-1]
        force[-1] = 0.0
        expected[rows] += force
    found = ask(shared_flow(damped), state).residual
    assert found[STARTS[CUBIC][0] + MATERIAL] == pytest.approx(expected[STARTS[CUBIC][0] + MATERIAL], rel=1e-10)
    assert close(found, expected, 1e-10)
