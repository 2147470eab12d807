"""A file that a sweep reads and that is replaced on the way ends it: one table never holds two inputs."""

import json
import os

import pytest
from sweep.short_hoist import HOIST, MASS

import tautline
from tautline.results.errors import ResultError
from tautline.scene.errors import SceneError
from tautline.sweeps.journal import NAME

VARY = {MASS: {"linspace": [2000, 8000, 12]}}
SLOW, QUICK = "t,speed\n0,0\n1,-0.5\n", "t,speed\n0,0\n1,-1.5\n"


@pytest.fixture
def scene(tmp_path):
    """A hoist whose drum follows a file beside it."""
    path, speed = tmp_path / "hoist.yaml", tmp_path / "speed.csv"
    text = HOIST.read_text(encoding="utf8").replace("end: 12 s", "end: 50 ms")
    path.write_text(text.replace("{ramp: {to: -2.0, over: 1.0}}", "{table: {file: speed.csv, column: speed}}"), "utf8")
    speed.write_text(SLOW, encoding="utf8")
    return path


def replaced_after(scene, cases, text):
    """A progress that replaces the file of the scene when so many cases are done."""

    def see(done, every):
        if done == cases:
            waiting = scene.with_name("new.csv")
            waiting.write_text(text, encoding="utf8")
            os.replace(waiting, scene.with_name("speed.csv"))

    return see


def rows_of(folder):
    lines = [json.loads(line) for line in (folder / NAME).read_text(encoding="utf8").splitlines()]
    return [line for line in lines if "case" in line]


def values_of(rows):
    return {row["case"]: row["values"] for row in rows}


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_file_that_is_replaced_ends_the_sweep_names_the_file_and_keeps_rows_of_the_first_only(scene, tmp_path, jobs):
    alone = tautline.sweep(scene, VARY, collect=["max_tension"], jobs=1, folder=tmp_path / "alone")
    out = tmp_path / "out"
    with pytest.raises(SceneError, match=r"speed.csv: is not the file .* cases finished .* are kept in .*`resume`"):
        tautline.sweep(
            scene, VARY, collect=["max_tension"], jobs=jobs, folder=out, progress=replaced_after(scene, 3, QUICK)
        )  # fmt: skip
    kept, whole = values_of(rows_of(out)), values_of(rows_of(tmp_path / "alone"))
    assert 3 <= len(kept) < 12
    assert all(whole[case] == values for case, values in kept.items())
    assert not (out / "sweep.nc").exists()
    with pytest.raises(ResultError, match=r"another sweep: .*speed.csv has been changed.*put the file back"):
        tautline.sweep(scene, VARY, collect=["max_tension"], jobs=1, folder=out, resume=True)
    (tmp_path / "speed.csv").write_text(SLOW, encoding="utf8")
    again = tautline.sweep(scene, VARY, collect=["max_tension"], jobs=1, folder=out, resume=True)
    assert (again["max_tension"].values == alone["max_tension"].values).all()


def test_a_file_that_is_written_again_with_the_same_contents_changes_nothing(scene):
    data = tautline.sweep(scene, VARY, collect=["rise"], jobs=1, progress=replaced_after(scene, 3, SLOW))
    assert (data["status"].values == "done").all()


def test_a_file_that_is_replaced_after_the_last_case_is_told_and_one_that_is_removed_too(scene, tmp_path):
    with pytest.raises(SceneError, match=r"speed.csv: is not the file .* 12 of 12 cases finished"):
        tautline.sweep(scene, VARY, collect=["rise"], jobs=1, progress=replaced_after(scene, 12, QUICK))
    with pytest.raises(SceneError, match=r"speed.csv: is not there any more; .* run it again"):
        tautline.sweep(
            scene, VARY, collect=["rise"], jobs=1,
            progress=lambda done, every: (tmp_path / "speed.csv").unlink(missing_ok=True),
        )  # fmt: skip


