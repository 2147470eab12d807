"""What the models of all applications have in common: how they are solved, what a result says of itself, energies."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from tautline.results.assessment.balance import ENERGIES
from tautline.results.on_demand import OnDemand
from tautline.results.variable import Variable
from tautline.scene.identity.contents import BESIDES, model_hash
from tautline.scene.solver import longest_step
from tautline.system.model import SolverSettings


def settings_of(
    solver: Any, interval: float, tolerance: float, criterion: str, step_error: float = 0.0, **more: Any
) -> SolverSettings:
    """How a model is solved, as the ``solver`` section of its scene says.

    Parameters
    ----------
    solver : tautline.scene.solver.Solver
        The section; `tolerance` and `criterion` (``force`` or ``energy``) count where it has none.
    interval : float
        Between frames, s.
    step_error : float
        Error that a step may have, m; 0 leaves steps as they are.
    **more
        Other fields of `SolverSettings`.

    Returns
    -------
    SolverSettings
    """
    alpha_m, alpha_f = solver.alphas
    optional = {key: getattr(solver, key) for key in ("max_iterations", "max_halvings") if hasattr(solver, key)}
    return SolverSettings(
        solver.method, longest_step(solver, interval), solver.end, interval, alpha_m, alpha_f,
        solver.tolerance or tolerance, getattr(solver, "criterion", None) or criterion, step_error=step_error,
        automatic=solver.step == "auto", newton=solver.newton, **optional, **more,
    )  # fmt: skip


def attributes_of(scene: Any, application: str, conventions: str, besides: Any = BESIDES) -> Mapping[str, Any]:
    """What a result says of its scene: text, title, application, conventions, units, and what the scene is.

    Each is made when it is asked for: a run that is not stored needs none.

    Parameters
    ----------
    scene
        A scene with a ``document``, or one made in Python.
    application : str
        Its name.
    conventions : str
        Signs, axes and the like.
    besides : collection of str
        Fields that do not count in what the scene is; see `tautline.scene.identity.contents.model_hash`.
    """
    document = scene.document
    folder: Path | None = getattr(scene, "folder", None)
    return OnDemand(
        {
            "scene": lambda: document.told if document is not None else "",
            "title": lambda: scene.title or "",
            "application": lambda: application,
            "model_hash": lambda: model_hash(scene, besides, folder),
            "conventions": lambda: conventions,
            "printed_in": lambda: getattr(scene, "units", "si"),
        }
    )


def energy_variables(strain: str, potential: str, lost: str, work: str) -> list[Variable]:
    """The variables of energies, (time,) J, with what each holds of an application.

    Parameters
    ----------
    strain, potential : str
        What follows "strain energy" and "potential energy": `` of the rope``, or nothing.
    lost : str
        What energy is lost to: ``damping and friction``.
    work : str
        Whose work is done from outside: ``of winches and forces``.

    Returns
    -------
    list of Variable
        In the order of the energies of a frame.
    """
    texts = {
        "kinetic_energy": "kinetic energy",
        "strain_energy": f"strain energy{strain}",
        "potential_energy": f"potential energy{potential}",
        "dissipated_energy": f"energy lost to {lost}",
        "external_work": f"work {work}",
    }
    return [Variable(name, ("time",), "J", text) for name, text in texts.items()]


def energies_of(frames: Any) -> dict[str, np.ndarray]:
    """Values of the variables of energies from a batch of frames.

    Parameters
    ----------
    frames
        With ``energy`` (frames, 5) J, as `Observer.observe` of an application is given them.

    Returns
    -------
    dict of str to (frames,) array
        By the names of `energy_variables`, J.
    """
    return {name: frames.energy[:, k].copy() for k, name in enumerate(ENERGIES)}
