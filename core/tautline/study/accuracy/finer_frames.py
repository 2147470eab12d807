"""What a run whose accuracy was asked for does between its frames, seen in one more run with finer ones.

An accuracy is of the stored frames: what happens between two of them is in none, however short the steps are. The last
run may take many steps in a frame. One more run takes fewer, a third of them or as many as the run before the last
took, and stores several frames for each of the run's own, see `tautline.study.trials.between_frames`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from tautline.integrators.status import Interrupted
from tautline.results.result import Result
from tautline.scene.methods import method_of
from tautline.study.trials.between_frames import (
    ENOUGH,
    INTERVAL,
    SECONDS,
    BetweenFrames,
    between_frames,
    divisor,
    frames_for_each,
)
from tautline.study.trials.step_error import ALLOWED, AT_LEAST, CUT_SHORT
from tautline.study.trials.trial import Setting, Subject
from tautline.system.model import Model

SHARE = 1.0 / 3.0
"""Steps of the further run, over those of the last, at least: longer ones do not follow what the last one does."""
NOT_LOOKED = "what happens between the stored frames is not known: {}"
"""The warning of a run between whose frames nobody could look, with the reason."""


@dataclass(frozen=True)
class Looked:
    """What came of the look.

    Attributes
    ----------
    found : BetweenFrames or None
        None where the further run did not come to its end.
    cpu : float
        Processor time of that run, s.
    why : str
        Why it did not.
    """

    found: BetweenFrames | None
    cpu: float
    why: str = ""

    def warned(self, key: str = INTERVAL) -> str | None:
        """What a reader should know; ``key`` is what sets the frames in the scene's file."""
        return NOT_LOOKED.format(self.why) if self.found is None else self.found.warned(key)


def steps_in_a_frame(last: int, before: int, explicit: bool) -> int:
    """How many steps the further run takes in an interval of the run's frames.

    They are no more than the run's own, ``last``, and no fewer than a third of these and than those of the run
    ``before`` it, which is known to come to its end. An explicit method is not stable with fewer than those.
    """
    least = before if explicit else max(before, math.ceil(SHARE * last))
    counts = range(min(max(1, least), last), last + 1)
    return next((count for count in counts if divisor(count) >= ENOUGH), max(counts, key=divisor))


def look_between(
    subject: Subject,
    model: Model,
    result: Result,
    last: int,
    before: int,
    progress: Callable[[float, float], None] | None = None,
) -> Looked | None:
    """Run a scene once more, with finer frames; None where a frame of the run holds one step, or there is no room.

    Parameters
    ----------
    subject : Subject
        The scene.
    model : Model
        That was run, with its limits: its method and its step are those of the run.
    result : Result
        Its run.
    last, before : int
        Steps in an interval of the frames of this run, and of the one before it.
    progress : callable or None
        Called with simulated and wall time, s.
    """
    try:
        return _look(subject, model, result, last, before, progress)
    except (Interrupted, KeyboardInterrupt):
        # Of the run itself nothing is missing.
        return Looked(None, 0.0, CUT_SHORT)


def _look(
    subject: Subject,
    model: Model,
    result: Result,
    last: int,
    before: int,
    progress: Callable[[float, float], None] | None,
) -> Looked | None:
    interval, method = float(model.solver.interval), model.solver.method
    count = steps_in_a_frame(last, before, method_of(method).explicit)
    finer = frames_for_each(model, interval / last, interval / count, len(result.time))
    if finer == 1:
        return None
    spent = float(result.attributes.get("cpu_time", 0.0)) * count / last
    seconds = AT_LEAST + ALLOWED * spent + SECONDS * finer * len(result.time)
    fine = Subject(subject.application, subject.scene, interval=interval / finer)
    further: dict[str, Any] = {} if progress is None else {"progress": progress}
    trial = fine.run(Setting(method, interval / count), seconds=seconds, **further)
    cpu = trial.cpu_time or 0.0
    if not trial.done or trial.result is None:
        return Looked(None, cpu, f"the run with finer frames stopped: {trial.sentence or trial.status}")
    return Looked(between_frames(model, result, trial.result), cpu)
