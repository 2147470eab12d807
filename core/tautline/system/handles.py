"""What can be driven, read and changed of a model while it runs, by names."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from tautline.scene.values.printed import rounded
from tautline.system.time_functions import FunctionRequest, Steering, all_requests, reach_of

PART = re.compile(r"(.+)\[(\d+(?:\s*,\s*\d+)*)\]")
"""One of the numbers of an output: ``payload.position[2]``."""
COMPONENTS = frozenset({"axis", "side", "part"})
"""Dimensions of components, such as those of a force: the largest of them together means nothing."""
LAST_DIGITS = 4.0e-16
"""Share of a number by which two products of the same factors differ."""


@dataclass(frozen=True)
class Input:
    """What can be driven while a run goes on.

    Attributes
    ----------
    members : tuple of (Steering, int)
        The scene's functions that it drives, by their numbers, and how. Name, unit and meaning are those of the first.
    """

    members: tuple[tuple[Steering, int], ...]

    @property
    def steering(self) -> Steering:
        """Of the first function."""
        return self.members[0][0]


@dataclass(frozen=True)
class Output:
    """Something that can be read while a run goes on.

    Attributes
    ----------
    name, unit, text : str
        What it is.
    shape : tuple of int
        Of its value; ``()`` is a number. A size of 0 is one that is not known before a frame is seen.
    value : callable
        Variables of one frame, name -> array with time as the leading axis, -> the value.
    places : tuple of str and int array, or None
        ``q`` or ``v`` and full degrees of freedom, where it is nothing else than these: it is read in a microsecond.
    dims : tuple of str
        Dimensions of its value, as the variables of results name them; empty where they are not known.
    series : callable or None
        The same of many frames at once: variables of m frames -> (m, ...) array; None where that is no quicker.
    variable : str
        Variable of results that it is, or a part of; empty where it is made otherwise.
    source : str
        Variable of which it is the largest or the smallest; empty where it is no such thing.
    judged_by : (str, str)
        Outputs whose values count in place of its own where it has a bound above and where it has one below; empty
        where its own do.
    labels : tuple of str
        Names of its places, where they are others than those of its dimensions.
    size : str
        Figure of a run that is the largest size of such vectors; empty where there is none.
    jumps : bool
        Whether it says which of a few states something is in, and jumps between them.
    """

    name: str
    unit: str
    text: str
    shape: tuple[int, ...]
    value: Callable[[Mapping[str, np.ndarray]], Any]
    places: tuple[str, np.ndarray] | None = None
    dims: tuple[str, ...] = ()
    series: Callable[[Mapping[str, np.ndarray]], np.ndarray] | None = None
    variable: str = ""
    source: str = ""
    judged_by: tuple[str, str] = ("", "")
    labels: tuple[str, ...] = ()
    size: str = ""
    jumps: bool = False

    @property
    def has_components(self) -> bool:
        """Whether its numbers are components, and not places: no bound, and no largest, of all of them has a sense.

        So it is where its dimensions are not known.
        """
        return bool(self.shape) and (not self.dims or bool(COMPONENTS & set(self.dims)))

    @property
    def example(self) -> str:
        """How the first of its numbers is named: one index a dimension."""
        return f"{self.name}[{','.join('0' for _ in self.shape)}]" if self.shape else self.name

    @property
    def one_of_components(self) -> str:
        """What to name in place of a vector: a cure."""
        size = f"name {self.size}, the largest of all sizes, or " if self.size else "name "
        return f"{size}one of its numbers: {self.example} is the first"

    def number(self, at: tuple[int, ...]) -> Output:
        """One of its numbers, by its indices, as an output of its own.

        Raises
        ------
        IndexError
            Saying what is wrong with the indices.
        """
        if len(at) != len(self.shape):
            counted = (
                "is one number" if not self.shape else f"has {len(self.shape)} index" + "es" * (len(self.shape) > 1)
            )
            raise IndexError(f"{self.name} {counted}")
        if 0 in self.shape:
            raise IndexError(f"{self.name} has none of these")
        return self.part(at)

    def part(self, at: tuple[int, ...]) -> Output:
        """One of its numbers, or all those that its first indices leave, as an output of its own.

        Raises
        ------
        IndexError
            Saying which indices it has.
        """
        if len(at) > len(self.shape):
            axes = len(self.shape)
            counted = "is one number" if not axes else f"has {'one index' if axes == 1 else f'{axes} indices'}"
            raise IndexError(f"{self.name} {counted}: write {self.example}")
        for k, size in zip(at, self.shape, strict=False):
            # A size of 0 is one that is not known.
            if k >= size > 0:
                raise IndexError(f"{self.name} has {size} of these: count from 0 to {size - 1}")
        whole, series, index = self.value, self.series, f"[{','.join(map(str, at))}]"
        in_each: Any = (slice(None), *at)
        above, below = (other and other + index for other in self.judged_by)
        return replace(
            self, name=self.name + index, shape=self.shape[len(at) :], dims=self.dims[len(at) :], labels=(),
            value=lambda frame: whole(frame)[at],
            places=None if self.places is None else (self.places[0], np.asarray(self.places[1][at])),
            series=None if series is None else lambda frames: series(frames)[in_each], judged_by=(above, below),
        )  # fmt: skip

    def one_by_one(self, frames: Mapping[str, np.ndarray], count: int) -> np.ndarray:
        """Its values in so many frames that were observed together, (count, ...)."""
        return np.array([self.value(OneFrame(frames, k)) for k in range(count)], float)


class OneFrame(Mapping[str, np.ndarray]):
    """One of several frames that were observed together: the variables of that frame alone."""

    def __init__(self, observed: Mapping[str, np.ndarray], frame: int) -> None:
        self._observed, self._part = observed, slice(frame, frame + 1)

    def __getitem__(self, name: str) -> np.ndarray:
        return self._observed[name][self._part]

    def __iter__(self) -> Iterator[str]:
        return iter(self._observed)

    def __len__(self) -> int:
        return len(self._observed)


class Bounds(NamedTuple):
    """What a parameter may be: from ``least``, which it must exceed where ``positive``, to ``most``."""

    least: float
    positive: bool
    most: float

    def hold(self, value: float) -> bool:
        """Whether a parameter may have this value."""
        low = value < self.least or (self.positive and value == self.least)
        return math.isfinite(value) and not low and value <= self.most

    def told(self, unit: str) -> str:
        """What may be given: ``more than 0, at most 1 (no unit)``; what is printed of the most may be given, too."""
        unit = unit or "no unit"
        if not math.isfinite(self.least):
            return f"a finite number ({unit})"
        bounds = f"more than {self.least:g}" if self.positive else f"at least {self.least:g}"
        upper = f", at most {rounded(self.most, 6):g}" if math.isfinite(self.most) else ""
        return f"{bounds}{upper} ({unit})"


@dataclass(frozen=True)
class Parameter:
    """A number of the scene that can be changed while a run goes on.

    Attributes
    ----------
    name, unit, text : str
        What it is.
    get : callable
        -> its value.
    set : callable
        Takes a new value into the groups' arrays.
    least : float
        The smallest value that it may have.
    positive : bool
        Whether it must be more than that.
    most : float
        The largest.
    not_below : str
        Another parameter, whose value it may equal and not be less than once the run goes on; empty where there is
        none. Which of two is given first does not matter.
    """

    name: str
    unit: str
    text: str
    get: Callable[[], Any]
    set: Callable[[Any], None]
    least: float = -np.inf
    positive: bool = False
    most: float = np.inf
    not_below: str = ""

    @property
    def bounds(self) -> Bounds:
        """What it may be."""
        return Bounds(self.least, self.positive, self.most)


@dataclass(frozen=True)
class Prepared:
    """A function of time that is known up to a time only: a record, or what was computed ahead for the run.

    Attributes
    ----------
    function : int
        Its number.
    key : str
        Where it stands in the scene.
    until : float
        s.
    """

    function: int
    key: str
    until: float


@dataclass
class Handles:
    """All of a model's, by name; and the functions of time that are `prepared`.

    ``instead`` tells of words of the field that are no name here, as `word_of` writes them, what to name for them.
    ``lacking`` tells of parameters that this scene has not, by their names, why.
    """

    inputs: dict[str, Input] = field(default_factory=dict)
    outputs: dict[str, Output] = field(default_factory=dict)
    parameters: dict[str, Parameter] = field(default_factory=dict)
    prepared: tuple[Prepared, ...] = ()
    instead: dict[str, str] = field(default_factory=dict)
    lacking: dict[str, str] = field(default_factory=dict)


def word_of(name: str) -> str:
    """A name as `Handles.instead` has it: ``hook_load`` for ``Hook load``."""
    return re.sub(r"[\s_-]+", "_", name.strip().lower())


def output_named(outputs: Mapping[str, Output], name: str) -> Output | None:
    """An output by its name, or one of its numbers by name and indices; None where there is none.

    Raises
    ------
    IndexError
        For indices that an output does not have.
    """
    return _named(outputs, name, Output.number)


def part_named(outputs: Mapping[str, Output], name: str) -> Output | None:
    """The same, or all the numbers that the first indices leave."""
    return _named(outputs, name, Output.part)


def _named(
    outputs: Mapping[str, Output], name: str, take: Callable[[Output, tuple[int, ...]], Output]
) -> Output | None:
    if name in outputs:
        return outputs[name]
    part = PART.fullmatch(name)
    if part is None or part[1] not in outputs:
        return None
    return take(outputs[part[1]], tuple(int(k) for k in part[2].split(",")))


def prepared_of(requests: Sequence[FunctionRequest]) -> tuple[Prepared, ...]:
    """Which of the requests, that the scene's functions were compiled from, end with what was prepared."""
    reaches = [(i, request, reach_of(request)) for i, request in enumerate(all_requests(requests))]
    return tuple(Prepared(i, request.key, until) for i, request, until in reaches if np.isfinite(until))


