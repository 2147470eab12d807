"""What a twin finds, as a result file: estimates, deviations, residuals and outputs over time."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tautline.results.errors import ResultError, WriteError
from tautline.results.result import Result
from tautline.results.store import Store
from tautline.results.variable import Variable
from tautline.scene.values.moments import stamp_said
from tautline.twin.condition import HEALTHS
from tautline.version import __version__

if TYPE_CHECKING:
    from tautline.twin.twin import Twin

BATCH = 200
"""Lines that are written at a time."""
STATES, ALARM = "alarm_state", "alarm"
"""Variable of the state of each alarm, and its dimension, of which the names are the coordinate."""
NOT_WATCHED, OFF, IN_DOUBT, CERTAIN = -1, 0, 1, 2
"""States of an alarm; the first is that of rows at which it was not watched, or of which an earlier version of the
program has stored none."""


class Series:
    """Collects lines of a twin and writes them batch by batch; the file is whole at every moment.

    Parameters
    ----------
    path : Path
        The result, NetCDF.
    twin : Twin
        Whose names and units it has.
    begin : float, optional
        Time, s, from which an operation is gone on with: what the result has up to then stays at its beginning, and
        what it has of later rows is replaced. NaN where no row was answered before.

    ended : bool
        Whether later rows were answered as the source had ended: what the result has of them stays until a line comes.

    Attributes
    ----------
    path : Path
    behind : bool
        Whether there are lines that could not be written.

    Raises
    ------
    ResultError
        For a path that cannot be written to, and for one that holds something else than the operation so far: the state
        and the result of an operation have the same mark.
    """

    def __init__(self, path: Path, twin: Twin, begin: float | None = None, ended: bool = False) -> None:
        plan, self.path = twin.plan, path
        self._columns: dict[str, Any] = {}
        variables: list[Variable] = []
        coordinates: dict[str, Any] = {}

        def add(name: str, unit: str, text: str, take: Any, shape: tuple[int, ...] = ()) -> None:
            name, dims = _name_in_file(name, self._columns), []
            for size in shape:
                dim = "axis" if size == 3 else f"of_{size}"
                coordinates.setdefault(dim, np.arange(size))
                dims.append(dim)
            variables.append(Variable(name, ("time", *dims), unit, text))
            self._columns[name] = (take, shape)

        for one in plan.unknowns:
            add(f"estimate {one.name}", one.unit, f"estimate of {one.name}", _take("estimates", one.name, "value"))
            add(
                f"deviation {one.name}",
                one.unit,
                f"standard deviation of {one.name}",
                _take("estimates", one.name, "sd"),
            )
        for moved in plan.inputs:
            add(f"input {moved.name}", moved.unit, f"{moved.name}, smoothed", _take("inputs", moved.name))
        for seen in plan.measured:
            name, unit = seen.name, seen.unit
            add(f"measured {name}", unit, f"{name}, measured", _take("measured", name))
            add(f"residual {name}", unit, f"{name}, measured less expected", _take("residuals", name))
        shapes = twin.plan_names.shapes
        for name in dict.fromkeys([*(one.name for one in plan.measured), *plan.keep]):
            add(name, twin.units.get(name, ""), f"{name}, computed", _take("outputs", name), shapes.get(name, ()))
        add("alarms", "", "number of alarms", lambda line: len(line["alarms"]))
        add("health", "", "0 good, 1 degraded, 2 lost", lambda line: HEALTHS.index(line["health"]))
        add("lag", "s", "time of a line behind the newest sample", lambda line: line["lag"])
        self._watched = list(twin.watch.names())
        earlier: dict[str, np.ndarray] | None = None
        former: list[str] = []
        if begin is not None and path.exists():
            earlier, former = self._earlier(path, begin, twin.mark)
        self._alarms = [*self._watched, *former]
        coordinates[ALARM] = np.array(self._alarms, object).astype(str)
        text = "state of each alarm: 0 off, 1 in doubt, 2 certain, -1 not watched"
        variables.append(Variable(STATES, ("time", ALARM), "", text))
        document = getattr(twin.scene, "document", None)
        attributes = {
            "title": heading(twin.scene),
            "scene": document.text if document else "", "version": __version__, "application": "twin",
            "operation": twin.mark,
            "printed_in": getattr(twin.scene, "units", "si"),
        }  # fmt: skip
        self._store = Store(path, variables, coordinates, attributes, resumable=False)
        self._lines: list[Mapping[str, Any]] = []
        self.behind = False
        self._before = earlier
        if not ended:
            self._go_on()

    def _go_on(self) -> None:
        """Keep what the result has of before, and replace what it has of later rows."""
        before, self._before = self._before, None
        if before is not None:
            self._store.append(before)

    def _earlier(self, path: Path, begin: float, mark: str) -> tuple[dict[str, np.ndarray], list[str]]:
        """Frames of the operation so far, up to a time, and names of alarms that are watched no more.

        Refuses a file of which anything would be lost by going on with it.
        """
        result = Result.read(path)
        names = {name for name, one in result.variables.items() if "time" in one.dims}
        wanted = {"time", *self._columns}
        cure = "name another file with -o, or the one of that operation"
        if result.attributes.get("application") != "twin" or not wanted <= names:
            cause = "does not hold what this twin tells, and the operation that is gone on with would replace it"
            raise ResultError(path, cause, cure)
        if result.attributes.get("operation", "") != mark:
            cause = "is the result of another operation than the one that is gone on with, which would replace it"
            raise ResultError(path, cause, cure)
        if further := sorted(names - wanted - {STATES}):
            cause = f"holds {', '.join(further)}, which this map does not ask for, and they would be lost"
            raise ResultError(path, cause, "name another file with -o, or let the map keep the same as before")
        times = np.asarray(result["time"])
        known = times <= begin
        if times.size and not known.any() and np.isfinite(begin):  # else all its rows are answered anew
            cause = f"begins at {stamp_said(float(times[0]))}, after {stamp_said(begin)}, from where the twin goes on"
            raise ResultError(path, cause, cure)
        kept = {name: np.asarray(result[name])[known] for name in wanted}
        former, states = _states_before(result, self._watched)
        return kept | {STATES: states[known]}, former

    def _states(self, line: Mapping[str, Any]) -> list[int]:
        """States (alarms,) in a line."""
        now = {one["name"]: CERTAIN if one["known"] else IN_DOUBT for one in line["alarms"]}
        return [now.get(name, OFF if name in self._watched else NOT_WATCHED) for name in self._alarms]

    def add(self, line: Mapping[str, Any]) -> None:
        """Take a line."""
        self._lines.append(line)
        if len(self._lines) >= BATCH:
            self.flush()

    def flush(self) -> None:
        """Write what there is.

        Raises
        ------
        WriteError
            Where that is not possible. Nothing is lost: it is written with the lines that come next.
        """
        if not self._lines:
            return
        lines, self._lines = self._lines, []  # the store keeps them from here on, also where it cannot write them yet
        frames = {"time": np.array([line["time"] for line in lines])}
        for name, (take, shape) in self._columns.items():
            rows = [take(line) for line in lines]
            frames[name] = np.array([_filled(row, shape) for row in rows], float)
        frames[STATES] = np.array([self._states(line) for line in lines], np.int8)
        self.behind = True
        self._go_on()
        self._store.append(frames)
        self.behind = False

    def finish(self, status: str) -> None:
        """Write the rest, and close; raises WriteError where that is not possible, and nothing hidden is left then."""
        with suppress(WriteError):  # `finish` tries again, and closes
            self.flush()
        self._store.finish({"status": status})
        self.behind = False


def heading(scene: Any) -> str:
    """What the twin of a scene is called in headings: by the scene's title; empty where it has none."""
    title = getattr(scene, "title", "")
    return f"Twin of {title}" if title else ""


def _states_before(result: Result, watched: Sequence[str]) -> tuple[list[str], np.ndarray]:
    """Alarms of an earlier result that are watched no more, and its states (rows, watched ones and those)."""
    names = [str(name) for name in result[ALARM]] if STATES in result.variables else []
    former = [name for name in names if name not in watched]
    states = np.full((len(result.time), len(watched) + len(former)), NOT_WATCHED, np.int8)
    for k, name in enumerate([*watched, *former]):
        if name in names:
            states[:, k] = result[STATES][:, names.index(name)]
    return former, states


def _take(*path: str) -> Any:
    def take(line: Mapping[str, Any]) -> Any:
        value: Any = line
        for key in path:
            value = value.get(key) if isinstance(value, Mapping) else None
        return value

    return take


def _name_in_file(name: str, taken: Collection[str]) -> str:
    """A name without ``/``, of which NetCDF makes a group where no reader looks; the variable's text has it in full."""
    name = name.replace("/", "_")
    while name in taken:
        name += "_"
    return name


def _filled(value: Any, shape: tuple[int, ...]) -> np.ndarray:
    """A value with NaN where there is none; a stored NaN says that nothing was measured."""
    if value is None:
        return np.full(shape, np.nan)
    return np.array(value, float)
