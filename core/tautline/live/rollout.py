"""Several simulations at a time, on several cores."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor

from tautline.arguments import Wanted, check_given, is_list
from tautline.live.errors import SimulationError, seconds
from tautline.live.simulation import Simulation

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
        For a time that is no finite number or before those of all simulations, and a number of threads that is none.
    StoppedEarly
        That of the first simulation which failed; the others have come to their end.
    """
    if isinstance(simulations, Iterator):
        simulations = list(simulations)
    check_given(simulations=(simulations, SIMULATIONS))
    until = seconds(until)
    if not until < math.inf:
        raise SimulationError(f"cannot advance to {until:g} s", "give a finite time")
    if workers is not None and not (isinstance(workers, int) and workers > 0):
        raise SimulationError(f"{workers!r} is no number of threads", "give 1 or more, or None for all processors")
    different = list({id(one): one for one in simulations}.values())
    if different and until < min(one.time for one in different):
        first = min(one.time for one in different)
        raise SimulationError(
            f"cannot advance to {until:g} s from {first:g} s", "give a later time; restore() goes back"
        )
    with ThreadPoolExecutor(workers) as pool:
        done = [pool.submit(one.advance_to, until) for one in different if one.time < until]
    for one in done:
        one.result()
