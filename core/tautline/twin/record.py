"""Synthetic records: a scene run with sensors, noise, bias, delays and dropouts, to rehearse a twin with.

What a sensor shows at t is what the simulation has at t less the sensor's delay, scaled as the map says, with noise and
its faults. The simulation is that of the scene: what it moves, it moves by its own functions of time.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tautline.live.simulation import Simulation
from tautline.scene.errors import option_error
from tautline.scene.refusal import nearest
from tautline.twin.map.check import checked
from tautline.twin.map.file import TwinMap
from tautline.twin.map.plan import Channel, Plan
from tautline.twin.operation import Operation, findings

KINDS = ("stuck", "lost", "bias", "drift", "scale", "clip", "spike")
"""Faults of a sensor."""
SIZED = ("bias", "drift", "scale", "clip", "spike")
"""Those that say nothing without a size."""
MOST_ROWS = 1.0e8
"""Rows that a record may have."""
EXAMPLE = "write COLUMN:KIND:FROM:TO[:SIZE], such as rope_tension:bias:4:8:5"
NOISE_EXAMPLE = "write COLUMN:SIZE in the unit of the column, such as winch_pos:0.001"
GAP_EXAMPLE = "write FROM:TO in s, such as 4:8"


@dataclass(frozen=True)
class Fault:
    """What goes wrong with a sensor between two times, s; the size is in the column's unit."""

    column: str
    kind: str
    begin: float
    end: float
    size: float = 0.0


@dataclass
class Sensing:
    """How sensors show what there is.

    Attributes
    ----------
    rate : float
        Rows a second.
    noise : float or None
        Standard deviation of measured outputs as a share of their value, 0 for none; None for that of the map, which
        inputs have in any case.
    input_noise : mapping
        Column of an input -> its standard deviation in the unit of the column, instead of that of the map.
    dropout : float
        Share of rows that do not arrive.
    jitter : float
        Standard deviation of the stamps, s.
    delay : float
        Of all measured outputs, s.
    gaps : sequence of (float, float)
        Times without rows, s.
    faults : sequence of Fault
        What goes wrong with single columns, and when.
    seed : int
        Of noise, dropout and jitter: the same seed makes the same rows.
    """

    rate: float = 10.0
    noise: float | None = None
    dropout: float = 0.0
    jitter: float = 0.0
    delay: float = 0.0
    input_noise: Mapping[str, float] = field(default_factory=dict)
    gaps: Sequence[tuple[float, float]] = ()
    faults: Sequence[Fault] = ()
    seed: int = 0
    _held: dict[str, float] = field(default_factory=dict)

    def shown(self, column: str, time: float, value: float, rng: np.random.Generator) -> float:
        """What a sensor with its faults shows."""
        for one in self.faults:
            if one.column != column or not one.begin <= time < one.end:
                continue
            if one.kind == "stuck":
                value = self._held.setdefault(f"{column} {one.begin}", value)
            elif one.kind == "lost":
                value = np.nan
            elif one.kind == "bias":
                value += one.size
            elif one.kind == "drift":
                value += one.size * (time - one.begin)
            elif one.kind == "scale":
                value *= one.size
            elif one.kind == "clip":
                value = min(value, one.size)
            elif one.kind == "spike" and rng.random() < 0.1:
                value += one.size
        return value


def record(
    scene: Any, map: TwinMap, sensing: Sensing, end: float | None = None
) -> Iterator[tuple[float, dict[str, float]]]:
    """Rows of a record: stamp, s, and readings by column, in the units of the map.

    Raises
    ------
    SceneError
        For a map that does not fit the scene, and for an end beyond what the scene moves by itself.
    StoppedEarly
        Where the simulation stops.
    """
    from tautline import read
    from tautline.application.installed import Installed

    scene = scene if hasattr(scene, "document") else read(scene)
    own = getattr(Installed().of(scene), "operation", None)
    operation: Operation | None = own(scene, None) if own else None
    plan, _, sim = checked(map, scene, operation.signals if operation else {}, dict.fromkeys(findings(operation), ""))
    rng = np.random.default_rng(sensing.seed)
    known = {one.column for one in plan.channels}
    for fault in sensing.faults:
        if fault.column not in known:
            raise option_error("--fault", fault.column, "there is no such column", nearest(fault.column, sorted(known)))
    driving = {one.column for one in plan.channels if one.is_input}
    for column in sensing.input_noise:
        if column not in driving:
            raise option_error("--input-noise", column, "is no column of an input", nearest(column, sorted(driving)))
    last = sim.model.solver.end if end is None else end
    if last * sensing.rate > MOST_ROWS:
        cause = f"is {last * sensing.rate:.2g} rows, and a record has {MOST_ROWS:.0e} at most"
        raise option_error("--rate", f"{sensing.rate:g}", cause, "give fewer rows a second, or an earlier --end")
    until, key = sim.known_until
    if last > until + 1e-9:
        cause = f"is later than what the scene moves by itself: {key} is known up to {until:g} s only"
        raise option_error("--end", f"{last:g} s", cause, "give an earlier one, or the scene a later solver.end")
    final = int(np.floor(last * sensing.rate + 1e-9))
    _check_times(sensing, final)
    earlier: deque[tuple[float, np.ndarray]] = deque()
    for k in range(final + 1):
        time = k / sensing.rate
        if time > sim.time:
            sim.advance_to(time)
        earlier.append((time, _values(sim, plan, operation)))
        while len(earlier) > 1 and earlier[1][0] <= time - sensing.delay + 1e-9:
            earlier.popleft()
        noisy = _noisy(plan.channels, _values(sim, plan, operation), earlier[0][1], sensing, rng)
        readings = {
            one.column: sensing.shown(one.column, time, value / one.scale + one.zero, rng)
            for one, value in zip(plan.channels, noisy, strict=True)
        }
        stamp = time + sensing.jitter * rng.standard_normal()
        arrives = rng.random() >= sensing.dropout and not any(a <= time < b for a, b in sensing.gaps)
        if arrives:
            yield stamp, readings


