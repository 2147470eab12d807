"""Functions of time as written in a scene, compiled to the arrays that `tautline.kernels.time_function` evaluates.

A velocity from which a position is wanted is integrated in closed form: polynomials and plain sines exactly. A chirp
or a sine under an envelope has no elementary integral; it is integrated by Gauss quadrature and stored as quintic
Hermite pieces (relative error below 1e-9, tested).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from tautline.errors import ArgumentError, ArgumentTypeError
from tautline.kernels.hermite import gauss
from tautline.kernels.moving_frame import Lifts, new_frames
from tautline.kernels.time_function import DEGREES, TERMS, LongSums, TimeFunctions
from tautline.scene.curves import hermite, slopes
from tautline.scene.errors import Problem, SceneError
from tautline.scene.functions import Chirp, Constant, Harmonic, Ramp, Spectrum, Sum, Table, Velocity

ANGLE_PER_PIECE = 0.05
"""Phase that a piece of a numerical integral spans, rad."""
PIECES_PER_ENVELOPE = 100
MOST_PIECES = 2_000_000
GAUSS_POINTS = 5
"""Of a piece of a numerical integral."""
WAVE_COLUMNS = 5
OVERLAP, OF_PIECE = 1.0e-10, 1.0e-6
"""By how much of its time, and of the piece before it, at most, the piece before the last row goes on behind it: a time
that is a sum of many is beside what was meant by as much."""
MANY_WAVES = 8
"""Waves of one function from which their Taylor series is shorter."""


@dataclass(frozen=True)
class FunctionRequest:
    """A function of time that is wanted.

    Attributes
    ----------
    model
        A model of `tautline.scene.functions`, or `Samples`; a `Velocity` is integrated whatever `integrate` says.
    integrate : bool
        Whether the model is a rate, and its antiderivative that is zero at t = 0 is wanted.
    end : float
        Time up to which a numerical integral is good, s; it goes on at a constant rate after. Only chirps and sines
        under an envelope need it.
    key : str
        Where it stands in the scene, for messages.
    factor : float
        What the function, or its integral, is multiplied by.
    inputs : tuple of Steering
        By which names it can be driven while a run goes on; empty where it cannot.
    """

    model: Any
    integrate: bool = False
    end: float = 0.0
    key: str = ""
    factor: float = 1.0
    inputs: tuple[Steering, ...] = ()


@dataclass(frozen=True)
class Steering:
    """A name by which a function of time is driven while a run goes on.

    Attributes
    ----------
    name : str
        ``winch.pay_out``.
    unit, text : str
        What it is.
    order : int
        0: what is given is the function's value; 1: its rate.
    factor : float
        What it is multiplied by to be that.
    least, most : float
        What may be given.
    zero_at_start : bool
        Whether it is 0 at the start, whatever is given later: what hangs on it is then brought to where it is drawn.
    """

    name: str
    unit: str
    text: str
    order: int = 0
    factor: float = 1.0
    least: float = -math.inf
    most: float = math.inf
    zero_at_start: bool = False


@dataclass(frozen=True, eq=False)
class FrameSet:
    """Frames that move, parents before children.

    Attributes
    ----------
    parent : tuple of int
        Number of the frame that each stands in, -1 for the ground.
    pivot : tuple of 3 float tuples
        What each turns about, m.
    motion : tuple of tuples of 6
        A `FunctionRequest` for each of the motions, None where there is none.
    """

    parent: tuple[int, ...]
    pivot: tuple[tuple[float, float, float], ...]
    motion: tuple[tuple[FunctionRequest | None, ...], ...]


@dataclass(frozen=True, eq=False)
class FrameEntry:
    """One of the twelve numbers that place a frame; it stands in a request in the place of a model."""

    frames: FrameSet
    frame: int
    number: int


@dataclass(frozen=True, eq=False)
class Samples:
    """A function known by its value and both derivatives at some times, such as the motion of a frame.

    Between the times it is the quintic through all six numbers at both ends: C2, in error by
    ``h^6 max|f^(6)| / 46080``. It is constant before the first time and after the last. It stands in a request in the
    place of a model, and may be integrated like one.

    Attributes
    ----------
    time : float64 (n,)
        Increasing, s.
    value, rate, second : float64 (n,)
        The function and its first and second derivative at these times.
    reach : float
        Time up to which it is what it stands for, s: a record ends.

    Raises
    ------
    ArgumentError
        If the arrays differ in length or are empty, a number is not finite, or the times do not increase.
    """

    time: np.ndarray
    value: np.ndarray
    rate: np.ndarray
    second: np.ndarray
    reach: float = math.inf

    def __post_init__(self) -> None:
        columns = [np.asarray(column, dtype=float) for column in (self.time, self.value, self.rate, self.second)]
        for name, column in zip(("time", "value", "rate", "second"), columns, strict=True):
            if column.ndim != 1 or column.size == 0 or column.shape != columns[0].shape:
                raise ArgumentError(f"{name} has the shape {column.shape}: give an entry for each of the times")
            if not np.all(np.isfinite(column)):
                raise ArgumentError(f"{name} is not finite everywhere")
            object.__setattr__(self, name, column)
        if np.any(np.diff(columns[0]) <= 0.0):
            raise ArgumentError("the times do not increase")


@dataclass
class Track:
    """A piecewise polynomial: `breaks` (n,) s, `origins` (n + 1,) s, `coefficients` (n + 1, 8).

    The last break stands `overlap` s behind the last row of what is held from there on.
    """

    breaks: np.ndarray
    origins: np.ndarray
    coefficients: np.ndarray
    overlap: float = 0.0

    @classmethod
    def of(cls, breaks: Any, origins: Any, rows: Any) -> Track:
        """Build from rows of any number of coefficients."""
        coefficients = np.zeros((len(rows), DEGREES))
        for i, row in enumerate(rows):
            coefficients[i, : len(row)] = row
        return cls(np.asarray(breaks, dtype=float), np.asarray(origins, dtype=float), coefficients)

    @classmethod
    def held(cls, time: np.ndarray, rows: np.ndarray, first: float, last: float) -> Track:
        """Pieces between times, about their left ends, and constant before and after.

        At the last time, and within rounding of it, the piece on its left counts: a run that ends there ends in motion.
        """
        coefficients = np.zeros((len(time) + 1, DEGREES))
        coefficients[1:-1, : rows.shape[1]] = rows
        coefficients[0, 0], coefficients[-1, 0] = first, last
        overlap = _overlap(time)
        breaks = np.append(time[:-1], time[-1] + overlap)
        return cls(breaks, np.concatenate((time[:1], time)), coefficients, overlap)

    def value(self, t: float) -> float:
        """Value at a time."""
        piece = int(np.searchsorted(self.breaks, t, side="right"))
        return float(np.polynomial.polynomial.polyval(t - self.origins[piece], self.coefficients[piece]))

    def bounds(self, end: float) -> tuple[float, float]:
        """Least and largest value that it may have from t = 0 to ``end``: a polynomial stays within its Bernstein form.

        They are exact where every piece is straight or a ramp. A curve's may be somewhat wider.
        """
        breaks = self.breaks.copy()
        breaks[-1:] -= self.overlap
        inside = breaks[(breaks > 0.0) & (breaks < end)]
        edges = np.concatenate(([0.0], inside, [max(end, 0.0)]))
        pieces = np.searchsorted(breaks, edges[:-1], side="right")
        # About the left edge of each piece, in units of its length.
        begins, lengths = edges[:-1] - self.origins[pieces], np.diff(edges)
        order = DEGREES - 1
        control = np.zeros((len(pieces), DEGREES))
        for k in range(DEGREES):
            shifted = (
                sum(math.comb(j, k) * self.coefficients[pieces, j] * begins ** (j - k) for j in range(k, DEGREES))
                * lengths**k
            )
            for j in range(k, DEGREES):
                control[:, j] += math.comb(j, k) / math.comb(order, k) * shifted
        return float(control.min()), float(control.max())

    def integral(self) -> Track:
        """Antiderivative, continuous, zero at t = 0.

        Raises
        ------
        ArgumentError
            For a polynomial of the highest degree that there is.
        """
        if np.any(self.coefficients[:, -1] != 0.0):
            raise ArgumentError(f"the integral of a polynomial of degree {DEGREES - 1} does not fit")
        rows = np.zeros_like(self.coefficients)
        rows[:, 1:] = self.coefficients[:, :-1] / np.arange(1, DEGREES)
        left = _rows_at(rows[:-1], self.breaks - self.origins[:-1])
        right = _rows_at(rows[1:], self.breaks - self.origins[1:])
        rows[1:, 0] = np.cumsum(left - right)
        track = Track(self.breaks, self.origins, rows, self.overlap)
        rows[:, 0] -= track.value(0.0)
        return track


def _overlap(time: np.ndarray) -> float:
    """How far behind the last of these times the piece before it goes on, s: what steps and units leave of rounding.

    Not where the run begins there, or later: it begins held.
    """
    last = float(time[-1])
    if time.size < 2 or last <= 0.0:
        return 0.0
    return max(8.0 * float(np.spacing(last)), min(OVERLAP * last, OF_PIECE * (last - float(time[-2]))))


@dataclass
class Parts:
    """A function in the making: its tracks, and its waves (amplitude, w, c, phi, envelope)."""

    tracks: list[Track] = field(default_factory=list)
    waves: list[tuple[float, float, float, float, float]] = field(default_factory=list)

    def constant(self, value: float) -> None:
        """Add a constant."""
        if value != 0.0:
            self.tracks.append(Track.of([], [0.0], [[value]]))

    def times(self, factor: float) -> Parts:
        """All of it times a number."""
        tracks = [replace(track, coefficients=factor * track.coefficients) for track in self.tracks]
        return Parts(tracks, [(factor * a, *rest) for a, *rest in self.waves])

    def integral(self, request: FunctionRequest) -> Parts:
        """Antiderivative, zero at t = 0."""
        whole = Parts([track.integral() for track in self.tracks])
        numerical = []
        for wave in self.waves:
            a, w, _, phi, _ = wave
            if not _by_numbers(wave):
                whole.waves.append((a / w, w, 0.0, phi - 0.5 * math.pi, 0.0))
                whole.constant(a / w * math.cos(phi))
            else:
                numerical.append(wave)
        if numerical:
            whole.tracks.append(_integrated(np.array(numerical), request))
        return whole


def _by_numbers(wave: tuple[float, float, float, float, float]) -> bool:
    """Whether a wave has no elementary integral."""
    _, w, c, _, grows = wave
    return c != 0.0 or grows != 0.0 or w == 0.0


def reach_of(request: FunctionRequest) -> float:
    """Time up to which a function is what the scene says, s: what is prepared for a run ends with it; else infinite."""
    model, integrate = request.model, request.integrate
    if isinstance(model, OF_FRAMES):
        return math.inf  # the motions of the frames have requests of their own
    if isinstance(model, Samples):
        return model.reach
    if isinstance(model, Velocity):
        model, integrate = model.velocity, True
    if not integrate:
        return math.inf
    parts = Parts()
    _add(model, parts, smooth=False)
    return request.end if any(_by_numbers(wave) for wave in parts.waves) else math.inf


def bounds_of(model: Any, end: float) -> tuple[float, float]:
    """Two values between which a function stays from t = 0 to a time, s; each term of a sum by itself.

    Parameters
    ----------
    model
        A model of `tautline.scene.functions` that is no `Velocity`.
    end : float

    Returns
    -------
    tuple of float
        No larger than its least, and no less than its largest value, in the unit of the function.
    """
    parts = _parts(FunctionRequest(model))
    bounds = [track.bounds(end) for track in parts.tracks]
    swing = sum(abs(amplitude) for amplitude, *_ in parts.waves)
    return sum(low for low, _ in bounds) - swing, sum(high for _, high in bounds) + swing


@dataclass(frozen=True, eq=False)
class FrameLift:
    """How far a frame's motion lifts a point, some time ago, times a gain; it stands in a request in place of a model.

    Attributes
    ----------
    frames : FrameSet
    frame, still : int
        Numbers of the frame that the point rides on, and of that whose motion counts.
    point : tuple of 3 float
        Where it is drawn, m.
    gain, delay, offset : float
        See `tautline.kernels.moving_frame.Lifts`.
    """

    frames: FrameSet
    frame: int
    still: int
    point: tuple[float, float, float]
    gain: float
    delay: float
    offset: float = 0.0


def compile_functions(requests: Sequence[FunctionRequest]) -> TimeFunctions:
    """Compile functions of time; the i-th request is function i of the result.

    The motions of frames come after all requests; see `all_requests`.

    Raises
    ------
    SceneError
        If a numerical integral would need too many pieces.
    """
    wanted, frames, motion = _with_motions(requests)
    written = [Parts() if isinstance(request.model, OF_FRAMES) else _parts(request) for request in wanted]
    tracks = [track for part in written for track in part.tracks]
    waves = [wave for part in written for wave in part.waves]
    steered = [i for i, request in enumerate(wanted) if request.inputs]
    live = np.full(len(wanted), -1, np.int64)
    live[steered] = len(tracks) + np.arange(len(steered))
    tracks += [Track.of([0.0, 0.0], [0.0, 0.0, 0.0], [[0.0]] * 3) for _ in steered]
    track_at, wave_at = (
        _offsets([len(part.tracks) for part in written]),
        _offsets([len(part.waves) for part in written]),
    )
    return TimeFunctions(
        track_from=track_at[:-1].copy(),
        track_to=track_at[1:].copy(),
        break_from=_offsets([len(track.breaks) for track in tracks]),
        breaks=np.concatenate([np.empty(0), *(track.breaks for track in tracks)]),
        origins=np.concatenate([np.empty(0), *(track.origins for track in tracks)]),
        coefficients=np.concatenate([np.empty((0, DEGREES)), *(track.coefficients for track in tracks)]),
        wave_from=wave_at[:-1].copy(),
        wave_to=wave_at[1:].copy(),
        waves=np.array(waves, dtype=float).reshape(-1, WAVE_COLUMNS),
        entry=_entries(wanted),
        live=live,
        frames=new_frames(*((frames.parent, frames.pivot) if frames else ((), ())), motion),
        sums=_long_sums([part.waves for part in written]),
        lifts=_lifts(wanted),
    )


def _long_sums(waves: Sequence[Sequence[tuple[float, ...]]]) -> LongSums:
    """Which functions are sums of many plain waves, and room for their series."""
    row, spans, begins = np.full(len(waves), -1, np.int64), [], []
    for i, each in enumerate(waves):
        fastest = max((abs(w) for _, w, *_ in each), default=0.0)
        if len(each) >= MANY_WAVES and fastest > 0.0 and all(c == 0.0 for _, _, c, *_ in each):
            row[i] = len(spans)
            spans.append(1.0 / fastest)
            begins.append(max(grows for *_, grows in each))
    k = len(spans)
    return LongSums(row, np.array(spans), np.array(begins), np.full(k, np.nan), np.zeros((k, TERMS)))


def all_requests(requests: Sequence[FunctionRequest]) -> list[FunctionRequest]:
    """The requests, and after them those of the motions of the frames that they ask for: in the order of functions."""
    return _with_motions(requests)[0]


def _with_motions(requests: Sequence[FunctionRequest]) -> tuple[list[FunctionRequest], FrameSet | None, Any]:
    """All requests with those of the frames' motions, the frames, and the functions (k, 6) of their motions."""
    sets = {id(r.model.frames): r.model.frames for r in requests if isinstance(r.model, OF_FRAMES)}
    if len(sets) > 1:
        raise ArgumentError("the frames of two scenes cannot be compiled together")
    wanted, frames = list(requests), next(iter(sets.values()), None)
    if frames is None:
        return wanted, None, ()
    motion = np.full((len(frames.parent), 6), -1)
    for k, six in enumerate(frames.motion):
        for c, request in enumerate(six):
            if request is not None:
                motion[k, c] = len(wanted)
                wanted.append(request)
    return wanted, frames, motion


