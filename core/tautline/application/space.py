"""A result in space, from Python: ``result.render()``."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from tautline.arguments import as_arguments
from tautline.scene.values.printed import printed_in

if TYPE_CHECKING:
    from tautline.results.result import Result
    from tautline.view.space.appearance import Appearance, Look

CALLED = {
    "--image": "time", "--colour": "colour", "--view": "view", "--radius": "radius", "--exaggerate": "exaggerate",
    "--camera": "camera",
}  # fmt: skip
"""Arguments by what the verb ``render`` calls them."""
LARGEST = 1.0e6
"""Factor that nobody can mean to give."""


@as_arguments(CALLED)
def in_space(
    result: Result,
    time: float | str = "last",
    colour: str | None = None,
    view: str | None = None,
    radius: float | None = None,
    exaggerate: float | None = None,
    camera: str = "",
    size: tuple[int, int] = (1280, 720),
    window: bool = False,
) -> Any:
    """Put a result into a plotter, as ``result.render`` does.

    Parameters
    ----------
    result : Result
    time : float or str
        s, or ``first`` or ``last``: the nearest frame is shown.
    colour, view, radius, exaggerate, camera
        As the options of the verb ``render``.
    size : tuple of int
        Pixels.
    window : bool
        Whether `show` is to open a window; else it draws off screen.

    Returns
    -------
    pyvista.Plotter
        With the whole scene in it: ``plotter.show()``, ``plotter.screenshot("crane.png")``, ``plotter.camera``.

    Raises
    ------
    ResultError
        If something asked for is unknown, or there is nothing to draw with.
    """
    from tautline.application.installed import Installed
    from tautline.view.space.stage import Stage
    from tautline.view.space.still import frame_of

    look = in_units_of(result, look_of(view, exaggerate))
    appearance = appearance_of(Installed().for_result(result), result, look)
    stage = Stage(appearance, colour, radius, camera, size, window)
    stage.show(frame_of(str(time), appearance.time))
    return stage.plotter


def appearance_of(application: Any, result: Result, look: Look) -> Appearance:
    """What a result looks like, by its application; its notes begin with what of the run is missing."""
    from tautline.results.naming import shortfall

    seen = application.appearance(result, look)
    missing = shortfall(result)
    return replace(seen, notes=(missing, *seen.notes)) if missing else seen


def in_units_of(result: Result, look: Look) -> Look:
    """A look whose legends have the units that the scene asks for."""
    return replace(look, units=printed_in(result.attributes))


def look_of(view: str | None, exaggerate: float | None) -> Look:
    """What an application must know of what is asked for.

    Raises
    ------
    ResultError
        For an exaggeration that is too large to be one.
    """
    from tautline.results.errors import ResultError
    from tautline.view.space.appearance import Look

    if exaggerate is not None and not exaggerate < LARGEST:
        raise ResultError(
            "--exaggerate",
            f"{exaggerate:g} is no factor",
            f"give a number above 0 and below {LARGEST:,.0f}, such as 50",
        )
    return Look(view or "", exaggerate)
