"""Records of a rig that the model itself makes: connections in a row, as an estimate of friction wants them.

At every connection the string, a stand longer than before, hangs in the slips while the block fetches the stand; then
it is picked up, slacked off and turned off bottom, which a run of the model answers, and the sensors are disturbed.
What is drilled between connections is left out: the record has a gap there, after which the string stands a stand
deeper and the block where it will be when the slips are set.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import inf
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from drillstring.model.build import build
from drillstring.scene.ends import Controller
from drillstring.scene.scene import DrillstringScene, scene_of
from drillstring.twin.stands import bit_depth, with_stand
from tautline.arguments import (
    ABOVE_ZERO,
    COUNT,
    MAPPING,
    PATH,
    Wanted,
    check,
    check_choices,
    check_given,
    is_number,
    is_whole,
)
from tautline.results.tables.rows import heads_of, write_rows
from tautline.scene.reading.document import Path_
from tautline.simulation import simulate

COLUMNS = ("time", "block", "hook_load", "rotary_speed", "torque", "flow", "bit_depth", "hole_depth")
UNITS = {
    "time": "s", "block": "m", "hook_load": "N", "rotary_speed": "rad/s", "torque": "N m", "flow": "m^3/s",
    "bit_depth": "m", "hole_depth": "m",
}  # fmt: skip
NOISE = MappingProxyType({"hook_load": 0.01, "torque": 0.01})
ORIGIN = "a record"
SHARES = Wanted(
    'a mapping of columns to shares, such as {"hook_load": 0.01}',
    MAPPING.is_one,
    lambda shares: all(is_number(share) and 0.0 <= share < inf for share in shares.values()),
)
SEED = Wanted(
    "a whole number from 0 on, a Generator of numpy, or None for another noise each time,",
    lambda value: value is None or isinstance(value, np.random.Generator) or is_whole(value),
    lambda value: not is_whole(value) or value >= 0,
)
TABLE = Wanted('a mapping of names to values, such as {"time": [0.0, 0.1]}', MAPPING.is_one)


@dataclass(frozen=True)
class Connecting:
    """What is done at every connection.

    Attributes
    ----------
    stand : float
        Length of a stand, m.
    speed : float
        Block speed of pick-up and slack-off, m/s, reached in ``ramp`` s.
    travel : float
        Time, s, at that speed, up and down again.
    rotary_speed, turning : float
        rad/s, reached in ``ramp`` s, and for how long, s.
    rest : float
        Time at rest before, between and after these, s.
    in_slips : float
        Time in slips before every one, s; none where zero. Most of it the block goes up by a stand.
    drilling : float
        Time between connections that is left out of the record, s.
    flow : float
        While the string is turned, m^3/s.
    transfer : float
        Time, s, in which the block takes the weight out of the slips.
    off_bottom : float
        Depth of the hole below the bit where the block is at its lowest, m.
    """

    stand: float = 28.0
    speed: float = 0.2
    travel: float = 15.0
    rotary_speed: float = 8.0
    turning: float = 30.0
    ramp: float = 2.0
    rest: float = 5.0
    in_slips: float = 90.0
    drilling: float = 600.0
    flow: float = 0.03
    transfer: float = 3.0
    off_bottom: float = 1.5

    @property
    def moving(self) -> float:
        """Time of the motions, s, which the model runs."""
        return 4.0 * self.rest + 2.0 * (self.travel + self.ramp) + self.turning + 2.0 * self.ramp

    def block(self) -> dict[str, Any]:
        """Block speed as a function of time of a scene: up, and as far down."""
        down = self.rest + self.travel + self.ramp + self.rest
        steps = ((self.rest, -1.0), (self.rest + self.travel, 1.0), (down, 1.0), (down + self.travel, -1.0))
        return {"velocity": {"sum": [self._step(at, sign * self.speed) for at, sign in steps]}}

    def rotation(self) -> dict[str, Any]:
        """Rotary speed as a function of time of a scene."""
        at = 3.0 * self.rest + 2.0 * (self.travel + self.ramp)
        steps = ((at, self.rotary_speed), (at + self.ramp + self.turning, -self.rotary_speed))
        return {"sum": [self._step(*one) for one in steps]}

    def _step(self, at: float, to: float) -> dict[str, Any]:
        return {"ramp": {"to": to, "over": self.ramp, "at": at}}


MOTIONS = Wanted("a Connecting, such as Connecting(stand=28.0),", lambda value: isinstance(value, Connecting))


def connections(
    scene: Any,
    count: int = 10,
    how: Connecting | None = None,
    *,
    rate: float = 10.0,
    noise: Mapping[str, float] = NOISE,
    seed: int | np.random.Generator | None = 0,
) -> dict[str, np.ndarray]:
    """A record of connections in a row, each with the string a stand deeper.

    Parameters
    ----------
    scene : DrillstringScene, path, text or dict
        The string at the first connection. Its bit is taken off bottom; its ``top.weight``
        is in the hook load, as a rig measures it.
    count : int
        Connections.
    how : Connecting, optional
        What is done at each.
    rate : float
        Samples a second.
    noise : mapping
        Column -> standard deviation of white noise as a share of the reading; 1 % of hook load and torque.
    seed : int, Generator or None
        Of the noise: the same number makes the same. A generator goes on from where it is, and None is another noise
        each time.

    Returns
    -------
    dict
        `COLUMNS`, each (samples,), SI. Time rises throughout. ``bit_depth`` is the unstretched string's length and how
        far down the block is: what a rig's tally of pipe shows. ``torque`` is the drive's where the scene has one.

    Raises
    ------
    SceneError
        As `with_stand` does.
    ArgumentTypeError, ArgumentError
        For what is no scene of a drill string, and for another argument that is none.
    StoppedEarly
        Where a run does.
    """
    check_given(count=(count, COUNT), rate=(rate, ABOVE_ZERO), noise=(noise, SHARES), seed=(seed, SEED))
    check(how=(how, MOTIONS))
    check_choices("noise", noise, COLUMNS)
    how = how or Connecting()
    parts = list(_parts(scene_of(scene), count, how, rate))
    columns = {name: np.concatenate([part[name] for part in parts]) for name in COLUMNS}
    random = np.random.default_rng(seed)
    for name, share in noise.items():
        columns[name] = columns[name] * (1.0 + share * random.standard_normal(columns[name].size))
    return columns


def write(columns: Mapping[str, np.ndarray], path: str | Path) -> Path:
    """Write columns as CSV: names in the header, with the units of `UNITS`, as twins read them, and all digits.

    Raises
    ------
    ResultError
        If the file cannot be written.
    ArgumentTypeError
        For what is no mapping, and for what is no path.
    """
    check_given(columns=(columns, TABLE), path=(path, PATH))
    return write_rows(heads_of(list(columns), UNITS), np.column_stack(list(columns.values())).tolist(), Path(path))


def _parts(scene: DrillstringScene, count: int, how: Connecting, rate: float) -> Iterator[dict[str, np.ndarray]]:
    """Rows in slips and rows in motion, one connection after another."""
    time = 0.0
    for k in range(count):
        if k:
            scene = with_stand(scene, how.stand)
            time += how.drilling
        moved = _moved(scene, how, rate)
        if how.in_slips > 0.0:
            held = _held(how, rate, float(moved["hook_load"][0]), scene.top.weight, float(moved["bit_depth"][0]))
            yield held | {"time": held["time"] + time}
            time += how.in_slips
        yield moved | {"time": moved["time"] + time}
        time += how.moving


def _moved(scene: DrillstringScene, how: Connecting, rate: float) -> dict[str, np.ndarray]:
    """What the model answers to the motions of one connection."""
    turning: Path_ = ("top", "rotation")
    if isinstance(scene.top.rotation, Controller):
        turning = (*turning, "controller", "speed")
    values: dict[Path_, Any] = {
        ("top", "block"): how.block(), turning: how.rotation(), ("bit", "on_bottom"): False,
        ("solver", "end"): how.moving, ("output", "interval"): 1.0 / rate,
    }  # fmt: skip
    result = simulate(build(scene.with_values({path: (value, ORIGIN) for path, value in values.items()})))
    # The last frame is the first of what comes next.
    keep = slice(0, round(how.moving * rate))
    depth = bit_depth(scene)
    spin = result["rotation_rate"][keep, 0]
    block = result["block_position"][keep]
    return {
        "time": result["time"][keep],
        "block": block,
        "hook_load": result["hook_load"][keep] + scene.top.weight,
        "rotary_speed": spin,
        "torque": (result["drive_torque"] if "drive_torque" in result else result["surface_torque"])[keep],
        "flow": np.where(np.abs(spin) > 0.01 * how.rotary_speed, how.flow, 0.0),
        "bit_depth": depth + block,
        "hole_depth": np.full(block.size, depth + how.off_bottom),
    }


def _held(how: Connecting, rate: float, load: float, empty: float, depth: float) -> dict[str, np.ndarray]:
    """Rows in slips: the block goes up by a stand and takes the string up; its place is zero after that."""
    time = np.arange(round(how.in_slips * rate)) / rate
    carried = np.clip((time - how.in_slips) / how.transfer + 1.0, 0.0, 1.0)
    rising = np.clip((time - 0.1 * how.in_slips) / (0.6 * how.in_slips), 0.0, 1.0)
    still = np.zeros_like(time)
    return {
        "time": time,
        "block": how.stand * (1.0 - rising**2 * (3.0 - 2.0 * rising)),
        "hook_load": empty + carried * (load - empty),
        "rotary_speed": still,
        "torque": still,
        "flow": still,
        "bit_depth": np.full_like(time, depth),
        "hole_depth": np.full_like(time, depth + how.off_bottom),
    }
