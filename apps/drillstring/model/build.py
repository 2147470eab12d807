"""A drill-string scene compiled into a model: wellbore, lumps, groups, start."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from drillstring.drilling.chatter import chatter_told, longest_step, shortened_told
from drillstring.drilling.end_groups import ROTATION, notes_of_ends, requests
from drillstring.model.handles import handles
from drillstring.model.lumped_model import assemble_lumps
from drillstring.model.prepared import prepared
from drillstring.results.break_away import ON_BOTTOM
from drillstring.results.drilling import creep_of, last_part, stalled_drive, variables_of_ends
from drillstring.results.limits import limits, pushed_at_the_top
from drillstring.results.observe import (
    COORDINATE_UNITS,
    EXTREMES,
    FIGURES,
    JOINED,
    NOTHING,
    headline,
    possible_figures,
    variables,
    whirl_remarks,
)
from drillstring.results.unseen_buckling import told_of_a_run
from drillstring.scene.ends import Controller
from drillstring.scene.scene import BEAM, DrillstringScene
from drillstring.string.factors import factors_of
from drillstring.string.lumps import Lumps
from drillstring.well.wellbore import Wellbore
from tautline.application.limits import with_limits
from tautline.application.modelling import attributes_of, settings_of
from tautline.integrators.statics.attainable import within_rounding
from tautline.kernels.groups import may_switch
from tautline.kernels.time_function import TimeFunctions, sample
from tautline.results.variable import Variable
from tautline.scene.functions import Constant
from tautline.scene.solver import error_of_steps, unused_alphas
from tautline.system.model import Model
from tautline.system.time_functions import compile_functions

TOLERANCE = 1.0e-9
"""Largest residual over the string's weight that counts as solved: a millinewton on a meganewton."""
STEP_ERROR = 1.0e-5
"""Error of a step, m, where the step is chosen and the scene gives none."""


def build(scene: DrillstringScene, functions: TimeFunctions | None = None) -> Model:
    """Compile a scene.

    Parameters
    ----------
    scene : DrillstringScene
    functions : TimeFunctions, optional
        Of the scene, in which block or drive are held at other values: all of the string starts with their speeds.

    Returns
    -------
    Model

    Raises
    ------
    SceneError
        For what only the wellbore and the lumps can tell: a string longer than the hole, a survey with a gap.
    """
    ready = prepared(scene)
    well, lumps = ready.well, ready.lumps
    functions = compile_functions(requests(scene)) if functions is None else functions
    law, notes = _law(scene)
    notes += notes_of_ends(scene, lumps.tubes)
    # A note and no warning: the scene may well be meant to be run by each method.
    notes += unused_alphas(scene.solver)
    string = _assembler(scene.model.kind)(scene, well, lumps, functions, law)
    system, observer = string.system, string.observer
    solver, stored = scene.solver, variables() + variables_of_ends(system.groups)
    criterion = "force" if may_switch(system.groups) else "energy"
    settings = settings_of(solver, scene.output.interval, TOLERANCE, criterion, error_of_steps(solver, STEP_ERROR))
    notes += shortened_told(scene, lumps, settings.step)
    model = Model(
        system=system,
        solver=replace(settings, step=longest_step(scene, lumps, settings.step)),
        variables=stored,
        coordinates=observer.coordinates(),
        attributes=attributes_of(scene, "drillstring", COORDINATE_UNITS),
        observe=observer.observe,
        on_demand=observer.on_demand,
        headline=lambda result: headline(result, lumps, scene.top.weight, creep_of(scene)),
        limits=lambda result: limits(result, scene, lumps),
        remarks=lambda result: _remarks(result, scene, well, lumps),
        of_step=lambda step: chatter_told(scene, lumps, step),
        figure_units=FIGURES,
        nothing=NOTHING,
        start="as given" if scene.start == "straight" else scene.start,
        step_limit=string.step_limit,
        confined=True,
        own=observer.own,
        notes=notes,
        statistics={"rules": JOINED, "possible": _possible(scene, lumps, stored)},
        extremes=EXTREMES,
        handles=lambda: handles(scene, lumps, model),
        anew=lambda held: build(scene, held),
    )  # fmt: skip
    return with_limits(within_rounding(model), scene)


def _remarks(result: Any, scene: DrillstringScene, well: Wellbore, lumps: Lumps) -> list[str]:
    """Sentences on what is seen in a run."""
    found = pushed_at_the_top(result, scene, lumps) + told_of_a_run(result, scene, well, lumps)
    # Of a run that keeps statistics it is told already that they have no whirl ratio, nor how the bit turns.
    return found if scene.output.statistics else found + _stalled(result, scene) + whirl_remarks(result, lumps)


def _stalled(result: Any, scene: DrillstringScene) -> list[str]:
    """A sentence where the drive stalls; none of one that something else drives, which asks what is not known."""
    if not isinstance(scene.top.rotation, Controller) or scene.driven:
        return []
    times = np.asarray(result.time)[last_part(np.asarray(result.time))]
    asked = float(sample(compile_functions(requests(scene)), ROTATION, times)[:, 1].mean())
    return stalled_drive(result, asked, scene.bit.on_bottom, scene.units)


def _possible(scene: DrillstringScene, lumps: Lumps, stored: list[Variable]) -> tuple[str, ...]:
    """Names of the figures that a run of a scene can have."""
    drills = any(one.name == ON_BOTTOM for one in stored)
    moves = not isinstance(scene.top.block, Constant)
    return possible_figures(drills, moves, scene.well.wall is not None, lumps, scene.top.weight)


def _assembler(kind: str) -> Any:
    """What makes a system of the string, by the kind of its model."""
    if kind == BEAM:
        # Only a scene of a beam needs a beam's code.
        from drillstring.model.beam_model import assemble_beam

        return assemble_beam
    return assemble_lumps


def _law(scene: DrillstringScene) -> tuple[str, list[str]]:
    """The friction law that the method can take, and what to tell the user about it."""
    if scene.well.wall is None:
        return "none", []
    law = scene.well.wall.friction.law
    if law == "projection" and scene.solver.explicit:
        if factors_of(scene.well.wall, "static").largest == 0.0:
            return "regularised", []
        speed = scene.well.wall.friction.slip_velocity
        return "regularised", [
            f"friction by projection is implicit: rk4 takes the regularised law instead, slip_velocity {speed:g} m/s "
            "(stuck lumps creep and chatter below their critical step; generalized-alpha does not)"
        ]
    return law, []
