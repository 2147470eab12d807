"""The laws of friction at four contacts at a time, in lanes: what a step asks of all contacts of a string.

The laws are those of friction.py, which says what their rows are. Where a contact changes its status, which is seldom,
that file's ``status`` is asked for it alone; so are tangents. tests/kernels/strings/test_friction_of_four.py compares
both files, contact by contact. Every law offers

- ``prepare(law, i, last, h, beta, gamma, touch, along_rate, around_rate)`` at the start of an attempt of a step,
- ``may_change(law, i, last, touch, converged)``: a mask of the contacts whose ``status`` is to be asked,
- ``resist(law, i, last, touch)``: the friction force on the pipe along and around, N,
- ``note(law, i, last, touch, along_rate, around_rate)``: the state at which the residual is evaluated, and how fast its
  slip velocities change, m/s^2,
- ``commit(law, i, last, touch)``: the step is accepted; the friction force of the accepted state,
- ``arrest(law, i, last, touch, along, along_rate)``: that force along the hole without the lumps' own inertia, where
  they are held from now on, and a mask of these.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drillstring.groups.friction import HELD, SLIP, STICK, STIFFNESS, Karnopp, Projection, Regularised
from drillstring.groups.friction import prepare as prepare_one
from drillstring.groups.sliding import Sliding
from tautline.kernels.dispatch import by_type
from tautline.kernels.jit import kernel
from tautline.kernels.lanes import (
    LANES,
    any_of,
    equals,
    exp,
    gather,
    lane,
    larger,
    load_fields,
    negated,
    scatter,
    sqrt,
    store_fields,
    where,
    within,
)

NEVER = float(np.inf)
"""What no force is above."""


class Slip(NamedTuple):
    """What a law of friction asks of a contact: normal force N, slip velocity along and around m/s."""

    normal: float
    along: float
    around: float


@kernel(forceinline=True)
def slip_of(touch, k):
    """That of lane k."""
    return Slip(lane(touch.normal, k), lane(touch.along, k), lane(touch.around, k))


# -- projection ------------------------------------------------------------------------------------------------------


@kernel(forceinline=True)
def _prepare_projection(law, i, last, h, beta, gamma, touch, along_rate, around_rate):
    rows = law.rows
    static, kinetic = gather(rows.static, i, last), gather(rows.kinetic, i, last)
    force_a, force_c, _, _ = load_fields(rows.force_a, i, last)
    _, _, _, c = load_fields(rows.nx, i, last)
    sticks = equals(rows.settled, i, last, STICK)
    change(rows.status, i, last, sticks, HELD)
    change(rows.status, i, last, negated(sticks), SLIP)
    for k in range(i, min(i + LANES, last)):
        rows[k].dropped = rows[k].reversed = rows[k].forced = 0
    store_fields(rows.force_a, i, last, force_a, force_c, touch.along, touch.around)
    if gamma > 0.0:
        mass, mass_c, _, links = load_fields(rows.mass, i, last)
        c = (STIFFNESS / gamma) * (mass * beta + links)
        store_fields(rows.mass, i, last, mass, mass_c, beta / gamma, links)
    free = (force_a == 0.0) & (force_c == 0.0)
    x, y = where(free, touch.along, -force_a), where(free, touch.around, -force_c)
    # Of the direction only the sign of its product with the slip is ever asked for.
    store_fields(rows.nx, i, last, x, y, where(sticks, static, kinetic), c)


@kernel(forceinline=True)
def change(array, i, last, mask, value):
    """Set whole numbers of contacts where the mask says yes; nothing is written that stands there already."""
    if any_of(mask & negated(equals(array, i, last, value))):
        chosen = where(mask, 1.0, 0.0)
        for k in range(i, min(i + LANES, last)):
            if lane(chosen, k - i) > 0.0:
                array[k] = value


@kernel(forceinline=True)
def _trial(law, i, last, touch):
    """Force that would hold each contact, turned round, N, its size squared, and the factor of friction."""
    force_a, force_c, _, _ = load_fields(law.rows.force_a, i, last)
    _, _, factor, c = load_fields(law.rows.nx, i, last)
    x, y = c * touch.along - force_a, c * touch.around - force_c
    return x, y, x * x + y * y, factor


@kernel(forceinline=True)
def _at_rest(law, i, last, touch, x, y):
    """Size squared, of the force (x, y) of :func:`_trial` or of that without the lumps' own inertia, the lesser."""
    whole = x * x + y * y
    rate_a, rate_c, seen_a, seen_c = load_fields(law.rows.rate_a, i, last)
    mass, mass_c, ratio, _ = load_fields(law.rows.mass, i, last)
    x = x + mass * (rate_a + ratio * (touch.along - seen_a))
    y = y + mass_c * (rate_c + ratio * (touch.around - seen_c))
    without = x * x + y * y
    return where(whole < without, whole, without)


