"""What the parts of a scene say of each other: contradictions that can be seen without any geometry."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from typing import Any
from weakref import WeakValueDictionary

from crane.scene.bodies import XYZ, Drag
from crane.scene.path import Anchor, Drum, End, PathItem, Sheave
from tautline.scene.functions import FunctionOfTime
from tautline.scene.model import Model, Scene
from tautline.scene.refusal import nearest, raise_all
from tautline.scene.values.magnitude import LARGEST, OUTSIDE, SMALLEST

Key = tuple[str | int, ...]
Fault = tuple[Key, str, str]
"""Key path, cause, cure."""

GROUND, VESSEL = "ground", "vessel"
MOST_ELEMENTS = 2000
"""Of the whole rope."""
PLACES = ("position", "center", "offset", "pivot", "reference", "rest")
FAR_AWAY = 1.0e8
"""Coordinate, m, beyond which the rounding of positions would show in the forces of a rope."""
WATERS = "volume", "added_mass", "drag"
"""What says of a body that water acts on it."""
SEA_KEYS = "significant_height", "peak_period", "gamma", "seed", "components", "ramp"
DIVISORS = ("mass_per_length", "axial_stiffness", "diameter", "radius", "core_radius", "mass", "inertia", "stiffness")


def check_consistency(scene: Scene) -> None:
    """Refuse a scene whose parts contradict each other; of several faults, all of the first kind are told.

    Raises
    ------
    ValidationError
        At the keys at fault.
    """
    checks: tuple[Callable[[Scene], Iterable[Fault]], ...] = (
        _names, _ends, _references, _cycles, _bodies, _neighbours, _mesh, _drums, _water, _ground, _start,
        _level, _compensation, _computable,
    )  # fmt: skip
    for check in checks:
        raise_all(check(scene))


def _names(scene: Scene) -> Iterator[Fault]:
    """Each name is given once among bodies, among items of the path and among frames."""
    bodies: list[tuple[Key, str]] = [(("bodies", i), body.name) for i, body in enumerate(scene.bodies)]
    items: list[tuple[Key, str]] = [(scene.key_of(item), item.name) for item in scene.path]
    frames: list[tuple[Key, str]] = [(("frames", i), frame.name) for i, frame in enumerate(scene.frames)]
    for kind, named in (("body", bodies), ("item of the path", items), ("frame", frames)):
        seen: Counter[str] = Counter()
        for at, name in named:
            seen[name] += 1
            if seen[name] > 1:
                yield (*at, "name"), f"is the name of another {kind}", "give each a name of its own"
    for at, name in frames:
        if name in (GROUND, VESSEL):
            yield (*at, "name"), f"the {name} has this name", "give the frame another, such as boom"


def _ends(scene: Scene) -> Iterator[Fault]:
    """A rope runs from a drum, an end or an anchor over sheaves to a drum, an end or an anchor."""
    if len(scene.path) < 2:
        yield ("path",), "is one item: a rope has two ends", "add an end or an anchor after it"
    for i, item in enumerate(scene.path):
        at = scene.key_of(item)
        last = i == len(scene.path) - 1
        if isinstance(item, Sheave) and (i == 0 or last):
            where, verb = ("after", "ends") if last else ("before", "begins")
            yield at, f"the rope {verb} on a sheave", f"put a drum, an end or an anchor {where} it"
        if not isinstance(item, Sheave) and 0 < i and not last:
            yield at, f"the rope goes on after this {item.key}", f"put {item.name} first or last in the path"


def _references(scene: Scene) -> Iterator[Fault]:
    """Bodies and frames that are named exist."""
    bodies = [body.name for body in scene.bodies]
    frames = [frame.name for frame in scene.frames] + ([VESSEL] if scene.vessel else []) + [GROUND]
    for item in scene.path:
        name = None if isinstance(item, (Drum, Anchor)) else item.body
        if name is not None and name not in bodies:
            cure = nearest(name, bodies) if bodies else "add `bodies:` with one of this name"
            yield (*scene.key_of(item), "body"), "there is no body of this name", cure
    mounted: list[tuple[Key, str | None]] = [
        ((*scene.key_of(item), "frame"), None if isinstance(item, End) else item.frame) for item in scene.path
    ]
    mounted += [(("frames", i, "parent"), frame.parent) for i, frame in enumerate(scene.frames)]
    for at, name in mounted:
        if name == VESSEL and scene.vessel is None:
            yield at, "the scene has no vessel", "add `vessel:`, or give the name of a frame, or ground"
        elif name is not None and name not in frames:
            yield at, "there is no frame of this name", nearest(name, frames)


def _cycles(scene: Scene) -> Iterator[Fault]:
    """No frame is its own parent."""
    parents = {frame.name: frame.parent for frame in scene.frames}
    for i, frame in enumerate(scene.frames):
        below, passed = frame.parent, [frame.name]
        while below in parents and below not in passed:
            passed.append(below)
            below = parents[below]
        if below == frame.name:
            way = " on ".join([*passed, frame.name])
            yield ("frames", i, "parent"), f"the frame is its own parent: {way}", "give ground or vessel to one of them"
            return


def _bodies(scene: Scene) -> Iterator[Fault]:
    """Every body hangs on the rope or a spring, and has mass where it does not hang on the rope."""
    roped = {item.body for item in scene.path if isinstance(item, (Sheave, End))}
    for i, body in enumerate(scene.bodies):
        if body.name in roped:
            continue
        if body.spring is None:
            cause = "no rope and no spring holds it"
            yield ("bodies", i, "name"), cause, f"add `end: {{name: hook, body: {body.name}}}` to the path"
        elif body.mass == 0.0:
            yield ("bodies", i, "mass"), "nothing with mass is attached to it", "give a mass greater than zero"
        elif body.release is not None and body.release.remaining == 0.0:
            at: Key = ("bodies", i, "release", "remaining")
            yield at, "leaves a body without mass and without a rope", "give a mass greater than zero"
    yield from _turning(scene)
    rigid = {body.name for body in scene.bodies if body.inertia is not None}
    for item in scene.sheaves:
        if item.body in rigid:
            cause = f"body {item.body} turns, and a sheave rides only on a body that does not"
            yield (*scene.key_of(item), "body"), cause, f"remove inertia from {item.body}"


def _turning(scene: Scene) -> Iterator[Fault]:
    """A rigid body moves by its mass, that of the water around it, or that of the rope which ends at its centre."""
    ends = [item for item in scene.path if isinstance(item, End)]
    beside = {end.body for end in ends if any(end.offset)} - {end.body for end in ends if not any(end.offset)}
    for i, body in enumerate(scene.bodies):
        if body.inertia is None or body.name not in beside:
            continue
        for key, one in ((("mass",), body), (("release", "remaining"), body.after_release())):
            wet = one.height is None
            moved = (axis in body.guide or (wet and one.added_mass[k] > 0.0) for k, axis in enumerate(XYZ))
            if one.mass == 0.0 and not all(moved):
                cause = (
                    "is no mass of a body with `inertia` and a rope beside its centre: nothing says how fast it moves"
                )
                yield ("bodies", i, *key), cause, "give the mass of hook and shackle, or remove `inertia`"
                break


def _neighbours(scene: Scene) -> Iterator[Fault]:
    """Two items between which a rope runs are apart."""

    def place(item: PathItem) -> tuple[Any, ...]:
        if isinstance(item, End) or (isinstance(item, Sheave) and item.body is not None):
            return "body", item.body, item.offset
        point = item.position if isinstance(item, Anchor) else item.center
        return "frame", scene.frame_of(item), point

    for i in range(1, len(scene.path)):
        before, item = scene.path[i - 1], scene.path[i]
        if place(before) == place(item):
            key = {"anchor": "position"}.get(item.key, "center" if getattr(item, "center", None) else "offset")
            cause = f"{item.name} has the same centre as {before.name}, the item before it: no rope runs between them"
            yield (*scene.key_of(item), key), cause, "move one of the two"


def _mesh(scene: Scene) -> Iterator[Fault]:
    asked, spans = scene.mesh.elements_per_span, len(scene.path) - 1
    at = ("mesh", "elements_per_span")
    if isinstance(asked, tuple) and len(asked) != spans:
        entries = "1 entry" if len(asked) == 1 else f"{len(asked)} entries"
        cause = f"has {entries}, and the path {spans} span{'s' if spans > 1 else ''}"
        yield at, cause, "give one number for all spans, or one for each"
    elif sum(scene.elements) > MOST_ELEMENTS:
        yield at, f"makes {sum(scene.elements)} elements, more than {MOST_ELEMENTS}", "take fewer, longer elements"


def _drums(scene: Scene) -> Iterator[Fault]:
    """What layers say agrees with the rope and with the drum."""
    for drum in scene.drums:
        layers, diameter, at = drum.layers, scene.rope.diameter, scene.key_of(drum)
        if layers is None:
            continue
        if diameter is None:
            yield (*at, "layers"), "the diameter of the rope is not given", "add `diameter:` to rope, or remove this"
            continue
        capacity = layers.capacity(diameter)
        if capacity is None or layers.count is None:
            continue
        outermost = layers.pitch_radius(layers.count, diameter)
        # A drum whose radius is that of its core is read as one whose first layer is being filled.
        if drum.radius > outermost * (1.0 + 1e-6):
            cause = f"lies outside of layer {layers.count}, whose radius is {outermost:.4g} m"
            yield (*at, "radius"), cause, "give the pitch radius of the layer that the rope leaves, or more layers"
        if drum.rope_on_drum is not None and drum.rope_on_drum > capacity:
            cause = f"is more than {layers.count} layers of {layers.turns} turns hold, {capacity:.4g} m"
            cause = f"{cause}: {layers.pitch_radii(diameter)}"
            yield (*at, "rope_on_drum"), cause, "give less, or more turns or layers"


def _water(scene: Scene) -> Iterator[Fault]:
    """Water acts where there is any, on a rope whose diameter is known."""
    if scene.water is None:
        for i, body in enumerate(scene.bodies):
            left = ("bodies", i, "release")
            for at, one in ((left[:2], body), *(() if body.release is None else ((left, body.release),))):
                for key in ("added_mass", "volume", "drag", "height"):
                    if _acts(getattr(one, key)):
                        yield (*at, key), "is given, and the scene has no water", "add `water:`, or remove this"
        return
    for key in ("rope_drag", "added_mass"):
        if getattr(scene.water, key) and scene.rope.diameter is None:
            yield ("water", key), "the diameter of the rope is not given", "add `diameter:` to rope, or remove this"
    if scene.water.waves is not None:
        yield from _waves(scene)
    if scene.water.current is not None and not (scene.water.rope_drag or any(_carried(b) for b in scene.bodies)):
        cause = "acts on nothing: neither the rope nor a body has drag along x or y"
        yield ("water", "current"), cause, "give water.rope_drag or a body `drag`, or remove this"


def _carried(body: Any) -> bool:
    """Whether water that flows takes a body along, before its release or after: by drag, or as it comes in."""
    for one in (body, body.after_release()):
        comes_in = one.added_mass[:2] if one.height is not None else ()
        if any((*one.drag.linear[:2], *one.drag.quadratic[:2], *comes_in)):
            return True
    return False


def _waves(scene: Scene) -> Iterator[Fault]:
    """Waves act on bodies whose height is known, and a vessel's are those of a sea."""
    at, waves = ("water", "waves"), scene.water.waves
    if not any(body.height is not None for body in scene.bodies):
        yield at, "no body has a `height`: waves act on nothing", "give a body `height` and `bottom`, or remove this"
    if scene.ground is not None and scene.ground.level >= scene.water.surface:
        cause = f"is not below water.surface = {scene.water.surface:g} m: there is no water for the waves"
        cure = "give the level of the sea bed, or remove `ground:` where the water is deep"
        yield ("ground", "level"), cause, cure
    for i, body in enumerate(scene.bodies):
        states = body, body.after_release()
        if body.height is None and any(_acts(getattr(one, key)) for one in states for key in WATERS):
            cause = "is missing: waves move the water at each depth otherwise, and act on a body by its height"
            yield ("bodies", i, "height"), cause, "give `height` and `bottom`"
    if waves.elevation != "vessel":
        return
    if scene.vessel is None or scene.vessel.sea is None:
        cause = "the scene has no vessel" if scene.vessel is None else "the vessel's motion is no response to a sea"
        cure = "give vessel.motion a sea, or write the waves, such as {spectrum: {significant_height: 1.5, ...}}"
        yield (*at, "elevation"), cause, cure
        return
    for key in SEA_KEYS:
        if len({getattr(sea, key) for sea in scene.vessel.seas.values()}) > 1:
            which = " and ".join(scene.vessel.seas)
            cause = f"the motions of the vessel have several seas: {key} of {which} is not the same"
            yield (*at, "elevation"), cause, "write the same, or give vessel.motion one sea and a file of responses"
            return
    known = getattr(scene.vessel.motion, "direction", None)
    if waves.direction is None and known is None:
        cause = "is missing, and the vessel's responses do not say in which direction the waves run"
        yield (*at, "direction"), cause, "give it: 0 deg along x, 180 deg for a sea from ahead of a vessel along x"
    elif waves.direction is not None and known is not None:
        yield (*at, "direction"), "is given, and vessel.motion.direction too: the sea has one", "remove this"


