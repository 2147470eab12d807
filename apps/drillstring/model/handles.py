"""What can be driven, read and changed of a drill string while it runs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from drillstring.drilling.end_groups import TORQUE_INPUT, is_driven, requests
from drillstring.results.places import reaches_of_links
from drillstring.scene.scene import DrillstringScene
from drillstring.string.factors import factors_of
from drillstring.string.lumps import Lumps
from drillstring.string.strength import shares_at_ends, tension_at_ends
from tautline.scene.errors import SceneError
from tautline.system.handles import Handles, Output, Parameter, inputs_of, outputs_of, part_of, prepared_of, same_as

AT_BIT = {
    "position": "position", "velocity": "velocity", "rotation_rate": "rotary_speed", "rotation": "rotation",
    "tension": "tension", "torque": "string_torque",
}  # fmt: skip
"""Variables along the string, and what their last is of the bit."""
NAMES = {
    "bit_speed": "bit.speed", "bit_depth": "bit.depth", "weight_on_bit": "bit.weight", "torque_on_bit": "bit.torque",
    "rate_of_penetration": "bit.rate_of_penetration", "hook_load": "top.hook_load", "block_position": "top.block",
    "surface_torque": "top.string_torque", "drive_torque": "top.torque", "drive_speed": "top.rotary_speed",
}  # fmt: skip
"""Variables that belong to an end, and their names there."""
LARGEST, LEAST = "largest_tension", "least_tension"
"""Outputs of what each element has at most and at least, ends and middle."""


def driven(scene: DrillstringScene, names: tuple[str, ...]) -> DrillstringScene:
    """The scene with what is named free to be driven; `top.torque` takes the place of the drive's controller.

    Raises
    ------
    SceneError
        For a torque where the scene has no drive with an inertia.
    """
    if TORQUE_INPUT in names and not is_driven(scene):
        cause = "prescribes the rotary speed: a drive that turns by a torque needs an inertia"
        cure = "write controller: {kind: pi, speed: ..., inertia: ...} here, or drive top.rotary_speed"
        raise SceneError([scene.problem("top.rotation", cause, cure)])
    return scene.driven_by(names) if names else scene


def handles(scene: DrillstringScene, lumps: Lumps, model: Any) -> Handles:
    """All handles of a drill string."""
    asked = requests(scene)
    inputs = inputs_of(asked)
    if TORQUE_INPUT in scene.driven:
        inputs = {name: one for name, one in inputs.items() if not name.startswith("top.rotary")}
    parameters = {one.name: one for one in _friction(scene, model.system.groups)}
    return Handles(inputs, _outputs(model) | _at_ends(scene, lumps, model), parameters, prepared_of(asked))


def _outputs(model: Any) -> dict[str, Output]:
    made = outputs_of(model.variables, model.coordinates)
    known = {variable.name: variable for variable in model.variables}
    for name, what in AT_BIT.items():
        whole = made[name]
        made[f"bit.{what}"] = part_of(
            known[name], f"bit.{what}", -1, whole.shape[1:], f"{known[name].long_name}, at the bit"
        )
    for name, other in NAMES.items():
        if name in made:
            made[other] = same_as(made[name], other)
    if "top.rotary_speed" not in made:
        made["top.rotary_speed"] = part_of(known["rotation_rate"], "top.rotary_speed", 0)
    return made


def _at_ends(scene: DrillstringScene, lumps: Lumps, model: Any) -> dict[str, Output]:
    """Largest and least tension of each element, by which bounds on `tension` are judged, and `tension` that says so.

    The variable is the tension in the middle of an element, and long elements have much more at their upper ends.
    """
    middle = outputs_of([one for one in model.variables if one.name == "tension"], model.coordinates)["tension"]
    share, labels = shares_at_ends(scene, lumps), tuple(reaches_of_links(lumps))

    def series(least: bool) -> Callable[[Mapping[str, np.ndarray]], np.ndarray]:
        return lambda frames: tension_at_ends(share, frames["hook_load"], frames["tension"], least)

    made = {"tension": replace(middle, judged_by=(LARGEST, LEAST))}
    for name, word in ((LARGEST, "largest"), (LEAST, "least")):
        of_frames = series(name == LEAST)
        made[name] = replace(
            middle, name=name, text=f"{word} effective tension anywhere in the element", labels=labels,
            value=_first(of_frames), series=of_frames,
        )  # fmt: skip
    return made


def _first(series: Callable[[Mapping[str, np.ndarray]], np.ndarray]) -> Callable[[Mapping[str, np.ndarray]], Any]:
    return lambda frame: series(frame)[0]


def _friction(scene: DrillstringScene, groups: tuple[Any, ...]) -> Iterator[Parameter]:
    """Friction factors of the open and of the cased hole, static and kinetic."""
    law = next((group.law for group in groups if hasattr(group, "law")), None)
    wall = scene.well.wall
    if law is None or wall is None:
        return
    rows = getattr(law, "rows", law)
    arrays = {kind: np.asarray(getattr(rows, kind)) for kind in ("static", "kinetic")}
    share = _cased(scene, arrays)
    found: dict[str, list[Parameter]] = {"wall": [], "casing": []}
    for kind, array in arrays.items():
        now = factors_of(wall, kind)
        factors = _Factors(array, share, now.open, now.cased)
        found["wall"].append(
            factors.parameter(f"wall.friction.{kind}", f"{kind} friction factor of the open hole", cased=False)
        )
        if now.several and share.any():
            found["casing"].append(
                factors.parameter(f"casing.friction.{kind}", f"{kind} friction factor of the cased hole", cased=True)
            )
    for where, hole in (("wall", "open"), ("casing", "cased")):
        for one, kind in zip(found[where], arrays, strict=False):
            # As in a scene: friction of slip is at most that of rest.
            yield replace(one, not_below=f"{where}.friction.kinetic") if kind == "static" else one
        if len(found[where]) == len(arrays):
            yield _together(f"{where}.friction", f"friction factor of the {hole} hole", *found[where])


def _cased(scene: DrillstringScene, arrays: dict[str, np.ndarray]) -> np.ndarray:
    """How much of each contact's reach is cased (n,); all counts as open where that cannot be told from its factors."""
    for kind, array in arrays.items():
        now = factors_of(scene.well.wall, kind)
        if now.several and now.cased != now.open:
            return (array - now.open) / (now.cased - now.open)
    return np.zeros(arrays["static"].shape)


