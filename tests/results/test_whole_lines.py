"""A table that grows row by row: no half row, nothing lost of what was there."""

import os
import resource

import pytest

from tautline.results.errors import WriteError
from tautline.results.tables.lines import WholeLines


def test_a_row_that_finds_no_room_is_taken_off_and_those_before_it_are_kept(tmp_path):
    path = tmp_path / "r.csv"
    pid = os.fork()
    if pid == 0:  # a limit of its own for the size of files, as a full disk has
        import signal

        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (105, 105))
        code = 1
        try:
            with WholeLines(path) as lines:
                try:
                    for _ in range(100):
                        lines.write(["1234", "5678"])
                except WriteError:
                    lines.keep()
                    code = 0
        finally:
            os._exit(code)
    assert os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]) == 0
    assert path.read_bytes() == b"1234,5678\r\n" * 9
    assert os.listdir(tmp_path) == ["r.csv"]


def test_an_earlier_file_stays_whole_until_the_rows_are_kept(tmp_path):
    path = tmp_path / "r.csv"
    path.write_text("before")
    with pytest.raises(KeyboardInterrupt), WholeLines(path) as lines:
        lines.write(["1"])
        raise KeyboardInterrupt
    assert path.read_text() == "before" and os.listdir(tmp_path) == ["r.csv"]
