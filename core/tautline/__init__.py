"""Tautline: slender things under tension, faster than real time.

``tautline.read(scene)`` reads a scene of any installed application, from a file, a YAML text or a dict;
``scene.replace(...)`` changes it; ``tautline.simulate(scene)`` runs it and returns a ``Result`` whose ``data`` is an
``xarray.Dataset``. ``tautline.study_errors`` and ``tautline.study_stability`` are the verbs ``study`` and
``stability``, and ``tautline.sweep`` the verb ``sweep``. All that is raised on purpose is a ``TautlineError``.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tautline.version import __version__

if TYPE_CHECKING:
    from tautline.application.installed import Installed
    from tautline.errors import ArgumentError, ArgumentTypeError, TautlineError
    from tautline.integrators.status import Interrupted, Status, StoppedEarly
    from tautline.live.errors import SimulationError, UnknownName
    from tautline.live.rollout import rollout
    from tautline.live.simulation import Simulation
    from tautline.results.errors import ResultError, WriteError
    from tautline.results.result import Result
    from tautline.scene.errors import Problem, SceneError, SceneWarning
    from tautline.study.accuracy.precision import Grid, Study
    from tautline.study.robustness.stability import Stability
    from tautline.sweeps.sweep import SweepInterrupted, sweep

__all__ = [
    "ArgumentError",
    "ArgumentTypeError",
    "Grid",
    "Interrupted",
    "Problem",
    "Result",
    "ResultError",
    "SceneError",
    "SceneWarning",
    "Simulation",
    "SimulationError",
    "Stability",
    "Status",
    "StoppedEarly",
    "Study",
    "SweepInterrupted",
    "TautlineError",
    "UnknownName",
    "WriteError",
    "__version__",
    "read",
    "rollout",
    "simulate",
    "study_errors",
    "study_stability",
    "sweep",
]

_PLACES = {
    "ArgumentError": "tautline.errors",
    "ArgumentTypeError": "tautline.errors",
    "Grid": "tautline.study.accuracy.precision",
    "Interrupted": "tautline.integrators.status",
    "Problem": "tautline.scene.errors",
    "Result": "tautline.results.result",
    "ResultError": "tautline.results.errors",
    "SceneError": "tautline.scene.errors",
    "SceneWarning": "tautline.scene.errors",
    "Simulation": "tautline.live.simulation",
    "SimulationError": "tautline.live.errors",
    "Stability": "tautline.study.robustness.stability",
    "Status": "tautline.integrators.status",
    "StoppedEarly": "tautline.integrators.status",
    "Study": "tautline.study.accuracy.precision",
    "TautlineError": "tautline.errors",
    "UnknownName": "tautline.live.errors",
    "WriteError": "tautline.results.errors",
    "rollout": "tautline.live.rollout",
    "SweepInterrupted": "tautline.sweeps.sweep",
    "sweep": "tautline.sweeps.sweep",
}
"""Where a public name stands that is imported when it is asked for: nothing heavy is loaded before."""
_STUDIED = {"--point": "point", "--tolerance": "tolerance", "--budget": "budget", "--constraints": "grid.constraints"}
"""What the verbs ``study`` and ``stability`` call the arguments of their functions."""


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"module 'tautline' has no attribute {name!r}")
    from importlib import import_module

    globals()[name] = value = getattr(import_module(_PLACES[name]), name)
    return value


def __dir__() -> list[str]:
    return sorted(__all__)


def read(source: Any, folder: str | Path | None = None) -> Any:
    """Read and validate a scene.

    Parameters
    ----------
    source : path, str, dict or scene
        A file, a YAML text, or what such a text says as a dict: ``{"solver": {"step": "2 ms", ...}, ...}``. A str is a
        text if it has more than one line, or reads as a mapping of keys to values. A scene is given back as it is.
    folder : path or None
        What the files that a text or a dict names are relative to; None for the current folder. Those of a file are
        relative to its own, and those of a scene have been found.

    Returns
    -------
    scene
        Frozen; ``scene.replace({"bodies[0].mass": "6 t"})`` gives another.

    Raises
    ------
    SceneError
        Listing every fault with its line, key, value and cure.
    ArgumentTypeError
        Where `source` is none of these, or `folder` is given beside a file or a scene.
    """
    from tautline.errors import ArgumentTypeError
    from tautline.scene.reading.source import document_of

    if hasattr(source, "document"):
        if folder is not None:
            raise ArgumentTypeError("the files that a scene names have been found: leave `folder` out")
        return source
    document = document_of(source, folder)
    return _installed().for_scene(document).read(document)


def simulate(
    scene: Any,
    path: str | Path | None = None,
    progress: Callable[[float, float], None] | None = None,
    resume: Result | None = None,
    *,
    step: float | str | None = None,
    end: float | str | None = None,
    method: str | None = None,
    accuracy: float | str | None = None,
    verify: bool | None = False,
) -> Result:
    """Run a scene.

    Parameters
    ----------
    scene : scene, path, str or dict
        What `tautline.read` returns, or what it takes.
    path : path or None
        Where the result is stored; None keeps it in memory.
    progress : callable or None
        Called with simulated and wall time, s. What it raises ends the run, and the frames until then are stored.
    resume : Result or None
        An earlier result of the same scene, to go on from where it ended.
    step, end : float, str or None
        Time step and simulated time, s or with a unit (``"2 ms"``), in place of the scene's; a step may be ``"auto"``.
    method : str or None
        Integrator, in place of the scene's.
    accuracy : float, str or None
        Relative error (``"1 %"``) for which method and step are chosen, in place of the scene's; ``result.accuracy``
        says what was reached. A step, a method and ``verify=True`` leave them as they are, and so does ``resume``.
    verify : bool or None
        Whether to run the scene with other steps, too, and estimate the error of this run: ``result.step_error``. None
        does what the command does by itself, which is quicker and leaves some scenes out; True always takes a half and
        a third of the step, as ``--verify`` does.

    Raises
    ------
    SceneError
        For bad input.
    ArgumentError
        For ``verify=True`` beside an accuracy.
    ArgumentTypeError
        For a path, a callable or a result that is none.
    ResultError
        For a result that cannot be written, or not be gone on with; nothing is written then.
    StoppedEarly, Interrupted
        With the result so far.
    """
    from tautline.arguments import FUNCTION, PATH, RESULT, SWITCH, as_arguments, check
    from tautline.errors import ArgumentError
    from tautline.simulation import simulate as run

    check(path=(path, PATH), progress=(progress, FUNCTION), resume=(resume, RESULT), verify=(verify, SWITCH))
    verify = None if verify is None else bool(verify)
    if verify and accuracy is not None:
        raise ArgumentError("verify = True estimates the error of steps that accuracy chooses: leave one of them out")
    wanted = {} if accuracy is None else {"accuracy": accuracy}
    application, scene = _overridden(scene, step=step, end=end, method=method, **wanted)
    asked = getattr(getattr(scene, "solver", None), "accuracy", None)
    with as_arguments({"-o": "path", "--resume": "resume", "--verify": "verify"}):
        if asked is not None and step is None and method is None and resume is None and not verify:
            from tautline.application.installed import key_of_setting
            from tautline.study.accuracy.choice import run_to_accuracy

            key = key_of_setting(application, "interval")
            return run_to_accuracy(application, scene, asked, path, progress, interval_key=key)
        model = application.build(scene)
        return run(model, path, progress, resume, afterwards=_estimate(application, scene, model, verify, resume))


def _estimate(application: Any, scene: Any, model: Any, verify: bool | None, resume: Result | None) -> Any:
    """What estimates the error of a run when it has ended; None where that is not to be done."""
    # Nothing is loaded for it where nobody asks.
    if verify is False or (verify is None and resume is not None):
        return None
    from tautline.application.after_run import error_of_step

    return error_of_step(application, scene, model, verify)


@functools.cache
def _installed() -> Installed:
    """The applications, looked for once."""
    from tautline.application.installed import Installed

    return Installed()


def _scene(scene: Any) -> Any:
    """What was read, or is read now; ArgumentTypeError for what is no scene and no source of one."""
    return read(scene)


def _overridden(scene: Any, **given: Any) -> tuple[Any, Any]:
    """The application of a scene, and the scene with other settings, which what is read now is validated with.

    A fault names the argument, where the command would name its option.
    """
    from tautline.application.installed import overridden
    from tautline.arguments import as_arguments
    from tautline.scene.reading.source import document_of

    with as_arguments({f"--{key.replace('_', '-')}": key for key in given}):
        if not hasattr(scene, "document"):
            document = document_of(scene)
            application = _installed().for_scene(document)
            changed = overridden(application, document, given)
            if changed is not None:
                return application, application.read(changed)
            scene = application.read(document)
        application = _installed().of(scene)
        return application, application.with_overrides(scene, **given)


def study_errors(scene: Any, end: float | str | None = None, grid: Any = None, **options: Any) -> Study:
    """Error against run time of a scene, as the verb ``study`` finds it.

    Parameters
    ----------
    scene : scene, path, str or dict
        What `tautline.read` returns, or what it takes.
    end : float, str or None
        Simulated time, s or with a unit, in place of the scene's.
    grid : Grid or None
        Methods, steps, meshes and constraints, such as ``tautline.Grid(steps=[1e-3, 5e-4])``; None for the usual.
    **options
        tolerance : relative error of position that is asked for, ``0.01`` or ``"1 %"``. budget : processor time, s,
        that one run may take. point : name of what is looked at. repeat : of each run, for its time. quick : whether
        the usual grid is cut to every other step. reference : a ``tautline.study.trials.trial.Setting`` with the method
        and the finest step of the reference. ``repetitions`` and ``reduced`` are earlier names of repeat and quick.

    Returns
    -------
    Study
        Its runs with their errors and times, and the reference that they are compared with.

    Raises
    ------
    SceneError
        For a scene that cannot be run, and a tolerance that cannot be.
    ResultError
        For a point that is not there.
    ArgumentError, ArgumentTypeError
        For any other argument with a value that it cannot have, of another type, or of a name that is none.
    StoppedEarly
        If the scene as it stands does not come to its end.
    """
    from tautline.arguments import as_arguments
    from tautline.study.accuracy.arguments import as_study_takes, check_study, with_share
    from tautline.study.accuracy.precision import Grid, study

    grid = Grid() if grid is None else grid
    options = with_share(options)
    grid = check_study(grid, options)
    options = as_study_takes(options)
    with as_arguments(_STUDIED):
        return study(_subject(scene, end), grid, **options)


def study_stability(scene: Any, end: float | str | None = None, **options: Any) -> Stability:
    """What limits the step of a scene, and what breaks it: the verb ``stability``.

    Parameters
    ----------
    scene : scene, path, str or dict
        What `tautline.read` returns, or what it takes.
    end : float, str or None
        Simulated time, s or with a unit, in place of the scene's.
    **options
        tolerance : relative error of position up to which a variant is right, ``0.01`` or ``"1 %"``. budget : processor
        time, s, that one run of a variant may take. point : name of what is looked at. quick : whether there are fewer
        variants.

    Returns
    -------
    Stability
        The critical step and what sets it, and how the scene's variants ended.

    Raises
    ------
    SceneError
        For a scene that cannot be run, and a tolerance that cannot be.
    ResultError
        For a point that is not there.
    ArgumentError, ArgumentTypeError
        For any other argument with a value that it cannot have, of another type, or of a name that is none.
    StoppedEarly
        If the scene as it stands does not come to its end.
    """
    from tautline.arguments import as_arguments
    from tautline.study.accuracy.arguments import check_stability, with_share
    from tautline.study.robustness.stability import stability

    options = with_share(options)
    check_stability(options)
    with as_arguments(_STUDIED):
        return stability(_subject(scene, end), **options)


def _subject(scene: Any, end: float | str | None) -> Any:
    from tautline.study.trials.trial import Subject

    application, read_scene = _overridden(scene, end=end)
    return Subject(application, read_scene, end=None if end is None else float(read_scene.solver.end))
