"""A simulation that is stepped: what `simulate` gives, states that are saved, inputs that never jump."""

import gc
import multiprocessing
import pickle
import tracemalloc
from copy import deepcopy
from pathlib import Path

import numpy as np
import pytest

import tautline
from tautline.integrators.status import StoppedEarly
from tautline.kernels.time_function import value_at
from tautline.live.errors import SimulationError, UnknownName
from tautline.scene.errors import SceneError

DATA = Path(__file__).parents[2] / "data"
SHORT = {
    "hoist": 3.0, "slewing": 2.0, "landing": 4.0, "sixteen_falls": 1.0, "hookblock": 2.0, "jwell": 3.0, "drilling": 3.0,
    "tripping": 1.0, "whirl": 0.5, "field_well": 1.0, "configuration_a": 0.01, "hose": 0.5, "cantilever_bar": 3.0,
    "reeled_span": 0.5, "hanging": 0.5,
}  # fmt: skip
"""Shipped scenes, and until when they are run here, s."""


def scene_of(name, end=None):
    scene = tautline.read(DATA / f"{name}.yaml")
    from tautline.application.installed import Installed

    return Installed().of(scene).with_overrides(scene, end=end)


def same(one, other, names=None):
    for name in names or one.variables:
        a, b = np.asarray(one[name]), np.asarray(other[name])
        assert np.array_equal(a, b, equal_nan=a.dtype.kind == "f"), name


@pytest.mark.parametrize("name", SHORT)
def test_stepped_by_the_output_interval_a_scene_gives_what_simulate_gives_to_the_bit(name):
    scene = scene_of(name, SHORT[name])
    whole = tautline.simulate(scene)
    sim = tautline.Simulation(scene)
    for time in whole["time"][1:]:
        sim.advance_to(float(time))
    same(whole, sim.result)
    assert sim.result.headline == whole.headline


def test_frames_are_kept_at_the_times_of_the_output_however_the_steps_are_taken():
    sim = tautline.Simulation(scene_of("hoist"))
    for _ in range(40):
        sim.advance(0.02)
    assert np.allclose(sim.result["time"], 0.05 * np.arange(17), atol=1e-12)
    assert sim.time == pytest.approx(0.8, abs=1e-12)
    coarse = tautline.simulate(scene_of("hoist", 0.8))
    # Steps of 5 ms all the same: 20 ms are four of them.
    assert np.allclose(sim.result["body_position"], coarse["body_position"], atol=1e-9)


def _go_on(packed, queue):
    sim = tautline.Simulation(scene_of("landing"))
    sim.restore(pickle.loads(packed))
    sim.advance(1.0)
    queue.put((sim.time, sim["position"], sim["max_tension"]))


def test_a_state_saved_in_one_process_goes_on_in_another_to_the_bit():
    sim = tautline.Simulation(scene_of("landing"))
    sim.advance(2.0)
    packed = pickle.dumps(sim.save())
    context = multiprocessing.get_context("spawn")
    queue = context.Queue()
    process = context.Process(target=_go_on, args=(packed, queue))
    process.start()
    time, position, tension = queue.get(timeout=300)
    process.join()
    sim.advance(1.0)
    assert time == sim.time and tension == sim["max_tension"] and np.array_equal(position, sim["position"])


MIDDLES = {
    "slip and stick along the wall": ("jwell", 7.3),
    "stick-slip of a bit, with the delay of its blades": ("drilling", 6.1),
    "contact with the wall all around": ("whirl", 0.31),
    "a landed load, slack rope, a capstan that slips": ("landing", 45.0),
    "a fluttering hose": ("hose", 0.4),
}


@pytest.mark.parametrize("what", MIDDLES)
def test_a_state_restored_in_the_middle_of_a_law_goes_on_to_the_bit(what):
    name, time = MIDDLES[what]
    sim = tautline.Simulation(scene_of(name), keep=False)
    sim.advance_to(time)
    state = sim.save()
    ahead = 20 * sim.model.solver.interval
    sim.advance(ahead)
    first = {name: sim[name] for name in sim.outputs}
    sim.restore(state)
    assert sim.time == state.time
    sim.advance(ahead)
    for key, value in first.items():
        assert np.array_equal(value, sim[key], equal_nan=True), key
    other = sim.copy()
    sim.advance(ahead)
    other.advance(ahead)
    for key in sim.outputs:
        assert np.array_equal(other[key], sim[key], equal_nan=True), key


