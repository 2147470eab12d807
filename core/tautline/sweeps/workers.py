"""Who runs the cases: this thread, several threads, or the processes of a Dask cluster.

The compiled loop leaves the interpreter to others, so threads share the cores as well as processes do, as long as most
of a case is its loop. What is left, building and reading out, is done by one thread at a time; where that is much, or a
verb has no loop at all, processes are worth their start.
"""

from __future__ import annotations

import logging
import multiprocessing
import pickle
import signal
import sys
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, ThreadPoolExecutor, wait
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple

from tautline.errors import TautlineError
from tautline.processes import without_current_folder
from tautline.results.tables.finding import Finding
from tautline.scene.errors import Problem, SceneError, option_error
from tautline.sweeps.cases import LOST, Job, OtherProgram, Row, Runner, program
from tautline.sweeps.inputs import InputChanged

THREADED = 1.0
"""Share of the time that threads may together spend outside of compiled loops. One of them is there at a time: beyond 1
the others would wait. It is measured on one case, so a bound below that is passed by noise."""
START = 10.0
"""Run time, s, of each worker from which processes are worth starting."""
PIECE = 0.25
"""Run time, s, of the cases that a process of a cluster is given at a time."""
MOST = 50
"""Cases in a piece."""
AHEAD = 3
"""Pieces that wait at each worker."""
LOCAL = "local"
"""In place of the address of a scheduler: a cluster on this machine."""
TALKERS = tuple(f"distributed.{one}" for one in ("batched", "client", "comm", "comm.core", "comm.tcp"))
"""Loggers of Dask that tell how a scheduler is lost."""
WORKER = "Dask Worker process"
"""How the names of the processes of a cluster begin."""
SILENT = logging.CRITICAL + 1
"""Level at which a logger says nothing."""
PATIENCE = 10.0
"""Time, s, in which a scheduler has to answer."""

Found = tuple[Row, Mapping[str, Finding]]
Todo = Iterable[tuple[int, Mapping[str, Any]]]
Piece = list[tuple[int, Mapping[str, Any]]]
"""Cases, with what is changed in the scene for each, that a worker is given together."""


class NoWorkers(SceneError):
    """Processes on this machine that could not be started."""


class SchedulerLost(TautlineError):
    """A scheduler that has ended with cases to run."""


class Measured(NamedTuple):
    """Run time of a case, s, and the share of it outside of its compiled loop."""

    wall: float
    beside: float


def how(jobs: int, cases: int, one: Measured) -> str:
    """``here``, ``threads`` or ``processes``, whichever is quickest for so many cases."""
    if jobs == 1 or cases <= 1:
        return "here"
    if one.beside * jobs <= THREADED or one.wall * cases / jobs < START or not _installed():
        return "threads"
    return "processes"


def _installed() -> bool:
    from importlib.util import find_spec

    return find_spec("distributed") is not None


def in_this_thread(runner: Runner, todo: Todo) -> Iterator[Found]:
    """Run cases one after another."""
    for case, changes in todo:
        yield runner.run(case, changes)


