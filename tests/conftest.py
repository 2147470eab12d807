"""Makes the folders of tests importable, as `references.soft_string`, orders them, and has Ctrl-C heard by all."""

import signal
import sys
from functools import cache
from pathlib import Path

import pytest

TESTS = Path(__file__).parent
sys.path.insert(0, str(TESTS))

# A shell starts what runs in the background with Ctrl-C ignored, and its children with it; tests of Ctrl-C need it.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items):
    """Strings first, all else after them, and what is read but not run in the middle.

    With ``--dist worksteal`` two workers begin at the first test and at the middle one. They would otherwise compile
    the same at the same time: the loop over steps as they begin, and then the kinds of groups of one application.
    """
    read = [item for item in items if _is_read(item)]
    run = sorted((item for item in items if not _is_read(item)), key=lambda item: not _is_of_strings(item.path))
    middle = len(items) // 2
    items[:] = [*run[:middle], *read, *run[middle:]]


def _is_read(item):
    return item.path.parent == TESTS / "input"


@cache
def _is_of_strings(path):
    return "drillstring" in path.read_text(encoding="utf8")
