"""Figures in the folder of a sweep are those of its last sweep; what the journal does not list is left alone."""

import json

import pytest
from cli.in_process import commands_of, leave_out_pixels
from sweep.short_hoist import MASS, write_sweep

from crane.application import Crane
from tautline.sweeps.journal import NAME, list_figures

VARY = f"vary: {{'{MASS}': [2 t, 4 t]}}\ncollect: "


@pytest.fixture
def sweep_(tmp_path, monkeypatch, capsys):
    """Run a sweep of two cases that collects some figures; gives exit code and the pictures in its folder."""
    monkeypatch.chdir(tmp_path)
    leave_out_pixels(monkeypatch)
    command = commands_of(Crane(), capsys)

    def run(collect, *options):
        write_sweep(tmp_path, VARY + f"[{collect}]", "50 ms")
        code, _, told = command("sweep", "limits.yaml", "-o", "out", "-j", "1", *options)
        assert code == 0, told
        return sorted(one.name for one in (tmp_path / "out").glob("*.png"))

    return run


def test_a_second_sweep_removes_the_figures_that_the_journal_of_the_first_lists_and_no_other(sweep_, tmp_path):
    assert sweep_("max_tension, rise") == ["max_tension.png", "rise.png"]
    for name in ("mine.png", "winch.tension.png"):
        (tmp_path / "out" / name).write_bytes(b"mine")
    (tmp_path / "max_tension.png").write_bytes(b"beside")
    assert sweep_("min_tension, rise") == ["min_tension.png", "mine.png", "rise.png", "winch.tension.png"]
    assert (tmp_path / "out" / "mine.png").read_bytes() == b"mine"
    assert (tmp_path / "max_tension.png").read_bytes() == b"beside"
    lines = [json.loads(line) for line in (tmp_path / "out" / NAME).read_text(encoding="utf8").splitlines()]
    assert [line["figures"] for line in lines if "figures" in line] == [["min_tension.png", "rise.png"]]


def test_a_sweep_that_is_gone_on_with_keeps_its_figures(sweep_):
    assert sweep_("max_tension, rise") == sweep_("max_tension, rise", "--resume") == ["max_tension.png", "rise.png"]


def test_only_pictures_in_the_folder_itself_are_ever_removed_whatever_a_journal_says(tmp_path):
    (tmp_path / "out").mkdir()
    for name in ("beside.png", "out/notes.txt", "out/old.png"):
        (tmp_path / name).write_text("mine")
    head = {"format": "tautline sweep 1", "sweep": "", "cases": 0}
    names = {"figures": ["../beside.png", str(tmp_path / "beside.png"), "notes.txt", "old.png"]}
    (tmp_path / "out" / NAME).write_text(json.dumps(head) + "\n" + json.dumps(names) + "\n")
    list_figures(tmp_path / "out", [tmp_path / "out" / "new.png"])
    assert sorted(one.name for one in tmp_path.rglob("*.*")) == ["beside.png", NAME, "notes.txt"]
