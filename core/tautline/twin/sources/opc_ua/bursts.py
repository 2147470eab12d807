"""Changes that are sent together, in the order in which they were measured.

What a server has sampled since it sent last it sends as one notification, and many do so variable by variable, as each
has a queue of its own (OPC UA part 4, 5.13.1.5). So the first variable reaches the newest stamp before the second one
begins with the oldest. A clock that was set back shows itself in the order of one variable: what came after that stays
after it.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from statistics import median_low

from tautline.twin.pace import BACK
from tautline.twin.sources.opc_ua.holding import Change

TOGETHER = 0.002
"""Stamps that are no further apart than this make one record, s."""


class Bursts:
    """Puts changes that came together in order. The last stamps of each variable are those to compare the next with."""

    def __init__(self) -> None:
        self._last: dict[str, deque[float]] = {}

    def forget(self) -> None:
        """Compare with nothing that came before: the connection is lost."""
        self._last.clear()

    def records(self, changes: Iterable[Change]) -> list[list[Change]]:
        """Changes that came together, by the record that they make; those of a record have different columns.

        The first readings of a subscription come before all others: they hold until these, and their stamps may be old.
        """
        found: list[list[Change]] = []
        for one in self._in_order(changes):
            begun = found[-1] if found else []
            if not begun or not _is_near(one, begun[0]) or any(one.column == other.column for other in begun):
                found.append([])
            found[-1].append(one)
        return found

    def _in_order(self, changes: Iterable[Change]) -> Sequence[Change]:
        """Changes by stamp, as far as that of no variable was set back; the first readings as they came."""
        every = list(changes)
        places: dict[str, list[int]] = {}
        for k, one in enumerate(every):
            if not one.first:
                places.setdefault(one.column, []).append(k)
        known = set(self._last)
        counts = {name: list(self._set_backs(name, [every[k].time for k in some])) for name, some in places.items()}
        # A clock that was set back before all of these came is no matter of their order.
        before = min((count[0] for name, count in counts.items() if name in known), default=0)
        keys = [(-1, 0.0)] * len(every)
        for name, some in places.items():
            for k, count in zip(some, counts[name], strict=True):
                keys[k] = (count - before if name in known else count, every[k].time)
        set_back = {name for name, count in counts.items() if count[-1]}
        if set_back:  # the last stamps of others may be of the clock as it was before
            self._last = {name: last for name, last in self._last.items() if name in set_back}
        return [every[k] for k in sorted(range(len(every)), key=keys.__getitem__)]

    def _set_backs(self, column: str, times: Sequence[float]) -> Iterator[int]:
        """How often the clock of a variable was set back before each of its readings, by their stamps as they came, s.

        A stamp out of order is none: the next ones are after the newest again. Nor is one that is before a stamp that
        alone was far ahead: it is compared with what most of the last stamps have reached.
        """
        count, last = 0, self._last.setdefault(column, deque(maxlen=BACK))
        for k, time in enumerate(times):
            if last and time < median_low(last) and _go_on_below(max(last), times[k : k + BACK]):
                count += 1
                last.clear()
            last.append(time)
            yield count


def _is_near(one: Change, other: Change) -> bool:
    """Whether two changes may be of one record."""
    return (one.first and other.first) or (one.first == other.first and abs(one.time - other.time) <= TOGETHER)


def _go_on_below(newest: float, then: Sequence[float]) -> bool:
    """Whether stamps follow one another without one that is later than the newest before them, s."""
    return then[-1] <= newest and all(one <= other for one, other in pairwise(then))


def measured_over(changes: Iterable[Change]) -> float:
    """Time over which the readings of a variable were measured that came together, s: the longest of all variables.

    It is counted in usual steps, as one stamp far from the others is no sign of a time that went by.
    """
    times: dict[str, list[float]] = {}
    for one in changes:
        if not one.first:
            times.setdefault(one.column, []).append(one.time)
    steps = [[b - a for a, b in pairwise(sorted(some))] for some in times.values()]
    return max((len(some) * median_low(some) for some in steps if some), default=0.0)
