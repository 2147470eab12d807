"""Which state the rig is in, told from what is measured at the surface, sample by sample.

Flags, each with hysteresis, are found first: does the hook carry the string, does the string turn, do pumps run, does
the block move, is the bit on bottom. A table of the flags is the state. Limits are learned from the record: the hook
load without the string, the largest rotary speed and flow, the noise of each signal.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from math import isfinite, nan
from typing import Any

from drillstring.twin.connections import Connection, Connections, Sample
from drillstring.twin.signals import Noise, Trend


class RigState(StrEnum):
    """States of a rig."""

    UNKNOWN = "unknown"
    IN_SLIPS = "in slips"
    CONNECTION = "connection"
    TRIPPING_IN = "tripping in"
    TRIPPING_OUT = "tripping out"
    ROTATING = "rotating off bottom"
    REAMING_DOWN = "reaming down"
    REAMING_UP = "reaming up"
    CIRCULATING = "circulating"
    DRILLING = "drilling"
    SLIDING = "sliding"
    AT_REST = "at rest"


IN_THE_SLIPS = (RigState.IN_SLIPS, RigState.CONNECTION)

LOST_WITHOUT = {
    "block": "motion of the string: tripping and reaming are not told from rest, nor connections from slips",
    "hook_load": "the slips: neither in slips nor connection is found, and there are no hook loads of stands",
    "rotary_speed": "rotation: drilling, reaming and rotating off bottom count as the same without rotation",
    "torque": "nothing of the states; torques of stands are missing",
    "flow": "circulating is not told from rest, and every rotating motion counts as reaming",
    "bit_depth": "depth: it is summed from the block's motion since the record began, if that is measured",
    "hole_depth": "the bottom of the hole: it is taken as the largest bit depth so far, and a bit that stands there "
    "without drilling counts as off bottom",
}
"""What cannot be told without a signal."""
SIGNALS = tuple(LOST_WITHOUT)


@dataclass(frozen=True)
class Settings:
    """What is not learned from the record.

    Attributes
    ----------
    block_weight : float or None
        Hook load without the string, N, where it is known; else it is learned when the slips first are set.
    slowest : float
        Block speed, m/s, below which a string off bottom counts as at rest.
    fastest_drilling : float
        m/s: a bit that goes down faster is not drilling.
    dwell : float
        Time, s, for which a state has to last before it is told; where samples are further apart one is enough.
    turning, pumping : float
        Share of the largest rotary speed, and of the largest flow, from which the string turns and pumps run. Below
        half of it they do not.
    least_speed, least_flow : float
        rad/s and m^3/s: largest values below these are those of a string at rest, and of pumps that stand.
    empty : float
        Largest hook load in slips as a share of the largest with the string, as long as the former is not known.
    transfer : float
        Share of the string's weight that the slips carry in the state in slips; more where so much is missing from the
        hook load of a string that is lowered (`RigStates.string_weighs`).
    band : float
        Half of the hysteresis about that share.
    connection_travel : float
        Way of the block in slips, m, from which it is a connection; ten times its noise if that is more.
    taking_up : float
        Time, s, after the slips took or gave back half of the weight in which the block still moves with the string's
        stretch: its motion is neither tripping nor a connection.
    setting_down : float
        Way of the block, m, from which its motion counts where the hook load has fallen: less is stretch, as the slips
        are set.
    bottom : float
        Distance of the bit from the bottom, m, within which it is on it; six times the noise if that is more.
    gap : float
        Time without samples, s, after which nothing is concluded from those before.
    """

    block_weight: float | None = None
    slowest: float = 0.012
    fastest_drilling: float = 0.05
    dwell: float = 0.25
    turning: float = 0.05
    pumping: float = 0.08
    least_speed: float = 0.5
    least_flow: float = 1.0e-3
    empty: float = 0.75
    transfer: float = 0.5
    band: float = 0.05
    connection_travel: float = 0.15
    taking_up: float = 3.0
    setting_down: float = 0.3
    bottom: float = 0.06
    gap: float = 10.0


LOST_ON_THE_WALL = (
    "with the friction of the scene the wall carries the string while it is lowered: its hook load is then like that "
    "in slips. The two states cannot be distinguished. A depth that is summed from the block's motion may be wrong"
)
BETWEEN = 0.5
"""Where the limit lies between the hook load of a string that is lowered and that without one."""
NEARLY = 0.85
"""Share of the string's weight on the slips from which the hook counts as free."""
WHOLLY = 0.8
"""Share from which on more on the wall is not told from slips: then a limit of nine tenths has to do."""
FOLLOWED = 20.0
"""Time, s, over which the hook loads with and without the string follow what is measured."""


