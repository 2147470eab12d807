"""A vessel's six motions: functions of time of their own, a record, or the response to one common sea.

In a sea, every wave of `tautline.system.time_functions.jonswap` moves the vessel by the response amplitude operators
of a CSV file. All six motions share the wave's phase, so that heave and pitch of a bow that meets a crest fit together.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from crane.sea.frames import GROUND, MOTIONS, Frame, boom
from crane.sea.mru import ANGLES, read_motions
from tautline.scene.errors import Problem, SceneError
from tautline.scene.functions import Constant, Harmonic, Spectrum, Sum
from tautline.scene.reading.columns import Columns
from tautline.system.time_functions import jonswap

VESSEL, BELOW = "vessel", "ground"
BY_KEY = "give `direction:` beside `rao:`"
"""How a scene asks for a direction of its file of responses; a command that has an option for it names that."""
OUTSIDE = 0.05
"""Share of a sea's energy that may lie at frequencies of which the table says nothing."""
LARGEST_RESPONSE = {True: 1.0, False: 30.0}
"""Of a rotation, rad/m, and of a displacement, m/m, that a vessel may have."""
FREQUENCY_UNITS = {"rad/s": 1.0, "1/s": 1.0, "hz": 2.0 * math.pi, "mhz": 2e-3 * math.pi}


class Boom(Protocol):
    """A frame as the scene gives it."""

    name: str
    pivot: tuple[float, ...]
    parent: str | None
    slew: Any
    luff: Any


class Ship(Protocol):
    """A vessel as the scene gives it.

    `motion` has the six motions; or `file`, `units`, `gap` (and `ramp`, `begin`); or `sea`, `rao` (and `direction`).
    """

    reference: tuple[float, ...]
    motion: Any


@dataclass(frozen=True, eq=False)
class Response:
    """Response amplitude operators at some frequencies.

    Attributes
    ----------
    path : Path
        The file.
    frequency : float64 (n,)
        Increasing, rad/s.
    amplitude, phase : dict of str to float64 (n,)
        By motion: m/m or rad/m, and the lead over the wave at the vessel's reference, rad, without jumps of 2 pi.
    written : dict of str to float64 (n,)
        The phase as the file has it, rad.
    """

    path: Path
    frequency: np.ndarray
    amplitude: Mapping[str, np.ndarray]
    phase: Mapping[str, np.ndarray]
    written: Mapping[str, np.ndarray]


def motions_of(vessel: Ship, folder: str | Path, end: float) -> tuple[Any, ...]:
    """Six functions of time, in the order of `crane.sea.frames.MOTIONS`, m and rad.

    Parameters
    ----------
    vessel : Ship
        As the scene gives it.
    folder : str or Path
        That its files are named from.
    end : float
        Time to which the run goes, s.

    Raises
    ------
    SceneError
        For faults of a file, by line, and for responses that no vessel has, by key.
    """
    motion = vessel.motion
    if hasattr(motion, "file"):
        ramp, begin = getattr(motion, "ramp", 0.0), getattr(motion, "begin", 0.0)
        return read_motions(Path(folder) / motion.file, end, motion.units, motion.gap, ramp, begin)
    if hasattr(motion, "sea"):
        response = read_response(Path(folder) / motion.rao, getattr(motion, "direction", None))
        return in_sea(motion.sea, response)
    moved = {name: getattr(motion, name) for name in MOTIONS}
    if problems := [one for name in MOTIONS for one in _too_large(name, moved[name], f"vessel.motion.{name}")]:
        raise SceneError(problems)
    return tuple(moved.values())


def _too_large(name: str, function: Any, key: str) -> Iterator[Problem]:
    """Responses of a motion to seas of its own that no vessel has, at their keys; those of a file are judged alike."""
    if isinstance(function, Spectrum) and abs(function.rao) > LARGEST_RESPONSE[name in ANGLES]:
        unit, other = ("rad/m", "deg/m") if name in ANGLES else ("m/m", "mm/m")
        cause = f"is more than any vessel's, {LARGEST_RESPONSE[name in ANGLES]:g} {unit}"
        cure = f"give {name} per metre of wave in {unit}, or write the unit, such as {other}"
        yield Problem("", None, f"{key}.spectrum.rao", None, cause, cure)
    for i, term in enumerate(function.terms if isinstance(function, Sum) else ()):
        yield from _too_large(name, term, f"{key}.sum[{i}]")


