"""Which rows an iteration takes: those out of balance and a margin, and the residual of all that they can change."""

import numpy as np
import pytest
from physics.wells.strings import shipped

from drillstring.model.build import build
from tautline.integrators.corrector import partial_newton as part
from tautline.integrators.corrector.partial_newton import ASKED, ASKED_END, LEAST_MARGIN, MARGIN, SOLVED, SOLVED_END
from tautline.integrators.corrector.rows import AllRows, rows_of
from tautline.integrators.state import new_state
from tautline.kernels import groups as over
from tautline.kernels.jit import entry
from tautline.kernels.lanes import LANES

LUMPS = 150
TOLERANCE = 1e-9


@entry
def aim(w, dofs, state, right_side, scale, tolerance, tried, slow):
    return part.choose_rows(w, dofs, state, right_side, scale, tolerance, tried, slow)


@entry
def take_all(w, state):
    part.take_all(w, state)


@entry
def residual(groups, q, v, a, r):
    over.residual(groups, 0.0, q, v, a, r)


class Iteration:
    """The J-well in many lumps, a lump in the middle of which is out of balance."""

    def __init__(self, **changes):
        self.system = build(shipped("jwell", model__elements=LUMPS, **changes)).system
        self.state = new_state(self.system)
        self.window = rows_of(self.system, in_parts=True)
        self.band = self.system.bandwidth
        self.right_side = np.zeros(self.system.size)

    def disturb(self, *rows, by=1.0):
        """Let rows be out of balance by so many tolerances."""
        for row in rows:
            self.right_side[row] = by * TOLERANCE * self.system.scale[row]
            self.state.residual[self.system.dofs.free[row]] = self.right_side[row]

    def aim(self, tried=False, slow=False):
        slow = aim(
            self.window, self.system.dofs, self.state, self.right_side, 1.0 / self.system.scale, TOLERANCE, tried, slow
        )
        return tuple(self.window.at[[SOLVED, SOLVED_END, ASKED, ASKED_END]]), slow

    def residual(self):
        r = np.zeros(self.system.q.size)
        residual(self.system.link(("residual",)), self.state.full_q, self.state.full_v, self.state.full_a, r)
        return r


@pytest.mark.parametrize("row", [0, 1, 37, 200, 595, 599])
def test_nothing_outside_the_window_can_change_by_what_is_solved_for(row):
    one = Iteration(bit__lateral="pinned")
    one.disturb(min(row, one.system.size - 1), by=3.0)
    before = one.residual()
    (first, last, *_), _ = one.aim()
    inside = one.residual()
    assert last - first < 0.5 * one.system.size
    asked = slice(*one.window.asked)
    assert np.array_equal(inside[asked], before[asked])
    for row in range(first, last):
        place = one.system.dofs.free[row]
        one.state.full_q[place] += 1e-4
        one.state.full_v[place] += 1e-3
        one.state.full_a[place] += 1e-2
    take_all(one.window, one.state)
    change = one.residual() - before
    assert np.any(change[asked])
    assert not np.any(np.delete(change, np.arange(one.system.q.size)[asked]))


def test_the_rows_out_of_balance_are_taken_with_a_margin_and_their_residual():
    one = Iteration()
    one.disturb(200, 210, by=0.2)
    one.disturb(40, by=0.05)
    margin = LEAST_MARGIN * one.band
    taken, _ = one.aim()
    # Whole blocks of rows: these are solved for together.
    first, last = (200 - margin) // LANES * LANES, -(-(211 + margin) // LANES) * LANES
    assert taken == (first, last, first - 2 * one.band, last + 2 * one.band)
    assert np.count_nonzero(one.right_side) == 3


def test_where_the_rows_at_the_edge_of_a_part_are_left_out_of_balance_twice_the_margin_is_taken():
    one = Iteration()
    one.disturb(200)
    (first, *_), _ = one.aim()
    one.disturb(first)
    (wider, *_), slow = one.aim(tried=True, slow=True)
    assert one.window.at[MARGIN] == 2 * LEAST_MARGIN * one.band and wider == first - one.window.at[MARGIN]
    assert not slow  # it is not the factors' fault


@pytest.mark.parametrize("row", [2, 200, 597], ids=["the upper end", "inside", "the lower end"])
def test_where_rows_fall_slowly_inside_a_part_or_at_an_end_of_the_string_it_is_the_factors_and_the_margin_stays(row):
    one = Iteration()
    one.disturb(row)
    one.aim()
    _, slow = one.aim(tried=True, slow=True)
    assert slow and one.window.at[MARGIN] == LEAST_MARGIN * one.band


def test_a_margin_that_was_too_large_shrinks_again():
    one = Iteration()
    one.disturb(200)
    one.window.at[MARGIN] = 3 + LEAST_MARGIN * one.band
    for _ in range(5):
        take_all(one.window, one.state)
        one.aim()
    assert one.window.at[MARGIN] == LEAST_MARGIN * one.band


def test_rows_all_over_the_string_are_all_taken():
    one = Iteration()
    one.disturb(10, 590)
    n = one.system.size
    assert one.aim() == ((0, n, 0, n), False)
    assert tuple(one.window.asked) == (0, one.system.q.size)


def test_short_strings_and_methods_that_want_it_take_all_rows():
    one = Iteration()
    assert isinstance(rows_of(one.system, in_parts=False), AllRows)
    assert isinstance(rows_of(build(shipped("jwell")).system, in_parts=True), AllRows)