def in_threads(runner: Runner, todo: Todo, jobs: int) -> Iterator[Found]:
    """Run cases on several threads; those that wait are few, however many there are."""
    remaining = iter(todo)
    runner.share()
    pool = ThreadPoolExecutor(jobs)
    waiting: set[Future[Found]] = set()
    try:
        while True:
            for case, changes in islice(remaining, 2 * jobs - len(waiting)):
                waiting.add(pool.submit(runner.run, case, changes))
            if not waiting:
                return
            done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
            for one in done:
                yield one.result()
    except BaseException:
        # Runs under way end at their next look at the clock.
        runner.cancelled = True
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def in_cluster(
    job: Job, todo: Todo, jobs: int, address: str, one: Measured, announce: Callable[[str], None] | None = None
) -> Iterator[Found]:
    """Run cases in the processes of a Dask cluster.

    A piece of which the worker dies is run by another. One that has ended several workers is cut into its cases; a
    case that does so by itself is given up, with the status ``worker lost``.

    Parameters
    ----------
    address : str
        Of a scheduler, or ``local`` for a cluster of `jobs` processes on this machine.

    Raises
    ------
    SceneError
        Where no scheduler answers, and where its workers cannot run the cases.
    SchedulerLost
        Where it answers no more.
    """
    from distributed import KilledWorker, as_completed

    packed, run_piece = pickle.dumps(job), _of_any_worker()
    size = max(1, min(MOST, round(PIECE / max(one.wall, 1e-3))))
    remaining = iter(todo)
    with _client(address, jobs) as client:
        if announce is not None:
            there = sum(client.nthreads().values())
            workers = f"{there} worker" + ("" if there == 1 else "s")
            announce(workers if there else "the scheduler has no workers yet: cases wait until one comes")
        pending = as_completed(loop=client.loop)
        given: dict[str, Piece] = {}

        def hand_over(piece: Piece) -> None:
            future = client.submit(run_piece, program(), packed, piece, pure=False)
            given[future.key] = piece
            pending.add(future)

        def submit() -> None:
            room = AHEAD * _count(client, jobs) - len(given)
            for _ in range(room):
                piece = list(islice(remaining, size))
                if not piece:
                    return
                hand_over(piece)

        submit()
        while given:
            future = next(pending)
            piece = given.pop(future.key)
            error, found = _end_of(future, address)
            if len(piece) > 1 and isinstance(error, KilledWorker):
                # One of its cases ends workers, and the others are not to blame.
                for single in piece:
                    hand_over([single])
            else:
                yield from found if error is None else _lost(error, [case for case, _ in piece], address)
            future.release()
            submit()


def _of_any_worker() -> Callable[..., Any]:
    """What runs a piece, as a function that goes to workers by its code and not by its name.

    A worker without Tautline, or with one that has no `run_piece`, would end by a name that it has not, and the cases
    wait for ever. So it says what it lacks.
    """

    def run(of_sweep: tuple[str, str], packed: bytes, piece: Piece) -> Any:
        from tautline.sweeps import cases
        from tautline.version import __version__

        if not hasattr(cases, "run_piece"):
            of_worker = f"a worker has an older Tautline, {__version__}"
            raise ImportError(f"{of_worker}, and the sweep is run with {of_sweep[0]}")
        return cases.run_piece(of_sweep, packed, piece)

    run.__annotations__ = {}
    return run


def _end_of(future: Any, address: str) -> tuple[Any, list[Found]]:
    """What went wrong with a piece, None if nothing, and what came of it."""
    try:
        error = future.exception()
        return error, future.result() if error is None else []
    except (CancelledError, OSError):
        raise SchedulerLost(f"the scheduler {address} answers no more") from None


def check_scheduler(address: str) -> None:
    """Refuse the address of a scheduler that does not answer; raises SceneError."""
    if address != LOCAL:
        with _client(address, 1):
            pass


def _count(client: Any, jobs: int) -> int:
    """Threads of all workers there are now; those asked for where none has come yet."""
    return sum(client.nthreads().values()) or jobs