def frames_of(
    vessel: Ship | None, booms: Sequence[Boom], folder: str | Path, end: float
) -> tuple[tuple[Frame, ...], dict[str, int]]:
    """Frames of a scene, parents before children.

    Parameters
    ----------
    vessel : Ship or None
        As the scene gives it.
    booms : sequence of Boom
        Frames of the scene; one without a parent stands on the vessel if there is one, else on the ground.
    folder, end
        As of `motions_of`.

    Returns
    -------
    frames : tuple of Frame
        The vessel first, if there is one.
    places : dict of str to int
        Place of each name in them: ``vessel``, those of the scene, and ``ground`` (`GROUND`).

    Raises
    ------
    SceneError
        For faults of the vessel's files.
    ValueError
        If a parent is unknown, or frames stand on each other in a ring.
    """
    frames: list[Frame] = []
    places = {BELOW: GROUND}
    if vessel is not None:
        places[VESSEL] = 0
        motions = motions_of(vessel, folder, end)
        frames.append(Frame(VESSEL, GROUND, _three(vessel.reference), motions, key="vessel.motion"))
    waiting = list(enumerate(booms))
    while waiting:
        left = []
        for i, item in waiting:
            parent = item.parent or (VESSEL if vessel is not None else BELOW)
            if parent not in places:
                left.append((i, item))
                continue
            places[item.name] = len(frames)
            key = f"frames[{i}]"
            frames.append(boom(item.name, places[parent], _three(item.pivot), item.slew, item.luff, key))
        if len(left) == len(waiting):
            raise ValueError(f"what does frame {left[0][1].name} stand on?")
        waiting = left
    return tuple(frames), places


def _three(point: Sequence[float]) -> tuple[float, float, float]:
    x, y, z = point
    return float(x), float(y), float(z)


def in_sea(sea: Spectrum, response: Response) -> tuple[Sum | Constant, ...]:
    """Six motions of a vessel in a sea.

    A wave ``a sin(w t + phi)`` at the reference makes the motion ``a A(w) sin(w t + phi + delta(w))``. Amplitude A and
    phase delta are interpolated between frequencies; below the first they are held, above the last there is no
    response. `sea.rao` is not used.

    Raises
    ------
    SceneError
        If more than a twentieth of the sea's energy lies at frequencies outside the table.
    """
    amplitude, frequency, phase = jonswap(sea.model_copy(update={"rao": 1.0}))
    table = response.frequency
    outside = (frequency < table[0]) | (frequency > table[-1])
    energy = float((amplitude**2).sum())
    share = float((amplitude[outside] ** 2).sum()) / energy if energy > 0.0 else 0.0
    if share > OUTSIDE:
        sheet = Columns(response.path, headed=True)
        cause = f"the table goes from {table[0]:.4g} to {table[-1]:.4g} rad/s, "
        cause += f"and {100.0 * share:.3g} % of the sea's energy lies outside"
        cure = f"add rows, {frequency[0]:.3g} to {frequency[-1]:.3g} rad/s, or check the unit of the frequency"
        raise SceneError([sheet.problem(sheet.header_line, "frequency", None, cause, cure)])
    motions: list[Sum | Constant] = []
    for name in MOTIONS:
        if name not in response.amplitude:
            motions.append(Constant(value=0.0))
            continue
        size = amplitude * np.interp(frequency, table, response.amplitude[name], right=0.0)
        angle = phase + np.interp(frequency, table, response.phase[name])
        waves = [
            Harmonic(amplitude=float(a), frequency=float(w) / (2.0 * math.pi), phase=float(phi), ramp=sea.ramp)
            for a, w, phi in zip(size, frequency, angle, strict=True)
            if a != 0.0
        ]
        motions.append(Sum(terms=tuple(waves)) if waves else Constant(value=0.0))
    return tuple(motions)


