"""Tautline: slender things under tension, faster than real time.

``tautline.read(path)`` reads a scene of any installed application; ``tautline.simulate(scene)`` runs it and returns a
``Result`` whose ``data`` is an ``xarray.Dataset``. ``tautline.study_errors`` and ``tautline.study_stability`` are the
verbs ``study`` and ``stability``.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tautline.version import __version__

if TYPE_CHECKING:
    from tautline.live.rollout import rollout
    from tautline.live.simulation import Simulation
    from tautline.results.result import Result
    from tautline.study.accuracy.precision import Study
    from tautline.study.robustness.stability import Stability

__all__ = ["Simulation", "__version__", "read", "rollout", "simulate", "study_errors", "study_stability"]

_LATER = {"Simulation": "tautline.live.simulation", "rollout": "tautline.live.rollout"}
"""Names that are loaded when they are first used."""


def __getattr__(name: str) -> Any:
    if name in _LATER:
        from importlib import import_module

        return getattr(import_module(_LATER[name]), name)
    raise AttributeError(f"module 'tautline' has no attribute '{name}'")


def read(path: str | Path) -> Any:
    """Read and validate a scene file.

    Raises
    ------
    SceneError
        Listing every fault with its line, key, value and cure.
    """
    from tautline.application.installed import Installed

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
    from tautline.application.installed import Installed
    from tautline.simulation import simulate as run

    scene = _scene(scene)
    return run(Installed().of(scene).build(scene), path, progress, resume)


def _scene(scene: Any) -> Any:
    """What was read, or is read now; TypeError for what is neither a scene nor the name of a file."""
    if isinstance(scene, (str, Path)):
        return read(scene)
    if not hasattr(scene, "document"):
        raise TypeError(f"a scene or the path of its file is wanted, not {type(scene).__name__}")
    return scene


def study_errors(scene: Any, end: float | None = None, grid: Any = None, **options: Any) -> Study:
    """Error against run time of a scene, or of the scene in a file, as the verb ``study`` finds it.

    Parameters
    ----------
    scene : scene or path
    end : float or None
        Simulated time, s, in place of the scene's.
    grid : tautline.study.accuracy.precision.Grid or None
        Methods, steps, meshes and constraints, such as ``Grid(steps=[1e-3, 5e-4])``; None for the usual.
    **options
        Of `tautline.study.accuracy.precision.study`: tolerance, repetitions, budget, point, reference.

    Raises
    ------
    SceneError, ResultError
        For bad input.
    StoppedEarly
        If the scene as it stands does not come to its end.
    """
    from tautline.study.accuracy.precision import Grid, study

    return study(_subject(scene, end), grid or Grid(), **options)


def study_stability(scene: Any, end: float | None = None, **options: Any) -> Stability:
    """What limits the step of a scene, or of the scene in a file, and what breaks it: the verb ``stability``.

    Parameters
    ----------
    scene : scene or path
    end : float or None
        Simulated time, s, in place of the scene's.
    **options
        Of `tautline.study.robustness.stability.stability`: tolerance, budget, point, quick.

    Raises
    ------
    SceneError, ResultError
        For bad input.
    StoppedEarly
        If the scene as it stands does not come to its end.
    """
    from tautline.study.robustness.stability import stability

    return stability(_subject(scene, end), **options)


def _subject(scene: Any, end: float | None) -> Any:
    from tautline.application.installed import Installed
    from tautline.study.trials.trial import Subject

    read_scene = _scene(scene)
    return Subject(Installed().of(read_scene), read_scene, end=end)
