"""What runs inside an FMU, without a host: inputs and parameters as a host sets them, refused and at the start."""

import json
import math
import zipfile
import zlib
from pathlib import Path

import pytest

import tautline
from tautline.live.errors import SimulationError
from tautline.live.fmu.unit import Core, from_bytes, state_from_bytes, to_bytes
from tautline.live.fmu.writing import write_fmu

pytest.importorskip("pythonfmu", reason="PythonFMU is not installed")

DATA = Path(__file__).parents[2] / "data"
SPEED, HEAVE = "winch.pay_out_speed", "vessel.heave"
HEIGHT, TENSION = "payload.position[2]", "winch.tension"
H = 0.05


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Resources of an FMU of the hoist: the scene itself hoists at 2 m/s, and its ship heaves by 0.5 m."""
    made = tmp_path_factory.mktemp("fmu")
    write_fmu(DATA / "hoist.yaml", made / "hoist.fmu", [SPEED, HEAVE], ["payload.position", TENSION])
    with zipfile.ZipFile(made / "hoist.fmu") as file:
        file.extractall(made)
    return made / "resources"


def still_with(heave=0.0):
    """The same scene with a winch that stands, and a ship that lies still at a heave, m."""
    changes = {"vessel.motion": {"heave": {"constant": heave}}, "path[0].drum.pay_out": 0}
    return tautline.Simulation(tautline.read(DATA / "hoist.yaml").replace(changes))


def test_an_input_of_zero_holds_what_the_scene_itself_would_move(folder):
    core = Core(folder)
    for k in range(40):
        core.set(SPEED, 0.0)
        core.set(HEAVE, 0.0)
        core.step(k * H, H)
    rest = still_with()
    assert core.get(HEIGHT) == pytest.approx(rest["payload.position"][2], abs=1e-6)
    assert core.get(TENSION) == pytest.approx(rest["winch.tension"], rel=1e-6)


@pytest.fixture(scope="module")
def heaving(tmp_path_factory):
    """Resources of an FMU of the hoist whose winch stands, and whose host gives the ship's heave with its rates."""
    made = tmp_path_factory.mktemp("rates")
    scene = tautline.read(DATA / "hoist.yaml").replace({"path[0].drum.pay_out": 0})
    write_fmu(scene, made / "hoist.fmu", [HEAVE, f"{HEAVE}.rate", f"{HEAVE}.second_rate"], [TENSION])
    with zipfile.ZipFile(made / "hoist.fmu") as file:
        file.extractall(made)
    return made / "resources"


def ramped_heave(t):
    """Heave of the scene, 0.5 m in 8 s grown with smoothstep over 8 s, and two derivatives by hand."""
    w, s = 2.0 * math.pi / 8.0, min(t / 8.0, 1.0)
    f = 0.5 * math.sin(w * t), 0.5 * w * math.cos(w * t), -0.5 * w * w * math.sin(w * t)
    g, dg, ddg = s**3 * (10 - 15 * s + 6 * s * s), 30 * s * s * (1 - s) ** 2 / 8, 60 * s * (1 - s) * (1 - 2 * s) / 64
    return f[0] * g, f[1] * g + f[0] * dg, f[2] * g + 2 * f[1] * dg + f[0] * ddg


def test_a_host_that_gives_rates_moves_a_rope_at_its_own_period_as_the_scene_does(heaving):
    """Of values alone at 0.375 s, the rope's period, tensions were 5.6 kN beyond the truth, of 50 kN."""
    core, (end, step) = Core(heaving), (24.0, 0.375)
    core.initialise()
    true = tautline.simulate(tautline.read(DATA / "hoist.yaml").replace({"path[0].drum.pay_out": 0, "solver.end": 24}))
    told = []
    for k in range(int(end / step)):
        for name, x in zip((HEAVE, f"{HEAVE}.rate", f"{HEAVE}.second_rate"), ramped_heave((k + 1) * step), strict=True):
            core.set(name, x)
        core.step(k * step, step)
        told.append(core.get(TENSION))
    known = true["drum_tension"]
    assert min(told) == pytest.approx(float(known.min()), abs=15.0)
    assert max(told) == pytest.approx(float(known.max()), abs=15.0)
    assert core.get(f"{HEAVE}.rate") == pytest.approx(ramped_heave(end)[1])


