"""What gets among lines on their way, such as names of files and NUL bytes, spoils no row, and is told.

What is right is what the rows were written from.
"""

import io
import sys

import pytest
from twin.sources.test_sources_of_data import all_of, written

from tautline.twin.sources.csv_file import CsvFile
from tautline.twin.sources.opening import open_source
from tautline.twin.sources.stream import Stream

HEADER = "time,winch,rope\n"
BOTH = ["winch", "rope"]


def file(tmp_path, text):
    return CsvFile(written(tmp_path / "r.csv", text), BOTH)


def stream(_, text):
    return Stream(io.StringIO(text), BOTH)


def read(source):
    return [(row.time, *row.values.values()) for row in all_of(source)]


@pytest.mark.parametrize("of", [file, stream])
def test_names_of_files_that_tail_writes_are_passed_over_before_the_header_and_behind_it_and_are_told_once(
    tmp_path, of
):
    # what `tail -n +1 -f a.csv b.csv` writes, and then a row that came to a.csv
    text = f"==> a.csv <==\n{HEADER}0,1,47\n1,2,48\n\n==> b.csv <==\n{HEADER}2,3,49\n\n==> a.csv <==\n3,4,50\n"
    source = of(tmp_path, text)
    assert read(source) == [(0, 1, 47), (1, 2, 48), (2, 3, 49), (3, 4, 50)]
    (note,) = source.notes
    assert ":1: lines such as '==> a.csv <==', by which `tail` names files, are passed over" in note
    assert source.refused == 0


def test_a_row_that_only_begins_as_a_name_of_a_file_counts_as_a_line_that_cannot_be_read():
    source = stream(None, f"{HEADER}0,1,47\n==> 1,2,48\n1,2,48\n")
    assert [row[0] for row in read(source) if row[0] == row[0]] == [0, 1] and not source.notes


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize("cell", ["\0\0\0", "4\0", "\0" + "4", "4\0" + "8"])
def test_a_cell_with_nul_bytes_in_the_midst_of_a_row_is_missing_and_that_is_told_once_with_its_line(tmp_path, of, cell):
    source = of(tmp_path, f"{HEADER}0,1,47\n1,{cell},48\n2,{cell},49\n3,4,50\n")
    rows = read(source)
    assert [(row[0], row[2]) for row in rows] == [(0, 47), (1, 48), (2, 49), (3, 50)]
    assert [row[1] == row[1] for row in rows] == [True, False, False, True]
    (note,) = source.notes
    assert ":3: there are NUL bytes in the line" in note and "Cells with such bytes count as missing" in note


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_lines_of_standard_input_may_end_as_those_of_a_file_may(tmp_path, monkeypatch, end):
    text = f"{HEADER}0,1,47\n1,2,48\n".replace("\n", end).encode()
    (tmp_path / "r.csv").write_bytes(text)
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(text), encoding="utf-8", newline="\n"))
    for address in ("-", str(tmp_path / "r.csv")):
        source = open_source(address, BOTH)
        assert read(source) == [(0, 1, 47), (1, 2, 48)] and not source.notes
