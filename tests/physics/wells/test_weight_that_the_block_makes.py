"""What `check` says of the weight on bit that the block's way makes, against closed forms, scipy, and a run.

String and rock are two springs in series, K, and dW/dt = K (v - rate(W)) with W >= 0. A rate in proportion to W - T
gives W = T + (W_0 - T) exp(-K c t) under a block that is held, the drill-off of A. Lubinski (1958).
"""

import numpy as np
import pytest
from physics.wells.strings import COLLAR, E, area, run, straight_hole
from scipy.integrate import solve_ivp

from drillstring.drilling.weight_of_run import weight_of_run
from drillstring.model.prepared import prepared
from drillstring.warnings import warnings

LENGTH, ROCK, WEIGHT, RPM = 400.0, 2.5e7, 5e4, 2.0 * np.pi / 60.0
SPRING = 1.0 / (1.0 / ROCK + LENGTH / (E * area(*COLLAR)))
FEED, END = 20.0 / 3600.0, 30.0
LAW = {"rate": "20 m/h", "speed": "120 rpm"}
WORN = {"specific_energy": "60 MPa", "contact_strength": "100 MPa", "wear_flat": "10 mm"}


def scene(block=0.0, weight=WEIGHT, speed=120 * RPM, end=END, **bit):
    return straight_hole(
        0.0, length=LENGTH, elements=1, bit={"on_bottom": True, "weight": weight} | bit, top__rotation=speed,
        well__wall="none", top__block=block, solver__end=end, solver__step=5e-3, output__interval=0.05,
        solver__rho_inf=0.5, damping={"structural": 2e-2},
    )  # fmt: skip


def told(given):
    return [one.text for one in warnings(given) if one.where == "top.block"]


def course(given):
    return weight_of_run(given, prepared(given).lumps.tubes)


def velocity(time, value):
    return {"velocity": {"table": {"time": time, "value": value}}}


@pytest.mark.parametrize("bit", [{"penetration": LAW | {"threshold": 9e4, "weight": 2e5}}, {"cutting": WORN}])
def test_nothing_is_said_of_a_block_held_over_a_bit_too_light_to_drill_for_its_weight_stays(bit):
    given = scene(**bit)
    assert told(given) == [] and np.all(course(given).weight == WEIGHT)


ROLLER = {"torque": {"static": 8e3, "kinetic": 4e3}}


@pytest.mark.parametrize("bit", [{"penetration": LAW | {"threshold": 9e4, "weight": 2e5}}, {"cutting": WORN}, ROLLER])
def test_a_block_that_is_raised_takes_all_weight_off_its_bit_by_whatever_law_it_drills(bit):
    (said,) = told(scene({"velocity": -FEED}, **bit))
    assert said.startswith("is raised at 20 m/h at the end: the weight on bit goes to 0 N")


def test_a_block_lowered_onto_a_bit_that_does_not_drill_by_its_way_presses_two_springs_by_it():
    way = 0.5 * WEIGHT / SPRING
    given = scene({"ramp": {"to": way, "over": 10.0}}, penetration=LAW | {"threshold": 9e4, "weight": 2e5})
    assert course(given).weight[-1] == pytest.approx(1.5 * WEIGHT, rel=1e-9)
    assert told(given) == ["is held at the end: the weight on bit goes to 75 kN"]


@pytest.mark.parametrize("threshold", [0.0, 2e4])
def test_a_held_string_is_told_to_drill_off_its_weight_and_how_far_it_comes_within_the_run(threshold):
    given = scene(penetration={"rate": "1 m/h", "speed": "120 rpm", "threshold": threshold})
    found, c = course(given), 1.0 / 3600.0 / (WEIGHT - threshold)
    assert found.weight == pytest.approx(threshold + (WEIGHT - threshold) * np.exp(-SPRING * c * found.time), rel=2e-3)
    (said,) = told(given)
    assert said.startswith("is held and the bit drills 1 m/h with the weight of the start: the weight on bit goes to ")
    assert f"goes to {threshold / 1e3:g} " in said and "lowered" not in said
    assert f"Without friction it is {found.weight[-1] / 1e3:.3g}" in said and "at the end of the run" in said