class Switch:
    """A flag with hysteresis: on above a level, off below another one."""

    def __init__(self) -> None:
        self.on = False

    def set(self, value: float, above: float, below: float) -> bool:
        """The flag with a new value."""
        self.on = value > below if self.on else value > above
        return self.on


@dataclass
class Hook:
    """Whether the hook carries the string, by what it carries with and without it, N.

    ``free`` where next to nothing of the string's weight is left on it, ``light`` where some is missing;
    ``on_the_wall`` is the share of the weight that friction carries while the string is lowered.
    """

    MADE_ANEW = ("settings",)

    settings: Settings
    without: float = nan
    with_string: float = nan
    on_the_wall: float = 0.0
    lowest: float = nan
    highest: float = nan
    recent: deque[tuple[float, float]] = field(default_factory=deque)
    carries: bool | None = None
    free: bool = False
    light: bool = False
    _time: float = nan
    _since: float = 0.0

    def __post_init__(self) -> None:
        if self.settings.block_weight is not None:
            self.without = self.settings.block_weight

    def add(self, time: float, load: float, hangs: bool, follows: bool | None) -> bool | None:
        """Whether the hook carries the string.

        Parameters
        ----------
        time, load : float
            s, N.
        hangs : bool
            Whether something shows that it does: the string turns, or fluid is pumped into it.
        follows : bool or None
            Whether the bit has lately moved with the block; None where the block did not move, or that is not known.

        Returns
        -------
        bool or None
            False in slips; None where that cannot be told yet.
        """
        self.recent.append((time, load))
        while time - self.recent[0][0] > 1.0:
            self.recent.popleft()
        level = sum(value for _, value in self.recent) / len(self.recent)
        self.lowest, self.highest = min(_or(self.lowest, level), level), max(_or(self.highest, level), level)
        self._since, self._time = (time - self._time if isfinite(self._time) else 0.0), time
        if follows is False and not isfinite(self.without):
            self.without = level
        empty, full = self._levels(hangs)
        if not isfinite(empty):
            self.carries = True if hangs or follows else self.carries
            return self.carries
        share = (full - load) / (full - empty) if full > empty else 0.0
        limit = max(self.settings.transfer, self.on_the_wall + BETWEEN * (1.0 - self.on_the_wall))
        in_slips = share > limit + self.settings.band * (1.0 if self.carries is not False else -1.0)
        self.carries, self.free = not in_slips, in_slips and share > max(NEARLY, limit)
        self.light = share > 1.0 - NEARLY
        self._learn(share, load)
        return self.carries

    def _levels(self, hangs: bool) -> tuple[float, float]:
        """Hook load without and with the string; NaN where nothing tells them."""
        if isfinite(self.without):
            if isfinite(self.with_string):
                return self.without, self.with_string
            return self.without, max(self.highest, self.without / self.settings.empty)
        if self.lowest < self.settings.empty * self.highest and not hangs:
            return self.lowest, self.highest
        return nan, nan

    def _learn(self, share: float, load: float) -> None:
        """Plateaus are followed slowly, and only well away from where the weight is being transferred."""
        part = self._since / (self._since + FOLLOWED)
        if share > NEARLY:
            self.without = _or(self.without, load) + part * (load - _or(self.without, load))
        elif share < 1.0 - NEARLY:
            self.with_string = _or(self.with_string, self.highest)
            self.with_string += part * (load - self.with_string)


