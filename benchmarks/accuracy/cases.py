"""Thirty scenes on which `simulate --accuracy` is judged: shipped ones, shortened where they are long, and variants."""

from __future__ import annotations

from typing import Any, NamedTuple

STATIC, KINETIC = "well.wall.friction.static", "well.wall.friction.kinetic"
LUMPS, SPEED = "model.elements", "water.speed.ramp.to"
DRIVE = "top.rotation.controller.speed.ramp.to"
STILL = {"path[0].drum.pay_out": {"constant": 0.0}, "vessel": None, "solver.end": "1 s", "output.interval": "5 ms"}
HEAVE = "vessel.motion.heave.harmonic"


class Case(NamedTuple):
    """A shipped scene with some keys changed, and its end, s; None keeps the scene's."""

    name: str
    scene: str
    keys: dict[str, Any]
    end: float | None = None


def rubbing(static: float, kinetic: float, end: float | None = None) -> Case:
    """The J-well with another friction."""
    return Case(f"J-well {static:g}/{kinetic:g}", "jwell", {STATIC: static, KINETIC: kinetic}, end)


def losing(remaining: float, elements: int) -> Case:
    """5 t on one fall, of which only some kg remain after 50 ms."""
    keys = STILL | {"bodies[0].release": {"at": 0.05, "remaining": remaining}, "mesh.elements_per_span": elements}
    return Case(f"load loss to {remaining:g} kg, {elements} elements a span", "hoist", keys, None)


CASES = (
    rubbing(0.3, 0.2),
    rubbing(0.2, 0.2),
    rubbing(0.25, 0.2, 30.0),
    rubbing(0.4, 0.3, 20.0),
    rubbing(0.0, 0.0),
    Case("J-well, 60 lumps", "jwell", {LUMPS: 60}, 10.0),
    Case("J-well, faster heave", "jwell", {"top.block.chirp.period": "12 s"}, 30.0),
    Case("ISCWSA well", "iscwsa", {}, 10.0),
    Case("ISCWSA well, 0.4/0.3", "iscwsa", {STATIC: 0.4, KINETIC: 0.3}, 10.0),
    Case("tripping", "tripping", {}, 12.0),
    Case("drilling", "drilling", {}, 10.0),
    Case("stick-slip", "drilling", {DRIVE: "60 rpm", "bit.torque.static": "12 kN m"}, 20.0),
    Case("field well", "field_well", {}),
    Case("whirl", "whirl", {}, 4.0),
    Case("hoist", "hoist", {}),
    Case("hoist in a faster sea", "hoist", {f"{HEAVE}.period": 4.0, f"{HEAVE}.amplitude": 1.0}),
    Case("hook block", "hookblock", {}),
    Case("sixteen falls", "sixteen_falls", {}, 4.0),
    Case("sixteen falls, 1 m of heave", "sixteen_falls", {f"{HEAVE}.amplitude": 1.0}, 6.0),
    Case("slewing", "slewing", {}),
    Case("landing", "landing", {}, 20.0),
    losing(1000.0, 8),
    losing(2500.0, 16),
    Case("hose at 35 m/s", "hose", {}, 2.0),
    Case("hose at 25 m/s", "hose", {SPEED: 25.0}),
    Case("hose at 15 m/s", "hose", {SPEED: 15.0}, 3.0),
    Case("hose at 30 m/s, 8 elements", "hose", {SPEED: 30.0, "hose.elements": 8}, 3.0),
    Case("hammer bar", "cantilever_bar", {}, 10.0),
    Case("reeled span", "reeled_span", {}, 6.0),
    Case("reeled span, heavier load", "reeled_span", {"CableModel[11].PointMass.mass": 2.0}, 6.0),
)
