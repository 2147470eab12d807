"""A storm that breaks the rope is no sea to lift in, whatever limits were given: that is said beside its numbers."""

from __future__ import annotations

import csv
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from cli.in_process import commands_of, leave_out_pixels, only_object
from storms.test_operability import ALONE, GRAVITY, MASS, PERIOD, SCENE, asked, response

import tautline
from crane.application import Crane
from crane.operability.criteria import read_criteria
from crane.operability.run_limits import Failed, RunLimit, above_strength, of_run, warnings_of
from crane.operability.storms import operability

# By Rice's formula the largest acceleration of 60 s reaches this at Hs = 0.6 m: 0.3 m is far below, 1.5 m far beyond.
BREAKS_AT = MASS * (GRAVITY + 0.6 * response(60.0)[1])
ANYWHERE = "load.position[2] < 40 m"


@pytest.fixture(scope="module")
def weak(tmp_path_factory):
    place = tmp_path_factory.mktemp("weak") / "weak.yaml"
    place.write_text(SCENE.replace("breaking_load: 1.1 MN", f"breaking_load: {BREAKS_AT:.0f} N"))
    return place


def test_storms_that_exceed_the_breaking_load_are_told_with_their_sea_states_beside_heights_and_life(
    weak, tmp_path, capsys, monkeypatch
):
    leave_out_pixels(monkeypatch)
    (tmp_path / "scatter.csv").write_text(f"Hs [m],{PERIOD}\n0.3,1\n1.5,1\n")
    options = (
        "--scatter", tmp_path / "scatter.csv", "--sn-constant", "1e3", "--seeds", "3", "--duration", "60 s",
        "--lead-in", "20 s", "-j", "1", "--limit", ANYWHERE, "--json", "-o", tmp_path / "storms",
    )  # fmt: skip
    code, out, said = commands_of(Crane(), capsys)("operability", weak, *options)
    assert code == 0
    told, words = only_object(out), " ".join(said.split())
    (one,) = told["run_limits"]
    assert (one["limit"], one["bound"], one["sense"]) == ("breaking_load", pytest.approx(round(BREAKS_AT)), "at most")
    # Three times the acceleration at which it breaks is about what a sea of 1.5 m has.
    assert one["worst"] == pytest.approx(MASS * (GRAVITY + 1.5 * response(60.0)[1]), rel=0.1)
    assert one["sea_states"] == [{"heading": None, "peak_period": PERIOD, "significant_height": 1.5, "storms": 3}]
    (height,) = told["limits"]
    assert height["allowable_height"] == 1.5 and height["run_limits_failed_from"] == 1.5
    (text,) = told["warnings"]
    assert "Hs 1.5 m, Tp 8 s (3 of 3)" in text and "Hs 0.3 m" not in text
    assert "1 sea state has such storms" in text and "The limits that are given allow it:" in text
    assert "Fatigue counts the cycles" in text
    assert f"--limit 'max_tension <= {round(BREAKS_AT) / 1e3:.12g} kN'" in text
    assert f"warning: {text}" in words
    assert words.count("storms fail limits of a run") == 1 and words.count("storms of it fail") == 1
    tables = {name: list(csv.reader((tmp_path / "storms" / name).open())) for name in ("operability.csv", "damage.csv")}
    for head, *rows in tables.values():
        at = next(k for k, name in enumerate(head) if "run" in name and "fail" in name)
        assert [row[at] for row in rows] == ["", "breaking_load (3)"]


def test_storms_of_seas_that_never_occur_do_not_stand_in_the_fatigue_and_nobody_says_so(
    weak, tmp_path, capsys, monkeypatch
):
    """They are run for the limit that is given, and their share of time, and so their damage, is none."""
    leave_out_pixels(monkeypatch)
    (tmp_path / "scatter.csv").write_text(f"Hs [m],{PERIOD}\n0.3,1\n1.5,0\n")
    options = (
        "--scatter", tmp_path / "scatter.csv", "--sn-constant", "1e3", "--seeds", "3", "--duration", "20 s",
        "--lead-in", "20 s", "-j", "1", "--limit", ANYWHERE, "-o", tmp_path / "storms",
    )  # fmt: skip
    code, _, said = commands_of(Crane(), capsys)("operability", weak, *options)
    words = " ".join(said.split())
    assert code == 0 and "(3 of 3)" in words and "fatigue life" in words
    assert "Fatigue counts" not in words and "storms of it fail" not in words


