"""Full and reduced unknowns: what each degree of freedom of the scene depends on.

Groups write into full vectors and know nothing of constraints. ``Dofs`` holds, for each full degree of freedom, the
reduced unknowns it depends on and their factors: none where it is fixed or prescribed, one with factor 1 where it is
free or shared, several where it is coupled.
"""

from __future__ import annotations

from bisect import bisect_right
from typing import NamedTuple

import numpy as np

from tautline.kernels.jit import entry, kernel, stands_for
from tautline.kernels.lanes import load, store
from tautline.kernels.matrix import add_at, have_cleared
from tautline.kernels.memory import form_of
from tautline.kernels.moving_frame import AXES, ENTRIES
from tautline.kernels.numba_registration import is_array
from tautline.kernels.separate import separate
from tautline.kernels.time_function import FUNCTIONS, evaluate

HELD, TIED = -1, -2
"""Marks in ``Dofs.number`` of degrees of freedom that are not simply one unknown."""


class Dofs(NamedTuple):
    """The map from n reduced unknowns to the full degrees of freedom.

    ``unknown[start[i]:start[i + 1]]`` (n,) and ``factor[...]`` are the masters of full degree of freedom i;
    ``number[i]`` is its only free master where that has factor 1, ``HELD`` where it has none and ``TIED`` otherwise;
    ``free`` (n,) is the full degree of freedom that each unknown is, and ``tied`` lists those with masters;
    a master that is held stands in ``unknown`` as -1 less its full number, and ``carried`` lists what has such masters;
    ``held`` lists those that are fixed (``motion`` -1) or follow a function of time, and ``offset`` is added to it;
    ``driven`` says which of ``held`` follow one. ``flowing`` lists held and tied ones whose rate counts at rest:
    material that flows steadily past nodes that stand still. ``runs`` is `runs_of` of ``free``.
    """

    start: np.ndarray
    unknown: np.ndarray
    factor: np.ndarray
    number: np.ndarray
    held: np.ndarray
    motion: np.ndarray
    offset: np.ndarray
    driven: np.ndarray
    carried: np.ndarray
    free: np.ndarray
    tied: np.ndarray
    flowing: np.ndarray
    runs: np.ndarray


LONG = 8
"""Unknowns of a series of runs, in the mean, from which on series are worth going through one by one."""
RUN = 6
"""Numbers that tell a series of runs."""
UNKNOWNS, PLACES, COUNT, REPEATS = 0, 2, 4, 5
"""Where among them stand the first unknown, and behind it how far apart the first ones of two runs are; the same of the
degrees of freedom; how many a run has; and how many runs there are."""


def runs_of(free: np.ndarray) -> np.ndarray:
    """Unknowns and degrees of freedom that follow one another side by side, in series of runs of one length (6 m,).

    A rope whose nodes hold their material has six of seven degrees of freedom free, again and again. None where series
    are short: then each unknown is looked up.
    """
    starts = np.flatnonzero(np.diff(free, prepend=-2) != 1)
    counts, places = np.diff(starts, append=free.size), free[starts]
    apart = np.diff(places)
    # Runs behind which another length begins, or another distance.
    others = (np.diff(counts) != 0) | (np.diff(apart, prepend=apart[:1]) != 0)
    breaks = [*np.flatnonzero(others).tolist(), starts.size - 1]
    series, i = [], 0
    while i < starts.size and len(series) * LONG <= free.size:
        alike = i + 1 < starts.size and counts[i] == counts[i + 1]
        last = breaks[bisect_right(breaks, i)] if alike else i
        series.append((starts[i], counts[i], places[i], apart[i] if alike else 0, counts[i], last - i + 1))
        i = last + 1
    is_worth_while = len(series) * LONG <= free.size
    return np.array(series if is_worth_while else [], dtype=np.int64).ravel()


DOFS = form_of(Dofs(*(np.zeros(0, float if name in ("factor", "offset") else np.int64) for name in Dofs._fields)))
"""The type of :class:`Dofs` in compiled code."""
VECTOR = form_of(np.zeros(0))
STATES, NUMBERS = form_of(np.zeros((0, 0))), form_of(np.zeros(0, np.int64))


