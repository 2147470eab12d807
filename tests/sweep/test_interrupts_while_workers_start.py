"""Ctrl-C while workers start counts when they have: neither they nor a cluster half begun end with a traceback."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from tautline.sweeps.workers import _interrupted_later

pytestmark = pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="signals are not blocked here")
HEARS = "import signal; print(signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, []))"


def hears_interrupts():
    """Whether a process that this thread begins hears Ctrl-C."""
    return subprocess.run([sys.executable, "-S", "-c", HEARS], capture_output=True, text=True).stdout.strip() == "True"


def test_an_interrupt_while_workers_start_counts_when_they_have():
    handler, begun = signal.getsignal(signal.SIGINT), []
    with pytest.raises(KeyboardInterrupt), _interrupted_later():
        os.kill(os.getpid(), signal.SIGINT)
        begun.append(True)
    assert begun == [True]
    assert signal.getsignal(signal.SIGINT) is handler
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, [])


def test_an_interrupt_counts_where_the_workers_could_not_be_started() -> None:
    with pytest.raises(KeyboardInterrupt), _interrupted_later():
        signal.raise_signal(signal.SIGINT)
        raise OSError("no port is left")


def test_workers_do_not_hear_the_interrupt_that_a_terminal_sends_to_all():
    assert hears_interrupts()
    with _interrupted_later(), ThreadPoolExecutor(1) as started:
        assert not started.submit(hears_interrupts).result()
    assert hears_interrupts()


@pytest.fixture
def handled_by():
    """Gives SIGINT another handler for a test."""
    before = signal.getsignal(signal.SIGINT)
    yield lambda handler: signal.signal(signal.SIGINT, handler)
    signal.signal(signal.SIGINT, before)


def test_where_interrupts_are_ignored_one_while_workers_start_ends_nothing(handled_by):
    """A shell has what it runs in the background ignore them."""
    handled_by(signal.SIG_IGN)
    with _interrupted_later():
        os.kill(os.getpid(), signal.SIGINT)
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN


def test_a_handler_of_the_caller_hears_the_interrupt_once_workers_have_started(handled_by):
    heard = []
    handled_by(lambda number, frame: heard.append(number))
    with _interrupted_later():
        os.kill(os.getpid(), signal.SIGINT)
        assert heard == []
    # Another thread may have taken the signal: this one hears of it a little later.
    for _ in range(200):
        if heard:
            break
        time.sleep(0.01)
    assert heard == [signal.SIGINT]


def test_a_handler_that_python_did_not_install_is_left_alone(monkeypatch):
    """As where a program in C has Python within it: Python could not put its handler back."""
    replaced = []
    monkeypatch.setattr(signal, "getsignal", lambda number: None)
    monkeypatch.setattr(signal, "signal", lambda *of: replaced.append(of))
    with _interrupted_later():
        pass
    assert replaced == []