def _acts(given: Drag | tuple[float, ...] | float | None) -> bool:
    """Whether any number is not zero of what the water around a body does; None in a release says nothing."""
    if isinstance(given, Drag):
        return any((*given.linear, *given.quadratic))
    return any(given) if isinstance(given, tuple) else bool(given)


def _ground(scene: Scene) -> Iterator[Fault]:
    """The ground is below everything."""
    if scene.ground is None:
        for i, body in enumerate(scene.bodies):
            left = body.release.bottom if body.release is not None else None
            for at, bottom in ((("bodies", i, "bottom"), body.bottom), (("bodies", i, "release", "bottom"), left)):
                if bottom and body.height is None:
                    yield at, "is given, and the scene has no ground", "add `ground:`, or remove this"
        return
    level = scene.ground.level
    lowest = level - 1e-9 * max(1.0, abs(level))
    cure = f"raise it, or lower ground.level = {level:g}"
    for i, body in enumerate(scene.bodies):
        if body.after_release().bottom > body.bottom:
            cause = f"is more than the whole body has, {body.bottom:g} m: it could be in the ground at once"
            yield ("bodies", i, "release", "bottom"), cause, "give how far the lowest point of what remains is below"
        if body.lowest < lowest:
            yield ("bodies", i, "position"), f"its lowest point, z = {body.lowest:g} m, is below the ground", cure
    for item in scene.path:
        key = "position" if isinstance(item, Anchor) else "center"
        point = getattr(item, key, None)
        if point is not None and point[2] < lowest:
            yield (*scene.key_of(item), key), f"z = {point[2]:g} m is below the ground", cure