@kernel(forceinline=True)
def prescribe(dofs, functions, t, q, v, a):
    """Set the degrees of freedom that follow a function of time in the full vectors; what is fixed stays as it is."""
    for k in dofs.driven:
        i = dofs.held[k]
        value, rate, second = evaluate(functions, dofs.motion[k], t)
        q[i] = dofs.offset[k] + value
        v[i] = rate
        a[i] = second


BENT, STRICT, LARGE, ROUNDED, STANDS = 0.055, 0.005, 0.02, 1e-6, 1e-10
"""What accelerations at the ends of steps may leave of a change of speed, over the step and the accelerations nearby,
before a function bends; the same where steps differ, of which one does not make up for another, and where it is smooth
within the step; and over the speeds, and the largest speed so far, below which that is rounding.

The mean of both ends leaves 0.033 of a sine that takes ten steps in a period, a cubic 0.05 of one that takes five.
"""
CALM = 4
"""Steps that accelerations at their ends show well, behind which a motion that has bent is at rest again."""
BESIDE = 1e-6
"""How far beside an instant, over a step, both sides of a corner are seen."""
GAUSS = 0.5 - 0.5 / 3.0**0.5
"""Where in a step the first of two points stands whose mean integrates a cubic."""
BEFORE, BEGIN, LAGGED, BENDS, SPEED, LOST, QUIET, AUXILIARY, DEBT, UNREST, FASTEST, CHANGE, SHIFT, OWED, SCALE = range(
    15
)
"""Rows of what is known of what is driven. In a step: their accelerations at its start, as they were and as they count,
and the auxiliary one there; 1 or `OWES` where it is pushed, the speed at its start, what accelerations at both ends
leave of the change of speed, and 1 where that is next to nothing. That speed is kept, not asked for again: where a step
ends and the next begins, times differ by rounding, and a corner may lie between. From step to step: the auxiliary
acceleration of eq. 2.86, by how much the change of speed is more than all steps have made of it, how many calm ones
have to follow, the largest speed so far, and the largest of late of a step's length times its acceleration. Last, what
a step leaves as it is shorter or longer than the one before, what all of them have left since the last push, and the
change of speed beside which something counts in the step."""
KNOWN = 15
"""How many rows these are."""
OWES = 2.0
"""What stands for a push that is not one of many: nothing bends, but steps before have left too much."""
FADES = 0.99
"""What is left of that one step later."""


