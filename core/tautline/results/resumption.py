"""What a result must be, to be gone on with, and what of it the run that goes on takes over."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.version import __version__

PARAMETERS_GIVEN, PARAMETERS_CHANGED = "parameters_given", "parameters_changed"
INPUTS_DRIVEN, FORCES_ADDED, DISPLACED = "inputs_driven", "forces_added", "displaced"
MISSING_UNTIL = "frames_missing_until"
"""Attribute of a result without the frames of another run that its state comes from: the time of that state, s."""
TORN = "torn"
"""Attribute of a result whose last state no longer holds what multipliers tie: which, and why."""
TAKEN_OVER = PARAMETERS_GIVEN, PARAMETERS_CHANGED, DISPLACED, MISSING_UNTIL
"""Attributes of a result that hold for what goes on from it: its last state and its frames are part of that."""
ROUNDING = 1e-12
"""Share of a time that is rounding."""


def truncated_start_warning(time: float) -> str:
    """A warning for the reader of a result that holds no frames from its start to a time, s."""
    return (
        f"the run was gone on with at {time:.6g} s from a state that another run saved. The frames of that run are not "
        "in this result. What is said of the whole run is said of the frames that are here"
    )


FRAMES_TOLD = "frames_told"
"""Attribute of models with moving frames: by which numbers their places are told, in results and states as in runs."""


def place_of(earlier: Result) -> Any:
    """Where a result stands, for messages."""
    return earlier.path or "result"


def refuse_another(earlier: Result, method: str, attributes: Mapping[str, Any]) -> None:
    """Refuse a result that the run of a model cannot go on from.

    Parameters
    ----------
    earlier : Result
    method : str
        Of integration.
    attributes : mapping
        Of the model.

    Raises
    ------
    ResultError
        Where it holds no state, was moved by what it does not hold, or is that of another method or scene.
    """
    place, made = place_of(earlier), earlier.attributes
    if not earlier.restart:
        if made.get("application") == "twin":
            cure = "name the result of a simulation, or go on with `twin --resume`"
            raise ResultError(place, "is what a twin has found, and no simulation", cure)
        raise ResultError(place, "holds no state to go on from", "run the scene from its start")
    if not np.isfinite(earlier["time"]).all():
        raise ResultError(place, "is damaged: some of its times are no numbers", "run the scene from its start")
    _refuse_what_was_moved(place, made)
    cure = "only solver.end, the step and the output may differ from what it was made with"
    for one, now, word in (
        (made.get("method"), method, "method"),
        (made.get("model_hash"), attributes.get("model_hash"), "scene"),
    ):
        if one != now:
            raise ResultError(place, f"belongs to another {word}", cure)
    # An input that was named makes a frame one that may move, though the scene holds it still.
    if FRAMES_TOLD in attributes and made.get(FRAMES_TOLD) != attributes[FRAMES_TOLD]:
        cause = "was made by a version of Tautline that tells the places of moving frames otherwise"
        raise ResultError(place, cause, "run the scene from its start")
    if made.get("prepared") != attributes.get("prepared"):
        cause = "was made with motions that were prepared otherwise, as those of a shorter or a longer run are"
        raise ResultError(place, cause, "run the scene from its start to the new end")


def _refuse_what_was_moved(place: Any, made: Mapping[str, Any]) -> None:
    """Refuse what went by inputs and forces that a result does not hold: the scene's own would jump in.

    And what a displacement has torn: the first step would close the gap at once, by a speed of the gap over the step.
    """
    if made.get(TORN):
        cause = f"ends with a displacement of one thing only: {made[TORN]}"
        raise ResultError(place, cause, "displace what it is tied to by the same before the result is taken")
    cure = "go on with the `Simulation` that made it, or with what its `save()` gave, or run the scene from its start"
    if made.get(INPUTS_DRIVEN):
        cause = f"comes from a simulation whose inputs were given: {made[INPUTS_DRIVEN]}. A result does not hold them"
        raise ResultError(place, cause, cure)
    if made.get(FORCES_ADDED):
        cause = f"comes from a simulation to which forces were added: {made[FORCES_ADDED]}. A result does not hold them"
        raise ResultError(place, cause, cure)


OTHER_STATE = "kept other numbers of its last state than this one needs"
"""What another build did, by whose last state a run cannot be gone on with."""


def refuse_frames_without(earlier: Result, names: Iterable[str]) -> None:
    """Refuse a result without some variables of its frames: one run has the same ones from its start to its end.

    Raises
    ------
    ResultError
        Where it lacks any of the names.
    """
    lacks = [name for name in names if name not in earlier]
    if lacks:
        raise of_another_build(earlier, f"stored no {', '.join(lacks)}, which this one does")


def of_another_build(earlier: Result, did: str = OTHER_STATE) -> ResultError:
    """The refusal of what another build of this program wrote of the same scene, and of what it did otherwise."""
    by = earlier.attributes.get("version", "")
    other = f"Tautline {by or 'of an unknown version'}" if by != __version__ else f"another build of Tautline {by}"
    cause = f"cannot be gone on with: {other} wrote it, and {did}"
    cure = "run the scene from its start, or go on with the same build that wrote it"
    return ResultError(place_of(earlier), cause, cure)


def restart_time(earlier: Result) -> float:
    """Time of the state that a result holds, s: that of a simulation may stand between two frames."""
    return float(earlier.attributes.get("restart_time", earlier["time"][-1]))


def frames_until(earlier: Result, time: float, names: tuple[str, ...]) -> dict[str, np.ndarray]:
    """Frames until a time, s. A run that failed has stored some after the state it holds, which are run again."""
    kept = np.array(earlier["time"]) <= time * (1.0 + ROUNDING)
    return {name: np.array(earlier[name])[kept] for name in (*names, "time")}


def moved_by(
    given: Iterable[str],
    changed: Iterable[str],
    driven: Iterable[str],
    added: Iterable[str],
    displaced: Iterable[str],
    joined: float | None,
) -> dict[str, Any]:
    """Attributes of what has moved a simulation beside its scene, and until when its frames are missing.

    Parameters
    ----------
    given, changed : iterable of str
        Names of parameters that were set before the start, and after it.
    driven, added, displaced : iterable of str
        Names of inputs that were given and of forces that were added, in their order, and of what was displaced.
    joined : float or None
        Time up to which the frames are those of another run, s.
    """
    names = {
        PARAMETERS_GIVEN: sorted(given),
        PARAMETERS_CHANGED: sorted(changed),
        INPUTS_DRIVEN: driven,
        FORCES_ADDED: added,
        DISPLACED: sorted(displaced),
    }
    moved: dict[str, Any] = {what: ", ".join(some) for what, some in names.items() if some}
    return moved if joined is None else {**moved, MISSING_UNTIL: joined}


def taken_over(earlier: Result | None) -> dict[str, Any]:
    """Attributes of a result that the run that goes on from it has as well."""
    made = {} if earlier is None else earlier.attributes
    return {name: made[name] for name in TAKEN_OVER if made.get(name)}