OF_FRAMES = (FrameEntry, FrameLift)
"""Models of functions that follow from the places of frames."""


def _entries(wanted: Sequence[FunctionRequest]) -> np.ndarray:
    """What each function is, as `TimeFunctions.entry` says."""
    entries, lifts = np.full(len(wanted), -1, np.int64), 0
    for i, request in enumerate(wanted):
        if isinstance(request.model, FrameEntry):
            entries[i] = 12 * request.model.frame + request.model.number
        elif isinstance(request.model, FrameLift):
            entries[i] = -2 - lifts
            lifts += 1
    return entries


def _lifts(wanted: Sequence[FunctionRequest]) -> Lifts:
    """The lifts among the functions, times the factors of their requests."""
    found = [(r.model, r.factor) for r in wanted if isinstance(r.model, FrameLift)]
    return Lifts(
        np.array([one.frame for one, _ in found], dtype=np.int64),
        np.array([one.still for one, _ in found], dtype=np.int64),
        np.array([one.point for one, _ in found], dtype=float).reshape(-1, 3),
        np.array([factor * one.gain for one, factor in found], dtype=float),
        np.array([one.delay for one, _ in found], dtype=float),
        np.array([factor * one.offset for one, factor in found], dtype=float),
    )


def _offsets(counts: list[int]) -> np.ndarray:
    return np.concatenate(([0], np.cumsum(counts, dtype=np.int64))).astype(np.int64)


