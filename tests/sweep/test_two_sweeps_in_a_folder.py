"""A folder is one sweep's from before its first case on, and one that comes to nothing leaves none behind."""

import json

import pytest
from cli.in_process import commands_of
from sweep.short_hoist import MASS, hoist, write_sweep

import tautline
from crane.application import Crane
from tautline.results.errors import ResultError
from tautline.sweeps.cases import Row
from tautline.sweeps.journal import NAME, Journal, list_figures

VARY = {MASS: [2000.0, 3000.0]}


def run(folder, **options):
    return tautline.sweep(hoist(0.05), VARY, jobs=1, folder=folder, **{"collect": ["max_tension"]} | options)


def rows_of(folder):
    return [line for line in map(json.loads, (folder / NAME).read_text("utf8").splitlines()) if "case" in line]


def other_sweep(folder, cases):
    """Another sweep of two cases runs so many of them."""
    other = Journal(folder, "other", 2, False)
    other.claim()
    other.begin()
    for case in range(cases):
        other.add(Row(case, "done", values={}))
    other.close()


def test_a_second_sweep_is_refused_before_the_first_case_of_the_one_that_is_running_has_ended(tmp_path):
    out, refused = tmp_path / "out", []

    def start_another(done, every):
        if done == 0:
            with pytest.raises(ResultError, match=r"process \d+ is writing this sweep") as error:
                run(out, collect=["rise"])
            refused.append(error.value)

    data = run(out, progress=start_another)
    assert len(refused) == 1 and (data["status"].values == "done").all() and len(rows_of(out)) == 2


@pytest.mark.parametrize("resume", [False, True])
def test_a_sweep_in_a_folder_that_another_is_writing_to_is_told_so_and_not_to_go_on(tmp_path, resume):
    out = tmp_path / "out"
    with pytest.raises(ResultError, match=r"process \d+ is writing this sweep"):
        running = Journal(out, "same", 2, False)
        running.claim()
        running.begin()
        running.add(Row(0, "done", values={}))
        try:
            Journal(out, "same", 2, resume)
        finally:
            running.close()
    # Who only looks takes no lock away, and leaves nothing.
    assert Journal(out, "same", 2, True).done == {0}
    assert [one.name for one in out.iterdir()] == [NAME]


def test_an_unfinished_sweep_that_came_while_another_one_was_being_checked_is_not_written_over(tmp_path):
    out = tmp_path / "out"
    late = Journal(out, "late", 8, False)
    other_sweep(out, 1)
    before = (out / NAME).read_bytes()
    with pytest.raises(ResultError, match="holds 1 finished cases of 2: they would be lost"):
        late.claim()
    late.close()
    assert [one.name for one in out.iterdir()] == [NAME] and (out / NAME).read_bytes() == before


def test_figures_of_a_sweep_that_ended_while_another_one_was_being_checked_are_set_aside_with_it(tmp_path):
    out = tmp_path / "out"
    late = Journal(out, "late", 8, False)
    other_sweep(out, 2)
    (out / "rise.png").write_bytes(b"of the other")
    list_figures(out, [out / "rise.png"])
    late.claim()
    late.begin()
    late.close()
    assert {one.name for one in (out / "earlier").iterdir()} == {NAME, "rise.png"}
    assert {one.name for one in out.iterdir()} == {NAME, "earlier"}


@pytest.mark.parametrize("there", [False, True], ids=["new folder", "folder that was there"])
def test_a_sweep_that_is_interrupted_before_any_case_leaves_the_disk_as_it_was(tmp_path, there):
    out = tmp_path / "out"
    if there:
        out.mkdir()

    def stop(done, every):
        raise KeyboardInterrupt

    with pytest.raises(tautline.SweepInterrupted):
        run(out, progress=stop)
    assert out.exists() == there and not any(out.glob("*"))


def test_a_sweep_that_is_refused_after_its_first_case_leaves_no_folder(tmp_path):
    out, key = tmp_path / "out", "path[0].drum.pay_out.ramp.to"
    with pytest.raises(tautline.SceneError, match="no_such_figure"):
        tautline.sweep(hoist(0.05), {key: [-1.0]}, collect=["no_such_figure"], jobs=1, folder=out)
    assert not out.exists()


def test_the_line_to_go_on_with_names_the_folder_even_where_no_case_has_ended(tmp_path, capsys, monkeypatch):
    from tautline.cli.output.progress import Counter

    def stop(self, done, every):
        raise KeyboardInterrupt

    write_sweep(tmp_path, f"vary: {{'{MASS}': [2 t, 4 t]}}\ncollect: [max_tension]", "50 ms")
    monkeypatch.setattr(Counter, "__call__", stop)
    monkeypatch.chdir(tmp_path)
    code, _, said = commands_of(Crane(), capsys)("sweep", "limits.yaml", "-o", "elsewhere", "-j", "1")
    assert code == 130 and "crane sweep limits.yaml -o elsewhere --resume" in " ".join(said.split())
    assert not (tmp_path / "elsewhere").exists()
