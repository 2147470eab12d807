"""A figure that is asked for and that no case has keeps its column, and the summary says that it is empty."""

from __future__ import annotations

import csv

import numpy as np
from cli.in_process import commands_of
from sweep.short_hoist import MASS, hoist, write_sweep

import tautline
from crane.application import Crane

COLLECT = ["max_tension", "slack_events", "max_snap"]


def test_a_snap_that_no_case_has_is_a_variable_without_numbers():
    data = tautline.sweep(hoist(0.3), {MASS: ["3 t", "4 t"]}, collect=COLLECT, jobs=1)
    assert (data["slack_events"] == 0).all()
    assert data["max_snap"].attrs["units"] == "N" and np.isnan(data["max_snap"].values).all()


def test_the_table_has_an_empty_column_for_it_and_the_summary_says_so(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    path = write_sweep(tmp_path, f"vary:\n  '{MASS}': [3 t, 4 t]\ncollect: [{', '.join(COLLECT)}]\n", "0.3 s")
    code, out, err = commands_of(Crane(), capsys)("sweep", path, "-j", 1, "-o", "made")
    assert code == 0 and "max_snap: no case has one; its column is empty" in " ".join((out + err).split())
    with open(tmp_path / "made" / "sweep.csv", encoding="utf8") as file:
        head, *rows = csv.reader(file)
    column = head.index("max_snap [N]")
    assert [row[column] for row in rows] == ["", ""]