@kernel(forceinline=True)
def prescribe_end(dofs, functions, t, h, equal, ratio, late, known, q, v, a):
    """Set what follows a function of time to where it is at t, the end of a step of length h; whether any bends in it.

    The vectors hold the start of the step; ``equal`` says whether steps are as long as each other as a rule, and
    ``ratio`` how long this one is over the one before. Steps make more of a change of speed than means of the
    accelerations at their ends do, by ``late`` times the length and what the auxiliary acceleration is behind.

    Between its ends a function may jump in speed, or change it within less time than the step takes: a valve shuts, a
    table has a corner. The accelerations at the ends do not show that, and what is carried along would never feel its
    push, or ten times of it. All steps of one motion are pushed, or none: of a smooth one each makes too little of the
    change or too much, which is nothing in the end, and a push of some of them would stay. The numbers that place a
    frame are one motion. ``known`` (15, n_full) takes what is seen, see `FASTEST`.
    """
    bends = False
    places = functions.frames.parent.size > 0
    if places:
        _scales_of_frames(dofs, functions, t, h, known, a)
    for k in dofs.driven:
        i, motion = dofs.held[k], dofs.motion[k]
        value, rate, second = evaluate(functions, motion, t)
        left = rate - v[i] - 0.5 * h * (a[i] + second)
        known[FASTEST, i] = max(known[FASTEST, i], abs(rate))
        scale = known[SCALE, i] if functions.entry[motion] >= 0 else h * max(abs(a[i]), abs(second))
        fast = max(ROUNDED * max(abs(v[i]), abs(rate)), STANDS * known[FASTEST, i])
        bent, owes = False, False
        if known[UNREST, i] > 0.0:
            bent = max(abs(left), scale) > fast
        elif abs(left) > (BENT if equal else STRICT) * scale and abs(left) > fast:
            if equal:
                bent = _bends(functions, motion, t, h, v[i], a[i])
            else:
                bent = abs(left) > LARGE * scale or _bends_within(functions, motion, t, h, scale, v[i], a[i])
        swings = h * (late * (a[i] - known[LAGGED, i]) + (second - a[i]) / 12.0)
        known[SHIFT, i] = (1.0 - 1.0 / (ratio * ratio)) * swings
        if not bent and known[UNREST, i] == 0.0 and (equal or abs(left) <= max(STRICT * scale, fast)):
            # Equal steps leave a twelfth of what the acceleration changes by, which swings with it. Of steps that are
            # long and short in phase with a swing more and more stays.
            owed = known[OWED, i] + known[SHIFT, i] if equal else known[DEBT, i] + left + swings
            bent = owes = abs(owed) > max(LARGE * max(scale, known[CHANGE, i]), fast)
        known[LOST, i], known[BENDS, i] = left, OWES if owes else 1.0 if bent else 0.0
        known[QUIET, i] = 1.0 if abs(left) <= max(STRICT * scale, fast) else 0.0
        bends = bends or bent
        q[i] = dofs.offset[k] + value
        v[i] = rate
        a[i] = second
    if bends and places:
        _push_frames_whole(dofs, functions, known)
    return bends


@kernel(forceinline=True)
def _motion_to(dofs, functions, first):
    """Where, among what is driven, the motion ends that begins at ``first``: a number alone, or those of one frame."""
    last = first + 1
    frame = functions.entry[dofs.motion[dofs.driven[first]]]
    while frame >= 0 and last < dofs.driven.size:
        other = functions.entry[dofs.motion[dofs.driven[last]]]
        if other < 0 or other // ENTRIES != frame // ENTRIES:
            break
        last += 1
    return last


@kernel(forceinline=True)
def _turns(functions, motion):
    """Whether a function is one of the nine numbers that turn a frame, and none of the three of its pivot."""
    return functions.entry[motion] % ENTRIES >= AXES


@kernel
def _scales_of_frames(dofs, functions, t, h, known, a):
    """Change of speed beside which something counts in the step to t: the largest of a frame's pivot, or of its turn.

    What rides on a frame follows both. One number alone has no acceleration for a moment now and then, and would be
    pushed without the others.
    """
    first = 0
    while first < dofs.driven.size:
        last = _motion_to(dofs, functions, first)
        if functions.entry[dofs.motion[dofs.driven[first]]] >= 0:
            pivot, turn = 0.0, 0.0
            for k in dofs.driven[first:last]:
                i, motion = dofs.held[k], dofs.motion[k]
                change = h * max(abs(a[i]), abs(evaluate(functions, motion, t)[2]))
                if _turns(functions, motion):
                    turn = max(turn, change)
                else:
                    pivot = max(pivot, change)
            for k in dofs.driven[first:last]:
                known[SCALE, dofs.held[k]] = turn if _turns(functions, dofs.motion[k]) else pivot
        first = last


@kernel
def _push_frames_whole(dofs, functions, known):
    """Push all numbers of a frame of which one bends, and as long as the one that takes longest to be calm."""
    first = 0
    while first < dofs.driven.size:
        last = _motion_to(dofs, functions, first)
        bends, bent, quiet, unrest = 0.0, False, 1.0, 0.0
        for k in dofs.driven[first:last]:
            i = dofs.held[k]
            bends, bent = max(bends, known[BENDS, i]), bent or known[BENDS, i] == 1.0
            quiet, unrest = min(quiet, known[QUIET, i]), max(unrest, known[UNREST, i])
        if bends > 0.0:
            for k in dofs.driven[first:last]:
                i = dofs.held[k]
                known[BENDS, i] = 1.0 if bent else bends
                known[QUIET, i], known[UNREST, i] = quiet, unrest
        first = last


