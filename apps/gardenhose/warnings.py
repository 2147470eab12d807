"""What to tell a user about a hose before it runs: large against what, and what to do."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from gardenhose.cables import cables_of, stiff_beside_all
from gardenhose.estimates import (
    RADIANS_PER_ELEMENT,
    SUPPORTS,
    Average,
    average,
    first_frequency,
    largest_change,
    onset,
    pushes,
    radians,
    rates,
    rk4_limit,
    speeds,
    thrust,
    transit,
)
from gardenhose.scene import MOST_ELEMENTS, HoseScene, Water
from tautline.scene.errors import SceneWarning
from tautline.scene.solver import step_taken
from tautline.scene.values.printed import significant

LAYERS_PER_ELEMENT = 1.5
"""Length of an element over that in which a clamp's direction gives way to the hanging hose's, sqrt(EJ / tension)."""
SOFTENED = 0.2
"""Share of EA that the flow's momentum may take away without a word."""
MOST_PUSH = 0.5
"""Share of EA from which a push P |r'| squashes a hose of Green's strain to nothing: |r'|^2 = 1 - 2 P / EA."""
SEEN_PUSH = 0.01
"""Share of the force that buckles a pipe up to which a push of water that gets faster is not told."""
QUICK, CHANGED = 0.4, 0.1
"""Part of the time of a wave along the hose, and share of the largest speed by which a flow that changes within it is
told: a valve that closes evenly within four such times, as those in which a pressure wave comes back."""
MANY_PUSHES = 10.0
"""Times the force that buckles a held pipe from which a push of water that once gets faster or slower is told."""
STEPS_PER_PERIOD = 10.0
NEAR_ONSET = 0.9
"""Share of the estimated critical speed from which a hose is taken to flutter."""
MOST_DROOP = 0.3
"""Share of the length up to which the sag of a beam of small deflections is told. That of a cantilever is then too
large by 7 % under its weight and by 9 % under one at its tip; at the whole length by 56 and 66 %, by the elastica
(Bisshopp and Drucker 1945)."""
MOST_HELD = 0.3
"""Sag of a hose held at both ends up to which it is told, over its radius of gyration sqrt(EJ / EA).

Its stretch carries the more of the weight the more it sags. Between pins a beam without stretch sags
a (1 + EA a^2 / (4 EJ)) where one that stretches sags a: 2 % more, here (Timoshenko, Strength of Materials II)."""

Sentences = Iterator[tuple[str, str]]


def _across(vector: tuple[float, ...], direction: tuple[float, ...]) -> float:
    """Part of a vector across a direction, of length one; 0 where it is but rounding."""
    along = sum(a * b for a, b in zip(vector, direction, strict=True))
    across = math.hypot(*(a - along * b for a, b in zip(vector, direction, strict=True)))
    return across if across > 1e-9 * abs(along) else 0.0


def warnings(scene: HoseScene) -> list[SceneWarning]:
    """Warnings of a scene, each with its cause and a cure."""
    speed = speeds(scene)
    hose = average(scene, float(np.abs(speed).max()))
    # Statics and flutter look at speeds of their own: `momentum_at`, `mesh_at` and `aspiration_at` warn of these.
    of_a_run = (
        [*_steps(scene, hose), *_momentum(scene, speed), *_mesh(scene, speed)],
        [*_held_column(scene, hose), *_hammer(scene, hose, speed), *_rest(scene)],
    )
    before, behind = ([SceneWarning(*one, of_a_run=True) for one in found] for found in of_a_run)
    return [*before, *(SceneWarning(*one) for one in (*_stiff(scene), *_ends(scene, speed))), *behind]


