"""One case of a sweep: the scene with its values, run; and the row that comes of it."""

from __future__ import annotations

import functools
import os
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from tautline.errors import TautlineError
from tautline.integrators.status import Interrupted, StoppedEarly
from tautline.results.headline import plain
from tautline.results.tables.finding import Finding
from tautline.scene.errors import SceneError
from tautline.scene.reading.document import Document
from tautline.statistics.trends import Trends
from tautline.sweeps.file import ORIGIN, SIMULATE, Collected
from tautline.sweeps.inputs import Inputs, stamps_of
from tautline.sweeps.verbs import Watch, chosen, names_of, of_run, tables_of
from tautline.version import __version__

DONE, BAD_INPUT, LOST, FAULT = "done", "bad input", "worker lost", "internal error"
UNFINISHED = (LOST, FAULT)
"""What may be the matter with the machine or the program and not with the case: it runs again with ``--resume``."""

RERUNS = 2
"""Times that a case runs again because a file of the same contents was written meanwhile."""


@dataclass
class Row:
    """What a case came to.

    Attributes
    ----------
    case : int
    status : str
        ``done``, or why it was not.
    message : str
        The sentence to that; empty if done.
    values : dict
        Name -> number or list of numbers in SI, or text; empty if not done.
    limits : list of str
        Names of the limits that a run that is done does not satisfy.
    wall_time, cpu_time, loop_time : float
        Of the case, of its thread, and of its compiled loop, s.
    process : int
        Number of the process that ran it.
    """

    case: int
    status: str
    message: str = ""
    values: dict[str, Any] = field(default_factory=dict)
    limits: list[str] = field(default_factory=list)
    wall_time: float = 0.0
    cpu_time: float = 0.0
    loop_time: float = 0.0
    process: int = 0


@dataclass(frozen=True)
class Job:
    """What is done in every case, as it goes to another process: nothing in it but plain values.

    Attributes
    ----------
    application : str
        Name of the application.
    document : Document
        The scene; its folder is absolute.
    files : mapping
        Path -> hash of the files that the scene and what varies in it name, as they were when the sweep began.
    begin : float
        Time, s, from which on frames of a run count.
    trends : mapping
        Names of what is collected and is an extreme -> ``largest`` or ``smallest``: of these the trend over the frames
        that count is found, too (`tautline.statistics.trends`).
    """

    application: str
    document: Document
    verb: str = SIMULATE
    options: Mapping[str, Any] = field(default_factory=dict)
    collected: tuple[Collected, ...] = ()
    files: Mapping[str, str] = field(default_factory=dict)
    begin: float = 0.0
    trends: Mapping[str, str] = field(default_factory=dict)


class Cancelled(TautlineError):
    """A run that is not wanted any more."""


