"""Friction factor back-calculated from hook loads that were measured while tripping."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from drillstring.model.prepared import well_of
from drillstring.scene.scene import DrillstringScene
from drillstring.statics.enough_links import links, settled_links
from drillstring.statics.helix import LockedUp
from drillstring.statics.statics import Statics, shortened
from drillstring.statics.torque_drag import own_friction, require_wall
from drillstring.string.factors import Factors, same
from tautline.integrators.status import Status, StoppedEarly
from tautline.scene.errors import Problem, SceneError
from tautline.scene.reading.columns import Columns, unit_named
from tautline.scene.reading.nulls import NEAR, written_for_none
from tautline.threads import one_thread

TOLD = 1.0e-6
"""Share of the largest derivative below which loads do not depend on a factor, or on a combination of two."""
START, MOST = 0.2, 1.0
"""Friction factor that the fit begins with, and the largest that it tries."""
STEP = 1.0e-3
"""Half the difference of factors that derivatives are taken over: the statics end within a tolerance, and what that
leaves of a load would be all of a derivative over much less."""
NONE = 1.0e-6
"""Factor below which there is no friction."""
BEYOND = 0.01
"""Share of the rotating weight by which a load on the wrong side of it is off by more than the gauge."""
PICK_UP, SLACK_OFF = ("pick_up", "pick up", "pick-up", "pickup"), ("slack_off", "slack off", "slack-off", "slackoff")
ENDINGS = ("", " weight", "_weight", "-weight")
COLUMNS = {
    "depth": ("depth", "measured depth", "md", "bit depth"),
    "pick_up": ("puw", *(f"{one}{end}" for one in ("pu", *PICK_UP) for end in ENDINGS)),
    "slack_off": ("sow", *(f"{one}{end}" for one in ("so", *SLACK_OFF) for end in ENDINGS)),
}
"""Headers that are read as each column."""
UNITS = {"depth": "m", "pick_up": "N", "slack_off": "N"}
LOADS = ("pick_up", "slack_off")
NO_LOAD = "no load in this row (a number such as -999.25 stands for none)"


class Measured(NamedTuple):
    """Hook loads of a trip: bit depth (n,) m; pick-up and slack-off (n,) N, NaN where not measured; lines (n,).

    ``unit`` is what the file has depths in, and ``size`` that unit, m. ``unused`` are titles of columns
    that are not read. ``nulls`` is how many loads are numbers that rigs write for none, such as -999.25.
    """

    depth: np.ndarray
    pick_up: np.ndarray
    slack_off: np.ndarray
    lines: np.ndarray
    unit: str = "m"
    size: float = 1.0
    unused: tuple[str, ...] = ()
    nulls: int = 0

    def told(self, depth: float) -> str:
        """A depth, m, as the file has it."""
        return f"{depth / self.size:.7g} {self.unit}"


class Unexplained(NamedTuple):
    """A load on the wrong side of the rotating weight, N, with the bit at a depth, m: friction acts the other way."""

    depth: float
    direction: str
    load: float
    rotating: float


class Fit(NamedTuple):
    """Friction factor that fits best, and its spread; in a cased hole both factors.

    ``friction`` is that of the open hole. ``spread`` is the standard error of the factor, from the residuals; NaN where
    there are no more loads than factors, infinite where the loads do not tell it. ``residual`` is the root mean square
    of what the loads are off, N; ``pick_up`` and ``slack_off`` are the open hole's factors that fit each alone, NaN
    where there are too few loads. ``cased`` and ``cased_spread`` are None in a hole without casing. ``unexplained`` are
    the loads that no factor explains. ``model_error`` is what the model itself may be off by, which residuals do not
    tell: it moves all loads together, and the factor with them. ``elements_error`` is what other elements would
    change in the factors, the largest, and about what more of them would. ``elements`` is how many the strings have,
    ``compared`` how many those have that ``elements_error`` is from: half, or as many as feel the bends of the hole
    where the strings' do not.
    """

    friction: float
    spread: float
    residual: float
    pick_up: float
    slack_off: float
    loads: int
    cased: float | None = None
    cased_spread: float | None = None
    unexplained: tuple[Unexplained, ...] = ()
    model_error: float = 0.0
    cased_model_error: float | None = None
    elements_error: float = 0.0
    elements: int = 0
    compared: int = 0

    @property
    def error(self) -> float:
        """Standard error of the factor with what the model may be off by."""
        return float(np.hypot(self.spread, self.model_error))

    @property
    def cased_error(self) -> float | None:
        """The same of the cased hole's factor; None in a hole without casing."""
        if self.cased_spread is None or self.cased_model_error is None:
            return None
        return float(np.hypot(self.cased_spread, self.cased_model_error))

    @property
    def out_of_reach(self) -> bool:
        """Whether a factor ended at the largest that is tried, and would have gone beyond."""
        return max(self.friction, self.cased or 0.0) > MOST - STEP

    def factors(self, shoe: float) -> Factors:
        """Of a hole with its casing shoe at a depth, m, or 0."""
        return Factors(self.friction, self.friction if self.cased is None else self.cased, shoe)


