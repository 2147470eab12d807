"""Records of connections that the model makes, against the soft string of tests/references/soft_string.py."""

import csv
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from references import soft_string as reference

import tautline
from drillstring.twin.records import COLUMNS, UNITS, Connecting, connections, write
from drillstring.twin.states import RigStates
from tautline.twin.sources.opening import open_source

DATA = Path(__file__).parents[3] / "data"
ARC = 600.0 * np.radians(50.0)
STATIONS = [0.0, 600.0, 600.0 + ARC, 2100.0 + ARC]
FRICTION, BLOCK = 0.23, 300e3
HOW = Connecting(stand=30.0, speed=0.25, travel=16.0, rotary_speed=6.0, turning=20.0, in_slips=60.0)


@pytest.fixture(scope="module")
def record():
    scene = tautline.read(DATA / "jwell.yaml").replace(
        {
            "well.sections": [{"hold": 600.0}, {"build": {"radius": 600.0, "to": "50 deg"}}, {"hold": 1500.0}],
            "well.wall.friction": FRICTION,
            "string[0].length": 1600.0,
            "top.weight": BLOCK,
            "damping": {"structural": "30 ms"},
            "model.elements": 40,
            "solver.step": "10 ms",
        }
    )
    return scene, connections(scene, 2, HOW, seed=3)


def test_a_record_rises_in_time_and_has_one_string_length_in_each_connection(record):
    _, columns = record
    assert tuple(columns) == COLUMNS and len({values.size for values in columns.values()}) == 1
    steps = np.diff(columns["time"])
    assert steps.min() > 0.0 and (steps > 1.0).sum() == 1 and steps.max() == pytest.approx(HOW.drilling + 0.1)
    length = columns["bit_depth"] - columns["block"]
    moving = columns["hook_load"] > 1.2 * BLOCK
    stand = columns["time"] > columns["time"][np.argmax(steps)]
    assert length[moving & ~stand] == pytest.approx(1840.0, abs=0.1)
    assert length[moving & stand] == pytest.approx(1870.0, abs=0.1)


MOTION = {"tripping out": "pick_up", "tripping in": "slack_off", "rotating off bottom": "rotating"}
SETTLING, LEAVING = 4.0, 1.5
"""Times, s, at the beginning and at the end of a motion in which it is not steady: the string is stretched first."""


def steady(columns):
    """The rig of a record, and hook load and torque of its samples in steady motion, by stand and motion."""
    rig, stretches, before = RigStates(), {}, None
    for k, time in enumerate(columns["time"]):
        motion = MOTION.get(str(rig.add(time, **{name: columns[name][k] for name in COLUMNS[1:]})))
        key = motion and (len(rig.connections), motion)
        if key and key != before:
            stretches[key] = []  # of a motion that comes again the last time
        if key:
            stretches[key].append((time, columns["hook_load"][k], columns["torque"][k]))
        before = key
    found = {}
    for key, rows in stretches.items():
        time, *values = np.transpose(rows)
        kept = (time > time[0] + SETTLING) & (time < time[-1] - LEAVING)
        found[key] = [value[kept] for value in values]
    return rig, found


def test_hook_loads_and_torque_of_each_stand_are_those_of_the_soft_string(record):
    """Within 1 %: the steady parts have some hundred samples of 1 % noise, and the string is not quite calm."""
    _, columns = record
    rig, found = steady(columns)
    assert [one.added for one in rig.connections] == pytest.approx([30.0], abs=0.3)
    well = reference.well_from_survey(STATIONS, [0.0, 0.0, *2 * [np.radians(50.0)]], [0.0] * 4)
    assert set(found) == {(k, motion) for k in (0, 1) for motion in ("pick_up", "slack_off", "rotating")}
    for (stand, motion), (load, torque) in found.items():
        assert load.size > 30
        pipe = 1600.0 + HOW.stand * stand
        string = reference.String([(pipe, 0.127, 0.1086), (240.0, 0.165, 0.0572)])
        hole = reference.Well(well.tangent, well.curvature, pipe + 240.0, well.breaks)
        expected = BLOCK + reference.hook_load(hole, string, FRICTION, motion)
        assert load.mean() == pytest.approx(expected, rel=0.01)
        if motion == "rotating":
            assert torque.mean() == pytest.approx(reference.rotating_torque(hole, string, FRICTION), rel=0.02)


def test_noise_is_that_share_of_the_reading_and_the_same_for_the_same_seed(record):
    scene, columns = record
    again = connections(scene, 1, HOW, seed=3, noise={"hook_load": 0.02})
    clean = connections(scene, 1, HOW, noise={})
    part = again["hook_load"] / clean["hook_load"] - 1.0
    assert part.std() == pytest.approx(0.02, rel=0.1) and abs(part.mean()) < 0.002
    assert np.array_equal(again["torque"], clean["torque"])
    same = connections(scene, 1, HOW, seed=3, noise={"hook_load": 0.02})
    assert all(np.array_equal(again[name], same[name]) for name in COLUMNS)
    assert columns["time"].size == 2 * clean["time"].size


def test_a_record_is_written_as_csv_with_units_in_its_header_and_read_back(record, tmp_path):
    path = write(record[1], tmp_path / "rig.csv")
    with path.open(encoding="utf8") as file:
        rows = list(csv.DictReader(file))
    assert tuple(rows[0]) == tuple(f"{name} [{UNITS[name]}]" for name in COLUMNS)
    assert len(rows) == record[1]["time"].size
    assert [float(row["hook_load [N]"]) for row in rows] == record[1]["hook_load"].tolist()


def test_a_twin_reads_a_written_record_in_the_units_of_its_map(record, tmp_path):
    """Kilonewtons and turns a minute, as the manual's map of a rig has them: they were 1000 times and 9.5 times off."""
    path = write(record[1], tmp_path / "rig.csv")
    units = {"hook_load": "kN", "rotary_speed": "rpm", "torque": "kN m", "flow": "l/min", "block": "m"}
    with closing(open_source(str(path), list(units), units=units)) as source:
        rows = []
        while not source.ended:
            rows.append(source.poll(0.0))
    rows = [row for row in rows if row is not None]
    assert [row.time for row in rows] == record[1]["time"].tolist()
    factors = {"hook_load": 1e-3, "rotary_speed": 30.0 / np.pi, "torque": 1e-3, "flow": 6e4, "block": 1.0}
    for name, of_one in factors.items():
        assert np.allclose([row.values[name] for row in rows], of_one * record[1][name], rtol=1e-12, atol=0.0)
