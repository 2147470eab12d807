"""The limits of a scene, read by what its model has: names of outputs and figures, units, places."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from itertools import product
from typing import Any

import numpy as np
from pydantic_core import PydanticCustomError

from tautline.results.assessment.bounds import Bound
from tautline.results.assessment.limits import AT_LEAST, AT_MOST
from tautline.scene.errors import LONGEST, Problem, SceneError, SceneWarning
from tautline.scene.limits import ABOVE, Limit
from tautline.scene.unit_slips import LISTED
from tautline.scene.values.printed import quantity
from tautline.scene.values.quantity import Quantity
from tautline.scene.values.systems import usual_unit
from tautline.system.handles import PART, Handles, Output, outputs_of, word_of
from tautline.system.model import Model

CLOSE, OFFERED, MOST_LISTED = 0.5, 3, 40
"""Likeness of names that are offered, and how many are."""


def with_limits(model: Model, scene: Any) -> Model:
    """The model of a scene with the limits that the scene gives itself; every application's `build` ends with it.

    Raises
    ------
    SceneError
        Listing every limit of an output that there is not, or of another unit, with its line, key and cure.
    """
    limits = getattr(scene, "limits", ())
    return replace(model, bounds=tuple(read_limits(limits, model, scene))) if limits else model


def read_limits(limits: Sequence[Limit], model: Model, scene: Any) -> list[Bound]:
    """Limits as bounds in SI on outputs and figures of a model.

    Parameters
    ----------
    scene
        For messages: its ``problem`` knows the file.

    Raises
    ------
    SceneError
        As `with_limits` does.
    """
    reader = _Reader(model, scene)
    found = [bound for i, limit in enumerate(limits) for bound in reader.read(i, limit)]
    if reader.problems:
        raise SceneError(reader.problems)
    return found


def bare_limits(scene: Any, build: Callable[[Any], Model]) -> list[SceneWarning]:
    """Warn of limits without a unit in a scene that is in other units than SI: they are read in SI.

    Parameters
    ----------
    build : callable
        Scene -> its model, which alone knows the units of outputs. It is called where there is such a limit only, and
        what it refuses is left to who builds the scene in earnest.
    """
    system, limits = getattr(scene, "units", "si"), getattr(scene, "limits", ()) or ()
    sides = [(i, limit, side) for i, limit in enumerate(limits) for side in limit.sides]
    # Zero is zero in all units.
    bare = [(i, side) for i, _, side in sides if not isinstance(side.written, str) and side.written != 0]
    if system == "si" or not bare:
        return []
    try:
        bounds = build(scene).bounds
    except SceneError:
        return []
    document, readings = getattr(scene, "document", None), []
    for (i, limit, side), bound in zip(sides, bounds, strict=True):
        usual = usual_unit(bound.unit, system)
        if (i, side) not in bare or not usual:
            continue
        line = document.line(("limits", i, side.key)) if document is not None else None
        where, typed = f" (line {line})" if line else "", f"{side.written:.10g}"
        other = quantity(float(Quantity(bound.unit, any_size=True).read(f"{typed} {usual}")), bound.unit)
        also = f"not {typed} {usual}" if other == f"{typed} {usual}" else f"{typed} {usual} would be {other}"
        readings.append(
            f"limits[{i}].{side.key} = {typed}{where} of {limit.output} is {typed} {bound.unit}, and {also}"
        )
    if not readings:
        return []
    more = f"; and {len(readings) - LISTED} more" if len(readings) > LISTED else ""
    count = "1 limit has" if len(readings) == 1 else f"{len(readings)} limits have"
    text = f"{system}, and {count} no unit. A number without a unit is read in SI: {'; '.join(readings[:LISTED])}{more}"
    return [SceneWarning("units", f"{text}. Write the unit that is meant")]


@dataclass(frozen=True)
class _Read:
    """What a name stands for: unit, and of an output how it is read of frames, and its places."""

    unit: str
    series: Any = None
    places: tuple[str, ...] = ("",)
    source: str = ""
    variable: str = ""
    absent: float | None = None


class _Reader:
    """Reads limits by the outputs and figures of a model, and collects what is wrong with them."""

    def __init__(self, model: Model, scene: Any) -> None:
        self.model, self.scene = model, scene
        handles = model.handles() if model.handles is not None else Handles(outputs=_plain(model))
        self.outputs: Mapping[str, Output] = handles.outputs
        self.instead = handles.instead
        self.problems: list[Problem] = []

    def fault(self, key: tuple[str | int, ...], cause: str, cure: str) -> None:
        self.problems.append(self.scene.problem(("limits", *key), cause, cure))

    def read(self, i: int, limit: Limit) -> list[Bound]:
        """The bounds of a limit."""
        name = limit.output.strip()
        read = self.named(i, name)
        if read is None:
            return []
        judged = [self.named(i, self.judged(name, side.fails)) or read for side in limit.sides]
        if read.series is None and limit.for_ > 0.0:
            cause = f"{name} is a figure of the whole run: it does not last"
            self.fault((i, "for"), cause, "remove it, or name an output over time")
        found = [self.number((i, side.key), side.written, read.unit) for side in limit.sides]
        if len(found) == 2 and None not in found and not found[0] > found[1]:
            (upper, _, _, _), (lower, _, _, _) = limit.sides
            cause = f"is not more than `{lower}`: every value would be beyond one of the two"
            cure = "a value fails the limit where it is above `above` or `at_most`, or below `below` or `at_least`"
            self.fault((i, upper), cause, cure)
        return [
            Bound(
                side.name, name, AT_MOST if side.fails == ABOVE else AT_LEAST, to, one.unit, limit.for_, one.series,
                one.places, one.source, one.variable, one.absent,
            )
            for side, one, to in zip(limit.sides, judged, found, strict=True)
            if to is not None
        ]  # fmt: skip

    def judged(self, name: str, fails: str) -> str:
        """What counts where an output, or one of its numbers, has a bound: most often itself."""
        part = None if name in self.outputs else PART.fullmatch(name)
        whole = part[1] if part else name
        other = self.outputs[whole].judged_by[fails != ABOVE] if whole in self.outputs else ""
        return other + name[len(whole) :] if other else name

    def number(self, key: tuple[str | int, ...], written: float | str, unit: str) -> float | None:
        """A bound in SI; a fault where it is none."""
        try:
            return float(Quantity(unit).read(written))
        except PydanticCustomError as error:
            self.fault(key, error.message(), str((error.context or {}).get("cure", "")))
            return None

    def named(self, i: int, name: str) -> _Read | None:
        """What an output or a figure is; a fault where it is none that can have a bound."""
        if name in self.outputs:
            return self.whole(i, self.outputs[name])
        part = PART.fullmatch(name)
        if part and part[1] in self.outputs:
            return self.part(i, self.outputs[part[1]], tuple(int(k) for k in part[2].split(",")))
        known = self.model.figure_units
        if name in known:
            return _Read(known[name], absent=0.0 if name in self.model.nothing else None)
        self.fault((i, "output"), "there is no such output, and no such figure", self.nearest(name))
        return None

    def nearest(self, name: str) -> str:
        """The names that were probably meant, or those that there are."""
        if word_of(name) in self.instead:
            return self.instead[word_of(name)]
        known = sorted({*self.outputs, *self.model.figure_units})
        lower = {one.lower(): one for one in known}
        close = get_close_matches(name[:LONGEST].lower(), list(lower), OFFERED, CLOSE)
        if close:
            return "did you mean " + " or ".join(f"'{lower[one]}'" for one in close) + "?"
        more = f", and {len(known) - MOST_LISTED} more" if len(known) > MOST_LISTED else ""
        return f"known: {', '.join(known[:MOST_LISTED])}{more}"

    def whole(self, i: int, output: Output) -> _Read | None:
        """An output with all of its places."""
        if output.source:
            whole = next(variable for variable in self.model.variables if variable.name == output.source)
            return _Read(output.unit, series_of(output), self.places(whole.dims[1:]), output.source, output.source)
        if output.has_components:
            self.fault((i, "output"), f"{output.name} has several components", output.one_of_components)
            return None
        places = output.labels or (self.places(output.dims) if output.shape else (_thing(output.name),))
        return _Read(output.unit, series_of(output), places, variable=output.variable)

    def part(self, i: int, output: Output, at: tuple[int, ...]) -> _Read | None:
        """One number of an output, or those of its places that are left."""
        try:
            one = output.part(at)
        except IndexError as error:
            cause, _, cure = str(error).partition(": ")
            self.fault((i, "output"), cause, cure)
            return None
        if one.has_components:
            cause = f"{one.name} has several components"
            self.fault((i, "output"), cause, output.one_of_components)
            return None
        places = self.places(one.dims) if one.shape else (_thing(output.name),)
        return _Read(output.unit, series_of(one), places)

    def places(self, dims: Sequence[str]) -> tuple[str, ...]:
        """Names of all places of some dimensions, in the order of a value's numbers."""
        nodes = self.nodes()
        if tuple(dims) == ("element", "end") and self.middles(len(self.labels("element"))) is not None:
            # Between nodes in a row an end is at a node, and not where the element's middle is.
            first, last = (self.labels("element", lengths) for lengths in (nodes[:-1], nodes[1:]))
            ends = self.labels("end")
            return tuple(
                f"{one}, {end}" for pair in zip(first, last, strict=True) for one, end in zip(pair, ends, strict=True)
            )
        return tuple(", ".join(words) for words in product(*(self.labels(dim) for dim in dims)))

    def labels(self, dim: str, lengths: np.ndarray | None = None) -> list[str]:
        """Names of the places of a dimension: as the coordinates have them, with the arc length where that is known.

        Parameters
        ----------
        lengths : (n,), optional
            Arc lengths that are told in place of those, m.
        """
        along = {
            name: np.asarray(values)
            for name, (dims, values, *_) in self.model.coordinates.items()
            if dims in (dim, (dim,))
        }
        named = along.get(f"{dim}_name", along.get(dim))
        if named is None:
            named = np.arange(len(next(iter(along.values()))) if along else 0)
        if named.dtype.kind in "USO":
            return [str(one) for one in named]
        if lengths is None:
            lengths = along.get("arc_length", self.middles(len(named)) if dim == "element" else None)
        at = [""] * len(named) if lengths is None else [f" at {x:.4g} m" for x in lengths]
        return [f"{dim} {number}{where}" for number, where in zip(named, at, strict=True)]

    def middles(self, count: int) -> np.ndarray | None:
        """Arc lengths of the middles of so many elements between nodes in a row; None where nodes have none."""
        nodes = self.nodes()
        return 0.5 * (nodes[1:] + nodes[:-1]) if len(nodes) == count + 1 else None

    def nodes(self) -> np.ndarray:
        """Arc lengths of the nodes (n,), m; none where they have none."""
        _, nodes, *_ = self.model.coordinates.get("arc_length", ((), np.zeros(0)))
        return np.asarray(nodes)


def _plain(model: Model) -> dict[str, Output]:
    """Outputs of an application that names none: its variables."""
    return outputs_of(model.variables, model.coordinates)


def _thing(name: str) -> str:
    """What an output belongs to, by its name: ``winch`` of ``winch.tension``; empty where it belongs to none."""
    return name.rpartition(".")[0]


def series_of(output: Output) -> Any:
    """What reads an output of many frames: variables of m frames -> (m, ...)."""
    return output.series or (lambda frames: output.one_by_one(frames, len(frames["time"])))
