"""A twin that goes on from a saved state, or as a copy, says what it would have said: to the bit."""

import copy
import json
from dataclasses import make_dataclass
from typing import NamedTuple

import numpy as np
import pytest
from of_the_suite import studies
from twin.rehearsal import STILL, WEIGHT, calm_rows, weight_twin

from tautline.results.errors import ResultError
from tautline.twin.memory import RECORDS
from tautline.twin.packing import Held, Packing, Unpacking
from tautline.twin.signals.row import Row
from tautline.twin.signals.rows import Rows
from tautline.twin.storage import load, save
from tautline.twin.twin import Twin

LOST, GAP = (4.0, 6.0), (8.0, 9.5)
END = 12.0
SAVED = {"a window half gone through": 3.3, "an input that is lost": 5.1, "a gap": 8.9, "an alarm": 10.3}
"""What is under way, and the time of the first row that the twin was not given, s."""
TOLD = 2.0
"""For how long lines are compared, s."""


def bad_rows():
    """Rows of which a sensor is lost for a while, and some are missing."""
    rows = [row for row in calm_rows() if row[0] < END and not GAP[0] < row[0] < GAP[1]]
    lost = {"winch_pos": np.nan}
    return [(t, readings | (lost if LOST[0] < t < LOST[1] else {})) for t, readings in rows]


def made():
    """Its bound is passed by each swing, so that an alarm is on now and then."""
    return weight_twin(start="5 t", map=WEIGHT.replace("above: 80 kN", "above: 50 kN") + "restrict: true\n")


def said_of(twin, rows):
    """Lines of rows as texts; how long each took is of no account."""
    lines = []
    for stamp, readings in rows:
        lines += twin.add(stamp, readings)
        twin.work()
    return [json.dumps(line | {"lag": 0.0}, sort_keys=True) for line in lines]


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """Lines of a twin that was not stopped; its states and copies by what was under way, with the lines before."""
    folder, twin, lines = tmp_path_factory.mktemp("states"), made(), []
    kept, under_way = {}, {}
    for stamp, readings in bad_rows():
        for name, time in SAVED.items():
            if name not in kept and stamp >= time:
                save(twin, folder / name)
                kept[name] = folder / name, copy.deepcopy(twin), len(lines), stamp
                under_way[name] = twin.estimate.relinearising, bool(twin.watch.alarms.active)
        lines += said_of(twin, [(stamp, readings)])
    assert any(one for one, _ in under_way.values()) and any(one for _, one in under_way.values())
    return lines, kept


@pytest.mark.parametrize(
    ("way", "name"),
    [
        *(("loaded", name) for name in SAVED if name != "an alarm"),
        ("copied", "an alarm"),
        *studies(("loaded", "an alarm"), *(("copied", name) for name in SAVED if name != "an alarm")),
    ],
)
def test_what_goes_on_says_to_the_bit_what_one_says_that_was_not_stopped(whole, name, way):
    lines, kept = whole
    path, twin, before, time = kept[name]
    twin = copy.deepcopy(twin) if way == "copied" else made()
    if way == "loaded":
        load(twin, path)
    found = said_of(twin, [row for row in bad_rows() if time <= row[0] < time + TOLD])
    assert len(found) > 3 and found == lines[before : before + len(found)]


def test_rows_that_wait_when_the_state_is_saved_may_come_again_and_count_once(whole):
    lines, kept = whole
    path, _, before, time = kept["a window half gone through"]
    twin = made()
    begin = load(twin, path)
    rows = [row for row in bad_rows() if begin < row[0] < time + TOLD]
    assert rows[0][0] < time
    found = said_of(twin, rows)
    assert found == lines[before : before + len(found)]
    assert not twin.readings.rows.counts["doubled"]


def test_a_copy_looks_ahead_from_its_own_estimate(whole):
    _, kept = whole
    twin = kept["an alarm"][1]
    other = copy.deepcopy(twin)
    own = other.outlook.estimated.__self__
    assert own is other.estimate and own is not twin.estimate


