"""Laws of friction at a contact: exact Coulomb by projection, Karnopp's, and a regularised one.

Each law gives the friction force ``lambda`` (along the hole, around it) on the pipe at a contact, as a function of the
normal force N and the slip velocity w, with its derivatives. One type for each law; a contact's code is compiled for
the one that the scene has. A fourth law, that of a string that slides in a given direction, stands in sliding.py. Every
law offers

- ``prepare(law, i, h, beta, gamma, touch, along_rate, around_rate)`` at the start of an attempt of a step,
- ``status(law, i, touch, converged)``: change status where it must; returns 1 if it did,
- ``act(law, i, touch)``: (lambda_a, lambda_c, aa, ac, ca, cc, an, cn), the last six d lambda / d (w_a, w_c, N),
- ``commit(law, i, touch)``: the step is accepted,
- ``force_now(law, i, touch)``: lambda of the accepted state.

friction_of_four.py has the same laws for four contacts at a time; tests/kernels/strings/test_friction_of_four.py
compares both, contact by contact.
"""

from __future__ import annotations

from math import exp, sqrt
from typing import NamedTuple

import numpy as np

from drillstring.groups.sliding import (
    Sliding,
    act_sliding,
    commit_sliding,
    force_sliding,
    prepare_sliding,
    status_sliding,
)
from tautline.kernels.dispatch import by_type
from tautline.kernels.jit import kernel

SLIP, STICK, FORCED, HELD = range(4)
"""Statuses of a contact: FORCED is stuck and not yet tested, because no linear solve has seen it stuck. HELD is stuck
since an earlier step: its force comes from a slip so small that what is predicted for a step says nothing of it."""
STIFFNESS = 3.0e5
"""Ratio of the projection's stiffness to the lump's own (docs/lumped_string.md): stuck lumps creep by one over it,
on the J-well at 10 ms by less than 1e-8 m/s."""


PROJECTED = np.dtype(
    [
        (name, np.float64)
        for name in (
            "force_a", "force_c", "slip_a", "slip_c", "nx", "ny", "factor", "c", "rate_a", "rate_c", "seen_a", "seen_c",
            "mass", "mass_c", "ratio", "links", "static", "kinetic",
        )
    ]
    + [(name, np.int64) for name in ("settled", "status", "dropped", "reversed", "forced")]
)  # fmt: skip
"""Exact Coulomb friction at a contact: static and kinetic factor; lump's mass kg and link stiffness N/m; force N and
slip m/s at the last accepted step; of the step under way: direction, factor, stiffness c N s/m; then the status settled
and under way, whether the factor dropped (of what came to rest: whether rest was refused) or the slip reversed in it,
and how often it was forced to stick. ``mass`` and ``mass_c`` kg are what a slip along and around sets in motion,
``rate_a`` and ``rate_c`` m/s^2 the slip's rates where it was ``seen_a``, ``seen_c`` m/s, and ``ratio`` 1/s of the
change of a rate to that of the slip within a step. Fours of them, in this order, are read and written together."""

BANDED = np.dtype(
    [
        (name, np.float64)
        for name in ("static", "kinetic", "mass_a", "mass_c", "force_a", "force_c", "settled_a", "settled_c")
    ]
    + [("held", np.int64)]
)
"""Karnopp friction at a contact: factors; mass that a slip along and around sets in motion kg; the force held through
the step under way where ``held`` is 1, and that of the last accepted step, N."""


class Projection(NamedTuple):
    """Exact Coulomb friction by return mapping: ``rows`` (n,) of ``PROJECTED``."""

    rows: np.recarray


class Karnopp(NamedTuple):
    """Karnopp's dead band ``band`` m/s, inside which friction balances what acts on the lump; rows of ``BANDED``."""

    rows: np.recarray
    band: float


class Regularised(NamedTuple):
    """Friction as a smooth function of the slip speed: static up to ``slip_velocity``, then falling to kinetic.

    The factors are (n,), one to a contact; the speeds m/s.
    """

    static: np.ndarray
    kinetic: np.ndarray
    slip_velocity: float
    decay_velocity: float


@kernel
def slip_speed(touch):
    """Size of the slip velocity, m/s."""
    return sqrt(touch.along * touch.along + touch.around * touch.around)


# -- projection ------------------------------------------------------------------------------------------------------


