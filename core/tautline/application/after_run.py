"""What a run says of its error when it has ended: it is estimated from runs of its scene with other steps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from tautline.application.installed import key_of_setting
from tautline.scene.errors import option_error

if TYPE_CHECKING:
    from tautline.application.protocol import Application
    from tautline.results.result import Result
    from tautline.simulation import Afterwards


def error_of_step(
    application: Application,
    scene: Any,
    model: Any,
    asked: bool | None,
    progress: Callable[[float, float], None] | None = None,
    begin: Callable[[Sequence[float]], None] | None = None,
) -> Afterwards | None:
    """What estimates a run's error due to its steps; None where that is not to be done.

    Parameters
    ----------
    asked : bool or None
        Whether it is to be done; None for where `tautline.study.trials.step_error.runs_for` does it by itself.
    progress : callable or None
        Called with simulated and wall time of the other runs, s; both go on from one to the next.
    begin : callable or None
        Called before the first of the other runs, with their steps over the run's own.

    Raises
    ------
    SceneError
        Where it is asked for, and the scene does not keep the frames that are compared.
    """
    if asked is False or getattr(model, "system", None) is None:
        return None
    if getattr(model, "keep", None) is not None:
        # Runs with other steps are compared frame by frame.
        if asked:
            cure = "leave --verify out, or run a shorter stretch of the scene with output.keep: frames"
            raise option_error("--verify", "", "needs every frame, and the scene keeps statistics", cure)
        return None
    from tautline.simulation import Afterwards
    from tautline.study.trials.step_error import NOT_KNOWN, looked_at, runs_for
    from tautline.study.trials.trial import Subject

    parts = runs_for(model, asked)
    if not parts:
        return None

    def compared(result: Result) -> tuple[dict[str, Any], list[str]]:
        told = None if begin is None else lambda: begin(parts)
        subject = Subject(application, scene)
        found, between = looked_at(subject, result, progress=progress, parts=parts, begin=told, judged_by=model)
        attributes: dict[str, Any] = {} if between is None else {"between_frames": between.record()}
        warnings = [] if between is None else [between.warned(key_of_setting(application, "interval"))]
        if isinstance(found, str):
            return attributes, [text for text in (found and NOT_KNOWN.format(found), *warnings) if text]
        keys = {name: key for name in ("step", "step_error") if (key := key_of_setting(application, name))}
        return attributes | {"step_error": found._asdict()}, [x for x in (found.warned(**keys), *warnings) if x]

    return Afterwards(compared)