@pytest.mark.parametrize("way", ["loaded", "copied"])
def test_a_run_ahead_that_is_under_way_comes_to_the_same_in_a_twin_that_goes_on(whole, tmp_path, way):
    twin = made()
    load(twin, whole[1]["an alarm"][0])
    twin.work()
    for row in [row for row in bad_rows() if row[0] >= SAVED["an alarm"]]:
        twin.add(*row)
        if twin.work(1e-4):
            break
    assert twin.outlook._job is not None
    save(twin, tmp_path / "state")
    other = copy.deepcopy(twin) if way == "copied" else made()
    if way == "loaded":
        load(other, tmp_path / "state")
    twin.work()
    assert other.outlook.found != twin.outlook.found
    other.work()
    assert other.outlook.found == twin.outlook.found
    assert other.outlook.restricted == twin.outlook.restricted


def test_a_state_of_an_earlier_program_that_kept_less_is_read(whole, tmp_path):
    path, first, *_ = whole[1]["an alarm"]
    with np.load(path) as file:
        np.savez(tmp_path / "old.npz", **{name: file[name] for name in file.files if not name.startswith("held")})
    twin = made()
    assert load(twin, tmp_path / "old.npz") == first.now
    assert np.array_equal(twin.estimate.horizon.mean, first.estimate.horizon.mean)
    assert len(said_of(twin, [row for row in bad_rows() if row[0] > first.now])) > 3


def test_a_window_that_an_earlier_program_kept_counts_as_one_that_has_come_though_it_kept_not_when_it_began(
    whole, tmp_path
):
    path, first, *_ = whole[1]["an alarm"]
    with np.load(path) as file:
        words = json.loads(file["words"].tobytes())
        del words["found"]
        kept = {name: file[name] for name in file.files if not name.startswith("held")}
    np.savez(tmp_path / "old.npz", **{**kept, "words": np.frombuffer(json.dumps(words).encode(), np.uint8)})
    twin = made()
    load(twin, tmp_path / "old.npz")
    horizon = twin.estimate.horizon
    assert first.now - horizon.window - 0.3 < horizon.begun < first.now - horizon.window + 0.3
    assert horizon.has_seen_a_window


@pytest.mark.parametrize(
    "held", [b"{", b"[]", b'{"pairs": [["some", {"same": 7}]]}', b'{"record": "os:system", "number": 0, "of": {}}']
)
def test_a_state_with_a_damaged_part_is_refused_and_changes_nothing(whole, tmp_path, held):
    with np.load(whole[1]["a gap"][0]) as file:
        np.savez(tmp_path / "bad.npz", **{**file, "held": np.frombuffer(held, np.uint8)})
    twin = made()
    with pytest.raises(ResultError, match="is no state of a twin"):
        load(twin, tmp_path / "bad.npz")
    assert np.isnan(twin.now)


def edited(path, to, edit):
    """A state of which what is held was edited."""
    with np.load(path) as file:
        held = json.loads(file["held"].tobytes())
        edit(dict(held["pairs"]))
        np.savez(to, **{**file, "held": np.frombuffer(json.dumps(held).encode(), np.uint8)})


def without(part, name):
    """An edit that takes one of the pairs of a part away."""

    def edit(held):
        pairs = held[part]["pairs"]
        pairs[:] = [one for one in pairs if one[0] != name]

    return edit


def record_of(held, name):
    """The first record of a name."""
    if isinstance(held, dict) and str(held.get("record", "")).endswith(name):
        return held
    parts = held.values() if isinstance(held, dict) else held if isinstance(held, list) else ()
    return next((found for one in parts if (found := record_of(one, name)) is not None), None)


