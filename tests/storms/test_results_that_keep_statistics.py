"""A result that keeps statistics holds what the same run with every frame has, to rounding."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from cli.in_process import commands_of

import tautline
from crane.application import Crane
from crane.rope_life.fatigue import rainflow_counts
from drillstring.application import Drillstring
from gardenhose.application import Gardenhose
from tautline.integrators.status import Interrupted
from tautline.scene.errors import SceneError
from tautline.simulation import simulate
from tautline.statistics.streaming import Blocks, Moments, Turns, Windows

DATA = Path(__file__).parents[2] / "data"
SEA = {"vessel.motion.heave": {"spectrum": {"significant_height": 1.5, "peak_period": 8.0, "seed": 4, "rao": 0.6}}}
LENGTH = {"solver.end": 40.0, "solver.step": 0.02, "path[0].drum.pay_out": {"constant": 0.0}, "output.interval": 0.04}


@pytest.fixture(scope="module")
def scene():
    return Crane().read(DATA / "hoist.yaml").replace(SEA | LENGTH)


@pytest.fixture(scope="module")
def both(scene, tmp_path_factory):
    folder = tmp_path_factory.mktemp("kept")
    asked = {"interval": 0.04, "keep": "statistics", "windows": 4.0, "block": 10.0, "begin": 6.0}
    build = Crane().build
    full = simulate(build(scene), folder / "full.nc")
    return full, simulate(build(scene.replace({"output": asked})), folder / "kept.nc")


def trapezoid(values, time):
    return np.trapezoid(values, time, axis=0) / (time[-1] - time[0])


def test_means_deviations_and_extremes_are_those_of_all_frames(both):
    full, kept = both
    some = full.time >= 6.0
    time = full.time[some]
    for name in ("tension", "body_position", "position", "kinetic_energy"):
        values = full[name][some]
        mean = trapezoid(values, time)
        scale = float(np.abs(values).max())
        assert kept[f"{name}_mean"] == pytest.approx(mean, abs=1e-12 * scale)
        assert kept[f"{name}_sd"] == pytest.approx(np.sqrt(trapezoid((values - mean) ** 2, time)), abs=1e-9 * scale)
        assert np.array_equal(kept[f"{name}_max"], values.max(axis=0))
        assert np.array_equal(kept[f"{name}_min"], values.min(axis=0))
        assert np.array_equal(kept[f"{name}_max_time"], time[values.argmax(axis=0)])
        assert np.array_equal(kept[f"{name}_min_time"], time[values.argmin(axis=0)])


def test_crossings_blocks_and_rainflow_cycles_are_those_of_all_frames(both):
    full, kept = both
    some = full.time >= 6.0
    time, tension = full.time[some], full["tension"][some]
    mean = kept["tension_mean"]
    crossings = ((tension[:-1] < mean) & (tension[1:] >= mean)).sum(axis=0)
    assert crossings.min() > 3
    assert np.array_equal(kept["tension_crossings"], crossings)
    assert "time of the statistics over the number of up-crossings" in kept.data["tension_period"].attrs["long_name"]
    assert kept["tension_period"] == pytest.approx((time[-1] - time[0]) / crossings)
    assert kept["block"] == pytest.approx([6.0, 16.0, 26.0])
    for k, begin in enumerate(kept["block"]):
        inside = (time >= begin - 1e-9) & (time < begin + 10.0 - 1e-9)
        assert np.array_equal(kept["tension_block_max"][k], tension[inside].max(axis=0))
        assert np.array_equal(kept["tension_block_min"][k], tension[inside].min(axis=0))
    edges = np.concatenate(([0.0], kept["tension_range"]))
    for i, j in np.ndindex(tension.shape[1:]):
        cycles = rainflow_counts(time, tension[:, i, j])
        expected = np.histogram(cycles.range, edges, weights=cycles.count)[0]
        assert np.array_equal(kept["tension_rainflow"][i, j], expected)


def test_windows_hold_the_whole_frames_round_the_extremes(both):
    full, kept = both
    windows = kept.attributes["windows"]
    assert {(one["variable"], one["extreme"]) for one in windows} == {("tension", "largest"), ("tension", "smallest")}
    for one in windows:
        inside = (full.time >= one["time"] - 2.0) & (full.time <= one["time"] + 2.0)
        stored = np.isin(kept.time, full.time[inside])
        assert stored.sum() == inside.sum() > 90
        for name in ("tension", "position", "sheave_load"):
            assert np.array_equal(kept[name][stored], full[name][inside])
    some = full.time >= 6.0
    assert max(one["value"] for one in windows) == full["tension"][some].max()
    assert len(kept.time) < 0.3 * len(full.time)


def test_figures_and_limits_are_those_of_all_frames(both, scene, monkeypatch):
    full = both[0]
    # Pieces of a few frames: what is joined is then joined often.
    monkeypatch.setattr("tautline.statistics.store.PIECE", 3000)
    kept = simulate(Crane().build(scene.replace({"output": {"interval": 0.04, "keep": "statistics"}})))
    expected = {
        "max_tension",
        "min_tension",
        "safety_factor",
        "max_offlead",
        "max_winch_power",
        "rise",
        "tension_cycles",
    }
    assert expected | {"equivalent_tension_range"} <= set(kept.headline)
    for name, figure in kept.headline.items():
        assert figure["value"] == pytest.approx(full.headline[name]["value"], rel=1e-9, abs=1e-9), name
        assert figure["text"] == full.headline[name]["text"]
    worst = {record["name"]: record for record in full.limits}
    for record in kept.limits:
        assert record["value"] == pytest.approx(worst[record["name"]]["value"], rel=1e-12)
        assert record["passed"] == worst[record["name"]]["passed"]
    assert {record["name"] for record in kept.limits} == set(worst)


def test_figures_leave_out_what_is_before_the_begin(both):
    full, kept = both
    some = full.time >= 6.0
    assert kept.headline["max_tension"]["value"] == full["tension"][some].max()
    assert kept.headline["max_tension"]["value"] < full.headline["max_tension"]["value"]


def test_batches_of_any_length_come_to_the_same():
    generator = np.random.default_rng(6)
    time = np.cumsum(generator.uniform(0.5, 1.5, 1000))
    values = np.round(np.cumsum(generator.standard_normal((1000, 3)), axis=0), 1) + 1e6
    made = []
    for cuts in ([], [1, 2, 3, 500], sorted(generator.choice(np.arange(1, 1000), 80, replace=False))):
        moments, turns, blocks, windows = Moments(), Turns(), Blocks(50.0), Windows(40.0)
        for part in np.split(np.arange(1000), cuts):
            frames = {"time": time[part], "x": values[part]}
            moments.add(time[part], values[part])
            turns.add(time[part], values[part])
            blocks.add(time[part], values[part])
            windows.add(frames, {"x": values[part]}, 0.0)
        made.append((moments, turns, blocks, windows))
    one = made[0]
    for other in made[1:]:
        assert other[0].sd == pytest.approx(one[0].sd, rel=1e-9)
        assert all(np.array_equal(a, b) for k in range(3) for a, b in zip(one[1].of(k), other[1].of(k), strict=True))
        assert all(np.array_equal(a, b) for a, b in zip(one[2].extremes(3), other[2].extremes(3), strict=True))
        whole, pieces = one[3].frames([]), other[3].frames([])
        assert np.array_equal(whole["x"], pieces["x"])
    _, turned = one[1].of(0)
    ways = np.sign(np.diff(turned))
    assert (ways[1:] * ways[:-1] < 0).all()
    assert turned.max() == values[:, 0].max()


@pytest.mark.parametrize("digits", [12, 1, 0])
def test_rainflow_cycles_of_turning_points_are_those_of_the_standard(digits):
    # Against the package that crane uses for whole histories; with few digits many ranges are equal.
    generator = np.random.default_rng(21)
    for _ in range(20):
        values = np.round(np.cumsum(generator.standard_normal(400)) + 2.0 * generator.standard_normal(400), digits)
        turns = Turns()
        turns.add(np.arange(400.0), values[:, None])
        ranges, count = turns.cycles(0)
        expected = rainflow_counts(np.arange(400.0), values)
        table = {}
        for size, number in [*zip(ranges, count, strict=True), *zip(expected.range, -expected.count, strict=True)]:
            key = round(size, 9)
            table[key] = table.get(key, 0.0) + number
        assert all(left == 0.0 for left in table.values())
        assert count.sum() == expected.count.sum()


def test_the_short_form_reads_and_keys_of_statistics_need_it(scene):
    assert scene.replace({"output": "statistics"}).output.statistics
    with pytest.raises(SceneError, match="add keep: statistics"):
        scene.replace({"output": {"interval": 0.04, "windows": 3.0}})
    with pytest.raises(SceneError, match="did you mean 'tension'"):
        Crane().build(scene.replace({"output": {"keep": "statistics", "of": ["tensoin"]}}))


@pytest.mark.parametrize("verb", [("plot",), ("render", "--movie", "x.mp4")])
def test_verbs_that_need_every_frame_say_so(both, verb, capsys):
    code, _, told = commands_of(Crane(), capsys)(verb[0], both[1].path, *verb[1:])
    assert code == 2
    told = " ".join(told.split())
    assert "keeps statistics" in told
    assert "keep: frames" in told


def test_a_run_that_does_not_go_on_from_statistics_says_that_it_is_for_them(both, capsys):
    source = DATA / "hoist.yaml"
    code, _, told = commands_of(Crane(), capsys)("simulate", source, "--resume", both[1].path)
    assert code == 2
    told = " ".join(told.split())
    assert "keeps statistics" in told and "a run that goes on from it needs every frame" in told
    assert "keep: frames" in told


def test_the_file_reads_as_a_data_set(both):
    data = tautline.Result.read(both[1].path).data
    assert data["tension_max"].dims == ("span", "end")
    assert data["tension_block_max"].dims == ("block", "span", "end")
    assert data.attrs["kept"] == "statistics"


def given(result):
    """Records of the limits that the scene gives, by name."""
    return {one["name"]: one for one in result.limits if "output" in one}


def test_limits_of_the_scene_are_judged_in_every_frame_and_for_how_long_is_not_known(scene):
    limits = [
        {"output": "max_tension", "above": 1.0e3, "name": "figure"},
        {"output": "tension", "above": 1.0e3, "name": "watched"},
        {"output": "tension", "above": 1.0e3, "for": 0.5, "name": "lasting"},
        {"output": "tension", "above": 1.0e6, "for": 0.5, "name": "never"},
        {"output": "paid_out", "above": 1.0e3, "name": "not watched"},
        {"output": "longest_slack", "above": 1.0, "name": "events"},
    ]
    asked = {"interval": 0.04, "keep": "statistics", "windows": 4.0, "block": 10.0, "begin": 6.0}
    found = given(simulate(Crane().build(scene.replace({"output": asked, "limits": limits, "solver.end": 20.0}))))
    assert found["figure"]["passed"] is False and found["watched"]["passed"] is False
    assert found["not watched"]["passed"] is True and found["never"]["passed"] is True
    for name in ("lasting", "events"):
        assert found[name]["passed"] is None and "keep frames" in found[name]["note"]
    for one in found.values():
        assert one["longest"] is None and one["exceeded"] is None and one["since"] is None


# The tip jumps at t = 0, and the load swings long after in a way of its own.
JUMP = """
title: A tip that heaves from the start on
rope: {mass_per_length: 1 kg/m, axial_stiffness: 20 MN, damping: 10 ms, breaking_load: 400 kN}
bodies: [{name: load, mass: 5 t, position: [0, 0, 0]}]
path: [{anchor: {name: tip, position: [0, 0, 10]}}, {end: {name: hook, body: load}}]
mesh: {elements_per_span: 1}
vessel: {reference: [0, 0, 0], motion: {heave: {harmonic: {amplitude: 0.5 m, period: 8 s}}}}
solver: {step: 20 ms, end: 30 s}
output: {interval: 100 ms}
"""
HIGH = 0.4
KEEP = {"interval": 0.1, "keep": "statistics", "windows": 0.5}


@pytest.fixture(scope="module")
def jump():
    return tautline.read(JUMP)


@pytest.fixture(scope="module")
def every_frame(jump):
    return simulate(Crane().build(jump))


@pytest.mark.parametrize("begin", [0.0, 13.0])
def test_a_limit_on_one_number_of_an_array_is_judged_in_all_frames_that_count(jump, every_frame, begin):
    limits = [
        {"output": "load.position[2]", "at_most": HIGH, "name": "high"},
        {"output": "load.position[2]", "at_least": -1.0, "name": "low"},
    ]
    found = given(simulate(Crane().build(jump.replace({"output": KEEP | {"begin": begin}, "limits": limits}))))
    some = every_frame.time >= begin - 1e-9
    time, height = every_frame.time[some], every_frame["body_position"][some, 0, 2]
    assert found["high"]["passed"] is False and found["low"]["passed"] is True
    for name, k in (("high", height.argmax()), ("low", height.argmin())):
        assert found[name]["value"] == height[k] and found[name]["time"] == time[k]
    assert found["high"]["margin"] == HIGH - height.max()


def test_frames_before_begin_count_in_no_figure_and_no_limit(jump, every_frame):
    begin = 13.0
    limits = [{"output": "tension", "above": 51.0e3, "name": "load"}, {"output": "max_tension", "above": 51.0e3}]
    kept = simulate(Crane().build(jump.replace({"output": KEEP | {"begin": begin}, "limits": limits})))
    some = every_frame.time >= begin - 1e-9
    tension = every_frame["tension"][some]
    assert every_frame["tension"].max() > tension.max() + 1.0e3 and tension.max() < 51.0e3
    figures = {name: one["value"] for name, one in kept.headline.items()}
    assert figures["max_tension"] == tension.max() and figures["min_tension"] == tension.min()
    # The start is what is hung from, and what a rise is measured from.
    height = every_frame["body_position"][:, 0, 2]
    assert figures["max_rise"] == height[some].max() - height[0]
    assert figures["rise"] == pytest.approx(height[-1] - height[0], abs=1e-12)
    # At rest the load hangs on the rope, and at the tip the rope's own weight too.
    hangs = 9.81 * np.array([5000.0 + 10.0, 5000.0])
    assert figures["dynamic_amplification"] == pytest.approx((tension[:, 0] / hangs).max(), rel=1e-4)
    (breaking,) = (one for one in kept.limits if one["name"] == "breaking_load")
    assert breaking["value"] == tension.max() and breaking["time"] >= begin
    assert all(one["passed"] for one in given(kept).values())


def test_a_run_that_ends_before_begin_judges_nothing(jump):
    from tautline.results.assessment.bounds import Tally

    (bound,) = Crane().build(jump.replace({"limits": [{"output": "tension", "above": 1.0}]})).bounds
    record = Tally(bound).record({})
    assert record["passed"] is None and "no frame counts" in record["note"]


WELL = """
well: {sections: [{hold: 500 m}], diameter: 8.5 in, wall: none}
string: [{name: drill pipe, length: rest, od: 5 in, id: 4.276 in}]
material: {youngs_modulus: 200 GPa, shear_modulus: 79 GPa, density: 7850}
damping: {translation: 100}
top: {block: {harmonic: {amplitude: 1 m, period: 10 s}}}
model: {kind: lumped, elements: 10}
solver: {method: generalized-alpha, step: 5 ms, end: 20 s}
output: {interval: 50 ms}
"""


def test_statistics_of_a_string_tell_its_largest_and_smallest_and_name_what_they_do_not_tell():
    well, begin = tautline.read(WELL), 4.0
    build = Drillstring().build
    full = simulate(build(well))
    kept = simulate(build(well.replace({"output": {"interval": 0.05, "keep": "statistics", "begin": begin}})))
    figures = {name: one["value"] for name, one in kept.headline.items()}
    some = full.time >= begin - 1e-9
    hook = full["hook_load"]
    assert figures["hook_load_max"] == hook[some].max() < hook.max()
    assert figures["hook_load_min"] == hook[some].min()
    assert figures["hook_load_start"] == hook[0]
    assert figures["bit_speed_max"] == np.abs(full["bit_speed"][some]).max()
    assert figures["stretch_start"] == full.headline["stretch_start"]["value"]
    left_out = kept.attributes["figures_left_out"].split(", ")
    assert set(left_out) == {"bit_displacement", "bit_stuck"}
    assert not set(left_out) & figures.keys()


def test_tables_of_windows_count_the_pieces_of_time_and_the_command_tells_them(both, tmp_path, capsys):
    full, kept = both
    code, _, told = commands_of(Crane(), capsys)("export", "--csv", kept.path, "-o", tmp_path)
    assert code == 0
    with (tmp_path / "kept.csv").open(newline="") as lines:
        titles, *rows = list(csv.reader(lines))
    assert titles[:2] == ["time [s]", "piece"]
    time, piece = np.array([[float(row[0]), int(row[1])] for row in rows]).T
    number = np.searchsorted(full.time, time - 1e-9)
    assert np.array_equal(np.diff(piece) > 0, np.diff(number) > 1) and piece[0] == 1 and piece[-1] > 2
    told = " ".join(told.split())
    assert f"keeps {len(time)} of {len(full.time)} frames" in told
    last = full.time[-1]
    assert f"to {last:g} s. Tables" in told or f", {last:g} s. Tables" in told
    commands_of(Crane(), capsys)("export", "--csv", full.path, "-o", tmp_path)
    assert "piece" not in (tmp_path / "full.csv").read_text().splitlines()[0]


HOSE = """
hose: {length: 0.5 m, elements: 6, axial_stiffness: 10 N, bending_stiffness: 0.00108 N*m^2, mass_per_length: 0.0031316}
water: {mass_per_length: 0.0007854 kg/m, speed: 5.0}
gravity: [0, 0, -9.81]
solver: {step: 2 ms, end: 1 s}
output: {interval: 10 ms}
"""


def left_out_of(result):
    return set(result.attributes["figures_left_out"].split(", "))


def test_what_statistics_do_not_tell_names_the_figures_of_a_hose_that_are_texts_or_several_numbers_too():
    hose = tautline.read(HOSE)
    full = simulate(Gardenhose().build(hose))
    kept = simulate(Gardenhose().build(hose.replace({"output": {"interval": 0.01, "keep": "statistics"}})))
    assert {"motion", "tip_mean"} <= left_out_of(kept)
    assert set(full.headline) <= set(kept.headline) | left_out_of(kept)


@pytest.mark.parametrize(
    ("changed", "more"),
    [
        ({}, set()),
        ({"rope.damping": 0.0, "mesh.elements_per_span": 2}, {"undamped_snaps"}),
    ],
)
def test_what_statistics_do_not_tell_names_no_figure_that_the_scene_cannot_have(jump, changed, more):
    # A rope from an anchor to a body, without sheave, drum and diameter.
    short = {"solver.end": 1.0, "output": KEEP}
    assert left_out_of(simulate(Crane().build(jump.replace(short | changed)))) == {
        "slack_events", "longest_slack", "max_snap", "snap_frames", *more,
    }  # fmt: skip


def test_figures_of_a_hoist_that_statistics_do_not_tell_are_those_that_the_run_with_every_frame_has(both):
    full, kept = both
    assert set(full.headline) - set(kept.headline) <= left_out_of(kept)
    # Of its slack and its slip it had none.
    assert left_out_of(kept) - set(full.headline) <= {"longest_slack", "max_snap", "snap_frames", "slipping_share"}


def test_statistics_tell_the_largest_tension_at_each_place(scene):
    limits = [{"output": "max_tension_hook", "above": 1.0e3, "name": "hook"}]
    short = scene.replace({"solver.end": 5.0, "limits": limits})
    full = simulate(Crane().build(short))
    kept = simulate(Crane().build(short.replace({"output": {"interval": 0.04, "keep": "statistics"}})))
    names = {name for name in full.headline if name.startswith("max_tension_")}
    assert len(names) == 4
    assert {name: kept.headline[name] for name in names} == {name: full.headline[name] for name in names}
    assert given(kept)["hook"]["passed"] is False


def test_limits_of_an_application_are_not_judged_and_say_why_where_a_run_ends_before_begin(jump):
    def stop(time, wall):
        if time > 2.0:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted) as ended:
        simulate(Crane().build(jump.replace({"output": KEEP | {"begin": 25.0}})), progress=stop)
    judged = {one["name"]: one for one in ended.value.result.limits}
    full = {one["name"]: one for one in simulate(Crane().build(jump.replace({"solver.end": 2.0}))).limits}
    assert judged.keys() == full.keys() and "breaking_load" in judged
    for name, one in judged.items():
        assert one["passed"] is None and one["value"] is None and one["limit"] == full[name]["limit"]
        assert one["note"] == "no frame counts: the run ended before output.begin"


@pytest.mark.parametrize("begin", [0.0, 1.0])
def test_the_title_of_the_limits_says_that_statistics_see_every_frame(tmp_path, capsys, monkeypatch, begin):
    monkeypatch.chdir(tmp_path)
    path, every = tmp_path / "jump.yaml", "{interval: 100 ms}"
    asked = f"{{interval: 100 ms, keep: statistics, windows: 0.5 s, begin: {begin} s}}"
    limited = JUMP.replace(every, f"{asked}\nlimits: [{{output: max_tension, above: 90 kN}}]")
    path.write_text(limited.replace("end: 30 s", "end: 2 s"), encoding="utf8")
    code, _, told = commands_of(Crane(), capsys)("simulate", path)
    told = " ".join(told.split())
    assert code == 0
    assert "limits of the scene, in every frame of the run" in told and "at the stored frames" not in told
    assert ("every frame of the run from t = 1 s" in told) == (begin > 0.0)


def test_a_block_shorter_than_the_interval_of_frames_is_refused(scene):
    asked = {"interval": 0.05, "keep": "statistics", "block": 0.02}
    with pytest.raises(SceneError, match=r"output\.block.*is shorter than output\.interval \(0\.05 s\)"):
        scene.replace({"output": asked})
    assert scene.replace({"output": asked | {"block": 0.05}}).output.block == 0.05


def test_a_block_that_nobody_wrote_is_told_with_its_length_and_the_cure_is_longer_than_the_interval(scene):
    with pytest.raises(SceneError) as caught:
        scene.replace({"solver.end": 1000.0, "output": {"interval": 700.0, "keep": "statistics"}})
    told = str(caught.value)
    assert "output.block: is not given. It is 600 s then, and is shorter than output.interval (700 s)" in told
    assert "such as 70000 s" in told and "such as 600 s" not in told


def test_blocks_between_two_frames_are_empty_and_the_others_keep_their_time():
    # Frames 0.5 s apart, as of steps longer than was asked for; blocks of 0.2 s.
    time = np.arange(5) * 0.5
    blocks = Blocks(0.2)
    for part in (slice(0, 2), slice(2, 5)):
        blocks.add(time[part], time[part, None])
    low, high = blocks.extremes(1)
    assert blocks.begins == pytest.approx(0.2 * np.arange(10))
    # The frame of 0.5 s is in the block that begins at 0.4 s, that of 1 s begins one.
    full = np.isfinite(high[:, 0])
    assert blocks.begins[full] == pytest.approx([0.0, 0.4, 1.0, 1.4])
    assert high[full, 0].tolist() == [0.0, 0.5, 1.0, 1.5]
    assert np.array_equal(low, high, equal_nan=True)
