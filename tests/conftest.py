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
    """Strings first, then what is read and not run, then all else: two workers compile different kernels.

    With ``--dist worksteal`` they begin at the first test and at the middle one. Both would otherwise compile the same
    at the same time: the loop over steps as they begin, and then the kinds of groups of one application.
    """
    items.sort(key=lambda item: _turn(item.path))


@cache
def _turn(path):
    if "drillstring" in path.read_text(encoding="utf8"):
        return 0
    return 1 if path.parent == TESTS / "input" else 2