def _start(scene: Scene) -> Iterator[Fault]:
    if scene.start != "static" or any(scene.gravity):
        return
    # A rope between fixed places that is shorter than its path pulls itself straight.
    if scene.bodies or scene.rope.length is None:
        cause = "there is no rest to be found without gravity"
        yield ("start",), cause, "give gravity, or start: as drawn"


def _level(scene: Scene) -> Iterator[Fault]:
    """Water lies level, and lifts along z: it does not know of gravity that leans."""
    x, y, z = scene.gravity
    if scene.water is not None and (x != 0.0 or y != 0.0 or z > 0.0):
        cause = f"[{x:g}, {y:g}, {z:g}] does not point down along z, and the surface of the water is level"
        yield ("gravity",), cause, "write [0, 0, -9.81], or leave out `water:`"


def _compensation(scene: Scene) -> Iterator[Fault]:
    """Heave is compensated by a drum that pays out as it is told, on a vessel that heaves."""
    at: Key = ("heave_compensation",)
    if scene.heave_compensation is None:
        return
    if scene.vessel is None:
        yield at, "the scene has no vessel: nothing heaves", "add `vessel:`, or remove this"
    elif not any(drum.prescribed for drum in scene.drums):
        cause = "no drum of the path has `pay_out:` or `speed:` for it to add to"
        yield at, cause, "drive a drum by pay_out, or remove this"