def _or(value: float, other: float) -> float:
    return value if isfinite(value) else other


class Level:
    """Whether something runs, by a share of the largest value that it was seen to have."""

    def __init__(self, share: float, least: float) -> None:
        self.share, self.least = share, least
        self.largest = 0.0
        self.seen = False
        self._last: deque[float] = deque(maxlen=3)
        self._switch = Switch()
        self._noise = Noise()

    def add(self, value: float) -> bool:
        """Whether it runs; a value that is not there changes nothing."""
        if not isfinite(value):
            return self._switch.on
        self.seen = True
        self._last.append(abs(value))
        noise = self._noise.add(value)
        # The middle of three keeps a single spike from becoming the largest value.
        self.largest = max(self.largest, sorted(self._last)[len(self._last) // 2])
        limit = max(self.least, self.share * self.largest, 4.0 * noise)
        return self._switch.set(abs(value), limit, 0.5 * limit)


class Bottom:
    """Whether the bit is on the bottom, by its depth and the hole's, or by a hole that deepens."""

    MADE_ANEW = ("settings",)

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self.hole = nan
        self._noise = Noise(1.0e-3)
        self._near = Switch()
        self._history: deque[tuple[float, float]] = deque()

    def add(self, time: float, bit: float, hole: float) -> tuple[bool, bool]:
        """Whether the bit is at the bottom, and whether the hole has deepened in the last ten seconds."""
        if not isfinite(bit):
            return False, False
        noise = self._noise.add(bit)
        given = isfinite(hole)
        self.hole = hole if given else max(_or(self.hole, bit), bit)
        within = max(self.settings.bottom, 6.0 * noise)
        near = not self._near.set(self.hole - bit, 2.0 * within, within)
        self._history.append((time, self.hole))
        while time - self._history[0][0] > 10.0:
            self._history.popleft()
        deepens = near and self.hole - self._history[0][1] > max(3.0 * noise, 0.5 * self.settings.bottom)
        return (near if given else deepens), deepens


class Together:
    """Whether the bit has moved with the block, over the last metre that the block has gone."""

    def __init__(self) -> None:
        self._places: deque[tuple[float, float, float]] = deque()

    def add(self, time: float, block: float, bit_depth: float) -> bool | None:
        """None where the block has not moved a metre in half a minute, and where one of the two is not known."""
        if not (isfinite(block) and isfinite(bit_depth)):
            return None
        self._places.append((time, block, bit_depth))
        while time - self._places[0][0] > 30.0:
            self._places.popleft()
        _, first, depth = self._places[0]
        if abs(block - first) < 1.0:
            return None
        followed = (bit_depth - depth) / (block - first)
        while abs(block - self._places[0][1]) >= 1.0:
            self._places.popleft()
        return True if followed > 0.7 else False if abs(followed) < 0.3 else None


class RigStates:
    """Tells the state of the rig with every sample.

    It looks back only. A state is told at most ``dwell`` s, or one sample if that is longer, after its flags are there;
    flags follow the signals within their own noise. Everything in it can be pickled and gone on with.

    Attributes
    ----------
    state : RigState
        Now.
    since : float
        Time since which it is so, s.
    in_the_hole : float
        Bit depth, m; where it is not measured, the way that the block has moved the string since the record began.
    """

    MADE_ANEW = ("settings",)

    def __init__(self, settings: Settings | None = None) -> None:
        self.settings = settings or Settings()
        self.state, self.since = RigState.UNKNOWN, nan
        self.in_the_hole = nan
        self._connections = Connections()
        self._hook = Hook(self.settings)
        self._turns = Level(self.settings.turning, self.settings.least_speed)
        self._pumps = Level(self.settings.pumping, self.settings.least_flow)
        self._bottom = Bottom(self.settings)
        self._trend, self._block_noise = Trend(8.0), Noise(1.0e-3)
        self._moves, self._together = Switch(), Together()
        self._released = self._set = self._began = nan
        self._time = self._last_block = self._set_at = nan
        self._connecting = False
        self._candidate: tuple[RigState, float] = (RigState.UNKNOWN, nan)
        self._seen: set[str] = set()

    @property
    def connections(self) -> list[Connection]:
        """Times in slips that are over."""
        return self._connections.all

    def lost(self) -> list[str]:
        """What cannot be told, for each signal that has not come, and where hardly any weight is left to lower with."""
        lost = [f"without {name}: {LOST_WITHOUT[name]}" for name in SIGNALS if name not in self._seen]
        return [*lost, LOST_ON_THE_WALL] if self._hook.on_the_wall >= WHOLLY else lost

    def string_weighs(self, weight: float, lowered: float = nan) -> None:
        """Take notice of what the string adds to the hook load, N, as after a stand was added.

        ``lowered`` is what it adds while it is lowered: in a long or rising hole that may be so little that the string
        would seem to stand in the slips.
        """
        self._hook.with_string = _or(self._hook.without, 0.0) + weight
        if isfinite(lowered) and weight > 0.0:
            self._hook.on_the_wall = min(max(0.0, 1.0 - lowered / weight), WHOLLY)

    def memory(self) -> dict[str, Any]:
        """What another process needs to go on in the same state, for JSON."""
        hook = self._hook
        return {
            "state": str(self.state), "since": self.since, "in_the_hole": self.in_the_hole, "without": hook.without,
            "with_string": hook.with_string, "carries": hook.carries, "connection": self._connections.memory(),
            "largest": [self._turns.largest, self._pumps.largest], "seen": sorted(self._seen),
        }  # fmt: skip

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Go on from what another process kept; noises and trends are learned anew."""
        self.state, self.since = RigState(memory["state"]), float(memory["since"])
        self.in_the_hole, hook = float(memory["in_the_hole"]), self._hook
        hook.without, hook.with_string = float(memory["without"]), float(memory["with_string"])
        hook.carries = memory["carries"]
        self._connections.recall(memory["connection"])
        self._turns.largest, self._pumps.largest = memory["largest"]
        self._turns.seen, self._pumps.seen = "rotary_speed" in memory["seen"], "flow" in memory["seen"]
        self._seen = set(memory["seen"])
        self._candidate = self.state, self.since

    def add(
        self,
        time: float,
        *,
        block: float = nan,
        hook_load: float = nan,
        rotary_speed: float = nan,
        torque: float = nan,
        flow: float = nan,
        bit_depth: float = nan,
        hole_depth: float = nan,
    ) -> RigState:
        """The state with one more sample.

        Parameters
        ----------
        time : float
            s. A sample that is not later than the one before changes nothing.
        block : float
            Position of the block, m, positive down.
        hook_load : float
            N, with block and top drive.
        rotary_speed, torque : float
            rad/s and N m at the surface.
        flow : float
            Into the string, m^3/s.
        bit_depth, hole_depth : float
            Measured depth, m.

        Any of them may be NaN: it is not there, now or at all.
        """
        if not isfinite(time) or time <= self._time:
            return self.state
        if time - self._time > self.settings.gap:
            self._trend.clear()
        given = (block, hook_load, rotary_speed, torque, flow, bit_depth, hole_depth)
        self._seen.update(name for name, value in zip(SIGNALS, given, strict=True) if isfinite(value))
        turns, pumps = self._turns.add(rotary_speed), self._pumps.add(flow)
        carried = self._hook.carries is not False
        rate = self._rate(time, block if "block" in self._seen else bit_depth)
        if isfinite(hook_load):
            self._hook.add(time, hook_load, turns or pumps, self._together.add(time, block, bit_depth))
            if self._hook.carries and not carried:
                self._released = time
            elif self._hook.carries is False and carried:
                self._set = time
        depth = self._depth(block, bit_depth)
        if not self._counts(time, rate, block):
            rate = 0.0
        told = self._flags(time, turns, pumps, rate, block, *self._bottom.add(time, depth, hole_depth))
        self._take(time, told)
        self._time = time
        self._collect(Sample(time, block, depth))
        return self.state

    def _rate(self, time: float, place: float) -> float:
        """Speed of the block, m/s, zero where it does not move; positive down."""
        if not isfinite(place):
            return self._trend.rate if self._moves.on else 0.0
        rate = self._trend.add(time, place, self._block_noise.add(place))
        # Slow is what three deviations of a rate would not tell from rest.
        limit = max(self.settings.slowest, 3.0 * self._trend.deviation)
        return rate if self._moves.set(abs(rate), limit, 0.5 * limit) else 0.0

    def _counts(self, time: float, rate: float, block: float) -> bool:
        """Whether a motion of the block is one of the string: not while slips take or give back its weight."""
        if rate == 0.0:
            self._began = block
            return True
        if time - self._released < self.settings.taking_up:
            return False
        return not self._hook.light or not isfinite(block) or abs(block - self._began) > self.settings.setting_down

    def _depth(self, block: float, bit_depth: float) -> float:
        """Bit depth, m: measured, or summed from the block while it carries the string."""
        if isfinite(bit_depth):
            self.in_the_hole = bit_depth
        elif "bit_depth" not in self._seen and isfinite(block):
            moved = block - self._last_block if isfinite(self._last_block) else 0.0
            self.in_the_hole = _or(self.in_the_hole, 0.0) + (moved if self._hook.carries is not False else 0.0)
        if isfinite(block):
            self._last_block = block
        return self.in_the_hole

    def _flags(
        self, time: float, turns: bool, pumps: bool, rate: float, block: float, bottom: bool, deepens: bool
    ) -> RigState:
        """The state that the flags of one sample make."""
        if "hook_load" in self._seen and self._hook.carries is None:
            return RigState.UNKNOWN
        if self._hook.carries is False:
            return self._slips(time, block)
        self._set_at, self._connecting = nan, False
        unpumped = self._pumps.seen and not pumps
        if bottom and -self.settings.slowest < rate < self.settings.fastest_drilling:
            if turns:
                return RigState.DRILLING
            if pumps or (deepens and not self._pumps.seen):
                return RigState.SLIDING
        if rate != 0.0 and turns and not unpumped:
            return RigState.REAMING_DOWN if rate > 0.0 else RigState.REAMING_UP
        if rate != 0.0:
            return RigState.TRIPPING_IN if rate > 0.0 else RigState.TRIPPING_OUT
        if turns:
            return RigState.ROTATING
        return RigState.CIRCULATING if pumps else RigState.AT_REST

    def _slips(self, time: float, block: float) -> RigState:
        """In slips; a connection once the block has moved without the string."""
        # What the block does while the slips take the weight is stretch.
        if isfinite(block) and self._hook.free and time - self._set >= self.settings.taking_up:
            if not isfinite(self._set_at):
                self._set_at = block
            travel = max(self.settings.connection_travel, 10.0 * self._block_noise.deviation)
            self._connecting = self._connecting or abs(block - self._set_at) > travel
        return RigState.CONNECTION if self._connecting else RigState.IN_SLIPS

    def _take(self, time: float, told: RigState) -> None:
        """Change the state where another has lasted."""
        if told is self.state:
            self._candidate = told, time
            return
        if told is not self._candidate[0]:
            self._candidate = told, time
        spacing = time - self._time if isfinite(self._time) else 0.0
        if time - self._candidate[1] >= self.settings.dwell - 0.5 * spacing or spacing >= self.settings.dwell:
            self.state, self.since = told, self._candidate[1]

    def _collect(self, sample: Sample) -> None:
        hangs = None if self.state is RigState.UNKNOWN else self.state in IN_THE_SLIPS
        self._connections.add(sample, hangs)
