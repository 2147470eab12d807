"""A sweep that is killed goes on: no finished case is run again, and nothing is twice in the result."""

import json
import os
import signal
import subprocess
import sys
import time
from collections import Counter

import numpy as np
import pytest
import xarray
from cli.in_process import commands_of
from sweep.short_hoist import HOIST, MASS, PERIOD, hoist, write_sweep

import tautline
from crane.application import Crane
from tautline.results.errors import ResultError
from tautline.sweeps.journal import NAME, Journal

CASES = 30
VARY = {MASS: {"linspace": [2000, 8000, CASES]}}


def lines_of(folder):
    """Whole lines of the journal that are rows."""
    path = folder / NAME
    text = path.read_bytes() if path.exists() else b""
    whole = [json.loads(line) for line in text.split(b"\n")[:-1]]
    return [line for line in whole if "case" in line]


def command(folder, *words):
    return [sys.executable, "-m", "crane.main", "sweep", "limits.yaml", "-o", "out", "-q", *words], {"cwd": folder}


def test_after_kill_9_no_finished_case_runs_again_and_the_result_is_that_of_one_go(tmp_path, capsys):
    write_sweep(tmp_path, f"vary: {{'{MASS}': {{linspace: [2000, 8000, {CASES}]}}}}\ncollect: [max_tension]", "4 s")
    out = tmp_path / "out"
    words, where = command(tmp_path, "-j", "2")
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, **where)
    try:
        while len(lines_of(out)) < 5 and process.poll() is None:
            time.sleep(0.005)
    finally:
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
    before = lines_of(out)
    assert 5 <= len(before) < CASES
    # What was killed was a process with two workers; to go on this one does as well as another.
    words = ("sweep", tmp_path / "limits.yaml", "-o", out, "-q", "-j", "1", "--resume", "--json")
    code, printed, said = commands_of(Crane(), capsys)(*words)
    assert code == 0, said
    told, after = json.loads(printed), lines_of(out)
    assert (told["cases"], told["done"], told["earlier"]) == (CASES, CASES, len(before))
    assert after[: len(before)] == before
    assert Counter(line["case"] for line in after) == Counter(range(CASES))
    assert {line["process"] for line in after[len(before) :]}.isdisjoint({line["process"] for line in before})
    with xarray.open_dataset(out / "sweep.nc", engine="h5netcdf") as data:
        assert (data["status"].values == "done").all()
        for case in (0, before[-1]["case"], CASES - 1):
            alone = tautline.simulate(hoist(4.0, **{MASS: float(data[MASS].values[case])}))
            assert data["max_tension"].values[case] == alone.headline["max_tension"]["value"]


def run(folder, **options):
    return tautline.sweep(hoist(0.05), VARY, collect=["max_tension"], jobs=1, folder=folder, **options)


def test_a_line_that_was_cut_off_is_run_again_and_stands_once(tmp_path):
    out = tmp_path / "out"
    whole = run(out)
    journal = out / NAME
    lines = journal.read_bytes().splitlines(keepends=True)
    journal.write_bytes(b"".join(lines[:12]) + lines[12][:20])
    again = run(out, resume=True)
    assert Counter(line["case"] for line in lines_of(out)) == Counter(range(CASES))
    assert np.array_equal(again["max_tension"].values, whole["max_tension"].values)


def test_a_sweep_that_is_not_finished_is_not_lost_by_mistake(tmp_path):
    out = tmp_path / "out"
    run(out)
    journal = out / NAME
    journal.write_bytes(b"".join(journal.read_bytes().splitlines(keepends=True)[:9]))
    with pytest.raises(ResultError, match="holds 7 finished cases of 30"):
        run(out)
    assert len(lines_of(out)) == 7


