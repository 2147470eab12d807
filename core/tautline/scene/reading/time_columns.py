"""Which column of a file holds the times, and in what unit, by the words of its header.

``time``, ``t_ms``, ``Time/ms``, ``elapsed [s]``, ``minutes``. Letters that mean something else in the field are no
times: ``T_min`` is a least tension, ``T_h`` a horizontal one or a hot temperature.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from tautline.scene.reading.columns import HEADER, LETTER_UNITS, Columns, is_unit

TIMES = "time", "t"
"""Names of the column of times, the likelier first."""
NAMES = frozenset("time times timestamp stamp elapsed datetime".split())
"""Words that mean the time, alone or with one of `KINDS`."""
KINDS = frozenset(
    "time times timestamp stamp elapsed date total relative rel absolute abs sim simulation simulated run running "
    "record recording test rig log system real gps utc local".split()
)
"""Words beside a name of the time which say whose it is: ``sim time``, ``time utc``."""
LOCAL_NAMES = frozenset("zeit uhrzeit clock temps tiempo tempo tijd tid czas".split())
"""Words for time, of other languages too: those of the first column, or of one of two."""
UNITS_OF_NAMES = {
    word: unit
    for unit, words in {
        "ns": "ns nsec nanos nanosecond nanoseconds",
        "us": "us \u00b5s \u03bcs usec micros microsecond microseconds",
        "ms": "ms msec msecs millis millisecond milliseconds",
        "s": "s sec secs second seconds",
        "min": "min mins minute minutes",
        "hour": "h hr hrs hour hours",
        "day": "d day days",
    }.items()
    for word in words.split()
}
"""Units of time by the words that a name ends with: ``time_ms``, ``TimeMs``, ``t ms``."""
OTHERWISE = ("s", "h", "d", "min")
"""Words that are units of time and more often something else: an arc length, a height, a depth, a least value."""
EXTREMES = frozenset("max mean avg average".split())
"""Words of other columns, beside which `min` is a least value."""
APART = re.compile(r"(?<=[a-z])(?=[A-Z])|[\W_]+")
RUN_TOGETHER = re.compile(
    rf"\b(time|timestamp|elapsed)({'|'.join(sorted(UNITS_OF_NAMES.keys() - {'s', 'd'}, key=len, reverse=True))})$"
)
"""Names of times with their unit in one word: ``timems``; `times` and `timed` are words themselves."""


@dataclass(frozen=True)
class TimeHead:
    """What the header of a column says of time.

    ``words`` of the name in small letters without its unit; ``unit`` of time that the name ends with, or empty.
    ``kind``: "name" of the time, bare "unit", "local" word for time, "min" alone, capital "letter" T, "odd": a name of
    the time with an ending that is not understood; or empty.
    """

    words: tuple[str, ...]
    unit: str
    kind: str

    @property
    def doubtful(self) -> bool:
        """Whether the unit of a column that holds the times is not clear from this."""
        if self.kind == "odd":
            return True
        if self.kind:
            return False
        alone = len(self.words) == 1 and not self.unit
        return (alone and self.words[0] in ("h", "d", "min")) or self.unit in ("min", "hour", "day")


def time_head(title: str) -> TimeHead:
    """Read the title of a column, without its unit in brackets; brackets in its middle are words of the name."""
    match = HEADER.fullmatch(title)
    bare = match["name"].strip() if match else title.strip()
    text = " ".join(part for part in APART.sub(" ", bare).lower().split() if part != "in")
    words = tuple(RUN_TOGETHER.sub(r"\1 \2", text).split())
    if len(words) < 2:
        (word,) = words or ("",)
        if word == "t":
            return TimeHead(words, "", "name" if bare == "t" else "letter")
        if word in UNITS_OF_NAMES and word not in OTHERWISE:
            return TimeHead(words, UNITS_OF_NAMES[word], "unit")
        return TimeHead(words, "min" if word == "min" else "", "min" if word == "min" else _kind(words))
    unit = UNITS_OF_NAMES.get(words[-1], "")
    name = words[:-1] if unit else words
    if name == ("t",):
        small = unit in LETTER_UNITS and bare.startswith("t")
        return TimeHead(name, unit, "name" if small else "")
    return TimeHead(name, unit, _kind(name))


def _kind(words: Sequence[str]) -> str:
    if any(word in NAMES for word in words) and all(word in KINDS | NAMES for word in words):
        return "name"
    if len(words) == 1 and words[0] in LOCAL_NAMES:
        return "local"
    return "odd" if words and words[0] in ("time", "times", "timestamp", "elapsed") else ""


def time_columns(columns: Columns) -> list[int]:
    """Columns that may be the time, the likeliest kind only: one where it is clear, none where no header tells.

    A column that is called ``time``, or else ``t``, is it. Of several other names of the time those count that have a
    unit of time in brackets. A bracket with another unit rules a column out where another one is left.
    """
    heads = [time_head(title) for title in columns.titles]
    lasting = [i for i, unit in enumerate(columns.units) if _lasts(unit)]
    foreign = [i for i, unit in enumerate(columns.units) if unit and i not in lasting]
    for name in TIMES:
        called = [i for i, title in enumerate(columns.titles) if columns.names[i] == name and heads[i].kind == "name"]
        if any(i not in foreign for i in called):
            return called[:1]
    units = [i for i, head in enumerate(heads) if head.kind == "unit"]
    least = [i for i, head in enumerate(heads) if head.kind == "min"]
    if any(EXTREMES & set(head.words) for head in heads) or not (units or least[:1] == [0]):
        least = []
    named = sorted({i for i, head in enumerate(heads) if head.kind == "name"} | set(units) | set(least))
    one_of_two = len(columns.filled()) == 2
    local = [i for i, head in enumerate(heads) if head.kind == "local" and (i == 0 or one_of_two)]
    of_kind = ([i for i, head in enumerate(heads) if head.kind == kind] for kind in ("letter", "odd"))
    for found in (named, local, *of_kind):
        left = [i for i in found if i not in foreign]
        if left:
            bracketed = [i for i in left if i in lasting]
            return bracketed if bracketed else left
    return lasting if len(lasting) == 1 else named[:1]


def _lasts(unit: str) -> bool:
    """Whether what a header has in brackets is a unit of time."""
    return bool(unit) and (unit.lower() in UNITS_OF_NAMES or is_unit(unit, "s"))
