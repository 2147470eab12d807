"""One run of a scene in a study: how it is set, how it ended, what it took."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from statistics import median
from typing import Any

import numpy as np

from tautline.integrators.state import State
from tautline.integrators.status import StoppedEarly
from tautline.results.result import Result
from tautline.run import Look
from tautline.scene.errors import SceneError
from tautline.scene.limits import without_limits
from tautline.scene.methods import explicit_like, implicit_like
from tautline.simulation import simulate
from tautline.system.model import Model

ENOUGH = 0.5
"""Wall time, s, after which a run is not repeated again: a long run's time is certain enough."""
LAST = 1.0e-9
"""Share of a run's time by which its last frame may be early."""
GIVEN_UP = "given up"
"""Status of a run that took longer than it may."""


@dataclass(frozen=True)
class Setting:
    """How a scene is run; None keeps what it says.

    Attributes
    ----------
    method : str or None
    step : float or None
        s; fixed unless `step_error` is given.
    step_error : float or None
        Error of a step, m, that the step is controlled by; ``step`` is then the longest.
    rho_inf : float or None
    elements : float
        Number of elements over the scene's own.
    constraint : str or None
        How constraints are imposed.
    newton : str or None
        ``modified`` or ``full``: whether an implicit method keeps old factors.
    """

    method: str | None = None
    step: float | None = None
    step_error: float | None = None
    rho_inf: float | None = None
    elements: float = 1.0
    constraint: str | None = None
    newton: str | None = None

    @property
    def kind(self) -> tuple[str | None, float, str | None, str | None]:
        """What settings share that differ in their step alone."""
        return self.method, self.elements, self.constraint, self.newton

    def __str__(self) -> str:
        parts = [self.method or "the scene's method"]
        if self.step_error is not None:
            parts.append(f"step error {self.step_error:.3g} m")
        elif self.step is not None:
            parts.append(f"step {self.step:.4g} s")
        if self.rho_inf is not None:
            parts.append(f"rho_inf {self.rho_inf:g}")
        if self.elements != 1.0:
            parts.append(f"{self.elements:g} x the elements")
        if self.constraint is not None:
            parts.append(self.constraint)
        if self.newton is not None:
            parts.append(f"{self.newton} Newton")
        return ", ".join(parts)


@dataclass(frozen=True)
class Trial:
    """A run that was made, or refused.

    Attributes
    ----------
    setting : Setting
    status : str
        ``done``, ``refused``, ``given up``, or the name of the status that it stopped with.
    sentence : str
        What that means, and what to do; empty if done.
    result : Result or None
        What was stored, also of a run that stopped.
    wall, cpu : tuple of float
        Of the time loop of each repetition, s: without compilation, building, frames and files.
    """

    setting: Setting
    status: str
    sentence: str = ""
    result: Result | None = None
    wall: tuple[float, ...] = ()
    cpu: tuple[float, ...] = ()

    @property
    def done(self) -> bool:
        """Whether it came to its end."""
        return self.status == "done"

    @property
    def wall_time(self) -> float | None:
        """Median of the repetitions, s."""
        return median(self.wall) if self.wall else None

    @property
    def cpu_time(self) -> float | None:
        """Median of the repetitions, s."""
        return median(self.cpu) if self.cpu else None

    def attribute(self, name: str) -> Any:
        """Attribute of the stored run; None if there is none."""
        return None if self.result is None else self.result.attributes.get(name)