def _steps(scene: HoseScene, hose: Average) -> Sentences:
    solver = scene.solver
    if solver.step == "auto":
        return
    step = float(solver.step)
    if solver.explicit:
        limit, taken = rk4_limit(scene), step_taken(solver, scene.output.interval)
        if taken > limit.step:
            cause = f"the fastest {limit.motion} motion of an element, eqs 2.137 and 2.151"
            cure = "Take a smaller step, or method: generalized-alpha"
            if limit.damping > 1.0:
                cause = (
                    f"the damping: the fastest {limit.motion} motion of an element is overdamped, c omega / 2 = "
                    f"{limit.damping:.3g}. Without damping the critical step would be {limit.undamped:.2g} s"
                )
                cure = "Take a smaller step, less damping, or method: generalized-alpha"
            text = f"{taken:g} s is longer than RK4's critical step of about {limit.step:.2g} s, set by {cause}"
            yield "solver.step", f"{text}. The run will become unstable. {cure}"
    u, (critical, frequency) = hose.dimensionless_speed, onset(scene, hose)
    what = "the first natural frequency"
    if critical is not None and frequency and u is not None and u > NEAR_ONSET * critical:
        # Far beyond the onset the stiffness hardly counts, and only the flow sets the time: frequency grows as speed.
        what, frequency = "flutter", frequency * max(1.0, u / critical)
    else:
        frequency = first_frequency(scene, hose)
    if frequency and solver.control == "fixed" and step * frequency * STEPS_PER_PERIOD > 1.0:
        text = (
            f"{step:g} s is long against the period of {what}, about {1.0 / frequency:.2g} s. Fewer than "
            f"{STEPS_PER_PERIOD:.0f} steps a period do not follow the motion. Take "
            f"{1.0 / (2.0 * STEPS_PER_PERIOD * frequency):.1g} s or less"
        )
        yield "solver.step", text
    ratio = scene.output.interval / step
    if solver.control == "fixed" and abs(ratio - round(ratio)) > 1e-6 * ratio:
        text = (
            f"{scene.output.interval:g} s is not a whole number of steps of {step:g} s. The step taken is "
            f"{scene.output.interval / math.ceil(ratio):.6g} s. Give a multiple of the step"
        )
        yield "output.interval", text


def _stiff(scene: HoseScene) -> Sentences:
    """A hose so stiff along itself that its bending may be lost beside it: at the stiffest piece."""
    text = stiff_beside_all(scene, cables_of(scene))
    if text:
        stiffest = max(range(len(scene.hose.pieces)), key=lambda i: scene.hose.pieces[i].axial_stiffness)
        yield _at(scene, stiffest, "axial_stiffness"), text


def _at(scene: HoseScene, i: int, key: str) -> str:
    """Key path of a piece's property."""
    return f"hose.{key}" if scene.hose.segments is None else f"hose.segments[{i}].{key}"


def _momentum(scene: HoseScene, speed: np.ndarray) -> Sentences:
    """Water whose momentum, or the push of a nozzle, is large against the hose's axial stiffness."""
    yield from _softened(scene, speed)
    yield from _pushed(scene, speed)


def _pushed(scene: HoseScene, speed: np.ndarray) -> Sentences:
    """A straight hose that its nozzle squashes: P |r'| against the force of the strain, EA by its measure."""
    fastest = float(np.abs(speed).max())
    pieces = scene.hose.pieces
    shares = [push / piece.axial_stiffness for push, piece in zip(pushes(scene, fastest), pieces, strict=True)]
    i = int(np.argmax(shares))
    if shares[i] <= SOFTENED:
        return
    green = scene.hose.strain == "green"
    whose = "the nozzle's push, M U^2 (outlet - 1)" if len(pieces) == 1 else "the push of nozzle and narrower bores"
    text = f"{whose}, is {100.0 * shares[i]:.0f} % of EA at {fastest:.3g} m/s. "
    if green and shares[i] >= MOST_PUSH:
        most = fastest * math.sqrt(MOST_PUSH / shares[i])
        text += f"From {100.0 * MOST_PUSH:.0f} % on, {most:.4g} m/s, no straight hose bears it. "
    else:
        left = math.sqrt(1.0 - 2.0 * shares[i]) if green else 1.0 / (1.0 + shares[i])
        text += f"It squashes a straight hose to {100.0 * left:.0f} % of its length. "
    of_nozzle = scene.water is not None and scene.water.outlet > 1.0
    yield "water.outlet" if of_nozzle else _at(scene, i, "axial_stiffness"), text + "Give more EA, or a lower speed"