def inputs_of(requests: Sequence[FunctionRequest]) -> dict[str, Input]:
    """Inputs by name, of the requests that the scene's functions were compiled from."""
    made: dict[str, Input] = {}
    for i, request in enumerate(all_requests(requests)):
        for steering in request.inputs:
            known = made[steering.name].members if steering.name in made else ()
            made[steering.name] = Input((*known, (steering, i)))
    return made


def outputs_of(
    variables: Sequence[Any],
    coordinates: Mapping[str, Any],
    things: Mapping[str, str] | None = None,
    names: Mapping[str, Sequence[str]] | None = None,
) -> dict[str, Output]:
    """Outputs by name: every variable as a whole, and parts of some by the names of things.

    Parameters
    ----------
    variables : sequence of tautline.results.variable.Variable
        What a frame holds; the second dimension of those in `things` has names.
    coordinates : mapping
        name -> (dimension, values, unit, text), of which the names of a dimension are taken.
    things : mapping
        Variable -> what it is of a thing: ``{"body_position": "position"}`` makes ``payload.position``.
    names : mapping
        Names of a dimension's things where they are not its coordinate's values.

    The size of a dimension that no coordinate tells is 0: `tautline.live.readings.with_shapes` looks at a frame.
    """
    sizes = {dim: len(values) for dim, values, *_ in coordinates.values() if isinstance(dim, str)}
    made = {}
    for variable in variables:
        shape = tuple(sizes.get(dim, 0) for dim in variable.dims[1:])
        made[variable.name] = Output(
            variable.name, variable.units, variable.long_name, shape, _whole(variable.name), None, variable.dims[1:],
            _all_of(variable.name), variable.name, jumps=variable.jumps,
        )  # fmt: skip
    for variable in variables:
        what = (things or {}).get(variable.name)
        if what is None:
            continue
        dim = variable.dims[1]
        shape = tuple(sizes.get(dim, 0) for dim in variable.dims[2:])
        for k, thing in enumerate((names or {}).get(dim) or coordinates[dim][1]):
            name = f"{thing}.{what}"
            made[name] = part_of(variable, name, k, shape)
    return made


