"""A result that keeps statistics and windows round the extremes in place of every frame.

It stands in the place of `tautline.results.store.Store`: frames come in batches as the loop makes them, and are given
up when their statistics are taken. The application's figures and limits are made of pieces of the run and joined: the
largest of the largest, the smallest of the smallest. Each piece knows the frame at the start of the run, from which a
rise is measured, and which counts for nothing else where values count from a later time on. Figures that are sums over
all frames, or that count events, cannot be made so and are left out. Limits of the scene are looked at in every frame.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from tautline.results.assessment.bounds import NO_FRAME_COUNTS, Bound, Tally
from tautline.results.assessment.limits import AT_MOST
from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.results.store import Store
from tautline.results.variable import Variable
from tautline.statistics.streaming import Blocks, Moments, Turns, Windows

PIECE = 400_000
"""Numbers of a piece of which figures are made."""
BINS = 64
"""Of a rainflow histogram."""
KEPT, STATISTICS = "kept", "statistics"
"""Attribute of a result, and its value, that says that it keeps statistics."""
LEFT_OUT = "figures_left_out"
"""Attribute that names the figures which such a result does not have, between commas."""
LARGEST, SMALLEST, LAST = "largest", "smallest", "last"


@dataclass(frozen=True)
class Keep:
    """What a scene asks to be kept, and what its application makes of it.

    Attributes
    ----------
    windows, block, begin : float
        Length of windows and of blocks, and from when on values count, s.
    watched : tuple of str
        Variables of which turning points, blocks and windows are kept.
    fatigue : tuple of str
        Those of them of which rainflow cycles are counted.
    rules : mapping
        Pattern of a figure's name -> how it is joined: `LARGEST`, `SMALLEST`, `LAST`.
    names : tuple of str
        Figures that are asked of pieces, where an application has a quicker way to some than to all.
    of_turns : callable or None
        (variable -> Turns) -> figures that follow from turning points.
    turned : tuple of str
        Their names.
    possible : tuple of str
        Figures that a run of the scene can have with every frame, those that are texts or several numbers too; empty
        where an application does not say.
    """

    windows: float
    block: float
    begin: float = 0.0
    watched: tuple[str, ...] = ()
    fatigue: tuple[str, ...] = ()
    rules: Mapping[str, str] = field(default_factory=dict)
    names: tuple[str, ...] = ()
    of_turns: Callable[[Mapping[str, Turns]], dict[str, dict[str, Any]]] | None = None
    turned: tuple[str, ...] = ()
    possible: tuple[str, ...] = ()

    def makes(self, name: str) -> bool:
        """Whether statistics tell a figure of the application, by its name: others need every frame."""
        return any(re.fullmatch(rule, name) for rule in self.rules) or (
            self.of_turns is not None and name in self.turned
        )


class Digest(Result):
    """What is kept of a run, with the figures and limits of all of its frames."""

    def __init__(
        self, contents: Any, figures: dict[str, Any], records: list[dict[str, Any]], tallies: Sequence[Tally]
    ) -> None:
        super().__init__(None, contents)
        self.figures, self.records, self.tallies = figures, records, tallies


def told_by_digest(model: Any) -> Any:
    """A model whose figures and limits are those that were joined of pieces."""
    return replace(model, headline=lambda digest: digest.figures, figures=None, limits=lambda digest: digest.records)


def check_whole(result: Result, verb: str) -> None:
    """Raise ResultError for a result that keeps statistics, of which a verb that needs every frame makes nothing."""
    if result.attributes.get(KEPT) == STATISTICS:
        cause = f"keeps statistics and windows round the extremes, not every frame: {verb} needs every frame"
        cure = "run the scene with `output: {keep: frames, interval: ...}`, or read its variables: tautline.Result.read"
        raise ResultError(result.path or "result", cause, cure)


class StatisticsStore(Store):
    """Takes batches of frames and keeps their statistics.

    Parameters
    ----------
    path, variables, coordinates, attributes
        As of `Store`.
    keep : Keep
    headline, limits : callable
        Result -> figures, and records of limits.
    bounds : sequence of tautline.results.assessment.bounds.Bound
        Limits of the scene, which are looked at in every frame that counts.
    figures : collection of str
        Names of all figures that a run can have with every frame, where `keep` does not tell them.
    """

    def __init__(
        self,
        path: str | Path | None,
        variables: Sequence[Variable],
        coordinates: Mapping[str, Any] | None,
        attributes: Mapping[str, Any] | None,
        keep: Keep,
        headline: Callable[[Any], dict[str, dict[str, Any]]],
        limits: Callable[[Any], list[dict[str, Any]]] | None,
        bounds: Sequence[Bound] = (),
        figures: Collection[str] = (),
    ) -> None:
        super().__init__(path, variables, coordinates, attributes)
        # That there is no figure of events, where none are made, does not say that there was no event.
        self._tallies = [Tally(one if keep.makes(one.output) else replace(one, absent=None)) for one in bounds]
        self._left_out = [name for name in keep.possible or figures if not keep.makes(name)]
        self.keep, self._headline, self._limits = keep, headline, limits
        self._moments: dict[str, Moments] = {}
        self._turns = {name: Turns() for name in keep.watched}
        self._blocks = {name: Blocks(keep.block) for name in keep.watched}
        self._windows = Windows(keep.windows)
        self._first: dict[str, np.ndarray] = {}
        self._last: dict[str, np.ndarray] = {}
        self._piece: list[dict[str, np.ndarray]] = []
        self._waiting = 0
        self.figures: dict[str, dict[str, Any]] = {}
        self.records: dict[str, dict[str, Any]] = {}
        self._finished = False

    def append(
        self,
        frames: Mapping[str, np.ndarray],
        restart: Mapping[str, np.ndarray] | None = None,
        attributes: Mapping[str, Any] | None = None,
    ) -> None:
        """Take the statistics of a batch of frames; see `Store.append`. What is to be gone on with is not kept."""
        batch = self._checked(frames)
        time = batch["time"]
        if len(time) == 0:
            return
        if self.frames == 0:
            self._first = {name: values[:1].copy() for name, values in batch.items()}
        self._last = {name: values[-1:].copy() for name, values in batch.items()}
        self.frames += len(time)
        self._now |= dict(attributes or {})
        keep = self.keep
        watched = {name: _columns(batch[name]) for name in keep.watched}
        # The rounding of a sum of steps must not leave out the frame at `begin` itself.
        begin = keep.begin * (1.0 - 1e-12)
        self._windows.add(batch, watched, begin)
        start = int(np.searchsorted(time, begin))
        if start < len(time):
            self._accumulate(batch, watched, time, start)
            self._piece.append({name: values[start:] for name, values in batch.items()})
            self._waiting += sum(values.size for values in batch.values())
            if self._waiting >= PIECE:
                self._join()

    def _accumulate(
        self, batch: dict[str, np.ndarray], watched: dict[str, np.ndarray], time: np.ndarray, start: int
    ) -> None:
        """Take the statistics of the frames of a batch from one on."""
        for name, values in batch.items():
            if name != "time":
                self._moments.setdefault(name, Moments()).add(time[start:], _columns(values)[start:])
        for name, values in watched.items():
            self._turns[name].add(time[start:], values[start:])
            self._blocks[name].add(time[start:], values[start:])

    def _join(self) -> None:
        """Make the figures and limits of the frames that wait, and join them with those before."""
        if not self._piece:
            return
        arrays = {name: np.concatenate([part[name] for part in self._piece]) for name in self._first}
        self._piece, self._waiting = [], 0
        contents = (self.variables, arrays, self.coordinates, self.attributes, {})
        piece = Result(None, contents, start=self.start or self._first)
        for tally in self._tallies:
            tally.add(arrays, arrays["time"])
        if self.keep.rules:
            # What is of the end of the run, and is not of this piece, the end has not.
            self.figures = {name: one for name, one in self.figures.items() if self._rule(name) != LAST}
            for name, figure in self._headline(piece).items():
                self._join_figure(name, figure)
        for record in self._limits(piece) if self._limits is not None else ():
            before = self.records.get(record["name"])
            if before is None or _worse(record, before):
                self.records[record["name"]] = record

    def _rule(self, name: str) -> str | None:
        """How a figure is joined; None where it is not."""
        return next((rule for pattern, rule in self.keep.rules.items() if re.fullmatch(pattern, name)), None)

    def _join_figure(self, name: str, figure: dict[str, Any]) -> None:
        rule = self._rule(name)
        if rule is None:
            return
        before = self.figures.get(name)
        if before is not None and rule == LARGEST and not figure["value"] > before["value"]:
            return
        if before is not None and rule == SMALLEST and not figure["value"] < before["value"]:
            return
        self.figures[name] = figure

    @property
    def result(self) -> Result | None:
        """What is kept so far, with the figures of all frames; None before the first batch."""
        if self.frames == 0:
            return None
        self._join()
        figures = dict(self.figures)
        if self.keep.of_turns is not None and self._moments:
            figures |= self.keep.of_turns(self._turns)
        arrays = self._frames()
        contents = (self.variables, arrays, self.coordinates, self.attributes, {})
        return Digest(contents, figures, self._records(), self._tallies)

    def _records(self) -> list[dict[str, Any]]:
        """Records of the application's limits; they are not judged where no frame counts."""
        if self._moments or self._limits is None:
            return list(self.records.values())
        # What is judged does not hang on the frame: which limits there are, and their bounds, the last one tells too.
        last = Result(None, (self.variables, self._last, self.coordinates, self.attributes, {}), start=self._first)
        nothing = {"value": None, "passed": None, "time": None, "place": "", "note": NO_FRAME_COUNTS}
        return [record | nothing for record in self._limits(last)]

    def finish(
        self, attributes: Mapping[str, Any] | None = None, restart: Mapping[str, np.ndarray] | None = None
    ) -> Result | None:
        """Write the statistics and the frames of the windows; see `Store.finish`."""
        if self.frames == 0 or self._finished:
            return super().finish(attributes, {})
        self._finished = True
        self._join()
        count, arrays = self.frames, self._frames()
        self.coordinates |= self._statistics()
        self.attributes |= {
            KEPT: STATISTICS, "frames_seen": count, "windows": self._told_windows(),
            "statistics_begin": self.keep.begin, "block": self.keep.block, LEFT_OUT: ", ".join(self._left_out),
        }  # fmt: skip
        self.frames, self._batches = 0, []
        super().append(arrays)
        return super().finish(attributes, {})

    def _frames(self) -> dict[str, np.ndarray]:
        """Frames of all windows, the first and the last."""
        return self._windows.frames([self._first, self._last])

    def _told_windows(self) -> list[dict[str, Any]]:
        dims = {variable.name: variable.dims[1:] for variable in self.variables}
        told = []
        for (name, which), window in self._windows.kept.items():
            shape = self._first[name].shape[1:]
            place = [
                self._place(dim, k) for dim, k in zip(dims[name], np.unravel_index(window.place, shape), strict=True)
            ]
            told.append({
                "variable": name, "extreme": which, "value": window.value, "time": window.time, "place": place,
                "begin": max(window.begin, float(self._first["time"][0])),
                "end": min(window.end, float(self._last["time"][0])),
            })  # fmt: skip
        return told

    def _place(self, dim: str, k: Any) -> Any:
        known = self.coordinates.get(dim)
        value = known[1][k] if known is not None and known[0] == (dim,) else int(k)
        return value.item() if isinstance(value, np.generic) else value

    def _statistics(self) -> dict[str, Any]:
        """Statistics as arrays that do not change with time: name -> (dimensions, array, unit, long name)."""
        made: dict[str, Any] = {}
        described = {variable.name: variable for variable in self.variables}
        for name, moments in self._moments.items():
            variable = described[name]
            shape, dims, unit, text = self._first[name].shape[1:], variable.dims[1:], variable.units, variable.long_name
            for word, values, units, what in (
                ("mean", moments.mean, unit, "mean"), ("sd", moments.sd, unit, "standard deviation"),
                ("min", moments.low, unit, "smallest"), ("max", moments.high, unit, "largest"),
                ("min_time", moments.low_time, "s", "time of the smallest"),
                ("max_time", moments.high_time, "s", "time of the largest"),
            ):  # fmt: skip
                made[f"{name}_{word}"] = (dims, np.reshape(values, shape), units, f"{what}, {text}")
            if name in self._turns:
                made |= self._of_watched(name, moments, shape, dims, unit, text)
        return made

    def _of_watched(
        self, name: str, moments: Moments, shape: tuple[int, ...], dims: tuple[str, ...], unit: str, text: str
    ) -> dict[str, Any]:
        turns, blocks = self._turns[name], self._blocks[name]
        n = moments.mean.size
        counts = np.array([turns.upcrossings(k, float(moments.mean[k])) for k in range(n)])
        period = np.where(counts > 0, moments.span / np.maximum(counts, 1), 0.0)
        made: dict[str, Any] = {
            f"{name}_crossings": (dims, counts.reshape(shape), "", f"up-crossings of the mean, {text}"),
            f"{name}_period": (
                dims,
                period.reshape(shape),
                "s",
                f"time of the statistics over the number of up-crossings of the mean, 0 if none, {text}",
            ),
        }
        if blocks.whole:
            low, high = blocks.extremes(n)
            made["block"] = (("block",), blocks.begins, "s", "start of the block")
            made[f"{name}_block_min"] = (
                ("block", *dims),
                low.reshape(-1, *shape),
                unit,
                f"smallest of a block, {text}",
            )
            made[f"{name}_block_max"] = (
                ("block", *dims),
                high.reshape(-1, *shape),
                unit,
                f"largest of a block, {text}",
            )
        if name in self.keep.fatigue:
            edges, cycles = rainflow_histogram(turns, n)
            bins = f"{name}_range"
            made[bins] = ((bins,), edges[1:], unit, "upper end of the bin of ranges")
            made[f"{name}_rainflow"] = ((*dims, bins), cycles.reshape(*shape, -1), "", f"rainflow cycles, {text}")
        return made


def rainflow_histogram(turns: Turns, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Rainflow cycles (ASTM E1049-85) of n values by range: edges (bins + 1,), counts (n, bins)."""
    tables = [turns.cycles(k) for k in range(n)]
    most = max((float(ranges.max(initial=0.0)) for ranges, _ in tables), default=0.0)
    edges = np.linspace(0.0, most or 1.0, BINS + 1)
    counts = np.array([np.histogram(ranges, edges, weights=count)[0] for ranges, count in tables])
    return edges, counts


def _columns(values: np.ndarray) -> np.ndarray:
    """Frames by values, (m, n)."""
    return values.reshape(len(values), -1)


def _worse(one: Mapping[str, Any], other: Mapping[str, Any]) -> bool:
    """Whether a record of a limit is worse than another: further beyond it, or nearer to it."""
    a, b = one["value"] / one["limit"], other["value"] / other["limit"]
    return bool(a > b) if one["sense"] == AT_MOST else bool(a < b)