def read_measured(path: Path, block: float = 0.0) -> Measured:
    """Read a CSV file with the columns depth, pick_up and slack_off; units stand in the header.

    An empty cell, a number that rigs write for none, such as -999.25, or a column that is missing, is a load that was
    not measured. The weight of the ``block``, N, which
    the rig's gauge shows with the string's, is taken off.

    Raises
    ------
    SceneError
        Naming the file, the row and what is wrong with it.
    """
    columns = Columns(path)
    _refuse_doubles(columns)
    wanted = [name for name in ("depth", *LOADS) if name == "depth" or _has(columns, name)]
    if wanted == ["depth"]:
        columns.refuse_title_lines()
        cause = "there is neither a column 'pick_up' nor 'slack_off'"
        columns.stop(columns.header_line, "pick_up, slack_off", None, cause, "name them in the header")
    written = {name: _column(columns, name) for name in wanted}
    columns.raise_if_any()
    none = {name: _nulls(written[name][0]) for name in wanted if name != "depth"}
    for name, where in none.items():
        written[name][0][where] = np.nan
    values = {name: found * factor for name, (found, factor) in written.items()}
    lines = np.array(columns.lines)
    missing = np.full(lines.size, np.nan)
    up, down = (values.get(name, missing) for name in LOADS)
    place = columns.index(COLUMNS["depth"])
    size = columns.factor((place, columns.units[place]), "depth", "m")
    unit = unit_named(columns.units[place])
    known = {head for heads in COLUMNS.values() for head in heads}
    heads = zip(columns.names, columns.titles, strict=True)
    unused = tuple(title for name, title in heads if name not in known and title.strip())
    nulls = sum(int(where.sum()) for where in none.values())
    measured = Measured(values["depth"], up - block, down - block, lines, unit, size, unused, nulls)
    _check(path, measured, block, columns)
    return measured


def _refuse_doubles(columns: Columns) -> None:
    """Refuse two columns of one meaning: one would be left out, and nobody would know which."""
    for name, heads in COLUMNS.items():
        found = [title for head, title in zip(columns.names, columns.titles, strict=True) if head in heads]
        if len(found) > 1:
            cause = f"the header has two such columns, the other is '{found[0]}'"
            columns.stop(columns.header_line, name, found[1], cause, "rename the one that is not meant")


def _has(columns: Columns, name: str) -> bool:
    return any(head in COLUMNS[name] for head in columns.names)


def _nulls(written: np.ndarray) -> np.ndarray:
    """Which loads (n,), as the file has them, stand for none: where others come near, they are loads that push."""
    null = written_for_none(written)
    lowest = np.fmin.reduce(written[~null], initial=np.inf)
    return null & ~(lowest < NEAR * written)


def _column(columns: Columns, name: str) -> tuple[np.ndarray, float]:
    """A column as it is written, with NaN for empty cells of loads, and the size of its unit in SI."""
    at = columns.index(COLUMNS[name])
    # Hook loads come in kN, t, kip and klbf, depths in m and ft, and a guess would fit a factor all the same.
    factor = columns.factor((at, columns.units[at]), name, UNITS[name])
    found = []
    for line, row in columns.rows:
        cell = row[at] if at < len(row) else ""
        found.append(columns.number(line, name, cell) if cell or name == "depth" else np.nan)
    return np.array(found, float), factor


def _as_written(columns: Columns, name: str, line: int) -> str:
    """A load as the file has it, with its unit."""
    at = columns.index(COLUMNS[name])
    return f"{dict(columns.rows)[line][at].strip()} {unit_named(columns.units[at])}"


def _check(path: Path, measured: Measured, block: float, columns: Columns) -> None:
    """Refuse rows that no trip has, in the numbers of the file."""
    problems: list[tuple[int, str, str | None, str, str]] = []
    for line, depth, up, down in zip(measured.lines, measured.depth, measured.pick_up, measured.slack_off, strict=True):
        if depth <= 0.0:
            problems.append((line, "depth", measured.told(depth), "not below the rotary table", "give the bit's depth"))
        if np.isnan(up) and np.isnan(down):
            problems.append((line, "pick_up, slack_off", None, NO_LOAD, "fill one in, or delete the row"))
        if up < down:
            cause = f"smaller than slack_off = {_as_written(columns, 'slack_off', line)}: friction makes it larger"
            cure = "swap the two, or check the columns' units"
            problems.append((line, "pick_up", _as_written(columns, "pick_up", line), cause, cure))
        if block > 0.0 and (up < 0.0 or down < 0.0):
            cause = f"smaller than top.weight = {block:g} N, which it holds"
            name = "pick_up" if up < 0.0 else "slack_off"
            cure = "remove top.weight if the loads are without it"
            problems.append((line, name, _as_written(columns, name, line), cause, cure))
    if problems:
        raise SceneError([Problem(str(path), int(line), *rest) for line, *rest in problems])


