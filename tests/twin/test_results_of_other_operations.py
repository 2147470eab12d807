"""An operation is gone on with in its own result only: what another one has found is not lost and not spliced."""

import shutil

import numpy as np
import pytest
from cli.in_process import commands_of
from twin.rehearsal import STILL

from crane.application import Crane
from tautline.results.result import Result
from tautline.results.store import Store
from tautline.twin import storage
from tautline.twin.series import Series

MAP = """
sensors:
  - {column: winch_pos, unit: m, input: winch.pay_out}
  - {column: rope_tension, unit: kN, output: winch.tension, sd: 0.5 kN}
ahead: 0 s
delay: 0 s
"""
"""Without a delay no row waits for those behind it: a result has ended where its state has."""


@pytest.fixture
def twin(tmp_path, capsys):
    """The command on rows from and to a time, s: exit code and what is told."""
    (tmp_path / "map.yaml").write_text(MAP)
    (tmp_path / "s.yaml").write_text(STILL)
    command = commands_of(Crane(), capsys)

    def run(begin, end, *more):
        times = np.arange(begin, end, 0.5)
        (tmp_path / "r.csv").write_text("time,winch_pos,rope_tension\n" + "".join(f"{t:g},0,49\n" for t in times))
        words = ["twin", tmp_path / "s.yaml", "--map", tmp_path / "map.yaml", "--source", tmp_path / "r.csv"]
        code, _, told = command(*words, *more)
        return code, told

    return run


def test_the_result_of_another_operation_is_refused_and_stays_as_it_was(twin, tmp_path):
    """Other rows, another load, another map: of the same application, with the same names."""
    state = tmp_path / "s.st"
    assert twin(0, 4, "--state", state, "-o", tmp_path / "own.nc")[0] == 0
    assert twin(1000, 1004, "-o", tmp_path / "later.nc")[0] == 0
    assert twin(0, 6, "--set", "bodies[0].mass=3 t", "-o", tmp_path / "other.nc")[0] == 0
    for name in ("later", "other"):
        path = tmp_path / f"{name}.nc"
        before, kept = path.read_bytes(), state.read_bytes()
        code, told = twin(4, 6, "--resume", state, "-o", path)
        assert code == 2 and "is the result of another operation" in told and "name another file with -o" in told
        assert path.read_bytes() == before and state.read_bytes() == kept
    code, told = twin(4, 6, "--resume", state, "-o", tmp_path / "own.nc")
    assert code == 0, told
    assert Result.read(tmp_path / "own.nc")["time"] == pytest.approx(np.arange(0.0, 6.0, 0.5))


def test_a_result_that_was_begun_later_in_the_operation_is_gone_on_with(twin, tmp_path):
    state, path = tmp_path / "s.st", tmp_path / "own.nc"
    assert twin(0, 4, "--state", state)[0] == 0
    for begin, end in ((4, 6), (6, 8)):
        code, told = twin(begin, end, "--resume", state, "--state", state, "-o", path)
        assert code == 0, told
    assert Result.read(path)["time"] == pytest.approx(np.arange(4.0, 8.0, 0.5))


def test_an_operation_that_begins_as_its_state_is_not_there_replaces_no_result(twin, tmp_path):
    """`--resume` begins anew where there is no state yet, and also where it was lost or named wrongly."""
    path = tmp_path / "own.nc"
    assert twin(0, 4, "--resume", tmp_path / "s.st", "-o", path)[0] == 0
    code, told = twin(4, 6, "--resume", tmp_path / "mistyped.st", "-o", path)
    assert code == 2 and f"{tmp_path / 'mistyped.st'} is not there, the state that --resume would go on from" in told
    assert "put the state back, name another file with -o, or replace it with --force" in told
    assert len(Result.read(path)["time"]) == 8
    assert twin(4, 6, "--resume", tmp_path / "new.st", "-o", path, "--force")[0] == 0


def test_what_a_result_has_more_than_the_map_asks_for_is_not_dropped(twin, tmp_path):
    state, path = tmp_path / "s.st", tmp_path / "own.nc"
    (tmp_path / "map.yaml").write_text(MAP + "keep: [payload.position]\n")
    assert twin(0, 4, "--state", state, "-o", path)[0] == 0
    (tmp_path / "map.yaml").write_text(MAP)
    code, told = twin(4, 6, "--resume", state, "-o", path)
    assert code == 2 and "holds payload.position, which this map does not ask for" in told
    assert "payload.position" in Result.read(path).variables


ALARMED = MAP + "watch:\n  - {output: winch.tension, above: 10 kN, name: %s}\n"


def test_what_was_stored_of_an_alarm_stays_when_it_is_renamed_taken_out_and_put_back(twin, tmp_path):
    state, path = tmp_path / "s.st", tmp_path / "own.nc"
    maps = (ALARMED % "heavy", ALARMED % "loaded", MAP, ALARMED % "heavy")
    states = {}
    for k, text in enumerate(maps):
        (tmp_path / "map.yaml").write_text(text)
        begun = ("--resume", state) if k else ()
        code, told = twin(4 * k, 4 * k + 4, *begun, "--state", state, "-o", path)
        assert code == 0, told
        result = Result.read(path)
        names = [str(name) for name in result["alarm"]]
        assert len(set(names)) == len(names)
        rows = np.asarray(result["alarm_state"]).reshape(-1, len(names))
        kept = {name: list(rows[:, names.index(name)]) for name in ("heavy", "loaded") if name in names}
        for name, before in states.items():
            assert kept[name][: len(before)] == before, f"{name} after {text}"
        states = kept
    time = np.asarray(result["time"])
    heavy, loaded = (np.array(states[name]) for name in ("heavy", "loaded"))
    assert np.array_equal(heavy >= 0, (time < 4.0) | (time >= 12.0))
    assert np.array_equal(loaded >= 0, (time >= 4.0) & (time < 8.0))
    assert (heavy[time < 4.0] > 0).any() and (loaded > 0).any() and (heavy[time >= 12.0] > 0).any()
    upper, _ = result.plot.alarms().axes
    assert {"heavy", "loaded"} <= {text.get_text() for text in upper.get_yticklabels()}


def test_the_first_lines_are_in_the_result_with_the_first_state_and_not_later(twin, tmp_path, monkeypatch):
    """What goes on from a state does not give the lines before it again."""
    stored, flush, write = [], Series.flush, storage.write
    monkeypatch.setattr(Series, "flush", lambda series: stored.append("result") or flush(series))
    monkeypatch.setattr(storage, "write", lambda *given: stored.append("state") or write(*given))
    assert twin(0, 4, "--resume", tmp_path / "own.st", "-o", tmp_path / "own.nc")[0] == 0
    assert stored[:3] == ["state", "result", "state"] and stored.count("result") > 1


def test_a_twin_that_is_killed_as_soon_as_it_has_a_result_goes_on_from_the_state_beside_it(twin, tmp_path, monkeypatch):
    """What a kill leaves is what the files are at that moment."""
    (left := tmp_path / "left").mkdir()
    write = Store.append

    def written(store, frames):
        write(store, frames)
        if not (left / "own.nc").exists():
            for one in tmp_path.glob("own.*"):
                shutil.copy(one, left)

    monkeypatch.setattr(Store, "append", written)
    assert twin(0, 4, "--resume", tmp_path / "own.st", "-o", tmp_path / "own.nc")[0] == 0
    code, told = twin(0, 6, "--resume", left / "own.st", "-o", left / "own.nc")
    assert code == 0, told
    assert Result.read(left / "own.nc")["time"] == pytest.approx(np.arange(0.0, 6.0, 0.5))