@kernel(forceinline=True)
def _note_projection(law, i, last, touch, along_rate, around_rate):
    store_fields(law.rows.rate_a, i, last, along_rate, around_rate, touch.along, touch.around)


@kernel(forceinline=True)
def _may_change_projection(law, i, last, touch, converged):
    rows = law.rows
    slips, presses = equals(rows.status, i, last, SLIP), touch.normal > 0.0
    content = presses & equals(rows.status, i, last, STICK)
    if any_of(content):
        x, y, _, factor = _trial(law, i, last, touch)
        limit = factor * touch.normal
        content = content & (_at_rest(law, i, last, touch, x, y) <= limit * limit)
    if any_of(negated(presses)):
        # Of pipe that is clear of the wall nothing is to be done once its direction of slip is forgotten.
        nx, ny, _, _ = load_fields(rows.nx, i, last)
        content = content | (negated(presses) & slips & (nx == 0.0) & (ny == 0.0))
    slides = presses & slips
    if converged:
        _, _, slip_a, slip_c = load_fields(rows.force_a, i, last)
        goes_on = equals(rows.settled, i, last, SLIP) & (touch.along * slip_a + touch.around * slip_c >= 0.0)
        return within(i, last) & negated(content | (slides & goes_on))
    held = presses & equals(rows.status, i, last, HELD)
    if any_of(held):
        change(rows.status, i, last, held, STICK)
    nx, ny, factor, c = load_fields(rows.nx, i, last)
    goes_on = slides & (touch.along * nx + touch.around * ny >= 0.0)
    if any_of(goes_on):
        x, y, square, _ = _trial(law, i, last, touch)
        turned = goes_on & (square > 0.0)
        store_fields(rows.nx, i, last, where(turned, x, nx), where(turned, y, ny), factor, c)
    return within(i, last) & negated(content | held | goes_on)


@kernel(forceinline=True)
def _resist_projection(law, i, last, touch):
    x, y, square, factor = _trial(law, i, last, touch)
    slips = equals(law.rows.status, i, last, SLIP)
    share = where(slips, factor * touch.normal / sqrt(where(square > 0.0, square, 1.0)), 1.0)
    return -share * x, -share * y


@kernel(forceinline=True)
def _commit_projection(law, i, last, touch):
    rows = law.rows
    presses = touch.normal > 0.0
    along, around = _resist_projection(law, i, last, touch)
    along, around = where(presses, along, 0.0), where(presses, around, 0.0)
    slips = negated(presses) | equals(rows.status, i, last, SLIP)
    _, _, slip_a, slip_c = load_fields(rows.force_a, i, last)
    store_fields(rows.force_a, i, last, along, around, slip_a, slip_c)
    change(rows.settled, i, last, slips, SLIP)
    change(rows.settled, i, last, negated(slips), STICK)
    return along, around


@kernel(forceinline=True)
def _arrest_projection(law, i, last, touch, along, along_rate):
    held = within(i, last) & (touch.normal > 0.0) & equals(law.rows.settled, i, last, STICK)
    if any_of(held):
        along = where(held, along - gather(law.rows.mass, i, last) * along_rate, along)
        scatter(law.rows.force_a, i, last, where(touch.normal > 0.0, along, 0.0))
    return along, held