def test_going_back_drops_the_frames_after_it_and_goes_on_as_if_they_had_not_been():
    scene = scene_of("hoist", 1.0)
    sim = tautline.Simulation(scene)
    sim.advance(0.5)
    state = sim.save()
    sim.advance(0.4)
    sim.restore(state)
    assert sim.result["time"][-1] == pytest.approx(0.5)
    sim.advance_to(1.0)
    same(tautline.simulate(scene), sim.result, ["time", "position", "tension"])


def test_inputs_never_jump_whatever_they_are_given_and_whenever():
    """Value, rate and second rate on both sides of every advance."""
    sim = tautline.Simulation(scene_of("hoist"), inputs=["winch.pay_out", "vessel.heave", "vessel.roll"], keep=False)
    rng = np.random.default_rng(5)
    # Of a position and its own speed one is given.
    named = [name for name in sim.inputs if not name.startswith("vessel.") or not name.endswith("_speed")]
    numbers = {name: sim.inputs._inputs[name].members[0][1] for name in named}
    functions = sim.model.system.functions
    for _ in range(200):
        before = {name: value_at(functions, k, sim.time) for name, k in numbers.items()}
        for name in numbers:
            size = 1e-3 if name != "winch.pay_out_speed" else 0.05
            if rng.random() < 0.3 and not (name == "winch.pay_out_speed" and sim.inputs.memory[0, 4] == 3.0):
                sim.inputs[name] = size * rng.normal() if rng.random() < 0.5 else (size * rng.normal(), size)
        begin, h = sim.time, float(rng.choice([0.005, 0.013, 0.02]))
        sim.inputs.write(begin, begin + h)
        for name, k in numbers.items():
            after = value_at(functions, k, begin)
            for order, (a, b) in enumerate(zip(before[name], after, strict=True)):
                assert abs(a - b) < 1e-9 * h ** (-order), (name, order)
        sim._time = begin + h  # only the functions are of interest here


def test_an_input_is_reached_at_the_end_of_the_next_advance_and_kept():
    sim = tautline.Simulation(scene_of("hoist"), inputs=["winch.pay_out"])
    out = sim.inputs["winch.pay_out"]
    sim.inputs["winch.pay_out"] = out - 0.01
    sim.advance(0.1)
    assert sim["winch.pay_out"] == pytest.approx(out - 0.01, abs=1e-12)
    assert sim["winch.pay_out_speed"] == pytest.approx(0.0, abs=1e-9)
    sim.advance(0.1)
    assert sim["winch.pay_out"] == pytest.approx(out - 0.01, abs=1e-12)


def test_a_ramp_fed_in_by_value_and_rate_ends_where_the_ramp_of_the_scene_does():
    scene = scene_of("hoist", 3.0)
    whole = tautline.simulate(scene)
    sim = tautline.Simulation(scene)
    while sim.time < 3.0 - 1e-9:
        x = min(sim.time + 0.01, 1.0)
        speed = -2.0 * x**3 * (10.0 - 15.0 * x + 6.0 * x * x), -60.0 * (x * (1.0 - x)) ** 2
        sim.inputs["winch.pay_out_speed"] = speed
        sim.advance(0.01)
    assert np.abs(sim.result["body_position"] - whole["body_position"]).max() < 1e-8
    assert np.abs(sim.result["tension"] / whole["tension"] - 1.0).max() < 1e-6


def test_a_moving_vessel_fed_in_moves_the_tip_as_that_of_the_scene():
    scene = scene_of("hoist", 4.0)
    whole = tautline.simulate(scene)
    sim = tautline.Simulation(scene)
    w = 2.0 * np.pi / 8.0
    while sim.time < 4.0 - 1e-9:
        t = sim.time + 0.01
        x = t / 8.0
        e, de = x**3 * (10.0 + x * (6.0 * x - 15.0)), 30.0 * (x * (1.0 - x)) ** 2 / 8.0
        dde = 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / 64.0
        s, c = 0.5 * np.sin(w * t), 0.5 * w * np.cos(w * t)
        sim.inputs["vessel.heave"] = e * s, de * s + e * c, dde * s + 2.0 * de * c - e * w * w * s
        sim.advance(0.01)
    assert np.abs(sim.result["body_position"] - whole["body_position"]).max() < 1e-8


