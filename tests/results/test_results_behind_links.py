"""A result that is named by a link is written where the link leads, and the link stays: `latest.nc`, a large disk."""

from pathlib import Path

import numpy as np
import pytest

from tautline.cli.output import disk_space
from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.results.store import Store
from tautline.results.variable import Variable


@pytest.fixture
def link(tmp_path) -> Path:
    (tmp_path / "disk").mkdir()
    (tmp_path / "named.nc").symlink_to(Path("disk") / "run.nc")
    return tmp_path / "named.nc"


def store(path, first=0.0):
    made = Store(path, [Variable("a", ("time",), "m", "a")], {}, {"scene": "a: 1"})
    made.append({"time": np.array([0.0, 1.0]), "a": np.array([first, 2.0])})
    return made


@pytest.mark.parametrize("there", [False, True])
def test_the_file_that_a_link_leads_to_is_written_and_the_link_stays(link, there):
    target = link.parent / "disk" / "run.nc"
    if there:
        store(target).finish()
    with store(link, 7.0) as made:
        hidden = {one.name for one in target.parent.iterdir()} - {"run.nc"}
        assert hidden and [one.name for one in link.parent.iterdir() if one.name.startswith(".")] == []
        assert made.finish().path == link
    assert link.is_symlink() and not target.is_symlink()
    assert Result(target)["a"][0] == 7.0
    assert [one.name for one in target.parent.iterdir()] == ["run.nc"]


def test_a_run_by_a_link_and_one_by_the_name_of_its_file_are_kept_apart(link):
    with store(link), pytest.raises(ResultError, match="is writing this result"):
        store(link.parent / "disk" / "run.nc")


def test_a_link_to_a_folder_that_is_not_there_is_refused_by_that_folder(tmp_path):
    (tmp_path / "a.nc").symlink_to(tmp_path / "gone" / "a.nc")
    with pytest.raises(ResultError, match=r"there is no folder .*gone"):
        store(tmp_path / "a.nc")
    assert (tmp_path / "a.nc").is_symlink()


def test_room_is_looked_for_on_the_disk_that_a_link_leads_to(link, monkeypatch):
    asked = []

    class Usage:
        free = 1e9

    monkeypatch.setattr(disk_space, "bytes_ahead", lambda model: 1.0)
    monkeypatch.setattr(disk_space.shutil, "disk_usage", lambda folder: asked.append(folder) or Usage)
    assert disk_space.room_warning(None, link) is None
    assert asked == [(link.parent / "disk").resolve()]
