"""Makes folders of tests and `benchmarks` importable, as `references.soft_string`; orders them; Ctrl-C is heard."""

import gc
import os
import signal
import sys
from functools import cache
from pathlib import Path

import hypothesis
import pytest

# Workers have a core each. Linear algebra on all cores has its threads wait for one another there, and eigenvalues of
# a hose take many times as long. It is asked for before NumPy is loaded.
os.environ["OPENBLAS_NUM_THREADS"] = os.environ.get("OPENBLAS_NUM_THREADS", "1")

from tautline.kernels.machine.gc_tuning import RARELY

# How long an example takes on cores that others use too says nothing.
hypothesis.settings.register_profile(
    "shared cores", deadline=None, suppress_health_check=[hypothesis.HealthCheck.too_slow]
)
hypothesis.settings.load_profile("shared cores")

TESTS = Path(__file__).parent
sys.path[:0] = [str(TESTS), str(TESTS.parent)]

# Tests compile much of the time.
gc.set_threshold(*RARELY)

# A shell starts what runs in the background with Ctrl-C ignored, and its children with it; tests of Ctrl-C need it.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session", autouse=True)
def _no_helpers_beside_workers():
    """Where there is a worker for every core each compiles alone: a helper would have to start, and to take turns."""
    if int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1")) >= (os.cpu_count() or 1):
        from tautline.kernels import parallel_compile

        parallel_compile.HELPERS = 0


@pytest.fixture(scope="session", autouse=True)
def _patient_commands():
    """On shared cores a search takes longer than a person waits; what is told then would stand before its table."""
    from tautline.cli.output import preparing

    preparing.PATIENCE = 3600.0


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector):
    """Every second worker reads folders from their ends.

    Without Python's own files of them, pytest takes longer to rewrite the assertions of all tests than to import them,
    and each worker would do it for all. So they meet in the middle, and take the other's files from there on.
    """
    report = yield
    if _number_of_worker() % 2 and isinstance(collector, pytest.Dir):
        report.result.reverse()
    return report


def _number_of_worker():
    """Of xdist, from 0; 0 where there are no workers."""
    return int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))


NOT_RUN = ("references", "wellbore", "input", "figures", "view", "results", "layers")
"""Folders of tests that read, draw or integrate apart, and have next to nothing compiled; the last ones run a scene.

So do those of folders within them, which come behind the files beside them: the first of `input` to simulate the hoist
does so when the other worker has had it compiled, and not while it has the string's loop, which is the hoist's too."""
FIRST = (Path("physics") / "test_relaxation.py", Path("cli") / "test_set.py")
"""Have the loops over steps of ropes compiled, and a crane, which the second worker is the first to need.

They take ten seconds each. Strings have their own, and both workers would come to those of ropes at one time."""


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items):
    """Loops of ropes first, then strings, all else after them, and what compiles nothing in the middle.

    With ``--dist worksteal`` two workers begin at the first test and at the middle one. They would otherwise compile
    the same at the same time: the loop over steps as they begin, and then the kinds of groups of one application. So
    the second has some minutes of other work, in which the first compiles what both need.
    """
    items.sort(key=lambda item: item.path.parts)  # one order, from whichever end they were read
    apart = [item for item in items if _folder(item.path) in NOT_RUN]
    apart.sort(key=lambda item: (NOT_RUN.index(_folder(item.path)), len(item.path.parts)))
    run = [item for item in items if _folder(item.path) not in NOT_RUN]
    run.sort(key=lambda item: (_place(item.path), not _is_of_strings(item.path)))
    middle = len(items) // 2
    items[:] = [*run[:middle], *apart, *run[middle:]]


# There are thirty times as many tests as files.
@cache
def _folder(path):
    return path.relative_to(TESTS).parts[0]


@cache
def _place(path):
    place = path.relative_to(TESTS)
    return FIRST.index(place) if place in FIRST else len(FIRST)


@cache
def _is_of_strings(path):
    return "drillstring" in path.read_text(encoding="utf8")
