"""Hook gauges by which a string stands in slips for ever, and those of rigs whose string does stand there."""

import itertools
import math

import pytest
from well_of_a_rig import VERTICAL, well

from drillstring.twin.slips import Expected, Slips
from tautline.twin.storage import load, save
from tautline.twin.twin import Twin

EMPTY, STRING = 300.0, 500.0
"""What the gauge shows of the empty block, kN, and about what the string of 2400 m weighs in mud."""
KIP = 4.4482216
"""kN."""
MAP = """
sensors:
  - {column: block, unit: m, input: top.block, zero: first}
  - {column: rpm, unit: rpm, input: top.rotary_speed}
  - {column: hook, unit: kN, output: top.hook_load, sd: 2 kN, zero: ZERO}
  - {column: torque, unit: kN m, output: surface_torque, sd: 0.2 kN m}
ahead: 0 s
"""
FAR_OFF = "hook far off"


def twin(zero="300", weight="300 kN"):
    scene = well(VERTICAL, "10 s", "1 s").replace("top: {", f"top: {{weight: {weight}, ")
    return Twin(scene, MAP.replace("ZERO", zero))


def rows(count, hook, rpm=0.0, torque=0.0, begin=0, apart=1):
    """Rows a second or more apart, with some noise of the gauge; the block goes up and down by two metres."""
    for t in range(begin, begin + count * apart, apart):
        load = hook(t) if callable(hook) else hook
        noise = 1.5 * math.sin(7.0 * t) + 1.0 * math.sin(31.0 * t)
        block = 1.0 - math.cos(0.1 * t)
        yield float(t), {"block": block, "rpm": rpm, "hook": load + noise, "torque": torque + 0.05 * math.sin(t)}


def lines_of(twin, *parts):
    return [line for t, values in itertools.chain(*parts) for line in twin.add(t, values)] + twin.finish()


def alarms_of(lines):
    return {alarm["name"] for line in lines for alarm in line["alarms"]}


@pytest.mark.parametrize(
    "shown", [0.0, (EMPTY + STRING) / KIP, lambda t: (EMPTY + STRING * (t > 40)) / KIP],
    ids=["dead at zero", "in kip", "in kip, slips first"],
)  # fmt: skip
def test_a_gauge_far_below_the_empty_hook_is_far_off_and_health_is_degraded(shown):
    lines = lines_of(twin(), rows(120, shown, rpm=100.0, torque=6.0))
    assert FAR_OFF in alarms_of(lines[:60])
    assert {line["health"] for line in lines[60:]} == {"degraded"}
    (alarm,) = lines[-1]["alarms"]
    assert "kN less than the empty hook would" in alarm["text"]


@pytest.mark.parametrize(("zero", "weight"), [("first", "300 kN"), ("0", "0 kN")])
def test_a_string_that_turns_with_torque_for_long_does_not_stand_in_slips(zero, weight):
    # By a gauge that is dead, and was tared: nothing is below the empty hook.
    lines = lines_of(twin(zero, weight), rows(120, 0.0, rpm=100.0, torque=6.0))
    assert {line["rig"]["state"] for line in lines[1:]} <= {"in slips", "connection"}
    assert FAR_OFF in alarms_of(lines) and lines[-1]["health"] == "degraded"
    assert "by hook the string stands in slips, and it turns with" in lines[-1]["alarms"][0]["text"]


@pytest.mark.parametrize("weight", [1.0, 0.9, 0.85], ids=["as stated", "a tenth lighter", "a seventh lighter"])
def test_a_string_in_slips_for_long_is_no_fault_though_blocks_are_lighter_and_joints_are_made_up(weight):
    empty = weight * EMPTY
    made_up = rows(20, empty, rpm=20.0, torque=30.0, begin=200)
    set_down = rows(15, 0.5 * empty, begin=220)
    lines = lines_of(twin(), rows(200, empty), made_up, set_down, rows(60, empty, begin=235))
    assert {line["rig"]["state"] for line in lines[1:]} <= {"in slips", "connection"}
    assert alarms_of(lines) == set() and {line["health"] for line in lines[1:]} == {"good"}


