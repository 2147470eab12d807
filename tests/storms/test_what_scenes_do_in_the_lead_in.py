"""What a scene does by itself in the lead-in, behind the storm or once in it, `operability` tells: storms miss it."""

from __future__ import annotations

from dataclasses import replace

import pytest
from cli.in_process import commands_of, leave_out_pixels
from storms.test_operability import ALONE, SCENE, asked

import tautline
from crane.application import Crane
from crane.operability.conditions import sea_keys
from crane.operability.single_events import event_notes, events_of, lead_notes
from crane.operability.storms import operability

WINCH = """\
  - drum: {name: winch, center: [0, 0, 10], radius: 0.4, axis: [0, 1, 0], wrap: over, pay_out: 0}
  - sheave: {name: tip, center: [10, 0, 20], radius: 0.2, axis: [0, 1, 0], wrap: over}
"""
AT_A_WINCH = SCENE.replace("  - anchor: {name: tip, position: [0, 0, 10]}\n", WINCH).replace(
    "[0, 0, 0]}", "[10.2, 0, 0]}"
)
JERK = {"table": {"time": [0, 20, 20.5, 21, 21.5, 400], "value": [0, 0, -2, -2, 0, 0], "interpolation": "linear"}}
RAMP = {"ramp": {"to": "10 kN", "at": 50, "over": 3}}
SOFT = {"rope.mass_per_length": 1.0, "rope.axial_stiffness": 2e7}
PLACE = "path[0].drum.pay_out"


def with_changes(changes):
    return tautline.read(AT_A_WINCH).replace(changes)


def notes(changes, lead=100.0, judged=True, duration=600.0, simulated=None):
    made = with_changes(changes)
    given = replace(asked((1.0,), 3, duration, simulated), lead=lead)
    return event_notes(made, sea_keys(made, False), given, judged)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({PLACE: JERK}, f"{PLACE} from 20 s to 21.5 s"),
        ({PLACE: {"sum": [0.1, JERK]}}, f"{PLACE} from 20 s to 21.5 s"),
        ({PLACE: {"ramp": {"to": -0.5, "over": 2}}}, f"{PLACE} from 0 s to 2 s"),
        ({"bodies[0].release": {"at": 30, "remaining": 1000}}, "bodies[0].release at 30 s"),
        ({"bodies[0].force": [RAMP, 0, 0]}, "bodies[0].force[0] from 50 s to 53 s"),
        ({"vessel.motion.surge": {"ramp": {"to": 5, "at": 60, "over": 9}}}, "vessel.motion.surge from 60 s to 69 s"),
        (
            {"frames": [{"name": "boom", "pivot": [0, 0, 0], "slew": {"ramp": {"to": "20 deg", "at": 10, "over": 40}}}],
             "path[1].sheave.frame": "boom"},
            "frames[0].slew from 10 s to 50 s",
        ),
    ],
)  # fmt: skip
def test_every_kind_of_event_in_the_lead_in_is_told_with_its_key_and_time(changes, said):
    (one,) = notes(changes)
    assert said in one and "lead-in of 100 s" in one and "add 100 s to its times" in one
    # A lead-in that ends before has it counted.
    begin = events_of(with_changes(changes))[0].begin
    assert begin == 0.0 or notes(changes, lead=begin) == []


def test_a_brake_that_opens_in_the_lead_in_is_told():
    brake = {"torque": "200 kN m", "until": 40}
    (one,) = notes({"path[0].drum": {
        "name": "winch", "center": [0, 0, 10], "radius": 0.4, "axis": [0, 1, 0], "wrap": "over", "torque": 20000,
        "inertia": 2000, "brake": brake,
    }})  # fmt: skip
    assert "path[0].drum.brake.until at 40 s" in one


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {PLACE: -0.001},
        {PLACE: {"table": {"time": [0, 50], "value": [0.1, 0.1]}}},
        {PLACE: {"ramp": {"from": 0.1, "to": 0.1, "over": 3}}},
        {PLACE: {"harmonic": {"amplitude": 0.1, "period": 9, "ramp": 20}}},
        {PLACE: {"ramp": {"rate": -0.001, "over": 2, "at": 5}}},
        {"vessel.motion.heave.spectrum.ramp": 30},
        {"vessel.motion.roll": {"harmonic": {"amplitude": 0.01, "period": 9}}},
    ],
)
def test_a_growing_sea_and_what_goes_on_all_the_time_are_no_events(changes):
    assert notes(changes) == []


def test_a_lead_in_that_is_too_short_for_the_sea_is_not_offered():
    at = {"bodies[0].release": {"at": 10, "remaining": 1000}}
    assert "--lead-in" not in notes(at)[0] and "10 s becomes 110 s" in notes(at)[0]
    at["bodies[0].release"]["at"] = 20
    assert "Give --lead-in 20s" in notes(at)[0]
    assert "--lead-in" not in notes(at | {"vessel.motion.heave.spectrum.ramp": 30})[0]


