"""Tautline: slender things under tension, faster than real time.

``tautline.read(path)`` reads a scene of any installed application; ``tautline.simulate(scene)`` runs it and returns a
``Result`` whose ``data`` is an ``xarray.Dataset``.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tautline.version import __version__

if TYPE_CHECKING:
    from tautline.results.result import Result

__all__ = ["__version__", "read", "simulate"]


def read(path: str | Path) -> Any:
    """Read and validate a scene file.

    Raises
    ------
    SceneError
        Listing every fault with its line, key, value and cure.
    """
    from tautline.cli.catalogue import Installed

    return Installed().for_scene(Path(path)).read(Path(path))


def simulate(
    scene: Any,
    path: str | Path | None = None,
    progress: Callable[[float, float], None] | None = None,
    resume: Result | None = None,
) -> Result:
    """Run a scene, or the scene in a file.

    Parameters
    ----------
    scene : scene or path
        What :func:`read` returns, or the file.
    path : path or None
        Where the result is stored; None keeps it in memory.
    progress : callable or None
        Called with simulated and wall time, s.
    resume : Result or None
        An earlier result of the same scene, to go on from where it ended.

    Raises
    ------
    SceneError
        For bad input.
    StoppedEarly, Interrupted
        With the result so far.
    """
    from tautline.cli.catalogue import Installed
    from tautline.simulation import simulate as run

    if isinstance(scene, (str, Path)):
        scene = read(scene)
    return run(Installed().of(scene).build(scene), path, progress, resume)