def _together(name: str, text: str, static: Parameter, kinetic: Parameter) -> Parameter:
    """Both friction factors in one: the kinetic one, and the static one in the ratio that the scene has."""
    ratio = static.get() / kinetic.get() if kinetic.get() > 0.0 else 1.0

    def change(value: float) -> None:
        kinetic.set(value)
        static.set(ratio * value)

    return Parameter(name, "", f"{text}; the static one follows in its ratio", kinetic.get, change, 0.0)


class _Factors:
    """Friction factors of contacts (n,), of which ``share`` (n,) is cased; they stand in the array alone."""

    def __init__(self, array: np.ndarray, share: np.ndarray, below: float, cased: float) -> None:
        self.array, self.share, self.drawn = array, share, (below, cased)

    def both(self) -> list[float]:
        """Of the open and of the cased hole."""
        found = []
        for drawn, end in zip(self.drawn, (0.0, 1.0), strict=True):
            wholly = np.abs(self.share - end) < 1e-12
            found.append(float(self.array[wholly][0]) if wholly.any() else drawn)
        return found

    def parameter(self, name: str, text: str, cased: bool) -> Parameter:
        def change(value: float) -> None:
            both = self.both()
            both[cased] = value
            self.array[...] = both[0] + (both[1] - both[0]) * self.share

        return Parameter(name, "", text, lambda: self.both()[cased], change, 0.0)