def _softened(scene: HoseScene, speed: np.ndarray) -> Sentences:
    """Water whose momentum is large against the hose's axial stiffness."""
    fastest = float(np.abs(speed).max())
    pieces = scene.hose.pieces
    shares = [thrust(scene, piece, fastest) / piece.axial_stiffness for piece in pieces]
    i = int(np.argmax(shares))
    if shares[i] <= SOFTENED:
        return
    most = fastest / math.sqrt(shares[i])
    where = _at(scene, i, "axial_stiffness")
    if shares[i] >= 1.0:
        text = (
            f"the water, up to {fastest:.3g} m/s, is faster than {most:.3g} m/s. There its momentum M U^2 equals "
            "EA. Above it no axial stiffness is left. Give more EA, or a lower speed"
        )
    else:
        text = (
            f"the momentum of the water, M U^2, is {100.0 * shares[i]:.0f} % of EA at {fastest:.3g} m/s. It takes "
            f"that much from the axial stiffness: {100.0 * (1.0 - shares[i]):.0f} % of EA is left. A hose that is bent "
            f"stretches by about {100.0 * shares[i]:.0f} %. See whether EA is what was meant. The axial stiffness is "
            f"zero at {most:.3g} m/s"
        )
    yield where, text


def _elements(wanted: float) -> int:
    """Round a number of elements up, to no more than a scene may have."""
    return math.ceil(min(wanted, MOST_ELEMENTS))


def mesh_at(scene: HoseScene, speeds: Sequence[float]) -> list[SceneWarning]:
    """Warnings of elements that are coarse for the fastest of some speeds of flow, m/s."""
    fastest = max((abs(speed) for speed in speeds), default=0.0)
    return [SceneWarning(where, text) for where, text in _waves(scene, fastest)] if fastest > 0.0 else []


def short_waves_at(scene: HoseScene, speeds: Sequence[float]) -> list[SceneWarning]:
    """Warnings of a hose without bending stiffness, whose stability at any of some speeds, m/s, the mesh decides."""
    if scene.water is None or not any(speeds):
        return []
    return [SceneWarning(where, text) for where, text in _short_waves(scene)]


def momentum_at(scene: HoseScene, speeds: Sequence[float]) -> list[SceneWarning]:
    """Warnings of water whose momentum, or push, is large against the axial stiffness at the fastest of speeds, m/s."""
    if scene.water is None or not any(speeds):
        return []
    return [SceneWarning(where, text) for where, text in _momentum(scene, np.array(speeds, float))]


def aspiration_at(scene: HoseScene, speeds_asked: Sequence[float]) -> list[SceneWarning]:
    """Warnings of water that is drawn in at the tip at some speeds asked for, m/s, and is not as the scene has it."""
    if scene.water is None or scene.hose.end != "free" or float(speeds(scene).min()) < 0.0:
        return []
    found = _aspiration(scene.water, min(speeds_asked, default=0.0))
    return [SceneWarning("--speed" if where == "water.speed" else where, text) for where, text in found]


def _waves(scene: HoseScene, fastest: float) -> Sentences:
    """Elements too long for the waves in which the flow bends the hose."""
    pieces = scene.hose.pieces
    if any(piece.bending_stiffness == 0.0 for piece in pieces):
        return
    phases = [radians(scene, piece, fastest) for piece in pieces]
    i = max(range(len(pieces)), key=lambda i: phases[i] / pieces[i].elements)
    if phases[i] > RADIANS_PER_ELEMENT * pieces[i].elements:
        text = (
            f"{pieces[i].elements} are coarse at {fastest:.3g} m/s. The flow bends the hose in waves of "
            f"{2.0 * math.pi * pieces[i].length / phases[i]:.2g} m, {significant(phases[i] / pieces[i].elements, 2)} "
            f"rad to an element. Take {_elements(1.5 * phases[i] / RADIANS_PER_ELEMENT)}"
        )
        yield _at(scene, i, "elements"), text


def _short_waves(scene: HoseScene) -> Sentences:
    """A section without bending stiffness: the shorter a wave in it is, the faster it grows."""
    for i, piece in enumerate(scene.hose.pieces):
        if piece.bending_stiffness == 0.0:
            text = (
                "is zero, and water flows. Nothing limits the growth of the shortest waves. The result then depends on "
                "the number of elements. Give the bending stiffness, however small"
            )
            yield _at(scene, i, "bending_stiffness"), text
            return


