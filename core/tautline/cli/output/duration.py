"""How long a command has taken: the person who waits counts from its start, imports and files included."""

from __future__ import annotations

import os
import time
from pathlib import Path

STAT = Path("/proc/self/stat")
AFTER_NAME, STARTED = ")", 19
"""What ends the name of the program in that file, and the field after it that says when the process started."""

_began = time.perf_counter()


def begin(of_process: bool) -> None:
    """Take the start of the process, or this moment, as the start of the command."""
    global _began
    _began = time.perf_counter() - (_age_of_process() if of_process else 0.0)


def total_time() -> float:
    """Time since the start of the command, s."""
    return time.perf_counter() - _began


def _age_of_process() -> float:
    """Time since the process started, s, to a hundredth; where no system tells, since this file was imported.

    A shell may become the command at the end of a script, and the process is then as old as the script. It has had
    other commands before, and we have not: what counts is the processor time that brought us here.
    """
    if _had_children():
        return time.process_time()
    try:
        ticks = int(STAT.read_text().rpartition(AFTER_NAME)[2].split()[STARTED])
        age = time.clock_gettime(time.CLOCK_BOOTTIME) - ticks / os.sysconf("SC_CLK_TCK")
    except (OSError, ValueError, IndexError, AttributeError):
        return total_time()
    return age if age > 0.0 else total_time()


def _had_children() -> bool:
    """Whether the process has waited for another to end."""
    try:
        from resource import RUSAGE_CHILDREN, getrusage
    except ImportError:  # Windows, where a process does not become another program
        return False
    return getrusage(RUSAGE_CHILDREN).ru_maxrss > 0
