"""Figures and the look in space of a result of which nothing is known but its variables."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.view.figures.comparison import names, title
from tautline.view.figures.curves import variable_figure
from tautline.view.figures.drawings import Drawing
from tautline.view.figures.figure import Figure
from tautline.view.figures.histories import energies
from tautline.view.space.appearance import Appearance, Line, Look, ranged, stored

VIEWS = {"space": "points and lines where the result has them"}
THIN = 2.0e-3
"""Radius of what is drawn, over the extent of everything."""


def _overview(results: Sequence[Result]) -> Figure:
    """The first variable of the results that is no energy and no bookkeeping."""
    told = [v.name for v in results[0].variables.values() if v.dims[:1] == ("time",) and v.name != "time"]
    ours = [name for name in told if not name.endswith(("_energy", "_work"))]
    if not ours:
        raise ResultError(results[0].path or "result", "holds no variable against time", "store one in the model")
    return variable_figure(results, names(results), ours[0], None, title(results))


DRAWINGS = {
    "overview": Drawing("the first variable against time", _overview),
    "energy": energies(),
}
"""Figures that any result has."""


def appearance(result: Result, look: Look) -> Appearance:
    """A line through all places of ``position`` (time, places, 3), m, coloured by what is stored at them.

    Raises
    ------
    ResultError
        If the result has no such variable.
    """
    if "position" not in result or np.ndim(result["position"]) != 3 or np.shape(result["position"])[2] != 3:
        cause = "holds no `position` (time, places, axis): there is nothing to see in space"
        raise ResultError(result.path or "result", cause, "store it in the model, or use `plot`")
    position = np.asarray(result["position"], dtype=float)
    dims = result.variables["position"].dims
    size = max(float(np.ptp(position.reshape(-1, 3), axis=0).max()), 1e-6)
    found = [
        ranged(name, variable.long_name or name, variable.units, np.asarray(result[name], dtype=float))
        for name, variable in result.variables.items()
        if variable.dims == dims[:2] and name != "position"
    ]
    path = position if position.shape[1] > 1 else np.concatenate([position, position + [0.0, 0.0, THIN * size]], axis=1)
    line = Line("places", stored(path), THIN * size, tuple(found if position.shape[1] > 1 else ()), measured=False)
    text = str(result.attributes.get("title") or "") or "result"
    return Appearance(text, np.asarray(result.time), lines=(line,), units=look.units)
