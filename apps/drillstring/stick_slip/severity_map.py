"""The map of stick-slip: how a bit turns at rotary speeds and weights, one run of the scene for each, on all cores.

Every run begins with the string at rest, the bit on the bottom with its weight. The drive comes to its speed, with it
the block to the rate of penetration there, and the bit is let go by a torque above what would turn it: the hardest
start. What the last half of the run shows is whether the string comes to turn steadily from there.
"""

from __future__ import annotations

import math
import os
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from drillstring.drilling.bit_numbers import bit_row, rate_at
from drillstring.drilling.impedance import torsional_frequency
from drillstring.model.build import build
from drillstring.model.prepared import tubes_of, well_of
from drillstring.results.drilling import NOT_TURNING, creep_of, last_part, stall_of, stick_slip
from drillstring.scene.ends import Controller
from drillstring.scene.scene import DrillstringScene
from drillstring.stick_slip.dying_out import CYCLES, brief, dying_out
from tautline.integrators.status import StoppedEarly
from tautline.integrators.time_loop import compile_for
from tautline.processes import FreshProcesses, without_current_folder
from tautline.run import Run
from tautline.scene.errors import SceneError
from tautline.scene.model import validate
from tautline.scene.reading.document import Document, Path_
from tautline.simulation import simulate

START_PERIODS = 1.0
"""Time in which a drive comes to its speed, over the period of the string's first torsional mode."""
NOT_RUN = "not run"


class Cell(NamedTuple):
    """One run, in SI; numbers of a run that did not come to its end are NaN, and the severity of a bit that rocks,
    does not turn, first turns in the part of the run that is judged, or whose starting transient has not decayed.

    Rotary speed and weight asked for; of the bit's rotary speed severity, share of time stuck, mean, least and largest;
    means of torque on bit, weight on bit and rate of penetration; how it ended, and why if early; run time; the torque
    at which its drive stalls, NaN if it does not; whether the bit first turned in the part that is judged; whether
    that part is too short to show a swing; of a transient that has not decayed the severity so far, and the length of
    run that is enough, NaN of another.
    """

    speed: float
    weight: float
    severity: float
    stuck: float
    mean: float
    least: float
    largest: float
    torque: float
    weight_mean: float
    rate: float
    status: str
    sentence: str
    wall_time: float
    stall: float = math.nan
    late: bool = False
    short: bool = False
    so_far: float = math.nan
    enough: float = math.nan

    @property
    def told(self) -> str:
        """The severity in figures, or that there is none."""
        if not self.turns:
            return "not turning"
        if self.late or self.short:
            return "too short"
        if self.dies_out:
            return "dying out"
        return "rocks" if math.isnan(self.severity) else f"{self.severity:.2f}"

    @property
    def turns(self) -> bool:
        """Whether the bit turns at all in the part that is judged; False where that is not known."""
        return max(self.largest, -self.least) > NOT_TURNING * self.speed

    @property
    def judged(self) -> bool:
        """Whether the run tells if the bit sticks: it came to its end, and the bit had begun to turn by its half."""
        return self.status == "done" and self.turns and not self.late and not self.short

    @property
    def dies_out(self) -> bool:
        """Whether the swing of a bit that comes to turn steadily still falls: its severity is not known yet."""
        return self.judged and not math.isnan(self.so_far)

    @property
    def sticks(self) -> bool:
        """Whether a bit that turns comes to rest; False where that is not known, and where it no longer does."""
        return self.judged and self.stuck > 0.0 and not self.dies_out

    @property
    def verdict(self) -> str:
        """What the run shows, in words; empty for one that did not come to its end."""
        if self.status != "done":
            return ""
        if not self.judged or self.dies_out or math.isnan(self.severity):
            return self.told
        return "sticks" if self.sticks else "does not stick"


NUMBERS = ("severity", "stuck", "mean", "least", "largest", "torque", "weight_mean", "rate", "so_far", "enough")
"""Fields of a cell that a run tells."""
FOUND = NUMBERS.index("rate") + 1
"""How many of them each cell must be given: they stand before its status."""


