"""A named pipe is read while it is written, as standard input is, and not as a file that is replayed."""

import os
import threading

from tautline.twin.sources.opening import open_source


def test_each_row_of_a_named_pipe_comes_at_once_and_waits_for_none_behind_it(tmp_path):
    path, more = tmp_path / "pipe", threading.Event()
    os.mkfifo(path)

    def write():
        with path.open("w") as file:
            file.write("time,a\n0,1\n1,2\n")
            file.flush()
            more.wait(10.0)
            file.write("2,3\n")

    writer = threading.Thread(target=write)
    writer.start()
    source = open_source(str(path), ["a"])
    assert source.live and not source.again
    assert [source.poll(5.0).values["a"] for _ in range(2)] == [1, 2]
    assert source.poll(0.05) is None and not source.ended
    more.set()
    assert source.poll(5.0).values["a"] == 3
    writer.join(5.0)
