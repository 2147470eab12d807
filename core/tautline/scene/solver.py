"""How a scene is solved and what of it is kept: the same for every application."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

from tautline.scene import methods
from tautline.scene.choices.words import WordOf, word
from tautline.scene.model import Model, Whole
from tautline.scene.refusal import fault
from tautline.scene.values.quantity import quantity

MOST_STEPS = 1.0e9
MOST_FRAMES = 1.0e6
SAME_TIME = 1.0e-9
"""Share of a step by which rounding may make an interval longer."""
SAME_NUMBER = 1.0e-12
"""Share of a number of intervals by which rounding may make it smaller."""

METHODS = WordOf(methods.names, methods.aliases)
Method = Annotated[str, METHODS]
Time = Annotated[float, quantity("s", positive=True, of="time simulated")]
Step = Annotated[float | Literal["auto"], quantity("s", positive=True, words=("auto",), of="time step")]
Accuracy = Annotated[float, quantity("", positive=True, below=1.0, of="relative error")]
Newton = Annotated[Literal["modified", "full"], word("modified", "full")]
Control = Annotated[Literal["fixed", "error"], word("fixed", "error")]


DEFAULT_RHO = 0.8
"""Spectral radius at infinite frequency where a scene gives neither it nor the alphas."""


def check_alphas(alpha_m: float | None, alpha_f: float | None) -> None:
    """Refuse one of the alphas without the other, and pairs that are unstable (eq. 2.83)."""
    if (alpha_m is None) != (alpha_f is None):
        there, lacking = ("alpha_f", "alpha_m") if alpha_m is None else ("alpha_m", "alpha_f")
        raise fault(lacking, f"is missing beside {there}", f"add `{lacking}:`, or give rho_inf instead of both")
    if alpha_m is None or alpha_f is None:
        return
    if alpha_f > 0.5:
        raise fault("alpha_f", "must not be more than 0.5: the method is unstable beyond", "give 0.5 or less")
    if alpha_m > alpha_f:
        cause = f"must not be more than alpha_f = {alpha_f:g}: the method is unstable so (eq. 2.83)"
        raise fault("alpha_m", cause, "lower alpha_m, or give rho_inf instead of both")


def alphas_of(method: str, rho_inf: float | None, alpha_m: float | None, alpha_f: float | None) -> tuple[float, float]:
    """``alpha_m, alpha_f`` as given or from rho_inf (eqs 2.79-2.80); zero for methods without them."""
    if not methods.method_of(method).has_alphas:
        return 0.0, 0.0
    if alpha_m is not None and alpha_f is not None:
        return alpha_m, alpha_f
    rho = DEFAULT_RHO if rho_inf is None else rho_inf
    return (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)


def unused_alphas(solver: Any) -> list[str]:
    """Notes of parameters of generalized-alpha beside another method; none where there are none.

    Parameters
    ----------
    solver : Solver or CableSolver
    """
    given = [name for name in ("rho_inf", "alpha_m", "alpha_f") if getattr(solver, name) is not None]
    if methods.method_of(solver.method).has_alphas or not given:
        return []
    names, them = " and ".join(given), "it" if len(given) == 1 else "them"
    return [f"{solver.method} has no {names} and ignores {them}; take generalized-alpha, or remove {them}"]


def check_control(solver: Any, key: str, by_error: bool = False) -> None:
    """Refuse step control without an error to keep to, and for a method that has none.

    Parameters
    ----------
    solver : Solver or CableSolver
    key : str
        What the error is called in the file.
    by_error : bool
        Whether steps are controlled by their error, and by which, where the file does not say it: those of a crane are.

    Raises
    ------
    ValidationError
        At ``key`` or ``control``.
    """
    error = solver.step_error
    says = "control" in solver.model_fields_set
    fixed = solver.step != "auto" and solver.control == "fixed" and (says or not by_error)
    if solver.explicit and solver.control == "error":
        raise fault("control", f"{solver.method} has no control of its error", "use generalized-alpha, or step: auto")
    if error is None and not by_error and solver.control == "error" and solver.step != "auto":
        raise fault(key, "is missing beside control: error", f"add `{key}:`, a length such as 1.0e-5")
    if error is not None and solver.explicit and by_error:
        raise fault(key, f"is not used: {solver.method} has no control of its error", f"remove {key}")
    if error is not None and fixed:
        cure = f"{'write' if says else 'add'} `control: error`, or remove {key}"
        raise fault(key, "is not used with a fixed step", cure)


def longest_step(solver: Any, interval: float) -> float:
    """Longest step of a run, s: the scene's, or the output's interval where the step is chosen."""
    return interval if solver.step == "auto" else float(solver.step)


def step_taken(solver: Any, interval: float) -> float:
    """Longest step that a run takes where the scene gives one, s; 0 where it is chosen.

    Each frame is divided into equal steps. What is left of the run after the last whole interval takes no longer ones.
    """
    if solver.step == "auto":
        return 0.0
    whole, rest = frames_to(solver.end, interval)
    return divided(interval if whole else rest, float(solver.step))


def frames_to(end: float, interval: float) -> tuple[int, float]:
    """Whole intervals up to the end of a run, s, and what is left after them, s: 0 where that is only rounding."""
    whole = math.floor(end / interval * (1.0 + SAME_NUMBER))
    rest = end - whole * interval
    return whole, rest if rest > SAME_TIME * interval else 0.0


def divided(interval: float, step: float) -> float:
    """The interval of the frames in equal steps, none longer than ``step``, s."""
    return interval / math.ceil(interval / min(step, interval) - SAME_TIME)


def fixed_step(solver: Any) -> float:
    """Step of an implicit method whose steps are all as long, s; 0 where steps are chosen, or are what is stable."""
    fixed = getattr(solver, "control", "fixed") == "fixed" and not solver.explicit and solver.step != "auto"
    return float(solver.step) if fixed else 0.0


def error_of_steps(solver: Any, usual: float) -> float:
    """Error in position that a step may have, m: the scene's, `usual` where the step is chosen, 0 for no control."""
    if solver.explicit or (solver.control == "fixed" and solver.step != "auto"):
        return 0.0
    return usual if solver.step_error is None else float(solver.step_error)