def _lost(error: Any, cases: list[int], address: str) -> Iterator[Found]:
    """Rows of cases that have ended their workers; whatever else is the matter is raised."""
    from distributed import KilledWorker

    if isinstance(error, KilledWorker):
        text = f"workers that ran it were lost, {error.allowed_failures + 1} in all; give them more memory"
        for case in cases:
            yield Row(case, LOST, text), {}
    elif isinstance(error, (ImportError, AttributeError, OtherProgram)):
        cure = "install the same version of Tautline where the workers run"
        raise option_error("--dask", address, f"its workers cannot run the cases: {error}", cure)
    elif isinstance(error, InputChanged) and address != LOCAL:
        raise InputChanged([replace(one, cause=f"{one.cause}, as a worker sees it") for one in error.problems])
    else:
        raise error


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep Dask from telling a lost scheduler by tracebacks, which we tell in a sentence; loggers are left as found."""
    loggers = [logging.getLogger(name) for name in TALKERS]
    levels = [one.level for one in loggers]
    for one in loggers:
        one.setLevel(SILENT)
    try:
        yield
    finally:
        for one, level in zip(loggers, levels, strict=True):
            one.setLevel(level)


def _can_put_off() -> bool:
    """Whether this thread may put Ctrl-C off. A handler that Python did not install could not be put back."""
    if threading.current_thread() is not threading.main_thread() or not hasattr(signal, "pthread_sigmask"):
        return False
    return signal.getsignal(signal.SIGINT) is not None


@contextmanager
def _interrupted_later() -> Iterator[None]:
    """Put off Ctrl-C until workers have started, and have them not hear it: this process ends them.

    A terminal sends it to all of them. Whoever is still importing then ends with a traceback, and so does a cluster
    that is half begun. A thread begins with the blocked signals of the one that made it, and so does a process.
    """
    if not _can_put_off():
        yield
        return
    from multiprocessing import resource_tracker

    # It unblocks the signal when it starts, which it would do for the first worker.
    resource_tracker.ensure_running()
    heard: list[int] = []
    # Another thread of this process may take the signal, and Python hands it to this one in spite of the mask.
    handler = signal.signal(signal.SIGINT, lambda number, _: heard.append(number))
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        signal.signal(signal.SIGINT, handler)
        if heard:
            # By the handler that was there: one of the caller, or none at all where he has it ignored, as by
            # `command &`. Also where no cluster could be started: what was asked then is to stop.
            signal.raise_signal(signal.SIGINT)


def _local_cluster(jobs: int) -> Any:
    """A cluster of processes on this machine; raises NoWorkers where they cannot be started."""
    from distributed import LocalCluster

    _check_script()
    try:
        with _interrupted_later():
            return LocalCluster(
                n_workers=jobs, threads_per_worker=1, processes=True, dashboard_address=":0", memory_limit=0,
                silence_logs=logging.CRITICAL,
            )  # fmt: skip
    except RuntimeError as error:
        cure = 'a script is imported by each of them: put the call under `if __name__ == "__main__":`'
        raise _no_workers(str(error), cure) from None


def _check_script() -> None:
    """Refuse a script that no process can import, as one from the standard input; raises NoWorkers."""
    script = getattr(sys.modules.get("__main__"), "__file__", None)
    if script is not None and not Path(script).is_file():
        cure = "a script is imported by each of them: save it as a file, and run that"
        raise _no_workers(f"there is no file {script}", cure)


def _no_workers(why: str, cure: str) -> NoWorkers:
    return NoWorkers([Problem("--dask", None, "", LOCAL, f"its processes could not be started ({why})", cure)])


def leave_if_starting() -> None:
    """End this process where it is one of such a cluster, and its start has come to the sweep that starts it.

    It imports the user's script, in which the call is not guarded. Who has started it says so in a sentence.
    """
    process = multiprocessing.current_process()
    if getattr(process, "_inheriting", False) and process.name.startswith(WORKER):
        raise SystemExit(1)


@contextmanager
def _client(address: str, jobs: int) -> Iterator[Any]:
    """A client of a scheduler, or of a cluster of our own, which ends with it."""
    try:
        from distributed import Client
    except ImportError:
        cure = "install it: pip install 'tautline[cluster]'"
        raise option_error("--dask", address, "needs dask.distributed, which is not installed", cure) from None
    with ExitStack() as stack:
        if address == LOCAL:
            # Until the end: the cluster starts a worker anew where one was killed.
            stack.enter_context(without_current_folder())
            place: Any = stack.enter_context(_local_cluster(jobs))
        else:
            place = address
        stack.enter_context(_quiet())
        try:
            client = Client(place, set_as_default=False, timeout=PATIENCE)
        except (OSError, ValueError) as error:
            cause = f"no scheduler answers: {' '.join(str(error).split()) or type(error).__name__}"
            raise option_error(
                "--dask", address, cause, "start one with `dask scheduler`, and give its address"
            ) from None
        stack.enter_context(client)
        yield client