@dataclass
class Subject:
    """A scene under study: its application and what all runs of it share.

    Attributes
    ----------
    application : Application
    scene : scene
        As it was read.
    end : float or None
        Simulated time, s, in place of the scene's.
    whole : float or None
        The scene's own, s, where ``end`` is less of it because only a quick look is asked for.
    interval : float or None
        Of the frames, s, in place of the scene's; a longer step takes its own.
    announce : callable or None
        Called before kernels are compiled.
    """

    application: Any
    scene: Any
    end: float | None = None
    interval: float | None = None
    whole: float | None = None
    announce: Callable[[int], Any] | None = None
    change: Callable[[Model], Model] = field(default=lambda model: model)

    @property
    def explicit(self) -> str:
        """Name of the explicit method that the scene is looked at with: its own, or the usual one."""
        return explicit_like(self.scene.solver.method)

    @property
    def implicit(self) -> str:
        """Name of the implicit method that the scene is looked at with: its own, or the usual one."""
        return implicit_like(self.scene.solver.method)

    def arranged(self, setting: Setting) -> Any:
        """The scene with a setting; raises SceneError where it cannot be so."""
        scene, given = self.scene, setting
        for what, value in (("constraint", given.constraint), ("elements", given.elements)):
            if value is not None and value != 1.0:
                varied = self.application.vary(scene, what, value)
                scene = scene if varied is None else varied
        control = None
        if given.step_error is not None:
            control = "error"
        elif given.step is not None:
            control = "fixed"
        return self.application.with_overrides(
            scene, method=given.method, step=given.step, end=self.end, rho_inf=given.rho_inf, control=control,
            step_error=given.step_error, interval=self._interval(given.step),
            newton=given.newton,
        )  # fmt: skip

    def _interval(self, step: float | None) -> float | None:
        if self.interval is None:
            made = self.application.build(self.application.with_overrides(self.scene, end=self.end))
            self.interval = float(made.solver.interval)
        return self.interval if step is None or step <= self.interval else step

    def varied(self, what: str, value: Any) -> Subject | None:
        """The same of a scene that is varied in one respect; None if it has nothing of the kind; raises SceneError."""
        scene = self.application.vary(self.scene, what, value)
        return None if scene is None else replace(self, scene=scene)

    def model(self, setting: Setting) -> Model:
        """The model of a setting, without limits, which may name elements that it lacks; raises SceneError."""
        return self.change(self.application.build(without_limits(self.arranged(setting))))

    def run(self, setting: Setting, repetitions: int = 1, **further: Any) -> Trial:
        """Run a setting, again and again for its time where it is short; bad input and stops become a status."""
        try:
            model = self.model(setting)
        except SceneError as error:
            return Trial(setting, "refused", _one_line(error))
        trial = run_model(model, setting, announce=self.announce, **further)
        while len(trial.wall) < repetitions and sum(trial.wall) < ENOUGH * repetitions and trial.done:
            again = run_model(self.model(setting), setting)
            trial = replace(trial, wall=trial.wall + again.wall, cpu=trial.cpu + again.cpu)
        return trial


class OutOfTime(Exception):
    """A run has taken longer than it may."""


class Allowance:
    """Looks at a run, and ends it where it takes longer than it may: a look is a two-hundredth of it at most.

    It is processor time that counts, or what is given up would depend on what else the machine does. What has to be
    compiled, and the way to the start, do not count.
    """

    def __init__(self, seconds: float, look: Look | None = None) -> None:
        self.seconds, self.look, self.began, self.reached = seconds, look, 0.0, 0.0

    def __call__(self, state: State, t: float, method: Any) -> None:
        """Take note of a state; raises OutOfTime."""
        now = time.thread_time()
        if t == 0.0:
            self.began = now
        self.reached = t
        if self.look is not None:
            self.look(state, t, method)
        if now - self.began > self.seconds:
            raise OutOfTime


def run_model(
    model: Model, setting: Setting, seconds: float | None = None, look: Look | None = None, **further: Any
) -> Trial:
    """Run a model and tell how it ended.

    Parameters
    ----------
    seconds : float or None
        Processor time after which the run is given up.
    look : callable or None
        As `simulate` takes it, to which ``further`` goes too.
    """
    allowance = None if seconds is None else Allowance(seconds, look)
    try:
        result = simulate(model, look=allowance or look, **further)
    except StoppedEarly as stop:
        return _ended(setting, stop.status.name, stop.sentence, stop.result)
    except OutOfTime:
        assert allowance is not None
        reached = f"at t = {allowance.reached:.4g} of {model.solver.end:.4g} s"
        return Trial(setting, GIVEN_UP, f"{reached}, after the {seconds:.3g} s that a run may take")
    status, sentence = "done", ""
    if float(result.time[-1]) < model.solver.end * (1.0 - LAST):
        status, sentence = "INCOMPLETE", "the last frame lies before the end of the run"
    elif not _finite(result):
        status, sentence = "NOT_FINITE", "a stored number is not finite"
    return _ended(setting, status, sentence, result)


def _ended(setting: Setting, status: str, sentence: str, result: Result | None) -> Trial:
    times: list[tuple[float, ...]] = []
    for name in ("wall_time", "cpu_time"):
        value = None if result is None else result.attributes.get(name)
        times.append(() if value is None else (float(value),))
    return Trial(setting, status, sentence, result, *times)


def _finite(result: Result) -> bool:
    numbers = (np.asarray(result[name]) for name in result.variables)
    return all(bool(np.isfinite(values).all()) for values in numbers if values.dtype.kind == "f")


def _one_line(error: SceneError) -> str:
    """The first fault without the file that it is in: the key, its value, what is wrong and what to do."""
    return str(replace(error.problems[0], file="", line=None))