@dataclass(frozen=True)
class Map:
    """Cells in rows of one weight, each by rising speed; ``interrupted`` if some were not run."""

    speeds: tuple[float, ...]
    weights: tuple[float, ...]
    cells: tuple[tuple[Cell, ...], ...]
    interrupted: bool = False

    def values(self, name: str) -> np.ndarray:
        """One field of all cells, (weights, speeds)."""
        return np.array([[getattr(cell, name) for cell in row] for row in self.cells])

    def ends(self) -> list[tuple[float | None, float | None]]:
        """For each weight the highest speed that sticks and the lowest above it that does not; None where none does."""
        found = []
        for row in self.cells:
            known = [cell for cell in row if cell.judged]
            sticking = [cell.speed for cell in known if cell.sticks]
            highest = max(sticking) if sticking else None
            above = [cell.speed for cell in known if highest is None or cell.speed > highest]
            found.append((highest, min(above) if above else None))
        return found

    @property
    def failures(self) -> list[Cell]:
        """Cells whose run stopped early."""
        return [cell for row in self.cells for cell in row if cell.status not in ("done", NOT_RUN)]


def require_bit(scene: DrillstringScene) -> None:
    """Raise SceneError where the scene has no bit whose torque could make it stick."""
    if not scene.bit.on_bottom:
        cause = "a bit that hangs has no torque"
        raise SceneError([scene.problem("bit.on_bottom", cause, "set it to true, with weight and torque")])
    if scene.bit.torque is None and scene.bit.cutting is None:
        cause = "gives no torque, without which nothing sticks"
        raise SceneError([scene.problem("bit", cause, "add torque: {static: 7 kN m, kinetic: 4 kN m}, or cutting")])


def period_of(scene: DrillstringScene) -> float:
    """Period of the string's first torsional mode, s."""
    return 1.0 / torsional_frequency(tubes_of(scene, well_of(scene).length))


def varied(scene: DrillstringScene, speed: float, weight: float, end: float | None = None) -> DrillstringScene:
    """The scene with its string at rest, coming to a rotary speed, rad/s, with a weight on bit, N, for `end` s.

    Torque and rate of penetration stay the laws that the scene gives; the block follows the rate.

    Raises
    ------
    SceneError
        For a scene that was not read from a text, and as the reader does.
    """
    well = well_of(scene)
    tubes = tubes_of(scene, well.length)
    period = period_of(scene)
    end = max(scene.solver.end, CYCLES * period) if end is None else end
    ramp = {"to": speed, "over": min(START_PERIODS * period, 0.25 * end)}
    turning: Path_ = ("top", "rotation")
    if isinstance(scene.top.rotation, Controller):
        turning = (*turning, "controller", "speed")
    bit = scene.bit
    values: dict[Path_, Any] = {turning: {"ramp": ramp}, ("bit", "weight"): weight, ("solver", "end"): end}
    for key in ("torque", "penetration"):
        law = getattr(bit, key)
        if law is not None:
            values["bit", key, "weight"] = law.weight or bit.weight
    if bit.penetration is not None or bit.cutting is not None:
        rate = rate_at(bit_row(bit, scene.well.diameter, tubes, speed, False)[0], weight, speed)
        values["top", "block"] = {"velocity": {"ramp": ramp | {"to": rate}}} if rate > 0.0 else 0.0
    return scene.varied(values, "stick-slip")


def run_cell(scene: DrillstringScene, speed: float, weight: float, end: float | None) -> Cell:
    """Run one cell; what stops it early is told in its status."""
    begun = time.perf_counter()
    try:
        result = simulate(build(varied(scene, speed, weight, end)))
    except StoppedEarly as stop:
        status, told = (
            stop.status.name.lower().replace("_", " "),
            f"t = {stop.time:.4g} s, {stop.part}: {stop.sentence}",
        )
        return _empty(speed, weight, status, told, time.perf_counter() - begun)
    except SceneError as error:
        return _empty(speed, weight, "bad input", str(error), time.perf_counter() - begun)
    last, spin = last_part(result.time), result["rotation_rate"][:, -1]
    found = stick_slip(result.time, spin, creep_of(scene))
    hole, seconds = result["hole_depth"][last], result.time[last]
    rate = float((hole[-1] - hole[0]) / (seconds[-1] - seconds[0])) if seconds.size > 1 else math.nan
    period = period_of(scene)
    fading = dying_out(result.time, spin, period, creep_of(scene))
    # A bit that comes to rest in a brief run sticks, as far as it shows: on the safe side.
    short = found["stuck"] == 0.0 and brief(result.time, period)
    cell = Cell(
        speed, weight, found["severity"], found["stuck"], found["mean"], found["least"], found["largest"],
        float(result["torque_on_bit"][last].mean()), float(result["weight_on_bit"][last].mean()),
        rate, "done", "", time.perf_counter() - begun,
        late=not (np.abs(spin[~last]) > NOT_TURNING * speed).any(), short=short,
    )  # fmt: skip
    if cell.judged:
        return cell._replace(severity=math.nan, so_far=fading[0], enough=fading[1]) if fading else cell
    return cell._replace(severity=math.nan, stall=math.nan if cell.turns else stall_of(result, speed))