@kernel(forceinline=True)
def book_speeds(dofs, h, alpha_m, alpha_f, gamma, bends, known, v, a):
    """Book what the accepted step of length h has left of changes of speed, and how long motions are to be pushed.

    The method makes a change of speed by the auxiliary acceleration of eq. 2.86, which is that of a little earlier. It
    is followed here for what is driven as the method does it for unknowns. Where anything ``bends`` in the step it is
    as the push leaves it.
    """
    share = 1.0 / (1.0 - alpha_m)
    for k in dofs.driven:
        i = dofs.held[k]
        pushed = known[BENDS, i] > 0.0
        begin, lagged = known[BEGIN, i], known[LAGGED, i]
        auxiliary = share * ((1.0 - alpha_f) * a[i] + alpha_f * begin - alpha_m * lagged)
        made = h * ((1.0 - gamma) * lagged + gamma * auxiliary)
        known[DEBT, i] = known[LOST, i] if pushed else known[DEBT, i] + v[i] - known[SPEED, i] - made
        known[AUXILIARY, i] = a[i] + share * alpha_m * (begin - lagged) if pushed else auxiliary
        known[OWED, i] = 0.0 if pushed else known[OWED, i] + known[SHIFT, i]
        known[CHANGE, i] = max(FADES * known[CHANGE, i], h * abs(a[i]))
        if known[QUIET, i] > 0.0:
            known[UNREST, i] = max(known[UNREST, i] - 1.0, 0.0)
        elif pushed and known[BENDS, i] != OWES:
            known[UNREST, i] = float(CALM)


@separate(bool, FUNCTIONS, int, float, float, float, float, late=True)
def _bends(functions, motion, t, h, v0, a0):
    """Whether a function changes its speed in the step before t as accelerations at the ends of steps do not show.

    Of a smooth motion one step makes too little of the change and another too much: nothing is lost of all of them. Its
    change is that of a cubic through the accelerations at the ends of this step and of the steps beside it.
    """
    v1 = _speed(functions, motion, t)
    inner = a0 + evaluate(functions, motion, t)[2]
    outer = evaluate(functions, motion, t - 2.0 * h)[2] + evaluate(functions, motion, t + h)[2]
    lost = abs(v1 - v0 - h * (13.0 * inner - outer) / 24.0)
    # Where a smooth motion begins or ends its accelerations are next to nothing, and any part of them is a large one:
    # what two steps nearby have in common counts. A jump nearby does not.
    most = 0.0
    before, last = _speed(functions, motion, t - 4.0 * h), 0.0
    for k in range(-3, 4):
        v = _speed(functions, motion, t + k * h)
        change = abs(v - before)
        most = max(most, min(change, last))
        before, last = v, change
    return lost > BENT * most and lost > ROUNDED * max(abs(v0), abs(v1))


@separate(bool, FUNCTIONS, int, float, float, float, float, float, late=True)
def _bends_within(functions, motion, t, h, scale, v0, a0):
    """Whether a function is not smooth in the step before t: two rules that integrate a cubic miss its change of speed.

    No corner is where both are right by accident. Nor is it smooth where what the step begins with, ``v0`` and ``a0``,
    is not its own. A miss counts beside the accelerations in the step, and ``scale``.
    """
    v1 = _speed(functions, motion, t)
    first, last = evaluate(functions, motion, t - h)[2], evaluate(functions, motion, t)[2]
    middle = evaluate(functions, motion, t - 0.5 * h)[2]
    early, late = evaluate(functions, motion, t - h + GAUSS * h)[2], evaluate(functions, motion, t - GAUSS * h)[2]
    simpson = abs(v1 - v0 - h * (first + 4.0 * middle + last) / 6.0)
    gauss = abs(v1 - v0 - 0.5 * h * (early + late))
    most = max(abs(first), abs(middle), abs(last), abs(early), abs(late))
    return max(simpson, gauss, h * abs(first - a0)) > STRICT * max(h * most, scale)


