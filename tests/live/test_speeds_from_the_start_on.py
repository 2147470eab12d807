"""Inputs that are held from the start on: all of a string, or of a rope that flows, has their speeds at once."""

import zipfile
from pathlib import Path

import numpy as np
import pytest

import tautline
from tautline.live.errors import SimulationError

DATA = Path(__file__).parents[2] / "data"
SPEED, BLOCK = "top.rotary_speed", "top.block_speed"
CASES = {
    "hanging": (SPEED, 10.0, {"top": {"rotation": {"constant": 10.0}}}),
    "whirl": (SPEED, 8.0, {"top.rotation": {"constant": 8.0}}),
    "drilling": (SPEED, 8.0, {"top.rotation.controller.speed": {"constant": 8.0}}),
    "tripping": (BLOCK, 0.2, {"top.block.velocity": {"constant": 0.2}}),
}


def string(name, kind):
    """A shipped drill string, as lumps or as a beam."""
    scene = tautline.read(DATA / f"{name}.yaml")
    model = {key: value for key, value in scene.document.root["model"].items() if key != "bending"}
    return scene if kind == "lumped" else scene.replace({"model": {**model, "kind": kind}})


def frames_of(sim, end):
    sim.advance_to(end)
    found = sim.result
    return {name: np.asarray(found[name]) for name in found if np.asarray(found[name]).dtype.kind == "f"}


@pytest.mark.parametrize("kind", ["lumped", "ale-ancf"])
@pytest.mark.parametrize("name", CASES)
def test_a_string_whose_top_is_held_at_a_speed_starts_as_with_that_constant_speed_in_the_scene(name, kind):
    key, speed, changes = CASES[name]
    scene = string(name, kind)
    found = frames_of(tautline.Simulation(scene, [key], initial={key: speed}), 0.05)
    wanted = frames_of(tautline.Simulation(scene.replace(changes), [key]), 0.05)
    for variable, values in wanted.items():
        size = np.abs(values).max(initial=0.0)
        np.testing.assert_allclose(found[variable], values, rtol=0.0, atol=1e-9 * size, err_msg=variable)


@pytest.mark.parametrize("kind", ["lumped", "ale-ancf"])
def test_a_free_string_that_turns_as_a_whole_from_the_start_on_has_no_torque(kind):
    """Without mud and wall nothing holds it. With its top alone at 10 rad/s it would have 20 kN m."""
    scene = string("hanging", kind)
    assert scene.well.wall is None
    found = frames_of(tautline.Simulation(scene, [SPEED], initial={SPEED: 10.0}), 0.5)
    assert np.abs(found["surface_torque"]).max() < 1e-3
    np.testing.assert_allclose(found["rotation_rate"], 10.0, rtol=1e-9)


def test_a_copy_and_a_restored_simulation_go_on_from_speeds_of_the_start():
    sim = tautline.Simulation(DATA / "whirl.yaml", initial={SPEED: 8.0})
    copy, restored = sim.copy(), tautline.Simulation(DATA / "whirl.yaml")
    restored.restore(sim.save())
    torques = []
    for one in (sim, copy, restored):
        one.advance_to(0.05)
        torques.append(one["surface_torque"])
    assert torques[0] == torques[1] == torques[2]


def test_a_string_that_starts_straight_is_not_wound_up_by_an_angle_at_its_top():
    scene = string("hanging", "lumped").replace({"start": "straight"})
    with pytest.raises(SimulationError, match=r"top.rotary_angle = 1 cannot be at the start.*give 0"):
        tautline.Simulation(scene, [SPEED], initial={"top.rotary_angle": 1.0})