def _computable(scene: Scene) -> Iterator[Fault]:
    """Yield the numbers that cannot be computed with, and the places that are too far from the origin."""
    if not _any_odd(scene):
        return
    for at, value in _numbers(scene, ()):
        name = next(part for part in reversed(at) if isinstance(part, str))
        if abs(value) > LARGEST or (name in DIVISORS and 0.0 < abs(value) < SMALLEST):
            yield at, *OUTSIDE
        elif name in PLACES and abs(value) > FAR_AWAY:
            cause = "is so far away that rounding would show in the rope's forces"
            yield at, cause, "put the origin near the crane, and give positions in m"


def _any_odd(value: Any) -> bool:
    """Whether any number is so large or so small that its key matters."""
    kind = type(value)
    if kind is float:
        return value != 0.0 and not SMALLEST <= abs(value) <= FAR_AWAY
    if kind in WITHOUT_NUMBERS:
        return False
    if kind is tuple or kind is list:
        for entry in value:
            if _any_odd(entry):
                return True
        return False
    if not isinstance(value, Model) or _not_odd.get(id(value)) is value:
        return False
    for entry in value.__dict__.values():
        if _any_odd(entry):
            return True
    _not_odd[id(value)] = value
    return False


WITHOUT_NUMBERS = frozenset({str, int, bool, type(None)})
"""Classes of values that no key cares how large they are."""
_not_odd: WeakValueDictionary[int, Model] = WeakValueDictionary()
"""Parts of scenes without such a number: variants of a scene share most of them."""


def _numbers(value: Any, at: Key) -> Iterator[tuple[Key, float]]:
    """Yield all numbers of a model with their key paths; of a function of time only its largest, at the whole."""
    if isinstance(value, float):
        yield at, value
    elif isinstance(value, tuple):
        for i, entry in enumerate(value):
            yield from _numbers(entry, (*at, i))
    elif isinstance(value, FunctionOfTime):
        yield at, max((abs(x) for x in _parts(value)), default=0.0)
    elif isinstance(value, Model):
        if isinstance(value, PathItem):
            at = (*at, value.key)
        for name in type(value).model_fields:
            yield from _numbers(getattr(value, name), (*at, name))


def _parts(value: Any) -> Iterator[float]:
    """Yield all numbers of a function of time."""
    if isinstance(value, float):
        yield value
    elif isinstance(value, (tuple, list)):
        for entry in value:
            yield from _parts(entry)
    elif isinstance(value, Model):
        for name in type(value).model_fields:
            yield from _parts(getattr(value, name))