def test_a_value_that_stays_with_a_rate_is_gone_through_and_one_without_is_rested_at(heaving):
    """A sine sampled once in half a period from its zeros has equal values, and rates that alternate."""
    core = Core(heaving)
    for k, rate in enumerate((0.5, -0.5, 0.0)):
        for name, x in zip((HEAVE, f"{HEAVE}.rate", f"{HEAVE}.second_rate"), (0.2, rate, 0.0), strict=True):
            core.set(name, x)
        core.step(k * H, H)
        assert core.sim.inputs.motion(HEAVE) == pytest.approx((0.2, rate, 0.0), abs=1e-9)
    core.step(3 * H, 1.0)
    assert core.sim.inputs.motion(HEAVE) == pytest.approx((0.2, 0.0, 0.0), abs=1e-9)
    assert core.get(f"{HEAVE}.rate") == pytest.approx(0.0, abs=1e-9)


def test_a_rate_that_is_read_is_that_of_the_input_where_nothing_was_set_for_a_step(heaving):
    core = Core(heaving)
    core.set(HEAVE, 0.05)
    core.set(f"{HEAVE}.rate", 0.5)
    assert core.get(f"{HEAVE}.rate") == 0.5
    core.step(0.0, H)
    assert core.get(f"{HEAVE}.rate") == pytest.approx(0.5)
    core.step(H, H)
    assert core.get(f"{HEAVE}.rate") == pytest.approx(0.0, abs=1e-9)


def test_rates_that_a_host_never_sets_are_found_from_its_values(heaving, folder):
    with_rates, without = Core(heaving), Core(folder)
    without.set(SPEED, 0.0)
    for k in range(12):
        for core in (with_rates, without):
            core.set(HEAVE, ramped_heave((k + 1) * H)[0])
            core.step(k * H, H)
    assert with_rates.get(HEAVE) == without.get(HEAVE)
    assert with_rates.sim.inputs.motion(HEAVE) == without.sim.inputs.motion(HEAVE)


def test_a_second_rate_without_the_rate_is_not_taken_for_it(heaving, folder):
    with_second, without = Core(heaving), Core(folder)
    without.set(SPEED, 0.0)
    for k in range(6):
        with_second.set(f"{HEAVE}.second_rate", 0.3)
        for core in (with_second, without):
            core.set(HEAVE, ramped_heave((k + 1) * H)[0])
            core.step(k * H, H)
    assert with_second.sim.inputs.motion(HEAVE) == without.sim.inputs.motion(HEAVE)


def test_rates_have_units_and_cannot_be_nan(heaving):
    core = Core(heaving)
    units = {name: unit for name, unit, _, kind in core.signals() if kind == "input"}
    assert units == {HEAVE: "m", f"{HEAVE}.rate": "m/s", f"{HEAVE}.second_rate": "m/s^2"}
    with pytest.raises(SimulationError, match="rate"):
        core.set(f"{HEAVE}.rate", math.nan)


@pytest.mark.parametrize(
    ("names", "words"),
    [
        ([f"{HEAVE}.rate"], "which is not among the inputs"),
        ([HEAVE, f"{HEAVE}.second_rate"], "says nothing without its rate"),
        ([HEAVE, f"{HEAVE}.rate", f"{HEAVE}.rate.rate"], "which is not among the inputs"),
    ],
)
def test_rates_of_what_is_not_given_itself_are_refused_and_nothing_is_written(names, words, tmp_path):
    with pytest.raises(SimulationError, match=words):
        write_fmu(DATA / "hoist.yaml", tmp_path / "hoist.fmu", names, [TENSION])
    assert not list(tmp_path.iterdir())


def test_an_input_that_was_never_set_still_goes_by_the_scene_and_says_so(folder):
    core = Core(folder)
    core.set(HEAVE, 0.0)
    core.step(0.0, 1.0)
    assert core.get(SPEED) == pytest.approx(-2.0) and core.get(HEAVE) == 0.0


def test_a_state_knows_which_inputs_were_set(folder):
    """After going back to a time before the first set, a zero is again the first one given."""
    core = Core(folder)
    saved = from_bytes(to_bytes(core.save()))
    heights = []
    for _ in range(2):
        core.set(SPEED, 0.0)
        core.set(HEAVE, 0.0)
        core.step(0.0, 1.0)
        heights.append(core.get(HEIGHT))
        core.restore(saved)
    assert heights == pytest.approx([5.0, 5.0], abs=1e-6)


