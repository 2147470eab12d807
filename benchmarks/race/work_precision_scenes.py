"""The eight scenes of `work_precision.py`: what is run, what is watched, and with which steps and tolerances."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

import tautline
from benchmarks import ROOT
from benchmarks.accuracy.cases import DRIVE, KINETIC, STATIC, losing
from benchmarks.race import scenes as race_scenes
from benchmarks.race.scenes import Case

DATA = ROOT / "data"
HALF = tuple(2.0**-k for k in range(12))
LOOSE = tuple(10.0**-k for k in range(2, 11))
ELEMENTS = 20
"""Of the catenary."""
BY_ERROR = "step by error"
"""Generalized-alpha with the step that keeps the error of each."""
ERRORS = tuple(10.0**-k for k in range(3, 9))
"""Of a step, m."""
SMOOTH = {"solver.control": "fixed", "path[1].sheave.bearing.friction": 0.0}
"""A hoist whose bearing does not stick, so that SciPy's methods can run it."""
STUCK = (
    "friction that sticks has a memory, which equations of motion do not hold: no method of SciPy can run it. The "
    "reference is our run by generalized-alpha with steps of {step:g} ms"
)


@dataclass(frozen=True)
class Scene:
    """A scene and how it is judged.

    Attributes
    ----------
    scene : scene
        What `tautline.Simulation` takes.
    end : float
        s.
    count : int
        Times, evenly apart, at which positions are compared.
    watched : callable
        Whether an unknown of a name is.
    less : str
        The unknown that what is watched counts from; empty for none.
    size : float
        Length or angle, m or rad, below which SciPy's absolute tolerance is a thousandth of its relative one.
    steps, theirs : dict
        Steps, s, of our methods; tolerances of SciPy's.
    exact : (str, str, float)
        Whose method the reference is, which, and its step or tolerance.
    race, race_steps : Case and tuple of float
        How Exudyn runs it, if it has it, and its steps, s.
    told : str
        What is watched, and what is left out and why.
    """

    title: str
    scene: Any
    end: float
    count: int
    watched: Callable[[str], bool]
    steps: dict[str, tuple[float, ...]]
    theirs: dict[str, tuple[float, ...]]
    exact: tuple[str, str, float]
    told: str
    less: str = ""
    size: float = 1.0
    race: Case | None = None
    race_steps: tuple[float, ...] = field(default=())

    @property
    def times(self) -> np.ndarray:
        """Times at which positions are compared, s."""
        return self.end * np.arange(1, self.count + 1) / self.count


def _steps(longest: float, count: int) -> tuple[float, ...]:
    return tuple(longest * x for x in HALF[:count])


def _is_place(name: str) -> bool:
    """Whether an unknown is a place in space."""
    return name.endswith((" x", " y", " z", " rx", " ry", " rz"))


def _is_bit(name: str) -> bool:
    return name.startswith("BHA at 3770.8 m") and name.endswith("along the hole")


def _changed(name: str, keys: dict[str, Any], **more: Any) -> Any:
    return tautline.read(DATA / f"{name}.yaml").replace({**keys, **more}, origin="work_precision.py")


def _jwell(static: float, kinetic: float) -> Scene:
    """The J-well under heave over 40 s, judged by the bit."""
    step = 2e-5
    return Scene(
        f"J-well {static:g}/{kinetic:g}", _changed("jwell", {STATIC: static, KINETIC: kinetic}), 40.0, 80, _is_bit,
        {"rk4": _steps(4e-3, 6), "generalized-alpha": _steps(32e-3, 10)}, {}, ("ours", "generalized-alpha", step),
        f"the bit along the hole, every 0.5 s; {STUCK.format(step=1e3 * step)}.",
    )  # fmt: skip


