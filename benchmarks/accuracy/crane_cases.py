"""Cranes on which the error that `simulate` states is measured: other loads, speeds, seas, friction and steps."""

from __future__ import annotations

from typing import Any

from benchmarks.accuracy.error_cases import Case

MASS, PAY_OUT, STEP, RHO = "bodies[0].mass", "path[0].drum.pay_out", "solver.step", "solver.rho_inf"
LAW, FRICTION, HEAVE = "path[1].sheave.law", "path[1].sheave.friction", "vessel.motion.heave"
VESSEL, DAMPING, RELEASE, BEARING = "vessel", "rope.damping", "bodies[0].release", "path[1].sheave.bearing"
SLEW, HOOK_FRICTION, DRUM = "frames[0].slew.ramp", "path[2].sheave.friction", "path[0].drum"


def ramp(speed: float, over: float = 1.0) -> dict[str, Any]:
    """A winch that comes to a speed, m/s, within a time, s."""
    return {"ramp": {"to": speed, "over": over}}


def stop(speed: float, at: float, over: float) -> dict[str, Any]:
    """A winch that comes to a speed, m/s, within a second, and to rest within a time, s."""
    return {"table": {"time": [0, 1, at, at + over], "value": [0, speed, speed, 0]}}


def waves(amplitude: float, period: float) -> dict[str, Any]:
    """Heave of an amplitude, m, and a period, s."""
    return {"harmonic": {"amplitude": amplitude, "period": period, "ramp": 5}}


def sea(height: float, period: float, seed: int) -> dict[str, Any]:
    """Heave in a sea of a significant height, m, and a peak period, s."""
    return {
        "spectrum": {
            "kind": "jonswap", "significant_height": height, "peak_period": period, "gamma": 2, "seed": seed,
            "rao": 0.7,
        }
    }  # fmt: skip


def on(heave: dict[str, Any]) -> dict[str, Any]:
    """A vessel that heaves."""
    return {"reference": [0, 0, -10], "motion": {"heave": heave}}


WINCH = {"name": "winch", "center": [0, 0, 0], "radius": 0.5, "axis": [0, 1, 0], "wrap": "over", "inertia": 300}
BRAKED = {
    "torque": {"constant": 25500}, "friction_torque": 500,
    "brake": {"torque": 60000, "closed": {"table": {"time": [0, 4, 4.1, 20], "value": [0, 0, 1, 1]}}},
}  # fmt: skip
HELD = {
    "tension": {"constant": 50000}, "friction_torque": 1500, "gains": {"proportional": 2, "integral": 0.5},
    "torque_limit": 40000,
}  # fmt: skip
DROPS, RUBS = {"at": 4.0, "remaining": 500}, {"friction": 0.1, "radius": 0.06}