EDITS = {
    "no twin": without("some", "twin"), "no watch": without("some", "watch"),
    "no states": lambda held: dict(held["families"]["pairs"])["family"]["pairs"].pop(0),
    "a part that is none": lambda held: held["whole"]["pairs"].append(["rows", 3]),
    "a record with less": lambda held: record_of(held, ":Row")["of"].pop("raw"),
    "a record of an unknown class": lambda held: record_of(held, ":Row").update(record="tautline.twin.rows:Line"),
}  # fmt: skip


@pytest.mark.parametrize("name", EDITS)
def test_a_state_of_a_program_with_other_parts_is_refused_whole_and_changes_nothing(whole, tmp_path, name):
    edited(whole[1]["a gap"][0], tmp_path / "other.npz", EDITS[name])
    twin = made()
    before = twin.estimate.horizon.mean.copy(), [state.block.tobytes() for state in twin.estimate.family.save()]
    with pytest.raises(ResultError, match="another version of the program"):
        load(twin, tmp_path / "other.npz")
    assert np.isnan(twin.now) and np.array_equal(twin.estimate.horizon.mean, before[0])
    assert [state.block.tobytes() for state in twin.estimate.family.save()] == before[1]


def test_a_record_that_lacks_what_has_a_default_is_one_of_an_earlier_program_and_is_read(whole, tmp_path):
    path, first, *_ = whole[1]["a gap"]
    edited(path, tmp_path / "earlier.npz", lambda held: record_of(held, ":Row")["of"].pop("begins"))
    twin = made()
    assert load(twin, tmp_path / "earlier.npz") == first.now and not twin.readings.rows.past[0].begins


def test_a_twin_of_an_earlier_program_that_kept_nothing_of_losses_has_simulated_something(whole, tmp_path):
    path, first, *_ = whole[1]["a gap"]
    edited(path, tmp_path / "earlier.npz", without("whole", "loss"))
    twin = made()
    assert not twin.loss.begun
    assert load(twin, tmp_path / "earlier.npz") == first.now and twin.loss.begun


@pytest.mark.parametrize("name", ["tracks", "scene", "sample_y"])
def test_a_state_that_lacks_something_is_refused_and_changes_nothing(whole, tmp_path, name):
    with np.load(whole[1]["a gap"][0]) as file:
        words = json.loads(file["words"].tobytes())
        arrays = {key: value for key, value in file.items() if key != name}
        words.pop(name, None)
        np.savez(tmp_path / "less.npz", **arrays | {"words": np.frombuffer(json.dumps(words).encode(), np.uint8)})
    twin = made()
    with pytest.raises(ResultError, match="is no state of a twin"):
        load(twin, tmp_path / "less.npz")
    assert np.isnan(twin.now)


WATCHED = """
sensors: [{column: load, unit: kN, output: winch.tension, sd: 0.5 kN}]
watch:
  - {output: winch.tension, above: 80 kN, name: overload}
  - {output: winch.tension, above: 80 kN, for: 2 s, name: lasting}
ahead: 0 s
"""


@pytest.mark.parametrize("layout", ["the same", "another"])
def test_an_overload_whose_cell_is_silent_is_not_over_in_a_twin_that_goes_on_whatever_its_simulations_hold(
    layout, tmp_path
):
    """84 kN from 0.5 s to 1.4 s, saved as the cell is silent, and again from 4 s on: for 2 s and more, then."""

    def lines(twin, begin, end):
        noise = 0.1 * np.sin(37.0 * np.arange(50) ** 2)
        shown = [49.0] * 5 + [84.0] * 10 + [np.nan] * 25 + [84.0] * 10
        rows = [(0.1 * k, [shown[k] + noise[k]]) for k in range(begin, end)]
        return [
            (
                line["time"],
                {one["name"]: one["known"] for one in line["alarms"] if one["name"] in ("overload", "lasting")},
            )
            for row in rows
            for line in twin.add(*row)
        ]

    first = Twin(STILL, WATCHED)
    lines(first, 0, 20)
    save(first, tmp_path / "state")
    with np.load(tmp_path / "state") as file:
        words = json.loads(file["words"].tobytes())
        words |= {"layout": "of another version"} if layout == "another" else {}
        np.savez(tmp_path / "own.npz", **{**file, "words": np.frombuffer(json.dumps(words).encode(), np.uint8)})
    second = Twin(STILL, WATCHED)
    load(second, tmp_path / "own.npz")
    assert bool([note for note in second.notes if "another version" in note]) == (layout == "another")
    found = lines(second, 20, 50)
    silent = [alarms for time, alarms in found if 2.45 < time < 3.95]
    again = [alarms for time, alarms in found if 3.95 < time < 4.5]
    assert len(silent) == 15 and all(one == {"overload": False} for one in silent)
    assert len(again) >= 5 and all(one == {"overload": True, "lasting": True} for one in again)


