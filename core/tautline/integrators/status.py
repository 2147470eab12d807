"""How a run can end, with a sentence for each."""

from __future__ import annotations

from enum import IntEnum
from typing import Any

from tautline.errors import TautlineError


class Status(IntEnum):
    """What the compiled loop reports."""

    DONE = 0
    NOT_CONVERGED = 1
    SINGULAR = 2
    NOT_FINITE = 3
    UNSTABLE = 4
    NO_EQUILIBRIUM = 5
    INACCURATE = 6
    NO_LENGTH = 7
    NULL_MOTION = 8
    OFF_WHEEL = 9
    RUN_OUT = 10
    TWO_BLOCKED = 11
    DRUM_FULL = 12
    SLACK_ON_WHEEL = 13
    IMBALANCE = 14
    NO_FORCE = 15
    NO_BALANCE = 16

    @property
    def word(self) -> str:
        """What the results and the reports of commands call it."""
        return self.name.lower().replace("_", " ")


SENTENCES = {
    Status.DONE: "done",
    Status.NOT_CONVERGED: (
        "the iterations of a step did not converge, even with the step halved as often as is allowed; "
        "try a smaller step, or look at what changes abruptly at that time"
    ),
    Status.SINGULAR: (
        "the tangent matrix is singular: a part is not held, or two conditions hold the same degree of freedom"
    ),
    Status.NOT_FINITE: "a number overflowed: the motion has become unphysical; try a smaller step",
    Status.UNSTABLE: (
        "the explicit method is unstable at this step: it is longer than the critical step 2.8 / omega_max "
        "(eq. 2.170), which strong damping c makes shorter, 2.8 / (c omega_max^2); take a smaller step, or the "
        "implicit method generalized-alpha"
    ),
    Status.INACCURATE: (
        "the error of a step stays above what `control: error` allows (a crane has it by default), even with the step "
        "halved as often as is allowed; allow a larger error, or take a smaller nominal step"
    ),
    Status.NO_LENGTH: (
        "an element has lost its length: all of its material has moved out through its nodes or lies on a wheel, or "
        "turning has taken as much rope off a drum; end the run earlier, or begin with a longer element"
    ),
    Status.NULL_MOTION: (
        "the rope is perpendicular to every support of its node, and p of the node is free. The node can slide along "
        "the rope, and nothing resists. Hold the node in a further direction, or hold its p"
    ),
    Status.OFF_WHEEL: (
        "the rope no longer runs over a sheave as it was led: the straight line between its neighbours passes it by, "
        "or it has gone round the sheave by a whole turn; keep the load where the rope is led, or add a sheave that "
        "leads it"
    ),
    Status.RUN_OUT: "all of the rope has run off its drum; pay out less, or give the drum more rope",
    Status.TWO_BLOCKED: (
        "two-blocking: a hook or block has reached the sheave or drum that its rope leads to. Stop hoisting earlier. "
        "If no winch hoisted it, find what moved the load upwards"
    ),
    Status.DRUM_FULL: (
        "all layers that a drum may have are full of rope; hoist less, or give the drum more turns or layers"
    ),
    Status.SLACK_ON_WHEEL: (
        "slack rope has fallen back onto the wheel that it leaves, and how it lies there is not known. A winch pays "
        "out faster than the load can follow, or goes on paying out after the load has landed, or a load is thrown up; "
        "pay out slower, stop when the load has landed, or take fewer elements for that span"
    ),
    Status.IMBALANCE: (
        "the run went to its end, but its energy does not balance: what it shows is not what the equations say; take "
        "a smaller step, and finer elements where they fold. If a smaller step does not help, a force law of the "
        "scene creates energy"
    ),
    Status.NO_FORCE: ("a force that was added, or a hook of an extension, gives nan or infinity: correct its function"),
    Status.NO_BALANCE: (
        "the run went to its end, but its energy has no value: nobody can say whether it balances, and so whether what "
        "the run shows is right. Correct the hook that gives no number"
    ),
    Status.NO_EQUILIBRIUM: "no static equilibrium was found to start from",
}


ON_WHEELS = (Status.OFF_WHEEL, Status.RUN_OUT, Status.TWO_BLOCKED, Status.DRUM_FULL, Status.SLACK_ON_WHEEL)
"""Ends of a run that a drum or a sheave as a whole has."""


class StoppedEarly(TautlineError):
    """A run that ended before its time; what it had is kept.

    Attributes
    ----------
    status : Status
    time : float
        Simulated time reached, s.
    part : str
        The unknown that was worst.
    detail : str
        What is known of the case beyond its status.
    sentence : str
        What it means and what to do, with the numbers of the case where there are any.
    result : Result or None
        What was stored until then.
    """

    def __init__(self, status: Status, time: float, part: str, detail: str = "", result: Any = None) -> None:
        # What happens on a wheel happens to all of it, whichever of its unknowns was worst.
        part = part.partition(":")[0] if status in ON_WHEELS else part
        self.status, self.time, self.part, self.detail, self.result = status, time, part, detail, result
        self.sentence = SENTENCES[status] + (f" ({detail})" if detail else "")
        super().__init__(f"{status.name} at t = {time:.6g} s, {part}: {self.sentence}")

    @property
    def line(self) -> str:
        """What a command prints of it."""
        if self.status is Status.TWO_BLOCKED:
            place = self.part.partition(":")[0]
            rest = self.sentence.partition(". ")[2]
            return f"two-blocking at {self.time:.4g} s: a hook or block has reached `{place}`. {rest}"
        return f"stopped at t = {self.time:.6g} s, {self.part}: {self.sentence}"


class Interrupted(TautlineError):
    """A run that the user interrupted; ``result`` is what was stored until then, ``time`` how far it came."""

    def __init__(self, time: float, result: Any = None) -> None:
        self.time, self.result = time, result
        super().__init__(f"interrupted at t = {time:.6g} s")
