"""What bodies and rope pull at each other with, as far as that is known before a run."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crane.geometry.reeving import Path
from crane.groups.immersion import share_of
from crane.scene.bodies import Body
from crane.scene.scene import CraneScene, End, Sheave
from tautline.kernels.time_function import value_at
from tautline.system.time_functions import FunctionRequest, compile_functions


def load_of(scene: CraneScene, body: Body) -> float:
    """Weight of a body less its buoyancy, with the force on it at t = 0, along gravity, N; below 0 it goes up."""
    g = np.array(scene.gravity, float)
    size = float(np.linalg.norm(g))
    if size == 0.0:
        return 0.0
    weight = (body.mass - buoyancy_of(scene, body)) * size
    if not body.force:
        return weight
    functions = compile_functions([FunctionRequest(force) for force in body.force])
    force = np.array([value_at(functions, i, 0.0)[0] for i in range(len(body.force))])
    return weight + float(force @ g) / size


def rises(scene: CraneScene, body: Body) -> bool:
    """Whether buoyancy and force lift a body more than it weighs."""
    return load_of(scene, body) < 0.0


class Floating(NamedTuple):
    """A body that goes up, by its number: what lifts it more than it weighs, N; and of that what its rope does.

    ``by_rope`` is None where the body goes up by itself; ``tall`` says whether it does so where it is drawn only.
    """

    body: int
    lift: float
    by_rope: float | None
    tall: bool = False

    def cause(self, name: str) -> str:
        """What lifts the body of a name."""
        if self.by_rope is None:
            return f"buoyancy and force lift it with {self.lift:.4g} N more than it weighs"
        return (
            f"its rope is lighter than water. Between {name} and the surface the water lifts it with "
            f"{self.by_rope:.4g} N more than it weighs, and that is {self.lift:.4g} N more than {name} pulls down with"
        )

    @property
    def cure(self) -> str:
        """What to change."""
        if self.by_rope is None:
            return f"give it less volume or more mass{', or draw it higher' if self.tall else ''}"
        return "give it more mass, or see whether rope.diameter and mass_per_length are those of the rope"


def floating(scene: CraneScene, path: Path) -> list[Floating]:
    """Bodies that hang on a rope from above and go up, by themselves or with a rope that floats."""
    up, pulls, found = -np.array(scene.gravity, float), pull(scene, path), []
    for k, body in enumerate(scene.bodies):
        sprung = body.spring is not None and any(body.spring.stiffness)
        free = any(up[c] != 0.0 and axis not in body.guide for c, axis in enumerate("xyz"))
        if body.name in pulls and free and not sprung and pulls[body.name] @ up > 0.0:
            load, rope = load_of(scene, body), rope_lift(scene, path, body)
            if load < 0.0:
                found.append(Floating(k, -load, None, body.height is not None))
            elif rope > load:
                found.append(Floating(k, rope - load, rope))
    return found


def rope_lift(scene: CraneScene, path: Path, body: Body) -> float:
    """What the rope that leads up from a body takes off its pull, up to where that is least, N: 0 of rope that sinks.

    That is at the surface. Above it the rope weighs; what it weighs there only the item above it bears.
    """
    water, rope = scene.water, scene.rope
    if water is None or rope.diameter is None:
        return 0.0
    floats = 0.25 * math.pi * rope.diameter**2 * water.density - rope.mass_per_length
    size = float(np.linalg.norm(scene.gravity))
    at = [i for i, item in enumerate(scene.path) if isinstance(item, (End, Sheave)) and item.body == body.name]
    tops = [(path.tangents[i][0, 2], path.tangents[i][1, 2]) for i in at if i < len(path.spans)]
    tops += [(path.tangents[i - 1][1, 2], path.tangents[i - 1][0, 2]) for i in at if i > 0]
    rise = max((min(top, water.surface) - low for low, top in tops), default=0.0)
    falls = float(pull(scene, path)[body.name][2])
    return max(0.0, floats * size * falls * rise)


def buoyancy_of(scene: CraneScene, body: Body) -> float:
    """Mass of the water that a body takes the place of where it is drawn, kg; one without a height does so anywhere."""
    return wet_share(scene, body) * displacement_of(scene, body)


def raised(scene: CraneScene, rise: float) -> CraneScene:
    """The scene in which water lifts bodies with a height as it does a rise, m, above where they are drawn."""
    return scene.model_copy(update={"bodies": tuple(_raised(scene, body, rise) for body in scene.bodies)})


def _raised(scene: CraneScene, body: Body, rise: float) -> Body:
    """A body that water lifts anywhere as it does where the body is drawn, a rise, m, higher."""
    if body.height is None:
        return body
    share = wet_share(scene, body, body.position[2] + rise)
    return body.model_copy(update={"height": None, "volume": share * body.volume})


def displacement_of(scene: CraneScene, body: Body) -> float:
    """Mass of the water that all of a body takes the place of, kg."""
    return scene.water.density * body.volume if scene.water is not None else 0.0


def added_mass_of(scene: CraneScene, body: Body) -> tuple[float, ...]:
    """Added mass of a body where it is drawn, along x, y and z, kg."""
    return tuple(wet_share(scene, body) * added for added in body.added_mass)


def wet_share(scene: CraneScene, body: Body, height: float | None = None) -> float:
    """Share of what water does to all of a body that it does with its position at a height, m; None for as drawn."""
    if scene.water is None or body.height is None:
        return 1.0
    lowest = (body.position[2] if height is None else height) - body.bottom
    return float(share_of.py_func((scene.water.surface - lowest) / body.height)[2])


def pull(scene: CraneScene, path: Path) -> dict[str, np.ndarray]:
    """By body that the rope touches: the force on it of a tension of 1 N all along the rope, (3,); found once."""
    return scene.once("pull", (scene.path, path), lambda: _pull(scene, path))


def _pull(scene: CraneScene, path: Path) -> dict[str, np.ndarray]:
    found: dict[str, np.ndarray] = {}
    for i, item in enumerate(scene.path):
        if isinstance(item, (End, Sheave)) and item.body is not None:
            found[item.body] = found.get(item.body, np.zeros(3)) + pull_on(path, i)
    return found


def pull_on(path: Path, i: int) -> np.ndarray:
    """Force on item i of the path of a tension of 1 N all along the rope, (3,): the rope shortens that way."""
    leaves = path.spans[i].e if i < len(path.spans) else np.zeros(3)
    comes = path.spans[i - 1].e if i > 0 else np.zeros(3)
    return np.asarray(leaves) - np.asarray(comes)
