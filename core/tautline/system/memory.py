"""What a run must remember to be gone on with: its state, and what its groups keep from step to step."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from tautline.elements.outside import OutsideForces
from tautline.kernels.dofs import Dofs
from tautline.kernels.time_function import TimeFunctions


def arrays_of(thing: Any, name: str) -> Iterator[tuple[str, np.ndarray]]:
    """All arrays of a tuple of named tuples, with a name that tells the place: ``groups.4.law.rows``."""
    if isinstance(thing, (TimeFunctions, Dofs)):
        return  # they follow from the scene; functions may reach further when a run is gone on with
    if isinstance(thing, np.ndarray):
        yield name, thing
    elif isinstance(thing, tuple):
        for key in getattr(thing, "_fields", range(len(thing))):
            if key == "address" and isinstance(thing, OutsideForces):
                continue  # it is of one simulation in one process: another would call a function that is not its own
            part = getattr(thing, key) if isinstance(key, str) else thing[key]
            yield from arrays_of(part, f"{name}.{key}")


def places_of(state: Any, groups: tuple[Any, ...], method: Any) -> dict[str, np.ndarray]:
    """The arrays of state, groups and method themselves: they stay where they are for the whole run."""
    things = ("state", state), ("groups", groups), ("method", method)
    return {name: array for start, thing in things for name, array in arrays_of(thing, start)}


def copied(places: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Copies of arrays; records are kept as their bytes."""
    return {
        name: np.frombuffer(array.tobytes(), np.uint8).copy() if array.dtype.names else array.copy()
        for name, array in places.items()
    }


def remember(state: Any, groups: tuple[Any, ...], method: Any) -> dict[str, np.ndarray]:
    """Copy the arrays of state, groups and method; records are kept as their bytes."""
    return copied(places_of(state, groups, method))


def recall(memory: Mapping[str, np.ndarray], state: Any, groups: tuple[Any, ...], method: Any) -> list[str]:
    """Write remembered arrays back into state, groups and method of the same scene.

    Returns
    -------
    list of str
        Names of arrays that do not fit, because they belong to another scene; nothing is written then.
    """
    places = places_of(state, groups, method)
    wrong = sorted(set(places) ^ set(memory))
    wrong += [name for name, place in places.items() if name in memory and place.nbytes != memory[name].nbytes]
    if not wrong:
        restore(memory, places)
    return wrong


def restore(memory: Mapping[str, np.ndarray], places: Mapping[str, np.ndarray]) -> None:
    """Write copies of arrays back into the arrays that they are of."""
    for name, place in places.items():
        place[...] = np.frombuffer(memory[name].tobytes(), place.dtype).reshape(place.shape)


class Beginning:
    """What groups remember before a run: the next one of the same model begins as this one did.

    Stuck contacts, worn rope and scratch are brought back. What somebody has set since the run ended stays set.

    Parameters
    ----------
    groups : tuple
        Of a model that has not run.
    """

    def __init__(self, groups: tuple[Any, ...]) -> None:
        self._before = remember((), groups, ())
        self._after = self._before

    def has_ended(self, groups: tuple[Any, ...]) -> None:
        """A run has ended."""
        self._after = remember((), groups, ())

    def bring_back(self, groups: tuple[Any, ...]) -> None:
        """Have the groups as they were, but for what is no longer as the run left it."""
        for name, place in places_of((), groups, ()).items():
            before, after = self._before[name], self._after[name]
            if not np.array_equal(before, after):
                for column, was, left in _columns(place, before, after):
                    column[...] = np.where(_same(column, left), was, column)


def _columns(place: np.ndarray, *copies: np.ndarray) -> Iterator[tuple[np.ndarray, ...]]:
    """An array, or each field of its records, with the same of its copies."""
    alike = [np.frombuffer(one.tobytes(), place.dtype).reshape(place.shape) for one in copies]
    for field in place.dtype.names or [()]:
        yield place[field], *(one[field] for one in alike)


def _same(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Where two arrays are the same; no number is the same as no number."""
    return (a == b) | ((a != a) & (b != b))
