"""A file that grew after its twin was stopped: what is said of it in the end is what one twin says that was not."""

import io
import json

import numpy as np
import pytest
from cli.in_process import commands_of

from crane.application import Crane
from tautline.cli.commands.twin import _Loop
from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.twin import storage

MAP = """
sensors:
  - {column: winch_pos, unit: m, input: winch.pay_out}
  - {column: heave, unit: m, input: vessel.heave}
  - {column: rope_tension, unit: kN, output: winch.tension, sd: 0.5 kN}
estimate:
  - {parameter: payload.mass, start: 7 t, sd: 2 t, range: [0.5 t, 20 t]}
ahead: 0 s
"""
CUTS = {"within a ramp of the winch": 22, "before any row was answered": 2}
"""Rows of the file when the twin ends for the first time."""


@pytest.fixture(scope="module")
def rows():
    """Lines of a file with a header: a winch that sets off after a second, at 10 Hz."""
    names = ("winch_pos", "heave", "rope_tension")
    found = ["time," + ",".join(names) + "\n"]
    for k in range(41):
        t = 0.1 * k
        ramp = max(0.0, t - 1.0)
        pay_out = -0.25 * ramp**2
        found.append(f"{t:.1f},{pay_out:.6f},{0.1 * np.sin(t):.6f},{49.05 + 2.0 * np.sin(5.0 * t):.4f}\n")
    return found


@pytest.fixture
def twin(tmp_path, capsys):
    """The command on the first lines of the file, as JSON by time; where told so, gone on with."""
    command = commands_of(Crane(), capsys)
    (tmp_path / "map.yaml").write_text(MAP)

    def run(lines, *more):
        (tmp_path / "r.csv").write_text("".join(lines))
        words = ["twin", "data/hoist.yaml", "--map", tmp_path / "map.yaml", "--source", tmp_path / "r.csv", "--json"]
        code, out, told = command(*words, *more)
        assert code == 0, told
        read = [json.loads(line) for line in out.splitlines()]
        lines = {line["time"]: line | {"lag": 0.0} for line in read if "estimates" in line}
        assert len(lines) == sum("estimates" in line for line in read)
        return lines, told

    return run


@pytest.fixture(scope="module")
def made_once():
    return {}


@pytest.fixture
def whole(twin, rows, made_once, tmp_path_factory):
    """Lines and result of a twin that was given the whole file at once; it is made for the first who asks."""
    if not made_once:
        path = tmp_path_factory.mktemp("whole") / "whole.nc"
        lines, _ = twin(rows, "-o", path)
        made_once.update(lines=lines, result=Result.read(path))
    return made_once["lines"], made_once["result"]


@pytest.mark.parametrize("cut", CUTS.values(), ids=CUTS)
def test_a_twin_that_goes_on_in_a_file_that_grew_says_to_the_digit_what_one_says_that_was_not_stopped(
    twin, rows, whole, tmp_path, cut
):
    lines, once = whole
    goes_on = ("--resume", tmp_path / "st", "-o", tmp_path / "parts.nc")
    first, _ = twin(rows[: 1 + cut], *goes_on)
    rest, told = twin(rows, *goes_on)
    assert len(first) == cut and first.keys() & rest.keys(), "the last rows are answered anew"
    assert "answered at the end of the source, and are answered anew where rows follow" in " ".join(told.split())
    answered = {time: line for time, line in first.items() if time < min(rest)}
    assert answered | rest == lines
    parts = Result.read(tmp_path / "parts.nc")
    for name in set(once.variables) - {"lag"}:
        assert np.array_equal(parts[name], once[name], equal_nan=once[name].dtype.kind == "f"), name