def read_response(path: str | Path, direction: float | None = None) -> Response:
    """Read response amplitude operators.

    Columns are ``frequency [rad/s]`` (or Hz) or ``period [s]``, and for each motion that there is, ``heave [m/m]``
    and ``heave phase [deg]``; rotations in rad/m or deg/m. A phase is a lead over the wave; headed ``heave lag`` it is
    a lag. A file for several directions of the sea has ``direction [deg]`` as well.

    Parameters
    ----------
    path : str or Path
        CSV file.
    direction : float, optional
        Which rows are taken, rad, of a file for several directions; -90 deg is 270 deg.

    Raises
    ------
    SceneError
        With a Problem for each fault: an unknown, missing or repeated column, a unit that is missing or another's, a
        cell that is no number, a response that is negative or larger than any vessel's, a frequency that is not
        positive or given twice, fewer than two frequencies, a direction that the file does not hold.
    """
    sheet = Columns(path, headed=True)
    found = _columns(sheet)
    frequency = _frequency(sheet, found)
    amplitude, phase = {}, {}
    for name in MOTIONS:
        if (name, "amplitude") not in found:
            continue
        per_metre, default = ("rad/m", None) if name in ANGLES else ("m/m", "m/m")
        column = found[name, "amplitude"]
        amplitude[name] = sheet.factor(column, name, per_metre, None, default) * sheet.numbers(column[0], name)
        _check_size(sheet, name, amplitude[name])
        how = "phase" if (name, "phase") in found else "lag"
        column = found[name, how]
        factor = sheet.factor(column, f"{name} {how}", "rad")
        phase[name] = (1.0 if how == "phase" else -1.0) * factor * sheet.numbers(column[0], f"{name} {how}")
    rows = _rows_of_direction(sheet, found, direction)
    sheet.raise_if_any()
    order = rows[np.argsort(frequency[rows], kind="stable")]
    _check_frequencies(sheet, frequency, order)
    sheet.raise_if_any()
    return Response(
        sheet.path,
        frequency[order],
        {name: column[order] for name, column in amplitude.items()},
        {name: np.unwrap(column[order]) for name, column in phase.items()},
        {name: column[order] for name, column in phase.items()},
    )


def _columns(sheet: Columns) -> dict[tuple[str, ...], tuple[int, str]]:
    """What each column is, all of them known and each motion with its phase."""
    names: dict[str, tuple[str, ...]] = {
        "frequency": ("frequency",),
        "period": ("period",),
        "direction": ("direction",),
    }
    for name in MOTIONS:
        names |= {f"{name}{word}": (name, "amplitude") for word in ("", " amplitude", " amp", " rao")}
        names |= {f"{name} phase": (name, "phase"), f"{name} lag": (name, "lag")}
    found = sheet.find(names)
    if not found:
        sheet.refuse_title_lines()
    known = {place for place, _ in found.values()}
    for place, title in enumerate(sheet.names):
        if place not in known and title:
            cure = "write headers such as: frequency [rad/s], heave [m/m], heave phase [deg], roll [deg/m]"
            sheet.problems.append(sheet.problem(sheet.header_line, title, None, "no such column", cure))
    motions = [name for name in MOTIONS if (name, "amplitude") in found]
    if not motions:
        cure = "add columns such as heave [m/m] and heave phase [deg]"
        sheet.problems.append(sheet.problem(sheet.header_line, "", None, "there is no motion", cure))
    for name in MOTIONS:
        phases = [how for how in ("phase", "lag") if (name, how) in found]
        if (name in motions) != (len(phases) == 1):
            cause = "has no column of its phase" if name in motions and not phases else "has no column of its amplitude"
            cause = "has a phase and a lag" if len(phases) == 2 else cause
            cure = f"give the two columns {name} and {name} phase [deg]"
            sheet.problems.append(sheet.problem(sheet.header_line, name, None, cause, cure))
    if (("frequency",) in found) == (("period",) in found):
        cure = "give one of frequency [rad/s], frequency [Hz] and period [s]"
        cause = "is given together with period" if ("period",) in found else "there is no such column"
        sheet.problems.append(sheet.problem(sheet.header_line, "frequency", None, cause, cure))
    sheet.raise_if_any()
    return found