def _check_times(sensing: Sensing, final: int) -> None:
    """Refuse a fault and a gap in which no row lies, of rows 0 to ``final``: a rehearsal would pass without it."""
    times = f"rows are from 0 s to {final / sensing.rate:g} s, {sensing.rate:g} a second"
    for one in sensing.faults:
        if not _has_row(one.begin, one.end, sensing.rate, final):
            given = f"{one.column}:{one.kind}:{one.begin:g}:{one.end:g}"
            cure = f"give times in which there are rows, or a later --end; {times}"
            raise option_error("--fault", given, "changes nothing: no row lies in these times", cure)
    for begin, end in sensing.gaps:
        if not _has_row(begin, end, sensing.rate, final):
            cure = f"give times in which there are rows, or a later --end; {times}"
            raise option_error("--gap", f"{begin:g}:{end:g}", "leaves nothing out: no row lies in these times", cure)


def _has_row(begin: float, end: float, rate: float, final: int) -> bool:
    """Whether begin <= k / rate < end for one of the rows k = 0 to ``final``."""
    if not begin < end or begin > (final + 1.0) / rate:
        return False
    first = int(np.floor(max(begin, 0.0) * rate))
    return any(begin <= k / rate < end for k in range(max(first - 1, 0), min(first + 2, final) + 1))


def _values(sim: Simulation, plan: Plan, operation: Operation | None) -> np.ndarray:
    """What sensors without faults would show (c,); NaN for what the scene knows nothing of, such as pumps."""
    signals = operation.simulated(sim) if operation else {}

    def value(one: Channel) -> float:
        if one.is_input:
            return float(sim.inputs[one.name])
        return float(sim[one.name]) if one.is_output else signals.get(one.name, np.nan)

    return np.array([value(one) for one in plan.channels])


def _noisy(
    channels: Sequence[Channel], now: np.ndarray, before: np.ndarray, sensing: Sensing, rng: np.random.Generator
) -> np.ndarray:
    """Values with their noise; outputs are those of the delay ago."""
    values = np.array([a if c.is_input else b for c, a, b in zip(channels, now, before, strict=True)])
    size = np.array([c.sd * (abs(v) if c.relative else 1.0) for c, v in zip(channels, values, strict=True)])
    size = np.where(np.isfinite(size), size, 0.0)
    if sensing.noise is not None:
        measured = np.array([c.is_output for c in channels])
        size = np.where(measured, sensing.noise * np.abs(values), size)
    for k, one in enumerate(channels):
        if one.column in sensing.input_noise:
            size[k] = abs(one.scale) * sensing.input_noise[one.column]
    return values + size * rng.standard_normal(len(values))


def read_fault(text: str) -> Fault:
    """A fault as it is written in the option; raises SceneError."""
    parts = text.split(":")
    kind = parts[1] if len(parts) > 1 else ""
    if len(parts) not in (4, 5) or kind not in KINDS:
        meant = nearest(kind, KINDS)
        cure = f"{meant}{' ' if meant.endswith('?') else '; '}{EXAMPLE}" if len(parts) > 1 else EXAMPLE
        raise option_error("--fault", text, "is no fault of a sensor", cure)
    try:
        begin, end = float(parts[2]), float(parts[3])
        size = float(parts[4]) if len(parts) == 5 else None
    except ValueError:
        raise option_error("--fault", text, "has a time or a size that is no number", EXAMPLE) from None
    if not begin < end:
        raise option_error("--fault", text, "ends before it begins", EXAMPLE)
    if kind in SIZED and (size is None or not np.isfinite(size)):
        raise option_error("--fault", text, f"has no size, which {kind} needs", f"write {':'.join(parts[:4])}:5")
    if kind not in SIZED and size is not None:
        raise option_error("--fault", text, f"has a size, and {kind} has none", f"write {':'.join(parts[:4])}")
    return Fault(parts[0], kind, begin, end, size or 0.0)


def read_input_noise(text: str) -> tuple[str, float]:
    """Column and standard deviation of a noise as they are written in the option; raises SceneError."""
    column, _, size = text.rpartition(":")
    try:
        sd = float(size)
    except ValueError:
        sd = np.nan
    if not column or not np.isfinite(sd) or sd < 0.0:
        raise option_error("--input-noise", text, "is no noise of an input", NOISE_EXAMPLE)
    return column, sd


def read_gap(text: str) -> tuple[float, float]:
    """Begin and end of times without rows, s, as they are written in the option; raises SceneError."""
    try:
        begin, end = (float(part) for part in text.split(":"))
    except ValueError:
        raise option_error("--gap", text, "is no gap", GAP_EXAMPLE) from None
    if not (np.isfinite(begin) and np.isfinite(end)):
        raise option_error("--gap", text, "is no gap", GAP_EXAMPLE)
    if not begin < end:
        raise option_error("--gap", text, "ends before it begins", GAP_EXAMPLE)
    return begin, end
