"""What keeps the frames of a run in memory, for a few figures of it: nothing is written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, Self

import numpy as np

from tautline.results.on_demand import OnDemand
from tautline.results.result import Result
from tautline.results.store import TIME, coordinate
from tautline.results.variable import Variable


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
