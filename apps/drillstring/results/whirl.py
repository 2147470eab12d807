"""How lumps go around the hole: whirl rate, whirl ratio, lateral acceleration, from the stored variables of a run.

The whirl rate is that of the direction from the hole's axis to the pipe's, clockwise looking down the hole; over the
rotary speed it is the whirl ratio: 1 for an unbalance that leads a forward whirl, minus the pipe's diameter over the
clearance of both sides for a pipe that rolls around the wall, 0 for one that lies on its low side.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

LATE = 0.2
"""Share of a run, at its end, of which figures of a steady whirl are told."""
TURNS = 1.0
"""Turns of the pipe over which a whirl rate is averaged."""
STILL = 1.0e-9
"""Offset, m, below which a lump is on the axis and goes around nothing."""
COUNTED = 0.5 * np.pi
"""Angle about the axis between two frames, rad, above which turns cannot be counted from frames."""
BY_AREA = "by the area swept, because turns cannot be counted: the way meets the axis, or the frames are too far apart"
"""What the summary says of a whirl ratio that is no count of turns."""
WHOLE = 2.0 * np.pi * (1.0 - 1e-9)
"""A turn, rad, but for rounding."""
SLOWEST = 1.0e-3
"""Rotary speed, rad/s, below which a string does not turn."""


@dataclass(frozen=True)
class Whirl:
    """One lump's path around the hole.

    Its number; time (m,) s; offset (m,) from the hole's axis, complex, m1 + i m2, m; ``velocity`` (m,) of that, m/s;
    ``spin`` (m,) rotary speed of the lump, rad/s; ``depth`` mean measured depth, m; ``clearance`` and ``diameter``
    of the pipe where it touches, m, or None in free space.
    """

    lump: int
    time: np.ndarray
    offset: np.ndarray
    velocity: np.ndarray
    spin: np.ndarray
    depth: float
    clearance: float | None
    diameter: float | None

    @property
    def rolling(self) -> float | None:
        """Whirl ratio of pure rolling on a rigid wall."""
        if self.clearance is None or self.diameter is None or not self.clearance > 0.0:
            return None
        return -self.diameter / (2.0 * self.clearance)

    def rate(self) -> np.ndarray:
        """Whirl rate (m,), rad/s, averaged about each frame over a turn of the pipe; NaN where it is on the axis.

        It is the mean of r x v over that of r^2: what a circle has, and of other ways the rate at which area is swept.
        """
        swept = np.imag(np.conj(self.offset) * self.velocity)
        size = np.abs(self.offset) ** 2
        speed = float(np.abs(self.spin).mean())
        half = np.pi * TURNS / speed if speed > SLOWEST else 0.0
        first = np.searchsorted(self.time, self.time - half, side="left")
        last = np.searchsorted(self.time, self.time + half, side="right")
        sums = [np.concatenate([[0.0], np.cumsum(values)]) for values in (swept, size)]
        area, square = (total[last] - total[first] for total in sums)
        return np.where(square > STILL**2 * (last - first), area / np.maximum(square, STILL**2), np.nan)

    def share(self) -> float:
        """Share of the run, at its end, of which the whirl ratio is told: a fifth, or the last turn if neither pipe
        nor lump goes round in that. The fifth is a choice, and the turn is none.
        """
        late, left = self._late(LATE), np.abs(self._turned()[-1] - self._turned())
        whole = np.flatnonzero(left >= WHOLE)
        if left[late][0] >= WHOLE or not whole.size or not self.counts(LATE):
            return LATE
        angle = np.unwrap(np.angle(self.offset[late]))
        if abs(angle[-1] - angle[0]) >= WHOLE:
            return LATE
        time = self.time
        return float((time[-1] - time[whole[-1]]) / (time[-1] - time[0])) * (1.0 + 1e-9)

    @property
    def span(self) -> str:
        """What of the run the whirl ratio is told of, in words."""
        return "fifth of the run" if self.share() == LATE else "turn of the pipe"

    def _turned(self) -> np.ndarray:
        """Angle by which the pipe has turned since the first frame (m,), rad."""
        return np.append(0.0, np.cumsum(0.5 * (self.spin[1:] + self.spin[:-1]) * np.diff(self.time)))

    def ratio(self, share: float | None = None) -> float:
        """Whirl ratio, mean of the end of the run; NaN where the string does not turn, or the lump is on the axis.

        It is the angle about the axis over that of the pipe in whole turns, so that of a whirl with the rotary is 1
        whatever the orbit's form and however the rotary's speed changes; NaN where neither goes round once. Where turns
        cannot be counted (`counts`) it is the area swept over r^2: 0 of what swings through the axis.
        """
        share = self.share() if share is None else share
        late = self._late(share)
        square, spin = float((np.abs(self.offset[late]) ** 2).sum()), float(self.spin[late].mean())
        if square <= STILL**2 * late.sum() or abs(spin) < SLOWEST:
            return float("nan")
        if self.counts(share):
            return _over_whole_turns(np.unwrap(np.angle(self.offset[late])), self._turned()[late])
        swept = np.imag(np.conj(self.offset[late]) * self.velocity[late])
        return float(swept.sum()) / square / spin

    def counts(self, share: float | None = None) -> bool:
        """Whether the turns about the axis can be counted at the end of the run.

        The lump stays away from the axis, and its angle goes less than a quarter of a turn from frame to frame: by
        place, and by speed, which tells of the whole turns that places leave out.
        """
        late = self._late(self.share() if share is None else share)
        time, offset = self.time[late], self.offset[late]
        if time.size < 2 or np.abs(offset).min() <= STILL:
            return False
        step = np.abs(np.angle(offset[1:] * np.conj(offset[:-1])))
        speed = np.abs(np.imag(np.conj(offset) * self.velocity[late])) / np.abs(offset) ** 2
        expected = np.maximum(speed[1:], speed[:-1]) * np.diff(time)
        return bool(max(step.max(), expected.max()) <= COUNTED)

    @property
    def is_short(self) -> bool:
        """Whether turns can be counted at the end of the run, and neither pipe nor lump makes one."""
        return self.counts(LATE) and bool(np.abs(self._turned()[-1] - self._turned()).max() < WHOLE)

    def why_none(self) -> str:
        """Why there is no whirl ratio, and what gives one."""
        if self.is_short:
            return "the string made less than a turn in this run. A longer `--end` gives it"
        late = self._late(LATE)
        if np.abs(self.offset[late]).max() <= STILL:
            return "the string is on the hole's axis in the last fifth of the run, and goes around nothing"
        does = "stands still" if np.abs(self.spin[late]).max() < SLOWEST else "turns to and fro, or hardly at all,"
        return f"the string {does} in the last fifth of the run. An `--end` while it turns one way gives it"

    def _late(self, share: float) -> np.ndarray:
        """Frames (m,) at the end of the run."""
        return np.asarray(self.time >= self.time[-1] - share * (self.time[-1] - self.time[0]))


def _over_whole_turns(angle: np.ndarray, turned: np.ndarray) -> float:
    """Angle (m,) of a lump about the axis over that of the pipe, rad, both from one time to the end.

    Within a turn the angle of an orbit that is no circle is faster and slower. So the time is that from which the pipe
    makes whole turns, or the lump where the pipe makes none; NaN where neither does.
    """
    to_go = np.array([turned[-1] - turned, angle[-1] - angle])
    for leader in to_go:
        left = leader * np.sign(leader[0])
        whole = min(2.0 * np.pi * np.floor(left[0] / (2.0 * np.pi) + 1e-9), left[0])
        if whole > 0.0:
            k = int(np.flatnonzero(left >= whole)[-1])
            share = (left[k] - whole) / (left[k] - left[k + 1])
            pipe, lump = to_go[:, k] + share * (to_go[:, k + 1] - to_go[:, k])
            return float(lump / pipe) if pipe else float("nan")
    return float("nan")


def whirl_of(result: Any, lump: int) -> Whirl:
    """The whirl of a lump; the velocity stands in the frame of the hole where the lump is."""
    offset, depth = result["lateral_displacement"][:, lump], result["measured_depth"][:, lump]
    across = lateral_velocity(result, [lump])[:, 0]
    clearance = float(result["clearance"][lump]) if "clearance" in result else None
    hole = float(result["hole_diameter"][0]) if "hole_diameter" in result else None
    return Whirl(
        lump, np.asarray(result.time), offset[:, 0] + 1j * offset[:, 1], across[:, 0] + 1j * across[:, 1],
        result["rotation_rate"][:, lump], float(depth.mean()), clearance,
        None if clearance is None or hole is None else hole - 2.0 * clearance,
    )  # fmt: skip


def lateral_velocity(result: Any, lumps: list[int] | slice = slice(None)) -> np.ndarray:
    """Velocity across the hole of some lumps on m1 and m2, (time, lumps, 2) m/s."""
    depth, velocity = result["measured_depth"][:, lumps], result["velocity"][:, lumps]
    stations = result["well_depth"]
    frame = []
    for name in ("well_side", "well_direction"):
        vectors = result[name]
        between = np.stack([np.interp(depth, stations, vectors[:, k]) for k in range(3)], axis=-1)
        frame.append(between / np.linalg.norm(between, axis=-1, keepdims=True))
    side, along = frame
    other = np.cross(along, side)
    return np.stack([(velocity * side).sum(axis=-1), (velocity * other).sum(axis=-1)], axis=-1)


def without_a_ratio(result: Any) -> list[str]:
    """A sentence where a run of a string that turns and whirls has no whirl ratio."""
    figures = whirl_figures(result)
    if not figures or "whirl_ratio" in figures:
        return []
    return [f"no whirl ratio: {whirl_of(result, busiest(result)).why_none()}"]


def busiest(result: Any) -> int:
    """Number of the lump whose way across the hole is the widest."""
    return int(np.ptp(result["lateral_displacement"], axis=0).max(axis=-1).argmax())


def goes_around(result: Any, lump: int) -> bool:
    """Whether a lump goes once around the hole's axis, by the area that it sweeps: one that crosses over does not."""
    offset = result["lateral_displacement"][:, lump, 0] + 1j * result["lateral_displacement"][:, lump, 1]
    swept = np.append(0.0, np.cumsum(np.imag(np.conj(offset[:-1]) * offset[1:])))
    return bool(np.ptp(swept) >= 2.0 * np.pi * np.mean(np.abs(offset) ** 2) > 0.0)