def test_a_parameter_changed_is_what_a_scene_with_that_number_is():
    """The hose begins as it is drawn, so that nothing of the start depends on its stiffness."""
    import yaml

    written = yaml.safe_load((DATA / "hose.yaml").read_text())
    sim = tautline.Simulation(scene_of("hose"))
    sim.parameters["hose.bending_stiffness"] = 0.0015
    sim.parameters["hose.axial_stiffness"] = 20.0
    sim.advance_to(0.3)
    written["hose"] |= {"bending_stiffness": 0.0015, "axial_stiffness": 20.0}
    written["solver"]["end"] = 0.3
    from gardenhose.scene import HoseScene

    other = tautline.simulate(HoseScene.parse(yaml.safe_dump(written)))
    assert np.abs(other["tip"][-1] - sim["tip.position"]).max() < 1e-6 * 0.5


OUTLET = """
CableModelMaterial: {Gravity: [0, 0, -9.81]}
CableModel:
  - Node7Dof: {id: 0, xyz: [0, 0, 0], xyz_d: [1, 0, 0], BC: [1, 1, 1, 1, 1, 1, 1], p: 0}
  - Node7Dof: {id: 1, xyz: [1, 0, 0], xyz_d: [1, 0, 0], BC: [0, 0, 0, 0, 0, 0, 1], p: 1}
  - Node7Dof: {id: 2, xyz: [2, 0, 0], xyz_d: [1, 0, 0], BC: [1, 1, 1, 0, 0, 0, 0], p: 2}
  - CableALEelement: {id: 0, nodes7: [0, 1], EA: 1.0e5, EJ: 10, rhoA: 1, cDamp: 0.001, strain: engineering}
  - CableALEelement: {id: 1, nodes7: [1, 2], EA: 1.0e5, EJ: 10, rhoA: 1, cDamp: 0.001, strain: engineering}
  - OneNodeSpring: {id: 1, nodes7: [1], stiffness: 100.0, damping: 0.02}
  - PointMass: {id: 0, nodes7: [1], mass: 0.5}
GeneralizedAlpha: {type: G-alpha, rho_inf: 0.8, time_step: 0.001, time_end: 0.2}
"""


def test_stiffnesses_of_cables_that_bend_and_flow_past_springs_are_what_a_scene_with_those_numbers_has():
    """Material flows out of the last element: forces of its end have the stiffnesses too."""
    sim = tautline.Simulation(OUTLET)
    for name, value in (("axial_stiffness", 2e4), ("bending_stiffness", 30.0), ("damping", 0.002)):
        sim.parameters[f"cables.{name}"] = value
    sim.advance_to(0.2)
    other = tautline.simulate(
        OUTLET.replace("1.0e5", "2.0e4").replace("EJ: 10", "EJ: 30").replace("0.001, strain", "0.002, strain")
    )
    assert np.abs(other["position"][-1, 1] - sim["node 1.position"]).max() < 1e-9
    assert abs(other["position"][-1, 1, 2]) > 0.01


def test_a_force_may_be_added_at_a_node_of_a_cable():
    """A free mass on a rope of nothing: F t^2 / (2 m). The force is new at t = 0, and acts from then on."""
    text = """
CableModelMaterial: {Gravity: [0, 0, 0]}
CableModel:
  - Node4Dof: {id: 3, xyz: [0, 0, 0], BC: [1, 1, 1, 1]}
  - Node4Dof: {id: 7, xyz: [1, 0, 0], BC: [0, 0, 0, 1]}
  - CableALEelementLin: {id: 0, nodes4: [3, 7], EA: 1.0e-9, rhoA: 1.0e-9}
  - PointMass: {id: 0, nodes4: [7], mass: 2.0}
GeneralizedAlpha: {type: G-alpha, rho_inf: 0.8, time_step: 0.001, time_end: 1}
"""
    sim = tautline.Simulation(text)
    sim.add_force(lambda t, q, v: np.array([0.0, 3.0, 0.0]), on="node 7.position")
    sim.advance_to(0.5)
    assert sim["node 7.position"] == pytest.approx([1.0, 3.0 * 0.5**2 / (2.0 * 2.0), 0.0], abs=1e-6)


