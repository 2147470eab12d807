"""Changes that are sent together, in the order in which they were measured.

What a server has sampled since it sent last it sends as one notification, and many do so variable by variable, as each
has a queue of its own (OPC UA part 4, 5.13.1.5). So the first variable reaches the newest stamp before the second one
begins with the oldest. A clock that was set back shows itself in the order of one variable: what came behind that stays
behind it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

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
    newest: dict[str, float] = {}
    set_back: dict[str, int] = {}
    keys: list[tuple[int, float]] = []
    every = list(changes)
    for one in every:
        if one.first:
            keys.append((-1, 0.0))
            continue
        set_back[one.column] = set_back.get(one.column, 0) + (one.time < newest.get(one.column, one.time))
        newest[one.column] = one.time
        keys.append((set_back[one.column], one.time))
    return [every[k] for k in sorted(range(len(every)), key=keys.__getitem__)]