def test_a_case_that_reads_a_file_while_it_is_written_is_no_row(scene, tmp_path, monkeypatch):
    """The file is another one when the case looks, and half written when it reads: not its own bad input."""
    from tautline.sweeps.cases import Runner

    of_case, seen = Runner._row, []

    def half_written(runner, case, changes):
        seen.append(case)
        if case == 4:
            (tmp_path / "speed.csv").write_text("t,spe", encoding="utf8")
        return of_case(runner, case, changes)

    monkeypatch.setattr(Runner, "_row", half_written)
    out = tmp_path / "out"
    with pytest.raises(SceneError, match=r"speed.csv: is not the file"):
        tautline.sweep(scene, VARY, collect=["max_tension"], jobs=1, folder=out)
    assert [row["case"] for row in rows_of(out)] == [0, 1, 2, 3] and seen[-1] == 4


def test_a_file_that_is_touched_in_every_case_lets_the_sweep_end_with_the_rows_of_its_contents(
    scene, tmp_path, monkeypatch
):
    from tautline.sweeps.cases import Runner

    alone = tautline.sweep(scene, VARY, collect=["max_tension"], jobs=1)
    of_case, runs = Runner._row, []

    def touched(runner, case, changes):
        runs.append(case)
        if len(runs) > 100:
            raise KeyboardInterrupt
        found = of_case(runner, case, changes)
        os.utime(tmp_path / "speed.csv", ns=(len(runs), len(runs)))
        return found

    monkeypatch.setattr(Runner, "_row", touched)
    data = tautline.sweep(scene, VARY, collect=["max_tension"], jobs=1)
    assert (data["max_tension"].values == alone["max_tension"].values).all() and len(runs) <= 3 * 12


def test_a_changed_file_is_told_as_a_worker_sees_it_of_workers_elsewhere_only():
    pytest.importorskip("distributed")
    from tautline.scene.errors import option_error
    from tautline.sweeps import workers
    from tautline.sweeps.inputs import InputChanged

    error = InputChanged(option_error("speed.csv", "", "is not the file that it was").problems)
    for address, told in ((workers.LOCAL, False), ("tcp://10.0.0.1:8786", True)):
        with pytest.raises(InputChanged, match="is not the file") as found:
            list(workers._lost(error, [1], address))
        assert ("as a worker sees it" in str(found.value)) is told


def test_a_worker_that_sees_another_file_under_the_same_path_runs_no_case(scene, tmp_path):
    import pickle

    from tautline.sweeps import cases
    from tautline.sweeps.inputs import InputChanged, hashes_of

    read = tautline.read(scene)
    packed = pickle.dumps(cases.job_of(tautline._installed().of(read), read, "simulate", {}, (), hashes_of([read])))
    (tmp_path / "speed.csv").write_text(QUICK, encoding="utf8")
    with pytest.raises(InputChanged, match=r"speed.csv: is not the file"):
        cases._runner.__wrapped__(packed)


def test_a_file_that_a_value_can_name_only_beside_others_counts_as_well(scene, tmp_path):
    (tmp_path / "other.csv").write_text("t,rate\n0,0\n1,-0.7\n", encoding="utf8")
    key = "path[0].drum.pay_out.table"
    vary = {f"{key}.file": ["speed.csv", "other.csv"], f"{key}.column": ["speed", "rate"]}

    def change(done, every):
        if done == 1:
            (tmp_path / "other.csv").write_text("t,rate\n0,0\n1,-1.7\n", encoding="utf8")

    with pytest.raises(SceneError, match=r"other.csv: is not the file"):
        tautline.sweep(scene, vary, "zip", ["rise"], jobs=1, progress=change)


@pytest.mark.parametrize("text", ["t,speed\n0,0\n1,much\n", None], ids=["that cannot be read", "that is gone"])
def test_a_file_without_which_no_scene_can_be_read_is_named_where_the_sweep_is_to_go_on(text, scene, tmp_path):
    other = tmp_path / "other.csv"
    other.write_text(QUICK, encoding="utf8")
    vary = {"path[0].drum.pay_out.table.file": ["speed.csv", "other.csv"]}
    tautline.sweep(scene, vary, collect=["rise"], jobs=1, folder=tmp_path / "out")
    other.unlink()
    if text is not None:
        other.write_text(text, encoding="utf8")
    with pytest.raises(ResultError, match=r"another sweep: .*other.csv has been changed.*put the file back"):
        tautline.sweep(scene, vary, collect=["rise"], jobs=1, folder=tmp_path / "out", resume=True)