@pytest.mark.parametrize("gap", [0.0, 200.0])
def test_the_time_of_a_bound_begins_anew_behind_a_long_gap_in_rows_however_late_its_sensor_is_lost(gap):
    """84 kN from 0.5 s on, with `for: 2 s`, and a gap behind 1.4 s."""
    twin, noise = Twin(STILL, WATCHED + "lost: 10 min\n"), 0.1 * np.sin(37.0 * np.arange(50) ** 2)
    lasting = []
    for k in range(50):
        shown = (84.0 if k >= 5 else 49.0) + noise[k]
        for line in twin.add(0.1 * k + gap * (k >= 15), [shown]):
            lasting += [line["time"] - gap for one in line["alarms"] if one["name"] == "lasting"]
    assert lasting[0] == pytest.approx(2.5 if gap == 0.0 else 3.5)


def differences(a, b, path="twin"):
    """Names of numbers that two things of a twin do not share."""
    if type(a) is not type(b):
        return [path]
    if isinstance(a, np.ndarray):
        return [] if a.shape == b.shape and a.tobytes() == b.tobytes() else [path]
    if isinstance(a, dict):
        keys = [] if list(a) == list(b) else [path]
        return keys + [one for key in a if key in b for one in differences(a[key], b[key], f"{path}.{key}")]
    if isinstance(a, str) or not (hasattr(a, "__len__") or hasattr(a, "__dict__")):
        return [] if a == b or (a != a and b != b) else [path]
    if hasattr(a, "__len__"):
        if isinstance(a, (set, frozenset)) or len(a) != len(b):
            return [] if a == b else [path]
        return [one for x, y in zip(a, b, strict=True) for one in differences(x, y, path)]
    return differences(vars(a), vars(b), path) if type(a).__module__.startswith("tautline.twin") else []


OF_THIS_PROCESS = (
    "_kept", "_job", "sim", "found", "factor", "limited_by", "simulations", "notes", "_remarks", "_come_as_measured",
    "taken",
)  # fmt: skip
"""Of one process only, or written before it is read: rows that may come again, what runs ahead, what was told."""


def test_nothing_is_left_out_of_a_state_whatever_a_part_of_a_twin_holds(whole):
    path, first, *_ = whole[1]["an alarm"]
    twin = made()
    load(twin, path)
    own = {name: value for name, value in vars(first).items() if name not in ("scene", "map", "application", "notes")}
    parts = [differences(value, vars(twin)[name], name) for name, value in own.items() if name != "outlook"]
    lost = {one for part in parts for one in part if one.rsplit(".", 1)[-1] not in OF_THIS_PROCESS}
    # The spare family is put anew before it goes through a window.
    assert {one for one in lost if not one.startswith("estimate.spare") or first.estimate.relinearising} == set()