@pytest.mark.parametrize(
    "line",
    [
        "{}", "[]", "7", '{"case": "one"}', '{"case": 3, "status": "done", "more": 1}', '{"case": 0', "\xff\0",
        pytest.param("[" * 100_000, id="brackets"),
    ],
)  # fmt: skip
def test_a_journal_with_a_line_that_no_sweep_writes_is_damaged_and_stays(tmp_path, line):
    out = tmp_path / "out"
    out.mkdir()
    (out / NAME).write_text(line + "\n")
    for resume in (False, True):
        with pytest.raises(ResultError, match="is damaged: line 1 is none of a sweep"):
            run(out, resume=resume)
    assert (out / NAME).read_text() == line + "\n"


@pytest.mark.parametrize("case", [-1, 2])
def test_a_case_that_the_sweep_has_not_is_damage_told_with_its_line(tmp_path, case):
    head = {"format": "tautline sweep 1", "sweep": "x", "cases": 2}
    lines = [head, {"case": 0, "status": "done"}, {"case": case, "status": "done"}]
    (tmp_path / NAME).write_text("".join(json.dumps(line) + "\n" for line in lines))
    for resume in (False, True):
        with pytest.raises(ResultError, match=f"is damaged: line 3 has case {case}, and the sweep only 2 cases"):
            Journal(tmp_path, "x", 2, resume)


def test_another_sweep_cannot_go_on_in_its_place(tmp_path):
    out = tmp_path / "out"
    run(out)
    with pytest.raises(ResultError, match="another sweep"):
        tautline.sweep(hoist(0.05), {MASS: [2000.0]}, collect=["rise"], jobs=1, folder=out, resume=True)
    with pytest.raises(ResultError, match="another sweep"):
        tautline.sweep(hoist(0.06), VARY, collect=["max_tension"], jobs=1, folder=out, resume=True)


def test_keys_in_another_order_are_another_sweep_for_its_cases_have_other_numbers(tmp_path):
    out, keys = tmp_path / "out", {MASS: [2000.0, 5000.0], PERIOD: [6.0, 7.0, 8.0]}
    tautline.sweep(hoist(0.05), keys, collect=["rise"], jobs=1, folder=out)
    with pytest.raises(ResultError, match="another sweep"):
        tautline.sweep(
            hoist(0.05), dict(reversed(keys.items())), collect=["rise"], jobs=1, folder=out, resume=True
        )  # fmt: skip


def test_percentiles_of_an_earlier_sweep_do_not_stay_beside_a_grid(tmp_path):
    out = tmp_path / "out"
    spread = {MASS: {"uniform": [2000, 5000]}}
    tautline.sweep(hoist(0.05), spread, {"monte_carlo": {"samples": 3}}, ["rise"], jobs=1, folder=out)
    assert (out / "percentiles.csv").exists()
    tautline.sweep(hoist(0.05), {MASS: [2000.0]}, collect=["rise"], jobs=1, folder=out)
    assert not (out / "percentiles.csv").exists()


def test_a_finished_sweep_that_is_gone_on_with_runs_nothing(tmp_path):
    out = tmp_path / "out"
    run(out)
    before = (out / NAME).read_bytes()
    assert (run(out, resume=True)["status"].values == "done").all()
    assert (out / NAME).read_bytes() == before


def test_a_folder_with_other_files_is_left_alone(tmp_path):
    (tmp_path / "thesis.txt").write_text("years of work", encoding="utf8")
    with pytest.raises(ResultError, match="holds other files"):
        run(tmp_path)
    assert [one.name for one in tmp_path.iterdir()] == ["thesis.txt"]


def test_ctrl_c_keeps_what_is_finished_and_says_so(tmp_path):
    def stop(done, every):
        if done == 4:
            raise KeyboardInterrupt

    with pytest.raises(tautline.SweepInterrupted) as found:
        tautline.sweep(hoist(0.05), VARY, collect=["rise"], jobs=2, folder=tmp_path / "out", progress=stop)
    status = found.value.data["status"].values
    assert (status == "done").sum() == 4 and (status == "not run").sum() == CASES - 4
    assert len(lines_of(tmp_path / "out")) == 4