@pytest.mark.parametrize("exponent", [0.5, 1.0, 2.5])
def test_the_weight_over_a_run_is_that_of_its_differential_equation_also_after_the_bit_was_lifted(exponent):
    """Lowered by 0.25 m in 10 s, lifted off the bottom, and set down again; scipy has the depth that is drilled."""
    time, value = [0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0], [0.0, 0.05, 0.0, -0.06, 0.0, 0.1, 0.0]
    law = {"rate": "40 m/h", "speed": "120 rpm", "threshold": 1e4, "weight_exponent": exponent}
    found = course(scene(velocity(time, value), penetration=law))
    fine = np.linspace(0.0, END, 30001)
    speed = np.interp(fine, time, value)
    way = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(fine))])

    def weight(t, drilled):
        return np.maximum(0.0, WEIGHT + SPRING * (np.interp(t, fine, way) - drilled))

    def rate(t, y):
        return 40.0 / 3600.0 * (np.maximum(0.0, weight(t, y) - 1e4) / (WEIGHT - 1e4)) ** exponent

    solved = solve_ivp(rate, (0.0, END), [0.0], "LSODA", rtol=1e-8, atol=1e-10, max_step=0.05, t_eval=found.time)
    exact = weight(found.time, solved.y[0])
    assert exact.min() == 0.0 and exact.max() > 1.5 * WEIGHT and exact[found.time > 25.0].max() > 0.5 * WEIGHT
    assert found.weight == pytest.approx(exact, abs=2e-2 * exact.max())


@pytest.fixture(scope="module")
def pushed():
    """Lowered by 40 mm within 4 s, eight times as fast as the bit drills with its first weight, and held then."""
    return scene(
        velocity([0.0, 2.0, 4.0, 5.0], [0.0, 0.02, 0.0, 0.0]), weight=2e4, end=10.0, penetration=LAW | {"weight": 1e5}
    )


def test_the_largest_weight_within_a_run_and_the_last_one_are_told_and_are_those_of_the_run(pushed):
    result = run(pushed)
    (said,) = told(pushed)
    most, last = result["weight_on_bit"].max(), result["weight_on_bit"][-1]
    numbers = [1e3 * float(part.split(" kN")[0]) for part in said.split("it is ")[1].split(", and ")]
    assert numbers == pytest.approx([last, most], rel=0.03), said
    when = float(said.split("at t = ")[1].split(" s")[0])
    assert when == pytest.approx(result.time[result["weight_on_bit"].argmax()], abs=0.3)
    assert "is held at the end and the bit drills 4 m/h" in said and "goes to 0 N" in said


def test_a_weight_beyond_what_the_string_weighs_is_told_where_it_comes_within_the_run_and_goes_again():
    block = velocity([0.0, 2.0, 4.0, 5.0], [0.0, 0.2, 0.0, 0.0])
    given = scene(block, weight=2e4, end=60.0, penetration=LAW | {"weight": 1e5})
    assert course(given).weight[-1] < 4e4
    assert any("leads to a weight on bit of" in one and "is more than the string weighs" in one for one in told(given))


def test_a_block_that_heaves_until_the_end_is_told_by_its_largest_weight_and_not_by_its_last_speed():
    given = scene({"harmonic": {"amplitude": 0.02, "period": 9.0}})
    (said,) = told(given)
    assert said.startswith("changes the weight on bit, and does not move steadily at the end of the run. Without")
    assert float(said.split(" kN at most")[0].split(" ")[-1]) == pytest.approx((WEIGHT + 0.02 * SPRING) / 1e3, rel=1e-3)


def rippled(amplitude, period):
    return {"sum": [{"constant": 120 * RPM}, {"harmonic": {"amplitude": amplitude * RPM, "period": period}}]}


def test_where_nothing_drills_a_rotary_that_ripples_does_not_matter_to_a_block_that_is_lowered():
    said, *_ = told(scene({"velocity": FEED}, speed={"harmonic": {"amplitude": 10 * RPM, "period": 3.0}}))
    assert said.startswith("lowers the bit at 20 m/h onto a bottom that is not drilled; give bit.penetration")


def test_a_rotary_that_ripples_counts_with_its_mean_and_leaves_a_steady_block_steady():
    said, *_ = told(scene({"velocity": 1.5 * FEED}, speed=rippled(1, 3.0), penetration=LAW))
    assert said.startswith("is lowered at 30 m/h at the end and the bit drills 20 m/h with the weight of the start: ")
    assert "the weight on bit goes to 75 kN" in said


def test_a_rotary_that_swings_both_ways_counts_with_what_its_turns_forward_drill():
    """The mean of a sine's upper halves over all time is 1 / pi of its amplitude."""
    swings = {"harmonic": {"amplitude": 120 * RPM, "period": 3.0}}
    (said,) = told(scene({"velocity": FEED}, speed=swings, penetration=LAW))
    goes = float(said.split("goes to ")[1].split(" kN")[0])
    assert 1e3 * goes == pytest.approx(np.pi * WEIGHT, rel=2e-3)