def _frequency(sheet: Columns, found: Mapping[tuple[str, ...], tuple[int, str]]) -> np.ndarray:
    """Frequency of each row, rad/s."""
    name = "period" if ("period",) in found else "frequency"
    column = found[(name,)]
    values = sheet.numbers(column[0], name)
    for line, value in zip(sheet.lines, values, strict=True):
        if value <= 0.0:
            sheet.problems.append(sheet.problem(line, name, f"{value:g}", "is not positive", "give one above zero"))
    if name == "period":
        with np.errstate(divide="ignore"):
            return 2.0 * math.pi / (sheet.factor(column, name, "s", None, "s") * values)
    # hertz and radians per second are both 1/s to a table of units
    unit = re.sub(r"\s", "", column[1]).lower()
    if unit not in FREQUENCY_UNITS:
        cause = f"'{column[1]}' is not a unit of frequency" if unit else "no unit: rad/s or Hz?"
        sheet.problems.append(
            sheet.problem(sheet.header_line, name, None, cause, "write frequency [rad/s] or frequency [Hz]")
        )
    return FREQUENCY_UNITS.get(unit, 1.0) * values


def _check_size(sheet: Columns, name: str, amplitude: np.ndarray) -> None:
    """Note responses that are negative, or so large that the unit must be another; one a column."""
    angle = name in ANGLES
    for wrong, cause, cure in (
        (amplitude < 0.0, "is negative", "give its size, and 180 deg more in the phase"),
        (amplitude > LARGEST_RESPONSE[angle], "is more than any vessel's", f"check the unit in the header of {name}"),
    ):
        if np.any(wrong):
            row = int(np.argmax(wrong))
            value = f"{amplitude[row]:.4g} {'rad/m' if angle else 'm/m'}"
            sheet.problems.append(sheet.problem(sheet.lines[row], name, value, cause, cure))


def _rows_of_direction(
    sheet: Columns, found: Mapping[tuple[str, ...], tuple[int, str]], direction: float | None
) -> np.ndarray:
    """Rows of the direction asked for; all of a file that has no directions."""
    everything = np.arange(len(sheet.lines))
    if ("direction",) not in found:
        if direction is not None:
            cure = "remove `direction:`, or name a file that has the column direction [deg]"
            sheet.problems.append(sheet.problem(sheet.header_line, "direction", None, "there is no such column", cure))
        return everything
    column = found[("direction",)]
    held = sheet.factor(column, "direction", "rad") * sheet.numbers(column[0], "direction")
    directions = np.unique(held[np.isfinite(held)])
    if direction is None and directions.size == 1:
        return everything
    rows = everything if direction is None else np.flatnonzero(_same_direction(held, directions, direction))
    if direction is None or not rows.size:
        listed = ", ".join(f"{math.degrees(x):.5g}" for x in directions[:12])
        cause = "none is asked for" if direction is None else f"{math.degrees(direction):.5g} deg is not in the file"
        cure = f"{BY_KEY}, one of {listed} deg"
        sheet.problems.append(sheet.problem(sheet.header_line, "direction", None, cause, cure))
    return rows


def _same_direction(held: np.ndarray, directions: np.ndarray, asked: float) -> np.ndarray:
    """Which rows are of the direction asked for, whole turns apart or not.

    Of directions of a file that are the same, such as 0 and 360 deg, one is taken: as it is written, or the first.
    """
    turns = (directions - asked) / (2.0 * math.pi)
    same = directions[np.abs(turns - np.round(turns)) < 1e-6 / (2.0 * math.pi)]
    if not same.size:
        return np.zeros(held.size, dtype=bool)
    return np.abs(held - same[np.argmin(np.abs(same - asked) > 1e-6)]) < 1e-6


def _check_frequencies(sheet: Columns, frequency: np.ndarray, order: np.ndarray) -> None:
    """Note a table of one frequency, and frequencies that it has twice."""
    if order.size < 2:
        cause, cure = f"{order.size} row of frequencies is no table", "give two at least"
        sheet.problems.append(sheet.problem(sheet.lines[order[0]], "frequency", None, cause, cure))
    for first, second in itertools.pairwise(order):
        if frequency[second] <= frequency[first] * (1.0 + 1e-12):
            cause = f"the same frequency as line {sheet.lines[first]}"
            value = f"{frequency[second]:.6g} rad/s"
            sheet.problems.append(sheet.problem(sheet.lines[second], "frequency", value, cause, "keep one of the two"))
