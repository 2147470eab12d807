"""Processes that begin with all that this one has loaded: to load NumPy, h5py and kernels takes longer than their work.

Such a process is as much of its own as a new one: it has its own number, memory and files, takes signals by itself, and
can be killed. That a new one does the same is shown by those tests that start one.
"""

import io
import os
import sys
import tempfile
import time
import traceback


class Forked:
    """A process that calls ``run``: its standard output is a pipe, and what it says of errors is kept in a file."""

    def __init__(self, run, *arguments):
        self.returncode = None
        out, into = os.pipe()
        self.errors = tempfile.TemporaryFile("w+", encoding="utf8")
        self.pid = os.fork()
        if self.pid == 0:
            os.close(out)
            self._be(run, arguments, into)
        os.close(into)
        self.stdout = os.fdopen(out, encoding="utf8")

    def _be(self, run, arguments, into):
        """What the new process does; it never comes back to the tests."""
        code = 1
        try:
            sys.stdout = io.TextIOWrapper(io.FileIO(into, "w"), encoding="utf8", write_through=True)
            sys.stderr = self.errors
            run(*arguments)
            code = 0
        except SystemExit as left:
            code = int(left.code or 0)
        except BaseException:
            traceback.print_exc()
        finally:
            self.errors.flush()
            os._exit(code)

    def poll(self):
        """The exit code, minus the number of a signal, or None while it runs."""
        if self.returncode is None:
            number, status = os.waitpid(self.pid, os.WNOHANG)
            self.returncode = os.waitstatus_to_exitcode(status) if number else None
        return self.returncode

    def wait(self, timeout=100.0):
        deadline = time.monotonic() + timeout
        while self.poll() is None:
            assert time.monotonic() < deadline, "the process does not end"
            time.sleep(0.002)
        return self.returncode

    def send_signal(self, number):
        if self.poll() is None:
            os.kill(self.pid, number)

    def kill(self):
        self.send_signal(9)

    def communicate(self):
        """Let it end; what is left of its output, and its errors."""
        out = self.stdout.read()
        self.stdout.close()
        self.wait()
        self.errors.seek(0)
        return out, self.errors.read()
