"""A stored variable, or a part of it, by the words of a command line: ``tension:winch to boom tip:first``."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from tautline.results.errors import ResultError, once_each
from tautline.results.result import Result
from tautline.view.figures.comparison import listed, nearest

LONGEST_TEXT = 44
"""Letters of a variable's description that an axis has room for; of longer ones the name stands for it."""
COMPONENTS = ("axis", "side", "part")
"""Dimensions whose members are no things of one kind, but directions: each is drawn in a panel of its own."""
QUOTES = "\"'"


class Chosen(NamedTuple):
    """Values of a variable, or of a part of it."""

    text: str
    """What it is: ``tension, winch to boom tip``."""
    unit: str
    dims: tuple[str, ...]
    """Dimensions that are left; ``time`` is the first where it changes with time."""
    values: np.ndarray
    labels: tuple[tuple[str, ...], ...]
    """Names along each dimension after ``time``."""
    things: bool = False
    """Whether the members of each of these dimensions, directions left out, have names: they are no row of numbers."""
    size: float = 0.0
    """Largest magnitude in any direction, be it chosen or not: what is rounding of it says nothing."""

    @property
    def items(self) -> tuple[str, ...]:
        """Dimensions after ``time`` but for directions."""
        dims = self.dims[1:] if self.changes else self.dims
        return dims[:-1] if dims[-1:] and dims[-1] in COMPONENTS else dims

    @property
    def changes(self) -> bool:
        """Whether it changes with time."""
        return self.dims[:1] == ("time",)

    def panels(self) -> list[tuple[str, list[str], np.ndarray]]:
        """Parts to draw one below the other: (text, names of the columns, values (frames, columns)).

        Directions are parts; of what has none there is one.
        """
        values, labels = self.values, list(self.labels)
        parts: list[tuple[str, np.ndarray]] = [(self.text, values)]
        if self.dims[-1:] and self.dims[-1] in COMPONENTS and len(self.dims) > 1:
            parts = [(f"{self.text}, {name}", values[..., k]) for k, name in enumerate(labels.pop())]
        columns = [", ".join(words) for words in itertools.product(*labels)]
        return [(text, columns, part.reshape(len(part), -1)) for text, part in parts]


def split(words: str) -> tuple[str, str]:
    """Name of a variable, and what follows its colon."""
    name, _, rest = words.partition(":")
    return name.strip(), rest.strip()


def choose(result: Result, words: str, option: str = "--what") -> Chosen:
    """Find a variable, or a part of it.

    Parameters
    ----------
    words : str
        A variable's name; after colons, members of its dimensions: the name or number that the result gives them, as
        ``body_position:payload:z`` or ``axial_force:3``, or where they have neither a place, counted from 0. A place
        below 0 counts from the end. Dimensions may be left out.

    Raises
    ------
    ResultError
        If there is no such variable or member.
    """
    name, rest = split(words)
    if name not in result.variables:
        cure = (
            once_each(words, option) or f"{nearest(name, list(result.variables))}it has {', '.join(result.variables)}"
        )
        raise ResultError(option, f"{result.path or 'the result'} has no variable '{name}'", cure)
    variable, values = result.variables[name], result[name]
    dims, picked, text = list(variable.dims), list[tuple[str, str]](), variable.long_name
    taken: dict[str, int] = {}
    every, left = values, list(dims)
    if values.dtype.kind not in "fiub":
        raise ResultError(option, f"'{name}' are names, not numbers", "name a variable with values")
    own = [dim for dim in dims if dim != "time"]
    while rest:
        dim, place, member, rest = _member(result, own, values.shape[len(dims) - len(own) :], rest, words, option)
        axis = len(dims) - len(own) + own.index(dim)
        values = np.take(values, place, axis=axis)
        del dims[axis], own[own.index(dim)]
        if dim not in COMPONENTS:
            every = np.take(every, place, axis=left.index(dim))
            left.remove(dim)
        directions = _directions(result, dim, text)
        taken[dim] = place
        picked.append((dim, directions[place] if directions else member if _named(result, dim) else f"{dim} {member}"))
    called = {dim: _called(result, dim, taken) for dim in variable.dims}
    labels = tuple(tuple(called[dim] or _words(result, dim, values.shape[dims.index(dim)], text)) for dim in own)
    for dim in variable.dims:
        text = text.removesuffix(", ".join(_directions(result, dim, text)))
    text = _text(text, name)
    things = all(_named(result, dim) for dim in own if dim not in COMPONENTS)
    size = _size(np.asarray(every, float))
    said = [called[dim][taken[dim]] if called[dim] else words for dim, words in picked]
    return Chosen(
        ", ".join([text, *said]), variable.units, tuple(dims), np.asarray(values, float), labels, things, size
    )


