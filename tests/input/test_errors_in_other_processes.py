"""Every error of the package goes to another process whole: a pool of processes ends, or hangs, where one does not."""

import importlib
import inspect
import pickle
import pkgutil
from multiprocessing import get_context

import pytest
from of_the_suite import studies

import crane
import drillstring
import gardenhose
import tautline
from drillstring.statics.form import NotAtRest
from tautline.errors import TautlineError
from tautline.integrators.status import Interrupted, Status, StoppedEarly
from tautline.results.result import Result
from tautline.scene.errors import Problem, SceneError
from tautline.scene.reading.document import PartlyReplacedError
from tautline.twin.sources.record import NewHeader
from tautline.view.figures.comparison import NothingToShow

STOP = StoppedEarly(Status.TWO_BLOCKED, 1.5, "block: turns", "at 3 m")
FAULT = Problem("a.yaml", 3, "rope.length", "-1 m", "must be positive", "give a length")
GIVEN = {
    StoppedEarly: (Status.TWO_BLOCKED, 1.5, "block: turns", "at 3 m"),
    NotAtRest: (StoppedEarly(Status.NO_EQUILIBRIUM, 0.0, "string"), 40, "by steps"),
    NothingToShow: (Result(None, ([], {}, {}, {}, {})), "no tension"),
    PartlyReplacedError: ([FAULT], None),
    NewHeader: (SceneError([FAULT]),),
}
"""What an error is made of where texts will not do; of those derived from one with problems, see `_made`."""


def _every() -> list[type[TautlineError]]:
    for package in (tautline, crane, drillstring, gardenhose):
        for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            if not module.name.endswith("__main__"):
                importlib.import_module(module.name)
    found, left = [], [TautlineError]
    while left:
        found.append(left.pop())
        left += found[-1].__subclasses__()
    ours = ("tautline", "crane", "drillstring", "gardenhose")
    return sorted({one for one in found if one.__module__.partition(".")[0] in ours}, key=lambda one: one.__qualname__)


def _made(kind: type[TautlineError]) -> TautlineError:
    if kind in GIVEN:
        return kind(*GIVEN[kind])
    if issubclass(kind, SceneError):
        return kind([FAULT])
    try:
        taken = inspect.signature(kind.__init__).parameters.values()
    except ValueError:
        taken = ()
    numbers = {"float": 1.5, "float | None": 1.5, "int | None": 3}
    given = [numbers.get(str(one.annotation), one.name) for one in taken if one.kind == one.POSITIONAL_OR_KEYWORD]
    return kind(*given[1:]) if len(given) > 1 else kind("a sentence")


def _told(error: TautlineError) -> dict[str, str]:
    return {name: repr(value) for name, value in vars(error).items() if not isinstance(value, (Result, BaseException))}


@pytest.fixture(scope="module")
def every():
    found = _every()
    assert len(found) > 25
    return found


def test_every_error_is_the_same_where_it_was_pickled(every):
    for kind in every:
        error = _made(kind)
        error.add_note("noted by the caller")
        for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
            again = pickle.loads(pickle.dumps(error, protocol))
            assert type(again) is kind
            assert str(again) == str(error), kind
            assert _told(again) == _told(error), kind
            assert vars(again).keys() == vars(error).keys(), kind


def _raise(error: TautlineError):
    raise error


@pytest.mark.parametrize("error", [STOP, *studies(Interrupted(2.5))], ids=lambda one: type(one).__name__)
def test_a_run_that_stops_in_a_worker_of_a_pool_is_told_to_who_waits(error):
    with get_context("spawn").Pool(1) as pool:
        with pytest.raises(type(error)) as told:
            pool.map_async(_raise, [error]).get(timeout=30.0)
    assert str(told.value) == str(error) and told.value.time == error.time


def test_a_copy_of_an_error_has_what_it_holds():
    import copy

    again = copy.copy(STOP)
    assert (again.status, again.time, again.part, again.line) == (STOP.status, STOP.time, STOP.part, STOP.line)
