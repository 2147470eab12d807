"""A twin watches the limits that its scene gives itself, but for what its map names."""

from math import pi

import numpy as np
import pytest
import yaml
from physics.cables.rope_text import chain, scene
from twin.rehearsal import CALM, SENSORS, alarms, at, changed, hoist, lines_of, rows_of

import tautline
from tautline.live.simulation import Simulation
from tautline.twin.map.check import bare_bounds, plan_of
from tautline.twin.map.file import read_map
from tautline.twin.map.names import names_of
from tautline.twin.twin import Twin
from tautline.twin.watch import Watch

LIMITS = [
    {"output": "winch.tension", "above": "80 kN", "for": "0.2 s", "name": "overload"},
    {"output": "min_tension", "below": "1 kN", "name": "slack"},
    {"output": "tension", "above": "90 kN", "name": "anywhere"},
    {"output": "payload.position[2]", "above": "29 m", "name": "height"},
    {"output": "dynamic_amplification", "above": 1.5, "name": "jerk"},
]


@pytest.fixture(scope="module")
def names():
    return names_of(Simulation(tautline.read(hoist(CALM) | {"limits": LIMITS}), keep=False))


def planned(names, more=""):
    return {one.name: one for one in plan_of(read_map(SENSORS + more), names, {}).alarms}


def test_limits_of_a_scene_are_watched_in_si_as_far_ahead_as_the_map_looks(names):
    found = planned(names, "ahead: 3 s\n")
    assert set(found) == {"overload", "slack", "anywhere"}
    overload, slack = found["overload"], found["slack"]
    assert (overload.target, overload.above, overload.lasting, overload.ahead) == ("winch.tension", 80e3, 0.2, 3.0)
    assert (slack.target, slack.below, slack.ahead) == ("min_tension", 1e3, 3.0)
    assert slack.above == float("inf") and overload.below == -float("inf")


def test_a_figure_of_a_whole_run_and_a_number_of_an_array_are_named_as_not_watched(names):
    assert names.unwatched == ("height", "jerk")


def test_what_the_map_watches_itself_takes_the_place_of_the_scene_s_limit(names):
    own = yaml.safe_dump({"watch": [
        {"output": "winch.tension", "above": "70 kN", "name": "mine"},
        {"output": "max_tension", "above": "95 kN", "name": "anywhere"},
        {"output": "min_tension", "above": "60 kN", "name": "other side"},
        {"residual": "winch.tension", "above": "4 sd", "name": "irregular"},
    ]})  # fmt: skip
    found = planned(names, own)
    assert set(found) == {"mine", "anywhere", "other side", "irregular", "slack"}
    assert found["mine"].above == 70e3 and found["anywhere"].target == "max_tension"


def test_an_overload_by_the_scene_s_own_limit_raises_an_alarm():
    rows = rows_of(hoist(CALM), end=4.5, rate=10.0)
    rows = changed(rows, lambda t, r: {**r, "rope_tension": r["rope_tension"] + 45.0 * (3.0 < t < 4.05)})
    lines = lines_of(Twin(hoist(CALM) | {"limits": LIMITS[:1]}, SENSORS), rows)
    raised = alarms(lines)["overload"]
    # It has to last for 0.2 s; rows come every 0.1 s.
    assert raised == pytest.approx(3.3, abs=0.11)
    assert "above 80 kN" in next(one["text"] for one in at(lines, raised)["alarms"] if one["name"] == "overload")


@pytest.mark.parametrize(("written", "low", "high"), [("[0, 600]", 0.0, 600e3), ("[0 kN, 2 MN]", 0.0, 2e6)])
def test_a_range_and_a_deviation_without_a_unit_are_in_that_of_the_sensor(written, low, high):
    map = f"sensors:\n  - {{column: pull, unit: kN, output: winch.tension, sd: 0.5, range: {written}, zero: 50}}\n"
    names = names_of(tautline.Simulation(hoist(CALM), keep=False))
    [one] = plan_of(read_map(map), names, {}).channels
    assert (one.low, one.high, one.sd) == pytest.approx((low, high, 500.0))
    assert one.shown == pytest.approx((50.0, 50.0 + 1e-3 * high))


def test_a_bound_without_a_unit_is_in_si_and_the_twin_says_so_where_the_sensor_is_in_another(names):
    watch = "watch:\n  - {output: winch.tension, above: 80}\n  - {output: winch.tension, below: 1 kN}\n"
    read = read_map(SENSORS + watch)
    plan = plan_of(read, names, {})
    assert plan.alarms[0].above == 80.0
    assert [one.name for one in plan.alarms[:2]] == ["winch.tension above 80 N", "winch.tension below 1 kN"]
    said = (
        "watch: `above: 80` of winch.tension has no unit and counts as 80 N. The sensor rope_tension is in kN. "
        "If the bound is too, write `above: 80 kN`"
    )
    assert bare_bounds(read, plan) == [said]
    assert said in Twin(hoist(CALM), SENSORS + watch).notes


def test_alarms_tell_values_in_the_unit_of_the_sensor_and_others_in_those_of_the_scene(names):
    plan = plan_of(read_map(SENSORS), names, {})
    watch = Watch(plan, [], None, "field")
    of = {one.target: watch._teller(one) for one in plan.alarms}
    assert of["winch.tension"](80e3) == "80 kN"
    # 1000 N over 4.4482 N/lbf.
    assert of["min_tension"](1e3).startswith("224.8 lbf") or of["min_tension"](1e3) == "0.2248 kip"