def test_an_input_set_in_the_initialisation_is_that_of_the_start_and_nothing_jumps(folder):
    """The reference is the scene with a ship that lies 1 m higher for good."""
    core = Core(folder)
    core.set(SPEED, 0.0)
    core.set(HEAVE, 1.0)
    assert core.get(HEAVE) == 1.0
    core.initialise()
    high = still_with(heave=1.0)
    assert core.get(TENSION) == pytest.approx(high["winch.tension"], rel=1e-9)
    for k in range(20):
        core.set(HEAVE, 1.0)
        core.step(k * H, H)
        assert core.get(TENSION) == pytest.approx(high["winch.tension"], rel=1e-6)
        assert core.get(HEIGHT) == pytest.approx(5.0, abs=1e-6)


def test_an_input_set_after_the_initialisation_is_reached_in_the_first_step(folder):
    core = Core(folder)
    core.initialise()
    core.set(SPEED, 0.0)
    core.set(HEAVE, 0.01)
    core.step(0.0, H)
    assert core.sim.inputs[HEAVE] == pytest.approx(0.01) and core.get(TENSION) > 1.1 * still_with()["winch.tension"]


def test_a_state_keeps_the_inputs_of_the_start(folder):
    core = Core(folder)
    core.set(SPEED, 0.0)
    core.set(HEAVE, 1.0)
    core.initialise()
    other = Core(folder)
    other.initialise()
    other.restore(from_bytes(to_bytes(core.save())))
    other.step(0.0, 1.0)
    assert other.get(HEAVE) == 1.0 and other.get(HEIGHT) == pytest.approx(5.0, abs=1e-6)


def test_an_instance_that_takes_a_state_of_an_initialised_one_goes_on_as_that_does(folder):
    """No start is found anew: a speed that is set next is reached in the step, by a cubic whose mean is half of it."""
    core, other = Core(folder), Core(folder)
    for name in (SPEED, HEAVE):
        core.set(name, 0.0)
    core.initialise()
    other.restore(from_bytes(to_bytes(core.save())))
    for one in (core, other):
        one.set(SPEED, -0.5)
        one.step(0.0, 0.2)
        assert one.sim["winch.pay_out"] == pytest.approx(-0.05, rel=1e-9)
    assert other.get(TENSION) == core.get(TENSION)


def test_a_state_from_before_the_initialisation_takes_inputs_of_the_start_again(folder):
    """The reference is a speed that is there from the start on: -0.5 m/s over 0.2 s."""
    core = Core(folder)
    saved = from_bytes(to_bytes(core.save()))
    core.initialise()
    core.step(0.0, 0.2)
    core.restore(saved)
    for name, value in ((SPEED, -0.5), (HEAVE, 0.0)):
        core.set(name, value)
    core.initialise()
    core.step(0.0, 0.2)
    assert core.sim["winch.pay_out"] == pytest.approx(-0.1, rel=1e-9)


def test_a_simulation_starts_with_its_inputs_at_initial_values():
    """References are scenes with that constant heave, and that constant speed of the winch."""
    scene = tautline.read(DATA / "hoist.yaml")
    held = tautline.Simulation(scene, initial={HEAVE: 1.0, SPEED: 0.0})
    held.advance(0.5)
    assert held["payload.position"][2] == pytest.approx(5.0, abs=1e-6)
    assert held["winch.tension"] == pytest.approx(still_with(heave=1.0)["winch.tension"], rel=1e-6)
    changes = {"vessel.motion": {"heave": {"constant": 0.0}}, "path[0].drum.pay_out": {"constant": -0.2}}
    wanted = tautline.Simulation(scene.replace(changes))
    found = tautline.Simulation(scene, initial={SPEED: -0.2, HEAVE: 0.0})
    for sim in (wanted, found):
        sim.advance(0.5)
    assert found["winch.pay_out"] == pytest.approx(-0.1, rel=1e-9)
    assert found["winch.tension"] == pytest.approx(wanted["winch.tension"], rel=1e-9)


PLACE = "winch.pay_out"