def _parts(request: FunctionRequest) -> Parts:
    model, integrate = request.model, request.integrate
    if isinstance(model, Velocity):
        if integrate:
            raise ArgumentError("a position given by its velocity cannot be integrated again")
        model, integrate = model.velocity, True
    parts = Parts()
    _add(model, parts, smooth=not integrate)
    return (parts.integral(request) if integrate else parts).times(request.factor)


def _add(model: Any, parts: Parts, smooth: bool) -> None:
    """Add a model's tracks and waves; `smooth`: a table is by default a C2 curve, not straight lines."""
    if isinstance(model, Constant):
        parts.constant(model.value)
    elif isinstance(model, Ramp):
        parts.tracks.append(_ramp(model))
    elif isinstance(model, Table):
        cubic = model.interpolation == "cubic" or (model.interpolation is None and smooth)
        parts.tracks.append(_table(np.array(model.time, dtype=float), np.array(model.value, dtype=float), cubic))
    elif isinstance(model, Samples):
        rows = hermite(np.diff(model.time), model.value, model.rate, model.second)
        parts.tracks.append(Track.held(model.time, rows, model.value[0], model.value[-1]))
    elif isinstance(model, Harmonic):
        w = 2.0 * math.pi * (model.frequency if model.frequency is not None else 1.0 / model.period)
        parts.waves.append((model.amplitude, w, 0.0, model.phase, model.ramp))
        parts.constant(model.mean)
    elif isinstance(model, Chirp):
        w = 2.0 * math.pi / model.period
        phi = model.shift * (model.rate * model.shift - w)
        parts.waves.append((model.amplitude, w - 2.0 * model.rate * model.shift, model.rate, phi, 0.0))
        parts.constant(-model.amplitude * math.sin(phi))
    elif isinstance(model, Spectrum):
        parts.waves += [(a, w, 0.0, phi, model.ramp) for a, w, phi in zip(*jonswap(model), strict=True)]
    elif isinstance(model, Sum):
        for term in model.terms:
            _add(term, parts, smooth)
    else:
        raise ArgumentTypeError(f"not a function of time: {type(model).__name__}")