@kernel
def _prepare_projection(law, i, h, beta, gamma, touch, along_rate, around_rate):
    f = law.rows[i]
    f.status = HELD if f.settled == STICK else SLIP
    f.factor = f.static if f.settled == STICK else f.kinetic
    f.dropped = 0
    f.reversed = 0
    f.forced = 0
    f.slip_a = touch.along
    f.slip_c = touch.around
    f.ratio = 0.0
    if gamma > 0.0:
        f.c = STIFFNESS * (f.mass * beta + f.links) / gamma
        f.ratio = beta / gamma
    x, y = -f.force_a, -f.force_c
    size = sqrt(x * x + y * y)
    if size == 0.0:
        x, y = touch.along, touch.around
        size = sqrt(x * x + y * y)
    f.nx = x / size if size > 0.0 else 0.0
    f.ny = y / size if size > 0.0 else 0.0


@kernel
def _force_at_rest(f, touch):
    """Less the force that holds the lump, or would hold it without any acceleration: the lesser of both, N (2,).

    The force that brings it to rest within a step holds a multiple of what is needed, and a method with numerical
    dissipation goes on to swing about that, from step to step, whatever their length. Where the force of the step is
    the lesser it counts: a contact that can stick in this step, and were let go, might find no state at all.
    """
    held_x = f.c * touch.along - f.force_a
    held_y = f.c * touch.around - f.force_c
    x = held_x + f.mass * (f.rate_a + f.ratio * (touch.along - f.seen_a))
    y = held_y + f.mass_c * (f.rate_c + f.ratio * (touch.around - f.seen_c))
    if held_x * held_x + held_y * held_y < x * x + y * y:
        return held_x, held_y
    return x, y


@kernel
def _status_projection(law, i, touch, converged):
    f = law.rows[i]
    if touch.normal <= 0.0:
        changed = f.status != SLIP
        f.status = SLIP
        f.nx = 0.0
        f.ny = 0.0
        return 1 if changed else 0
    if converged:
        return _settle_events(law, i, touch)
    if f.status == HELD:
        # The first test of a step sees what is predicted.
        f.status = STICK
        return 0
    x, y = _force_at_rest(f, touch)
    size = sqrt(x * x + y * y)
    if f.status == SLIP:
        if touch.along * f.nx + touch.around * f.ny < 0.0:
            # Never from slip one way straight to slip the other way.
            f.status = FORCED
            f.forced += 1
            return 1
        # What goes on slipping is resisted against the force of the step, and may turn no other way.
        x, y = f.c * touch.along - f.force_a, f.c * touch.around - f.force_c
        size = sqrt(x * x + y * y)
    elif size <= f.factor * touch.normal:
        f.status = STICK
        return 0
    elif f.status == STICK or f.forced < 2:
        f.status = SLIP
        f.nx = x / size
        f.ny = y / size
        return 1
    # A lump that rolls around the hole turns within an iteration, and the slip that this leaves is no sign that it
    # slips: forced for a second time it sticks until the iteration has converged.
    if size > 0.0:
        f.nx = x / size
        f.ny = y / size
    return 0


@kernel
def _settle_events(law, i, touch):
    """Changes that wait for a converged state, each once a step: the factor drops, or slip has reversed.

    What sticks is tested as well: where the prediction was the solution nothing else has.
    """
    f = law.rows[i]
    if f.status != SLIP:
        x, y = _force_at_rest(f, touch)
        size = sqrt(x * x + y * y)
        limit = f.factor * touch.normal
        if f.settled == SLIP:
            # It has come to rest within the step, and static friction may hold it. Refused twice it would circle.
            limit = f.static * touch.normal
        if size <= limit or (f.settled == SLIP and f.dropped > 0):
            f.status = STICK
            return 0
        if f.settled == SLIP:
            f.dropped = 1
        f.status = SLIP
        f.nx = x / size
        f.ny = y / size
        return 1
    if f.settled == STICK and f.dropped == 0:
        f.dropped = 1
        f.factor = f.kinetic
        return 1 if f.kinetic != f.static else 0
    reversed_slip = touch.along * f.slip_a + touch.around * f.slip_c < 0.0
    if f.settled == SLIP and reversed_slip and f.reversed == 0:
        f.reversed = 1
        f.factor = f.static
        f.status = FORCED
        f.forced += 1
        return 1
    return 0


@kernel
def _act_projection(law, i, touch):
    f = law.rows[i]
    c = f.c
    x = c * touch.along - f.force_a
    y = c * touch.around - f.force_c
    if f.status != SLIP:
        return -x, -y, -c, 0.0, 0.0, -c, 0.0, 0.0
    size = sqrt(x * x + y * y)
    if size == 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    nx, ny = x / size, y / size
    mu = f.factor
    turn = mu * touch.normal * c / size
    return (
        -mu * touch.normal * nx, -mu * touch.normal * ny,
        -turn * ny * ny, turn * nx * ny, turn * nx * ny, -turn * nx * nx, -mu * nx, -mu * ny,
    )  # fmt: skip


