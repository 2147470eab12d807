"""What to tell a user about winches before a crane runs: what they take in, pay out and hold."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from crane.assembly.drum_supply import Supply, capacity_of, hoisted_spans, reeled_of, supply_of
from crane.assembly.estimates import Estimate
from crane.scene.keys import where
from crane.scene.scene import CraneScene, Drum
from crane.sea.compensation import Compensation
from tautline.system.time_functions import Samples

SUDDEN = 0.01
"""Share of the tension at rest that a jump in speed may add without a word."""

Sentences = Iterator[tuple[str, str]]


def winch_warnings(found: Estimate, actuator: Compensation | None) -> Sentences:
    """Motion of winches that begins with a jump, or goes too far, and layers that count nothing: key and text of each.

    Parameters
    ----------
    found : Estimate
    actuator : Compensation or None
        Of the heave compensation, where there is one.
    """
    scene = found.scene
    for drum in scene.drums:
        yield from _layers(scene, drum)
        supply = supply_of(scene, drum)
        if supply is None:
            continue
        front = abs(float(supply.speed[0])) * found.impedance
        if front > SUDDEN * found.largest_tension:
            text = (
                f"jumps to {supply.speed[0]:.3g} m/s at t = 0: a front of {front:.3g} N runs along the rope, v sqrt(EA "
                "rho); begin at 0 with a ramp, such as {ramp: {to: "
                f"{supply.speed[0]:.3g}, over: 1.0}}}}, unless that is what is asked"
            )
            yield where(scene, drum, drum.drive), text
        whole = _compensated(supply, actuator)
        yield from _empty(scene, drum, whole)
        yield from _full(scene, drum, whole)
    yield from _too_high(found)


def _layers(scene: CraneScene, drum: Drum) -> Sentences:
    """Layers of a drum of which nobody knows how much rope is on it."""
    if drum.layers is not None and drum.rope_on_drum is None:
        full = "" if drum.layers.count is None else ", and it is full as if it had begun empty"
        text = (
            "without rope_on_drum nobody knows which layer the rope leaves from: drum_rotation and winch_torque go by "
            f"the drum's radius{full}; give rope_on_drum, or remove layers"
        )
        yield where(scene, drum, "layers"), text


def _compensated(supply: Supply, actuator: Compensation | None) -> Supply:
    """Supply of the operator and of heave compensation together."""
    if actuator is None or not isinstance(actuator.pay_out, Samples):
        return supply
    answered = np.interp(supply.time, actuator.pay_out.time, actuator.pay_out.value)
    return supply._replace(paid_out=supply.paid_out + answered)


def _empty(scene: CraneScene, drum: Drum, supply: Supply) -> Sentences:
    """A drum that runs out of rope."""
    held, most = drum.rope_on_drum, float(supply.paid_out.max())
    if held is not None and most > held:
        k = int(np.argmax(supply.paid_out > held))
        text = (
            f"{held:.4g} m, and {most:.4g} m are paid out: the run will stop at about t = {supply.time[k]:.3g} s, when "
            "the drum is empty; give more rope, or pay out less"
        )
        yield where(scene, drum, "rope_on_drum"), text


def _full(scene: CraneScene, drum: Drum, supply: Supply) -> Sentences:
    """A drum that heave compensation fills; one that its operator fills is refused."""
    capacity, held = capacity_of(scene, drum), (drum.rope_on_drum or 0.0) - supply.paid_out
    if capacity is not None and held.max() > capacity:
        k = int(np.argmax(held > capacity))
        text = (
            f"the layers hold {capacity:.4g} m, and with heave compensation it comes to {float(held.max()):.4g} m: the "
            f"run will stop at about t = {supply.time[k]:.3g} s, when the drum is full; give it more turns or layers"
        )
        yield where(scene, drum, "layers"), text


def _too_high(found: Estimate) -> Sentences:
    """A load that is hoisted into what it hangs on."""
    scene = found.scene
    loose, (drums, time, taken) = hoisted_spans(scene), reeled_of(scene)
    room = sum(found.path.spans[k].length for k in loose)
    if loose and taken.max() > room:
        k, drum = int(np.argmax(taken > room)), drums[0]
        who = "reels" if len(drums) == 1 else f"{' and '.join(one.name for one in drums)} together reel"
        text = (
            f"{who} {float(taken.max()):.4g} m in, and there are {room:.4g} m between the load and what it hangs on: "
            f"the load comes into the sheave at about t = {time[k]:.3g} s; hoist less, or end earlier"
        )
        yield where(scene, drum, drum.drive), text