class Runner:
    """Runs the cases of a job in this process; threads may share it.

    Parameters
    ----------
    application, scene
        Of the job, where they were made already.

    Attributes
    ----------
    tried : dict
        Scenes of cases that were made to see whether they can be; each is used once.
    """

    def __init__(self, job: Job, application: Any = None, scene: Any = None) -> None:
        self.job, self.inputs = job, Inputs(job.files)
        if scene is None:
            # In another process: of a file that is another one here, that is to be said and not what it lacks.
            self.inputs.check(stamps_of(job.files))
        self.application = application if application is not None else _application(job.application)
        self.scene = scene if scene is not None else self.application.read(job.document)
        self.cancelled = False
        self.tried: dict[int, Any] = {}
        self._own = threading.local()
        self._turn: threading.Lock | None = None

    def share(self) -> None:
        """Have several threads run cases: of a run all but its loop is done by one of them at a time."""
        if self.job.verb == SIMULATE:
            self._turn = threading.Lock()

    def varied(self, changes: Mapping[str, Any]) -> Any:
        """The scene of a case; raises SceneError."""
        return self.scene.replace(changes, origin=ORIGIN) if changes else self.scene

    def run(self, case: int, changes: Mapping[str, Any]) -> tuple[Row, dict[str, Finding]]:
        """Run a case: its row, and all findings without their values; what stops it early is told in the row.

        Raises
        ------
        InputChanged
            Where a file that it reads is not what it was when the sweep began: there is no row then.
        """
        files = self.inputs.of_case(self.scene, changes)
        for left in range(RERUNS, -1, -1):
            before = stamps_of(files)
            self.inputs.check(before)
            row, found = self._row(case, changes)
            after = stamps_of(files)
            if after == before:
                break
            # One was written while the case ran, which may have read half of it; of the same contents it runs again.
            # One that is touched all the time has the contents of the sweep before and after: the row is right.
            self.inputs.check(after)
            if not left:
                break
        return row, found

    def _row(self, case: int, changes: Mapping[str, Any]) -> tuple[Row, dict[str, Finding]]:
        """The same, whatever becomes of the files meanwhile."""
        began, used = time.perf_counter(), time.thread_time()
        row = Row(case, DONE, process=os.getpid())
        found: dict[str, Finding] = {}
        try:
            with self._turn or nullcontext():
                scene = self.tried.pop(case, None)
                found, row.limits, row.loop_time = self._found(self.varied(changes) if scene is None else scene)
            kept = chosen(found, self.job.collected, self.job.trends)
            row.values = {name: plain(one.value) for name, one in kept.items()}
            # What is told of the columns goes without the values: it is kept, and sent by the workers of a cluster.
            found = {name: one._replace(value=None) for name, one in found.items()}
        except Interrupted:
            raise KeyboardInterrupt from None
        except StoppedEarly as stop:
            row.status = stop.status.word
            row.message = f"t = {stop.time:.4g} s, {stop.part}: {stop.sentence}"
            if stop.result is not None:
                row.loop_time = float(stop.result.attributes.get("cpu_time") or 0.0)
        except SceneError as error:
            row.status, row.message = BAD_INPUT, str(error)
        except Cancelled:
            raise
        except Exception as error:  # a fault of the program in one case must not cost the others
            row.status, row.message = FAULT, " ".join(f"{type(error).__name__}: {error}".split())
        row.wall_time, row.cpu_time = time.perf_counter() - began, time.thread_time() - used
        return row, found

    def _found(self, scene: Any) -> tuple[dict[str, Finding], list[str], float]:
        """Findings of a case, limits that it does not satisfy, and the time of its compiled loop, s."""
        if self.job.verb != SIMULATE:
            table = tables_of(self.application)[self.job.verb]
            return table.find(scene, table.read(scene, self.job.options)), [], 0.0
        from tautline.simulation import simulate

        model = self.application.build(scene)
        watch = Watch(model, self.job.collected, self.job.begin)
        trends = Trends(self.job.trends, watch.begin, float(model.solver.end))
        trends.watch(model)
        result = simulate(model, progress=self._go_on, brief=self._brief())
        sometimes = getattr(self.application, "sometimes", ())
        found = of_run(result, model, self.job.collected, watch, sometimes)
        found |= trends.findings(found, {one.name: watch.values(one.name) for one in watch.asked})
        failed = [str(record["name"]) for record in result.limits if record["passed"] is False]
        return found, failed, float(result.attributes["cpu_time"])

    def _brief(self) -> Any:
        """What is wanted of a run; threads have one each, for the length of batches goes from run to run in it."""
        from tautline.run import Brief

        known = getattr(self._own, "brief", None)
        if known is None:
            names = names_of(self.job.collected)
            known = self._own.brief = Brief(names, begin=self.job.begin)
        known.turn = self._turn
        return known

    def _go_on(self, simulated: float, wall: float) -> None:
        if self.cancelled:
            raise Cancelled

    def prepare(self, changes: Mapping[str, Any], announce: Callable[[int], Any] | None = None) -> Any:
        """Build a case and compile or load what all will need, in this thread; returns the model, None of no run."""
        if self.job.verb != SIMULATE:
            return None
        from tautline.integrators.time_loop import compile_for
        from tautline.run import Run

        model = self.application.build(self.varied(changes))
        run = Run(model)
        compile_for(run.method, model.system, run.state, announce, model.start == "static")
        return model


def job_of(
    application: Any, scene: Any, verb: str, options: Mapping[str, Any], collected: Sequence[Collected],
    files: Mapping[str, str] | None = None, begin: float = 0.0, trends: Mapping[str, str] | None = None,
) -> Job:  # fmt: skip
    """The job of a scene that was read, and of files as they are."""
    document = scene.document
    home = Path(document.folder).resolve()
    return Job(
        application.name, replace(document, home=home), verb, dict(options), tuple(collected), files or {}, begin,
        dict(trends or {}),
    )  # fmt: skip


def _application(name: str) -> Any:
    from tautline.application.installed import Installed

    return next(one for one in Installed().all() if one.name == name)


@functools.lru_cache(maxsize=4)
def _runner(packed: bytes) -> Runner:
    import pickle

    return Runner(pickle.loads(packed))


class OtherProgram(TautlineError):
    """A worker whose Tautline is another one than that of the sweep."""


@functools.cache
def program() -> tuple[str, str]:
    """Version of Tautline, and the hash of all its sources with those of the installed applications that come with it.

    A version that is worked on keeps its number while its sources change.
    """
    from tautline.kernels.machine.sources import hash_of_all_sources

    return __version__, hash_of_all_sources()


def run_piece(
    of_sweep: tuple[str, str], packed: bytes, cases: Sequence[tuple[int, Mapping[str, Any]]]
) -> list[tuple[Row, dict[str, Finding]]]:
    """Run cases in a process of a cluster, which keeps the scene of a job that it has read.

    Raises
    ------
    OtherProgram
        Where this process has another Tautline than the sweep.
    """
    # Before the job is unpacked, whose classes may differ too.
    version, sources = of_sweep
    here, of_here = program()
    if here != version:
        raise OtherProgram(f"a worker has Tautline {here}, and the sweep is run with {version}")
    if of_here != sources:
        raise OtherProgram(f"a worker has Tautline {here} of other sources than that of the sweep")
    runner = _runner(packed)
    return [runner.run(case, changes) for case, changes in cases]