def with_step(given: Any, key: str) -> Any:
    """A ``solver`` section as it is written, with the step that stands for none where an accuracy is given."""
    if isinstance(given, dict) and given.get("accuracy") is not None and key not in given:
        return {key: "auto", **given}
    return given


class Solver(Model):
    """The time integrator.

    Generalized-alpha takes `rho_inf` (spectral radius at infinite frequency: 1 keeps, 0 kills what the step cannot
    follow), or both `alpha_m` and `alpha_f` (thesis eqs 2.79 to 2.83). The other methods pass them over, so that a
    scene can be run by each.

    With `control: error` an implicit method halves and doubles the step to keep the error of one below `step_error`, m.
    `step: auto` chooses the longest step as well: the output's interval, and for rk4 what is stable.

    `newton: full` makes a new tangent in every iteration of an implicit method, as the thesis does; `modified` keeps
    the factors of an old one, also across steps, while they still contract.

    `frequency`, Hz, is the highest that the answer is to show: `check` and `simulate` warn of a step that is too long
    for it, as they do for the functions of time in the scene.

    `accuracy: 1 %` lets `simulate` choose method and step by itself, so that the estimated error of position, force and
    twist due to the steps is no larger. `step` may then be left out; what does not choose takes `step: auto` for it.
    """

    method: Method = "generalized-alpha"
    rho_inf: Annotated[float, quantity("", nonnegative=True, at_most=1.0, of="parameter of the method")] | None = None
    alpha_m: Annotated[float, quantity("", of="parameter of the method")] | None = None
    alpha_f: Annotated[float, quantity("", of="parameter of the method")] | None = None
    step: Step
    end: Time
    control: Control = "fixed"
    step_error: Annotated[float, quantity("m", positive=True, of="step error")] | None = None
    tolerance: Annotated[float, quantity("", positive=True, below=1.0, of="parameter of the method")] | None = None
    frequency: Annotated[float, quantity("Hz", positive=True, of="frequency")] | None = None
    accuracy: Accuracy | None = None
    max_iterations: Annotated[Whole, Field(ge=1, le=1000)] = 20
    max_halvings: Annotated[Whole, Field(ge=0, le=40)] = 10
    newton: Newton = "modified"
    criterion: Annotated[Literal["energy", "force"], word("energy", "force")] | None = None
    by_error: ClassVar[bool] = False
    """Whether steps are controlled by their error where the scene does not say it."""

    @classmethod
    def _in_full(cls, given: Any) -> Any:
        """A scene whose accuracy is given needs no step."""
        return with_step(given, "step")

    @model_validator(mode="after")
    def _check(self) -> Solver:
        given = [name for name in ("rho_inf", "alpha_m", "alpha_f") if getattr(self, name) is not None]
        if "rho_inf" in given and len(given) > 1:
            raise fault(given[1], "is given together with rho_inf", "keep rho_inf, or alpha_m and alpha_f")
        check_alphas(self.alpha_m, self.alpha_f)
        check_control(self, "step_error", self.by_error)
        if self.step == "auto":
            return self
        if self.end < self.step:
            raise fault("end", f"is before the first step ends ({self.step:g} s)", "end later, or take a smaller step")
        if self.end / self.step > MOST_STEPS:
            cause = f"makes {self.end / self.step:.1e} steps to the end, more than {MOST_STEPS:.0e}"
            raise fault("step", cause, "take a larger step, or end earlier")
        return self

    @property
    def explicit(self) -> bool:
        """Whether the method is explicit: it has a critical step, and no control of its error."""
        return methods.method_of(self.method).explicit

    @property
    def alphas(self) -> tuple[float, float]:
        """``alpha_m, alpha_f`` of generalized-alpha (zero for Newmark); `rho_inf` defaults to 0.8."""
        return alphas_of(self.method, self.rho_inf, self.alpha_m, self.alpha_f)