PIPE = """
well: {sections: [{hold: 1000 m}], diameter: 1 m, wall: none}
string: [{name: drill pipe, length: rest, od: 0.127, id: 0.1086}]
material: {youngs_modulus: 200 GPa, shear_modulus: 79 GPa, density: 7850 kg/m^3}
model: {kind: lumped, elements: 2}
gravity: 9.80665
limits: [{output: tension, above: ABOVE}, {output: tension, below: BELOW, name: push}]
start: static
solver: {method: generalized-alpha, rho_inf: 0.8, step: 1 ms, end: 2 s}
output: {interval: 0.1 s}
"""
HANGS = 7850.0 * pi / 4.0 * (0.127**2 - 0.1086**2) * 1000.0 * 9.80665
"""Weight of the pipe, which its upper end has for its tension; of two elements the middles have 3/4 and 1/4 of it."""
HOOK = """
sensors:
  - {column: hook, unit: kN, output: hook_load, sd: 5 kN}
  - {column: block, unit: m/s, input: top.block_speed}
"""


def pipe(above, below):
    return tautline.read(PIPE.replace("ABOVE", f"{above:.1f}").replace("BELOW", f"{below:.1f}"))


def hanging_rows():
    return [(0.1 * k, {"hook": 1e-3 * HANGS, "block": 0.0}) for k in range(1, 16)]


@pytest.mark.parametrize(("share", "least", "told"), [(0.9, -1.0, True), (1.1, -1.0, False), (1.1, 10.0, "push")])
def test_a_twin_watches_the_tension_at_the_ends_of_elements_that_a_run_is_judged_by(share, least, told):
    scene = pipe(share * HANGS, least)
    judged = {one["name"]: one["passed"] for one in tautline.simulate(scene).limits if one.get("output") == "tension"}
    raised = alarms(lines_of(Twin(scene, HOOK), hanging_rows()))
    assert {name for name in raised if name in judged} == {name for name, passed in judged.items() if not passed}
    assert [not passed for passed in judged.values()] == [told is True, told == "push"]


def test_what_is_read_live_has_the_tension_that_a_run_is_judged_by():
    sim = tautline.Simulation(pipe(0.9 * HANGS, -1.0))
    sim.advance(0.1)
    assert sim["largest_tension"].tolist() == pytest.approx([HANGS, 0.5 * HANGS], rel=1e-5)
    assert sim["least_tension"].tolist() == pytest.approx([0.5 * HANGS, 0.0], rel=1e-5, abs=1e-5 * HANGS)
    assert sim["tension"].max() == pytest.approx(0.75 * HANGS, rel=1e-5)


def bar_of_two_elements():
    """A bar held at its first node, with 0.01 N along it at the last one (speed of waves 1 m/s)."""
    p = np.linspace(0.0, 1.0, 3)
    items = chain(
        np.stack([p, 0 * p, 0 * p], 1), p, {0: (1,) * 4, 1: (0, 1, 1, 1), 2: (0, 1, 1, 1)}, EA=1.0, linear=True
    )
    load = "  - PointForce: {id: 9, nodes4: [2], force: [0.01, 0, 0]}\n"
    return scene(items + load, gravity=(0, 0, 0), time_step=0.01, time_end=2.0, start='"as given"')


BAR_MAP = """
sensors: [{{column: n0, unit: N, output: element 0.{sensor}, sd: 0.5 mN}}]
watch: [{{output: element 0.{watched}, above: {bound} N, name: overload}}]
"""


def of_a_bar(watched, reading, bound=0.5, sensor="axial_force"):
    """Texts of the alarm `overload` of a bar whose true force is 0.01 N at most, from a record of its sensor."""
    record = [(0.05 * k, {"n0": reading if k > 10 else 0.0}) for k in range(21)]
    twin = Twin(tautline.read(bar_of_two_elements()), BAR_MAP.format(sensor=sensor, watched=watched, bound=bound))
    return [one["text"] for line in lines_of(twin, record) for one in line["alarms"] if one["name"] == "overload"]


@pytest.mark.parametrize("sensor", ["axial_force", "largest_axial_force"])
def test_a_reading_of_an_element_s_force_beyond_its_bound_raises_the_alarm_that_is_asked_for_by_name(sensor):
    texts = of_a_bar("axial_force", 0.9, sensor=sensor)
    assert texts and set(texts) == {"element 0.axial_force measured: 0.9 N, above 0.5 N"}
    assert of_a_bar("axial_force", 0.4, sensor=sensor) == []


def test_what_is_computed_is_judged_at_the_ends_and_told_by_the_name_that_was_asked():
    texts = of_a_bar("axial_force", 0.0, bound=0.005)
    assert texts and all(text.startswith("element 0.axial_force computed: ") for text in texts)


def test_a_watch_of_a_map_on_tension_is_of_the_ends_of_elements_too():
    names = names_of(tautline.Simulation(pipe(1.1 * HANGS, -1.0), keep=False))
    own = "watch: [{output: tension, above: 200 kN}, {output: tension, below: 1 N, name: loose}]\n"
    found = {one.name: one.target for one in plan_of(read_map(HOOK + own), names, {}).alarms}
    assert found == {"tension above 200 kN": "largest_tension", "loose": "least_tension"}