CHOSEN_BY = (
    Case("hoist", {}),
    Case("hookblock", {}),
    Case("slewing", {}),
    Case("landing", {}, None, 40.0),
    Case("sixteen_falls", {}, None, 6.0),
    Case("hoist", {MASS: "20 t", PAY_OUT: ramp(-0.5, 0.5)}, name="20 t, 0.5 m/s"),
    Case("hoist", {MASS: "1 t", HEAVE: waves(1.5, 6.0)}, name="1 t, waves of 1.5 m"),
    Case("hoist", {PAY_OUT: stop(-2.0, 4.0, 0.2)}, name="the winch stops, slack"),
    Case("hoist", {HEAVE: waves(2.5, 3.2)}, name="waves of 2.5 m, slack"),
    Case("hoist", {RELEASE: DROPS}, name="the load drops"),
    Case("hoist", {LAW: "capstan", FRICTION: 0.2}, name="capstan friction 0.2"),
    Case("hoist", {BEARING: RUBS}, name="bearing friction 0.1"),
    Case("hoist", {HEAVE: sea(2.5, 7.0, 3), PAY_OUT: ramp(-0.5)}, None, 20.0, "a sea of 2.5 m"),
    Case("hoist", {STEP: "auto"}, name="step: auto"),
    Case("hoist", {STEP: "20 ms"}, name="step 20 ms"),
    Case("hoist", {MASS: "0.5 t", HEAVE: waves(2.0, 3.5)}, name="0.5 t, waves of 2 m"),
    Case("hookblock", {MASS: "20 t"}, name="20 t"),
    Case("hookblock", {PAY_OUT: ramp(-3.0, 0.3)}, None, 6.0, "3 m/s within 0.3 s, slack"),
    Case("hookblock", {VESSEL: on(waves(1.0, 6.0)), PAY_OUT: ramp(-0.3)}, name="waves of 1 m"),
    Case("hookblock", {PAY_OUT: stop(-1.0, 4.0, 0.1), HOOK_FRICTION: 0.15}, name="the winch stops, friction 0.15"),
    Case("slewing", {SLEW: {"rate": 0.6, "over": 1.0}}, name="0.6 rad/s"),
    Case("slewing", {MASS: "6 t"}, name="6 t"),
    Case("slewing", {STEP: "20 ms"}, name="step 20 ms"),
    Case("landing", {MASS: "30 t", HEAVE: sea(4.0, 9.0, 7)}, None, 30.0, "30 t, a sea of 4 m"),
    Case("landing", {FRICTION: 0.3}, None, 30.0, "friction 0.3"),
    Case("sixteen_falls", {MASS: "20 t"}, None, 5.0, "20 t"),
    Case("sixteen_falls", {STEP: "10 ms"}, None, 5.0, "step 10 ms"),
)
PROVED_WITH = (
    Case("hoist", {DRUM: WINCH | BRAKED}, name="a brake closes"),
    Case("hoist", {DRUM: WINCH | HELD}, name="a winch that holds its tension"),
    Case("hoist", {MASS: "11 t", PAY_OUT: ramp(-0.3), LAW: "capstan", FRICTION: 0.12}, name="11 t, friction 0.12"),
    Case("hoist", {MASS: "2 t", HEAVE: sea(1.8, 6.0, 11), PAY_OUT: stop(-0.6, 4.0, 0.3)}, name="2 t, a sea, a stop"),
    Case("hoist", {MASS: "9 t", PAY_OUT: ramp(-1.0), RELEASE: DROPS, RHO: 0.8}, name="9 t drop, rho_inf 0.8"),
    Case("hoist", {MASS: "1.5 t", PAY_OUT: ramp(-1.5), BEARING: RUBS, STEP: "12.5 ms"}, name="1.5 t, step 12.5 ms"),
    Case("hoist", {DAMPING: 1e-3, HEAVE: sea(2.0, 5.5, 5), PAY_OUT: ramp(-0.4)}, name="damping 1 ms, a sea"),
    Case("hoist", {HEAVE: waves(1.0, 5.0), STEP: "2.5 ms", RHO: 0.95}, name="step 2.5 ms, rho_inf 0.95"),
    Case("hookblock", {VESSEL: on(waves(2.5, 3.2)), PAY_OUT: ramp(-0.2)}, name="waves of 2.5 m"),
    Case("hookblock", {VESSEL: on(sea(2.5, 6.5, 21)), PAY_OUT: ramp(-0.6), STEP: "2.5 ms"}, name="a sea, step 2.5 ms"),
    Case("hookblock", {MASS: "1.7 t", PAY_OUT: stop(-1.5, 3.5, 0.3), DAMPING: 1e-3}, name="1.7 t, a stop"),
    Case(
        "hookblock",
        {MASS: "3.7 t", PAY_OUT: ramp(0.5), VESSEL: on(waves(0.6, 7.0)), HOOK_FRICTION: 0.2, STEP: "10 ms"},
        name="3.7 t, step 10 ms",
    ),
    Case("hookblock", {VESSEL: on(waves(0.7, 8.0)), STEP: "auto", PAY_OUT: ramp(-0.8)}, name="step: auto"),
    Case("slewing", {MASS: "0.7 t", SLEW: {"rate": 0.5, "over": 1.5}, RHO: 0.3}, name="0.7 t, 0.5 rad/s, rho_inf 0.3"),
    Case(
        "slewing", {MASS: "7 t", SLEW: {"rate": 0.3, "over": 0.8}, LAW: "capstan", FRICTION: 0.1}, name="7 t, friction"
    ),
    Case("slewing", {MASS: "3 t", RELEASE: {"at": 5.0, "remaining": 400}, STEP: "10 ms"}, name="3 t drop, step 10 ms"),
    Case("slewing", {DAMPING: 1e-2, SLEW: {"rate": 0.4, "over": 2.0}}, name="damping 10 ms"),
    Case("slewing", {STEP: "25 ms", SLEW: {"rate": 0.2, "over": 1.0}}, name="step 25 ms"),
    Case("landing", {MASS: "240 t", FRICTION: 0.2, DAMPING: 1e-3}, None, 25.0, "240 t, friction 0.2"),
    Case("landing", {MASS: "60 t", HEAVE: waves(1.2, 7.0)}, None, 25.0, "60 t, waves of 1.2 m"),
    Case("landing", {HEAVE: sea(3.0, 8.0, 31), STEP: "25 ms"}, None, 25.0, "a sea of 3 m, step 25 ms"),
    Case("sixteen_falls", {MASS: "160 t", PAY_OUT: ramp(-0.5)}, None, 5.0, "160 t"),
    Case("sixteen_falls", {MASS: "40 t", PAY_OUT: stop(-2.0, 3.0, 0.1)}, None, 6.0, "40 t, a stop"),
    Case("sixteen_falls", {PAY_OUT: ramp(1.0), STEP: "12.5 ms", RHO: 0.8}, None, 5.0, "lowered, step 12.5 ms"),
)
