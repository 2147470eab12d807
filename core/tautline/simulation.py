"""Run a model: from its start to its end, storing frames as they come."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tautline.finer_frames import FinerFrames
from tautline.integrators.status import Interrupted, Status, StoppedEarly
from tautline.integrators.time_loop import (
    compile_for,
    loop_of,
)
from tautline.interruption import listening, undisturbed
from tautline.results.brief_store import BriefStore
from tautline.results.result import Result
from tautline.results.resumption import (
    taken_over,
)
from tautline.results.store import FrameStore, Store
from tautline.run import INTERRUPTED, Brief, Look, Run
from tautline.system.model import Model
from tautline.version import __version__

Further = tuple[dict[str, Any], list[str]]
"""Attributes of a result, and warnings, that a run itself does not know."""


class Afterwards(NamedTuple):
    """What is found out behind a run that came to its end.

    Attributes
    ----------
    look : callable
        Called with the result.
    unless : Further or None
        What is known instead where Ctrl-C ends the look, or came with the last frames: the run is done all the same,
        for nothing of it is missing. None where the look belongs to the run, which is then interrupted.
    """

    look: Callable[[Result], Further]
    unless: Further | None = None


def simulate(
    model: Model,
    path: str | Path | None = None,
    progress: Callable[[float, float], None] | None = None,
    resume: Result | None = None,
    announce: Callable[[int], Any] | None = None,
    look: Look | None = None,
    afterwards: Afterwards | None = None,
    brief: Brief | None = None,
    begin: Callable[[], Any] | None = None,
    finer: FinerFrames | None = None,
) -> Result:
    """Run a model and store its frames.

    Parameters
    ----------
    model : Model
        From an application's builder.
    path : path or None
        The result file; None keeps the result in memory.
    progress : callable or None
        Called with simulated and wall time, s, after every batch of frames. What it raises ends the run; the frames
        until then are kept.
    resume : Result or None
        An earlier result of the same scene, to go on from where it ended; its frames come first in the new one.
    announce : callable or None
        Called before kernels are compiled, with their number: a scene of a kind that was never run here has to wait.
    look : callable or None
        Called with the state, its time, s, and the method, at the start and after every so many frames, some two
        hundred times in all; it changes nothing.
    afterwards : Afterwards or None
        What finds further attributes of a run that came to its end, and further warnings.
    brief : Brief or None
        For one of many runs.
    begin : callable or None
        Called when nothing of ``resume`` can be refused any more, before anything is written.
    finer : FinerFrames or None
        Takes further frames, between those that are stored; not with ``resume``, ``brief`` or statistics.

    Returns
    -------
    Result

    Raises
    ------
    StoppedEarly
        Where no start was found or a step failed, with the status and what was stored until then; and IMBALANCE where
        the run came to its end with a twentieth of its energy created numerically, NO_BALANCE where it came there with
        an energy that is no number.
    Interrupted
        On Ctrl-C, with what was stored until then; not behind the last frame where ``afterwards`` says what holds then.
    ResultError
        Where ``resume`` holds no state to go on from, or that of another scene, or has come to the end already.
    """
    # One of many runs is the only one of its model.
    with model.system.beginning_anew() if brief is None else nullcontext():
        return _run(model, path, progress, resume, announce, look, afterwards, brief, begin, finer)


def _run(
    model: Model,
    path: str | Path | None,
    progress: Callable[[float, float], None] | None,
    resume: Result | None,
    announce: Callable[[int], Any] | None,
    look: Look | None,
    afterwards: Afterwards | None,
    brief: Brief | None,
    begin: Callable[[], Any] | None,
    finer: FinerFrames | None,
) -> Result:
    """Run a model whose groups are as they were built; see `simulate`."""
    attributes = {} if brief is not None else {**model.attributes, "version": __version__, **taken_over(resume)}
    make, model = _store_of(model, brief)
    run = Run(model, look, brief, finer)
    earlier = _gone_on_with(run, resume) if resume is not None else None
    if begin is not None:
        begin()
    with make(path, model.variables, model.coordinates, attributes) as store, listening() as ear:
        try:
            if brief is None or not brief.compiled:
                compile_for(run.method, model.system, run.state, announce, model.start == "static")
            # The static start asks for a part of what the loop does.
            model.system.link(loop_of(run.method)[1])
            if earlier is not None:
                assert resume is not None
                store.attributes["start"] = run.began.attribute
                if isinstance(store, Store):
                    # Of a simulation that kept its last frames only: the start is not among those that follow.
                    store.start = resume.start
                store.append(earlier, run.memory, run.progress())
            else:
                run.start()
                # Figures may be over what the start was, also those of a part of the frames.
                store.attributes["start"] = run.began.attribute
                run.store_first(store)
            while run.done < run.ends.size:
                run.advance(store)
                ear.check()
                if progress is not None:
                    _tell(progress, run, store)
            further = ({}, []) if afterwards is None else _found_behind(afterwards, run, store)
        except KeyboardInterrupt:
            if not run.complete or afterwards is None or afterwards.unless is None:
                result = run.finish(store, INTERRUPTED)
                raise Interrupted(run.reached, result) from None
            further = afterwards.unless
        except StoppedEarly as stop:
            stop.result = run.finish(store, stop.status.word)
            raise
        with undisturbed(tell=False):
            result = run.finish(store, run.end_status().word, *further)
    assert result is not None
    if run.end_status() == Status.NO_BALANCE:
        raise StoppedEarly(Status.NO_BALANCE, run.time, "the whole scene", run.no_energy, result)
    if run.end_status() == Status.IMBALANCE:
        detail = f"{100.0 * run.energy_created():.2g} % of it was created numerically"
        raise StoppedEarly(Status.IMBALANCE, run.time, "the whole scene", detail, result)
    return result


def _found_behind(afterwards: Afterwards, run: Run, store: FrameStore) -> Further:
    """What is found out behind a run; whatever that raises, the run is kept as it ended."""
    stored = store.result
    try:
        return ({}, []) if stored is None else afterwards.look(stored)
    except (KeyboardInterrupt, StoppedEarly):  # have a way of their own
        raise
    except BaseException:  # also SystemExit
        run.finish(store, run.end_status().word)
        raise


def _tell(progress: Callable[[float, float], None], run: Run, store: FrameStore) -> None:
    """Show progress; what that raises ends the run, of which the frames are kept as on Ctrl-C."""
    try:
        progress(run.reached, run.wall)
    except KeyboardInterrupt:  # has a way of its own
        raise
    except BaseException:  # also SystemExit
        run.finish(store, INTERRUPTED)
        raise


def _gone_on_with(run: Run, resume: Result) -> dict[str, np.ndarray]:
    """Let a run go on from an earlier result; returns its frames. Raises ResultError where that cannot be."""
    from tautline.statistics.store import check_whole

    check_whole(resume, "a run that goes on from it")
    return run.resume_from(resume)


def _store_of(model: Model, brief: Brief | None) -> tuple[Callable[..., FrameStore], Model]:
    """What takes the frames of a model, and the model as its run is to see it."""
    if model.keep is None:
        return (BriefStore if brief is not None and brief.names and model.on_demand is not None else Store), model
    from tautline.statistics.store import StatisticsStore, told_by_digest

    headline: Callable[[Any], dict[str, dict[str, Any]]] = model.headline
    limits, names = model.limits, tuple(model.keep.names)
    if brief is not None and brief.names:
        judged = {bound.output for bound in model.bounds if not bound.of_frames}
        names = tuple(brief.names | judged)
    if names and (figures := model.figures) is not None:

        def headline(result: Result) -> dict[str, dict[str, Any]]:
            return figures(result, names)

    make = partial(
        StatisticsStore,
        keep=model.keep,
        headline=headline,
        limits=limits,
        bounds=model.bounds,
        figures=model.figure_units,
    )
    return make, told_by_digest(model)