@kernel(forceinline=True)
def _speed(functions, motion, t):
    return evaluate(functions, motion, t)[1]


@separate(bool, DOFS, FUNCTIONS, float, float, STATES, VECTOR, late=True)
def ease(dofs, functions, t, h, known, a):
    """Take accelerations for zero that what bends in the step of length h from t has at t, and for less than a step.

    They are neither of the step before nor of this one. Returns whether there are any.
    """
    eased = False
    first = 0
    while first < dofs.driven.size:
        last = _motion_to(dofs, functions, first)
        short = _passes(dofs, functions, first, last, t, h, a)
        for k in dofs.driven[first:last]:
            i = dofs.held[k]
            known[BEGIN, i] = a[i]
            if known[BENDS, i] > 0.0 and short:
                known[LAGGED, i] -= a[i]
                a[i] = known[BEGIN, i] = 0.0
                eased = True
        first = last
    return eased


@kernel
def _passes(dofs, functions, first, last, t, h, a):
    """Whether accelerations at t make more of a change of speed than there is in the steps on both sides."""
    for turns in range(2):
        made, most = 0.0, 0.0
        for k in dofs.driven[first:last]:
            motion = dofs.motion[k]
            if _turns(functions, motion) == (turns == 1):
                v = _speed(functions, motion, t)
                made = max(made, abs(a[dofs.held[k]]) * h)
                most = max(most, abs(v - _speed(functions, motion, t - h)), abs(_speed(functions, motion, t + h) - v))
        if made > (1.0 + BENT) * most:
            return True
    return False


@separate(float, DOFS, FUNCTIONS, float, float, VECTOR, VECTOR, VECTOR, late=True)
def work_of_easing(dofs, functions, t, h, eased, before, ways):
    """What the work of a step of length h from t is more by, J, as it begins with the full residuals ``eased``.

    It is booked as the mean of the forces at both ends times the way, and begun with those of ``before``. ``ways``
    (n_full,) is scratch.
    """
    for i in range(ways.size):
        ways[i] = 0.0  # what is fixed goes no way
    work = 0.0
    for k in dofs.driven:
        i, motion = dofs.held[k], dofs.motion[k]
        ways[i] = evaluate(functions, motion, t + h)[0] - evaluate(functions, motion, t)[0]
        work += 0.5 * (eased[i] - before[i]) * ways[i]
    for i in dofs.carried:
        for k in range(dofs.start[i], dofs.start[i + 1]):
            if dofs.unknown[k] < 0:
                work += 0.5 * dofs.factor[k] * (eased[i] - before[i]) * ways[-1 - dofs.unknown[k]]
    return work


@separate(type(None), DOFS, FUNCTIONS, float, float, float, float, STATES, VECTOR, late=True)
def prescribe_push(dofs, functions, t, h, first, last, known, a):
    """Set the accelerations at the end of the step of length h from t of what bends in it.

    With it a step makes all of the change of speed, and what others have left. It counts the part ``first`` of the
    auxiliary acceleration at its start, ``last`` of the acceleration at its end, and the rest of that at its start.
    """
    for k in dofs.driven:
        i, motion = dofs.held[k], dofs.motion[k]
        if known[BENDS, i] > 0.0:
            known[LOST, i] = 0.0
            if known[BENDS, i] == OWES or (known[UNREST, i] == 1.0 and known[QUIET, i] > 0.0):
                # The last push, and one by itself, leave what steps without one have left on the way from rest: of a
                # swing nothing in the mean.
                later, sooner = evaluate(functions, motion, t + 2.0 * h)[2], evaluate(functions, motion, t)[2]
                known[LOST, i] = -h * (later - sooner) / 24.0
            mean = (_speed(functions, motion, t + h) - known[SPEED, i] + known[DEBT, i] - known[LOST, i]) / h
            a[i] = (mean - first * known[LAGGED, i] - (1.0 - first - last) * known[BEGIN, i]) / last


