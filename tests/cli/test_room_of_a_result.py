"""A result that its disk has no room for is warned of before the run begins, by what its frames will take."""

from collections import namedtuple
from pathlib import Path

import pytest
from cli.in_process import commands_of

from tautline.application.installed import Installed
from tautline.cli.output import disk_space
from tautline.simulation import simulate

DATA = Path(__file__).parents[2] / "data"
Usage = namedtuple("Usage", "total used free")


def _model(scene, **overrides):
    application, read = Installed().read(DATA / f"{scene}.yaml")
    return application.build(application.with_overrides(read, **overrides))


@pytest.fixture
def little_room(monkeypatch):
    """A disk with 5 kB left, and a look at however few frames."""
    monkeypatch.setattr(disk_space, "WORTH_A_LOOK", 0.0)
    monkeypatch.setattr(disk_space.shutil, "disk_usage", lambda folder: Usage(10_000, 5_000, 5_000))


@pytest.mark.parametrize("scene", ["jwell", "hoist", "hose", "reeled_span"])
def test_what_is_foretold_is_what_is_stored(scene, little_room, tmp_path):
    model = _model(scene, end=0.5)
    stored = simulate(model, tmp_path / "result.nc")
    assert disk_space.bytes_ahead(model) == sum(stored[variable.name].nbytes for variable in model.variables)


def test_short_runs_of_small_scenes_are_not_looked_at():
    model = _model("jwell", end=0.5)
    model.observe = None
    assert disk_space.bytes_ahead(model) == 0


def test_a_long_run_of_a_small_scene_is_looked_at():
    few, many = _model("jwell", end=2.0e4), _model("jwell", end=4.0e4)
    assert disk_space.bytes_ahead(few) > 5e8
    assert disk_space.bytes_ahead(many) == pytest.approx(2.0 * disk_space.bytes_ahead(few), rel=1e-5)


def test_what_keeps_statistics_alone_needs_no_room(little_room):
    model = _model("jwell", end=0.5)
    model.keep = object()
    assert disk_space.bytes_ahead(model) == 0


def test_the_warning_has_the_sizes_and_the_cure(little_room, tmp_path):
    model = _model("jwell", end=0.5)
    said = disk_space.room_warning(model, tmp_path / "result.nc")
    frames, size = round(0.5 / 0.05) + 1, disk_space.bytes_ahead(model)
    assert f"{frames} frames of {disk_space.size(size / frames)}" in said
    assert f"will be {disk_space.size(size)}" in said
    assert "5 kB are free" in said
    assert "output.interval" in said


@pytest.mark.parametrize(("share", "warned"), [(1.5, True), (2.5, False)])
def test_a_result_needs_room_for_two_copies(share, warned, little_room, monkeypatch, tmp_path):
    model = _model("jwell", end=0.5)
    free = round(share * disk_space.bytes_ahead(model))
    monkeypatch.setattr(disk_space.shutil, "disk_usage", lambda folder: Usage(free, 0, free))
    assert (disk_space.room_warning(model, tmp_path / "result.nc") is not None) is warned


def test_a_run_with_room_is_not_warned_of(tmp_path):
    assert disk_space.room_warning(_model("jwell", end=0.5), tmp_path / "result.nc") is None


def test_the_command_warns_and_runs(little_room, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    application, _ = Installed().read(DATA / "jwell.yaml")
    code, _, said = commands_of(application, capsys)("simulate", DATA / "jwell.yaml", "--end", 0.2, "--no-verify")
    assert code == 0, said
    assert "The run will stop when the disk is full" in " ".join(said.split())
    assert (tmp_path / "jwell.nc").exists()


@pytest.mark.parametrize(("amount", "said"), [(5e3, "5 kB"), (2.5e6, "2.5 MB"), (1.23e10, "12.3 GB"), (4e13, "40 TB")])
def test_sizes_are_told_as_people_read_them(amount, said):
    assert disk_space.size(amount) == said
