"""Changes that are sent together, in the order in which they were measured.

What a server has sampled since it sent last it sends as one notification, and many do so variable by variable, as each
has a queue of its own (OPC UA part 4, 5.13.1.5). So the first variable reaches the newest stamp before the second one
begins with the oldest. A clock that was set back shows itself in the order of one variable: what came after that stays
after it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise

from tautline.twin.pace import BACK
from tautline.twin.sources.opc_ua.holding import Change

TOGETHER = 0.002
"""Stamps that are no further apart than this make one record, s."""


def records_of(changes: Iterable[Change]) -> list[list[Change]]:
    """Changes that came together, by the record that they make; those of a record have different columns.

    The first readings of a subscription come before all others: they hold until these, and their stamps may be old.
    """
    found: list[list[Change]] = []
    for one in _in_order(changes):
        begun = found[-1] if found else []
        if not begun or not _is_near(one, begun[0]) or any(one.column == other.column for other in begun):
            found.append([])
        found[-1].append(one)
    return found


def _is_near(one: Change, other: Change) -> bool:
    """Whether two changes may be of one record."""
    return (one.first and other.first) or (one.first == other.first and abs(one.time - other.time) <= TOGETHER)


def _in_order(changes: Iterable[Change]) -> Sequence[Change]:
    """Changes by stamp, as far as that of no variable was set back; the first readings as they came."""
    every = list(changes)
    keys = [(-1, 0.0)] * len(every)
    places: dict[str, list[int]] = {}
    for k, one in enumerate(every):
        if not one.first:
            places.setdefault(one.column, []).append(k)
    for some in places.values():
        times = [every[k].time for k in some]
        for k, key in zip(some, zip(_set_backs(times), times, strict=True), strict=True):
            keys[k] = key
    return [every[k] for k in sorted(range(len(every)), key=keys.__getitem__)]


def _set_backs(times: Sequence[float]) -> Iterator[int]:
    """How often the clock of a variable was set back before each of its readings, by their stamps as they came, s.

    A stamp out of order is none: the next ones are behind the newest again. Nor is one that follows those before a
    stamp that alone was far ahead.
    """
    count, newest, before = 0, -math.inf, math.inf
    for k, time in enumerate(times):
        if time < min(newest, before) and _go_on_below(newest, times[k : k + BACK]):
            count, newest, before = count + 1, time, math.inf
        elif time > newest:
            newest, before = time, newest if newest > -math.inf else math.inf
        elif before < math.inf:
            before = max(before, time)
        yield count


def _go_on_below(newest: float, then: Sequence[float]) -> bool:
    """Whether stamps follow one another without one that is later than the newest before them, s."""
    return then[-1] <= newest and all(one <= other for one, other in pairwise(then))