def test_packed_values_are_the_same_to_the_bit_and_what_was_one_is_one_again():
    row = Row(1.5, np.array([np.nan, -0.0, 0.1 + 0.2]), places=[3])
    held = {"a": [row, row.values], "b": row, "c": (np.float64(1 / 3), -np.inf, None, "é"), "d": {2: {"x"}}}
    packing = Packing([Row])
    words = json.dumps(packing.packed(held))
    found = Unpacking([Row], packing.data).value(json.loads(words))
    assert found["a"][0] is found["b"] and found["a"][1] is found["b"].values
    assert found["b"].values.tobytes() == row.values.tobytes() and vars(found["b"]).keys() == vars(row).keys()
    assert found["c"] == held["c"] and type(found["c"][0]) is np.float64 and found["d"] == held["d"]


class Outmoded(NamedTuple):
    """A record of an earlier program, with what another part holds as well."""

    time: float
    shown: np.ndarray


Earlier = make_dataclass("Earlier", [*Row.__dataclass_fields__, "no_more"])
Earlier.__module__, Earlier.__qualname__ = Row.__module__, Row.__qualname__


def unpacked(value, of_then, of_now):
    """A value that a program with other records has written, as this one reads it."""
    packing = Packing(of_then)
    words = json.dumps(packing.packed(value))
    return Unpacking(of_now, packing.data).value(json.loads(words))


def test_a_field_that_a_record_has_no_more_is_left_out_and_what_others_share_with_it_is_there():
    shared = np.array([1.5, np.nan])
    found = unpacked([Earlier(*range(len(Row.__dataclass_fields__)), shared), shared], [Earlier], [Row])
    assert type(found[0]) is Row and vars(found[0]) == {one: k for k, one in enumerate(Row.__dataclass_fields__)}
    assert found[1].tobytes() == shared.tobytes()


def test_a_record_that_lacks_a_field_is_refused():
    less = make_dataclass("Less", ["time"])
    less.__module__, less.__qualname__ = Row.__module__, Row.__qualname__
    with pytest.raises(ValueError, match="lacks fields"):
        unpacked(less(1.0), [less], [Row])


@pytest.mark.parametrize(
    "within", [lambda one: one, lambda one: [{"a": (one,)}], lambda one: Row(1.5, np.zeros(1), places=[one])]
)
def test_a_record_of_a_class_that_is_no_more_is_a_fault_only_where_a_thing_needs_it(within):
    old, rows = Outmoded(1.0, np.array([2.0])), Rows(("x",))
    found = unpacked({"then": within(old), "shared": old.shown}, [Outmoded, Row], [Row])
    assert found["shared"][0] == 2.0
    assert not Held({"no_more": found["then"], "reached": 3.0}).lacks(rows)
    assert Held({"reached": found["then"]}).lacks(rows)


@pytest.mark.parametrize(("name", "needed"), [("no_more", False), ("since", True)])
def test_a_twin_goes_on_from_a_state_with_records_of_an_earlier_program_where_it_does_not_need_them(
    name, needed, tmp_path, monkeypatch
):
    first, second = Twin(STILL, WATCHED), Twin(STILL, WATCHED)
    for k in range(10):
        first.add(0.1 * k, [84.0 + 1e-3 * (k % 7)])
    assert hasattr(first.settling, name) == needed
    setattr(first.settling, name, [Outmoded(0.5, first.estimate.horizon.mean)])
    with monkeypatch.context() as then:
        then.setattr("tautline.twin.memory.RECORDS", (*RECORDS, Outmoded))
        then.setattr(first.settling, "memory", Twin(STILL, WATCHED).settling.memory)
        save(first, tmp_path / "state.npz")
    if needed:
        with pytest.raises(ResultError, match="was written by another version"):
            load(second, tmp_path / "state.npz")
        assert np.isnan(second.now) and not second.watch.alarms.active
    else:
        load(second, tmp_path / "state.npz")
        assert second.now == first.now and second.watch.alarms.active == first.watch.alarms.active != {}


def test_what_a_part_of_another_version_has_held_is_left_out():
    rows = Rows(("x",))
    Held({"reached": 3.0, "no_more": 1}).put(rows)
    assert rows.reached == 3.0 and not hasattr(rows, "no_more")
