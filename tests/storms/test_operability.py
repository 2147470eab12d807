"""Allowable sea states are those of the closed form where there is one, and what is not known is said."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import xarray
from cli.in_process import commands_of, leave_out_pixels, only_object

from crane.application import Crane
from crane.operability.allowable import (
    ABOVE,
    BELOW,
    FAILED,
    INSIDE,
    STOPPED,
    Allowable,
    allowable,
    crossing,
    fitted,
    governing,
)
from crane.operability.conditions import Condition, conditions_of, highest
from crane.operability.scatter import fatigue_over, read_scatter
from crane.operability.storms import Asked, operability
from crane.verbs.operability_options import OperabilityOptions, read_options
from tautline.scene.errors import SceneError
from tautline.statistics.gumbel import fit_gumbel
from tautline.sweeps.execution import Execution
from tautline.sweeps.file import read_sweep

ALONE = Execution(jobs=1)
MASS, GRAVITY, PERIOD = 5000.0, 9.81, 8.0
SCENE = f"""
title: Stiff rope, heave alone
rope: {{mass_per_length: 0.01, axial_stiffness: 4.0e8, damping: 2.0e-3, diameter: 36 mm, breaking_load: 1.1 MN}}
bodies:
  - {{name: load, mass: {MASS} kg, position: [0, 0, 0]}}
path:
  - anchor: {{name: tip, position: [0, 0, 10]}}
  - end: {{name: hook, body: load}}
mesh: {{elements_per_span: 1}}
vessel:
  reference: [0, 0, 0]
  motion:
    heave: {{spectrum: {{significant_height: 1.0, peak_period: {PERIOD}, seed: 1, rao: 0.8, components: 600}}}}
