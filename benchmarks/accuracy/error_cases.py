"""Scenes on which the error that `simulate` states is measured: half to choose it by, half to prove it with."""

from __future__ import annotations

from typing import Any, NamedTuple

STATIC, KINETIC = "well.wall.friction.static", "well.wall.friction.kinetic"
AMPLITUDE, PERIOD = "top.block.chirp.amplitude", "top.block.chirp.period"
LUMPS, RHO, SPEED = "model.elements", "solver.rho_inf", "water.speed.ramp.to"


class Case(NamedTuple):
    """A shipped scene with some keys changed, its step and its end, s; None keeps the scene's.

    ``name`` says in words what is changed; empty names the keys.
    """

    scene: str
    keys: dict[str, Any]
    step: float | None = None
    end: float | None = None
    name: str = ""

    def __str__(self) -> str:
        told = self.name or ", ".join(f"{key.split('.')[-1]} {value}" for key, value in self.keys.items())
        return f"{self.scene}: {told}" if told else self.scene


def rubbing(static: float, kinetic: float, step: float | None = None, end: float | None = None) -> Case:
    """The J-well with another friction."""
    return Case("jwell", {STATIC: static, KINETIC: kinetic}, step, end)


CHOSEN_BY = (
    Case("jwell", {}),
    rubbing(0.25, 0.2),
    rubbing(0.2, 0.2),
    rubbing(0.4, 0.3),
    rubbing(0.1, 0.1, 2.5e-3),
    Case("jwell", {STATIC: 0.35, LUMPS: 24}, 2e-3, 20.0),
    Case("jwell", {RHO: 0.8}),
    Case("jwell", {}, 5e-3),
    Case("jwell", {}, 1e-2),
    Case("jwell", {AMPLITUDE: "2 m", PERIOD: "12 s"}),
    rubbing(0.0, 0.0, 5e-3),
    rubbing(0.15, 0.1, 5e-4),
    Case("iscwsa", {}),
    Case("drilling", {}, None, 10.0),
    Case("tripping", {}, None, 10.0),
    Case("hoist", {}),
    Case("hoist", {}, 2e-2),
    Case("sixteen_falls", {}, 1e-2, 5.0),
    Case("hose", {}),
    Case("slewing", {}),
    Case("landing", {}, None, 20.0),
    Case("whirl", {}, 2e-3, 5.0),
    Case("reeled_span", {}),
    Case("field_well", {}),
    Case("hose", {SPEED: 15.0}, 2e-3),
    Case("hose", {SPEED: 25.0}, 5e-4),
    Case("cantilever_bar", {}, 2e-2, 8.0),
    Case("reeled_span", {}, 2.5e-3),
    Case("hose", {"coupling": "lagrange"}, 5e-4, 3.0),
)
PROVED_WITH = (
    rubbing(0.3, 0.25),
    rubbing(0.4, 0.2),
    rubbing(0.4, 0.4),
    rubbing(0.22, 0.18, 3e-3),
    Case("jwell", {STATIC: 0.28, LUMPS: 16}, 1e-3, 30.0),
    Case("jwell", {LUMPS: 60}, 2e-3, 10.0),
    Case("jwell", {STATIC: 0.35, KINETIC: 0.3, RHO: 0.5}, 4e-3),
    Case("jwell", {AMPLITUDE: "1.5 m", PERIOD: "15 s"}, 2e-3),
    Case("jwell", {AMPLITUDE: "0.5 m", PERIOD: "30 s"}, 2e-3),
    rubbing(0.12, 0.1, 8e-3),
    rubbing(0.28, 0.15, 2e-3, 25.0),
    rubbing(0.33, 0.21, 1.5e-3),
    Case("iscwsa", {STATIC: 0.4, KINETIC: 0.3}, 5e-3),
    Case("iscwsa", {STATIC: 0.2, KINETIC: 0.1}, 2e-3),
    Case("tripping", {STATIC: 0.4, KINETIC: 0.2}, 1e-2, 12.0),
    Case("drilling", {STATIC: 0.35, KINETIC: 0.25}, 5e-3, 8.0),
    Case("hoist", {}, 1e-2),
    Case("hookblock", {}),
    Case("hookblock", {}, 2.5e-2),
    Case("sixteen_falls", {}, 5e-3, 4.0),
    Case("hose", {"hose.elements": 6}, 2e-3, 4.0),
    Case("cantilever_bar", {}, None, 10.0),
    Case("slewing", {}, 1.25e-2, 8.0),
    Case("whirl", {KINETIC.replace("friction.kinetic", "friction"): 0.3}, 4e-3, 4.0),
    Case("field_well", {}, 5e-3),
    Case("landing", {}, 2e-2, 15.0),
    Case("reeled_span", {}, 1e-2, 6.0),
    Case("hose", {SPEED: 20.0}),
    Case("hose", {SPEED: 30.0, "hose.elements": 8}, 5e-4),
    Case("hose", {RHO: 0.6}, 2.5e-4, 3.0),
    Case("reeled_span", {}, 2e-3, 8.0),
    Case("sixteen_falls", {"vessel.motion.heave.harmonic.amplitude": 1.0}, 1e-2, 8.0),
    Case("cantilever_bar", {}, 5e-3, 20.0),
)
QUICK = (Case("jwell", {STATIC: 0.25}, 2e-3, 2.0), Case("hose", {SPEED: 15.0}, 2e-3, 0.2))
"""What shows that the benchmark runs."""
