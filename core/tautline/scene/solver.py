"""How a scene is solved and what of it is kept: the same for every application."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from tautline.scene.model import Model, Whole, word
from tautline.scene.quantity import quantity
from tautline.scene.refusal import fault

MOST_STEPS = 1.0e9
MOST_FRAMES = 1.0e6

METHODS = word(
    "generalized-alpha",
    "newmark",
    "rk4",
    aliases={"G-alpha": "generalized-alpha", "generalised-alpha": "generalized-alpha", "runge-kutta": "rk4"},
)
Method = Annotated[Literal["generalized-alpha", "newmark", "rk4"], METHODS]
Step = Annotated[float, quantity("s", positive=True)]


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
    if method != "generalized-alpha":
        return 0.0, 0.0
    if alpha_m is not None and alpha_f is not None:
        return alpha_m, alpha_f
    rho = DEFAULT_RHO if rho_inf is None else rho_inf
    return (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)


class Solver(Model):
    """The time integrator.

    Generalized-alpha takes `rho_inf` (spectral radius at infinite frequency: 1 keeps, 0 kills what the step cannot
    follow), or both `alpha_m` and `alpha_f` (thesis eqs 2.79 to 2.83). The other methods pass them over, so that a
    scene can be run by each.
    """

    method: Method = "generalized-alpha"
    rho_inf: Annotated[float, quantity("", nonnegative=True, at_most=1.0)] | None = None
    alpha_m: Annotated[float, quantity("")] | None = None
    alpha_f: Annotated[float, quantity("")] | None = None
    step: Step
    end: Step
    tolerance: Annotated[float, quantity("", positive=True, below=1.0)] | None = None
    max_iterations: Annotated[Whole, Field(ge=1, le=1000)] = 20
    max_halvings: Annotated[Whole, Field(ge=0, le=40)] = 10
    criterion: Annotated[Literal["energy", "force"], word("energy", "force")] | None = None

    @model_validator(mode="after")
    def _check(self) -> Solver:
        given = [name for name in ("rho_inf", "alpha_m", "alpha_f") if getattr(self, name) is not None]
        if "rho_inf" in given and len(given) > 1:
            raise fault(given[1], "is given together with rho_inf", "keep rho_inf, or alpha_m and alpha_f")
        check_alphas(self.alpha_m, self.alpha_f)
        if self.end < self.step:
            raise fault("end", f"is before the first step ends ({self.step:g} s)", "end later, or take a smaller step")
        if self.end / self.step > MOST_STEPS:
            cause = f"makes {self.end / self.step:.1e} steps to the end, more than {MOST_STEPS:.0e}"
            raise fault("step", cause, "take a larger step, or end earlier")
        return self

    @property
    def alphas(self) -> tuple[float, float]:
        """``alpha_m, alpha_f`` of generalized-alpha (zero for Newmark); `rho_inf` defaults to 0.8."""
        return alphas_of(self.method, self.rho_inf, self.alpha_m, self.alpha_f)


class Output(Model):
    """What is kept: a frame every `interval`."""

    interval: Annotated[float, quantity("s", positive=True)]


def check_output(solver: Solver, output: Output) -> None:
    """Check the frames against the steps; for the validator of a scene that holds both.

    Raises
    ------
    ValidationError
        At ``output.interval``.
    """
    at = ("output", "interval")
    if output.interval < solver.step * (1.0 - 1e-9):
        cause = f"is shorter than the step ({solver.step:g} s): there is nothing between two steps to keep"
        raise fault(at, cause, "give at least solver.step, or take smaller steps")
    if output.interval > solver.end * (1.0 + 1e-9):
        raise fault(at, f"is longer than the whole run ({solver.end:g} s)", "give less than solver.end")
    if solver.end / output.interval > MOST_FRAMES:
        cause = f"keeps {solver.end / output.interval:.1e} frames, more than {MOST_FRAMES:.0e}"
        raise fault(at, cause, "give a longer interval, or end earlier")
