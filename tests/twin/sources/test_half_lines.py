"""A last line without a line end: its last cell may be half of one, and counts as missing."""

import io

import pytest
from cli.in_process import commands_of
from twin.sources.test_sources_of_data import all_of, written

from crane.application import Crane
from tautline.results.result import Result
from tautline.twin.sources.csv_file import CsvFile
from tautline.twin.sources.stream import Stream

TEXT = "time,winch,rope\n0,1,47.5\n1,1,4"


def file(tmp_path, text):
    return CsvFile(written(tmp_path / "r.csv", text), ["winch", "rope"])


def stream(_, text):
    return Stream(io.StringIO(text), ["winch", "rope"])


@pytest.mark.parametrize("of", [file, stream])
def test_the_last_cell_of_a_line_without_a_line_end_is_missing_and_the_row_is_given(tmp_path, of):
    rows = all_of(of(tmp_path, TEXT))
    assert [row.whole for row in rows] == [True, False]
    assert rows[1].values["winch"] == 1.0 and rows[1].values["rope"] != rows[1].values["rope"]


@pytest.mark.parametrize("of", [file, stream])
def test_a_line_that_has_its_end_loses_no_cell(tmp_path, of):
    rows = all_of(of(tmp_path, TEXT + "\n"))
    assert rows[1].whole and rows[1].values["rope"] == 4.0


def test_an_object_without_a_line_end_is_whole():
    (row,) = all_of(Stream(io.StringIO('{"time": 0, "rope": 4}'), ["rope"]))
    assert row.whole and row.values["rope"] == 4.0


def test_the_row_of_a_half_line_is_answered_anew_when_the_file_has_grown(tmp_path, capsys):
    here = commands_of(Crane(), capsys)
    (tmp_path / "map.yaml").write_text(
        "sensors:\n  - {column: winch, unit: m, input: winch.pay_out}\n"
        "  - {column: rope, unit: kN, output: winch.tension}\n"
    )
    rows = [f"{0.1 * k:.1f},0,{47.5 + 0.01 * k:.2f}\n" for k in range(12)]
    words = ["--map", tmp_path / "map.yaml", "--source", tmp_path / "r.csv", "--resume", tmp_path / "st"]
    for text in ("".join(rows[:8])[:-4], "".join(rows)):
        written(tmp_path / "r.csv", "time,winch,rope\n" + text)
        code, _, told = here("twin", "data/hoist.yaml", *words, "-o", tmp_path / "tw.nc")
        assert code == 0
        assert ("has no line end" in told) == (len(text) < 8 * len(rows[0]))
    result = Result.read(tmp_path / "tw.nc")
    assert list(result["time"]) == pytest.approx([0.1 * k for k in range(12)])
    assert list(result["measured winch.tension"] / 1e3) == pytest.approx([47.5 + 0.01 * k for k in range(12)])