def test_the_mass_of_a_load_changes_its_weight():
    sim = tautline.Simulation(scene_of("hoist"))
    sim.parameters["payload.mass"] = 6000.0
    assert sim.parameters["payload.mass"] == 6000.0
    sim.inputs["winch.pay_out"] = 0.0
    rope = sim["winch.tension"] - 5000.0 * 9.81
    sim.advance(20.0)
    times = []
    for _ in range(200):
        sim.advance(0.02)
        times.append(sim["winch.tension"])
    assert np.mean(times) == pytest.approx(6000.0 * 9.81 + rope, rel=0.05)


def test_what_a_parameter_puts_into_the_scene_as_it_changes_is_work_from_outside():
    """20 % more mass at a height, and with a speed, have 20 % more energy; the run accounts for them."""
    sim = tautline.Simulation(scene_of("hoist"))
    sim.advance_to(2.0)
    before, work = (sim.result[name][-1] for name in ("potential_energy", "external_work"))
    sim.parameters["payload.mass"] = 1.2 * sim.parameters["payload.mass"]
    sim.advance_to(4.0)
    result = sim.result
    assert result.attributes["energy_error"] < 1e-3
    assert not any("unaccounted" in told for told in result.warnings)
    assert result["external_work"][-1] != work and np.isfinite(before)


@pytest.mark.parametrize(("name", "value"), [("payload.mass", 4000.0), ("rope.axial_stiffness", 4.0e7)])
def test_a_parameter_given_for_the_start_puts_nothing_in(name, value):
    sim = tautline.Simulation(scene_of("hoist"), parameters={name: value})
    sim.advance_to(1.0)
    assert sim.parameters[name] == value
    assert sim.result["external_work"][0] == 0.0
    assert sim.result.attributes["energy_error"] < 1e-3


def test_the_mass_of_a_load_can_be_changed_before_and_after_a_part_of_it_is_let_go():
    scene = deepcopy(tautline.read(DATA / "hoist.yaml").document.root)
    scene["bodies"][0]["release"] = {"at": 2.0, "remaining": 2000}
    scene["path"][0]["drum"]["pay_out"] = 0.0
    sim = tautline.Simulation(scene)
    rope = sim["winch.tension"] - 5000.0 * 9.81
    sim.advance_to(1.0)
    sim.parameters["payload.mass"] = 4000.0
    with pytest.raises(SimulationError, match="at least 2000"):
        sim.parameters["payload.mass"] = 1999.0
    assert sim.parameters["payload.mass"] == 4000.0
    sim.advance_to(3.0)
    assert sim.parameters["payload.mass"] == 2000.0
    sim.parameters["payload.mass"] = 2500.0
    sim.advance_to(25.0)
    assert sim.parameters["payload.mass"] == 2500.0
    assert np.mean(sim.result["drum_tension"][-100:]) == pytest.approx(2500.0 * 9.81 + rope, rel=0.05)
    assert sim.result.attributes["energy_error"] < 1e-3


@pytest.mark.parametrize("share", [-0.1, 1.1, 2.0])
def test_a_brake_is_closed_from_not_at_all_to_wholly(share):
    scene = deepcopy(tautline.read(DATA / "hoist.yaml").document.root)
    drum = scene["path"][0]["drum"]
    drum.pop("pay_out")
    drum |= {"torque": {"constant": 0}, "inertia": 200, "brake": {"torque": "100 kN m", "closed": {"constant": 1.0}}}
    sim = tautline.Simulation(scene)
    sim.inputs["winch.brake"] = 1.0
    with pytest.raises(SimulationError, match=r"is not from 0 to 1; it is how far the brake is closed"):
        sim.inputs["winch.brake"] = share
    assert sim.inputs["winch.brake"] == 1.0
    drum["brake"]["closed"] = {"constant": share}
    with pytest.raises(SceneError, match=r"closed.*give a share from 0, open, to 1, closed"):
        tautline.Simulation(scene)


