"""Which column of a file holds the times, and in what unit, by the words of its header.

Tables of scenes are read by this: ``time``, ``t_ms``, ``Time/ms``, ``elapsed [s]``, ``TIME [MS]``, ``minutes since
start``. Letters that mean something else in the field are no times: ``T_min`` is a least tension, ``T_h`` a horizontal
one or a hot temperature. The stamps of twins have their names and units by this, too, but for columns that are called
by a unit alone: among the many columns of a machine ``minutes since start`` may be a duration, and the map names it.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from tautline.scene.reading.columns import HEADER, LETTER_UNITS, NO_UNIT, Columns, is_unit

TIMES = "time", "t"
"""Names of the column of times, the likelier first."""
NAMES = frozenset("time times timestamp stamp elapsed datetime".split())
"""Words that mean the time, alone or with one of `KINDS`."""
KINDS = frozenset(
    "time times timestamp stamp elapsed date total relative rel absolute abs sim simulation simulated run running "
    "record recording test rig log system real gps utc local".split()
)
"""Words beside a name of the time which say whose it is: ``sim time``, ``time utc``."""
LOCAL_NAMES = frozenset("zeit uhrzeit laufzeit messzeit zeitstempel clock temps tiempo tempo tijd tid czas".split())
"""Words for time, of other languages too: those of the first column, or of one of two."""
UNITS_OF_NAMES = {
    word: unit
    for unit, words in {
        "ns": "ns nsec nanos nanosec nanosecond nanoseconds",
        "us": "us \u00b5s \u03bcs usec micros microsec microsecs microsecond microseconds mikrosek mikrosekunde "
        "mikrosekunden microsegundos microsecondes mikrosekundy mikrosekunder",
        "ms": "ms msec msecs msek mseconds millis millisec millisecs millisecond milliseconds millisek millisekunde "
        "millisekunden milisegundo milisegundos milliseconde millisecondes milisekunda milisekundy milisekund "
        "millisekund millisekunder",
        "s": "s sec secs second seconds sek sekunde sekunden segundo segundos seconde secondes sekunda sekundy sekund "
        "sekunder",
        "min": "min mins minute minutes minuten minuto minutos minuta minuty minut minutt minutter",
        "hour": "h hr hrs hour hours stunde stunden horas heures godziny godzin",
        "day": "d day days tage d\u00edas dias jours dni dager",
    }.items()
    for word in words.split()
}
"""Units of time by the words of names, in languages of the field: ``time_ms``, ``TimeMs``, ``t ms``, ``Minuten``."""
OTHERWISE = ("s", "h", "d", "min")
"""Words that are units of time and more often something else: an arc length, a height, a depth, a least value."""
UNSURE = frozenset("hora heure godzina timer".split())
"""An hour or the time of the day, hours or a clock: no unit for sure."""
SHORT = UNSURE | frozenset("m mo mon std".split())
"""Words that beside a name of the time may be a unit and may not: `m` is a metre, a minute or a month."""
IN_BRACKETS = {"seg": "s", "std": "hour", "timer": "hour", "week": "week", "weeks": "week"}
"""Units of time in brackets only: as words of a name they are something else."""
ZONES = frozenset(
    "z gmt cet cest est edt cst cdt mst mdt pst pdt akst hst ast adt bst ist wet west eet eest msk jst kst hkt sgt "
    "aest aedt acst awst nzst nzdt sast".split()
)
"""Zones of time by their short names; `Europe/Berlin` is one of `ZONE`."""
LABELS = frozenset(
    "plc sps pc device raw start none null n/a na string str text double float float32 float64 int int64 real lreal "
    "number server client host controller logger daq sensor machine scada".split()
)
"""Whose clock it is, or of what type the numbers are."""
DATES = frozenset(("date", "datetime", "iso", "iso8601"))
"""Forms of a date: numbers below them may be days, as spreadsheets count them, and are in no unit for sure."""
NO_UNITS = {*NO_UNIT, *NAMES, *KINDS, *ZONES, *LABELS, "unix", "epoch", "posix"} - DATES
"""What stands in the brackets of a time, in small letters, and is no unit."""
DATED = frozenset(("timestring", "varname"))
"""Columns of an export of WinCC, in small letters."""
DAYS = 3e10, 6e10
"""Days since 1900 times a million, from 1982 to 2064: no milliseconds that a run or a clock counts."""
BRACKETS = re.compile(r"[\[(]([^\[\]()]*)[\])]")
ZONE = re.compile(
    r"\b(utc|gmt) ?[+-] ?\d{1,2}(:?\d{2})?\b"
    r"|\b(africa|america|asia|atlantic|australia|europe|indian|pacific|etc)/[a-z_/]+"
)
"""A zone of time in brackets: ``UTC+02:00``, ``Europe/Berlin``."""
SINCE = ("since", "from", "after", "seit", "depuis", "desde", "od", "fra")
"""Words behind which a name says from when times count: ``ms since epoch``."""
EXTREMES = frozenset("max mean avg average".split())
"""Words of other columns, beside which `min` is a least value."""
APART = re.compile(r"(?<=[a-z])(?=[A-Z])|[\W_]+")
SMALL_WORDS = re.compile(r"(milli|mi[ck]ro|nano)[\s_]*s(?=e[ck])", re.IGNORECASE)
"""Prefixes of seconds in a word of their own: ``MilliSeconds``, ``micro sec``."""
SMALL_LETTERS = re.compile(r"(?:(?<![^\W_])|(?<=[Tt]ime)|(?<=[Zz]eit))([mun\u00b5\u03bc])S(?=e[ck]|$|[\W_])")
"""The same in letters: ``mSec``, ``t_mS``."""
SCALES = frozenset("milli micro mikro nano kilo deci centi half quarter tenth tenths hundredth hundredths".split())
"""Words beside a unit that make it another one."""
PARTS = ("m", "u", "n", "k", "c", "d")
"""Letters that may do the same before seconds, and may be something else: ``m_sec``."""
SCALED = re.compile(r"(deci|dezi|centi|zenti|deca|deka|hecto|hekto|kilo)s(ec|ek|eg)?[a-z]*")
"""Parts and multiples of seconds in one word that no unit here has: ``deciseconds``."""
COUNTED = re.compile(rf"\d+({'|'.join(UNITS_OF_NAMES)})")
"""So many of a unit in one word: ``10ms``."""
RUN_TOGETHER = re.compile(
    r"\b([a-z]*time|timestamp|stamp|elapsed|[a-z]*zeit|zeitstempel|unix|epoch|posix|duration|tiempo|tempo|czas|tijd)"
    rf"({'|'.join(sorted(UNITS_OF_NAMES.keys() - {'s', 'd'}, key=len, reverse=True))})$"
)
"""Names of times with their unit in one word: ``timems``; `times` and `timed` are words themselves."""
LETTER_TOGETHER = re.compile(r"t(ms|us|ns|msec|usec|nsec|sec|min)")
"""The same of the letter `t`: ``tms``."""


@dataclass(frozen=True)
class TimeHead:
    """What the header of a column says of time.

    ``words`` of the name in small letters without its unit; ``unit`` of time that the name has, or empty.
    ``kind``: "name" of the time, bare "unit", "local" word for time, "min" alone, capital "letter" T, "odd": a name of
    the time with an ending that is not understood; or empty. ``doubtful``: whether the unit of a column that holds the
    times is not clear from this.
    """

    words: tuple[str, ...]
    unit: str
    kind: str
    doubtful: bool = False

    @property
    def unclear_unit(self) -> bool:
        """Whether it is doubtful by what is, or may be, a word for a unit of time."""
        known = bool(self.unit) or any(one in UNITS_OF_NAMES or one in SHORT for one in self.words)
        return self.doubtful and (known or _is_scaled(self.words))


def time_head(title: str) -> TimeHead:
    """Read the title of a column, without its unit in brackets; brackets in its middle are words of the name."""
    match = HEADER.fullmatch(title)
    bare = match["name"].strip() if match else title.strip()
    joined = SMALL_WORDS.sub(lambda one: f" {one[1]}s".lower(), bare)
    joined = SMALL_LETTERS.sub(lambda one: f" {one[1] if one[1].isascii() else 'u'}s", joined)
    text = " ".join(part for part in APART.sub(" ", joined).lower().split() if part != "in")
    text = LETTER_TOGETHER.sub(r"t \1", RUN_TOGETHER.sub(r"\1 \2", text))
    words, since = _without_origin(text.split())
    if len(words) < 2:
        return _of_one_word(words[0] if words else "", bare, since)
    units = [word for word in words if word in UNITS_OF_NAMES]
    if _is_scaled(words):
        return _of_other_words(words, True)
    if len(units) != 1:
        return _of_other_words(words, any(one not in OTHERWISE for one in units))
    (word,) = units
    unit, last = UNITS_OF_NAMES[word], words[-1] == word
    rest = tuple(one for one in words if one != word)
    if rest == ("t",) and last:
        small = bare.startswith("t") and (unit in LETTER_UNITS or word not in ("h", "hr", "d", "min"))
        return TimeHead(rest, unit, "name" if small else "", not small and unit not in LETTER_UNITS)
    kind = _kind(rest)
    if kind in ("name", "local"):
        if last or word not in OTHERWISE:
            return TimeHead(rest, unit, kind)
        return TimeHead(words, "", "odd" if kind == "name" else "", True)  # a least time, or so many minutes
    if last:
        return TimeHead(rest, unit, kind, kind == "odd" or unit in ("min", "hour", "day"))
    return _of_other_words(words, word not in OTHERWISE)


def _without_origin(words: Sequence[str]) -> tuple[tuple[str, ...], bool]:
    """Words without those that say from when times count, but for units; and whether `since` is one of these."""
    at = next((i for i, word in enumerate(words) if i and word in SINCE), len(words))
    behind = words[at + 1 :]
    left = (*words[:at], *(word for word in behind if word in UNITS_OF_NAMES))
    return left, bool(behind) and words[at] not in ("from", "after")


def _of_one_word(word: str, bare: str, since: bool) -> TimeHead:
    """Of a name of one word, behind which it may say since when times count."""
    words = (word,)
    if word == "t":
        return TimeHead(words, "", "name" if bare == "t" or since else "letter")
    if word in UNITS_OF_NAMES and (since or word not in OTHERWISE):
        return TimeHead(words, UNITS_OF_NAMES[word], "unit")
    if word == "min":
        return TimeHead(words, "min", "min")
    return TimeHead(words, "", _kind(words), word in ("h", "d", "std") or word in UNSURE or _is_scaled(words))


def _is_scaled(words: Sequence[str]) -> bool:
    """Whether a name has so many, or a part, of a unit: ``10ms``, ``1/100 s``, ``tenths of seconds``, ``uptime_cs``."""
    if any(COUNTED.fullmatch(word) or SCALED.fullmatch(word) for word in words) or (
        len(words) > 1 and words[-1] in ("cs", "ds", "ks")
    ):
        return True
    for before, word in pairwise(words):
        if word in UNITS_OF_NAMES and (before[0].isdecimal() or (before in PARTS and UNITS_OF_NAMES[word] == "s")):
            return True
    return not SCALES.isdisjoint(words) and any(word in UNITS_OF_NAMES for word in words)


def _of_other_words(words: tuple[str, ...], doubtful: bool) -> TimeHead:
    """Of a name of several words that has no unit of time, or none that is clear."""
    kind = _kind(words)
    timed = words[0] == "t" or words[0] in LOCAL_NAMES
    ends = UNITS_OF_NAMES.get(words[-1], "") in ("min", "hour", "day") or (timed and words[-1] in SHORT)
    return TimeHead(words, "", kind, doubtful or ends or kind == "odd" or words[0] in LOCAL_NAMES)


def _kind(words: Sequence[str]) -> str:
    if any(word in NAMES for word in words) and all(word in KINDS | NAMES for word in words):
        return "name"
    if len(words) == 1 and words[0] in LOCAL_NAMES:
        return "local"
    return "odd" if words and words[0] in ("time", "times", "timestamp", "elapsed") else ""


def unit_of_time(bracketed: str) -> str | None:
    """The unit that the brackets of a column of times give: ``MS``, ``Sec.``, ``in ms``, ``ms, rel``.

    Small and capital letters are one here. Empty for what is no unit, such as ``UTC``; None for what is not understood,
    for another quantity's unit, and for the form of a clock or a date. `m` may be metres, minutes or months.
    """
    plain = ZONE.sub("utc", " ".join(bracketed.casefold().replace("\u03bc", "\u00b5").split()))
    parts = (" ".join(_without_origin(part.split())[0]) for part in re.split("[,;]", plain))
    found = [part for part in (_bare_unit(one.removeprefix("in ").strip(" .")) for one in parts) if part]
    if not found:
        return ""
    if len(found) > 1:
        return None
    (unit,) = found
    known = UNITS_OF_NAMES.get(unit) or IN_BRACKETS.get(unit)
    if known:
        return known
    for text in (bracketed, unit):
        if unit != "m" and is_unit(text, "s"):
            return text
    return None


def _bare_unit(text: str) -> str:
    """What is left of a text in brackets without words that are no unit: ``unix ms`` -> ``ms``; or nothing."""
    return "" if text in NO_UNITS else " ".join(word for word in text.split() if word not in NO_UNITS)


def is_contradicted(title: str, bracketed: str) -> bool:
    """Whether the name of a column of times has another unit of time than its brackets: ``time_ms [s]``."""
    head, unit = time_head(title), unit_of_time(bracketed)
    return bool(head.unit) and not head.doubtful and unit in UNITS_OF_NAMES.values() and unit != head.unit


def is_of_days(name: str, names: Sequence[str], number: float = 0.0) -> bool:
    """Whether a column is no milliseconds, as its name says, but the days of a spreadsheet times a million.

    So WinCC writes `Time_ms`, beside the same moment as a text. `number` is one of its cells.
    """
    if name.casefold() != "time_ms":
        return False
    return not DATED.isdisjoint(one.casefold() for one in names) or DAYS[0] < number < DAYS[1]


def unit_of_stamps(name: str, bracketed: str) -> tuple[str, str]:
    """The unit of stamps by the name of their column and its brackets, and what is doubtful about it.

    The second is "unit" where a word that is or may be a unit is not clear, "name" where only the end of the name is
    not understood; else empty.
    """
    unit = unit_of_time(bracketed)
    if unit is None:
        return "", "unit"
    within = [one for one in map(unit_of_time, BRACKETS.findall(name)) if one]
    if not unit and within:  # brackets before others, or in the middle of the name: `Time (s) [UTC]`, `time (s) rel`
        return (within[0], "") if len(within) == 1 else ("", "unit")
    head = time_head(name)
    if unit or not head.doubtful:
        return unit or head.unit, ""
    return "", "unit" if head.unclear_unit else "name"


def time_columns(columns: Columns) -> list[int]:
    """Columns that may be the time, the likeliest kind only: one where it is clear, none where no header tells.

    A column that is called ``time``, or else ``t``, is it. Of several other names of the time those count that have a
    unit of time in brackets. A bracket with another unit rules a column out where another one is left.
    """
    heads = [time_head(title) for title in columns.titles]
    brackets = [unit_of_time(unit) for unit in columns.units]
    lasting = [i for i, unit in enumerate(brackets) if unit]
    foreign = [i for i, unit in enumerate(brackets) if unit is None]
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