def _size(values: np.ndarray) -> float:
    """Largest magnitude of what is finite; 0 of nothing."""
    return float(np.abs(values[np.isfinite(values)]).max(initial=0.0))


def _member(
    result: Result, dims: list[str], sizes: tuple[int, ...], rest: str, words: str, option: str
) -> tuple[str, int, str, str]:
    """Dimension, place and name of the member that the rest begins with, and what is left of the rest.

    Names go before numbers, and dimensions are asked in their order.
    """
    for dim, size in zip(dims, sizes, strict=True):
        labels = _labels(result, dim, size)
        # The longest first: a name may begin as another does.
        for k in sorted(range(size) if _named(result, dim) else (), key=lambda k, labels=labels: -len(labels[k])):
            for member in (labels[k], *(f"{quote}{labels[k]}{quote}" for quote in QUOTES)):
                if rest == member or rest.startswith(member + ":"):
                    return dim, k, labels[k], rest[len(member) + 1 :]
    word, _, left = rest.partition(":")
    counted = word.strip().removeprefix("-").isdecimal()
    if dims and counted:
        number, labels = int(word), _labels(result, dims[0], sizes[0])
        if not _named(result, dims[0]) and str(number) in labels:
            return dims[0], labels.index(str(number)), str(number), left
        if -sizes[0] <= number < (sizes[0] if _named(result, dims[0]) else 0):
            return dims[0], number % sizes[0], labels[number], left
    members = [member for dim, size in zip(dims, sizes, strict=True) for member in _labels(result, dim, size)]
    if not members:
        raise ResultError(option, f"'{words}': there is nothing to choose from with '{rest}'", "leave it out")
    cause = f"'{words}': there is no '{word}' in {' or '.join(dims)}"
    raise ResultError(option, cause, f"{'' if counted else nearest(word, members)}there are {listed(members)}")


def _named(result: Result, dim: str) -> bool:
    """Whether members of a dimension have names that are no numbers."""
    return dim in result.variables and result[dim].dtype.kind not in "fiub"


def _labels(result: Result, dim: str, size: int) -> list[str]:
    """Names or numbers of the members of a dimension; places where the result gives neither."""
    if dim in result.variables and len(result[dim]) == size:
        return [str(member) for member in result[dim]]
    return [str(k) for k in range(size)]


def _words(result: Result, dim: str, size: int, long_name: str) -> list[str]:
    """What a figure calls the members of a dimension of a variable that is described so."""
    labels = _labels(result, dim, size)
    if dim in COMPONENTS or _named(result, dim):
        return _directions(result, dim, long_name) or labels
    return [f"{dim} {label}" for label in labels]


def _called(result: Result, dim: str, taken: Mapping[str, int]) -> list[str]:
    """Names that members of a dimension have where members of others are taken: the ends of a span are its items.

    A result tells them by ``DIM_name``, along those others too; empty where it does not, or others are left.
    """
    told = result.variables.get(f"{dim}_name")
    if told is None or len(told.dims) < 2 or any(other not in taken for other in told.dims if other != dim):
        return []
    names = np.moveaxis(np.asarray(result[f"{dim}_name"]), told.dims.index(dim), -1)
    return [str(name) for name in names[tuple(taken[other] for other in told.dims if other != dim)]]


def _directions(result: Result, dim: str, long_name: str) -> list[str]:
    """Directions that a description lists at its end, as ``velocity north, east, down``, and their dimension too."""
    told = result.variables[dim].long_name if dim in COMPONENTS and dim in result.variables else ""
    names = told.split(", ")
    return names if told and long_name.endswith(f" {told}") and len(names) == len(result[dim]) else []


def _text(long_name: str, name: str) -> str:
    """A variable's description without its second thoughts, or its name where that is shorter."""
    text = long_name.split(";")[0].split(",")[0].strip()
    return text if text and len(text) <= LONGEST_TEXT else name.replace("_", " ")