@separate(type(None), DOFS, STATES, VECTOR, late=True)
def prescribe_begun(dofs, known, a):
    """Set the accelerations of what bends to those with which its step began."""
    for k in dofs.driven:
        i = dofs.held[k]
        if known[BENDS, i] > 0.0:
            a[i] = known[BEGIN, i]


@separate(bool, DOFS, FUNCTIONS, float, float, STATES, VECTOR, late=True)
def prescribe_lasting(dofs, functions, t, h, known, a):
    """Set the accelerations with which what is driven goes on at t, behind a step of length h in which some has bent.

    Of that it is zero where the acceleration does not show how speed changes in the next step, or a corner is at t.
    Returns whether any of that goes on with another acceleration than its step began with.
    """
    changes = False
    first = 0
    while first < dofs.driven.size:
        last = _motion_to(dofs, functions, first)
        hidden = known[BENDS, dofs.held[dofs.driven[first]]] > 0.0 and _hides(dofs, functions, first, last, t, h)
        for k in dofs.driven[first:last]:
            i = dofs.held[k]
            a[i] = 0.0 if hidden else evaluate(functions, dofs.motion[k], t)[2]
            changes = changes or (known[BENDS, i] > 0.0 and a[i] != known[BEGIN, i])
        first = last
    return changes


@kernel
def _hides(dofs, functions, first, last, t, h):
    """Whether accelerations at t do not show how speed changes in the next step, or a corner is at t."""
    for turns in range(2):
        jump, beside, lost, scale = 0.0, 0.0, 0.0, 0.0
        for k in dofs.driven[first:last]:
            motion = dofs.motion[k]
            if _turns(functions, motion) == (turns == 1):
                _, v0, a0 = evaluate(functions, motion, t)
                _, v1, a1 = evaluate(functions, motion, t + h)
                left = evaluate(functions, motion, t - BESIDE * h)[2]
                right = evaluate(functions, motion, t + BESIDE * h)[2]
                jump, beside = max(jump, abs(right - left)), max(beside, abs(left), abs(right))
                lost = max(lost, abs(v1 - v0 - 0.5 * h * (a0 + a1)))
                scale = max(scale, h * max(abs(a0), abs(a1)))
        if jump > BENT * beside or lost > BENT * scale:
            return True
    return False


@separate(type(None), DOFS, float, STATES, VECTOR, VECTOR, late=True)
def prescribe_means(dofs, h, known, v, a):
    """Set accelerations of what is driven to those of the mean of a step of length h."""
    for k in dofs.driven:
        i = dofs.held[k]
        a[i] = (v[i] - known[SPEED, i]) / h


@separate(type(None), DOFS, NUMBERS, VECTOR, VECTOR, late=True)
def drop_inertia(dofs, algebraic, reduced, a):
    """Set full accelerations to zero, but multipliers, which are forces: ``algebraic`` lists their unknowns."""
    for i in range(a.size):
        a[i] = 0.0
    for k in algebraic:
        a[dofs.free[k]] = reduced[k]


@separate(float, DOFS, float, STATES, VECTOR, VECTOR, STATES, VECTOR, STATES, STATES, late=True)
def work_of_push(dofs, h, known, q, v, moved, others, entered, scratch):
    """Work of what is driven in a step of length h in which a function bends, J.

    The full residuals at its end are ``others`` without accelerations, and ``moved`` (2, n_full) with those of the mean
    of the step and with those at its start. The difference of the first is inertia, of which h times the force is the
    impulse: its work is that times the mean of the speeds at both ends. All else works along the way, with the mean of
    the forces at both ends: of those ``entered`` (2, n_full), with places, without inertia.
    """
    for i in range(v.size):
        scratch[0, i] = scratch[1, i] = 0.0  # what is fixed goes no way
    for k in dofs.driven:
        i = dofs.held[k]
        scratch[0, i] = q[i] - entered[0, i]
        scratch[1, i] = 0.5 * h * (known[SPEED, i] + v[i])
    work = 0.0
    for k in dofs.driven:
        i = dofs.held[k]
        along = 0.5 * (entered[1, i] + others[i] - (moved[1, i] - others[i]))
        work += along * scratch[0, i] + (moved[0, i] - others[i]) * scratch[1, i]
    for i in dofs.carried:
        along, inertia = 0.5 * (entered[1, i] + others[i] - (moved[1, i] - others[i])), moved[0, i] - others[i]
        for k in range(dofs.start[i], dofs.start[i + 1]):
            if dofs.unknown[k] < 0:
                j = -1 - dofs.unknown[k]
                work += dofs.factor[k] * (along * scratch[0, j] + inertia * scratch[1, j])
    return work