def test_where_no_row_is_new_nothing_is_answered_again_and_no_file_changes(twin, rows, whole, tmp_path):
    goes_on, cut = ("--resume", tmp_path / "st", "-o", tmp_path / "parts.nc"), 22
    twin(rows[: 1 + cut], *goes_on)
    before = Result.read(tmp_path / "parts.nc")
    for _ in range(2):
        again, told = twin(rows[: 1 + cut], *goes_on)
        assert not again and "nothing is new: 22 rows not after 2.1 s" in " ".join(told.split())
        assert "rows not processed" not in told and "ALARM" not in told
        after = Result.read(tmp_path / "parts.nc")
        assert np.array_equal(after.time, before.time) and after.attributes["status"] == "done"
    lines, once = whole
    rest, _ = twin(rows, *goes_on)
    assert rest == {time: line for time, line in lines.items() if time >= min(rest)}
    assert np.array_equal(Result.read(tmp_path / "parts.nc").time, once.time)


def test_a_result_that_is_missing_is_said_not_to_be_written_where_no_row_is_new(twin, rows, tmp_path):
    result = tmp_path / "parts.nc"
    goes_on = ("--resume", tmp_path / "st", "-o", result)
    _, told = twin(rows[:23], *goes_on)
    assert "not written" not in told
    result.unlink()
    _, told = twin(rows[:23], *goes_on)
    words = " ".join(told.split())
    assert words.count("parts.nc is not written: no row was answered") == 1 and not result.exists()
    assert "nothing is new: 22 rows not after 2.1 s" in words


def test_rows_that_a_file_has_lost_are_not_counted_as_rows_that_are_not_new(twin, rows, tmp_path):
    """Of 22 rows the last wait for others: they are answered at the end of the file, and are gone from it then."""
    twin(rows[:23], "--resume", tmp_path / "st")
    _, told = twin(rows[:11], "--resume", tmp_path / "st")
    assert "nothing is new: 10 rows not after 2.1 s" in " ".join(told.split())


def test_a_pipe_that_gives_no_row_answers_none_of_those_that_were_answered_at_its_end(
    rows, tmp_path, monkeypatch, capsys
):
    command = commands_of(Crane(), capsys)
    (tmp_path / "map.yaml").write_text(MAP)

    def piped(lines):
        monkeypatch.setattr("sys.stdin", io.StringIO("".join(lines)))
        words = ["twin", "data/hoist.yaml", "--map", tmp_path / "map.yaml", "--source", "-", "--json"]
        _, out, _ = command(*words, "--resume", tmp_path / "st")
        return [json.loads(line)["time"] for line in out.splitlines()]

    assert len(piped(rows[:21])) == 20
    assert piped(rows[:1]) == []
    more = piped([rows[0], *rows[21:31]])
    assert more[0] < 2.0 < more[-1] and np.allclose(np.diff(more), 0.1)


def test_a_state_that_could_not_be_written_before_the_end_is_written_later_as_it_was_then(
    twin, rows, tmp_path, monkeypatch
):
    (tmp_path / "good").mkdir()
    twin(rows[:23], "--resume", tmp_path / "good" / "st")
    wanted = np.load(tmp_path / "good" / "st")
    kept, tried = _Loop._save_before_end, []
    real = storage.write

    def fails(state, path):
        if tried and tried[-1] == "end":
            tried.append("failed")
            raise ResultError(path, "the disk is full", "free some space")
        real(state, path)

    def at_end(self):
        tried.append("end")
        kept(self)

    monkeypatch.setattr(storage, "write", fails)
    monkeypatch.setattr(_Loop, "_save_before_end", at_end)
    _, told = twin(rows[:23], "--resume", tmp_path / "st")
    assert tried == ["end", "failed"] and "the state is saved again" in " ".join(told.split())
    found = np.load(tmp_path / "st")
    assert all(
        np.array_equal(found[name], wanted[name], equal_nan=True)
        for name in ("mean", "covariance", "sample_time", "sample_y")
    )
    now, then = (json.loads(one["words"].tobytes()) for one in (found, wanted))
    assert now["now"] == then["now"] < 2.1 and now["heard"] == then["heard"]
