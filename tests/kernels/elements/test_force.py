"""What explicit methods ask for where nothing is accelerated: the residual without M a."""

import numpy as np
import pytest
from kernels.elements import cable_groups as rope

from tautline.kernels import groups as over
from tautline.kernels.groups import KINDS, link
from tautline.kernels.jit import entry

OF_ITS_OWN = [name for name in rope.KINDS if "force" in KINDS[type(rope.KINDS[name].make())].hooks]


@entry
def _ask(groups, q, v, a, r, f):
    over.residual(groups, 0.0, q, v, a, r)
    over.force(groups, 0.0, q, v, a, f)


def asked(group, q, v, a):
    """Residual and force (2, n) of a group."""
    sums = np.zeros((2, q.size))
    _ask(link((group,), "residual", "force"), q, v, a, *sums)
    return sums


@pytest.mark.parametrize("damped", [True, False])
@pytest.mark.parametrize("name", rope.KINDS)
def test_the_force_is_the_residual_of_what_is_not_accelerated(name, damped):
    kind = rope.KINDS[name]
    state = rope.new_state(kind.node, still=kind.still)
    residual, force = asked(kind.make(damped), state.q, state.v, np.zeros_like(state.a))
    assert np.abs(force).max() > 0.1
    assert rope.close(force, residual, 1e-14)


@pytest.mark.parametrize("name", OF_ITS_OWN)
def test_a_force_of_its_own_does_not_depend_on_accelerations(name):
    kind = rope.KINDS[name]
    state = rope.new_state(kind.node, still=kind.still)
    residual, force = asked(kind.make(), *state)
    assert np.array_equal(force, asked(kind.make(), state.q, state.v, 0.0 * state.a)[1])
    assert not rope.close(force, residual, 1e-3)


def test_kinds_with_a_force_of_their_own_and_without_are_both_among_these():
    assert OF_ITS_OWN == ["inertia", "linear inertia"]