SIX = 6
"""Unknowns of a node of a rope that holds its material: they are moved together."""


@kernel
def _copy_runs(runs, source, read, target, written):
    """Copy all runs; ``read`` and ``written`` say whether source and target are by `UNKNOWNS` or by `PLACES`."""
    for k in range(0, runs.size, RUN):
        copy_some_runs(runs, k, 0, runs[k + REPEATS], source, read, target, written)


@kernel(forceinline=True)
def copy_some_runs(runs, k, begin, end, source, read, target, written):
    """Copy runs ``begin`` to ``end`` - 1 of the series that stands at k; see `_copy_runs`."""
    count, step, stride = runs[k + COUNT], runs[k + read + 1], runs[k + written + 1]
    a, b = runs[k + read] + begin * step, runs[k + written] + begin * stride
    for _ in range(begin, end):
        if count == SIX:
            four, fifth, sixth = load(source, a), source[a + 4], source[a + 5]
            store(target, b, four)
            target[b + 4], target[b + 5] = fifth, sixth
        else:
            for i in range(count):
                target[b + i] = source[a + i]
        a += step
        b += stride


@separate(type(None), DOFS, VECTOR, VECTOR)
def expand(dofs, reduced, full):
    """Write reduced unknowns into the full vector; held degrees of freedom are left as they are."""
    _copy_runs(dofs.runs, reduced, UNKNOWNS, full, PLACES)
    if dofs.runs.size == 0:
        for i in range(dofs.free.size):
            full[dofs.free[i]] = reduced[i]
    expand_tied(dofs, reduced, full)


@entry
def expand_now(dofs, reduced, full):
    """The same as :func:`expand`, for Python."""
    expand(dofs, reduced, full)


@kernel
def expand_tied(dofs, reduced, full):
    """Write what depends on several unknowns, or on held ones, into the full vector."""
    for i in dofs.tied:
        x = 0.0
        for k in range(dofs.start[i], dofs.start[i + 1]):
            master = dofs.unknown[k]
            x += dofs.factor[k] * (reduced[master] if master >= 0 else full[-1 - master])
        full[i] = x


@kernel(forceinline=True)
def expand_held(dofs, full):
    """Write into the full vector what it is while all reduced unknowns are zero."""
    for i in dofs.free:
        full[i] = 0.0
    for i in dofs.tied:
        x = 0.0
        for k in range(dofs.start[i], dofs.start[i + 1]):
            if dofs.unknown[k] < 0:
                x += dofs.factor[k] * full[-1 - dofs.unknown[k]]
        full[i] = x


@kernel
def keep_flowing(dofs, v, a):
    """Put everything to rest but material that flows steadily."""
    a.fill(0.0)
    for i in dofs.flowing:
        a[i] = v[i]
    for i in range(v.size):
        v[i] = a[i]
        a[i] = 0.0


@kernel(forceinline=True)
def reduce(dofs, full, reduced):
    """Sum full residuals into the reduced rows they belong to."""
    _copy_runs(dofs.runs, full, PLACES, reduced, UNKNOWNS)
    if dofs.runs.size == 0:
        for i in range(dofs.free.size):
            reduced[i] = full[dofs.free[i]]
    for i in dofs.tied:
        for k in range(dofs.start[i], dofs.start[i + 1]):
            if dofs.unknown[k] >= 0:
                reduced[dofs.unknown[k]] += dofs.factor[k] * full[i]


