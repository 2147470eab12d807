"""Inputs that are held from the start on: a scene is drawn, sought and judged with what they are held at."""

from pathlib import Path

import numpy as np
import pytest
from physics.test_starts_beyond_the_second_load import FIRST, HOSE, sag

import tautline
from tautline.live.errors import SimulationError

DATA = Path(__file__).parents[2] / "data"
SPEED = "water.speed"
FALLS = "starts from an unstable equilibrium"


def bow(sim):
    place = sim["position"]
    return float(np.hypot(place[:, 1], place[:, 2]).max())


def hose(coupling, speed):
    return tautline.read(HOSE.replace("coupling: linear", f"coupling: {coupling}").replace("10}", f"{speed}}}"))


@pytest.mark.parametrize("coupling", ["linear", "lagrange", "penalty", "augmented"])
def test_a_hose_is_judged_at_the_speed_at_which_its_water_is_held_from_the_start(coupling):
    """Water at 10 m/s presses it by M U^2 beyond Euler's first load, and at 0.1 m/s it stays straight."""
    bent = tautline.Simulation(hose(coupling, 0.1), initial={SPEED: 10.0})
    assert bow(bent) == pytest.approx(sag(50.0 - FIRST), rel=2e-3)
    assert [told for told in bent.result.warnings if "unstable equilibrium" in told]
    straight = tautline.Simulation(hose(coupling, 10), initial={SPEED: 0.1})
    assert bow(straight) < 1e-9 and not straight.result.warnings


FREE = """
hose: {length: 1, elements: 8, axial_stiffness: 1.0e3, bending_stiffness: 0.05, mass_per_length: 0.5,
       direction: [0, 0, 1]}
water: {mass_per_length: 0.5, speed: SPEED}
gravity: [0, 0, -9.81]
start: static
disturbance: [0.01, 0, 0]
solver: {method: generalized-alpha, rho_inf: 0.9, step: 1 ms, end: 0.02}
output: {interval: 0.01}
"""


@pytest.mark.parametrize(("written", "held", "falls"), [(0.0, 1e-3, True), (1e-3, 0.0, False)])
def test_a_hose_with_a_free_end_is_said_to_fall_at_the_speed_at_which_its_water_is_held(written, held, falls):
    """Upright it weighs 196 EJ / L^2: Greenhill's weight is 7.8 of these. Without flow it begins in a hanging shape."""
    sim = tautline.Simulation(tautline.read(FREE.replace("SPEED", str(written))), initial={SPEED: held})
    sim.inputs[SPEED] = written  # what comes later changes nothing of the start
    sim.advance(0.01)
    assert any(FALLS in told for told in sim.result.warnings) == falls


NODE = (
    "  - Node7Dof: {{id: {k}, xyz: [{x}, 0, 0], xyz_d: [1, 0, 0], BC: [{h}, {h}, {h}, 0, 0, 0, 1], "
    "BC_functions: [0, 0, {z}, 0, 0, 0, {p}]}}\n"
)


def span(start, place=0.0, follows="z"):
    """A rope between two points; the height of the second, or its p, goes by a velocity."""
    text = "CableModelMaterial: {Gravity: [0.0, 0.0, -9.81]}\nCableModel:\n"
    for k in range(9):
        last = int(k == 8)
        text += NODE.format(k=k, x=0.245 * k, h=int(k in (0, 8)), z=last * (follows == "z"), p=last * (follows == "p"))
    for k in range(8):
        text += f"  - CableALEelement: {{id: {k}, nodes7: [{k}, {k + 1}], EA: 1.0e4, EJ: 1.0e-3, rhoA: 1.0}}\n"
    begins = place if follows == "z" else 1.96
    text += f"  - Function_VelocityDefined: {{id: 1, pos0: {begins}, timeList: [0, 1, 2], velocityList: [0, 0, 0]}}\n"
    text += "GeneralizedAlpha: {type: G-alpha, rho_inf: 0.6, eps_energy: 1.0e-8, maxIter: 20, massDamp: 0.0, "
    text += f"time_step: 0.005, time_end: 2.0, plotpoints: 50, skipVTK: True, start: {start}}}\n"
    return tautline.read(text)


@pytest.mark.parametrize("start", ["static", "relaxed"])
def test_a_rope_is_brought_to_rest_with_its_end_where_it_is_held_from_the_start(start):
    """It hangs as one that is drawn with its end there, and stays so."""
    held = tautline.Simulation(span(start), initial={"function 1": 0.3})
    drawn = tautline.Simulation(span(start, 0.3))
    assert held["position"][-1, 2] == pytest.approx(0.3, abs=1e-12)
    np.testing.assert_allclose(held["position"], drawn["position"], rtol=0.0, atol=1e-6)
    before = held["position"].copy()
    held.advance(0.2)
    np.testing.assert_allclose(held["position"], before, rtol=0.0, atol=1e-5)


@pytest.mark.parametrize(("start", "follows"), [("as given", "z"), ("static", "p"), ("relaxed", "p")])
def test_a_rope_that_would_stay_as_drawn_beside_what_is_held_elsewhere_is_refused(start, follows):
    with pytest.raises(SimulationError, match=r"function 1 = 0.3 cannot be at the start.*give 0"):
        tautline.Simulation(span(start, follows=follows), initial={"function 1": 0.3})


CRANE = {"vessel.heave": (1.0, {"heave": {"constant": 1.0}}), "vessel.roll": (0.05, {"roll": {"constant": 0.05}})}


@pytest.mark.parametrize("start", ["as drawn", "static"])
@pytest.mark.parametrize("key", CRANE)
def test_a_crane_is_drawn_with_its_vessel_where_it_is_held_from_the_start(key, start):
    """The reference is the vessel that lies there. Of a rope drawn elsewhere a metre was stretch: 18 MN."""
    value, motion = CRANE[key]
    hoist = tautline.read(DATA / "hoist.yaml")
    held = tautline.Simulation(hoist.replace({"start": start}), [key], initial={key: value})
    lies = tautline.Simulation(hoist.replace({"start": start, "vessel.motion": motion}))
    weight = 5000.0 * 9.81
    assert held["tension"].max() < (0.01 if start == "as drawn" else 1.1) * weight
    # what the rest of the scene moves by begins with a ramp
    np.testing.assert_allclose(held["tension"], lies["tension"], rtol=1e-9)
    held.advance(0.05)
    lies.advance(0.05)
    np.testing.assert_allclose(held["tension"], lies["tension"], rtol=1e-4)
