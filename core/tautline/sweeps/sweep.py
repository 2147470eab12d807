"""A sweep: many runs of one scene, and the table of what they came to."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from hashlib import sha256
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tautline.arguments import (
    FIGURES,
    FUNCTION,
    NAME,
    OPTIONS,
    PATH,
    SWITCH,
    VARIED,
    WHOLE,
    as_arguments,
    check,
    check_given,
    mapping_of,
)
from tautline.errors import ArgumentError, TautlineError
from tautline.results.tables.finding import Finding
from tautline.scene.errors import SHOWN, Problem, SceneError, option_error
from tautline.scene.identity.contents import model_hash
from tautline.scene.reading.document import join_key
from tautline.sweeps.cases import DONE, UNFINISHED, Row, Runner, job_of
from tautline.sweeps.doubts import Unsatisfied
from tautline.sweeps.execution import Execution
from tautline.sweeps.file import ORIGIN, SIMULATE, SweepFile, plan_cases, read_sweep, refused
from tautline.sweeps.inputs import InputChanged, hashes_of, stamps_of
from tautline.sweeps.journal import Journal
from tautline.sweeps.plans import Cases
from tautline.sweeps.table import DATASET, RANKED, TABLE, Variables, dataset, write_csv, write_netcdf, write_percentiles
from tautline.sweeps.verbs import check_figures, check_options, check_outputs, check_verb, of_all, unknown
from tautline.sweeps.workers import (
    LOCAL,
    Found,
    Measured,
    NoWorkers,
    SchedulerLost,
    check_scheduler,
    how,
    in_cluster,
    in_this_thread,
    in_threads,
    leave_if_starting,
)

if TYPE_CHECKING:
    import xarray

FIRST = 2
"""Cases that are run here before others get work: the first loads what comes after its loop, the second tells."""
TRIED, PATIENCE = 1000, 10.0
"""Cases by which it is known how long it takes to try all, and the time, s, above which that is said."""
KEPT = 2_000_000
"""Letters of scenes that are kept from being tried to being run: of short ones a thousand cases are not made twice."""


@dataclass
class Outcome:
    """What a sweep came to.

    Attributes
    ----------
    data : Variables
    cases : Cases
    done, failed, earlier : int
        Cases that came to their end, that did not, and of both those that an earlier run of the sweep had finished.
    wall_time, cpu_time, loop_time : float
        Of this run: time, processor time of all that took part, and that of the compiled loops, s.
    interrupted : bool
        Whether it was ended before all cases were run, by Ctrl-C or because the scheduler was lost.
    lost : str
        The sentence to the latter, empty else.
    result, table, percentiles : Path or None
        Files that were written.
    unsatisfied : Unsatisfied
        Limits that cases fail which came to their end.
    aside : Path or None
        Folder of the files of an earlier sweep, whose place this one has not taken: it stopped early, or no case ended.
    """

    data: Variables
    cases: Cases
    done: int = 0
    failed: int = 0
    earlier: int = 0
    wall_time: float = 0.0
    cpu_time: float = 0.0
    loop_time: float = 0.0
    interrupted: bool = False
    lost: str = ""
    result: Path | None = None
    table: Path | None = None
    percentiles: Path | None = None
    aside: Path | None = None
    unsatisfied: Unsatisfied = field(default_factory=Unsatisfied)

    @property
    def ended(self) -> str:
        """How the sweep ended, as ``status`` of ``--json`` has it."""
        if self.lost:
            return "scheduler lost"
        if self.interrupted:
            return "interrupted"
        return "done" if self.done else "no case came to its end"

    @property
    def overhead(self) -> float | None:
        """Processor time beside the compiled loops, as a share of theirs; None of a verb without a loop."""
        return self.cpu_time / self.loop_time - 1.0 if self.loop_time > 0.0 else None


class SweepInterrupted(TautlineError):
    """A sweep that was interrupted; ``data`` holds the cases that were finished."""

    def __init__(self, data: Any) -> None:
        self.data = data
        super().__init__("the sweep was interrupted")


@as_arguments({"-o": "folder", "--resume": "resume", "--dask": "dask"})
def sweep(
    scene: Any,
    vary: Mapping[str, Any],
    plan: Any = "grid",
    collect: Sequence[Any] = (),
    *,
    verb: str = SIMULATE,
    options: Mapping[str, Any] | None = None,
    indices: str | None = None,
    jobs: int | None = None,
    dask: str | None = None,
    folder: str | Path | None = None,
    resume: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> xarray.Dataset:
    """Run a scene with many values of some of its keys.

    Parameters
    ----------
    scene : scene, path, str or dict
        What :func:`tautline.read` returns, or what it takes.
    vary : mapping, table or list of pairs
        Key of the scene -> list of values, ``{"linspace": [5, 15, 11]}``, ``{"logspace": [0.1, 10, 5]}``, or a
        distribution such as ``{"normal": ["5 t", "0.5 t"]}``.
    plan : str or mapping
        ``grid``, ``zip``, ``one_at_a_time``, or ``{"latin_hypercube": {"samples": 100, "seed": 1}}``; also ``sobol``
        and ``monte_carlo``.
    collect : sequence
        Names of figures, and outputs with a statistic: ``{"output": "winch.tension", "statistic": "p95"}``; nothing
        for all figures.
    verb : str
        ``simulate``, or another verb with a table: ``torque-drag``, ``campbell``, ``static``, ``flutter``.
    options : mapping, optional
        Of that verb, as they stand on its command line: ``{"depth": "500:3500:500"}``.
    indices : str, optional
        ``sobol``: with the plan ``sobol``, the share of the variance that each parameter causes.
    jobs : int, optional
        Workers; as many as there are processors by default.
    dask : str, optional
        Address of a Dask scheduler, or ``local`` for processes on this machine.
    folder : path, optional
        Where result, table and journal go; nothing is written without it.
    resume : bool
        Whether to go on with the sweep in that folder.
    progress : callable, optional
        Called with the number of finished cases and that of all.

    Returns
    -------
    xarray.Dataset
        With a dimension a parameter for a grid, ``case`` else. ``status`` says how each case ended.

    Raises
    ------
    SceneError, ResultError, ArgumentError, ArgumentTypeError
        For bad input; nothing is written then.
    SweepInterrupted
        On Ctrl-C, with the cases that were finished.
    """
    import tautline

    leave_if_starting()
    vary = mapping_of(vary)
    check_given(vary=(vary, VARIED))
    check(
        collect=(collect, FIGURES), verb=(verb, NAME), options=(options, OPTIONS), indices=(indices, NAME),
        jobs=(jobs, WHOLE), dask=(dask, NAME), folder=(folder, PATH), resume=(resume, SWITCH),
        progress=(progress, FUNCTION),
    )  # fmt: skip
    if resume and folder is None:
        raise ArgumentError("resume = True goes on with the sweep in a folder: give its `folder` too")
    collect = [collect] if isinstance(collect, (str, Mapping)) else list(collect)
    given = {"scene": "scene", "verb": verb, "vary": dict(vary), "plan": plan, "collect": collect}
    given |= {"options": dict(options)} if options else {}
    given |= {"indices": indices} if indices else {}
    read_scene = tautline._scene(scene)
    application = tautline._installed().of(read_scene)
    execution = Execution(jobs, dask, None if folder is None else Path(folder), resume)
    if progress is not None:
        execution = replace(execution, progress=progress)
    outcome = run_sweep(read_sweep(given), application, read_scene, execution)
    if outcome.interrupted:
        raise SweepInterrupted(outcome.data.to_xarray())
    return outcome.data.to_xarray()


def run_sweep(
    read: SweepFile, application: Any, scene: Any, execution: Execution | None = None, begin: float = 0.0,
    trends: Mapping[str, str] | None = None,
) -> Outcome:  # fmt: skip
    """Run a sweep that was read; what is refused is refused before anything is written.

    Frames of a run count from the time `begin`, s, on. Of `trends`, name of an extreme -> ``largest`` or ``smallest``,
    there is a column with the trend, too.
    """
    one = _Sweep(read, application, scene, execution or Execution(), begin, trends)
    one.check()
    try:
        one.claim()
        one.execution.begin()
        return one.run()
    finally:
        one.close()


class _Sweep:
    """A sweep under way."""

    def __init__(
        self, read: SweepFile, application: Any, scene: Any, execution: Execution, begin: float = 0.0,
        trends: Mapping[str, str] | None = None,
    ) -> None:  # fmt: skip
        self.began, self.used = time.perf_counter(), time.process_time()
        self.read, self.application, self.scene = read, application, scene
        jobs, folder = execution.jobs, execution.folder
        if jobs is not None and jobs < 0:
            raise option_error("jobs", str(jobs), "is less than zero", "give 1 or more; 0 or None for all processors")
        self.execution, self.jobs, self.folder = execution, jobs or _processors(), folder
        check_verb(read, application)
        check_options(read, application, scene)
        self.collected = read.collected()
        self.cases = plan_cases(read, application, scene)
        scenes = self._scenes()
        files = hashes_of(scenes)
        self.job = job_of(application, scene, read.verb, read.options, self.collected, files, begin, trends)
        self.runner = Runner(self.job, application, scene)
        self.journal: Journal | None = None
        if folder is not None:
            mark, about = self._mark(scenes), read.said() | self._begun_at()
            self.journal = Journal(folder, mark, len(self.cases), execution.resume, files, about)
        self.columns: dict[str, Finding] = dict(self.journal.columns or {}) if self.journal is not None else {}
        self.kept: list[Row] = []
        # Whether all names that are asked for are known to be found: then each row is kept as soon as it is there.
        self.named = False
        # Figures that some cases have and others not, since what varies are no numbers: a rope without a breaking load.
        self.of_some: dict[str, Finding] = {}
        # Those that no case may have, such as a snap: their column is there, and empty.
        self.of_none: dict[str, Finding] = {}
        self.loop_time = self.elsewhere = 0.0
        self.process = os.getpid()
        self.lost: list[Row] = []

    def _mark(self, scenes: Sequence[Any]) -> str:
        """What makes it this sweep: the scene with its files, and all of the sweep's file that changes a number."""
        # The cases of a grid are numbered in the order of its keys, which a sorted text would not tell.
        order = list(self.read.vary)
        whole: list[Any] = [self.read.said() | self._begun_at(), order, self.scene.document.root]
        whole.append([model_hash(scene, (), getattr(scene, "folder", None)) for scene in scenes])
        return sha256(json.dumps(whole, sort_keys=True, default=str).encode()).hexdigest()[:16]

    def _begun_at(self) -> dict[str, Any]:
        """From when on frames count, where it is not all of them, and of what a trend is found."""
        begun: dict[str, Any] = {"begin": self.job.begin} if self.job.begin else {}
        return begun | ({"trends": self.job.trends} if self.job.trends else {})

    def _scenes(self) -> list[Any]:
        """The scene, and others that name all files that values name: records of motion, responses."""
        scenes = [self.scene]
        for one in self.cases.parameters:
            for value in one.values if not one.numeric else ():
                try:
                    scenes.append(self.scene.replace({one.key: value}, origin=ORIGIN))
                except SceneError:
                    # It cannot be had beside the others as they are, and may be beside their values.
                    scenes += self._with(one.key, value)
        return scenes

    def _with(self, key: str, value: Any) -> Iterator[Any]:
        """The first scene of a case that has a value and can be had; none where there is none."""
        having = (case for case, each in enumerate(self.cases.values[key]) if each is value)
        for case in islice(having, TRIED):
            with suppress(SceneError):
                yield self.scene.replace(self.cases.changes(case), origin=ORIGIN)
                return

    def check(self) -> None:
        """Try every case on the scene's reader, and build one; raises SceneError before anything is written."""
        problems: dict[Problem, list[Problem]] = {}
        finished = self.journal.done if self.journal is not None else ()
        began, kept = time.perf_counter(), KEPT // max(1, len(self.scene.document.text))
        for case in range(len(self.cases)):
            if case == TRIED:
                left = (time.perf_counter() - began) * (len(self.cases) / TRIED - 1.0)
                if left > PATIENCE:
                    told = f"the values of {len(self.cases)} cases are tried first"
                    self.execution.say(f"{told}, which takes about {left:.0f} s")
            changes = self.cases.changes(case)
            try:
                scene = self.runner.varied(changes)
                if len(self.runner.tried) < kept and case not in finished:
                    self.runner.tried[case] = scene
            except SceneError as error:
                told = ", ".join(f"{key} = {value}" for key, value in changes.items())
                found = refused(self.read, error, f"case {case}: {told}").problems
                for problem in found:
                    # Values that a distribution makes are all at one line, and what is said of them is the same.
                    drawn = self._drawn(problem) is not None
                    problems.setdefault(replace(problem, value=None) if drawn else problem, []).append(problem)
            if len(problems) > SHOWN:
                break
        if problems:
            raise SceneError([self._with_bounds(some) for some in problems.values()])
        try:
            model = self.runner.prepare(self.cases.changes(0), self.execution.announce)
        except SceneError:
            # A case that cannot be built is a row; a scene that cannot be built at all is bad input.
            model = self.runner.prepare({}, self.execution.announce)
        if self.execution.dask is not None:
            check_scheduler(self.execution.dask)
        if model is not None:
            check_outputs(self.read, model)
            self.named = check_figures(self.read, model, getattr(self.application, "sometimes", ()))
            asked = [one for one in self.collected if one.figure in model.figure_units]
            named = {one.name: Finding(None, model.figure_units[one.figure], one.figure) for one in asked}
            if not all(one.numeric for one in self.cases.parameters):
                self.of_some = named
            sometimes = getattr(self.application, "sometimes", ())
            self.of_none = {name: one for name, one in named.items() if one.text in sometimes}

    def _drawn(self, problem: Problem) -> Any:
        """The distribution that made the value of a problem; None where none did."""
        for one in self.cases.parameters:
            if one.spread is not None and problem.key and problem.key.startswith(join_key(("vary", one.key))):
                return one.spread
        return None

    def _with_bounds(self, same: Sequence[Problem]) -> Problem:
        """One problem for all that differ in their values alone.

        Of what a distribution makes, and the scene cannot have, it says how often, and that there are others with
        bounds.
        """
        problem = same[0]
        spread = self._drawn(problem)
        if spread is None:
            return problem
        often = f" ({len(same)} of the {len(self.cases)} values are refused for this)" if len(same) > 1 else ""
        bounded = f"the {spread.name} distribution reaches there: take truncated_normal, or other numbers"
        cure = f"{problem.cure}; {bounded}" if problem.cure else bounded
        return replace(problem, cause=f"{problem.cause}{often}", cure=cure)

    def claim(self) -> None:
        """Have the folder for this sweep alone; what an earlier run of it has finished by now is known then."""
        if self.journal is not None:
            self.journal.claim()
            self.columns |= self.journal.columns or {}

    def run(self) -> Outcome:
        """Run what is not finished, and write the result."""
        finished = set(self.journal.done) if self.journal is not None else set()
        if self.journal is not None and self.journal.columns is not None:
            self.journal.begin()
        todo = ((case, self.cases.changes(case)) for case in range(len(self.cases)) if case not in finished)
        interrupted, lost, done = False, "", len(finished)
        rows, progress = self._rows(todo, len(self.cases) - done), self.execution.progress
        try:
            progress(done, len(self.cases))
            for row, found in rows:
                self._take(row, found)
                done += 1
                progress(done, len(self.cases))
            self.runner.inputs.check(stamps_of(self.job.files))
        except KeyboardInterrupt:
            interrupted = True
        except SchedulerLost as error:
            interrupted, lost = True, str(error)
        except InputChanged as error:
            rows.close()
            raise self._with_resume_hint(error, done) from None
        finally:
            rows.close()
        outcome = self._finish(interrupted, len(finished))
        outcome.lost = lost
        return outcome

    def _with_resume_hint(self, error: InputChanged, done: int) -> InputChanged:
        """The same fault of the input, with what is kept and how to go on."""
        if self.journal is not None and not self.journal.begun and self.kept:
            self._begin()
        every = f"the sweep has stopped, with {done} of {len(self.cases)} cases finished"
        if self.journal is None or not self.journal.done:
            cure = "run it again, and leave its files alone until it has ended"
        else:
            every += f" before that: they are kept in {self.journal.path.parent}"
            if self.journal.aside is not None:
                every += f". Results of the sweep before it are in {self.journal.aside}"
            cure = "put the file back as it was and go on with --resume, or name another folder with -o"
        return InputChanged([replace(one, cause=f"{one.cause}; {every}", cure=cure) for one in error.problems])

    def _rows(self, todo: Iterator[tuple[int, Mapping[str, Any]]], left: int) -> Iterator[Found]:
        """Rows as they come. The first cases are run here: they tell what the others take."""
        measured = Measured(1.0, 1.0)
        for case, changes in islice(todo, 1 if self.jobs == 1 else FIRST):
            row, found = self.runner.run(case, changes)
            left -= 1
            measured = Measured(row.wall_time, 1.0 - min(1.0, row.loop_time / max(row.wall_time, 1e-9)))
            yield row, found
        dask, say = self.execution.dask, self.execution.say
        if dask is not None:
            by = "processes"
        else:
            by = how(self.jobs, left, measured)
        if by == "here":
            yield from in_this_thread(self.runner, todo)
        elif by == "threads":
            total = len(self.cases)
            say(f"{total} cases; {total - left} have run, {left} left, on {self.jobs} threads")
            yield from in_threads(self.runner, todo, self.jobs)
        else:
            self.runner.tried.clear()
            try:
                yield from in_cluster(self.job, todo, self.jobs, dask or LOCAL, measured, say)
            except NoWorkers as error:
                if dask is not None:
                    raise
                say(f"{error.problems[0].cause}: the other cases run on {self.jobs} threads")
                yield from in_threads(self.runner, todo, self.jobs)

    def _take(self, row: Row, found: Mapping[str, Finding]) -> None:
        """Keep a row: in the journal, as soon as it is known that what is asked for is found."""
        self.loop_time += row.loop_time
        if row.process != self.process:
            self.elsewhere += row.cpu_time
        if row.status == DONE:
            self._check_names(found)
            self._learn(row, found)
        if row.status in UNFINISHED:
            self.lost.append(row)
        elif self.journal is None or not self.journal.begun:
            self.kept.append(row)
            if self.journal is not None and (row.status == DONE or self.named):
                self._begin()
        else:
            self.journal.add(row)

    def _check_names(self, found: Mapping[str, Finding]) -> None:
        """Refuse names that the verb does not find, but for those that it finds in some runs only."""
        sometimes = getattr(self.application, "sometimes", ())
        missing = [one for one in unknown(found, self.collected) if self.collected[one[0]].figure not in sometimes]
        missing = [one for one in missing if self.collected[one[0]].name not in self.columns | self.of_some]
        if missing:
            raise SceneError([self.read.problem_at(("collect", i), cause, cure) for i, cause, cure in missing])

    def _learn(self, row: Row, found: Mapping[str, Finding]) -> None:
        """Keep what the columns are; a run may find what those before it have not."""
        new = {name: of_all(found[name]) for name in row.values if name not in self.columns}
        self.columns |= new
        if new and self.journal is not None and self.journal.begun:
            self.journal.describe(self.columns)

    def _begin(self) -> None:
        assert self.journal is not None
        self.journal.begin()
        self.journal.describe(self.columns)
        for row in self.kept:
            self.journal.add(row)
        self.kept = []

    def _all_rows(self) -> Iterator[Row]:
        if self.journal is not None:
            yield from self.journal.rows()
        yield from self.kept
        yield from self.lost

    def _finish(self, interrupted: bool, earlier: int) -> Outcome:
        """Write result and table of all that is known."""
        if self.journal is not None and not self.journal.begun and (self.kept or self.journal.done):
            self._begin()
        known = self.of_none | self.of_some | self.columns
        columns = {one.name: known[one.name] for one in self.collected if one.name in known}
        attributes = {
            "scene": self.scene.document.told, "application": self.application.name, "verb": self.read.verb,
            "sweep": self.read.document.told, "title": self.read.title or self.scene.title or "",
            "printed_in": str(getattr(self.scene, "units", "si")),
        }  # fmt: skip
        unsatisfied = Unsatisfied()
        data = dataset(self.cases, columns | self.columns, unsatisfied.of(self._all_rows()), attributes)
        if self.cases.indices and not interrupted:
            from tautline.sweeps.indices import sobol_indices

            data = data.with_variables(sobol_indices(data, self.cases))
        outcome = Outcome(data, self.cases, earlier=earlier, interrupted=interrupted, unsatisfied=unsatisfied)
        status = data["status"].values.ravel()
        outcome.done = int((status == DONE).sum())
        outcome.failed = int(((status != DONE) & (status != "not run")).sum())
        if self.folder is not None and self.journal is not None and self.journal.begun:
            outcome.result = write_netcdf(data, self.folder / DATASET)
            outcome.table = write_csv(data, self.cases, self.folder / TABLE)
            outcome.percentiles = write_percentiles(data, self.folder / RANKED)
            if outcome.done and not interrupted:
                self.journal.replace()
            outcome.aside = self.journal.aside
        self.close()
        outcome.wall_time = time.perf_counter() - self.began
        outcome.cpu_time = time.process_time() - self.used + self.elsewhere
        outcome.loop_time = self.loop_time
        return outcome

    def close(self) -> None:
        """Let others have the folder."""
        if self.journal is not None:
            self.journal.close()


def _processors() -> int:
    """Processors that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:
        return os.cpu_count() or 1
