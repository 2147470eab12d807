"""A rig's work as a twin follows it: slips, the string that grows, friction off bottom, weight and torque on bottom.

Hook load and torque show friction while the whole string slides off bottom. In slips the simulation waits. With every
stand it goes on with a longer string, and what is known of the friction stays. On bottom weight and torque of the bit
follow from what hook and drive show beside a string that is computed off bottom (at_bit.py).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import hypot, isfinite, nan
from typing import Any

import numpy as np

from drillstring.model.prepared import tubes_of, well_of
from drillstring.scene.scene import DrillstringScene
from drillstring.statics.motion import Motion
from drillstring.statics.soft_string import SoftString, soft_string
from drillstring.statics.statics import weight_per_length
from drillstring.string.factors import Factors, factors_of
from drillstring.twin.at_bit import AtBit, AtSurface, Known
from drillstring.twin.connections import Connection, Sample
from drillstring.twin.row_rate import Needed, Remarks, RowInterval
from drillstring.twin.severity import Settings as SeveritySettings
from drillstring.twin.severity import Severity, StickSlip
from drillstring.twin.slips import Expected, Slips, expected
from drillstring.twin.stands import with_stand
from drillstring.twin.states import IN_THE_SLIPS, RigState, RigStates, Settings
from drillstring.twin.sticking_limit import sticking_limit
from drillstring.twin.torsional_line import line_of
from tautline.scene.errors import SceneError
from tautline.scene.values.printed import quantity
from tautline.twin.map.plan import Plan
from tautline.twin.operation import Guidance, Operation

ASKED = {
    "block": "m", "hook_load": "N", "rotary_speed": "rad/s", "torque": "N m", "flow": "m^3/s", "bit_depth": "m",
    "hole_depth": "m",
}  # fmt: skip
"""What a rig measures, by the names of its states, and the units."""
FOUND = {"bit.weight": "N", "bit.torque": "N m", "bit.depth": "m", "bit.stick_slip": ""}
"""What it finds, and the units."""
KNOWN_AS = {
    "top.block": "block", "block_position": "block", "top.hook_load": "hook_load", "hook_load": "hook_load",
    "top.rotary_speed": "rotary_speed", "top.string_torque": "torque", "surface_torque": "torque",
    "top.torque": "torque", "drive_torque": "torque", "bit.depth": "bit_depth", "bit_depth": "bit_depth",
}  # fmt: skip
"""Names of the scene that are such a signal."""
STRING_TORQUE = ("top.string_torque", "surface_torque")
"""Those of the torque in the string, without that of the drive's inertia."""
OFF_BOTTOM = (
    RigState.TRIPPING_IN, RigState.TRIPPING_OUT, RigState.ROTATING, RigState.REAMING_DOWN, RigState.REAMING_UP,
)  # fmt: skip
"""States in which hook load and torque show the friction."""
ON_BOTTOM = (RigState.DRILLING, RigState.SLIDING)
"""States in which they show weight and torque at the bit."""
RESTING = (RigState.AT_REST, RigState.CIRCULATING)
"""States in which the string hangs still: slips may still carry a part of it, and friction holds what it held."""
STAND = 3.0
"""Length that counts as a stand, m."""
STARTING = 1.0
"""Time at the begin of a motion that does not count, s: when it began is known to the dwell of a state."""
SLIDES = 0.25
"""Least speed of any part of the string over the block's, where the whole of it slides. So much may its rotary speed be
off the rotary table's, over it, where the whole of it turns."""
SLOWEST, SLOWEST_TURN = 5e-3, 0.1
"""Speeds of the block m/s and of the rotary rad/s below which nothing is said of sliding."""
WINDOW = 300.0
"""Longest time from slips to slips that an estimate looks back over, s."""
MEAN = 3.0
"""Time over which weight and torque at the bit are averaged, s."""
STICKING = 0.5
"""Severity from which on an alarm is raised: the bit's speed swings by half of its mean."""
SEVERITY_EVERY = 1.0
"""How often stick-slip is looked for, s."""


@dataclass(frozen=True)
class _Gauge:
    """The sensor of the hook load: output, column, reading of the empty hook and deviations of noise and offset, N."""

    name: str = ""
    column: str = ""
    zero: float = 0.0
    noise: float = 0.0
    offset: float = 0.0
    tell: Callable[[float], str] = str