@kernel
def _commit_projection(law, i, touch):
    f = law.rows[i]
    if touch.normal <= 0.0:
        f.force_a = 0.0
        f.force_c = 0.0
        f.settled = SLIP
        return
    along, around = act(law, i, touch)[0:2]
    f.force_a = along
    f.force_c = around
    f.settled = SLIP if f.status == SLIP else STICK


@kernel
def _force_projection(law, i, touch):
    f = law.rows[i]
    return f.force_a, f.force_c


# -- Karnopp ---------------------------------------------------------------------------------------------------------


@kernel
def _prepare_karnopp(law, i, h, beta, gamma, touch, along_rate, around_rate):
    """Hold the lump, if friction can: the force that stops it within the step, from what acted on it at its start.

    The dead band is at least the speed that kinetic friction takes away in one step; else a step jumps across it.
    """
    f = law.rows[i]
    band = max(law.band, f.kinetic * touch.normal * h / min(f.mass_a, f.mass_c))
    f.held = 0
    if touch.normal > 0.0 and slip_speed(touch) < band:
        x = f.settled_a - f.mass_a * (along_rate + touch.along / h)
        y = f.settled_c - f.mass_c * (around_rate + touch.around / h)
        size = sqrt(x * x + y * y)
        limit = f.static * touch.normal
        if size > limit:
            x, y = x * f.kinetic * touch.normal / size, y * f.kinetic * touch.normal / size
        f.force_a, f.force_c = x, y
        f.held = 1


@kernel
def _act_karnopp(law, i, touch):
    f = law.rows[i]
    if f.held == 1:
        return f.force_a, f.force_c, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    size = slip_speed(touch)
    if size == 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    nx, ny = touch.along / size, touch.around / size
    mu = f.kinetic
    turn = mu * touch.normal / size
    return (
        -mu * touch.normal * nx, -mu * touch.normal * ny,
        -turn * ny * ny, turn * nx * ny, turn * nx * ny, -turn * nx * nx, -mu * nx, -mu * ny,
    )  # fmt: skip


@kernel
def _commit_karnopp(law, i, touch):
    f = law.rows[i]
    along, around = act(law, i, touch)[0:2]
    f.settled_a = along if touch.normal > 0.0 else 0.0
    f.settled_c = around if touch.normal > 0.0 else 0.0


@kernel
def _force_karnopp(law, i, touch):
    f = law.rows[i]
    return f.settled_a, f.settled_c


# -- regularised -----------------------------------------------------------------------------------------------------


@kernel
def _act_regularised(law, i, touch):
    size = slip_speed(touch)
    excess = law.static[i] - law.kinetic[i]
    if size < law.slip_velocity:
        ratio = law.static[i] / law.slip_velocity
        slope = 0.0
    else:
        fade = exp(-(size - law.slip_velocity) / law.decay_velocity)
        mu = law.kinetic[i] + excess * fade
        ratio = mu / size
        slope = (-excess * fade / law.decay_velocity - ratio) / size**2
    x, y, n = touch.along, touch.around, touch.normal
    return (
        -ratio * n * x, -ratio * n * y,
        -n * (ratio + slope * x * x), -n * slope * x * y, -n * slope * x * y, -n * (ratio + slope * y * y),
        -ratio * x, -ratio * y,
    )  # fmt: skip


@kernel
def _force_by_act(law, i, touch):
    return act(law, i, touch)[0:2]


@kernel
def _nothing_to_prepare(law, i, h, beta, gamma, touch, along_rate, around_rate):
    return


@kernel
def _never_changes(law, i, touch, converged):
    return 0


@kernel
def _nothing_to_commit(law, i, touch):
    return


prepare = by_type(
    {
        Projection: _prepare_projection, Karnopp: _prepare_karnopp, Regularised: _nothing_to_prepare,
        Sliding: prepare_sliding,
    }
)  # fmt: skip
status = by_type(
    {Projection: _status_projection, Karnopp: _never_changes, Regularised: _never_changes, Sliding: status_sliding}
)
act = by_type({Projection: _act_projection, Karnopp: _act_karnopp, Regularised: _act_regularised, Sliding: act_sliding})
commit = by_type(
    {
        Projection: _commit_projection, Karnopp: _commit_karnopp, Regularised: _nothing_to_commit,
        Sliding: commit_sliding,
    }
)  # fmt: skip
force_now = by_type(
    {Projection: _force_projection, Karnopp: _force_karnopp, Regularised: _force_by_act, Sliding: force_sliding}
)