def _catenary() -> Scene:
    case = Case("catenary", ELEMENTS, 1e-2, 1.0, 1.0, 0.1, 1e-6, 1e-6, 1e-6)
    return Scene(
        "Catenary", tautline.read(race_scenes.text(case, 1.0, 0.1)), 1.0, 10, _is_place,
        {"rk4": _steps(1e-3, 4), "generalized-alpha": _steps(20e-3, 11)},
        {"DOP853": LOOSE[:6], "Radau": LOOSE[:7], "BDF": LOOSE[:6]}, ("SciPy", "Radau", 1e-10),
        f"the rope of the race with {ELEMENTS} elements, which is swung at one end; the places of all nodes, every "
        "0.1 s. Exudyn's element in the plane.", race=case, race_steps=_steps(20e-3, 9),
    )  # fmt: skip


def _hose() -> Scene:
    case = Case("hose", 10, 1e-3, 0.5, 0.5, 0.05, 1e-5, 1e-4, 1e-7, 0.9, 35.0)
    return Scene(
        "Hose, 35 m/s", _changed("hose", {"water.speed": 35.0}), 0.5, 10, _is_place,
        {"rk4": _steps(5e-6, 2), "generalized-alpha": _steps(8e-3, 11)},
        {"Radau": LOOSE[:7], "BDF": LOOSE[:6]}, ("SciPy", "Radau", 1e-10),
        "the shipped hose with a constant speed; the places of all nodes, every 50 ms, over half a second. The waves "
        "along it are too fast for explicit methods: DOP853 was left out. Exudyn's element in the plane.",
        race=case, race_steps=_steps(4e-3, 8),
    )  # fmt: skip


SCENES = (
    Scene(
        "Hammer bar", _changed("cantilever_bar", {}), 0.9, 9, lambda name: True,
        {"rk4": _steps(0.04, 7), "generalized-alpha": _steps(0.02, 12)},
        {"DOP853": LOOSE[:7], "Radau": LOOSE[:6], "BDF": LOOSE[:6]}, ("SciPy", "DOP853", 1e-12),
        "all unknowns, every 0.1 s, until the hammer touches.",
    ),
    _hose(),
    _catenary(),
    _jwell(0.2, 0.2),
    _jwell(0.3, 0.2),
    Scene(
        "Hoist", _changed("hoist", SMOOTH), 12.0, 24, _is_place,
        {"rk4": _steps(2e-4, 4), "generalized-alpha": _steps(40e-3, 11), BY_ERROR: ERRORS},
        {"DOP853": LOOSE[:6], "Radau": LOOSE[:6], "BDF": LOOSE[:5]}, ("SciPy", "DOP853", 1e-11),
        "the shipped lift from a moving vessel, without friction in the bearing; all places, every half second.",
    ),
    Scene(
        "Load lost", _changed("hoist", losing(1000.0, 8).keys | SMOOTH), 0.4, 20, _is_place,
        {"rk4": _steps(4e-4, 6), "generalized-alpha": _steps(8e-3, 11), BY_ERROR: ERRORS},
        {"DOP853": LOOSE[:6], "Radau": LOOSE[:6], "BDF": LOOSE[:5]}, ("SciPy", "DOP853", 1e-11),
        "four of five tonnes fall off at 50 ms, and the rope goes slack; without friction in the bearing; all places, "
        "every 20 ms. What a slack rope does next depends so much on what was before that runs of different methods "
        "differ by some 1e-3: the reference is no better than that.",
    ),
    Scene(
        "Stick-slip", _changed("drilling", {DRIVE: "60 rpm", "bit.torque.static": "12 kN m", "solver.end": "20 s"}),
        20.0, 80, lambda name: name.endswith("at 3000.0 m: rotation"),
        {"rk4": _steps(4e-3, 6), "generalized-alpha": _steps(32e-3, 9)}, {}, ("ours", "generalized-alpha", 2e-5),
        f"how far the bit is behind the top drive, every quarter of a second; {STUCK.format(step=2e-2)}.",
        less="drill pipe 5 in 19.50 lb/ft S135 at 0.0 m: rotation",
    ),
)  # fmt: skip
QUICK = (SCENES[0], replace(SCENES[3], end=4.0, count=8, exact=("ours", "generalized-alpha", 1e-3)))
"""Scenes of a reduced run, which only shows that it runs."""