@pytest.mark.parametrize("start", ["static", "as drawn"])
def test_a_winch_whose_load_starts_as_drawn_starts_at_no_other_place_than_zero(start):
    """As much rope is found as lets the load hang as drawn: a winch elsewhere would be read so, and move nothing."""
    scene = tautline.read(DATA / "hoist.yaml").replace({"start": start})
    for value in (-1.0, 1.0):
        with pytest.raises(SimulationError, match=r"winch.pay_out = -?1 cannot be at the start.*give 0.*the speed"):
            tautline.Simulation(scene, initial={PLACE: value})
    assert tautline.Simulation(scene, initial={PLACE: 0.0})[PLACE] == 0.0


def test_a_winch_of_a_scene_that_gives_its_rope_s_length_starts_at_any_place_and_the_load_with_it():
    """The reference is a scene whose rope is 1 m shorter."""
    scene = tautline.read(DATA / "hoist.yaml").replace({"path[0].drum.pay_out": 0, "vessel.motion": {"heave": 0}})
    wound = tautline.Simulation(scene.replace({"rope.length": 60.0}), [PLACE], initial={PLACE: -1.0})
    short = tautline.Simulation(scene.replace({"rope.length": 59.0}))
    assert wound["payload.position"][2] == pytest.approx(short["payload.position"][2], abs=1e-6)
    assert wound["winch.tension"] == pytest.approx(short["winch.tension"], rel=1e-6)
    assert wound[PLACE] == -1.0


def test_an_fmu_whose_winch_was_placed_at_the_start_says_why_it_cannot_and_starts_once_it_is_at_zero(tmp_path):
    write_fmu(DATA / "hoist.yaml", tmp_path / "placed.fmu", [PLACE, HEAVE], ["payload.position", TENSION])
    with zipfile.ZipFile(tmp_path / "placed.fmu") as file:
        file.extractall(tmp_path)
    core = Core(tmp_path / "resources")
    core.set(HEAVE, 0.0)
    core.set(PLACE, -1.0)
    with pytest.raises(SimulationError, match=r"with what was set: winch.pay_out = -1 cannot be"):
        core.initialise()
    core.set(PLACE, 0.0)
    core.initialise()
    for k in range(20):
        core.set(PLACE, -0.05 * (k + 1))
        core.step(k * 0.5, 0.5)
    core.step(10.0, 2.0)
    assert core.get(HEIGHT) == pytest.approx(6.0, abs=0.02)


@pytest.mark.parametrize("value", [float("nan"), "high", (1.0, 0.5)])
def test_an_initial_value_that_cannot_be_is_refused(value):
    with pytest.raises(SimulationError, match=HEAVE):
        tautline.Simulation(DATA / "hoist.yaml", initial={HEAVE: value})


def test_the_first_step_says_when_it_begins_and_a_later_gap_is_refused(folder):
    core = Core(folder)
    core.initialise()
    core.step(100.0, H)
    core.step(100.0 + H, H)
    with pytest.raises(SimulationError, match="the host steps from 7 s"):
        core.step(7.0, H)
    other = Core(folder)
    other.restore(from_bytes(to_bytes(core.save())))
    with pytest.raises(SimulationError, match=r"the unit stands at 100\.1 s"):
        other.step(0.0, H)


@pytest.mark.parametrize(("start", "gap"), [(1.7e9, 1.0), (1.7e9, 1e-5), (1e6, 9e-4), (0.0, 2e-9)])
def test_a_gap_is_refused_whatever_the_start_time_and_the_rounding_of_the_host_s_sums_is_none(start, gap, folder):
    """A double holds an epoch time to 2.4e-7 s: sums of it are wrong by half of that in each step."""
    core, time = Core(folder), start
    core.start_at(start)
    for _ in range(3):
        core.step(time, 0.01)
        time += 0.01
    core.step(start + 0.03, 0.01)
    with pytest.raises(SimulationError, match=r"the host steps from .* s earlier;") as refused:
        core.step(start + 0.04 + gap, 0.01)
    told = float(str(refused.value).split(" s earlier;")[0].split()[-1])
    assert told == pytest.approx(gap, rel=0.01, abs=2.4e-7 * (start > 1e9)), "two times that may be alike in all digits"
    core.step(start + 0.04, 0.01)