_NO_GAUGE = _Gauge()


def _gauge_of(plan: Plan) -> _Gauge:
    """The sensor of the hook load in a map; one without a name where there is none."""
    shown = (one for one in plan.channels if not one.is_input)
    one = next((one for one in shown if KNOWN_AS.get(one.name, one.name) == "hook_load"), None)
    if one is None:
        return _NO_GAUGE
    zero = 0.0 if one.zero_first else one.scale * one.zero
    noise = 0.0 if one.relative else one.sd
    offset = max((off.sd for off in plan.unknowns if off.is_offset and off.target == one.name), default=0.0)
    return _Gauge(one.name, one.column, zero, noise, offset, one.told)


RECORDS = (AtSurface, Connection, Factors, Motion, RigState, Sample, StickSlip)
"""Classes of records that are kept over a restart."""


class RigOperation(Operation):
    """What a twin asks of a rig.

    Parameters
    ----------
    scene : DrillstringScene
        With the bit off bottom.

    Raises
    ------
    SceneError
        As `well_of` and `tubes_of` do.

    Attributes
    ----------
    rig : RigStates
    added : float
        Pipe added since the begin, m.
    """

    outputs = FOUND
    signals = ASKED
    window, mean, anywhere = WINDOW, 4.0, True
    records = RECORDS
    reads = ("top.block", "top.hook_load", "surface_torque", "bit.depth", "axial_velocity", "rotation_rate")

    def __init__(self, scene: DrillstringScene) -> None:
        self.scene, self._first = scene, scene
        self.weight = float(scene.top.weight or 0.0)
        self.rig, self._slips = RigStates(Settings(block_weight=self.weight)), Slips()
        self._string, self._turning, self._gauge = 0.0, 0.0, _NO_GAUGE
        self.added = 0.0
        self._stands: list[float] = []
        self._connections, self._before = 0, 0
        self._hook_load = nan
        self._of_drive = True
        self._severity: Severity | None = None
        self._stick_slip: Any = None
        self._ends: dict[str, Any] = {}
        self._looked = -np.inf
        self._moved = nan, nan
        self._told_in = RigState.UNKNOWN
        self._weight_on_bit = nan
        self._interval, self._estimates, self._slow = RowInterval(), False, list[str]()
        self._remarks, self._unsaid = Remarks(), list[str]()
        self._lay_out()

    def _lay_out(self) -> None:
        """The string as a line for torsion, and as a soft string with a weight at its bit."""
        line = line_of(self.scene)
        if self._severity is None:
            self._severity = Severity(line, SeveritySettings(torque_of_drive=self._of_drive))
        else:
            self._severity.line = line
            self._severity.clear()
        self._at_bit = AtBit(self.scene, max(MEAN, 1.0 / line.frequency))
        highest, over = self._severity.settings.highest, self._at_bit.mean_over
        self._needed = Needed.of(self.mean, self._at_bit.axial, self._at_bit.torsional, highest, over)

    def built(self, sim: Any) -> None:
        """Learn what the string weighs.

        Raises
        ------
        SceneError
            For a bit on bottom.
        """
        if self.scene.bit.on_bottom:
            cause = "begins with the bit on bottom: what it carries would be computed, and not found from the hook load"
            cure = "write on_bottom: false for a twin; it tells drilling from rotating off bottom by itself"
            raise SceneError([self.scene.problem("bit.on_bottom", cause, cure)])
        weight = float(sim["top.hook_load"])
        self.rig.string_weighs(weight, self._lowered())
        self._string, self._turning = weight, self._turned().get("torque", 0.0)

    def sizes(self) -> dict[str, float]:
        """What the string weighs at the hook and takes to turn off bottom, with the friction of the scene, N and N m.

        A string that is lowered shows no torque at all. A share of that is no noise of the sensor.
        """
        sizes = self._turned()
        return {name: sizes[kind] for name, kind in KNOWN_AS.items() if kind in sizes}

    def _turned(self) -> dict[str, float]:
        """The same by kind of signal."""
        turning = self._moved_as("rotating")
        if turning is None or turning.locked is not None:
            return {}
        return {"hook_load": abs(turning.hook_load), "torque": abs(turning.surface_torque)}

    def doubts(self, plan: Plan) -> list[str]:
        """A hook load that has the block's weight in it, where the scene states that weight and the map no zero."""
        self._estimates = any(not one.is_offset for one in plan.unknowns)
        self._gauge = _gauge_of(plan)
        weight = quantity(self.weight, "N")
        return [
            f"{one.column}: top.weight says that block and top drive weigh {weight}, and the sensor's zero is 0. The "
            f"simulation's hook load is that of the string alone. If the gauge shows the block too, write `zero:` with "
            f"its reading of the empty block, in the unit of the column; if it does not, leave top.weight out."
            for one in plan.measured
            if self.weight > 0.0 and KNOWN_AS.get(one.name) == "hook_load" and one.zero == 0.0 and not one.zero_first
        ]

    def _lowered(self) -> float:
        """Hook load, N, of the string that is lowered with the friction of the scene; nothing where it locks up."""
        lowered = self._moved_as("slack_off")
        if lowered is None:
            return nan
        return lowered.hook_load if lowered.locked is None else 0.0

    def _moved_as(self, motion: str) -> SoftString | None:
        """The string off bottom in a motion of `soft_string`, with the friction of the scene; None without a wall."""
        well, wall = well_of(self.scene), self.scene.well.wall
        if wall is None:
            return None
        tubes = tubes_of(self.scene, well.length)
        weight = weight_per_length(self.scene, tubes)
        return soft_string(well, tubes, weight, factors_of(wall, "kinetic"), motion, hole=self.scene.well.diameter)

    # -- a row ---------------------------------------------------------------------------------------------------------

    def before(self, time: float, values: Mapping[str, float]) -> Guidance:
        """Find the state of the rig, and say how the row is to be taken."""
        self._slow = self._needed.lost(self._interval.add(time), estimates=self._estimates)
        self._unsaid += self._remarks.new(self._slow)
        signals = {KNOWN_AS.get(name, name): value for name, value in values.items()}
        asked = {name: signals.get(name, nan) for name in ASKED}
        # A rig's hook load has the block's weight in it; that of the scene has not.
        asked["hook_load"] += self.weight
        self._hook_load = asked["hook_load"]
        self._moved = asked["block"], asked["rotary_speed"]
        of_drive = not any(name in values for name in STRING_TORQUE)
        if of_drive != self._of_drive:
            self._of_drive, self._severity = of_drive, None
            self._lay_out()
        state = self.rig.add(time, **asked)
        turns = abs(asked["rotary_speed"]) > SLOWEST_TURN
        torque = asked["torque"] if turns else 0.0
        known = state is not RigState.UNKNOWN
        self._slips.add(time, state in IN_THE_SLIPS, asked["hook_load"], torque, self._expected(), known)
        if state in IN_THE_SLIPS:
            self._at_bit.clear()
            self._stick_slip = None
            return Guidance(use=False, paused=True)
        self._look(time, asked)
        use = state in OFF_BOTTOM and time - self.rig.since >= STARTING
        return Guidance(use=use, scene=self._longer(), rests=state in RESTING)

    def _expected(self) -> Expected:
        """What a gauge that is right shows while the string stands in slips."""
        gauge = self._gauge
        block = max(self.weight, abs(gauge.zero))
        return expected(block, self._string, self._turning, gauge.noise, gauge.offset, self.weight)

    def contradicted(self) -> dict[str, str]:
        """A hook gauge by which the string stands in slips, where it cannot."""
        slips, gauge = self._slips, self._gauge
        wrong = "Unit or zero of the sensor is wrong, or it is dead"
        if isfinite(slips.below):
            why = f"{gauge.column} shows {gauge.tell(slips.below)} less than the empty hook would"
            return {
                gauge.name: f"{why}. {wrong}; or top.weight is not right, or the block is set down or pushes the string"
            }
        if isfinite(slips.turning):
            why = f"by {gauge.column} the string stands in slips, and it turns with {quantity(slips.turning, 'N m')}"
            others = "or a joint is made up, or the rotary table turns the string in slips"
            return {gauge.name: f"{why}. {wrong}; or top.weight is not right, {others}"}
        return {}

    def summary(self) -> list[tuple[str, str]]:
        """For how long the string stood in slips, which no estimate comes from, and what the last rows do not tell."""
        rows = [("cannot be told", one) for one in self._at_bit.lost]
        if self._slips.in_them > 0.0:
            long = f"{self._slips.in_them:.0f} s of {self._slips.watched:.0f} s"
            rows.append(("in slips or connection", f"{long}; nothing is compared there"))
        return rows

    def remarks(self) -> list[str]:
        """What rows that come slowly do not tell, once of each subject, however often the twin is begun again."""
        unsaid, self._unsaid = self._unsaid, []
        return [f"cannot be told: {one}" for one in unsaid]

    def _longer(self) -> DrillstringScene | None:
        """The string that came out of the slips, where it is longer or shorter than before."""
        new = self.rig.connections[self._connections :]
        self._connections = len(self.rig.connections)
        added = sum(one.added for one in new if abs(one.added) >= STAND)
        return self._grown(added) if added else None

    def _grown(self, added: float) -> DrillstringScene:
        self.added += added
        self._stands.append(added)
        self.scene = with_stand(self.scene, added)
        self._lay_out()
        return self.scene

    def counts(self, read: Mapping[str, np.ndarray], sensors: Sequence[str]) -> np.ndarray:
        """Which sensors tell of friction: none where parts of the string rest, and the torque where it turns."""
        around, along = read["rotation_rate"], read["axial_velocity"]
        turns = np.all(np.abs(around[..., 0]) > SLOWEST_TURN)
        if turns:
            tells = np.all(np.abs(around - around[..., :1]) <= SLIDES * np.abs(around[..., :1]))
        else:
            slides = np.all(np.abs(along[..., 0]) > SLOWEST)
            tells = slides and np.all(along * np.sign(along[..., :1]) >= SLIDES * np.abs(along[..., :1]))
        return np.array([bool(tells and (turns or KNOWN_AS.get(name) != "torque")) for name in sensors])

    def found(
        self, time: float, measured: Mapping[str, tuple[float, float]], outputs: Mapping[str, tuple[Any, Any]],
        estimates: Mapping[str, tuple[float, float]], sim: Any,
    ) -> dict[str, tuple[float, float]]:  # fmt: skip
        """Where the bit is; and on bottom its weight and torque, from what hook and drive show beside a string without.

        The weight also changes the friction of the string, and makes it shorter than it is computed: where the weight
        is not known, nor is the depth.
        """
        depth, sd = (float(x) for x in outputs["bit.depth"])
        before, self._told_in = self._told_in, self.rig.state
        if self.rig.state is not before:
            # A string that begins to turn has another friction.
            self._at_bit.clear()
        if self.rig.state not in ON_BOTTOM:
            self._weight_on_bit = nan
            return {"bit.depth": (depth, sd)} | self._swinging()
        sensors = {KNOWN_AS[name]: name for name in measured if name in KNOWN_AS}
        values, known = {}, {}
        for kind in ("hook_load", "torque"):
            if (name := sensors.get(kind)) is not None:
                value, noise = measured[name]
                computed, of_computed = (float(x) for x in outputs[name])
                values[kind], known[kind] = (computed, value - computed), Known(noise, of_computed)
        load, torque = values.get("hook_load", (nan, nan)), values.get("torque", (nan, nan))
        self._at_bit.add(AtSurface(time, *self._moved, load[0], torque[0], -load[1], torque[1]))
        told = self._at_bit.told(known.get("hook_load"), known.get("torque"), estimates)
        self._weight_on_bit = told.get("bit.weight", (nan, nan))[0]
        shorter, of_shorter = self._at_bit.shorter
        if isfinite(shorter):
            # Without it the bit would be told a decimetre too deep, and as if that were exact.
            told["bit.depth"] = depth - shorter, hypot(sd, of_shorter)
        return told | self._swinging()

    def simulated(self, sim: Any) -> dict[str, float]:
        """What a rig would measure of a simulation; of its pumps that knows nothing."""
        found = {kind: float(sim[name]) for name, kind in KNOWN_AS.items() if name in sim.outputs}
        found["hook_load"] += self.weight
        hole = "hole_depth" in sim.outputs
        return found | {"hole_depth": float(sim["hole_depth"]) if hole else well_of(self.scene).length}

    # -- stick-slip ----------------------------------------------------------------------------------------------------

    def _look(self, time: float, asked: Mapping[str, float]) -> None:
        """Follow the torque at the surface, while the string turns."""
        assert self._severity is not None
        if not abs(asked["rotary_speed"]) > SLOWEST_TURN:
            self._severity.clear()
            self._stick_slip, self._ends = None, {}
            return
        self._severity.add(time, asked["torque"], asked["rotary_speed"])
        if time - self._looked >= SEVERITY_EVERY:
            self._looked = time
            self._stick_slip = self._severity.stick_slip()
            drills = self._stick_slip is not None and self.rig.state is RigState.DRILLING
            self._ends = self._what_ends_it() if drills else {}

    def _swinging(self) -> dict[str, tuple[float, float]]:
        found = self._stick_slip
        return {} if found is None else {"bit.stick_slip": (found.severity, found.sd)}

    def told(self) -> dict[str, Any]:
        """The rig in a line: its state, connections so far, pipe added, what would end stick-slip, what is missing."""
        rig: dict[str, Any] = {
            "state": str(self.rig.state), "since": self.rig.since, "added": self.added,
            "connections": self._before + self._connections,
            "cannot_be_told": [*self.rig.lost(), *self._slow, *self._at_bit.lost],
        }  # fmt: skip
        if self._ends:
            rig["stick_slip_ends"] = self._ends
        return {"rig": rig}

    def _what_ends_it(self) -> dict[str, Any]:
        """What would end stick-slip: speed at this weight, weight at this speed, with standard deviations."""
        assert self._severity is not None
        if not self._weight_on_bit > 0.0:
            return {"text": "the weight on the bit is not known"}
        limit = sticking_limit(self.scene, self._severity.line, self._weight_on_bit, abs(self._stick_slip.mean))
        if isinstance(limit, str):
            return {"text": limit}
        return {
            "speed": limit.speed_needed, "speed_sd": limit.speed_sd, "weight": limit.weight_allowed,
            "weight_sd": limit.weight_sd,
        }  # fmt: skip

    def alarms(self) -> Iterator[tuple[str, bool, str, float]]:
        """Stick-slip that lasts: what a start of the rotary sets off dies out by itself."""
        assert self._severity is not None
        found = self._stick_slip
        sticks = found is not None and found.severity - found.sd > STICKING
        text = f"the bit's speed swings by {100.0 * found.severity:.0f} % of its mean" if sticks else ""
        yield "stick-slip", sticks, text, self._severity.span

    # -- to be kept over a restart -------------------------------------------------------------------------------------

    MADE_ANEW = ("scene", "_first", "weight", "_needed", "_gauge")

    def kept(self) -> dict[str, Any]:
        """Itself, with all that rows have shown."""
        return {"rig": self}

    def memory(self) -> dict[str, Any]:
        """What a later process needs to go on."""
        return {
            "added": self.added, "stands": self._stands, "of_drive": self._of_drive,
            "connections": self._before + self._connections, "rig": self.rig.memory(),
            "interval": self._interval.memory(), "said": self._remarks.memory(), "slips": self._slips.memory(),
        }  # fmt: skip

    def recall(self, memory: Mapping[str, Any]) -> DrillstringScene | None:
        """Go on from what an earlier process kept; gives the string as it had grown."""
        self.rig.recall(memory["rig"])
        self._before = int(memory["connections"])
        # States that were written before these were kept do not have them.
        if "interval" in memory:
            self._interval.recall(memory["interval"])
            self._remarks.recall(memory["said"])
        if "slips" in memory:
            self._slips.recall(memory["slips"])
        if memory.get("of_drive", True) is not self._of_drive:
            self._of_drive, self._severity = not self._of_drive, None
            self._lay_out()
        # Lengths are added one after the other, as they were: their sum would be another number in its last digit.
        for added in memory.get("stands", [memory["added"]] if memory["added"] else []):
            self._grown(float(added))
        return self.scene if self._stands else None
