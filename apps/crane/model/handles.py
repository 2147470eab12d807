"""What can be driven, read and changed of a crane while it runs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from crane.assembly.friction import most_bearing_friction, most_groove_friction, stands_still
from crane.assembly.layout import AXES, Layout
from crane.groups.capstan_friction import BEARING, CAPSTAN, EFFICIENCY, Slips
from crane.groups.immersion import Immersed
from crane.groups.masses import Bodies
from crane.groups.span import Spans
from crane.groups.winch import Drums
from crane.scene.carried import brings_sea
from crane.scene.scene import CraneScene, Drum, End, Sheave
from crane.scene.surroundings import Motion, Vessel
from crane.sea.frames import SPEED
from tautline.results.variable import Variable
from tautline.scene.errors import SceneError
from tautline.scene.values.printed import rounded
from tautline.system.handles import (
    Handles,
    Output,
    Parameter,
    extreme_of,
    inputs_of,
    number,
    outputs_of,
    part_of,
    prepared_of,
)

THINGS = {
    "body_position": "position", "body_velocity": "velocity", "body_turn": "turn", "sheave_load": "force",
    "wrap_angle": "wrap_angle", "fleet_angle": "fleet_angle", "sheave_rotation": "rotation", "slipping": "slipping",
    "drum_tension": "tension", "paid_out": "pay_out", "pay_out_speed": "pay_out_speed", "drum_rotation": "rotation",
    "winch_torque": "torque", "winch_power": "power",
}  # fmt: skip
"""Variables of bodies, sheaves and drums, and what each is of one of them."""
OF_FORCES = "max_sheave_load"
"""Figure that is the largest size of the forces on sheaves."""
MOST_FALLS = 4
"""Spans that are told one by one."""
VESSEL, VESSEL_NAME = "vessel.", "vessel"
PLACES = {"position": "q", "velocity": "v"}


def driven(scene: CraneScene, names: tuple[str, ...]) -> CraneScene:
    """The scene with what is named free to be driven: a vessel comes under it where its motion is named.

    Raises
    ------
    SceneError
        Where heave compensation, or the waves on the loads, belong to a motion that is driven.
    """
    moved = [
        name
        for name in names
        if name.startswith(VESSEL) or name.rpartition(".")[2].removesuffix(SPEED) in ("slew", "luff")
    ]
    if moved and scene.heave_compensation is not None:
        cause = f"answers the motion that the scene prescribes, and {moved[0]} is driven from outside"
        cure = "remove it, and drive the winch by what is measured"
        raise SceneError([scene.problem("heave_compensation", cause, cure)])
    of_vessel = [name for name in names if name.startswith(VESSEL)]
    if of_vessel and brings_sea(scene):
        cause = f"is the sea that the vessel's motion answers, and {of_vessel[0]} is driven from outside"
        cure = "write the waves, such as {spectrum: {significant_height: 1.5, peak_period: 8}}"
        raise SceneError([scene.problem(("water", "waves", "elevation"), cause, cure)])
    if scene.vessel is None and of_vessel:
        scene = scene.model_copy(update={"vessel": Vessel(reference=(0.0, 0.0, 0.0), motion=Motion())})
    forces = [f"{name}[{c}]" for name in names if name.endswith(".force") for c in range(AXES)]
    return scene.driven_by((*names, *forces)) if names else scene


def handles(made: Any, variables: Sequence[Variable], coordinates: Mapping[str, Any]) -> Handles:
    """All handles of a crane; ``made`` is its assembly.

    The model itself is not asked for: it holds what calls this, and would lie in a circle with it.
    """
    layout: Layout = made.layout
    inputs = inputs_of(layout.requests.of)
    # Compensation, and the waves that a vessel answers, were computed for the motion that the scene prescribes.
    compensated, answers = layout.scene.heave_compensation is not None, brings_sea(layout.scene)
    fixed = [frame for frame in layout.frames if compensated or (answers and frame.name == VESSEL_NAME)]
    moved = {name for frame in fixed for i in range(len(frame.words)) for name in frame.inputs_of(i)}
    inputs = {name: one for name, one in inputs.items() if name not in moved}
    parameters = {one.name: one for one in _parameters(layout, made.system.groups)}
    prepared = prepared_of(layout.requests.of)
    outputs = _outputs(layout, variables, coordinates)
    instead = {"hook_load": hook_load_told(layout.scene)} | bending_told(layout.scene)
    return Handles(inputs, outputs, parameters, prepared, instead, _lacking(layout))


def bending_told(scene: CraneScene) -> dict[str, str]:
    """What to give where a scene lacks what its figures of bending need: cures by the names of the figures."""
    if scene.rope.diameter:
        return {}
    why = {
        "max_bending_cycles": "without it each tremble of the rope at a sheave would be a cycle",
        "smallest_bending_ratio": "it is that of a sheave over that of the rope",
    }
    told = {name: f"give rope.diameter: {reason}" for name, reason in why.items()}
    return told | {"bending": "give rope.diameter, and name max_bending_cycles or smallest_bending_ratio"}


def hook_load_told(scene: CraneScene) -> str:
    """What to name for the load on the hook, of which a crane has no output of its own: a cure."""
    hung = [i for i, item in enumerate(scene.path) if isinstance(item, (End, Sheave)) and getattr(item, "body", None)]
    spans = sorted({k for i in hung for k in (i - 1, i) if 0 <= k < len(scene.path) - 1})
    if not spans:
        return "no body hangs on the rope: name tension, of all spans, or one such as tension[0,0]"
    last = spans[-1]
    told = ", ".join(f"tension[{k}]" for k in spans[:MOST_FALLS])
    told += f" to tension[{last}]" if len(spans) > MOST_FALLS else ""
    blocks = [f"{scene.path[i].name}.force[2]" for i in hung if isinstance(scene.path[i], Sheave)]
    word = "the tension in the falls at the hook" if blocks else "the tension of the rope that the hook hangs on"
    cure = f"no output of a crane is called so. For {word} name {told}"
    if blocks:
        few = ", ".join(blocks[:MOST_FALLS]) + (" and so on" if len(blocks) > MOST_FALLS else "")
        cure += f"; for the rope's vertical force on a sheave of the block {few}"
    return cure


def _outputs(layout: Layout, variables: Sequence[Variable], coordinates: Mapping[str, Any]) -> dict[str, Output]:
    made = outputs_of(variables, coordinates, THINGS)
    scene = layout.scene
    tension = next(variable for variable in variables if variable.name == "tension")
    for name, text, choose in (("max_tension", "largest", np.max), ("min_tension", "smallest", np.min)):
        made[name] = extreme_of(tension, name, f"{text} tension at the ends of spans", choose)
    for name in ("sheave_load", *(f"{sheave.name}.{THINGS['sheave_load']}" for sheave in scene.sheaves)):
        if name in made:
            made[name] = replace(made[name], size=OF_FORCES)
    known = {variable.name: variable for variable in variables}
    places = {body.name: (layout.body[body.name], "body_", k) for k, body in enumerate(scene.bodies)}
    places |= {
        item.name: (layout.station[layout.item[i]], "", layout.item[i])
        for i, item in enumerate(scene.path)
        if item.name not in places
    }
    for thing, (place, of, k) in places.items():
        for what, vector in PLACES.items():
            name, at = f"{thing}.{what}", (vector, place + np.arange(AXES))
            whole = part_of(known[of + what], name, k, (AXES,), f"{what} of {thing}")
            made[name] = replace(whole, places=at)
    return made


def _parameters(layout: Layout, groups: tuple[Any, ...]) -> Iterator[Parameter]:
    kinds = {type(group): group for group in groups}
    if Bodies in kinds:
        yield from _of_bodies(layout, kinds[Bodies], kinds.get(Immersed))
    yield from _of_rope(kinds[Spans])
    if Slips in kinds:
        yield from _of_contacts(layout, kinds[Slips])
    if Drums in kinds:
        yield from _of_drums(layout, kinds[Drums])


def _of_bodies(layout: Layout, bodies: Bodies, immersed: Immersed | None) -> Iterator[Parameter]:
    rows = bodies.rows
    in_water = {} if immersed is None else {int(k): i for i, k in enumerate(immersed.rows["body"])}
    for k, body in enumerate(layout.scene.bodies):
        one = slice(k, k + 1)
        places, text, least = [bodies.kept[one], bodies.mass[one], rows["mass"][one]], f"mass of {body.name}", 0.0
        if body.release is None:
            places.append(rows["remaining"][one])
        else:
            text, least = f"{text}, at least what remains after its release", body.release.remaining
        yield number(f"{body.name}.mass", "kg", text, places, least=least, positive=least == 0.0)
        # What water does is with the body, or with the share of it that is under water.
        water, w = (bodies, k) if immersed is None or k not in in_water else (immersed, in_water[k])
        for c, axis in enumerate("xyz"):
            for field, what, unit in (
                ("added", "added_mass", "kg"), ("linear", "linear_drag", "N s/m"),
                ("quadratic", "quadratic_drag", "N s^2/m^2"),
            ):  # fmt: skip
                text = f"{what.replace('_', ' ')} of {body.name} along {axis}"
                # What a release does not change is the same before and after it.
                key = "added_mass" if field == "added" else "drag"
                stays = body.release is not None and getattr(body.release, key) is None
                places = [kept[field][w : w + 1, c] for kept in (water.rows, *([water.left] if stays else []))]
                yield number(f"{body.name}.{what}[{c}]", unit, text, places, positive=False)


def _of_rope(spans: Spans) -> Iterator[Parameter]:
    rows = spans.rows
    # The springs of friction are there to stick, and are no property that the rope is known by.
    text = "EA of the rope in its spans; what holds it on wheels and drums until it slips keeps that of the scene"
    yield number("rope.axial_stiffness", "N", text, [rows["stiffness"]])
    if np.ptp(rows["damping"]) == 0.0:
        yield number("rope.damping", "s", "damping of the rope's stretching", [rows["damping"]], positive=False)


def _of_contacts(layout: Layout, slips: Slips) -> Iterator[Parameter]:
    """Friction on sheaves and in their bearings."""
    after = {layout.item[i]: (i, item) for i, item in enumerate(layout.scene.path) if isinstance(item, Sheave)}
    for k, row in enumerate(slips.rows):
        place = slips.rows["coefficient"][k : k + 1]
        if int(row.after) not in after:
            continue
        i, sheave = after[int(row.after)]
        if row.kind == EFFICIENCY:
            name, text = f"{sheave.name}.efficiency", f"efficiency of {sheave.name}"
            yield Parameter(name, "", text, _efficiency(place), _set_efficiency(place), 0.0, True, 1.0)
        elif row.kind == CAPSTAN:
            most = most_groove_friction(layout, i)
            text = f"friction of the rope in the groove of {sheave.name}{_up_to(most, 'bearing')}"
            yield number(f"{sheave.name}.groove_friction", "", text, [place], positive=False, most=most)
        elif row.kind == BEARING and sheave.bearing is not None:
            most = most_bearing_friction(layout, i)
            text = f"friction in the bearing of {sheave.name}{_up_to(most, 'groove')}"
            factor = [sheave.bearing.radius / sheave.radius]
            yield number(f"{sheave.name}.bearing_friction", "", text, [place], positive=False, factor=factor, most=most)


def _up_to(most: float, other: str) -> str:
    """Why a friction has a bound: of groove and bearing without inertia the weaker as drawn is what a run has."""
    return f", at most {rounded(most, 4):g}: with more the {other} would give way first" if most < np.inf else ""


def _lacking(layout: Layout) -> dict[str, str]:
    """Frictions of sheaves that never act, and are no parameters: why, and what to do, by the names they would have."""
    told = {}
    for i, item in enumerate(layout.scene.path):
        if not isinstance(item, Sheave) or item.law != "capstan" or item.locked or item.bearing is None:
            continue
        if i in layout.rim or item.bearing.friction == 0.0:
            continue
        still = stands_still(layout, i)
        never, weaker, what = ("bearing", "groove", "stands still") if still else ("groove", "bearing", "turns")
        why = f"{item.name} {what}: its {weaker} gives way before its {never}"
        cure = "give the sheave an inertia, and both act"
        told[f"{item.name}.{never}_friction"] = f"{why}; {cure}"
    return told


def _efficiency(place: np.ndarray) -> Callable[[], float]:
    return lambda: 1.0 / (1.0 + float(place[0]))


def _set_efficiency(place: np.ndarray) -> Callable[[float], None]:
    def change(value: float) -> None:
        place[0] = 1.0 / value - 1.0

    return change


def _of_drums(layout: Layout, drums: Drums) -> Iterator[Parameter]:
    motors = [item for item in layout.scene.path if isinstance(item, Drum) and not item.prescribed]
    for k, drum in enumerate(motors):
        one = slice(k, k + 1)
        yield number(f"{drum.name}.inertia", "kg m^2", f"inertia of {drum.name}", [drums.rows["inertia"][one]])
        if drum.drive == "tension":
            for gain, unit in (("proportional", ""), ("integral", "1/s")):
                text = f"{gain} gain of {drum.name}"
                yield number(f"{drum.name}.{gain}", unit, text, [drums.rows[gain][one]], positive=False)
