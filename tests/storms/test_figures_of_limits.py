"""A folder of operability has the figures of the limits that were asked for last, and keeps what is not its own."""

from __future__ import annotations

import pytest
from cli.in_process import commands_of, leave_out_pixels, only_object
from storms.test_limits_of_the_scene import SCENE

from crane.application import Crane
from tautline.sweeps.journal import ASIDE

SEA = ("--hs", "0.5,1", "--tp", "8", "--seeds", "3", "--duration", "10 s", "--lead-in", "5 s", "-j", "1", "--quiet")


@pytest.fixture
def run(capsys, monkeypatch, tmp_path):
    leave_out_pixels(monkeypatch)
    command = commands_of(Crane(), capsys)
    (tmp_path / "heave.yaml").write_text(SCENE)

    def go(*more):
        code, out, err = command("operability", tmp_path / "heave.yaml", *SEA, "-o", tmp_path / "op", "--json", *more)
        assert code == 0, err
        return only_object(out)

    return go


def test_figures_of_limits_that_are_not_asked_for_any_more_are_removed_and_no_other_file_is(run, tmp_path):
    folder = tmp_path / "op"
    run("--limit", "max_tension < 60 kN", "--limit", "min_tension > 5 kN")
    assert {one.name for one in folder.glob("*.png")} == {
        "allowable_max_tension_60_kN.png", "allowable_min_tension_5_kN.png", "allowable_all_limits.png",
    }  # fmt: skip
    for name in ("allowable_mine.png", "notes.txt"):
        (folder / name).write_text("of the user")
    told = run("--limit", "max_tension < 55 kN", "--limit", "min_tension > 5 kN", "--resume")
    assert told["earlier"] == 6
    mine = {"allowable_mine.png"}
    assert {one.name for one in folder.glob("*.png")} - mine == {
        "allowable_max_tension_55_kN.png", "allowable_min_tension_5_kN.png", "allowable_all_limits.png",
    }  # fmt: skip
    assert {path.rpartition("/")[2] for path in told["figures"]} == {one.name for one in folder.glob("*.png")} - mine
    assert (folder / "allowable_mine.png").read_text() == (folder / "notes.txt").read_text() == "of the user"


def test_a_new_run_in_the_folder_leaves_no_figure_of_the_run_before(run, tmp_path):
    folder = tmp_path / "op"
    run("--limit", "max_tension < 60 kN")
    run("--limit", "min_tension > 5 kN")
    assert {one.name for one in folder.glob("*.png")} == {"allowable_min_tension_5_kN.png"}
    assert not (folder / ASIDE).exists()