@pytest.mark.parametrize("fmi", [2, 3])
def test_an_fmu_whose_host_sets_a_speed_before_the_start_has_no_shock(fmi, tmp_path):
    """The host is FMPy; the reference is the scene with that constant speed."""
    fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed")
    pytest.importorskip("pythonfmu" if fmi == 2 else "pythonfmu3", reason="what writes FMUs is not installed")
    from tautline.live.fmu.writing import write_fmu

    unit = tmp_path / "whirl.fmu"
    write_fmu(DATA / "whirl.yaml", unit, [SPEED], ["surface_torque"], fmi=fmi)
    assert zipfile.is_zipfile(unit)
    rows = np.zeros(6, dtype=[("time", "f8"), (SPEED, "f8")])
    rows["time"], rows[SPEED] = 0.02 * np.arange(6), 8.0
    ran = fmpy.simulate_fmu(
        str(unit), start_time=0.0, stop_time=0.1, step_size=0.02, output_interval=0.02, input=rows,
        output=["surface_torque"],
    )  # fmt: skip
    steady = tautline.Simulation(string("whirl", "lumped").replace({"top.rotation": {"constant": 8.0}}))
    wanted = []
    for k in range(6):
        if k:
            steady.advance_to(0.02 * k)
        wanted.append(steady["surface_torque"])
    np.testing.assert_allclose(ran["surface_torque"], wanted, rtol=0.0, atol=1e-6)


NODE = (
    "  - Node7Dof: {{id: {k}, xyz: [{x}, 0, 0], xyz_d: [1, 0, 0], BC: [{h}, {h}, {h}, 0, 0, 0, 1], "
    "BC_functions: [0, 0, 0, 0, 0, 0, {f}]}}\n"
)


def driven_through(speed):
    """A rope between two points, driven along itself: at every node a motion of its own, all at one speed at first."""
    text = "CableModelMaterial: {Gravity: [0.0, 0.0, -9.81]}\nCableModel:\n"
    for k in range(5):
        text += NODE.format(k=k, x=0.5 * k, h=int(k in (0, 4)), f=k + 1)
    for k in range(4):
        text += f"  - CableALEelement: {{id: {k}, nodes7: [{k}, {k + 1}], EA: 1000.0, EJ: 0.1, rhoA: 1.0}}\n"
    for k in range(5):
        rates = f"timeList: [0, 50, 100], velocityList: [{speed}, {speed}, {0.001 * k}]"
        text += f"  - Function_VelocityDefined: {{id: {k + 1}, pos0: {0.495 * k}, {rates}}}\n"
    text += "GeneralizedAlpha: {type: G-alpha, rho_inf: 0.6, eps_energy: 1.0e-8, maxIter: 20, massDamp: 0.0, "
    return tautline.read(text + "time_step: 0.005, time_end: 10.0, plotpoints: 50, skipVTK: True, start: static}\n")


def test_a_rope_whose_motions_are_held_at_one_speed_flows_on_from_the_start():
    """The reference is the scene whose motions have that speed: the rope is at rest in its curve."""
    held = {f"function {k}.rate": 2.0 for k in range(1, 6)}
    found = frames_of(tautline.Simulation(driven_through(0.0), initial=held), 0.1)
    wanted = frames_of(tautline.Simulation(driven_through(2.0)), 0.1)
    np.testing.assert_allclose(found["axial_force"], wanted["axial_force"], rtol=1e-9)


def test_a_motion_given_by_its_speed_starts_at_no_other_place_than_zero():
    """One node would be elsewhere at the start, and the rope stay as it is drawn."""
    scene = DATA / "reeled_span.yaml"
    with pytest.raises(SimulationError, match=r"function 1 = 0.1 cannot be at the start.*give 0.*the speed"):
        tautline.Simulation(scene, initial={"function 1": 0.1})
    assert tautline.Simulation(scene, initial={"function 1": 0.0})["axial_force"] is not None


@pytest.mark.parametrize(("span", "count"), [(0.2, 5), (0.3, 7), (0.35, 8), (1.0, 21)])
def test_frames_of_the_last_seconds_are_as_many_at_any_time(span, count):
    """A frame that is as old as the span is kept, whatever the rounding of its time is."""
    sim = tautline.Simulation(DATA / "hoist.yaml", keep=span)
    counts = set()
    for k in range(60):
        sim.advance(0.05)
        if k >= 25:
            counts.add(len(sim.result["time"]))
    assert counts == {count}
