"""Variables that are made when they are asked for: of many runs only some figures are wanted."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any, Self

import numpy as np

from tautline.results.result import Result
from tautline.results.store import TIME, coordinate
from tautline.results.variable import Variable


class OnDemand(Mapping[str, Any]):
    """A mapping of which each value is made when it is first asked for.

    Parameters
    ----------
    made : mapping of str to callable
        Name -> what makes the value.
    """

    def __init__(self, made: Mapping[str, Callable[[], Any]]) -> None:
        self._made = made
        self._known: dict[str, Any] = {}

    def also(self, **made: Callable[[], Any]) -> OnDemand:
        """The same with further values, each made when it is first asked for; of what is known nothing is made anew."""
        further = OnDemand({**self._made, **made})
        further._known = self._known
        return further

    def __getitem__(self, name: str) -> Any:
        """A value; KeyError where there is none."""
        if name not in self._known:
            self._known[name] = self._made[name]()
        return self._known[name]

    def __contains__(self, name: object) -> bool:
        return name in self._made

    def __iter__(self) -> Iterator[str]:
        return iter(self._made)

    def __len__(self) -> int:
        return len(self._made)


def together(names: Sequence[str], make: Callable[[], Mapping[str, Any]]) -> dict[str, Callable[[], Any]]:
    """What makes each of some values that are made all at once: for `OnDemand`."""
    found: dict[str, Any] = {}

    def one(name: str) -> Any:
        if not found:
            found.update(make())
        return found[name]

    return {name: partial(one, name) for name in names}


class BriefStore:
    """Keeps batches of frames in memory as they come, and makes a variable of them where a figure asks for it.

    It takes what is observed of a batch as a mapping, which may make its values on demand, and looks at none of them;
    what it is given must stay as it is.

    Parameters
    ----------
    path : None
        As that of `tautline.results.store.Store`; nothing is written.
    variables, coordinates, attributes
        As of `tautline.results.store.Store`.
    """

    def __init__(
        self,
        path: None,
        variables: Sequence[Variable],
        coordinates: Mapping[str, Any] | None = None,
        attributes: Mapping[str, Any] | None = None,
    ) -> None:
        self.frames = 0
        self.variables, self.attributes = [TIME, *variables], {"status": "running", **(attributes or {})}
        given = coordinates or {}
        self._fixed = OnDemand({name: partial(coordinate, name, given[name]) for name in given})
        self._observed: list[Mapping[str, np.ndarray]] = []
        self._joined: Mapping[str, np.ndarray] | None = None

    def append(
        self,
        frames: Mapping[str, np.ndarray],
        restart: Mapping[str, np.ndarray] | None = None,
        attributes: Mapping[str, Any] | None = None,
    ) -> None:
        """Add a batch."""
        self._observed.append(frames)
        self._joined = None
        self.frames += len(frames["time"])

    def finish(
        self, attributes: Mapping[str, Any] | None = None, restart: Mapping[str, np.ndarray] | None = None
    ) -> Result | None:
        """Add what is known only at the end; None if there was no frame."""
        self.attributes |= {"status": "done", **(attributes or {})}
        return self.result

    @property
    def result(self) -> Result | None:
        """What was stored so far; None before the first batch."""
        if self.frames == 0:
            return None
        if self._joined is None:
            # Nothing here refers back to the store: frames go with their last user, and wait for no collection.
            whole = {variable.name: partial(_whole, self._observed, variable.name) for variable in self.variables}
            self._joined = OnDemand(whole)
        return Result(None, (self.variables, self._joined, self._fixed, self.attributes, {}))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        """Nothing is left behind."""


def _whole(batches: Sequence[Mapping[str, np.ndarray]], name: str) -> np.ndarray:
    """A variable over all batches."""
    parts = [batch[name] for batch in batches]
    return parts[0] if len(parts) == 1 else np.concatenate(parts)