@pytest.mark.parametrize(
    ("name", "bad", "good"),
    [("payload.mass", -5.0, 5000.0), ("payload.mass", float("nan"), 5000.0), (HEAVE, float("inf"), 0.0)],
)
@pytest.mark.parametrize("late", [False, True])
def test_a_value_that_cannot_be_is_refused_and_no_step_is_made_until_one_that_can_is_set(folder, name, bad, good, late):
    core = Core(folder)
    if late:
        core.initialise()
        core.step(0.0, H)
    before = core.get(name), core.get(TENSION)
    with pytest.raises(SimulationError, match=name):
        core.set(name, bad)
    if not late:
        core.initialise()
    assert (core.get(name), core.get(TENSION)) == before
    for _ in range(2):
        with pytest.raises(SimulationError, match=name):
            core.step(H if late else 0.0, H)
    core.set(name, good)
    core.step(H if late else 0.0, H)
    assert core.get(name) == good and 0.0 < core.get(TENSION) < 1e5


def test_a_start_that_is_not_found_fails_the_steps_and_nothing_that_is_read(folder, monkeypatch):
    core = Core(folder)
    tension = core.get(TENSION)
    core.set("payload.mass", 6000.0)
    with monkeypatch.context() as patched:
        patched.setattr("tautline.live.fmu.unit.Simulation", _no_equilibrium)
        assert core.get(TENSION) == tension
        for act in (core.initialise, lambda: core.step(0.0, H)):
            with pytest.raises(SimulationError, match="no start is found with what was set: no equilibrium"):
                act()
    core.set("payload.mass", 5500.0)
    core.step(0.0, H)
    assert core.get(TENSION) == pytest.approx(1.1 * tension, rel=0.02)


DEEP = 1.0e5
"""A heave, m, with which no equilibrium is found."""


@pytest.mark.parametrize("asked", ["initialise", "step"])
def test_a_start_that_an_input_prevents_is_found_once_the_input_is_set_to_another(folder, asked):
    core = Core(folder)
    act = core.initialise if asked == "initialise" else lambda: core.step(0.0, H)
    core.set(SPEED, 0.0)
    core.set(HEAVE, DEEP)
    for _ in range(2):
        with pytest.raises(SimulationError, match="no start is found with what was set"):
            act()
    core.set(HEAVE, 1.0)
    act()
    core.step(0.0 if asked == "initialise" else H, H)
    assert core.get(TENSION) == pytest.approx(still_with(heave=1.0)["winch.tension"], rel=1e-6)


def test_an_input_is_of_the_start_while_a_parameter_that_was_set_later_prevents_it(folder, monkeypatch):
    core = Core(folder)
    core.set(SPEED, 0.0)
    core.set(HEAVE, 0.5)
    core.set("payload.mass", 6000.0)
    with monkeypatch.context() as patched:
        patched.setattr("tautline.live.fmu.unit.Simulation", _no_equilibrium)
        with pytest.raises(SimulationError, match="no start is found"):
            core.initialise()
    core.set(HEAVE, 1.0)
    core.step(0.0, H)
    assert core.get(HEAVE) == 1.0 and core.get(HEIGHT) == pytest.approx(5.0, abs=1e-6)


def at_rest_with(folder, mass):
    """An initialised unit whose winch and ship stand still, and whose load is of a mass, kg."""
    core = Core(folder)
    for name, value in ((SPEED, 0.0), (HEAVE, 0.0), ("payload.mass", mass)):
        core.set(name, value)
    core.initialise()
    return core


def test_a_parameter_set_between_the_initialisation_and_the_first_step_is_a_sudden_change(folder):
    """A load on a spring that is heavier all at once: tension m' g + (m' - m) g at most, but for little damping."""
    light, heavy, g = 5000.0, 8000.0, 9.81
    core = at_rest_with(folder, light)
    core.set("payload.mass", heavy)
    assert core.get(TENSION) == pytest.approx(light * g, rel=0.02)
    tensions = []
    for k in range(12):
        core.step(k * H, H)
        tensions.append(core.get(TENSION))
    assert max(tensions) == pytest.approx((2.0 * heavy - light) * g, rel=0.05)


