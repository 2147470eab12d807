"""Files that are written beside their place: what is there stays until the new one is whole."""

import os
import stat
import threading

import pytest

from tautline.results.tables.rows import write_rows
from tautline.whole_file import name_beside, take_name, whole_file


def test_a_file_is_as_it_was_until_the_new_one_is_whole(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("old")
    with whole_file(path) as waiting:
        waiting.write_text("new")
        assert path.read_text() == "old"
        assert waiting.suffix == ".csv"
    assert path.read_text() == "new"
    assert os.listdir(tmp_path) == ["a.csv"]


@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), KeyboardInterrupt(), ValueError()])
def test_whatever_ends_the_writing_leaves_the_old_file_and_nothing_beside(tmp_path, error):
    path = tmp_path / "a.csv"
    path.write_text("old")
    with pytest.raises(type(error)), whole_file(path) as waiting:
        waiting.write_text("half")
        raise error
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["a.csv"]


def test_a_link_stays_one_and_what_it_leads_to_is_replaced(tmp_path):
    (tmp_path / "there").mkdir()
    path, link = tmp_path / "there" / "a.csv", tmp_path / "link.csv"
    path.write_text("old")
    link.symlink_to(path)
    with whole_file(link) as waiting:
        waiting.write_text("new")
    assert link.is_symlink() and path.read_text() == "new"


def test_a_file_keeps_its_permissions(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("old")
    path.chmod(0o640)
    with whole_file(path) as waiting:
        waiting.write_text("new")
    assert stat.S_IMODE(path.stat().st_mode) == 0o640


def test_a_file_that_must_not_be_written_is_not_replaced(tmp_path, monkeypatch):
    path = tmp_path / "a.csv"
    path.write_text("old")
    monkeypatch.setattr(os, "access", lambda *_: False)  # who is root may write all
    with pytest.raises(PermissionError), whole_file(path):
        pytest.fail("there is nothing to write")
    assert path.read_text() == "old"


def test_a_folder_is_no_file(tmp_path):
    with pytest.raises(IsADirectoryError), whole_file(tmp_path):
        pytest.fail("there is nothing to write")


def test_a_pipe_gets_what_is_written_at_once_and_stays(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    read = []
    reader = threading.Thread(target=lambda: read.append(pipe.read_text()))
    reader.start()
    with whole_file(pipe) as waiting:
        assert waiting == pipe
        waiting.write_text("rows")
    reader.join()
    assert read == ["rows"] and pipe.is_fifo()


def test_a_link_to_a_pipe_leaves_the_pipe(tmp_path):
    pipe, link = tmp_path / "pipe", tmp_path / "link"
    os.mkfifo(pipe)
    link.symlink_to(pipe)
    assert name_beside(link) == link
    take_name(link, link)
    assert pipe.is_fifo() and link.is_symlink()


def test_rows_that_cannot_be_told_leave_the_table_that_was_there(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("old")

    def rows():
        yield [1.0]
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_rows(["time [s]"], rows(), path)
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["a.csv"]
