"""Several simulations at a time, on several cores."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, wait

from tautline.arguments import Wanted, check_given, is_list
from tautline.integrators.status import Interrupted
from tautline.interruption import Ear, listening
from tautline.live.errors import SimulationError, seconds
from tautline.live.simulation import Simulation

LOOK = 0.1
"""Wall time, s, after which Ctrl-C is heard where the system has told another thread of it."""
SIMULATIONS = Wanted(
    "a list of simulations", lambda value: is_list(value) and all(isinstance(one, Simulation) for one in value)
)


def rollout(simulations: Sequence[Simulation], until: float, workers: int | None = None) -> None:
    """Advance simulations to a time, each on a thread of its own: the compiled loop leaves the interpreter to others.

    Parameters
    ----------
    simulations : sequence of Simulation
        Each once; those that have come to that time stay where they are.
    until : float or str
        s, or a text with its unit.
    workers : int, optional
        Threads at a time; by default as many as there are processors.

    Raises
    ------
    ArgumentTypeError
        For what is no list of simulations.
    SimulationError
        For a simulation that is given twice, a time that is no finite number or before those of all simulations, and a
        number of threads that is none.
    StoppedEarly
        That of the first simulation which failed; the others have come to their end.
    Interrupted
        On Ctrl-C: each simulation stands after the step that was under way, and may go on. It is that of the first
        simulation which has not come to its end.
    """
    if isinstance(simulations, Iterator):
        simulations = list(simulations)
    check_given(simulations=(simulations, SIMULATIONS))
    until = seconds(until)
    if not until < math.inf:
        raise SimulationError(f"cannot advance to {until:g} s", "give a finite time")
    if workers is not None and not (isinstance(workers, int) and workers > 0):
        raise SimulationError(f"{workers!r} is no number of threads", "give 1 or more, or None for all processors")
    _check_each_once(simulations)
    if len(simulations) and until < (first := min(one.time for one in simulations)):
        raise SimulationError(
            f"cannot advance to {until:g} s from {first:g} s", "give a later time; restore() goes back"
        )
    for one in simulations:
        one.parameters.check()
    with listening(patient=True) as ear:
        _advance(simulations, until, workers, ear)


def _check_each_once(simulations: Sequence[Simulation]) -> None:
    """Refuse one that is given twice: a copy was meant, or another one, and both would show one motion."""
    places: dict[int, int] = {}
    for place, one in enumerate(simulations):
        before = places.setdefault(id(one), place)
        if before != place:
            raise SimulationError(
                f"simulations[{place}] is the same simulation as simulations[{before}]: it moves once",
                "give each once; sim.copy() gives another one that goes on by itself",
            )


def _advance(simulations: Sequence[Simulation], until: float, workers: int | None, ear: Ear) -> None:
    """Advance simulations on threads, which hear of Ctrl-C by the ear of this one."""

    def go_on(one: Simulation) -> None:
        if ear.heard:
            raise Interrupted(one.time)
        one.advance_heard(until, ear)

    done: list[Future[None]] = []
    with ThreadPoolExecutor(workers) as pool:
        try:
            for one in simulations:
                if one.time < until:
                    done.append(pool.submit(go_on, one))
            while wait(done, LOOK).not_done:
                pass
        except KeyboardInterrupt:
            # Raised by a handler that is not ours. Threads that went on would change simulations unseen.
            ear.heard = True
    errors = [error for one in done if (error := one.exception()) is not None]
    if ear.heard:
        interrupted = (error for error in errors if isinstance(error, Interrupted))
        raise next(interrupted, Interrupted(min((one.time for one in simulations), default=until)))
    if errors:
        raise errors[0]