def test_cases_that_fail_before_the_first_that_ends_are_in_the_journal_at_once(tmp_path):
    # They have run for as long as others: after kill -9 they need not run again.
    out, seen = tmp_path / "out", []
    key = "path[0].drum.pay_out.ramp.to"
    tautline.sweep(
        hoist(2.0), {key: [-20.0, -21.0, -22.0]}, collect=["rise"], jobs=1, folder=out,
        progress=lambda done, every: seen.append(len(lines_of(out))),
    )  # fmt: skip
    assert seen == [0, 1, 2, 3]
    assert {line["status"] for line in lines_of(out)} == {"two blocked"}


def test_a_file_that_a_value_names_and_that_has_changed_makes_another_sweep(tmp_path):
    scene = tmp_path / "hoist.yaml"
    scene.write_text(HOIST.read_text(encoding="utf8").replace("end: 12 s", "end: 50 ms"), encoding="utf8")
    speed, out = tmp_path / "speed.csv", tmp_path / "out"
    speed.write_text("t,speed\n0,0\n1,-0.5\n", encoding="utf8")
    vary = {"path[0].drum.pay_out": [{"constant": 0.0}, {"table": {"file": "speed.csv", "column": "speed"}}]}
    tautline.sweep(scene, vary, collect=["rise"], jobs=1, folder=out)
    speed.write_text("t,speed\n0,0\n1,-1.5\n", encoding="utf8")
    with pytest.raises(ResultError, match="another sweep"):
        tautline.sweep(scene, vary, collect=["rise"], jobs=1, folder=out, resume=True)


def test_results_of_an_earlier_sweep_do_not_stand_beside_one_that_stopped_and_are_not_lost(tmp_path):
    out, spread = tmp_path / "out", {MASS: {"uniform": [2000, 5000]}}
    tautline.sweep(hoist(0.05), spread, {"monte_carlo": {"samples": 3}}, ["rise"], jobs=1, folder=out)
    (out / "mine.txt").write_text("mine")
    first = {name: (out / name).read_bytes() for name in ("sweep.nc", "sweep.csv", "percentiles.csv", NAME)}

    def fail(done, every):
        if done == 4:
            raise RuntimeError("the machine is lost")

    with pytest.raises(RuntimeError):
        run(out, progress=fail)
    assert sorted(one.name for one in out.iterdir() if not one.name.startswith(".")) == ["earlier", NAME, "mine.txt"]
    assert {one.name: one.read_bytes() for one in (out / "earlier").iterdir()} == first
    assert len(lines_of(out)) == 4
    run(out, resume=True)
    left = [NAME, "mine.txt", "sweep.csv", "sweep.nc"]
    assert sorted(one.name for one in out.iterdir() if not one.name.startswith(".")) == left
    assert len(lines_of(out)) == CASES


def test_a_sweep_that_is_interrupted_says_where_the_results_of_the_one_before_it_are(tmp_path, capsys, monkeypatch):
    from tautline.cli.output.progress import Counter

    write_sweep(tmp_path, f"vary: {{'{MASS}': [2 t, 4 t]}}\ncollect: [max_tension]", "50 ms")
    words = ("sweep", tmp_path / "limits.yaml", "-o", tmp_path / "out", "-j", "1", "--json")
    assert json.loads(commands_of(Crane(), capsys)(*words)[1])["earlier_results"] is None
    pictures = {one.name for one in (tmp_path / "out").glob("*.png")}

    def stop(self, done, every):
        if done == 1:
            raise KeyboardInterrupt

    monkeypatch.setattr(Counter, "__call__", stop)
    code, printed, said = commands_of(Crane(), capsys)(*words)
    assert code == 130 and json.loads(printed)["earlier_results"] == str(tmp_path / "out" / "earlier")
    assert "results of an earlier sweep are not those of this one" in " ".join(said.split())
    assert pictures and pictures < {one.name for one in (tmp_path / "out" / "earlier").iterdir()}
