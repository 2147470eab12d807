"""``GeneralizedAlpha``: the integrator, by the names of the thesis' section 3.1.9 in the file and the house's here."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from tautline.scene.choices.words import word
from tautline.scene.methods import method_of
from tautline.scene.model import Model, Switch, Whole
from tautline.scene.refusal import fault
from tautline.scene.solver import (
    METHODS,
    MOST_FRAMES,
    MOST_STEPS,
    Accuracy,
    Control,
    Newton,
    Step,
    Time,
    alphas_of,
    check_alphas,
    check_control,
    with_step,
)
from tautline.scene.values.quantity import quantity

FRAMES_OF_AUTO = 1000
"""Frames of a run whose step is chosen, where the scene does not say how many it wants."""


class CableSolver(Model):
    """How a cable is solved.

    Theirs: ``type`` RK4, G-alpha or Newmark; ``alpha_m`` and ``alpha_f`` of eqs 2.79 to 2.83, passed over by the other
    methods; ``eps_energy`` of eq. 2.78; ``plotpoints`` frames a second, 0 for every step.

    Ours: ``rho_inf`` in place of the alphas. ``start: static`` looks for equilibrium first, ``relaxed`` lets
    the scene come to rest by dynamic relaxation. RK4 with multipliers comes
    back to the constraints after each step by ``stabilise`` projections (two in the thesis, eqs 2.124-2.125), in the
    metric of the ``mass`` (eq. 2.127) or of ``identity`` (eq. 2.128). ``control: error`` halves and doubles the step
    to keep the local error below ``tolerance``, m; ``time_step: auto`` chooses the longest step as well.
    ``newton: full`` makes a new tangent in every iteration, as the thesis does; ``modified`` keeps the factors of an
    old one. ``frequency``, Hz, is the highest that the answer is to show: a step that is too long for it is warned of.
    ``accuracy: 1 %`` lets ``simulate`` choose method and step by itself; ``time_step`` may then be left out.
    """

    method: Annotated[str, METHODS] = Field("generalized-alpha", alias="type")
    rho_inf: Annotated[float, quantity("", nonnegative=True, at_most=1.0, of="parameter of the method")] | None = None
    alpha_m: Annotated[float, quantity("", of="parameter of the method")] | None = None
    alpha_f: Annotated[float, quantity("", of="parameter of the method")] | None = None
    tolerance: Annotated[float, quantity("", positive=True, below=1.0, of="parameter of the method")] = Field(
        1.0e-8, alias="eps_energy"
    )
    max_iterations: Annotated[Whole, Field(ge=1, le=1000)] = Field(20, alias="maxIter")
    mass_damping: Annotated[float, quantity("1/s", nonnegative=True, of="rate of damping")] = Field(
        0.0, alias="massDamp"
    )
    step: Step = Field(alias="time_step")
    end: Time = Field(alias="time_end")
    plotpoints: Annotated[float, quantity("", nonnegative=True, of="frames a second")] = 0.0
    skip_vtk: Switch = Field(True, alias="skipVTK")
    start: Annotated[Literal["static", "relaxed", "as given"], word("static", "relaxed", "as given")] = "as given"
    projection: Annotated[Literal["mass", "identity", "none"], word("mass", "identity", "none")] = "identity"
    stabilise: Annotated[Whole, Field(ge=0, le=2)] = 2
    control: Control = "fixed"
    step_error: Annotated[float, quantity("m", positive=True, of="step error")] | None = Field(None, alias="tolerance")
    newton: Newton = "modified"
    frequency: Annotated[float, quantity("Hz", positive=True, of="frequency")] | None = None
    accuracy: Accuracy | None = None

    @classmethod
    def _in_full(cls, given: Any) -> Any:
        """A scene whose accuracy is given needs no step."""
        return with_step(given, "time_step")

    @model_validator(mode="after")
    def _alphas(self) -> CableSolver:
        given = [name for name in ("rho_inf", "alpha_m", "alpha_f") if getattr(self, name) is not None]
        if "rho_inf" in given and len(given) > 1:
            raise fault("rho_inf", f"is given together with {given[1]}", "keep rho_inf, or alpha_m and alpha_f")
        check_alphas(self.alpha_m, self.alpha_f)
        return self

    @model_validator(mode="after")
    def _times(self) -> CableSolver:
        check_control(self, "tolerance")
        if self.step == "auto":
            return self
        if self.end < self.step:
            cause = f"is before the first step ends ({self.step:g} s)"
            raise fault("time_end", cause, "end later, or take a smaller time_step")
        if self.end / self.step > MOST_STEPS:
            cause = f"makes {self.end / self.step:.1e} steps to the end, more than {MOST_STEPS:.0e}"
            raise fault("time_step", cause, "take a larger step, or end earlier")
        if self.end / self.interval > MOST_FRAMES:
            cause = f"keeps {self.end / self.interval:.1e} frames, more than {MOST_FRAMES:.0e}"
            raise fault("plotpoints", cause, "ask for fewer frames a second, such as 100, or end earlier")
        return self

    @property
    def interval(self) -> float:
        """Time between the frames that are kept, s: no shorter than a step, no longer than the run."""
        if self.step == "auto":
            return min(1.0 / self.plotpoints if self.plotpoints > 0.0 else self.end / FRAMES_OF_AUTO, self.end)
        asked = 1.0 / self.plotpoints if self.plotpoints * self.step > 0.0 else self.step
        return min(max(asked, self.step), self.end)

    @property
    def explicit(self) -> bool:
        """Whether the method is explicit: it has a critical step, and no control of its error."""
        return method_of(self.method).explicit

    @property
    def alphas(self) -> tuple[float, float]:
        """``alpha_m, alpha_f`` of generalized-alpha (zero for the others); `rho_inf` defaults to 0.8."""
        return alphas_of(self.method, self.rho_inf, self.alpha_m, self.alpha_f)
