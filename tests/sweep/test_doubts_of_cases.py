"""A case whose rope has parted is done like any other: that is said once, however quiet."""

from __future__ import annotations

import csv

from cli.in_process import commands_of, leave_out_pixels, only_object
from sweep.short_hoist import write_sweep

from crane.application import Crane
from tautline.sweeps.doubts import Unsatisfied

BREAKS = "vary:\n  'bodies[0].mass': [2 t, 150 t, 160 t]\ncollect: [max_tension]\n"


def test_limits_that_cases_fail_are_told_with_number_and_first_case_however_quiet(tmp_path, capsys, monkeypatch):
    leave_out_pixels(monkeypatch)
    place = write_sweep(tmp_path, BREAKS, "0.2 s")
    code, out, said = commands_of(Crane(), capsys)("sweep", place, "-q", "-j", "1", "--json", "-o", tmp_path / "rows")
    told, words = only_object(out), " ".join(said.split())
    assert code == 0 and told["done"] == 3
    assert {"limit": "breaking_load", "cases": 2, "first_case": 1} in told["limits_not_satisfied"]
    assert words.count("warning: breaking_load failed in 2 of 3 cases, first case 1.") == 1
    head, *rows = csv.reader((tmp_path / "rows" / "sweep.csv").open())
    column = head.index("limits_not_satisfied")
    assert rows[0][column] == "" and all("breaking_load" in row[column] for row in rows[1:])
    # 1.1 MN bear no load of 1.5 MN: `check` would say so of that scene, and the sweep's own is sound.
    assert "bodies[0].mass = 160000 kg: rope.breaking_load" in words


def test_a_limit_that_the_only_case_fails_is_told_without_others():
    failed = Unsatisfied({"breaking_load": {0}})
    assert failed.warnings(1) == ["breaking_load failed in the one case. Its numbers are given all the same"]
    assert "first case 0" in failed.warnings(2)[0] and "among those of the others" in failed.warnings(2)[0]


def test_cases_that_satisfy_all_limits_have_no_column_and_no_warning(tmp_path, capsys, monkeypatch):
    leave_out_pixels(monkeypatch)
    place = write_sweep(tmp_path, BREAKS.replace("150 t, 160 t", "3 t"), "0.2 s")
    code, out, said = commands_of(Crane(), capsys)("sweep", place, "-q", "-j", "1", "--json", "-o", tmp_path / "rows")
    told = only_object(out)
    assert code == 0 and told["limits_not_satisfied"] == [] and told["warnings"] == [] and "failed in" not in said
    assert "limits_not_satisfied" not in (tmp_path / "rows" / "sweep.csv").read_text()


def test_what_a_distribution_reaches_and_the_scene_cannot_have_is_refused_once_with_its_number(tmp_path, capsys):
    text = "vary:\n  'bodies[0].mass': {normal: [5 t, 5 t]}\nplan: {monte_carlo: {samples: 40, seed: 1}}\n"
    code, _, said = commands_of(Crane(), capsys)("sweep", write_sweep(tmp_path, text), "-o", tmp_path / "rows")
    words = " ".join(said.split())
    assert code == 2 and words.count("must not be negative") == 1 and "of the 40 values" in words
    assert not (tmp_path / "rows").exists()


def test_cases_that_failed_are_told_with_their_reason_however_quiet_and_stand_among_the_warnings(
    tmp_path, capsys, monkeypatch
):
    leave_out_pixels(monkeypatch)
    # The hook hangs from the boom tip at 30 m; one at 4 m is below it.
    text = "vary:\n  'path[1].sheave.center[2]': [30 m, 4 m]\ncollect: [max_tension]\n"
    place = write_sweep(tmp_path, text, "0.2 s")
    code, out, said = commands_of(Crane(), capsys)("sweep", place, "-q", "-j", "1", "--json", "-o", tmp_path / "rows")
    told, words = only_object(out), " ".join(said.split())
    assert code == 0 and (told["done"], told["failed"]) == (1, 1)
    (reason,) = [text for text in told["warnings"] if text.startswith("case 1: bad input: ")]
    assert words.count(f"warning: {' '.join(reason.split())}") == 1