def fit(
    scene: DrillstringScene,
    measured: Measured,
    elements: int | None = None,
    path: Path | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Fit:
    """Friction factor whose hook loads come nearest to those measured: least squares, over both directions.

    Where the scene has a casing, its factor and that of the open hole are sought together. The loads are those of the
    statics of the lumped model (statics.py). The spread is the standard error: the square root of the diagonal of
    s^2 (J^T J)^-1 with s^2 the squares of the residuals over n - m, J the derivatives of the n loads with respect to
    the m factors. The model's own error is what half the elements, or the soft string that crosses the hole from side
    to side, would change in the factors, the larger of both: the first falls with the number of elements, and what the
    second leaves is stretch and stiffness, which a soft string lacks.

    Raises
    ------
    SceneError
        For depths at which the string does not fit the well, by row.
    StoppedEarly
        Where no equilibrium was found, naming the load.
    """
    require_wall(scene)
    _check_depths(scene, measured, path)
    count, strings = _links(scene, measured) if elements is None else elements, []
    for done, depth in enumerate(measured.depth, 1):
        strings.append(Statics(scene, float(depth), count, unit=measured.unit))
        if progress is not None:
            progress(done, measured.depth.size)
    rows = [
        (string, direction, float(load))
        for direction in LOADS
        for string, load in zip(strings, getattr(measured, direction), strict=True)
        if np.isfinite(load)
    ]
    shoe = own_friction(scene).shoe
    one_way = [_least_squares([row for row in rows if row[1] == name], shoe)[0] for name in LOADS]
    alone = {name: found[0] for name, found in zip(LOADS, one_way, strict=True)}
    # Where both directions lead alone is near where they lead together.
    known = [found for found in one_way if np.isfinite(found).all()]
    factors, errors, slopes = _least_squares(rows, shoe, np.mean(known, axis=0) if known else None)
    n, spread = len(rows), _spread(errors, slopes)
    residual = float(np.sqrt(errors @ errors / n))
    both = (float(factors[1]), float(spread[1])) if shoe > 0.0 else (None, None)
    together = Factors(float(factors[0]), float(factors[-1]), shoe)
    compared = _compared(scene, float(measured.depth.max()), count)
    by_elements, by_soft = _model_error(scene, rows, together, errors, slopes, compared)
    off = np.maximum(by_elements, by_soft)
    return Fit(
        float(factors[0]), float(spread[0]), residual, alone["pick_up"], alone["slack_off"], n, *both,
        unexplained=_unexplained(rows), model_error=float(off[0]),
        cased_model_error=float(off[1]) if shoe > 0.0 else None,
        elements_error=float(by_elements.max()), elements=count, compared=compared[0],
    )  # fmt: skip


def _check_depths(scene: DrillstringScene, measured: Measured, path: Path | None) -> None:
    """Refuse depths at which the string does not fit the well, by row."""
    length = well_of(scene).length
    for depth, line in zip(measured.depth, measured.lines, strict=True):
        try:
            shortened(scene, length, float(depth), scene.model.elements, unit=measured.unit)
        except SceneError as error:
            found = error.problems[0]
            problem = Problem(
                str(path or "measured"), int(line), "depth", measured.told(depth), found.cause, found.cure
            )
            raise SceneError([problem]) from None


def _links(scene: DrillstringScene, measured: Measured) -> int:
    """Links that feel the bends of the hole, at about the friction that is sought."""
    own = own_friction(scene)
    friction = own if own.largest > 0.0 else same(START, own.shoe)
    return settled_links(scene, measured.depth.tolist(), [friction], measured.unit)[0]


@one_thread()
def _model_error(
    scene: DrillstringScene, rows: list[tuple[Statics, str, float]], factors: Factors, errors: np.ndarray,
    slopes: np.ndarray, compared: tuple[int, float],
) -> np.ndarray:  # fmt: skip
    """By how much other models would have other factors (2, m): half the elements, and the soft string.

    The soft string crosses the hole as this one does (crossings.py): that a string without clearance does not is known,
    and no error. Each is solved once, at the factors that were fitted: its change of the loads is one of the factors by
    the slopes of the fit, and no other fit is made. Where elements cannot be halved, twice the change to twice as many
    tells the same.
    """
    if len(rows) < slopes.shape[1] or not slopes.size:
        return np.full((2, 2), np.nan)
    other, share = compared
    others = {depth: Statics(scene, depth, other) for depth in {string.depth for string, *_ in rows}}
    # The fit has ended with these loads: they are not sought again.
    loads = errors + np.array([measured for *_, measured in rows])
    by_elements = share * (np.array([_hook_load((others[row[0].depth], *row[1:]), factors) for row in rows]) - loads)
    by_soft = np.array([_soft_hook_load(string, way, factors) for string, way, _ in rows]) - loads
    # A soft string that locks up has no load to compare with.
    back = np.linalg.pinv(slopes, rcond=TOLD)
    return np.array([np.abs(back @ np.nan_to_num(each)) for each in (by_elements, by_soft)])


def _compared(scene: DrillstringScene, depth: float, count: int) -> tuple[int, float]:
    """Elements to compare with, and the share of the change to them that is told.

    Where those of the fit do not feel the bends of the hole half of them do not either, and change nothing: then it is
    those that do.
    """
    if (enough := links(scene, [depth], least=count)) > count:
        return enough, 1.0
    # A string has an element for each of its sections at least.
    return (count // 2, 1.0) if count // 2 >= len(scene.string) else (2 * count, 2.0)


def _soft_hook_load(string: Statics, way: str, factors: Factors) -> float:
    """Hook load of the soft string, N."""
    return string.soft.solved(factors, way, string.bit_force, crosses=True).hook_load


@one_thread()
def _least_squares(
    rows: list[tuple[Statics, str, float]], shoe: float, start: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Factors (m,), open and cased, residuals (n,) N, and derivatives (n, m) N; NaN of fewer rows than factors."""
    count = 2 if shoe > 0.0 else 1
    if len(rows) < count:
        return np.full(count, np.nan), np.zeros(0), np.zeros((0, count))
    size = max(abs(load) for *_, load in rows)

    def errors(x: np.ndarray) -> np.ndarray:
        factors = Factors(float(x[0]), float(x[-1]), shoe)
        return np.array([_hook_load(row, factors) - row[2] for row in rows]) / size

    def slopes(x: np.ndarray) -> np.ndarray:
        columns = []
        for k in range(count):
            low, high = x.copy(), x.copy()
            low[k], high[k] = max(0.0, x[k] - STEP), min(MOST, x[k] + STEP)
            columns.append((errors(high) - errors(low)) / (high[k] - low[k]))
        return np.column_stack(columns)

    begin = [START] * count if start is None else start
    found = least_squares(errors, begin, slopes, bounds=(0.0, MOST), xtol=1e-8, ftol=1e-12, gtol=1e-12)
    # The search stays inside of its bounds: what ends at zero is a little above.
    return np.where(found.x < NONE, 0.0, found.x), found.fun * size, found.jac * size


def _hook_load(row: tuple[Statics, str, float], factors: Factors) -> float:
    """Hook load of a string in the direction of a measured one, N."""
    string, way, load = row
    try:
        return string.solve(factors, way).hook_load
    except (StoppedEarly, LockedUp) as stop:
        detail = f"friction factor {factors:g}" if isinstance(stop, StoppedEarly) else str(stop)
        part = f"{way.replace('_', ' ')} {load / 1e3:g} kN with the bit at {string.depth:g} m"
        detail = f"{detail}, tried to explain the load: check it, and the block's weight"
        raise StoppedEarly(Status.NO_EQUILIBRIUM, 0.0, part, detail) from None


def _unexplained(rows: list[tuple[Statics, str, float]]) -> tuple[Unexplained, ...]:
    """Loads that friction would have to push the other way for."""
    found = []
    for string, way, load in rows:
        rotating = string.solve(0.0, "rotating").hook_load
        lacking = rotating - load if way == "pick_up" else load - rotating
        if lacking > BEYOND * abs(rotating):
            found.append(Unexplained(string.depth, way, load, rotating))
    return tuple(found)


@one_thread()
def _spread(errors: np.ndarray, slopes: np.ndarray) -> np.ndarray:
    """Standard errors of the factors (m,): infinite of one that the loads do not tell."""
    n, m = slopes.shape
    if n <= m:
        return np.full(m, np.nan)
    _, sizes, ways = np.linalg.svd(slopes, full_matrices=False)
    told = sizes > TOLD * sizes[0]
    variance = errors @ errors / (n - m) * (ways[told] ** 2 / sizes[told, None] ** 2).sum(axis=0)
    untold = (ways[~told] ** 2).sum(axis=0) > TOLD
    return np.where(untold, np.inf, np.sqrt(variance))