solver: {{method: generalized-alpha, rho_inf: 0.9, step: 50 ms, end: 100 s}}
output: {{interval: 50 ms}}
"""
SHARE = 0.9


@pytest.fixture(scope="module")
def application():
    return Crane()


@pytest.fixture(scope="module")
def scene(application, tmp_path_factory):
    place = tmp_path_factory.mktemp("scene") / "heave.yaml"
    place.write_text(SCENE)
    return application.read(place)


def asked(heights=(0.3, 0.9, 1.5), seeds=12, duration=160.0, simulated=None, limits=(), **more):
    conditions = [Condition(height, PERIOD, None) for height in heights]
    return Asked(
        conditions, range(1, seeds + 1), duration, simulated or duration, tuple(limits), SHARE, lead=20.0, **more
    )


def response(duration, peak_period=PERIOD, rao=0.8):
    """Percentile of the largest acceleration of the tip at Hs = 1 m, m/s^2, from the spectrum alone (JONSWAP, Rice)."""
    peak = 2.0 * math.pi / peak_period
    w = np.linspace(0.4 * peak, 5.0 * peak, 200_001)
    width = np.where(w <= peak, 0.07, 0.09)
    density = w**-5.0 * np.exp(-1.25 * (peak / w) ** 4) * 3.3 ** np.exp(-0.5 * ((w - peak) / (width * peak)) ** 2)
    density *= 1.0 / 16.0 / np.trapezoid(density, w)
    m4, m6 = (np.trapezoid(density * w**k, w) * rao**2 for k in (4, 6))
    cycles = duration / (2.0 * math.pi) * math.sqrt(m6 / m4)
    return math.sqrt(m4) * math.sqrt(2.0 * math.log(cycles / -math.log(SHARE))), math.sqrt(m4 * 2.0 * math.log(cycles))


@pytest.fixture(scope="module")
def lift(application, scene, tmp_path_factory):
    folder = tmp_path_factory.mktemp("lift") / "storms"
    percentile, _ = response(160.0)
    # The closed form allows 1.05 m for each; the first of them is in the largest, the second in the smallest tension.
    limits = [
        f"max_tension < {MASS * (GRAVITY + 1.05 * percentile)}",
        f"min_tension > {MASS * (GRAVITY - 1.05 * percentile)}",
    ]
    return operability(application, scene, asked(limits=limits, confidence=0.99), replace(ALONE, folder=folder))


def test_the_allowable_height_of_a_linear_response_is_that_of_its_spectrum(lift):
    # T = m (g + a): a rope of 89 rad/s under waves below 4 rad/s. Twelve storms leave an interval of some per cent; a
    # draw in a hundred is outside of it.
    for k in (0, 1):
        found = lift.table.allowable[k, 0, 0]
        assert found.bound == INSIDE
        assert found.low <= 1.05 <= found.high
        assert found.height == pytest.approx(1.05, rel=0.12)
        assert 0.02 < found.high - found.low < 0.6


def test_the_most_probable_largest_is_that_of_the_spectrum(lift):
    _, probable = response(160.0)
    n = 1
    height = lift.table.heights[n]
    expected = MASS * (GRAVITY + height * probable)
    assert (
        lift.table.extremes["most_probable_low"][0, 0, 0, n]
        <= expected
        <= lift.table.extremes["most_probable_high"][0, 0, 0, n]
    )
    low, high = (lift.table.extremes[f"exceedance{end}"][0, 0, 0] for end in ("_low", "_high"))
    # At the lowest height the limit is far away, at the highest it is passed by nearly all.
    assert high[0] < 0.05
    assert low[-1] > 0.5


def test_shorter_storms_scale_to_the_duration(application, scene):
    limit = f"max_tension < {MASS * (GRAVITY + 1.0)}"
    short = operability(application, scene, asked((1.0,), 12, 480.0, 120.0, [limit], confidence=0.99), ALONE)
    _, probable = response(480.0)
    low, high = (short.table.extremes[f"most_probable{end}"][0, 0, 0, 0] for end in ("_low", "_high"))
    assert low <= MASS * (GRAVITY + probable) <= high


def moved(scene, **motion):
    """The scene with other motions of the vessel, of which each is a spectrum with some keys."""
    sea = {"significant_height": 1.0, "peak_period": PERIOD, "components": 600}
    return scene.replace({f"vessel.motion.{name}": {"spectrum": sea | keys} for name, keys in motion.items()})


def test_motions_of_two_seeds_do_not_follow_the_same_waves_in_any_storm(application, scene, tmp_path):
    # Two motions that both lift the tip, with as much each: in phase they are twice one, apart 2^0.5 times as much.
    # Sway leans the rope by nothing that counts; heave and a pitch of 0.8 rad per m with an arm of 1 m are alike.
    both = moved(
        scene.replace({"vessel.reference": [-20.0, 0.0, 10.0]}), heave={"seed": 1, "rao": 0.4},
        pitch={"seed": 2, "rao": -0.02},
    )  # fmt: skip
    limit = f"max_tension < {MASS * (GRAVITY + 1.0)}"
    _, probable = response(80.0, rao=0.4 * math.sqrt(2.0))
    _, in_phase = response(80.0, rao=0.8)
    found = {}
    for name, pitch in (("apart", 2), ("together", 1)):
        one = both.replace({"vessel.motion.pitch.spectrum.seed": pitch})
        table = operability(application, one, asked((1.0,), 12, 80.0, limits=[limit], confidence=0.99), ALONE).table
        found[name] = [table.extremes[f"most_probable{end}"][0, 0, 0, 0] for end in ("_low", "_high")]
    assert found["apart"][0] <= MASS * (GRAVITY + probable) <= found["apart"][1]
    assert found["together"][0] <= MASS * (GRAVITY + in_phase) <= found["together"][1]
    assert found["apart"][1] < MASS * (GRAVITY + in_phase)


@pytest.mark.parametrize(
    ("motion", "cause"),
    [
        ({"heave": {}, "pitch": {"peak_period": 12.0, "rao": 0.01}}, "is 12 and that of heave is 8"),
        ({"heave": {}, "pitch": {"significant_height": 0.5, "rao": 0.01}}, "is 0.5 and that of heave is 1"),
        ({"heave": {}, "roll": {"gamma": 1.0, "rao": 0.01}}, "is 1 and that of heave is 3.3"),
    ],
)
def test_motions_of_several_seas_are_refused(application, scene, motion, cause):
    with pytest.raises(SceneError, match=cause):
        operability(application, moved(scene, **motion), asked(limits=["max_tension < 60 kN"]))


def test_a_sea_within_a_sum_is_refused_as_it_would_stay_what_it_is(application, scene):
    sea = {"spectrum": {"significant_height": 1.0, "peak_period": PERIOD}}
    swinging = scene.replace({"vessel.motion.sway": {"sum": [sea, {"harmonic": {"amplitude": 0.5, "period": 8}}]}})
    with pytest.raises(SceneError, match="within something else"):
        operability(application, swinging, asked(limits=["max_tension < 60 kN"]))


@pytest.mark.parametrize("values", [(1.0, 2.0, 4.0, 5.0), (1.0, 2.5, 2.4, 5.0), (1.0, 1.0, 1.0, 5.0)])
def test_the_allowable_height_grows_with_the_limit(values):
    heights = np.array([0.5, 1.0, 1.5, 2.0])
    found = [crossing(heights, np.array(values), limit)[0] for limit in np.linspace(1.0, 5.0, 40)]
    assert np.all(np.diff(found) >= -1e-12)
    assert crossing(heights, np.array(values), 0.9) == (0.0, BELOW)
    assert crossing(heights, np.array(values), 5.1) == (2.0, ABOVE)


def test_storms_that_fail_are_none_to_lift_in():
    heights = np.array([0.5, 1.0, 1.5])
    # That is no height that was found between two: the bound says so, at the lowest height too.
    assert crossing(heights, np.array([1.0, 2.0, np.inf]), 3.0) == (1.0, STOPPED)
    assert crossing(heights, np.array([np.inf, 2.0, 3.0]), 3.0) == (0.0, STOPPED)
    assert FAILED == "failed"


def test_the_allowable_height_of_a_linear_response_is_the_limit_over_the_response():
    # T = 50 + 7 Hs, at heights that are not evenly spaced: nothing of interpolation is left in it.
    heights = np.array([0.5, 0.8, 1.7, 2.0, 3.5])
    for limit in (54.0, 58.3, 70.0):
        found = allowable(heights, *(50.0 + a * heights for a in (7.0, 6.0, 8.0)), limit, 3.5)
        assert found.height == pytest.approx((limit - 50.0) / 7.0, rel=1e-12)
        assert found.low == pytest.approx((limit - 50.0) / 8.0, rel=1e-12)
        assert found.high == pytest.approx((limit - 50.0) / 6.0, rel=1e-12)
        assert (found.bound, found.low_bound, found.high_bound) == (INSIDE, INSIDE, INSIDE)


def test_an_end_of_the_interval_that_the_grid_bounds_says_so():
    heights = np.array([1.0, 2.0, 3.0])
    found = allowable(heights, 10.0 * heights, 5.0 * heights, 30.0 * heights, 25.0, 3.0)
    assert (found.low, found.height, found.high) == (0.0, pytest.approx(2.5), 3.0)
    assert (found.low_bound, found.bound, found.high_bound) == (BELOW, INSIDE, ABOVE)


def test_of_several_limits_the_least_height_governs_and_an_unknown_one_leaves_it_unknown():
    from types import SimpleNamespace

    heights = [[[1.0, 2.0, 1.0]], [[1.5, 0.5, np.nan]]]
    found = np.empty((2, 1, 3), object)
    for at in np.ndindex(*found.shape):
        found[at] = Allowable(np.array(heights)[at], 0.4, 4.0, INSIDE)
    assert governing(SimpleNamespace(allowable=found)).tolist() == [[0, 1, -1]]


def test_each_option_of_the_command_line_comes_to_its_own_place(tmp_path):
    diagram = tmp_path / "scatter.csv"
    diagram.write_text("Hs [m],6,8\n1,10,5\n2,3,4\n")
    given = OperabilityOptions(
        hs=None, tp=None, heading="0,90", seeds=7, first_seed=3, duration="2h", simulated="30min", lead_in="50 s",
        limit=["max_tension < 60 kN"], percentile="P85", confidence="70 %", scatter=diagram, sn_constant=1e3,
    )  # fmt: skip
    made = read_options(given, gravity=(0.0, 0.0, -9.81))
    assert list(made.seeds) == list(range(3, 10)) and made.limits == ("max_tension < 60 kN",)
    assert (made.duration, made.simulated, made.lead) == (7200.0, 1800.0, 50.0)
    assert (made.share, made.confidence, made.compared, made.constant) == (0.85, 0.7, "percentile", 1e3)
    assert {(one.height, one.period) for one in made.conditions} == {(1.0, 6.0), (1.0, 8.0), (2.0, 6.0), (2.0, 8.0)}
    assert sorted({one.heading for one in made.conditions}) == pytest.approx([0.0, math.pi / 2.0])
    assert made.scatter.of(2.0, 8.0) > 0.0


def test_waves_steeper_than_they_can_be_are_not_run():
    # DNV-RP-C205, 3.5.4: 1/15 to 8 s, 1/25 from 15 s, linear between.
    assert highest(6.0) == pytest.approx(9.81 * 36.0 / (2.0 * math.pi) / 15.0)
    assert highest(20.0) == pytest.approx(9.81 * 400.0 / (2.0 * math.pi) / 25.0)
    assert highest(11.5) == pytest.approx(9.81 * 11.5**2 / (2.0 * math.pi) * 0.5 * (1 / 15 + 1 / 25))
    assert not Condition(4.0, 5.0, None).physical
    assert Condition(2.0, 6.0, None).physical


def test_waves_are_as_steep_as_the_gravity_of_the_scene_lets_them():
    mars, nowhere = (conditions_of([2.0], [6.0], [None], (0.0, 0.0, -g))[0] for g in (3.71, 0.0))
    assert highest(6.0, 3.71) == pytest.approx(3.71 / 9.81 * highest(6.0), rel=1e-12)
    assert not mars.physical and nowhere.physical and nowhere.gravity == 9.81


@pytest.fixture
def command(capsys, monkeypatch):
    leave_out_pixels(monkeypatch)
    return commands_of(Crane(), capsys)


SMALL = (
    "--hs",
    "0.5:3:0.5",
    "--tp",
    "5",
    "--seeds",
    "3",
    "--duration",
    "20 s",
    "--lead-in",
    "5 s",
    "-j",
    "1",
    "--quiet",
)


def test_the_command_writes_tables_marks_steep_waves_and_goes_on(command, scene, tmp_path):
    folder = tmp_path / "storms"
    limit = ("--limit", "max_tension < 60 kN", "--limit", "load.position[2] < 5 m")
    code, out, _ = command("operability", scene.document.path, *SMALL, *limit, "-o", folder, "--json")
    assert code == 0
    told = only_object(out)
    # At 5 s the steepest are 2.6 m.
    assert (told["cases"], told["done"], told["failed"]) == (15, 15, 0)
    assert {one["limit"] for one in told["limits"]} == {"max_tension < 60 kN", "load.position[2] < 5 m"}
    with xarray.open_dataset(folder / "operability.nc") as data:
        assert data["status"].values[0, 0].tolist() == ["computed"] * 5 + ["not physical: too steep"]
        assert data["value"].dims == ("limit", "heading", "peak_period", "significant_height", "seed")
        high = data["percentile"].values[1, 0, 0, :5]
        assert np.all(np.diff(high) > 0.0)
    head = (folder / "allowable.csv").read_text().splitlines()
    assert head[0].startswith("limit,heading [deg],peak_period [s],allowable_height [m]")
    # A row for each limit, and one for both: the least, with the limit that it is of.
    assert len(head) == 4
    rows = [line.split(",") for line in head[1:]]
    assert float(rows[2][3]) == min(float(row[3]) for row in rows[:2])
    assert rows[2][0] == "all limits" and rows[2][-1] in [row[0] for row in rows[:2]]
    assert told["all_limits"][0]["governed_by"] == rows[2][-1]
    assert len(list(folder.glob("allowable_*.png"))) == 3
    # What was finished is not run again.
    journal = folder / "journal.ndjson"
    lines = journal.read_bytes().splitlines(keepends=True)
    # Four storms, and the list of figures after them.
    journal.write_bytes(b"".join(lines[:-5]))
    code, out, _ = command("operability", scene.document.path, *SMALL, *limit, "-o", folder, "--json", "--resume")
    assert code == 0
    again = only_object(out)
    assert again["earlier"] == 11
    assert again["limits"] == told["limits"]


@pytest.mark.parametrize(
    ("more", "cause", "cure"),
    [
        (("--limit", "max_tensoin < 60 kN"), "finds no 'max_tensoin'", "did you mean 'max_tension'"),
        (("--limit", "max_tension < 60 m"), "60 m", "60"),
        (("--limit", "max_tension"), "is no limit", "max_tension < 60 kN"),
        ((), "there is no limit", "--limit"),
        (("--limit", "max_tension < 60 kN", "--heading", "0,90"), "knows no headings", "leave --heading out"),
        (("--limit", "max_tension < 60 kN", "--seeds", "2"), "too few storms", "10 give"),
        (("--limit", "max_tension < 60 kN", "--hs", "9,10"), "steeper than waves", "longer periods"),
        (("--limit", "max_tension < 60 kN", "--hs", "0.5-4"), "written with colons and a step", "--hs 0.5:4:0.5"),
        (("--limit", "max_tension < 60 kN", "--percentile", "P100"), "no percentage", "P90"),
        (("--limit", "max_tension < 60 kN", "--percentile", "0.9"), "may mean 90 % or 0.9 %", "P90"),
        (("--limit", "max_tension < 60 kN", "--confidence", "0.95"), "may mean 95 % or 0.95 %", "90 %"),
        (
            ("--limit", "max_tension < 60 kN", "--set", "vessel.motion.heave.spectrum.ramp=6"),
            "is shorter than vessel.motion.heave.spectrum.ramp, 6 s",
            "--lead-in 6s",
        ),
        (
            ("--seeds", "1", "--set", "limits=[{output: max_tension, above: 60 kN}]"),
            "too few storms",
            "10 give",
        ),
        (("--limit", "max_tension < 60 kN", "--simulate", "40 s"), "is longer than 20 s", "or less"),
    ],
)
def test_what_cannot_be_is_refused_before_anything_is_written(command, scene, tmp_path, more, cause, cure):
    folder = tmp_path / "storms"
    code, _, told = command("operability", scene.document.path, *SMALL, *more, "-o", folder)
    told = " ".join(told.split())
    assert code == 2
    assert cause in told
    assert cure in told
    assert not folder.exists()


@pytest.mark.parametrize(
    "more",
    [
        ("--limit", "max_tension < 60 kN", "--seeds", "1"),
        ("--limit", "max_tensoin < 60 kN"),
        ("--limit", "max_tension < 60 m"),
        ("--limit", "max_tension < 60 kN", "--simulate", "40 s"),
    ],
)
def test_a_refusal_comes_before_all_that_reads_as_a_start(command, scene, tmp_path, more):
    loud = [word for word in SMALL if word != "--quiet"]
    code, _, told = command("operability", scene.document.path, *loud, *more, "-o", tmp_path / "storms")
    assert code == 2
    assert "sea states" not in told and "note:" not in told and "warning:" not in told


def test_a_folder_that_holds_other_files_is_refused_before_all_that_reads_as_a_start(command, scene, tmp_path):
    limit = ("--limit", "max_tension < 60 kN", "-o", tmp_path / "storms")
    loud = [word for word in SMALL if word != "--quiet"]
    (tmp_path / "storms").mkdir()
    (tmp_path / "storms" / "letter.txt").write_text("of somebody")
    code, _, told = command("operability", scene.document.path, *loud, *limit)
    assert code == 2 and "holds other files" in " ".join(told.split()) and "sea states" not in told


def test_seas_that_are_all_too_steep_are_refused_by_the_limit_of_steepness_and_not_by_the_seeds(
    command, scene, tmp_path
):
    sea = ("--hs", "8", "--tp", "4", "--seeds", "1", "--limit", "max_tension < 60 kN")
    code, _, told = command("operability", scene.document.path, *SMALL, *sea, "-o", tmp_path / "storms")
    told = " ".join(told.split())
    assert code == 2 and "--seeds" not in told
    assert f"waves of Tp 4 s are {highest(4.0):.3g} m high at most".lower() in told.lower()
    assert "the lowest asked for are 8 m" in told and "longer periods" in told


def test_a_scene_without_a_sea_is_refused(application, scene):
    still = scene.replace({"vessel.motion.heave": {"harmonic": {"amplitude": 0.5, "period": 8}}})
    with pytest.raises(SceneError, match="has no sea"):
        operability(application, still, asked(limits=["max_tension < 60 kN"]))


def test_fatigue_over_a_scatter_diagram_is_the_sum_by_occurrence(tmp_path):
    place = tmp_path / "scatter.csv"
    place.write_text("Hs,7,9\n1,30,10\n2,0,60\n")
    diagram = read_scatter(place)
    assert diagram.share.tolist() == [[0.3, 0.1], [0.0, 0.6]]
    # By hand: two headings of which each is there half of the time; one storm of 100 s each, a cell that was not run.
    ranges = np.array([[[[10.0], [np.nan]], [[20.0], [40.0]]], [[[10.0], [np.nan]], [[20.0], [80.0]]]])
    cycles = np.full((2, 2, 2, 1), 50.0)
    found = fatigue_over(diagram, diagram.heights, diagram.periods, ranges, cycles, 100.0, 1000.0, 2.0e6)
    storms = 31557600.0 / 100.0 * 50.0
    damage = storms * (0.3 * 10.0**5 + 0.1 * 20.0**5 + 0.6 * 0.5 * (40.0**5 + 80.0**5))
    assert found.damage.sum() == pytest.approx(damage, rel=1e-12)
    assert found.cycles == pytest.approx(storms, rel=1e-12)
    assert found.range == pytest.approx((damage / storms) ** 0.2, rel=1e-12)
    assert found.life == pytest.approx(2.0e6 * 1000.0**5 / damage, rel=1e-12)
    assert found.covered == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("head", "height", "period"),
    [
        ("Hs", 1.0, 1.0), ("Hs [m]", 1.0, 1.0), ("Hs [ft]", 0.3048, 1.0), ("Hs (feet)", 0.3048, 1.0),
        ("Hs [cm] / Tp [min]", 0.01, 60.0), ("Hs \\ Tp (s)", 1.0, 1.0),
    ],
)  # fmt: skip
def test_heights_and_periods_of_a_scatter_diagram_have_the_units_of_its_first_cell(tmp_path, head, height, period):
    place = tmp_path / "scatter.csv"
    place.write_text(f"{head},7,9\n1,30,10\n2,0,60\n")
    diagram = read_scatter(place)
    assert diagram.heights.tolist() == pytest.approx([height, 2.0 * height], rel=1e-15)
    assert diagram.periods.tolist() == pytest.approx([7.0 * period, 9.0 * period], rel=1e-15)


@pytest.mark.parametrize(
    ("text", "line", "cause"),
    [
        ("Hs,7,9\n1,3,x\n", 2, "is no number"),
        ("Hs,7,9\n1,-3,2\n", 2, "is no number"),
        ("Hs,9,7\n1,3,2\n", None, "increasing"),
        ("Hs [kg],7,9\n1,3,2\n", 1, r"\[kg\] is the unit neither of a height nor of a period; write Hs \[m\]"),
        ("Hs [m] / Tp [ft],7,9\n1,3,2\n", 1, r"\[ft\] is a second unit of a length"),
        ("Hs [Fuss],7,9\n1,3,2\n", 1, r"\[Fuss\] is no unit"),
    ],
)
def test_faults_of_a_scatter_diagram_are_told_by_line(tmp_path, text, line, cause):
    place = tmp_path / "scatter.csv"
    place.write_text(text)
    with pytest.raises(SceneError, match=cause) as error:
        read_scatter(place)
    assert error.value.problems[0].line == line


def test_a_scatter_diagram_gives_the_sea_states(command, scene, tmp_path):
    place = tmp_path / "scatter.csv"
    place.write_text("Hs [m],6,8\n0.5,3,1\n1.0,2,4\n")
    options = (
        "--seeds",
        "1",
        "--duration",
        "20 s",
        "--lead-in",
        "5 s",
        "-j",
        "1",
        "--quiet",
        "--json",
        "--sn-constant",
        "1e4",
    )
    code, out, _ = command("operability", scene.document.path, "--scatter", place, *options, "-o", tmp_path / "f")
    assert code == 0
    told = only_object(out)
    assert told["cases"] == 4
    assert told["fatigue"]["equivalent_tension_range"] > 0.0
    assert told["fatigue"]["share_of_time"] == pytest.approx(1.0)
    assert told["fatigue"]["life_years"] > 0.0
    rows = [line.split(",") for line in (tmp_path / "f" / "damage.csv").read_text().splitlines()]
    assert rows[0][1:3] == ["peak_period [s]", "significant_height [m]"] and len(rows) == 1 + told["cases"]
    assert sum(float(row[-1]) for row in rows[1:]) == pytest.approx(1.0)
    code, _, said = command("operability", scene.document.path, "--scatter", place, *options[:-1], "-5")
    assert code == 2 and "--sn-constant -5: is no constant of an S-N curve" in said


def test_fatigue_is_that_of_a_year_whether_the_lead_in_is_kept_for_a_limit_or_not(command, scene, tmp_path):
    """A lead-in as long as the storm doubled the cycles, and the time stayed that of the storm."""
    place = tmp_path / "scatter.csv"
    place.write_text("Hs [m],6\n1.0,1\n")
    options = ("--scatter", place, "--seeds", "3", "--duration", "30 s", "--lead-in", "30 s", "-j", "1", "--json", "-q")
    cycles = []
    for k, limit in enumerate([(), ("--limit", "slack_events < 1")]):
        code, out, _ = command("operability", scene.document.path, *options, *limit, "-o", tmp_path / f"f{k}")
        assert code == 0
        cycles.append(only_object(out)["fatigue"]["cycles_per_year"])
    assert cycles[1] == pytest.approx(cycles[0], rel=0.3)


def test_time_of_a_scatter_diagram_that_was_not_run_is_a_warning_however_quiet(command, scene, tmp_path):
    # 3 of 7 occurrences are too steep to be run: their damage is lacking, and no life is asked for
    place = tmp_path / "scatter.csv"
    place.write_text("Hs [m],3,8\n0.5,0,4\n1.0,3,0\n")
    options = (
        "--seeds",
        "1",
        "--duration",
        "10 s",
        "--lead-in",
        "5 s",
        "-j",
        "1",
        "--json",
        "-q",
        "-o",
        tmp_path / "f",
    )
    code, out, said = command("operability", scene.document.path, "--scatter", place, *options, "-o", tmp_path / "f")
    assert code == 0
    (text,) = [one for one in only_object(out)["warnings"] if "shorter than one wave" not in one]
    assert text.startswith("42.9 % of the time of the scatter diagram was not run")
    assert text.endswith("its damage is not counted")
    assert "warning: 42.9 % of the time" in " ".join(said.split())


def test_sea_states_that_never_occur_are_not_run_for_fatigue_alone(command, scene, tmp_path):
    place = tmp_path / "scatter.csv"
    place.write_text("Hs [m],6,8\n0.5,3,0\n1.0,0,4\n")
    options = ("--seeds", "1", "--duration", "10 s", "--lead-in", "5 s", "-j", "1", "--json", "-o", tmp_path / "f")
    code, out, said = command("operability", scene.document.path, "--scatter", place, *options)
    assert code == 0
    told = only_object(out)
    assert told["cases"] == 2 and told["fatigue"]["share_of_time"] == pytest.approx(1.0)
    assert "2 sea states, 1 storm of 10 s each" in said and "2 more of the scatter diagram never occur" in said
    with xarray.open_dataset(tmp_path / "f" / "operability.nc") as data:
        assert (data["status"].values == "does not occur").sum() == 2
    # A limit is asked of all of them.
    limit = ("--limit", "max_tension < 60 kN", "--seeds", "3", "--quiet", "-o", tmp_path / "g")
    code, out, _ = command("operability", scene.document.path, "--scatter", place, *options, *limit)
    assert code == 0 and only_object(out)["cases"] == 12


def test_the_sweep_of_storms_is_a_plain_one():
    # What is handed to the sweep reads as the file of one: every key varies together.
    read = read_sweep({"scene": "scene", "vary": {"a": [1, 2], "b": [3, 4]}, "plan": "zip", "collect": ["max_tension"]})
    assert read.chosen_plan().name == "zip"


def test_limits_of_the_scene_are_those_that_storms_are_judged_by(scene):
    from crane.operability.criteria import limits_of_scene

    limited = scene.replace({"limits": [
        {"output": "max_tension", "above": "60 kN", "name": "overload"}, {"output": "min_tension", "below": 500.0},
    ]})  # fmt: skip
    assert limits_of_scene(limited) == ["max_tension <= 60 kN", "min_tension >= 500.0"]
    assert limits_of_scene(scene) == []


def test_an_output_is_not_judged_over_the_lead_in(application, scene):
    # The load is lowered by 3.5 m in the lead-in of 20 s: in the storm it is far below its start.
    falling = scene.replace({
        "path": [
            {"drum": {"name": "winch", "center": [-0.5, 0, 13], "radius": 0.5, "axis": [0, 1, 0], "wrap": "over",
                      "pay_out": {"table": {"time": [0, 0.5, 3.5, 4], "value": [0, 1, 1, 0]}}}},
            {"end": {"name": "hook", "body": "load"}},
        ],
    })  # fmt: skip
    start = float(falling.bodies[0].position[2])
    found = operability(
        application, falling, asked((0.3,), 3, 10.0, limits=[f"load.position[2] < {start - 1.5}"]), ALONE
    )
    assert set(found.outcome.data["status"].values) == {"done"}, found.outcome.data["message"].values
    assert found.table.values.max() < start - 1.5


def test_storms_without_slack_keep_a_limit_on_snaps(application, scene):
    # Such a storm has no such figure: it counts as 0, and is not left out of the fit.
    found = operability(application, scene, asked((0.3, 0.8), 3, 10.0, limits=["max_snap < 1 kN"]), ALONE)
    assert found.table.values.tolist() == [[[[[0.0] * 3] * 2]]]
    one = found.table.allowable[0, 0, 0]
    assert (one.height, one.bound) == (0.8, ABOVE)
    assert any("no Gumbel distribution" in note for note in found.notes)


def test_time_of_a_scatter_diagram_that_was_not_run_is_told_because_its_damage_is_lacking(tmp_path):
    from crane.operability.scatter import not_covered

    place = tmp_path / "scatter.csv"
    place.write_text("Hs,7,9\n1,30,10\n2,0,60\n")
    diagram = read_scatter(place)
    whole = np.ones((1, 2, 2, 1))
    assert not_covered(fatigue_over(diagram, diagram.heights, diagram.periods, whole, whole, 1.0)) == []
    part = whole.copy()
    part[0, 1, 1] = np.nan
    (note,) = not_covered(fatigue_over(diagram, diagram.heights, diagram.periods, part, whole, 1.0))
    assert "60 % of the time" in note and note.endswith("its damage is not counted")


def test_equal_storms_have_a_most_probable_largest_without_an_interval():
    from crane.operability.criteria import Criterion
    from tautline.results.assessment.limits import AT_MOST

    one = Criterion("max_tension < 60 kN", "max_tension", AT_MOST, 60e3, "N", False)
    found = fitted(np.full(4, 50e3), one, 1.0, 0.9, 0.9)
    assert found["percentile"] == found["percentile_low"] == 50e3 and found["exceedance"] == 0.0


TAUT = {"min_tension > 0": True, "min_tension >= 0": False, "min_tension > 2 kN": True}


@pytest.mark.parametrize("text", TAUT)
def test_storms_that_all_slacken_the_rope_are_beyond_a_limit_that_wants_it_taut(text):
    """No tension is less than none: all of the smallest are 0, and nothing tells how far beyond they would be."""
    from crane.operability.allowable import SLACK, _allowables
    from crane.operability.criteria import read_criteria

    (one,) = read_criteria([text], {"min_tension": "N"}, {})
    found = fitted(np.zeros(6), one, 1.0, 0.9, 0.9)
    assert found["exceedance"] == found["exceedance_low"] == float(TAUT[text])
    heights = np.array([1.0, 2.0, 3.0])
    storms = [np.linspace(4.0e3, 5.0e3, 6), np.linspace(2.5e3, 3.5e3, 6), np.zeros(6)]
    made = [fitted(storm, one, 1.0, 0.9, 0.9) for storm in storms]
    extremes = {name: np.array([each[name] for each in made])[None, None, None] for name in made[0]}
    status = np.full((1, 1, 3), "computed", object)
    allowed = _allowables([one], heights, np.array([8.0]), [None], status, extremes, "most_probable")[0, 0, 0]
    assert (allowed.height, allowed.bound) == ((2.0, SLACK) if TAUT[text] else (3.0, ABOVE))


def test_a_force_that_can_be_negative_has_no_floor():
    """Of a rod, or of a component: all storms are below 0, and the fit is that of the forces as they are."""
    from crane.operability.criteria import read_criteria

    (one,) = read_criteria(["min_tension > -20 kN"], {"min_tension": "N"}, {})
    forces = np.array([-9.0e3, -11.0e3, -8.0e3, -12.0e3, -9.5e3])
    found = fitted(forces, one, 1.0, 0.9, 0.9)
    assert found["most_probable"] == pytest.approx(-fit_gumbel(-forces).location) and found["most_probable"] < -8.0e3


def test_a_limit_that_wants_less_is_broken_by_what_is_equal():
    heights = np.array([0.5, 1.0, 2.0])
    assert crossing(heights, np.array([0.0, 1.0, 1.0]), 1.0, strict=True) == (1.0, INSIDE)
    assert crossing(heights, np.array([0.0, 1.0, 1.0]), 1.0) == (2.0, ABOVE)
    assert crossing(heights, np.array([1.0, 1.0, 1.0]), 1.0, strict=True) == (0.0, BELOW)


RESPONSES = "frequency [rad/s],direction [deg],heave [m/m],heave phase [deg]\n" + "".join(
    f"{w},{angle},{0.8 if w < 4 else 0.0},0\n" for angle in (0, 90) for w in (0.2, 2.0, 4.0)
)


def test_a_heading_that_the_responses_lack_is_refused_before_any_storm_is_run(application, scene, tmp_path):
    (tmp_path / "vessel.csv").write_text(RESPONSES)
    motion = "{sea: {significant_height: 1, peak_period: 8}, rao: vessel.csv, direction: 0 deg}"
    begin, end = SCENE.index("  motion:"), SCENE.index("solver:")
    (tmp_path / "sea.yaml").write_text(f"{SCENE[:begin]}  motion: {motion}\n{SCENE[end:]}")
    sea = application.read(tmp_path / "sea.yaml")
    conditions = [Condition(0.5, PERIOD, math.radians(angle)) for angle in (0.0, 90.0, 200.0)]
    wanted = Asked(conditions, range(1, 4), 10.0, 10.0, ("max_tension < 60 kN",), lead=5.0)
    with pytest.raises(SceneError, match=r"Tp 8 s, heading 200 deg.*not in the file; give --heading, one of 0, 90"):
        operability(application, sea, wanted, replace(ALONE, folder=tmp_path / "storms"))
    assert not (tmp_path / "storms").exists()


def test_extremes_that_are_scaled_too_far_are_noted():
    from crane.operability.storms import scale_notes

    assert scale_notes(asked(duration=10800.0)) == []
    assert scale_notes(asked(duration=10800.0, simulated=1800.0)) == []
    far, short = scale_notes(asked(duration=10800.0, simulated=60.0))
    assert "scaled by 180" in far and "--simulate 1080s" in far
    assert "8 waves of 8 s" in short and "--simulate 800s" in short


def test_a_limit_of_the_scene_on_an_array_is_judged_at_all_its_places(application, scene):
    limited = scene.replace({"limits": [
        {"output": "tension", "above": "60 kN", "name": "overload"},
        {"output": "tension", "below": "1 kN", "for": "2 s", "name": "slack"},
    ]})  # fmt: skip
    found = operability(application, limited, asked((0.5,), 3, 10.0, limits=["max_tension < 60 kN"]), ALONE)
    texts = [one.text for one in found.criteria]
    assert texts == ["max_tension < 60 kN", "tension <= 60 kN", "tension >= 1 kN"]
    # A span has two ends, and the rope's largest tension is at one of them.
    assert found.table.values[1].tolist() == found.table.values[0].tolist()
    assert (found.table.values[2] < found.table.values[1]).all()
    assert any(note.startswith("limit slack: counts in the scene after 2 s") for note in found.notes)


def test_a_place_that_an_output_has_not_is_refused(application, scene):
    with pytest.raises(SceneError, match=r"there is no load\.position\[7\]"):
        operability(application, scene, asked((0.5,), 3, 10.0, limits=["load.position[7] < 3 m"]), ALONE)
    with pytest.raises(SceneError, match=r"load\.position is no single number.*load\.position\[0\]"):
        operability(application, scene, asked((0.5,), 3, 10.0, limits=["load.position < 3 m"]), ALONE)


def test_a_duration_of_seconds_is_among_the_warnings_that_json_has_and_is_said_before_anything_runs(application, scene):
    said = []
    execution = replace(ALONE, say=said.append)
    found = operability(application, scene, asked((0.3,), 3, 3.0, limits=["max_tension < 1 MN"]), execution)
    (told,) = (one for one in found.warnings if "--duration is 3 s" in one)
    assert told not in found.notes
    assert said[0] == f"warning: {told}"
