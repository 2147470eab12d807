"""A scatter diagram, how often each sea state occurs, and the fatigue of a rope over it.

Damage is linear (Palmgren and Miner): of N cycles of the equivalent range S it is N S^m, and over the diagram the sum
of those of the sea states, each by its share of time.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from crane.rope_life.fatigue import SLOPE
from tautline.scene.errors import Problem, SceneError, option_error
from tautline.scene.reading.columns import NO_UNIT, unit_named
from tautline.scene.values.units import UnknownUnit, read_unit

OPTION = "--scatter"
WHOLE = 1.0e-6
"""Share of time that may be lacking for what was run to count as all of it: rounding of sums."""
YEAR = 365.25 * 86400.0
COLLECTED = ("equivalent_tension_range", "tension_cycles")
UNIT = re.compile(r"\[\s*([^\]]*?)\s*\]|\(\s*([^)]*?)\s*\)")
"""What stands in brackets: in square ones a unit, in round ones a unit or a remark."""
WORD = re.compile(r"[^\W\d]\w*|[→↓]")
HEIGHT = re.compile(r"(?-i:H)|h_?s(_m)?|h_?m_?[0o]|h_?1|h_?sig|swh|hts?|heights?", re.IGNORECASE)
PEAK = re.compile(r"t_?p(_s|eak)?|peak", re.IGNORECASE)
PERIOD = re.compile(rf"{PEAK.pattern}|(?-i:T)|periods?", re.IGNORECASE)
ANOTHER = re.compile(r"t_?(z|zero|e|m|s|c|h?_?1_?3|av|avg|mean|m?_?0_?[12]|m?_?10|[12])(_s)?", re.IGNORECASE)
OTHER = r"mean|average|zero|energy|significant|crossing"
OF_A_PERIOD = re.compile(
    rf"({OTHER})([- ]*(up|down|crossing|wave))*[- ]*period|"
    r"(?<!return )periods?\s*\(\s*(mean|average|zero|energy)([- ]*(up|down|crossing))*\s*\)",
    re.IGNORECASE,
)
"""Words of the first cell: of a height, of a peak period, of any period, and of a period that is another one."""
WRITTEN = (
    (r"[{}$]", ""),
    (r"\bT\s*\(\s*([zep]|m\w+)\s*\)", r"T\1"),
    (r"(?<=\d)/(?=\d)", "_"),
    (r"\bT(_?m)?[-_, ]*-1[, ]*0\b", "Tm10"),
)
"""Ways to write an index: T_{z}, T(z), H1/3, T-1,0."""
SITE = re.compile(r"t_?[12s]", re.IGNORECASE)
"""Words of the latter that may be the name of something else beside a peak period, such as of a site."""
DOWN = re.compile(r"rows|down|↓|column|col", re.IGNORECASE)
ACROSS = re.compile(r"columns|cols|across|→|row", re.IGNORECASE)
"""Words by which the first cell says where something stands: in the rows, or in the first column; and so on."""
EXAMPLE = "the first row: Hs [m], then peak periods in s; each further row: a height in m, then occurrences"


class Scatter(NamedTuple):
    """Occurrences of sea states.

    Attributes
    ----------
    heights, periods : (n,), (m,) arrays
        Centres of the cells, increasing, m and s.
    share : (n, m) array
        Of time; sums to 1.
    """

    heights: np.ndarray
    periods: np.ndarray
    share: np.ndarray

    def of(self, height: float, period: float) -> float:
        """Share of time of a sea state; 0 of one that is not in the diagram."""
        at = np.isclose(self.heights, height)[:, None] & np.isclose(self.periods, period)[None, :]
        return float(self.share[at].sum())


def read_scatter(path: Path) -> Scatter:
    """Read a CSV table of occurrences, in any number: they are made shares of time.

    Raises
    ------
    SceneError
        Naming the line of what is no number, negative, missing, or not increasing, of a unit of anything but
        heights and periods, and of a first cell that names other periods, or periods before heights.
    """
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            rows = [(reader.line_num, row) for reader in [csv.reader(file)] for row in reader]
    except (OSError, UnicodeDecodeError) as error:
        cause = f"cannot be read: {getattr(error, 'strerror', None) or error}"
        raise option_error(OPTION, str(path), cause, "name a CSV file") from None
    rows = [(line, [cell.strip() for cell in row]) for line, row in rows if any(cell.strip() for cell in row)]
    problems: list[Problem] = []

    def number(line: int, cell: str, empty: float = math.nan) -> float:
        try:
            value = float(cell) if cell else empty
        except ValueError:
            value = math.nan
        if not (math.isfinite(value) and value >= 0.0):
            cause = "is empty" if not cell else "is no number that is zero or more"
            problems.append(Problem(str(path), line, "", cell or None, cause, EXAMPLE))
        return value

    if len(rows) < 2 or len(rows[0][1]) < 2:
        raise SceneError([Problem(str(path), None, "", None, "is no scatter diagram", EXAMPLE)])
    line, head = rows[0]
    _check_words(str(path), line, head[0])
    units = _units(str(path), line, head[0])
    periods = np.array([number(line, cell) for cell in head[1:]])
    table = []
    for line, row in rows[1:]:
        if len(row) != len(head):
            problems.append(_of_another_length(str(path), line, len(row), len(head)))
        cells = (row + [""] * len(head))[: len(head)]
        table.append([number(line, cells[0]), *(number(line, cell, 0.0) for cell in cells[1:])])
    if problems:
        raise SceneError(problems)
    heights, count = units["length"] * np.array(table)[:, 0], np.array(table)[:, 1:]
    periods = units["time"] * periods
    for values, what in ((heights, "heights"), (periods, "periods")):
        if not (np.all(np.diff(values) > 0.0) and values[0] > 0.0):
            cause = f"{what} are not above zero and increasing"
            raise SceneError([Problem(str(path), None, "", None, cause, "sort them, each once")])
    if not count.sum() > 0.0:
        raise SceneError([Problem(str(path), None, "", None, "has no occurrence above zero", EXAMPLE)])
    return Scatter(heights, periods, count / count.sum())


def _of_another_length(file: str, line: int, cells: int, head: int) -> Problem:
    """An empty cell is a sea that does not occur. Cells that are lacking may be those of a file that was cut off."""
    short = "give each row a cell for each period, 0 or empty where none occurs"
    return Problem(file, line, "", None, f"has {cells} cells, and the head {head}", short if cells < head else EXAMPLE)


def _check_words(file: str, line: int, head: str) -> None:
    """Refuse a first cell that surely names other periods than those of the peak, or periods before heights."""
    text = head
    for way, plain in WRITTEN:
        text = re.sub(way, plain, text)
    words = WORD.findall(text)
    if other := _another_period(text):
        other = other if other in head else head.strip()
        cause = f"'{other}' is not the peak period Tp, by which seas are given here"
        ratios = "for a JONSWAP sea of gamma 3.3 Tp is 1.286 Tz, 1.199 Tm01, 1.107 Te"
        cure = f"convert the periods ({ratios}), and write Hs [m] / Tp [s]"
        raise SceneError([Problem(file, line, "", head, cause, cure)])
    if turned := _turned(words):
        cause = "says '{} … {}': heights stand in the first column, and periods in the first row".format(*turned)
        cure = "if the first column has the periods, exchange rows and columns; write Hs [m] / Tp [s]"
        raise SceneError([Problem(file, line, "", head, cause, cure)])


def _another_period(text: str) -> str:
    """The period that a first cell names, where it is none of the peak; of several the first is that of the table."""
    words = list(WORD.finditer(text))
    peak = min((word.start() for word in words if PEAK.fullmatch(word[0])), default=None)
    others = [word for word in words if ANOTHER.fullmatch(word[0]) and (peak is None or not SITE.fullmatch(word[0]))]
    others += OF_A_PERIOD.finditer(text)
    first = min(others, key=lambda word: word.start(), default=None)
    return first[0] if first is not None and (peak is None or first.start() < peak) else ""


def _turned(words: list[str]) -> tuple[str, str] | None:
    """Two words that say that periods stand in the first column: where all periods are named before heights and not
    said to stand across, or heights are said to.
    """
    periods, heights, places = (
        [k for k, word in enumerate(words) if any(one.fullmatch(word) for one in kinds)]
        for kinds in ((PERIOD,), (HEIGHT,), (DOWN, ACROSS))
    )
    if not periods or not heights:
        return None
    if heights[0] < periods[0]:
        said = [k for k in places if heights[0] < k < periods[0]]
        return (words[heights[0]], words[said[0]]) if said and ACROSS.fullmatch(words[said[0]]) else None
    if periods[-1] > heights[0]:
        return None
    # The first place that is said is that of what is named beside it: of the periods, if it stands before the heights.
    if places and bool(ACROSS.fullmatch(words[places[0]])) == (places[0] < heights[0]):
        return None
    return words[periods[0]], words[heights[0]]


def _units(file: str, line: int, head: str) -> dict[str, float]:
    """Units of heights, m, and of periods, s, out of the first cell: ``Hs [ft] / Tp [s]``; 1 where it names none."""
    kinds = {read_unit("m").dimension: "length", read_unit("s").dimension: "time"}
    found: dict[str, float] = {}
    for square, round_ in UNIT.findall(head):
        text = square or round_
        if text in NO_UNIT:
            continue
        try:
            unit = read_unit(unit_named(text))
            kind = kinds.get(unit.dimension, "")
            cause = "" if kind else f"[{text}] is the unit neither of a height nor of a period"
        except UnknownUnit as error:
            if round_:
                continue
            cause = f"[{text}] is no unit: {error}"
        if not cause and kind in found:
            cause = f"[{text}] is a second unit of a {kind}"
        if cause:
            raise SceneError([Problem(file, line, "", head, cause, "write Hs [m], Hs [ft], or Hs [ft] / Tp [s]")])
        found[kind] = unit.si(Fraction(1))
    return {"length": 1.0, "time": 1.0} | found


class Fatigue(NamedTuple):
    """What a scatter diagram does to a rope.

    Attributes
    ----------
    damage : (headings, periods, heights) array
        Sum of n S^m in a year, by sea state with its share of time, N^m.
    range : float
        Constant range that does the damage in as many cycles, N.
    cycles : float
        In a year.
    covered : float
        Share of the time that was run. Of a sea state of which some storms failed it is the share of the others.
    life : float or None
        Years to the damage 1 of what was run: the life where all of it was, and else what it is at most. None without
        an S-N curve.
    share, run : (headings, periods, heights) arrays
        Share of time of each sea state, and the share of its storms that were run.
    """

    damage: np.ndarray
    range: float
    cycles: float
    covered: float
    life: float | None
    share: np.ndarray
    run: np.ndarray

    @property
    def any(self) -> bool:
        """Whether any of the time was run."""
        return self.covered > 0.0

    @property
    def unharmed(self) -> bool:
        """Whether the time that was run does no damage: no cycle counts, or the life is more than a number can be."""
        return self.any and (not self.damage.any() or self.life == math.inf)

    @property
    def whole(self) -> bool:
        """Whether all of the time was run."""
        return self.covered > 1.0 - WHOLE


def fatigue_over(
    scatter: Scatter, heights: np.ndarray, periods: np.ndarray, ranges: np.ndarray, cycles: np.ndarray, length: float,
    breaking_load: float | None = None, constant: float | None = None,
) -> Fatigue:  # fmt: skip
    """Sum rainflow damage over a scatter diagram.

    Parameters
    ----------
    heights, periods : (n,), (m,) arrays
        Of the sea states that were run.
    ranges, cycles : (headings, m, n, seeds) arrays
        Equivalent range, N, and its number of cycles in each storm; NaN where there is none. Headings count alike.
        A storm without them is time that was not run. It does no damage in the sum, and the others do not stand in for
        it: storms that fail are often those in which the rope snaps, whose damage is many times that of the others.
    length : float
        Of each storm, s.
    breaking_load, constant : float, optional
        S-N curve N (S / breaking load)^m = constant.
    """
    share = np.zeros((len(periods), len(heights)))
    for i, height in enumerate(scatter.heights):
        for j, period in enumerate(scatter.periods):
            at = np.flatnonzero(np.isclose(periods, period)), np.flatnonzero(np.isclose(heights, height))
            if at[0].size and at[1].size:
                share[at[0][0], at[1][0]] = scatter.share[i, j]
    with np.errstate(invalid="ignore"):
        known = np.isfinite(ranges) & np.isfinite(cycles)
        rate = np.where(known, cycles, 0.0).mean(axis=-1) / length
        damage = np.where(known, cycles * ranges**SLOPE, 0.0).mean(axis=-1) / length
    run = known.mean(axis=-1)
    of_each = np.broadcast_to(share / len(ranges), run.shape)
    each = YEAR * of_each
    total, count = float((each * damage).sum()), float((each * rate).sum())
    found = (total / count) ** (1.0 / SLOPE) if count > 0.0 else 0.0
    life = None
    if constant is not None and breaking_load is not None and total > 0.0:
        # In this order: a large constant times a large load is more than a number can be, where the life is not.
        life = constant * (breaking_load**SLOPE / total)
    return Fatigue(each * damage, found, count, float((of_each * run).sum()), life, of_each, run)


def share_outside(scatter: Scatter, states: Iterable[tuple[float, float]]) -> float:
    """Share of time of a diagram that sea states, each a height, m, and a period, s, leave out; 0 of rounding."""
    inside = sum(scatter.of(*state) for state in set(states))
    return 1.0 - inside if inside < 1.0 - WHOLE else 0.0


def not_covered(found: Fatigue) -> list[str]:
    """What is to be known where not all of the diagram was run: the damage of the rest is lacking."""
    if found.whole:
        return []
    share = 100.0 * (1.0 - found.covered)
    # At most by this sum, no more: what did run counts the most worked end of each storm, which may be too much.
    life = "" if found.life is None else ". With it the fatigue life is shorter: it is at most the one by this sum"
    return [
        f"{share:.3g} % of the time of the scatter diagram was not run (too steep, failed, or not among --hs and "
        f"--tp): its damage is not counted{life}"
    ]


def told(found: Fatigue) -> dict[str, Any]:
    """Keys of ``--json``."""
    life = found.life if found.life != math.inf else None
    return {
        "equivalent_tension_range": found.range if found.any else None,
        "cycles_per_year": found.cycles if found.any else None, "slope": SLOPE,
        "share_of_time": found.covered, "life_years": life if found.whole else None,
        "life_years_at_most": None if found.whole else life, "no_damage": found.unharmed,
    }  # fmt: skip