def _mesh(scene: HoseScene, speed: np.ndarray) -> Sentences:
    """Elements too long for the bending that flow and weight make."""
    fastest, hose = float(np.abs(speed).max()), scene.hose
    pieces = hose.pieces
    if scene.water is not None and fastest > 0.0:
        short = list(_short_waves(scene))
        if short:
            yield from short
            return
        waves = list(_waves(scene, fastest))
        if waves:
            yield from waves
            return
    weight = sum((p.mass_per_length + (p.water_mass_per_length or 0.0)) * p.length for p in pieces) + hose.tip_mass
    tension = weight * math.hypot(*scene.gravity)
    across = _across(scene.gravity, hose.unit_direction)
    piece = pieces[0]
    if hose.root_support == "clamped" and hose.end == "free" and across > 0.0 and piece.bending_stiffness > 0.0:
        layer = math.sqrt(piece.bending_stiffness / tension)
        length = piece.length / piece.elements
        if length > LAYERS_PER_ELEMENT * layer:
            text = (
                f"an element is {length:.2g} m long. Under its weight the hose bends away from its clamp within "
                f"{layer:.2g} m. Take {_elements(piece.length / layer)}, or a short first segment"
            )
            yield _at(scene, 0, "elements"), text


def _ends(scene: HoseScene, speed: np.ndarray) -> Sentences:
    """What happens at the tip that is not as simple as it looks."""
    hose, water = scene.hose, scene.water
    if hose.end != "free" and hose.tip_mass > 0.0:
        yield "hose.tip_mass", f"has no effect: the tip is {hose.end}. Remove it, or let the end be free"
    if water is None or hose.end != "free":
        return
    yield from _aspiration(water, float(speed.min()))
    if water.outlet < 1.0:
        text = (
            f"{water.outlet:g}: the jet is slower than the water in the hose, as after a diffuser. The flow may "
            "separate and keep its speed. Give 1 for a plain end, or more for a nozzle"
        )
        yield "water.outlet", text


def _held_column(scene: HoseScene, hose: Average) -> Sentences:
    """Water that gets faster and slower between two held ends: who bears that force is the model's choice."""
    support = SUPPORTS.get((scene.hose.root_support, scene.hose.end))
    if scene.water is None or support is None or support[2] is None or hose.bending == 0.0:
        return
    # What rises once pushes once: only a flow that comes and goes can shake the pipe.
    changes = rates(scene)
    quickest = max(0.0, min(float(changes.max()), -float(changes.min())))
    push = 0.5 * hose.water * quickest * hose.length
    share = push / (hose.bending * (support[2] / hose.length) ** 2)
    if share > SEEN_PUSH:
        text = (
            f"rises and falls by up to {quickest:.3g} m/s^2, and both ends are held. Here the wall alone moves the "
            "water, and both ends share the force: N = M dU/dt (s - L/2). Where the outlet keeps its pressure, the "
            f"pressure moves it, and N = -M dU/dt (L - s), smaller by {push:.3g} N all along. That is "
            f"{significant(100.0 * share, 2)} % of the force that buckles the pipe. A pulsating flow may then make a "
            "pipe swing that is quiet here. See docs/hose.md"
        )
        yield "water.speed", text


def _hammer(scene: HoseScene, hose: Average, speed: np.ndarray) -> Sentences:
    """Water that stops or starts so quickly that waves of pressure would run through it, or its pressure buckle it."""
    fastest, time = float(np.abs(speed).max()), transit(scene)
    if scene.water is None or fastest == 0.0:
        return
    if largest_change(scene, QUICK * time) >= CHANGED * fastest:
        # Of a change that lasts longer, or in a run that is shorter, what it is in all.
        whole = largest_change(scene, min(QUICK / CHANGED * time, 0.5 * scene.solver.end))
        what = (
            f"changes by {whole:.3g} m/s within {QUICK / CHANGED * time:.2g} s or less. A wave of stretch takes "
            f"{time:.2g} s along this hose"
        )
    else:
        support = SUPPORTS.get((scene.hose.root_support, scene.hose.end))
        if support is None or support[2] is None or hose.bending == 0.0 or any(_held_column(scene, hose)):
            return
        quickest = float(np.abs(rates(scene)).max())
        push = 0.5 * hose.water * quickest * hose.length
        share = push / (hose.bending * (support[2] / hose.length) ** 2)
        if share <= MANY_PUSHES:
            return
        what = (
            f"changes at up to {quickest:.3g} m/s^2. To make that change, M dU/dt L/2 is {push:.3g} N, "
            f"{significant(share, 2)} times the force that buckles the pipe"
        )
    text = (
        f"{what}. In the model the water stops, or starts, everywhere at once. Pressure waves (water hammer) are not "
        "in this model. Behind a valve that closes quickly the pressure rises by rho c dU (Joukowsky): density, speed "
        "of pressure waves, change of the flow's speed. Give a slower change, or judge the pressure wave by other means"
    )
    yield "water.speed", text


