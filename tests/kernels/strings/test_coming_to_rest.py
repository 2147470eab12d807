"""What has come to rest within a step is held up to its static factor, and let go beyond it."""

import numpy as np
import pytest

from drillstring.groups.contact import Touch
from drillstring.groups.friction import PROJECTED, SLIP, STICK, Projection, status
from tautline.kernels.jit import entry
from tautline.system.records import records

STATIC, KINETIC, NORMAL = 0.5, 0.3, 20.0


@entry
def _ask(law, touch):
    return status(law, 0, touch, True)


@pytest.mark.parametrize(("share", "expected"), [(0.2, STICK), (0.4, STICK), (0.49, STICK), (0.51, SLIP), (0.8, SLIP)])
def test_what_came_to_rest_is_held_up_to_the_static_factor_and_let_go_beyond(share, expected):
    """The force that holds it is that share of the normal force; it slipped at the end of the step before."""
    given = {"static": STATIC, "kinetic": KINETIC, "factor": KINETIC, "force_a": -share * NORMAL, "c": 1.0}
    rows = records(1, PROJECTED, **given)
    rows.settled, rows.status = SLIP, STICK
    changed = _ask(Projection(rows), Touch(1.0, 0.0, 0.1, 0.0, NORMAL, 0.0, 0.0, 1.0))
    assert (int(rows[0].status), changed) == (expected, int(expected == SLIP))


@pytest.mark.parametrize(("share", "expected"), [(0.29, STICK), (0.31, SLIP)])
def test_what_has_stuck_is_held_by_the_factor_of_its_step(share, expected):
    given = {"static": STATIC, "kinetic": KINETIC, "factor": KINETIC, "force_a": -share * NORMAL, "c": 1.0}
    rows = records(1, PROJECTED, **given)
    rows.settled, rows.status = STICK, STICK
    _ask(Projection(rows), Touch(1.0, 0.0, 0.1, 0.0, NORMAL, 0.0, 0.0, 1.0))
    assert int(rows[0].status) == expected


def test_a_contact_that_is_clear_of_the_wall_slips():
    rows = records(1, PROJECTED, static=STATIC, kinetic=KINETIC, factor=STATIC, c=1.0)
    rows.settled, rows.status = STICK, STICK
    assert _ask(Projection(rows), Touch(1.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0, 1.0)) == 1
    assert int(rows[0].status) == SLIP and np.hypot(rows[0].nx, rows[0].ny) == 0.0