BAD = {
    "an unknown input": (lambda s: s.inputs.__setitem__("winch.payout", 1.0), UnknownName, "mean 'winch.pay_out'"),
    "an unknown output": (lambda s: s["payload.pos"], UnknownName, "did you mean 'payload.position'"),
    "an unknown parameter": (lambda s: s.parameters["payload.mas"], UnknownName, "did you mean 'payload.mass'"),
    "a value that is none": (lambda s: s.inputs.__setitem__("winch.pay_out", np.nan), SimulationError, "finite number"),
    "a vector": (lambda s: s.inputs.__setitem__("winch.pay_out", np.zeros(5)), SimulationError, "finite number"),
    "a text": (lambda s: s.inputs.__setitem__("winch.pay_out", "1 m"), SimulationError, "give a value in m"),
    "a negative mass": (lambda s: s.parameters.__setitem__("payload.mass", -1.0), SimulationError, "more than 0"),
    "a mass that is no number": (lambda s: s.parameters.__setitem__("payload.mass", "x"), SimulationError, "no number"),
    "no time": (lambda s: s.advance(0.0), SimulationError, "above zero"),
    "time going back": (lambda s: s.advance_to(0.1), SimulationError, "later time"),
    "the time now": (lambda s: s.advance_to(s.time), SimulationError, "is the time now"),
    "the time now within rounding": (lambda s: s.advance_to(np.nextafter(s.time, 9)), SimulationError, "the time now"),
    "a time within rounding": (lambda s: s.advance(1e-13), SimulationError, "too short to go on by"),
    "a time that is none": (lambda s: s.advance(np.nan), SimulationError, "above zero"),
    "an endless time": (lambda s: s.advance_to(np.inf), SimulationError, "later time"),
    "no state": (lambda s: s.restore(None), SimulationError, "is no saved state"),
    "a state of another scene": (
        lambda s: s.restore(tautline.Simulation(scene_of("slewing")).save()), SimulationError, "another scene",
    ),
    "a state of other inputs": (
        lambda s: s.restore(tautline.Simulation(scene_of("hoist"), inputs=["vessel.yaw"]).save()),
        SimulationError, "other inputs",
    ),
}  # fmt: skip


@pytest.fixture(scope="module")
def hoist():
    return tautline.Simulation(scene_of("hoist"))


@pytest.mark.parametrize("what", BAD)
def test_bad_input_is_refused_with_a_cure_and_leaves_the_simulation_where_it_was(what, hoist):
    act, kind, words = BAD[what]
    if hoist.time < 0.3:
        hoist.advance_to(0.3)
    before = hoist.save()
    with pytest.raises(kind, match=words):
        act(hoist)
    after = hoist.save()
    assert after.time == before.time and np.array_equal(before.block, after.block)


def test_an_input_that_the_scene_cannot_have_is_refused_with_the_nearest():
    with pytest.raises(UnknownName, match=r"winch[.]pay_out"):
        tautline.Simulation(scene_of("hoist"), inputs=["winch.payout"])


def test_what_stops_keeps_its_frames_and_can_be_restored():
    sim = tautline.Simulation(scene_of("hoist"))
    sim.advance(1.0)
    state = sim.save()
    with pytest.raises(StoppedEarly) as stop:
        for _ in range(1000):  # the load comes up to the boom tip
            sim.inputs["winch.pay_out_speed"] = -20.0
            sim.advance(0.05)
    assert stop.value.result["time"][-1] <= sim.time and len(stop.value.result["time"]) > 20
    assert sim.stopped and np.isfinite(sim["payload.position"]).all()
    with pytest.raises(SimulationError, match="restore a state"):
        sim.advance(0.1)
    sim.restore(state)
    sim.inputs["winch.pay_out_speed"] = 0.0
    sim.advance(0.5)
    assert not sim.stopped and sim.time == pytest.approx(1.5)


def test_an_input_that_the_scene_itself_moves_goes_on_from_its_speed():
    """The winch of the scene hoists at 2 m/s: positions that go on so are followed without a stop."""
    sim = tautline.Simulation(scene_of("hoist"), keep=False)
    sim.advance_to(2.0)
    out, speeds = sim["winch.pay_out"], []
    for k in range(1, 11):
        sim.inputs["winch.pay_out"] = out - 2.0 * 0.02 * k
        sim.advance(0.02)
        speeds.append(sim["winch.pay_out_speed"])
    assert np.allclose(speeds, -2.0, atol=1e-6)