def _aspiration(water: Water, slowest: float) -> Sentences:
    """Water that is drawn in at a free tip."""
    if slowest < 0.0:
        text = (
            f"goes down to {slowest:.3g} m/s: water is drawn in at the tip. The model lets it enter along the tip's "
            "tangent with all its momentum. In that theory a cantilever flutters at almost no speed. In experiments it "
            "has not (Paidoussis, Fluid-Structure Interactions 1, chapter 4). Compare with measurements, or hold the "
            "tip"
        )
        yield "water.speed", text
        if water.outlet != 1.0:
            text = "acts on water that leaves, and some is drawn in. What a nozzle does there is unknown. Set it to 1"
            yield "water.outlet", text


def _rest(scene: HoseScene) -> Sentences:
    """A straight hose that nothing pushes sideways."""
    direction = scene.hose.unit_direction
    if any(_across(vector, direction) > 0.0 for vector in (scene.gravity, scene.disturbance)):
        return
    why = "acts along the hose" if any(scene.gravity) else "is zero"
    moves = "Nothing starts it moving sideways"
    if scene.start != "straight":
        moves = (
            f"`start: {scene.start}` begins in a bent shape where the straight one does not stand and a bent one does. "
            "Otherwise nothing starts it moving sideways"
        )
    cure = "Give `disturbance`, such as a hundredth of a metre a second across the hose"
    if scene.hose.end != "free":
        cure = "Let a little of gravity act across the hose, such as a thousandth of it"
    text = f"gravity {why}. The straight hose is in equilibrium, stable or not. {moves}. {cure}"
    yield "disturbance" if scene.hose.end == "free" else "gravity", text


def _droop(scene: HoseScene, hose: Average, across: float) -> float | None:
    """Sag of a beam of small deflections under its weight and that of the mass at a free tip, m.

    None where it is beyond what such a beam tells of.
    """
    support = SUPPORTS[scene.hose.root_support, scene.hose.end]
    tip = scene.hose.tip_mass / (3.0 * hose.length) if scene.hose.end == "free" else 0.0
    sag = (support[1] * (hose.mass + hose.water) + tip) * across * hose.length**4 / hose.bending
    if scene.hose.end == "free":
        return sag if sag <= MOST_DROOP * hose.length else None
    radius = math.sqrt(hose.bending / max(piece.axial_stiffness for piece in scene.hose.pieces))
    return sag if sag <= MOST_HELD * radius else None


def figures(scene: HoseScene) -> dict[str, Any]:
    """Figures of hose and flow for ``check --json``, SI; None where there is no such thing.

    `critical_speed` and `critical_frequency` are estimates (of divergence, at 0 Hz, where both ends are held), as are
    `first_frequency` and `droop`, the sag of a beam of small deflections under its weight: None beyond 0.3 of
    the length of a hose with a free end, where it is too large by 7 to 9 %, and beyond 0.3 of its radius of gyration
    sqrt(EJ / EA) of one held at both ends, where stretch carries weight: 2 %.
    """
    largest = float(np.abs(speeds(scene)).max())
    hose = average(scene, largest)
    critical, frequency = onset(scene, hose)
    per_speed = average(scene, 1.0).dimensionless_speed
    load = hose.mass + hose.water
    support = SUPPORTS.get((scene.hose.root_support, scene.hose.end))
    across = _across(scene.gravity, scene.hose.unit_direction)
    step = rk4_limit(scene).step
    stiff = hose.bending > 0.0
    return {
        "hose": {
            "length": hose.length,
            "elements": scene.hose.element_count,
            "mass": hose.mass * hose.length + scene.hose.tip_mass,
            "water": hose.water * hose.length,
            "mass_ratio": hose.mass_ratio,
            "gravity": load * math.hypot(*scene.gravity) * hose.length**3 / hose.bending if stiff else None,
            "droop": _droop(scene, hose, across) if stiff and support else None,
            "first_frequency": first_frequency(scene, hose),
        },
        "flow": {
            "largest_speed": largest,
            "dimensionless_speed": hose.dimensionless_speed,
            "critical_dimensionless_speed": critical,
            "critical_speed": critical / per_speed if critical is not None and per_speed else None,
            "critical_frequency": frequency,
        }
        if scene.water is not None
        else None,
        "critical_step_rk4": step if math.isfinite(step) else None,
    }