def _ramp(model: Ramp) -> Track:
    begin, over, base = model.at, model.over, model.from_
    breaks, origins = [begin, begin + over], [begin, begin, begin + over]
    if model.rate is None:
        to = base if model.to is None else model.to
        d = to - base
        rows = [[base], [base, 0.0, 0.0, 10.0 * d / over**3, -15.0 * d / over**4, 6.0 * d / over**5], [to]]
    else:
        # the slope goes by the quintic, the value by its integral: half of rate * over has grown when it is done
        r = model.rate
        grown = [base, 0.0, 0.0, 0.0, 2.5 * r / over**3, -3.0 * r / over**4, r / over**5]
        rows = [[base], grown, [base + 0.5 * r * over, r]]
    return Track.of(breaks, origins, rows)


def _table(time: np.ndarray, value: np.ndarray, cubic: bool) -> Track:
    if len(time) == 1:
        return Track.of([], [0.0], [[value[0]]])
    if cubic:
        slope, second = slopes(time, value)
        rows = hermite(np.diff(time), value, slope, second)
    else:
        rows = np.column_stack((value[:-1], np.diff(value) / np.diff(time)))
    return Track.held(time, rows, value[0], value[-1])


def _rows_at(rows: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Each row's polynomial at its own x."""
    value = np.zeros(len(x))
    for k in range(DEGREES - 1, -1, -1):
        value = value * x + rows[:, k]
    return value


def _waves_at(waves: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Value and rate of a sum of waves at times >= 0."""
    f, df = np.zeros_like(t), np.zeros_like(t)
    for a, w, c, phi, grows in waves:
        x = np.clip(t / grows, 0.0, 1.0) if grows > 0.0 else np.ones_like(t)
        e = x**3 * (10.0 + x * (6.0 * x - 15.0))
        de = 30.0 * (x * (1.0 - x)) ** 2 / grows if grows > 0.0 else np.zeros_like(t)
        angle = phi + t * (w + c * t)
        f += a * e * np.sin(angle)
        df += a * (de * np.sin(angle) + e * np.cos(angle) * (w + 2.0 * c * t))
    return f, df


def _integrated(waves: np.ndarray, request: FunctionRequest) -> Track:
    """Integral from 0 to the request's end of waves that have no elementary one."""
    end = request.end
    if not end > 0.0:
        raise ArgumentError(f"{request.key or 'a function of time'}: an integral in numbers needs the end of the run")
    fastest = max(max(abs(w), abs(w + 2.0 * c * end)) for _, w, c, _, _ in waves)
    growing = [grows for *_, grows in waves if grows > 0.0]
    pieces = math.ceil(max([8.0, fastest * end / ANGLE_PER_PIECE] + [PIECES_PER_ENVELOPE * end / g for g in growing]))
    if pieces > MOST_PIECES:
        cause = f"integrating this up to {end:g} s takes {pieces:.1e} pieces"
        raise SceneError([Problem("scene", None, request.key, None, cause, "give the position, or end earlier")])
    time = np.linspace(0.0, end, pieces + 1)
    h = np.diff(time)
    added = np.zeros(pieces)
    for place, weight in zip(*gauss(GAUSS_POINTS), strict=True):
        added += weight * h * _waves_at(waves, time[:-1] + place * h)[0]
    f, df = _waves_at(waves, time)
    whole = np.concatenate(([0.0], np.cumsum(added)))
    track = Track.held(time, hermite(h, whole, f, df), whole[0], whole[-1])
    track.coefficients[0, 1], track.coefficients[-1, 1] = f[0], f[-1]
    return track


def jonswap(model: Spectrum) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Split a JONSWAP sea into sines.

    The band from 0.4 to 5 times the peak frequency is cut into equal parts; each gives one sine with the energy of
    its part, at a random frequency within it (so that nothing repeats) and with a random phase. The energies are
    scaled to sum to that of the significant height, Hs^2/16.

    Returns
    -------
    amplitude, frequency, phase : float64 (components,)
        In the unit of the value (response included), rad/s, rad.
    """
    peak = 2.0 * math.pi / model.peak_period
    edges = np.linspace(0.4 * peak, 5.0 * peak, model.components + 1)
    fine = max(1, math.ceil(4000 / model.components))
    inner = (np.arange(fine) + 0.5) / fine
    w = edges[:-1, None] + np.diff(edges)[:, None] * inner
    width = np.where(w <= peak, 0.07, 0.09)
    peaked = np.exp(-0.5 * ((w / peak - 1.0) / width) ** 2)
    energy = (w**-5.0 * np.exp(-1.25 * (peak / w) ** 4) * model.gamma**peaked * peak**5).mean(axis=1)
    energy *= model.significant_height**2 / 16.0 / energy.sum()
    generator = np.random.default_rng(model.seed)
    frequency = edges[:-1] + np.diff(edges) * generator.random(model.components)
    phase = 2.0 * math.pi * generator.random(model.components)
    return model.rao * np.sqrt(2.0 * energy), frequency, phase