def turns(result: Any) -> bool:
    """Whether the string turns at all."""
    return float(np.abs(result["rotation_rate"]).max()) > SLOWEST


def whirl_figures(result: Any) -> dict[str, tuple[float, str, str]]:
    """Headline figures: value, unit, text by name; none of a string that does not turn or does not leave its place.

    Acceleration is the mean between two frames: a blow that is shorter than the output's interval is not seen in full.
    """
    if not turns(result) or len(result.time) < 2:
        return {}
    lump = busiest(result)
    one, place = whirl_of(result, lump), result["body_name"][lump]
    if np.ptp(np.abs(one.offset)) <= STILL:
        return {}
    figures = {"lateral_offset_max": (float(np.abs(one.offset).max()), "m", f"largest lateral displacement ({place})")}
    figures["lateral_offset_depth"] = (one.depth, "m", "measured depth of the largest lateral displacement")
    share = one.share()
    ratio = one.ratio(share)
    if np.isfinite(ratio):
        words = f"mean whirl speed over rotary speed, last {one.span}"
        figures["whirl_ratio"] = (ratio, "", words if one.counts(share) else f"{words}; {BY_AREA}")
    gained = np.diff(lateral_velocity(result), axis=0) / np.diff(result.time)[:, None, None]
    largest = float(np.linalg.norm(gained, axis=-1).max())
    figures["lateral_acceleration_max"] = (largest, "m/s^2", "largest lateral acceleration")
    return figures
