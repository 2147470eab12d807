"""A disk that is full does not silence a twin: it tells this once, goes on with lines and alarms, and tries again."""

import errno
import json
import os
import subprocess
import sys

import pytest
import yaml
from cli.in_process import commands_of
from of_the_suite import studies
from twin.rehearsal import SENSORS, hoist

from crane.application import Crane
from tautline.cli.commands import twin as command
from tautline.results import layout
from tautline.results.result import Result
from tautline.twin import storage

ROWS = 40


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A scene, a map with an alarm that is always raised, and a record."""
    folder = tmp_path_factory.mktemp("full")
    (folder / "scene.yaml").write_text(yaml.safe_dump(hoist({"time": [0, 9], "value": [0, 0]})))
    (folder / "map.yaml").write_text(SENSORS + "watch:\n  - {output: winch.tension, above: 1 kN, name: heavy}\n")
    rows = "".join(f"{0.1 * k:.1f},0,0,49\n" for k in range(ROWS))
    (folder / "rows.csv").write_text("time [s],winch_pos [m],heave [cm],rope_tension [kN]\n" + rows)
    return folder


class Full:
    """Fails to write as on a full disk, so many times or always."""

    def __init__(self, real, times=10**6):
        self.real, self.left = real, times

    def __call__(self, *arguments, **options):
        if self.left > 0:
            self.left -= 1
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return self.real(*arguments, **options)


def run(files, capsys, monkeypatch, *words):
    monkeypatch.setattr(command, "SAVE_EVERY", 0.0)
    here = commands_of(Crane(), capsys)
    code, out, told = here(
        "twin", files / "scene.yaml", "--map", files / "map.yaml", "--source", files / "rows.csv", "--json", *words
    )
    lines = [json.loads(line) for line in out.splitlines()]
    hidden = [one.name for one in files.iterdir() if ".part" in one.name or "lock" in one.name]
    return code, [one for one in lines if "estimates" in one], [one for one in lines if "file" in one], told, hidden


@pytest.mark.parametrize("what", ["state", "result"])
def test_a_full_disk_is_told_once_the_alarms_go_on_and_the_twin_ends_with_3(files, capsys, monkeypatch, what):
    if what == "state":
        monkeypatch.setattr(storage.np, "savez", Full(storage.np.savez))
    else:
        monkeypatch.setattr(layout, "create", Full(layout.create))
    words = ["-o", files / f"{what}.nc", "--state", files / f"{what}.st"]
    code, lines, saved, told, hidden = run(files, capsys, monkeypatch, *words)
    assert code == 3 and len(lines) == ROWS and lines[-1]["alarms"]
    assert told.count("cannot be saved") == 1 and "No space left on device" in told and "Traceback" not in told
    assert [(one["file"], one["saved"]) for one in saved] == [(what, False)]
    assert "--resume" not in told and not hidden
    if what == "state":
        assert Result.read(files / "state.nc").attributes["status"] == "done"
    else:
        assert (files / "result.st").exists()


def test_a_disk_that_has_room_again_loses_nothing(files, capsys, monkeypatch):
    monkeypatch.setattr(layout, "create", Full(layout.create, times=3))
    monkeypatch.setattr(storage.np, "savez", Full(storage.np.savez, times=3))
    code, _, saved, _, hidden = run(files, capsys, monkeypatch, "-o", files / "b.nc", "--state", files / "b.st")
    assert code == 0 and not hidden
    assert sorted((one["file"], one["saved"]) for one in saved) == [
        ("result", False), ("result", True), ("state", False), ("state", True),
    ]  # fmt: skip
    assert len(Result.read(files / "b.nc")["time"]) == ROWS


@pytest.mark.parametrize("what", ["state", "result"])
def test_a_folder_that_has_vanished_is_told_to_be_made_again_and_no_space_is_asked_for(
    files, capsys, monkeypatch, what
):
    folder, real = files / f"vanishing {what}", command._Loop._save
    folder.mkdir()

    def save(loop):
        if folder.exists():
            for one in folder.iterdir():
                one.unlink()
            folder.rmdir()
        real(loop)

    monkeypatch.setattr(command._Loop, "_save", save)
    words = {"state": ["--state", folder / "v.st"], "result": ["-o", folder / "v.nc"]}[what]
    code, lines, saved, told, _ = run(files, capsys, monkeypatch, *words)
    assert code == 3 and len(lines) == ROWS and [(one["file"], one["saved"]) for one in saved] == [(what, False)]
    told = " ".join(told.split())
    assert f"the folder {folder} is gone: make it again" in told and "free some space" not in told


@pytest.mark.parametrize("way, cause", [("> /dev/full", "No space left on device"), *studies((">&-", "it is closed"))])
def test_where_lines_cannot_be_printed_the_twin_tells_it_once_goes_on_stores_all_and_ends_with_3(
    files, tmp_path, way, cause
):
    words = ["twin", "--json", "-q", files / "scene.yaml", "--map", files / "map.yaml", "--source", files / "rows.csv"]
    words += ["-o", tmp_path / "all.nc", "--state", tmp_path / "all.st"]
    command = " ".join([sys.executable, "-m", "crane.main", *map(str, words), way])
    found = subprocess.run(["bash", "-c", command], capture_output=True, text=True, timeout=120)
    assert found.returncode == 3 and found.stderr.count("standard output: cannot be written") == 1
    assert cause in found.stderr and "The twin goes on" in found.stderr and "ALARM heavy" in found.stderr
    result = Result.read(tmp_path / "all.nc")
    assert len(result["time"]) == ROWS and result.attributes["status"] == "done"
    assert sorted(one.name for one in tmp_path.iterdir()) == ["all.nc", "all.st"]


@pytest.mark.study
def test_a_twin_goes_on_where_neither_its_lines_nor_its_words_can_be_written(files, tmp_path):
    words = ["twin", "--json", files / "scene.yaml", "--map", files / "map.yaml", "--source", files / "rows.csv"]
    words += ["-o", tmp_path / "all.nc"]
    command = " ".join([sys.executable, "-m", "crane.main", *map(str, words), "> /dev/full 2>&1"])
    assert subprocess.run(["bash", "-c", command], timeout=120).returncode == 3
    assert len(Result.read(tmp_path / "all.nc")["time"]) == ROWS