def test_of_several_seas_that_break_the_rope_those_are_said_that_occur():
    limit = RunLimit("strain", "largest strain", "", "at most")
    place = (np.array([0.3, 1.5]), np.array([8.0]))
    table = SimpleNamespace(
        seeds=(1, 2), headings=(None,), heights=place[0], periods=place[1], status=np.zeros((1, 1, 2)),
        allowable=np.zeros((0, 1, 1)),
    )  # fmt: skip
    failed = [Failed(limit, np.array([[[2, 1]]]), 0.02, 0.01)]
    (text,) = warnings_of(failed, table, np.array([[[1.0, 0.0]]]), "si")
    assert "2 sea states have such storms" in text
    assert "of these storms in the 1 sea state that occurs in the scatter diagram as if" in text
    assert "Fatigue" not in warnings_of(failed, table, None, "si")[0]


def test_a_warning_of_limits_of_a_run_is_told_however_quiet(weak, tmp_path, capsys, monkeypatch):
    leave_out_pixels(monkeypatch)
    options = ("--tp", "8", "--seeds", "3", "--duration", "20 s", "--lead-in", "20 s", "-j", "1", "--limit", ANYWHERE)
    code, _, said = commands_of(Crane(), capsys)("operability", weak, "--hs", "1.5", *options, "-q", "-o", tmp_path)
    assert code == 0 and "limit that every run is judged by" in " ".join(said.split())


def test_storms_are_judged_as_a_run_of_the_same_sea_is(weak):
    application = Crane()
    scene = application.read(weak)
    found = operability(application, scene, asked((0.3, 0.7), 3, 30.0, limits=[ANYWHERE]), ALONE)
    data, key = found.outcome.data, "vessel.motion.heave.spectrum"
    for case in range(6):
        height, seed = (data[f"{key}.{name}"].values[case] for name in ("significant_height", "seed"))
        changes = {f"{key}.significant_height": float(height), f"{key}.seed": int(seed)}
        changes |= {"solver.end": 50.0, "output": {"interval": "50 ms", "keep": "statistics", "begin": 20.0}}
        run = tautline.simulate(scene.replace(changes | {f"{key}.ramp": 10.0}))
        (record,) = (one for one in run.limits if one["name"] == "breaking_load")
        assert data["run_limit.breaking_load.failed"].values[case] == (not record["passed"])
        assert data["run_limit.breaking_load.value"].values[case] == pytest.approx(record["value"], rel=1e-9)


def test_what_does_not_change_in_a_run_hangs_on_no_sea():
    about = {"text": "", "unit": "", "sense": "at most"}
    records = [
        {"name": "strain", "time": 1.0, **about}, {"name": "bending_ratio", "time": None, **about},
        {"name": "overload", "time": 1.0, "output": "tension", **about},
    ]  # fmt: skip
    assert [one.name for one in of_run(records)] == ["strain"]


STRONGER = {
    "max_tension < 2 MN": True, "max_tension < 1.1 MN": False, "max_tension_hook < 1.2 MN": True,
    "tension <= 2 MN": True, "max_snap < 2 MN": True, "safety_factor > 0.5": True, "safety_factor > 3": False,
    "min_tension > 2 MN": False, "max_sheave_load < 2 MN": False,
}  # fmt: skip


@pytest.mark.parametrize("text", STRONGER)
def test_a_limit_above_the_breaking_load_is_doubted(text):
    scene = tautline.read(SCENE)
    name = text.split()[0]
    (one,) = read_criteria([text], {name: "" if name == "safety_factor" else "N"}, {})
    found = above_strength([one], scene)
    assert bool(found) == STRONGER[text]
    assert all(text in said and "the rope parts" in said for said in found)


def test_a_limit_above_the_breaking_load_is_told_before_any_storm_is_run():
    said, progress = [], []
    execution = replace(ALONE, say=said.append, progress=lambda done, total: progress.append((done, len(said))))
    limits = ["max_tension < 2 MN"]
    found = operability(Crane(), tautline.read(SCENE), asked((0.3,), 3, 60.0, limits=limits), execution)
    (warned,) = found.warnings
    assert said[0] == f"warning: {warned}" and "1.1 MN" in warned
    assert progress[0] == (0, len(said))
    assert not found.failed and math.isfinite(np.sum(found.table.values))


@pytest.mark.parametrize("more", [(), ("-q",)])
def test_a_limit_above_the_breaking_load_is_told_once_however_quiet(more, weak, tmp_path, capsys, monkeypatch):
    leave_out_pixels(monkeypatch)
    options = ("--hs", "0.3", "--tp", "8", "--seeds", "3", "--duration", "20 s", "--lead-in", "20 s", "-j", "1")
    limit = ("--limit", "max_tension < 2 MN", "-o", tmp_path)
    code, _, said = commands_of(Crane(), capsys)("operability", weak, *options, *limit, *more)
    words = " ".join(said.split())
    assert code == 0 and words.count("warning: limit 'max_tension < 2 MN' is above the breaking load") == 1
    assert words.count("is above the breaking load") == 1