def test_after_ctrl_c_a_simulation_stands_between_two_steps_and_goes_on():
    import signal
    import threading

    sim, other = (tautline.Simulation(scene_of("jwell"), keep=1.0) for _ in range(2))
    timer = threading.Timer(0.3, signal.raise_signal, (signal.SIGINT,))
    timer.start()
    with pytest.raises(tautline.Interrupted) as stop:
        sim.advance_to(1.0e5)
    assert 0.0 < sim.time < 1.0e5 and stop.value.result["time"][-1] <= sim.time
    end = np.ceil(sim.time) + 0.5
    sim.advance_to(end)
    other.advance_to(end)
    assert np.abs(sim["position"] - other["position"]).max() < 1e-6


def test_ctrl_c_between_two_calls_of_the_loop_leaves_nothing_half_done():
    import signal

    sim, other = (tautline.Simulation(scene_of("hoist")) for _ in range(2))
    arrive = sim._arrive

    def pressed(end):
        if end > 0.2:
            signal.raise_signal(signal.SIGINT)
        arrive(end)

    sim._arrive = pressed
    for _ in range(2):
        with pytest.raises(tautline.Interrupted):
            sim.advance_to(1.0)
    sim._arrive = arrive
    assert 0.2 < sim.time < 1.0
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    sim.advance_to(1.0)
    other.advance_to(1.0)
    assert np.array_equal(sim.result["time"], other.result["time"])
    assert np.array_equal(sim.result["position"], other.result["position"])


def test_what_stops_without_frames_says_so_all_the_same():
    sim = tautline.Simulation(scene_of("hoist"), keep=False)
    with pytest.raises(StoppedEarly) as stop:
        for _ in range(1000):
            sim.inputs["winch.pay_out_speed"] = -20.0
            sim.advance(0.05)
    assert stop.value.result is None and sim.stopped
    with pytest.raises(SimulationError, match="keep=True"):
        sim.result  # noqa: B018


@pytest.mark.parametrize("count", [200, pytest.param(10_000, marks=pytest.mark.study)])
def test_hundreds_of_advances_leak_nothing(count):
    sim = tautline.Simulation(scene_of("hoist"), inputs=["winch.pay_out"], keep=1.0)
    out = sim["winch.pay_out"]

    def some(n):
        for k in range(n):
            sim.inputs["winch.pay_out"] = out + 0.01 * np.sin(0.01 * k)
            sim.advance(0.01)
            sim["winch.tension"]

    for n in (200, 10, 300):
        some(n)  # what happens for the first time loads what it needs
    gc.collect()
    tracemalloc.start()
    some(10)
    before = tracemalloc.get_traced_memory()[0]
    some(count)
    gc.collect()
    grown = tracemalloc.get_traced_memory()[0] - before
    tracemalloc.stop()
    assert grown < min(100_000, 100 * count)


def test_copies_roll_out_on_threads_to_what_each_alone_comes_to():
    sim = tautline.Simulation(scene_of("hoist"))
    sim.advance(0.5)
    sims = [sim.copy() for _ in range(4)]
    for k, one in enumerate(sims):
        one.parameters["payload.mass"] = 4000.0 + 500.0 * k
    alone = sims[2].copy()
    alone.parameters["payload.mass"] = 5000.0
    tautline.rollout(sims, until=2.0, workers=2)
    alone.advance_to(2.0)
    assert np.array_equal(sims[2]["position"], alone["position"])
    assert len({one["winch.tension"] for one in sims}) == 4


def test_frames_of_the_last_seconds_only_are_kept_where_that_is_asked_for():
    sim = tautline.Simulation(scene_of("hoist"), keep=0.5)
    sim.advance_to(3.0)
    times = sim.result["time"]
    assert times[-1] == pytest.approx(3.0) and times[0] == pytest.approx(2.5) and len(times) == 11
    assert tautline.Simulation(scene_of("hoist"), keep=False)._kept.rows.size == 0
