"""A scene that is ready to run: its system, its solver, and what its frames mean."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tautline.kernels.time_function import TimeFunctions
from tautline.system.handles import Handles
from tautline.system.system import System


@dataclass(frozen=True)
class SolverSettings:
    """What the integrator is told.

    method ``generalized-alpha``, ``newmark`` or ``rk4``; alpha_m and alpha_f of eqs 2.79-2.80; nominal step, end and
    output interval s; how an explicit method is put back onto its constraints (``mass``: eq. 2.127, ``identity``:
    eq. 2.128) and how often a step; tolerance and criterion (``force``: residual over scale; ``energy``: eq. 2.78 with
    the energy over ``energy_unit`` J, by default that of the largest force through one metre); limits;
    ``step_error`` m, above which the error of an implicit step halves it, or 0; ``automatic``: ``step`` is the longest,
    an explicit method takes what is stable; ``contraction``: the part of a residual that an iteration with old
    factors may leave before they are made anew; ``newton``: ``modified``, or ``full`` for new factors in every
    iteration; ``guarded``: an explicit run stops where its step is beyond the
    critical one, even where nothing has grown yet.
    """

    method: str
    step: float
    end: float
    interval: float
    alpha_m: float
    alpha_f: float
    tolerance: float = 1e-9
    criterion: str = "force"
    max_iterations: int = 20
    max_halvings: int = 10
    projection: str = "mass"
    stabilise: int = 1
    energy_unit: float | None = None
    step_error: float = 0.0
    automatic: bool = False
    contraction: float = 0.1
    newton: str = "modified"
    guarded: bool = True


@dataclass
class Model:
    """What an application builds from a scene, and all that a run needs to know.

    Attributes
    ----------
    system : System
    solver : SolverSettings
    variables : list
        Descriptions of what is stored (``results.variable.Variable``); ``time`` goes without saying.
    coordinates : dict
        name -> (dimension, values, units, long name).
    attributes : mapping
        Stored with the result: the scene's text among them.
    observe : callable
        Frames (``integrators.time_loop.Frames``) of a batch -> dict of arrays, leading axis time.
    on_demand : callable or None
        The same, each array made when it is asked for, of frames that stay as they are; None where an application has
        no such way.
    headline : callable
        Result -> dict of name -> {"value", "unit", "text"}: the application's own figures.
    start : str
        ``static``: from equilibrium, ``relaxed``: from where dynamic relaxation comes to rest, or ``as given``.
    step_limit : float
        Largest change of an unknown in one iteration of the search for it, m or rad.
    own : int
        Numbers that the groups record each frame.
    frames_tell_all : bool
        Whether frames mean the same whatever the parameters are. Else they are observed by a model whose parameters are
        those with which they were computed.
    notes : list of str
        What the builder decided that the user should know.
    confined : bool
        Whether an unstable equilibrium is kept and warned of, as of a pressed string in its hole; others are left.
    settle : callable or None
        Brings the run's state to the static equilibrium that it starts from, where that takes more than finding it: a
        rope of the length that makes its drawing true. It may return the `Stability` of that.
    other_start : str
        What a scene's ``start`` may be where no equilibrium is found: ropes over sheaves have no relaxation.
    aside : str
        Sentence on how to choose the side to which the scene is pushed out of unstable balance; empty where it is drawn
        there.
    carried : str
        What may hold a static start far from the drawing: ``the current``; empty where nothing does.
    limits : callable or None
        Result -> records of what it is judged by (`tautline.results.assessment.limits`).
    remarks : callable or None
        Result -> sentences to warn of with what the run did, such as what no machine can do; None for none.
    of_step : callable or None
        Mean step that a run took, s -> sentences to warn of, where a step is too long for a law; None for none.
    figures : callable or None
        Result, names -> the same as `headline`, of the figures that are named at least; None where no way is
        quicker to some than to all.
    handles : callable or None
        -> what can be driven, read and changed while it runs; None where an application does not say.
    figure_units : mapping
        Figures of `headline` that are one number, by name, with their SI units: those that only some runs have too.
    nothing : collection of str
        Those of them without which a run has nothing of the kind: they are 0 then, such as the longest slack.
    bounds : sequence of tautline.results.assessment.bounds.Bound
        Limits that the scene gives itself.
    keep : tautline.statistics.store.Keep or None
        What is kept in place of every frame; None for every frame.
    longer_steps_tell : bool
        Whether one run with longer steps tells how wrong a run is whose steps are controlled by their errors
        (`tautline.study.trials.step_error`). It was measured for the application, and no friction decides what comes
        of the run.
    blow : str
        Name of the figure that is the largest blow of a run, whose error due to the step is told beside those of motion
        and force: a snap of the rope. Empty where an application has none.
    cause : callable or None
        State, status -> status, place and detail by which a run that stopped is told better; None for what it was.
    at_rest : callable or None
        -> variables by name as they are in the static equilibrium that was found last, before anything moves: what
        figures are over that a sudden start must not change. None where an application has no such figures.
    memory : mapping
        Arrays, by name, in which the application keeps what it found at the start and needs to tell what frames mean. A
        saved state of a simulation holds them.
    statistics : mapping
        Fields of `Keep` that are the application's: variables that are watched where the scene names none, and so on.
    extremes : mapping
        Pattern of a figure's name -> ``largest`` or ``smallest``: figures that are so over all frames, and that figures
        of pieces of a run do not make. Those that do stand among the rules of ``statistics``.
    anew : callable or None
        Functions of time of this model, which something may have written into -> the model of the same scene with them,
        for an application whose builder takes from them how all of the scene moves at t = 0. None where it takes
        nothing that the start does not find again.
    """

    system: System
    solver: SolverSettings
    variables: list[Any]
    coordinates: dict[str, tuple[str, np.ndarray, str, str]]
    attributes: Mapping[str, Any]
    observe: Callable[[Any], dict[str, np.ndarray]]
    headline: Callable[[Any], dict[str, dict[str, Any]]]
    start: str = "static"
    step_limit: float = 1.0
    own: int = 0
    frames_tell_all: bool = True
    notes: list[str] = field(default_factory=list)
    confined: bool = False
    settle: Callable[[Any], Any] | None = None
    other_start: str = "relaxed"
    aside: str = ""
    carried: str = ""
    limits: Callable[[Any], list[dict[str, Any]]] | None = None
    figures: Callable[[Any, Collection[str]], dict[str, dict[str, Any]]] | None = None
    handles: Callable[[], Handles] | None = None
    figure_units: Mapping[str, str] = field(default_factory=dict)
    nothing: Collection[str] = ()
    bounds: Sequence[Any] = ()
    keep: Any = None
    longer_steps_tell: bool = False
    blow: str = ""
    statistics: Mapping[str, Any] = field(default_factory=dict)
    extremes: Mapping[str, str] = field(default_factory=dict)
    on_demand: Callable[[Any], Mapping[str, np.ndarray]] | None = None
    remarks: Callable[[Any], list[str]] | None = None
    of_step: Callable[[float], list[str]] | None = None
    cause: Callable[[Any, Any], tuple[Any, int, str] | None] | None = None
    at_rest: Callable[[], Mapping[str, np.ndarray]] | None = None
    memory: Mapping[str, np.ndarray] = field(default_factory=dict)
    anew: Callable[[TimeFunctions], Model] | None = None

    def seen(self, frames: Any) -> Mapping[str, np.ndarray]:
        """Variables of frames that stay as they are, made on demand where that can be: few may be asked for."""
        return (self.on_demand or self.observe)(frames)

    def end_of(self, state: Any, status: Any, worst: int) -> tuple[Any, str, str]:
        """Status, part and detail of a run that stopped with a status and an unknown that was worst."""
        told = None if self.cause is None else self.cause(state, status)
        end, place, detail = (status, worst, "") if told is None else told
        return end, self.system.name_of(place), detail