def test_a_block_held_over_a_bit_that_drills_is_told_in_a_run_too_short_for_its_weight_to_change():
    (said,) = told(scene(speed=rippled(2, 3.0), end=2.0, penetration={"rate": "0.1 m/h", "speed": "120 rpm"}))
    assert said.startswith("is held and the bit drills 0.0") and "goes to 0 N" in said


def test_a_rotary_that_still_changes_its_speed_is_told_beside_the_weight_that_its_last_speed_makes():
    grows = {"table": {"time": [0.0, END], "value": [0.0, 120 * RPM], "interpolation": "linear"}}
    (said,) = told(scene({"velocity": 2.0 * FEED}, speed=grows, penetration=LAW))
    assert "goes to 100 kN with the rotary's last speed, 120 rpm, which it does not keep. Without" in said


SEA = {"spectrum": {"significant_height": 2.5, "peak_period": 9.0}}


@pytest.mark.parametrize("end", [10800.0, 4e4])
def test_a_long_sea_is_seen_by_few_instants_and_it_is_said_which(end):
    given = scene(SEA, end=end, penetration=LAW)
    found = course(given)
    assert 5000 < found.time.size < 12_000 and 0.0 < found.followed < 0.1 * end
    part = f"{found.followed:.4g} s"
    assert any(f"from every wave of the first and of the last {part}, and from single" in one for one in told(given))
    early = found.time <= found.followed
    short = course(scene(SEA, end=found.followed, penetration=LAW))
    exact = np.interp(found.time[early], short.time, short.weight)
    assert found.weight[early] == pytest.approx(exact, abs=2e-2 * exact.max())


def test_a_heave_that_keeps_time_with_the_steps_of_a_long_run_is_met_in_all_its_phases():
    given = scene({"harmonic": {"amplitude": 0.005, "period": 0.5}}, end=4e4)
    found = course(given)
    between = found.weight[(found.time > found.followed) & (found.time < 4e4 - found.followed)]
    assert np.mean(between) == pytest.approx(WEIGHT, rel=2e-3)
    assert [between.min(), between.max()] == pytest.approx([WEIGHT - 0.005 * SPRING, WEIGHT + 0.005 * SPRING], rel=1e-3)


def test_a_block_that_comes_back_to_where_it_was_is_not_told_for_the_rounding_of_its_positions():
    way = {"table": {"time": [0.0, 10.0, 30.0], "value": [0.1, -0.3, 0.1 + 1e-15]}}
    given = scene(way, weight=0.0)
    assert course(given).weight[-1] == 0.0 and told(given) == []


def test_a_heave_that_lifts_the_bit_off_in_every_period_is_told_by_its_least_weight_too():
    amplitude = 1.5 * WEIGHT / SPRING
    (said,) = told(scene({"harmonic": {"amplitude": amplitude, "period": 8.0}}, end=32.0))
    assert "125 kN at most" in said and ", and 0 N at least, at t = " in said
    when = float(said.split("at least, at t = ")[1].split(" s")[0])
    assert -1.5 * np.sin(2.0 * np.pi * when / 8.0) >= 1.0 and "single instants" not in said


STOPPED = [{"ramp": {"to": to, "over": 5.0, "at": at}} for to, at in ((3e-4, 0.0), (-1e-4, 10.0), (-2e-4, 10.0))]
UNEVEN = [{"ramp": {"to": to, "over": 5.0, "at": at}} for to, at in ((1e-4, 0.0), (2e-4, 0.0), (-3e-4, 10.0))]
NEVER = [{"constant": speed} for speed in (0.1, 0.2, -0.3)]


@pytest.mark.parametrize("terms", [STOPPED, UNEVEN, NEVER])
def test_a_block_that_stops_but_for_rounding_is_held(terms):
    """Sums of speeds that end at rest end at some 1e-20 m/s: neither raised, nor lowered onto what is not drilled."""
    given = scene(block={"velocity": {"sum": terms}}, torque={"static": 8e3, "kinetic": 4e3})
    found = course(given)
    assert found.feed == 0.0 and found.to_come == pytest.approx(found.weight[-1])
    assert found.still == (terms is NEVER) and (terms is not NEVER or not told(given))
    assert not any("raised" in text or "lower" in text for text in told(given))
