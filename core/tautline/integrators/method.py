"""The integrators by name."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from tautline.integrators.stepping import stepping_of
from tautline.scene.methods import names
from tautline.system.model import SolverSettings
from tautline.system.system import System

Maker = Callable[[System, SolverSettings], Any]


class _Makers(Mapping[str, Maker]):
    """Makers of scratch by the names of all methods that are registered."""

    def __getitem__(self, name: str) -> Maker:
        return stepping_of(name).make

    def __iter__(self) -> Iterator[str]:
        return iter(names())

    def __len__(self) -> int:
        return len(names())


METHODS = _Makers()
"""Makers of a method's scratch; the order test runs over all of them."""


def method_for(system: System, settings: SolverSettings) -> Any:
    """Scratch of the method that the settings name."""
    return METHODS[settings.method](system, settings)
