"""Results of a twin: a scene's names, with other variables than its runs have."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from tautline.application.defaults import Defaults

if TYPE_CHECKING:
    from tautline.results.result import Result

TWIN = "twin"
"""Application by which the result of a twin is known."""


class TwinResults(Defaults):
    """Who draws the results of twins, whatever scene they belong to."""

    name = TWIN
    title = "Results of twins"

    @property
    def drawings(self) -> Mapping[str, Any]:
        """Estimates, residuals and alarms."""
        from tautline.view.figures.estimates import DRAWINGS

        return DRAWINGS


def drawer(result: Result, application_of: Callable[[Result], Any]) -> Any:
    """Who draws a result: the application of its scene, but for the result of a twin."""
    return TwinResults() if result.attributes.get("application") == TWIN else application_of(result)
