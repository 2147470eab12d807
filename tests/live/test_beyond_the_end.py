"""How far a live simulation goes: past the scene's end where all moves by formulas, and no further than a record."""

import numpy as np
import pytest
from physics.lifting.crane_scenes import body, crane, drum, end

import tautline
from tautline.live.errors import SimulationError

SEA = {"spectrum": {"significant_height": 2.0, "peak_period": 6.0, "seed": 3, "ramp": 2.0}}
WAVE = {"harmonic": {"amplitude": 1.0, "period": 6.0, "ramp": 2.0}}
GROWING = {"harmonic": {"amplitude": 0.5, "period": 6.0, "ramp": 2.0}}


def on_a_vessel(motion, until=4.0, **more):
    vessel = {"reference": [0, 0, 0], "motion": motion}
    drive = more.pop("drive", {})
    path = [drum((0.0, 0.0, 30.0), **drive), end("payload")]
    load = [body("payload", 2000.0, [0.3, 0.0, -20.0])]
    solver = {"end": until, "step": 0.01}
    return crane(path, load, vessel=vessel, mesh={"elements_per_span": 2}, solver=solver, interval=0.1, **more)


@pytest.fixture
def record(tmp_path):
    """A record of 5 s of heave."""
    t = np.linspace(0.0, 5.0, 51)
    rows = [f"{x},0,0,{np.sin(x)},0,0,0" for x in t]
    head = "t [s],surge [m],sway [m],heave [m],roll [deg],pitch [deg],yaw [deg]"
    (tmp_path / "mru.csv").write_text("\n".join([head, *rows]))
    return {"file": str(tmp_path / "mru.csv"), "ramp": 1.0}


PREPARED = {
    "an actuator with limits": (
        on_a_vessel({"heave": WAVE}, heave_compensation={"gain": 1.0, "limits": {"stroke": 0.5}}), 4.0, "heave_comp",
    ),
    "a speed that is integrated by numbers": (
        on_a_vessel({}, drive={"speed": GROWING}), 4.0, "drum.speed",
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", PREPARED)
def test_what_was_computed_ahead_is_not_gone_past(what):
    scene, last, word = PREPARED[what]
    sim = tautline.Simulation(scene)
    sim.advance_to(last)
    before = sim["payload.position"].copy()
    for ask in (lambda: sim.advance(0.1), lambda: sim.advance_to(last + 0.1)):
        with pytest.raises(SimulationError, match=rf"{word}.* is known up to 4 s only; .*solver.end"):
            ask()
    assert sim.time == last and np.array_equal(sim["payload.position"], before) and not sim.stopped


def test_a_record_is_gone_on_with_past_the_end_of_the_scene_up_to_its_own(record):
    sim = tautline.Simulation(on_a_vessel(record))
    sim.advance_to(5.0)
    assert sim["winch.position"][2] == pytest.approx(30.0 + np.sin(5.0), abs=1e-4)
    with pytest.raises(SimulationError, match=r"vessel.motion.heave is known up to 5 s only"):
        sim.advance(0.1)


def test_a_motion_that_is_driven_in_place_of_the_record_goes_on(record):
    sim = tautline.Simulation(on_a_vessel(record))
    sim.advance_to(5.0)
    sim.inputs["vessel.heave"] = 0.5
    sim.advance_to(7.0)
    assert sim["winch.position"][2] == pytest.approx(30.5)


@pytest.mark.parametrize("heave", [SEA, WAVE], ids=["sea", "wave"])
def test_waves_are_functions_of_any_time_and_go_on_past_the_end(heave):
    sim, longer = (tautline.Simulation(on_a_vessel({"heave": heave}, until)) for until in (4.0, 9.0))
    sim.advance_to(9.0)
    longer.advance_to(9.0)
    assert np.allclose(sim["payload.position"], longer["payload.position"], atol=1e-9)