# -- Karnopp ---------------------------------------------------------------------------------------------------------


@kernel
def _prepare_karnopp(law, i, last, h, beta, gamma, touch, along_rate, around_rate):
    for k in range(i, min(i + LANES, last)):
        prepare_one(law, k, h, beta, gamma, slip_of(touch, k - i), lane(along_rate, k - i), lane(around_rate, k - i))


@kernel(forceinline=True)
def _resist_karnopp(law, i, last, touch):
    rows = law.rows
    size = sqrt(touch.along * touch.along + touch.around * touch.around)
    share = gather(rows.kinetic, i, last) * touch.normal / where(size > 0.0, size, 1.0)
    held = gather(rows.held, i, last) == 1
    along = where(held, gather(rows.force_a, i, last), -share * touch.along)
    return along, where(held, gather(rows.force_c, i, last), -share * touch.around)


@kernel(forceinline=True)
def _commit_karnopp(law, i, last, touch):
    along, around = _resist_karnopp(law, i, last, touch)
    presses = touch.normal > 0.0
    along, around = where(presses, along, 0.0), where(presses, around, 0.0)
    scatter(law.rows.settled_a, i, last, along)
    scatter(law.rows.settled_c, i, last, around)
    return along, around


# -- regularised, sliding --------------------------------------------------------------------------------------------


@kernel(forceinline=True)
def _resist_regularised(law, i, last, touch):
    size = sqrt(touch.along * touch.along + touch.around * touch.around)
    static, kinetic = gather(law.static, i, last), gather(law.kinetic, i, last)
    creeps = size < law.slip_velocity
    ratio = static / law.slip_velocity
    if any_of(negated(creeps)):
        fade = exp(-larger(size - law.slip_velocity, 0.0) / law.decay_velocity)
        mu = kinetic + (static - kinetic) * fade
        ratio = where(creeps, ratio, mu / where(creeps, 1.0, size))
    return -ratio * touch.normal * touch.along, -ratio * touch.normal * touch.around


@kernel(forceinline=True)
def _resist_sliding(law, i, last, touch):
    push = gather(law.rows.factor, i, last) * touch.normal
    return push * gather(law.rows.along, i, last), push * gather(law.rows.around, i, last)


@kernel(forceinline=True)
def _commit_as_is(law, i, last, touch):
    return resist(law, i, last, touch)


@kernel(forceinline=True)
def _nothing_to_prepare(law, i, last, h, beta, gamma, touch, along_rate, around_rate):
    return


@kernel(forceinline=True)
def _nothing_to_note(law, i, last, touch, along_rate, around_rate):
    return


@kernel(forceinline=True)
def _never_arrests(law, i, last, touch, along, along_rate):
    return along, touch.normal > NEVER


@kernel(forceinline=True)
def _never_changes(law, i, last, touch, converged):
    return touch.normal > NEVER


prepare = by_type(
    {
        Projection: _prepare_projection, Karnopp: _prepare_karnopp, Regularised: _nothing_to_prepare,
        Sliding: _nothing_to_prepare,
    }
)  # fmt: skip
may_change = by_type(
    {
        Projection: _may_change_projection, Karnopp: _never_changes, Regularised: _never_changes,
        Sliding: _never_changes,
    }
)  # fmt: skip
resist = by_type(
    {
        Projection: _resist_projection, Karnopp: _resist_karnopp, Regularised: _resist_regularised,
        Sliding: _resist_sliding,
    }
)  # fmt: skip
commit = by_type(
    {
        Projection: _commit_projection, Karnopp: _commit_karnopp, Regularised: _commit_as_is, Sliding: _commit_as_is,
    }
)  # fmt: skip
note = by_type(
    {
        Projection: _note_projection, Karnopp: _nothing_to_note, Regularised: _nothing_to_note,
        Sliding: _nothing_to_note,
    }
)  # fmt: skip
arrest = by_type(
    {
        Projection: _arrest_projection, Karnopp: _never_arrests, Regularised: _never_arrests, Sliding: _never_arrests,
    }
)  # fmt: skip