def test_what_comes_behind_the_storm_and_what_is_scaled_in_it_are_told():
    release = {"bodies[0].release": {"at": 150, "remaining": 1000}}
    assert notes(release) == [], "a storm as long as the operation has it once, as the operation has"
    (scaled,) = notes(release, simulated=60.0)
    assert "bodies[0].release at 150 s" in scaled and "--simulate 600s" in scaled
    assert notes(release, simulated=60.0, judged=False) == []
    (never,) = notes(release, duration=40.0)
    assert "storms end at 140 s" in never and "bodies[0].release at 150 s" in never


def test_of_what_outlasts_the_lead_in_only_the_first_part_is_unjudged():
    """50 s to 53 s around a lead-in of 52 s: the force is there in the storm, but for its first 2 s."""
    (told,) = notes({"bodies[0].force": [RAMP, 0, 0]}, lead=52.0)
    assert "bodies[0].force[0] from 50 s to 53 s. No limit judges its first part" in told
    assert "judges it:" not in told and "does this" not in told and "50 s becomes 102 s" in told
    (told,) = notes({"bodies[0].force": [RAMP, 0, 0]}, lead=53.0)
    assert "bodies[0].force[0] from 50 s to 53 s. No limit judges it" in told and "first part" not in told
    # Each by itself, also in one sum.
    (told,) = notes({PLACE: {"sum": [RAMP | {"ramp": {"to": 1, "at": 50, "over": 60}}, JERK]}})
    assert f"does this in it: {PLACE} from 20 s to 21.5 s. No limit judges it" in told
    assert f"begins this in it: {PLACE} from 50 s to 110 s. No limit judges its first part" in told


@pytest.mark.parametrize("end", [300.0, 75.0])
def test_of_a_motion_that_goes_on_through_most_of_a_storm_nothing_is_called_unjudged(end):
    """Storms from 5 s to 125 s."""
    times = [0.0, 0.1 * end, 0.8 * end, end]
    table = {"table": {"time": times, "value": [0, 0.1, -0.1, 0]}}
    assert notes({PLACE: table}, lead=5.0, duration=120.0) == []
    mixed = {"sum": [table, {"ramp": {"to": 0.1, "at": 1, "over": 2}}]}
    (told,) = notes({PLACE: mixed}, lead=5.0, duration=120.0)
    assert f"{PLACE} from 1 s to 3 s. No limit judges it" in told and f"{end:g} s" not in told


def test_a_record_that_goes_on_all_through_a_storm_is_no_single_event():
    table = {"table": {"time": [0, 500, 1000], "value": [0, 0.01, 0], "interpolation": "linear"}}
    assert not any("once" in one for one in notes({PLACE: table}, simulated=300.0))


def test_the_jerk_that_simulate_finds_is_among_the_warnings_of_storms_that_miss_it():
    """The largest tension of the whole run is that of the jerk: the storms' is far below, and that is said."""
    made = with_changes({PLACE: JERK, "solver.step": 0.1, "output.interval": 0.1, **SOFT})
    run = tautline.simulate(made.replace({"solver.end": 30.0}))
    given = replace(asked((0.3,), 3, 40.0, limits=["max_tension < 65 kN"]), lead=30.0)
    found = operability(Crane(), made, given, ALONE)
    assert run.headline["max_tension"]["value"] > 65e3
    assert found.table.allowable[0, 0, 0].height == 0.3
    (one,) = [text for text in found.warnings if PLACE in text]
    assert one in found.said_before


def test_a_lead_in_shorter_than_a_wave_is_told():
    assert lead_notes(replace(asked(), lead=8.0)) == []
    assert "shorter than one wave of 8 s" in lead_notes(replace(asked(), lead=5.0))[0]


def test_words_of_the_command(tmp_path, monkeypatch, capsys):
    """No lead-in has a cure that lets the sea grow; a range that misses its end says so; P99.99999 is not P100."""
    monkeypatch.chdir(tmp_path)
    drops = AT_A_WINCH.replace("[10.2, 0, 0]}", "[10.2, 0, 0], release: {at: 35, remaining: 1 t}}")
    (tmp_path / "sea.yaml").write_text(drops.replace("end: 100 s", "end: 30 s"))
    leave_out_pixels(monkeypatch)
    run = commands_of(Crane(), capsys)
    given = ["operability", "sea.yaml", "--tp", "8", "--seeds", "3", "--duration", "20 s"]
    given += ["--limit", "max_tension < 65 kN"]
    code, _, err = run(*given, "--hs", "1", "--lead-in", "0")
    assert code == 2 and "such as 100 s" in err
    code, out, err = run(*given, "--hs", "0.2:0.5:0.2", "--lead-in", "20 s", "--percentile", "P99.99999")
    text = " ".join((out + err).split())
    assert code == 0 and "--hs 0.2:0.5:0.2 ends at 0.4 m: its step does not meet 0.5 m" in text
    assert "P99.99999" in text and "P100" not in text
    assert "never drops" not in text, "the storm ends at 40 s, whatever the end of the scene's own run"
