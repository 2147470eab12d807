"""Variables that are made when they are asked for: of many runs only some figures are wanted."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any


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