def add_entry(matrix, dofs, i, j, x):
    """Add x at full row i, column j to a reduced matrix: a ``Matrix``, or only its diagonal (n,)."""
    for k in range(dofs.start[i], dofs.start[i + 1]):
        for l in range(dofs.start[j], dofs.start[j + 1]):
            row, column, value = dofs.unknown[k], dofs.unknown[l], dofs.factor[k] * dofs.factor[l] * x
            if row < 0 or column < 0:
                continue
            if not hasattr(matrix, "ndim"):
                add_at(matrix, row, column, value)
            elif row == column:
                matrix[row] += value


@stands_for(add_entry)
def _add_entry(matrix, dofs, i, j, x):
    if is_array(matrix):

        def diagonal(matrix, dofs, i, j, x):
            number = dofs.number[i]
            if i == j and number >= 0:
                matrix[number] += x
            elif i == j and number == TIED:
                for k in range(dofs.start[i], dofs.start[i + 1]):
                    if dofs.unknown[k] >= 0:
                        matrix[dofs.unknown[k]] += dofs.factor[k] * dofs.factor[k] * x

        return diagonal

    def bordered(matrix, dofs, i, j, x):
        for k in range(dofs.start[i], dofs.start[i + 1]):
            row = dofs.unknown[k]
            y = dofs.factor[k] * x
            for l in range(dofs.start[j], dofs.start[j + 1]):
                if row >= 0 and dofs.unknown[l] >= 0:
                    add_at(matrix, row, dofs.unknown[l], dofs.factor[l] * y)

    return bordered


def add_block(matrix, dofs, first, stride, width, block):
    """Add a dense block (k, k): ``width`` degrees of freedom from ``first``, from ``first + stride``, ...

    To a ``Matrix``, or what stands on its diagonal to a diagonal (n,).
    """
    chosen = _add_block_to_diagonal if hasattr(matrix, "ndim") else _add_block_to_band
    chosen(matrix, dofs, first, stride, width, block)


@stands_for(add_block)
def _add_block(matrix, dofs, first, stride, width, block):
    if is_array(matrix):
        return lambda matrix, dofs, first, stride, width, block: _add_block_to_diagonal(
            matrix, dofs, first, stride, width, block
        )
    return lambda matrix, dofs, first, stride, width, block: _add_block_to_band(
        matrix, dofs, first, stride, width, block
    )


@kernel
def _add_block_to_diagonal(diagonal, dofs, first, stride, width, block):
    """Of a matrix that is diagonal no two of these degrees of freedom depend on one unknown."""
    for i in range(block.shape[0]):
        place = first + stride * (i // width) + i % width
        add_entry(diagonal, dofs, place, place, block[i, i])


@kernel
def _add_block_to_band(matrix, dofs, first, stride, width, block):
    """The same where a matrix has a band; see :func:`add_block`."""
    number = dofs.number
    nodes = block.shape[0] // width
    n = matrix.band.shape[0]
    for node in range(nodes):
        for k in range(width):
            row = number[first + stride * node + k]
            if row == TIED or row >= n:
                _add_any_block(matrix, dofs, first, stride, width, block)
                return
    centre = matrix.band.shape[1] // 2
    for left in range(nodes):
        for j in range(width):
            column = number[first + stride * left + j]
            if column >= 0:
                have_cleared(matrix, column + 1)
                for right in range(nodes):
                    for i in range(width):
                        row = number[first + stride * right + i]
                        if row >= 0:
                            matrix.band[column, centre + row - column] += block[width * right + i, width * left + j]


@kernel
def _add_any_block(matrix, dofs, first, stride, width, block):
    """The same where some of the degrees of freedom are tied or belong to the border."""
    number = dofs.number
    for i in range(block.shape[0]):
        place = first + stride * (i // width) + i % width
        row = number[place]
        if row == HELD:
            continue
        for j in range(block.shape[0]):
            if block[i, j] == 0.0:
                continue
            other = first + stride * (j // width) + j % width
            column = number[other]
            if row >= 0 and column >= 0:
                add_at(matrix, row, column, block[i, j])
            elif column != HELD:
                add_entry(matrix, dofs, place, other, block[i, j])