def test_a_value_that_was_refused_before_the_initialisation_and_is_set_right_after_it_is_of_the_start(folder):
    core = Core(folder)
    with pytest.raises(SimulationError, match=r"payload\.mass"):
        core.set("payload.mass", -5.0)
    for name in (SPEED, HEAVE):
        core.set(name, 0.0)
    core.initialise()
    core.set("payload.mass", 8000.0)
    for k in range(4):
        core.step(k * H, H)
        assert core.get(TENSION) == pytest.approx(8000.0 * 9.81, rel=0.02)


def test_a_second_initialisation_without_a_reset_is_refused_and_no_step_is_made_until_a_state_is_set(folder):
    core = Core(folder)
    before = core.save()
    core.initialise()
    saved = core.save()
    for act in (core.initialise, lambda: core.asked_step(0.0, H)):
        with pytest.raises(SimulationError, match=r"initialised already.*reset it"):
            act()
    core.restore(saved)
    core.asked_step(0.0, H)
    core.restore(before)
    core.initialise()
    core.asked_step(0.0, H)


def _no_equilibrium(*_, **__):
    raise SimulationError("no equilibrium")


def test_bytes_that_are_no_state_are_told_where_they_are_set_and_steps_wait_for_one_that_is(folder):
    core = Core(folder)
    core.step(0.0, H)
    saved = core.save()
    for junk in (b"\0" * 100, b"", b"{}", b"[1]\0abc"):
        with pytest.raises(SimulationError):
            from_bytes(junk)
        with pytest.raises(SimulationError, match="no state of this FMU"):
            core.restore(state_from_bytes(junk))
        with pytest.raises(SimulationError, match="no state"):
            core.step(H, H)
    core.restore(saved)
    core.step(H, H)


@pytest.mark.parametrize("tiny", [1e-12, 1e-13, 1e-15, 1e-16])
def test_a_communication_step_of_rounding_succeeds_and_inputs_wait_for_the_next(tiny, folder):
    """A host of variable step makes one between two others; the reference is one that makes none."""
    heights = []
    for others in ((), (tiny,)):
        core, t = Core(folder), 0.0
        for _ in range(3):
            core.step(t, H)
            t += H
        core.set(SPEED, 0.0)
        before = core.get(HEIGHT)
        for length in others:
            core.step(t, length)
            assert core.get(HEIGHT) == pytest.approx(before, abs=1e-8) and core.get(SPEED) == 0.0
            t += length
        core.step(t, H - sum(others))
        core.step(t + H - sum(others), H)
        heights.append(core.get(HEIGHT))
    assert heights[1] == pytest.approx(heights[0], abs=1e-7)


def test_many_steps_of_rounding_add_up_to_an_advance(folder):
    core = Core(folder)
    core.step(0.0, H)
    shortest = 1e-9 * core.sim.model.solver.interval
    for k in range(20):
        core.step(H + k * shortest / 4.0, shortest / 4.0)
    assert core.sim.time == pytest.approx(H + 5.0 * shortest, abs=1.1 * shortest) and core.sim.time > H


@pytest.mark.parametrize("length", [0.0, -1e-13, -H, float("nan")])
def test_a_communication_step_of_no_length_or_backwards_is_refused(length, folder):
    core = Core(folder)
    core.step(0.0, H)
    with pytest.raises(SimulationError, match="a communication step of"):
        core.step(H, length)


def test_an_output_that_is_set_is_told_and_stays(folder):
    core = Core(folder)
    core.step(0.0, H)
    tension = core.get(TENSION)
    with pytest.raises(SimulationError, match="is an output"):
        core.refuse_output(TENSION)
    assert core.get(TENSION) == tension > 0.0
    other = Core(folder)
    for k in range(2):
        other.step(k * H, H)
    core.step(H, H)
    assert core.get(TENSION) == other.get(TENSION) != tension


def with_head(saved, change):
    """Bytes of a state whose head was changed by a function, with the sum that belongs to them."""
    head, _, block = to_bytes(saved)[8:].partition(b"\0")
    told = json.loads(head)
    change(told)
    rest = json.dumps(told).encode() + b"\0" + block
    return f"{zlib.crc32(rest):08x}".encode() + rest


@pytest.fixture(scope="module")
def saved(folder):
    """A state of the unit after a step with an input that was set."""
    core = Core(folder)
    core.set(SPEED, 0.1)
    core.step(0.0, H)
    return core.save()