def test_an_idle_drive_that_turns_in_slips_is_no_fault():
    lines = lines_of(twin("first"), rows(200, EMPTY, rpm=100.0, torque=0.5))
    assert alarms_of(lines) == set()


@pytest.mark.parametrize("apart", [20, 31, 60])
@pytest.mark.parametrize(
    ("hook", "rpm", "torque"), [(0.4 * EMPTY, 0.0, 0.0), (EMPTY, 20.0, 30.0)], ids=["set down", "made up"]
)
def test_one_row_of_those_that_come_slowly_is_no_sign_of_a_wrong_gauge(apart, hook, rpm, torque):
    before, after = (rows(8, EMPTY, begin=begin, apart=apart) for begin in (0, 9 * apart))
    lines = lines_of(twin(), before, rows(1, hook, rpm, torque, begin=8 * apart, apart=apart), after)
    assert alarms_of(lines) == set()


@pytest.mark.parametrize("apart", [5, 20, 60])
def test_a_dead_gauge_is_found_also_by_rows_that_come_slowly(apart):
    assert FAR_OFF in alarms_of(lines_of(twin(), rows(8, 0.0, apart=apart)))


@pytest.mark.parametrize(("lasts", "raised"), [(100, False), (280, False), (340, True)])
def test_a_gauge_that_has_shown_the_string_is_not_accused_while_a_rotary_table_turns_it_in_slips(
    tmp_path, lasts, raised
):
    drilled, turned = rows(30, EMPTY + STRING, begin=15), rows(lasts, EMPTY, 20.0, 5.0, begin=60)
    one, again = twin(), twin()
    lines_of(one, rows(15, EMPTY), drilled, rows(15, EMPTY, begin=45))
    save(one, tmp_path / "a.state")
    load(again, tmp_path / "a.state")
    lines = lines_of(again, turned)
    assert (FAR_OFF in alarms_of(lines)) == raised
    texts = [alarm["text"] for line in lines for alarm in line["alarms"]]
    assert all("or the rotary table turns the string in slips" in text for text in texts)


def test_the_alarm_names_a_block_that_pushes_the_string():
    # A liner is pushed by 100 kN of the block's weight.
    (alarm,) = lines_of(twin(), rows(60, EMPTY - 100.0))[-1]["alarms"]
    assert alarm["name"] == FAR_OFF and "or the block is set down or pushes the string" in alarm["text"]


def test_the_alarm_ends_once_the_gauge_shows_the_string():
    lines = lines_of(twin(), rows(60, 0.0), rows(30, EMPTY, begin=60))
    assert FAR_OFF in alarms_of(lines) and lines[-1]["alarms"] == []


def test_the_summary_says_for_how_long_the_string_stood_in_slips():
    one = twin()
    lines_of(one, rows(101, EMPTY))
    assert one.operation.summary() == [("in slips or connection", "100 s of 100 s; nothing is compared there")]


def test_a_twin_that_goes_on_has_the_alarm_and_the_time_in_slips_still(tmp_path):
    one, again = twin(), twin()
    lines_of(one, rows(61, 0.0))
    save(one, tmp_path / "a.state")
    load(again, tmp_path / "a.state")
    (line, *_) = lines_of(again, rows(1, 0.0, begin=61))
    assert [alarm["name"] for alarm in line["alarms"]] == [FAR_OFF] and line["health"] == "degraded"
    assert again.operation.summary()[0][1].startswith("61 s of 61 s")


def test_times_in_slips_of_an_earlier_program_are_taken_over():
    slips = Slips()
    slips.recall([61.0, 60.0])
    assert slips.memory() == [61.0, 60.0, 0.0]


def test_a_first_row_in_which_nothing_is_known_of_the_rig_is_no_sign_that_the_gauge_has_shown_the_string():
    by = Expected(empty=0.0, below=1.0e5, torque=1.0e3)
    slips = Slips()
    slips.add(0.0, False, 2.0e5, 5.0e3, by, known=False)
    assert not slips.carried
    slips.add(1.0, False, 2.0e5, 5.0e3, by)
    assert slips.carried
