"""What is said of compiling: that it is once only and kept, where that is so."""

import pytest

from tautline.cli.output import first_run
from tautline.kernels.machine import storage


@pytest.fixture
def said(monkeypatch):
    """What is said of compiling two kernels, with nothing known of the cache before."""
    told: list[str] = []
    monkeypatch.setattr(first_run, "say", lambda text, *_: told.append(text))
    monkeypatch.setattr(storage, "_told", [])
    monkeypatch.setattr(storage, "shipped_for", lambda: None)
    storage.folder_to_write.cache_clear()
    yield told
    storage.folder_to_write.cache_clear()


def test_code_that_is_kept_is_said_to_be(said, monkeypatch, tmp_path):
    monkeypatch.setenv("TAUTLINE_CACHE", str(tmp_path))
    first_run.compiling(2)()
    assert "Once only." in said[0] and said[1].endswith(" s, and kept for later runs")


def test_code_that_cannot_be_kept_is_not_said_to_be(said, monkeypatch, tmp_path, capsys):
    (tmp_path / "file").touch()
    monkeypatch.setenv("TAUTLINE_CACHE", str(tmp_path / "file" / "below"))
    first_run.compiling(2)()
    assert "Once only" not in said[0] and said[1].endswith(" s")


def test_code_that_could_not_be_written_is_not_said_to_be_kept(said, monkeypatch, tmp_path, capsys):
    monkeypatch.setenv("TAUTLINE_CACHE", str(tmp_path))
    done = first_run.compiling(2)
    storage.say_not_kept("No space left on device")
    done()
    assert "Once only." in said[0] and said[1].endswith(" s")