def assert_refused(folder, data, cause):
    """Bytes are refused with their cause where they are read, and no step is made of a unit that is given them."""
    with pytest.raises(tautline.SimulationError, match=cause):
        from_bytes(data)
    core = Core(folder)
    for work in (lambda: core.restore(state_from_bytes(data)), lambda: core.step(0.0, H)):
        with pytest.raises(tautline.SimulationError, match=cause):
            work()


@pytest.mark.parametrize(
    "name, wrong",
    [
        ("stopped", []), ("stopped", ["a"]), ("stopped", ["a", "b", "c"]), ("stopped", 3), ("stopped", "ab"),
        ("given", 3), ("given", "abc"), ("changed", "abc"), ("changed", [1]), ("explicit", 3), ("explicit", ["a"]),
        ("explicit", "12"), ("displaced", 3), ("time", "soon"), ("time", None), ("time", -1.0), ("time", math.nan),
        ("time", math.inf), ("frames", "many"), ("frames", -5), ("frames", math.inf), ("frames", 2.7), ("frames", True),
        ("frames", "3"), ("scene", None), ("start", 1), ("another", 1),
    ],
)  # fmt: skip
def test_bytes_of_a_state_that_holds_what_cannot_be_are_refused_in_plain_words(folder, saved, name, wrong):
    data = with_head(saved, lambda told: told["state"].update({name: wrong}))
    assert_refused(folder, data, "the saved state is damaged")


NAMES = (
    "time", "scene", "layout", "frames", "changed", "given", "stopped", "explicit", "start", "last", "displaced"
)  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
def test_bytes_of_a_state_without_a_name_that_is_read_are_refused(folder, saved, name):
    assert_refused(folder, with_head(saved, lambda told: told["state"].pop(name)), "the saved state is damaged")


@pytest.mark.parametrize(
    "name", ["state", "sent", "given", "held", "changed", "begin", "timed", "initialised", "running"]
)
def test_bytes_of_a_unit_without_a_name_that_is_read_are_refused(folder, saved, name):
    assert_refused(folder, with_head(saved, lambda told: told.pop(name)), "the saved state is damaged")


@pytest.mark.parametrize(
    "name, wrong",
    [
        ("sent", "abc"), ("sent", {SPEED: "fast"}), ("given", {SPEED: math.nan}), ("held", [1]), ("changed", None),
        ("changed", {"payload.mass": True}), ("running", 1), ("timed", "yes"), ("initialised", None), ("begin", "now"),
        ("begin", math.inf), ("another", 1), ("state", []), ("state", None),
    ],
)  # fmt: skip
def test_bytes_of_a_unit_that_holds_what_cannot_be_are_refused_in_plain_words(folder, saved, name, wrong):
    assert_refused(folder, with_head(saved, lambda told: told.update({name: wrong})), "the saved state is damaged")


def test_bytes_of_a_state_that_were_damaged_anywhere_are_refused(folder, saved):
    """Also where what they hold then could be: a time of 5 s, another input."""
    data = to_bytes(saved)
    for sound in (data, with_head(saved, lambda told: None)):
        assert from_bytes(sound)["sent"] == saved["sent"] == {SPEED: 0.1}
    assert_refused(folder, data.replace(b"0.1", b"0.7", 1), "the saved state is damaged")
    for place in (0, len(data) // 2, len(data) - 1):
        damaged = bytearray(data)
        damaged[place] ^= 1
        assert_refused(folder, damaged, "the saved state is damaged")
    assert_refused(folder, data[:-1], "the saved state is damaged")


@pytest.mark.parametrize("name, wrong", [("frames", math.inf), ("changed", "abc"), ("frames", -5), ("time", 5.0)])
def test_a_state_sent_to_another_process_is_refused_where_what_stands_beside_its_block_is_not_what_was(
    saved, name, wrong
):
    build, (told, block, total) = saved["state"].__reduce__()
    assert build(told, block, total).told == told
    with pytest.raises(tautline.SimulationError, match="the saved state is damaged"):
        build(told | {name: wrong}, block, total)
    with pytest.raises(tautline.SimulationError, match="the saved state is damaged"):
        build({key: value for key, value in told.items() if key != name}, block, total)