def _whole(name: str) -> Callable[[Mapping[str, np.ndarray]], Any]:
    return lambda frame: frame[name][0]


def _part(name: str, k: int) -> Callable[[Mapping[str, np.ndarray]], Any]:
    return lambda frame: frame[name][0, k]


def _all_of(name: str) -> Callable[[Mapping[str, np.ndarray]], np.ndarray]:
    return lambda frames: frames[name]


def _part_of_all(name: str, k: int) -> Callable[[Mapping[str, np.ndarray]], np.ndarray]:
    return lambda frames: frames[name][:, k]


def part_of(variable: Any, name: str, k: int, shape: tuple[int, ...] = (), text: str = "") -> Output:
    """An output that is the k-th of a variable."""
    return Output(
        name, variable.units, text or variable.long_name, shape, _part(variable.name, k), None, variable.dims[2:],
        _part_of_all(variable.name, k), variable.name, jumps=variable.jumps,
    )  # fmt: skip


def same_as(output: Output, name: str) -> Output:
    """An output under another name."""
    return replace(output, name=name)


def extreme_of(variable: Any, name: str, text: str, choose: Callable[[np.ndarray], Any]) -> Output:
    """An output that is the largest, or the smallest, of a variable."""
    source = variable.name
    return Output(
        name, variable.units, text, (), lambda frame: choose(frame[source][0]),
        series=lambda frames: np.array([choose(one) for one in frames[source]]), source=source,
        jumps=variable.jumps,
    )  # fmt: skip


def number(
    name: str, unit: str, text: str, places: Sequence[np.ndarray], *, least: float = 0.0, positive: bool = True,
    factor: Sequence[float] | None = None, most: float = np.inf,
) -> Parameter:  # fmt: skip
    """A parameter that stands as it is, or times factors, in some places: views of the groups' arrays."""
    factors = [1.0] * len(places) if factor is None else list(factor)

    def get() -> float:
        # To divide by what a value was multiplied by does not give it back: 0.005 came as 0.004999999999999999.
        stands, times = float(places[0].flat[0]), factors[0]
        short = float(f"{stands / times:.15g}")
        return short if math.isclose(short * times, stands, rel_tol=LAST_DIGITS) else stands / times

    def change(value: float) -> None:
        for place, times in zip(places, factors, strict=True):
            place[...] = value * times

    return Parameter(name, unit, text, get, change, least, positive, most)
