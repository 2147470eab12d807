"""The critical step of an explicit method three ways: effective length, eigenvalues along the run, and real runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.linalg import eigvals

from tautline.integrators.linearise import SUMS, evaluate, evaluate_damping, evaluate_groups
from tautline.integrators.state import State
from tautline.integrators.status import Status, StoppedEarly
from tautline.integrators.vibration.critical_step import CriticalStep, Mode, critical_step
from tautline.kernels.groups import link, without_friction
from tautline.kernels.matrix import dense, new_matrix, sparse
from tautline.results.assessment.balance import ENERGIES
from tautline.results.result import Result
from tautline.run import Run
from tautline.scene.errors import SceneError
from tautline.scene.methods import RK4, Method, method_of
from tautline.study.trials.trial import Setting, Subject, run_model
from tautline.system.system import System
from tautline.threads import one_thread

DENSE = 250
"""Unknowns up to which all eigenvalues are found, and not the fastest alone."""
SAME = 1.0e-6
"""Relative difference of two critical steps that is none."""
LOWER = 0.98
"""Share of the least critical step so far below which a state is looked at more closely."""
STEPS = 3000
"""Steps of a run of the bisection: enough for what is a per cent beyond the limit to grow out of rounding."""
FRAMES = 150
MOST_STEPS = 200_000
"""Steps that the run which is looked at may take by the explicit method."""
FEWEST = 500
"""Steps of a run of the bisection, at least."""
RESOLVED = 0.05
"""Share of it at which a run shows how much its fastest mode moves by itself."""
SHORT = 0.6
"""Share of the critical step by eigenvalues at which a run is stable, most likely."""
GROWTH_LIMIT = 30.0
"""How much more than at a short step the fastest mode may move in a run that counts as stable."""
UNBALANCED = 0.01
"""Error of the energy balance from which a run is not stable, unless a short step has nearly as much."""
ROUNDING_SHARE = 1.0e-9
"""Share of all motion from which a mode is told from rounding."""
APART = 0.01
"""Relative width at which the bisection ends."""
WIDENED = 6
"""Times that the bracket may be doubled or halved before it is given up."""


@dataclass(frozen=True)
class Critical:
    """What limits an explicit step.

    Attributes
    ----------
    effective_length : float or None
        s, eq. 2.151 with Table 2.1, and ``shortest``, the element that sets it; None where nothing is known.
    eigenvalue : float or None
        Least along the run, s, at the time ``at``, s; None where nothing vibrates.
    omega_max : float or None
        Angular frequency of the mode that sets it, rad/s.
    set_by : str
        Which forces hold that mode, and where it is largest.
    bisection : tuple of float or None
        Longest step that was stable in real runs from the scene's start, and shortest that was not, s.
    at_start : float or None
        By eigenvalues, where the bisection begins, s.
    points : (k,) complex array
        Eigenvalues of that state, 1/s, where there are few enough unknowns.
    why : str
        Why a way was not gone.
    method : str
        Name of the explicit method.
    """

    effective_length: float | None
    shortest: str
    eigenvalue: float | None
    at: float
    omega_max: float | None
    set_by: str
    bisection: tuple[float, float] | None
    at_start: float | None
    points: np.ndarray
    why: str
    method: str = RK4.name


class CriticalStepSearch:
    """Looks at a run for the least critical step; ``simulate`` calls it with each state."""

    def __init__(self, system: System, method: Method = RK4) -> None:
        self.system, self.search = system, CriticalStep(system, method)
        self.start = self.least = np.inf
        self.at, self.mode, self.set_by = 0.0, None, ""
        self.points: np.ndarray = np.zeros(0, complex)

    def __call__(self, state: State, t: float, method: Any = None) -> None:
        """Take note of a state."""
        step, row = self.search.search(state, t)
        first = t == 0.0
        points = np.zeros(0, complex)
        if self.system.size <= DENSE and (first or step < self.least):
            points = eigenvalues(self.system, state, t)
            step = float(min([step, *(critical_step_of(x, self.search.method) for x in points)]))
        if first:
            self.start = step
        if step < self.least * (1.0 - SAME):
            if step < LOWER * self.least:
                self.set_by = _set_by(self.system, state, t, self.search.mode, row)
            self.least, self.at, self.mode = step, t, self.search.mode
            self.points = points


def critical_step_of(value: complex, method: Method = RK4) -> float:
    """Longest step of an explicit method, s, for a motion exp(value t); infinite where it grows or does not move."""
    if value == 0.0 or value.real > 1e-6 * abs(value):
        return np.inf
    if value.imag == 0.0:
        return critical_step(0.0, abs(value), method)
    return critical_step(abs(value) ** 2, max(0.0, -2.0 * value.real), method)


@one_thread()
def eigenvalues(system: System, state: State, t: float) -> np.ndarray:
    """Eigenvalues, 1/s, of small motions about a state that moves, its constraints kept: (k,) complex."""
    parts = []
    kept = state.residual.copy()
    for part in np.eye(3):
        matrix = new_matrix(system.size, system.bandwidth, system.border)
        if part[1]:
            evaluate_damping(system, state, t, matrix)
        else:
            evaluate(system, state, t, 0.0, False, *part, matrix, np.zeros(system.size))
        parts.append(dense(matrix))
    state.residual[:] = kept
    mass, damping, stiffness = parts
    free = np.setdiff1d(np.arange(system.size), system.algebraic)
    basis = _allowed(mass[np.ix_(system.algebraic, free)])
    m, c, k = (basis.T @ part[np.ix_(free, free)] @ basis for part in (mass, damping, stiffness))
    n = len(m)
    if n == 0:
        return np.zeros(0, complex)
    unit = float(np.sqrt(np.linalg.norm(k) / np.linalg.norm(m))) or 1.0
    inverse = np.linalg.solve(m, np.hstack([k / unit**2, c / unit]))
    found = eigvals(np.block([[np.zeros((n, n)), np.eye(n)], [-inverse[:, :n], -inverse[:, n:]]]))
    return unit * found[np.isfinite(found)]


def _allowed(constraints: np.ndarray) -> np.ndarray:
    """Basis of the motions that keep the constraints, whose gradients stand in the mass matrix of explicit methods."""
    from scipy.linalg import null_space

    return null_space(constraints) if constraints.size else np.eye(constraints.shape[1])


def _set_by(system: System, state: State, t: float, mode: Mode, row: int) -> str:
    """The kind of force that holds a mode, its share, and the place that moves most."""
    by_damping = mode.damping > 2.0 * np.sqrt(max(mode.stiffness, 0.0))
    part = (0.0, 1.0, 0.0) if by_damping else (0.0, 0.0, 1.0)
    shares = []
    kept = state.residual.copy()
    for group in without_friction(system.groups) if by_damping else system.groups:
        matrix = new_matrix(system.size, system.bandwidth, system.border)
        groups, none = link((group,), *SUMS), np.zeros(system.size)
        evaluate_groups(groups, system, state, t, 0.0, False, *part, matrix, none)
        shares.append((float(mode.shape @ (sparse(matrix) @ mode.shape)), type(group).__name__))
    state.residual[:] = kept
    whole = sum(abs(share) for share, _ in shares) or 1.0
    share, name = max(shares, default=(0.0, "nothing"))
    what = "damping" if by_damping else "stiffness"
    return f"{what} of {_plain(name)} ({100.0 * share / whole:.0f} %), most at {system.names[row]}"


def _plain(name: str) -> str:
    """``WallContact`` -> ``wall contact``."""
    return "".join(f" {c.lower()}" if c.isupper() else c for c in name).strip()


def critical_steps(subject: Subject, progress: Callable[[str], None] = lambda text: None) -> Critical:
    """Find the critical step of a scene's explicit form three ways.

    Raises
    ------
    SceneError
        For a scene that cannot be.
    """
    bars = subject.application.vary(subject.scene, "bars") or []
    shortest = max(bars, key=lambda bar: bar.fastest, default=None)
    length = None if shortest is None else method_of(subject.explicit).reach_of_vibration / shortest.fastest
    progress("eigenvalues along the run")
    why: list[str] = []
    look = _search_run(subject, why)
    found = look is not None and np.isfinite(look.least)
    bracket = None
    if look is not None and np.isfinite(look.start):
        progress("bisection")
        bracket = bisect(subject, look.start, why)
    elif look is not None:
        why.append("nothing vibrates at the start: there is no limit to look for")
    return Critical(
        length, "" if shortest is None else shortest.name, look.least if look and found else None,
        look.at if look else 0.0, look.mode.omega if look and found and look.mode else None,
        look.set_by if look else "",
        bracket, look.start if look is not None and np.isfinite(look.start) else None,
        look.points if look else np.zeros(0, complex), "; ".join(why), subject.explicit,
    )  # fmt: skip


def _search_run(subject: Subject, why: list[str]) -> CriticalStepSearch | None:
    """Look at a run with the forces of an explicit method: by that itself, or where that is long by the scene's own.

    Some laws, of friction above all, are not the same for explicit methods.
    """
    setting = Setting()
    try:
        run = Run(subject.model(Setting(subject.explicit)))
        run.start()
        step, _ = CriticalStep(run.model.system, method_of(subject.explicit)).search(run.state, 0.0)
        if MOST_STEPS * SHORT * step > run.model.solver.end:
            setting = Setting(subject.explicit, min(SHORT * step, run.model.solver.interval))
    except (SceneError, StoppedEarly) as error:
        cause = error.problems[0].cause if isinstance(error, SceneError) else error.sentence
        why.append(f"{subject.explicit} cannot take this scene: {cause}")
    model = subject.model(setting)
    look = CriticalStepSearch(model.system, method_of(subject.explicit))
    trial = run_model(model, setting, announce=subject.announce, look=look)
    if not trial.done:
        why.append(f"the run that was looked at stopped: {trial.status}")
    return look


def bisect(subject: Subject, guess: float, why: list[str]) -> tuple[float, float] | None:
    """Longest stable and shortest unstable step, s, in runs of some thousand steps from the scene's start.

    A run is unstable where it stops, and where the mode that is the fastest at the start moves far more than it does
    with a short step: contacts that open bound its growth, and its energy may then seem to balance.
    """
    low, high = SHORT * guess, 1.4 * guess
    natural, quiet = explicit_run(subject, RESOLVED * guess, FRAMES), None
    for _ in range(WIDENED):
        quiet = explicit_run(subject, low)
        if quiet is not None:
            break
        low, high = 0.5 * low, low
    if quiet is not None and natural is not None:
        # Where damping is strong a mode is gone before a longer step is looked at for the first time.
        quiet = max(quiet[0], natural[0]), max(quiet[1], natural[1])
    if quiet is None:
        why.append(f"no step down to {low:.2g} s is stable in runs of {STEPS} steps")
        return None
    if quiet[0] == 0.0:
        why.append("nothing moves: no run can show a limit")
        return None
    for _ in range(WIDENED):
        if not _stable(subject, high, quiet):
            break
        low, high = high, 2.0 * high
    else:
        why.append(f"every step up to {high:.2g} s is stable in runs of {STEPS} steps")
        return None
    while high / low - 1.0 > APART:
        middle = float(np.sqrt(low * high))
        low, high = (middle, high) if _stable(subject, middle, quiet) else (low, middle)
    return low, high


def _stable(subject: Subject, step: float, quiet: tuple[float, float]) -> bool:
    """Whether a run from the start keeps its energy, and its fastest mode as quiet, as well as a short step does."""
    moved = explicit_run(subject, step)
    return (
        moved is not None
        and moved[0] <= GROWTH_LIMIT * quiet[0]
        and moved[1] <= max(UNBALANCED, GROWTH_LIMIT * quiet[1])
    )


def explicit_run(subject: Subject, step: float, steps: int | None = None) -> tuple[float, float] | None:
    """Run explicitly from the start, for some thousand steps or as many as are named; nobody looks after the step.

    Returns
    -------
    tuple of float, or None
        Largest momentum of the mode that is the fastest at the start, with what rounding makes of it, and energy that
        was created numerically, relative; None where the run stopped.
    """
    # Whole steps to a frame, or the step that is taken would be shorter than the one that is named.
    wanted = _end(subject, step) if steps is None else steps * step
    end = FRAMES * step * max(1, round(wanted / (FRAMES * step)))
    short = replace(subject, end=end, interval=end / FRAMES)
    try:
        model = short.model(Setting(subject.explicit, step))
    except SceneError:
        return None
    model.solver = replace(model.solver, guarded=False)
    monitor = ModeMonitor(model.system, method_of(subject.explicit))
    trial = run_model(model, Setting(subject.explicit, step), look=monitor)
    if trial.result is None or trial.status not in ("done", Status.IMBALANCE.name):
        return None
    return monitor.largest, _gained_late(trial.result)


def _gained_late(result: Result) -> float:
    """Energy created numerically in the second half of a run, over what goes through it then.

    In the first the ledger itself is off, by what a motion loses that is damped within a few steps.
    """
    kinetic, strain, potential, work, lost = (result[name] for name in ENERGIES)
    missing = kinetic + strain + potential - work + lost
    half = missing.size // 2
    through = np.abs(np.diff(work[half:])).sum() + lost[-1] - lost[half] + kinetic[half:].max() + np.ptp(strain[half:])
    whole = kinetic.max() + np.ptp(strain) + np.abs(np.diff(work)).sum()
    gained = float(missing[half:].max() - missing[half])
    return gained / float(through + ROUNDING_SHARE * whole) if through + whole > 0.0 else 0.0


def _end(subject: Subject, step: float) -> float:
    """Time of a run of the bisection, s: within what was looked at, if that is long enough."""
    whole = subject.end if subject.end is not None else subject.model(Setting()).solver.end
    return max(min(STEPS * step, whole), FEWEST * step)


class ModeMonitor:
    """Follows the mode of a run that is the fastest at its start."""

    def __init__(self, system: System, method: Method) -> None:
        self.search, self.momentum = CriticalStep(system, method), np.zeros(0)
        self.largest = 0.0

    def __call__(self, state: State, t: float, method: Any = None) -> None:
        """Take note of a state."""
        if not self.momentum.size:
            self.search.search(state, t)
            self.momentum = self.search.momentum()
        moved = abs(float(self.momentum @ state.v))
        total = float(np.abs(self.momentum) @ np.abs(state.v))
        self.largest = max(self.largest, moved, ROUNDING_SHARE * total)