def _empty(speed: float, weight: float, status: str = NOT_RUN, sentence: str = "", wall: float = 0.0) -> Cell:
    return Cell(speed, weight, *[math.nan] * FOUND, status, sentence, wall)


def stick_slip_map(
    scene: DrillstringScene,
    speeds: Sequence[float],
    weights: Sequence[float],
    end: float | None = None,
    jobs: int | None = None,
    progress: Callable[[int, int], None] | None = None,
    announce: Callable[[int], Any] | None = None,
) -> Map:
    """Run the scene at all speeds and weights.

    Parameters
    ----------
    scene : DrillstringScene
        Read from a file, with a bit on bottom and its torque.
    speeds, weights : sequence of float
        Rotary speeds rad/s, weights on bit N.
    end : float, optional
        Length of every run, s; that of the scene, or twenty periods of the string's first torsional mode if more.
    jobs : int, optional
        Processes; as many as there are cores if None. With one all is done in this process.
    progress, announce : callable, optional
        Called with the number of cells done and that of all; with that of what is to be compiled first.

    Returns
    -------
    Map
        With the cells that were run where it was interrupted by Ctrl-C.

    Raises
    ------
    SceneError
        For a scene without such a bit, and where the first cell cannot be built.
    """
    require_bit(scene)
    speeds, weights = tuple(sorted(set(speeds))), tuple(sorted(set(weights)))
    cells = {(w, s): _empty(s, w) for w in weights for s in speeds}
    # What is compiled here is loaded by all: they share the cache.
    first = Run(build(varied(scene, speeds[0], weights[0], end)))
    compile_for(first.method, first.model.system, first.state, announce)
    jobs = min(jobs or os.cpu_count() or 1, len(cells))
    done, interrupted = 0, False
    try:
        for cell in _run_all(scene, [(s, w, end) for w in weights for s in speeds], jobs):
            cells[cell.weight, cell.speed] = cell
            done += 1
            if progress is not None:
                progress(done, len(cells))
    except KeyboardInterrupt:
        interrupted = True
    return Map(speeds, weights, tuple(tuple(cells[w, s] for s in speeds) for w in weights), interrupted)


def _run_all(scene: DrillstringScene, asked: Sequence[tuple[float, float, float | None]], jobs: int) -> Iterator[Cell]:
    """Cells as they are done."""
    if jobs == 1:
        for one in asked:
            yield run_cell(scene, *one)
        return
    assert scene.document is not None
    with _processes(scene.document, jobs) as pool:
        waiting = {pool.submit(_work, *one): one for one in asked}
        for future in as_completed(waiting):
            speed, weight, _ = waiting[future]
            try:
                yield future.result()
            except BrokenProcessPool:
                yield _empty(speed, weight, "process died", "its process was killed: less memory with fewer --jobs")


@contextmanager
def _processes(document: Document, jobs: int) -> Iterator[Executor]:
    """Fresh processes that have read the scene; on the way out what waits is given up."""
    # A process is started when there is work for it, and one beside them as soon as there is a pool.
    with without_current_folder():
        pool = ProcessPoolExecutor(jobs, FreshProcesses(), initializer=_read, initargs=(document,))
    try:
        yield pool
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


_scene: list[DrillstringScene] = []
"""The scene of a process."""


def _read(document: Document) -> None:
    # Ctrl-C is for the process that waits; it takes back what has not begun.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _scene[:] = [validate(DrillstringScene, document)]


def _work(speed: float, weight: float, end: float | None) -> Cell:
    return run_cell(_scene[0], speed, weight, end)