INTERVAL = 0.05
"""Interval of the frames of which statistics are taken, s, where none is given."""
FRAMES, STATISTICS = "frames", "statistics"
FRAMES_OF_A_BLOCK = 100
"""Frames of a block that is named as an example."""
OF_STATISTICS = ("windows", "block", "begin", "of")


class Output(Model):
    """What is kept: a frame every `interval`, or the statistics of these frames.

    Of statistics, `windows` is the length of the stretches of whole frames around the largest and the smallest of each
    of the variables `of`; `block` the length of the blocks of which these are kept; `begin` the time from which on
    values count, for figures and limits too; the start of the run stands for what is at rest.
    """

    interval: Annotated[float, quantity("s", positive=True, of="interval of frames")]
    keep: Annotated[Literal["frames", "statistics"], word(FRAMES, STATISTICS)] = "frames"
    windows: Annotated[float, quantity("s", positive=True, of="duration")] = 20.0
    block: Annotated[float, quantity("s", positive=True, of="duration")] = 600.0
    begin: Annotated[float, quantity("s", nonnegative=True, of="moment")] = 0.0
    of: tuple[str, ...] = Field((), examples=["[tension]"])

    @classmethod
    def _in_full(cls, given: Any) -> Any:
        """`output: statistics` is short for a mapping; statistics need no interval of their own."""
        if given == STATISTICS:
            given = {"keep": STATISTICS}
        if isinstance(given, dict) and given.get("keep") == STATISTICS and "interval" not in given:
            given = {"interval": INTERVAL, **given}
        return given

    @model_validator(mode="after")
    def _fits(self) -> Output:
        if self.keep == FRAMES:
            for key in OF_STATISTICS:
                if key in self.model_fields_set:
                    raise fault(key, "is for statistics, and every frame is kept", f"add keep: {STATISTICS}")
        elif self.block < self.interval * (1.0 - 1e-9):
            cause = f"is shorter than output.interval ({self.interval:g} s): blocks would hold no frame"
            if "block" not in self.model_fields_set:
                cause = f"is not given. It is {self.block:g} s then, and {cause}"
            several = f"{FRAMES_OF_A_BLOCK * self.interval:g} s"
            raise fault("block", cause, f"give a block of many frames, such as {several}, or a shorter interval")
        return self

    @property
    def statistics(self) -> bool:
        """Whether statistics are kept in place of every frame."""
        return self.keep == STATISTICS


def check_output(solver: Solver, output: Output) -> None:
    """Check the frames against the steps; for the validator of a scene that holds both.

    Raises
    ------
    ValidationError
        At ``output.interval``.
    """
    at = ("output", "interval")
    if output.statistics and output.begin >= solver.end:
        raise fault(("output", "begin"), f"is not before the end of the run ({solver.end:g} s)", "begin earlier")
    if solver.step != "auto" and output.interval < solver.step * (1.0 - 1e-9):
        cause = f"is shorter than the step ({solver.step:g} s): there is nothing between two steps to keep"
        raise fault(at, cause, "give at least solver.step, or take smaller steps")
    if output.interval > solver.end * (1.0 + 1e-9):
        raise fault(at, f"is longer than the whole run ({solver.end:g} s)", "give less than solver.end")
    if solver.end / output.interval > MOST_FRAMES:
        cause = f"keeps {solver.end / output.interval:.1e} frames, more than {MOST_FRAMES:.0e}"
        raise fault(at, cause, "give a longer interval, or end earlier")
