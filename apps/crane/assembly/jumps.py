"""What begins suddenly at the start of a crane's run while the load rests, and what that adds to the tension.

A motion that begins at once swings the load on its rope, beside what the motion itself does. That is taken apart by a
second start: one that grows over some bounces leaves no bounce behind. What the sudden start leaves more is the bounce
of the start. How its waves add up in the rope is computed by `crane.assembly.rope_waves`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crane.assembly.estimates import Estimate
from crane.assembly.layout import entries_of
from crane.assembly.loads import pull_on
from crane.assembly.prepared import heave_of
from crane.assembly.rope_waves import bar_of, tensions
from crane.scene.scene import Anchor, Drum, End
from crane.sea.compensation import Compensation
from crane.sea.frames import point_of
from tautline.kernels.moving_frame import ENTRIES
from tautline.kernels.time_function import sample
from tautline.system.time_functions import FunctionRequest, compile_functions

SUDDEN = 0.01
"""Share of the tension at rest that a sudden start may add without a word."""
BOUNCES_SEEN = 4.0
"""Bounces of the load after the delay of a late actuator, over which its swing is looked for."""
GROWTH = 6.0
"""Bounces over which the motion grows that leaves no bounce behind."""
PER_BOUNCE = 100
"""Times in one bounce at which the rate is taken."""
FIRST, LATER = 0.8, 1.3
"""Bounces to the end of the first rise and drop; and after the delay of a late actuator."""
ROUNDING = 1e-9
"""Speed over acceleration, s, of a point that rests at its turn but for rounding."""
PER_TRANSIT, MOST_STEPS = 200, 6000
"""Steps in the time of a wave along the whole rope, where they are not too many."""


class Jumps(NamedTuple):
    """Motion at t = 0 of what the load hangs on, while the load rests, and what it adds to the motion's own tension.

    Attributes
    ----------
    fastest : float
        Largest speed of a point of the path in a moving frame, m/s, and `point`, its name.
    acceleration : float
        Of that point, m/s^2; where none has a speed, of the point that is accelerated most.
    drums : tuple of (Drum, float)
        Drums that pay out by prescription, and the speed that their operators ask for, m/s, positive out.
    answer : float
        Speed at which heave compensation pays out at each of them, m/s.
    front, pulled : float
        Largest of the fronts that run along the rope, N, and the speed along the rope that makes it, m/s.
    swing : float
        Tension that the bounce of the load adds and takes, N.
    rise, drop : float
        Largest tension that fronts and bounce together add anywhere in the rope in the first bounce, and take, N.
    sway : float
        Angle by which the load begins to swing sideways, rad.
    late : bool
        Whether the actuator rests at t = 0 and has to catch up: then the swing is that of its whole start.
    """

    fastest: float
    point: str
    acceleration: float
    drums: tuple[tuple[Drum, float], ...]
    answer: float
    front: float = 0.0
    pulled: float = 0.0
    swing: float = 0.0
    rise: float = 0.0
    drop: float = 0.0
    sway: float = 0.0
    late: bool = False


def jumps_of(found: Estimate, actuator: Compensation | None) -> Jumps:
    """Add up with their signs all motions that begin at t = 0: the load feels their sum only.

    Parameters
    ----------
    found : Estimate
    actuator : Compensation or None
        Of the heave compensation, where there is one: every drum that pays out by prescription pays it out too.
    """
    begin = np.zeros(1)
    fastest, point = _largest(found, order=1)
    acceleration, accelerated = _largest(found, order=2)
    if fastest <= ROUNDING * acceleration:
        fastest, point = 0.0, ""
    moves = max(fastest, acceleration) > 0.0
    answer = float(_answers(actuator, begin)[0]) if actuator is not None and moves else 0.0
    drums = tuple((drum, float(_asked(found, drum, begin)[0])) for drum in found.scene.drums if drum.prescribed)
    jumps = Jumps(fastest, point or accelerated, acceleration, drums, answer)
    if not moves and not any(speed for _, speed in drums):
        return jumps
    heave = found.impedance * fastest, _bounce(found, _Start(found, None, False, moves=moves, pays=False))
    # a limit that is met later has nothing to do with the start: it is told with its share of the run
    late = actuator is not None and actuator.away > 0.0 and answer == 0.0 and moves
    late = late and max(heave) > SUDDEN * found.largest_tension
    start = _Start(found, actuator, late, moves=moves, pays=True)
    rise, drop = _first_waves(found, start)
    pulled = _pulled(found, drums, answer)
    return jumps._replace(
        front=found.impedance * pulled,
        pulled=pulled,
        swing=_bounce(found, start),
        rise=rise,
        drop=drop,
        sway=_sway(found),
        late=late,
    )


class _Start:
    """Speeds of all that begins to move at t = 0; what rests then begins to move later, which is no matter of it."""

    def __init__(self, found: Estimate, actuator: Compensation | None, late: bool, *, moves: bool, pays: bool) -> None:
        self.found, self.actuator, self.late, self.moves = found, actuator, late, moves
        self.drums = [drum for drum in found.scene.drums if drum.prescribed] if pays else []

    @property
    def delay(self) -> float:
        """Time until a late actuator begins to catch up, s; 0 without one."""
        asked = self.found.scene.heave_compensation
        return asked.delay if self.late and asked is not None else 0.0

    def paid(self, drum: Drum, time: np.ndarray, *, ready: bool) -> np.ndarray:
        """Speed (m,), m/s, at which a drum pays out; `ready` with an actuator that is at its command from t = 0 on."""
        speed = (
            _asked(self.found, drum, time) if _asked(self.found, drum, np.zeros(1))[0] != 0.0 else np.zeros(time.size)
        )
        if self.actuator is None or not self.moves:
            return speed
        return speed + (_answers(self.actuator, time) if self.late and not ready else self._ready(time))

    def _ready(self, time: np.ndarray) -> np.ndarray:
        """Speed (m,), m/s, of an actuator that is never late nor at a limit."""
        asked = self.found.scene.heave_compensation
        if asked is None:
            return np.zeros(time.size)
        return asked.gain * sample(compile_functions([FunctionRequest(heave_of(self.found.scene))]), 0, time)[:, 1]

    def ends(self, time: np.ndarray, *, ready: bool = False, turns: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Speed of the begin and the end of each span along it, 2 of (m, spans) m/s, with the load at rest.

        A span whose ends move across it turns, and lengthens: with `turns`.
        """
        found, path = self.found, self.found.path
        count = len(path.spans)
        first, last = np.zeros((time.size, count)), np.zeros((time.size, count))
        speeds = _moved(found, time, 1) if self.moves else {}
        away = {i: places - places[:1] for i, places in _moved(found, time, 0).items()} if turns and speeds else {}
        for k, span in enumerate(path.spans):
            along = span.length * np.asarray(span.e) + away.get(k + 1, 0.0) - away.get(k, 0.0)
            along = np.broadcast_to(along, (time.size, 3)) / np.linalg.norm(along, axis=-1, keepdims=True)
            if k in speeds:
                first[:, k] = np.einsum("mi,mi->m", speeds[k], along)
            if k + 1 in speeds:
                last[:, k] = np.einsum("mi,mi->m", speeds[k + 1], along)
        for drum in self.drums:
            if drum is found.scene.path[0]:
                first[:, 0] += self.paid(drum, time, ready=ready)
            else:
                last[:, -1] -= self.paid(drum, time, ready=ready)
        return first, last

    def rate(self, time: np.ndarray, *, ready: bool, turns: bool = False) -> np.ndarray:
        """Rate (m,), m/s, at which all of it together lengthens the rope."""
        first, last = self.ends(time, ready=ready, turns=turns)
        return (last - first).sum(axis=1)

    def at_once(self) -> np.ndarray:
        """Part of the speeds of the ends of the spans at t = 0 that drums pay out, (spans, 2) m/s."""
        paid = np.zeros((len(self.found.path.spans), 2))
        for drum in self.drums:
            speed = float(self.paid(drum, np.zeros(1), ready=False)[0])
            paid[(0, 0) if drum is self.found.scene.path[0] else (-1, 1)] = (
                speed if drum is self.found.scene.path[0] else -speed
            )
        return paid


def _hung(found: Estimate) -> list[tuple[int, int]]:
    """Numbers of the items of the path in moving frames, and of the first entry of their frames."""
    layout = found.layout
    if found.scene.start != "static" or not layout.frames:
        return []
    frames = [(i, int(layout.wheels.frame[i])) for i in range(len(found.scene.path))]
    rides = [getattr(item, "body", None) is not None for item in found.scene.path]
    return [(i, frame) for i, frame in frames if not rides[i] and frame != layout.frame[-1]]


def _moved(found: Estimate, time: np.ndarray, order: int) -> dict[int, np.ndarray]:
    """Place (m, 3), m, at times (m,) of every item of the path in a moving frame, by its number, or a rate of it."""
    hung, layout = _hung(found), found.layout
    if not hung:
        return {}
    functions = compile_functions(layout.requests.of)
    places = {frame: range(frame, frame + ENTRIES) for _, frame in hung}
    rates = {frame: entries_of(layout.degrees, functions, at, time, order) for frame, at in places.items()}
    pivots = {layout.frame[k]: frame.pivot for k, frame in enumerate(layout.frames)}
    moved: dict[int, np.ndarray] = {}
    for i, frame in hung:
        item = found.scene.path[i]
        drawn = getattr(item, "center", None) or getattr(item, "position", None)
        moved[i] = point_of(rates[frame], pivots[frame], drawn or ())
    return moved


def _largest(found: Estimate, order: int) -> tuple[float, str]:
    """Largest speed at t = 0 of a point of the path in a moving frame, m/s, or acceleration, m/s^2, and its name."""
    largest, name = 0.0, ""
    for i, rates in _moved(found, np.zeros(1), order).items():
        size = float(np.linalg.norm(rates))
        if size > largest:
            largest, name = size, found.scene.path[i].name
    return largest, name


def _asked(found: Estimate, drum: Drum, time: np.ndarray) -> np.ndarray:
    """Speed (m,), m/s, at which the operator of a prescribed drum pays out."""
    drive, factor = (drum.pay_out, 1.0) if drum.drive == "pay_out" else (drum.speed, drum.radius)
    return factor * sample(compile_functions([FunctionRequest(drive)]), 0, time)[:, 0]


def _answers(actuator: Compensation, time: np.ndarray) -> np.ndarray:
    """Speed (m,), m/s, at which the actuator pays out."""
    return sample(compile_functions([FunctionRequest(actuator.pay_out)]), 0, time)[:, 1]


def _pulled(found: Estimate, drums: tuple[tuple[Drum, float], ...], answer: float) -> float:
    """Speed v of the largest front Z v, m/s: of an end along its span, and half of what a sheave takes either way."""
    path, scene = found.path, found.scene
    paid = {id(drum): speed + answer for drum, speed in drums}
    speeds = {i: velocity[0] for i, velocity in _moved(found, np.zeros(1), 1).items()}
    pulls = [0.0]
    for i, item in enumerate(scene.path):
        taken = -float(speeds[i] @ pull_on(path, i)) if i in speeds else 0.0
        if isinstance(item, (Drum, Anchor)):
            pulls.append(abs(taken - paid.get(id(item), 0.0)))
        elif not isinstance(item, End):
            pulls.append(0.5 * abs(taken))
    return max(pulls)


def _bounce(found: Estimate, start: _Start) -> float:
    """Tension, N, that a load on the rope as one spring adds and takes by the free bounce that the start leaves.

    The stretch of the spring is the real part of the integral of r(s) exp(i w (t - s)) over s, where r is the rate at
    which the rope is lengthened and w the bounce of the load. Of a motion that grows by a share g(s) the integral is
    that of g r, and the sudden start leaves that of (1 - g) r more. A late actuator adds its way to its command.
    """
    if found.frequency is None:
        return 0.0
    left = _left(found, start, turns=True)
    swing = np.abs(left) * np.ones(1)
    if start.late:
        end = min(float(found.scene.solver.end), start.delay + BOUNCES_SEEN / found.frequency)
        seen = np.linspace(0.0, end, max(2, math.ceil(end * found.frequency * PER_BOUNCE)))
        late = _turned(found, start.rate(seen, ready=False) - start.rate(seen, ready=True), seen)
        swing = np.abs((np.exp(2j * math.pi * found.frequency * seen) * (late + left)).real)
    return found.bounce_of(2.0 * math.pi * found.frequency * float(swing.max()))


def _turned(found: Estimate, rate: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Integral of r(s) exp(-i w s) from 0 to each time, (m,) m."""
    turned = rate * np.exp(-2j * math.pi * (found.frequency or 0.0) * time)
    return np.concatenate([[0.0], np.cumsum(0.5 * (turned[1:] + turned[:-1]) * np.diff(time))])


def _left(found: Estimate, start: _Start, *, turns: bool) -> complex:
    """Integral of `_turned` that the sudden start leaves more than one that grows slowly, m; `turns` as of `ends`."""
    time = np.linspace(0.0, GROWTH / (found.frequency or 1.0), int(GROWTH * PER_BOUNCE))
    x = time / time[-1]
    grown = x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
    return complex(_turned(found, (1.0 - grown) * start.rate(time, ready=True, turns=turns), time)[-1])


def _first_waves(found: Estimate, start: _Start) -> tuple[float, float]:
    """Largest tension that the start adds anywhere in the rope while the load bounces for the first time, and takes, N.

    It is that of the rope as a bar less that of the motion without a bounce.
    """
    rope, path = found.scene.rope, found.path
    transit = path.length / rope.wave_speed
    bounce = 0.0 if found.frequency is None else 1.0 / found.frequency
    end = 2.0 * transit + (LATER if start.late else FIRST) * bounce + start.delay
    step = _step(found, max(transit / PER_TRANSIT, end / MOST_STEPS))
    time = step * np.arange(max(2, math.ceil(end / step)))
    few = np.linspace(0.0, time[-1], max(2, math.ceil(PER_BOUNCE * max(1.0, end * (found.frequency or 0.0)))))
    first, last = (_between(speeds, few, time) for speeds in start.ends(few, turns=True))
    stiffness = rope.axial_stiffness / path.length
    added = tensions(bar_of(found, step), first, last, start.at_once(), step)
    added -= stiffness * np.interp(time, few, _without_bounce(found, start, few))[:, None, None]
    return max(0.0, float(added.max())), max(0.0, -float(added.min()))


def _step(found: Estimate, longest: float) -> float:
    """Step of the waves, s, of which the time along the shortest span is a whole number where it is longer than one."""
    shortest = float(found.path.chords.min()) / found.scene.rope.wave_speed
    return longest if shortest < longest else shortest / math.ceil(shortest / longest)


def _between(speeds: np.ndarray, few: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Speeds (n, spans) known at a few times, at many."""
    return np.stack([np.interp(time, few, speed) for speed in speeds.T], axis=1)


def _without_bounce(found: Estimate, start: _Start, time: np.ndarray) -> np.ndarray:
    """Stretch of the rope, (m,) m, that the motion makes by itself, had it grown slowly before."""
    rate = start.rate(time, ready=True)
    if found.frequency is None:
        return _turned(found, rate, time).real
    grown = _turned(found, rate, time) - _left(found, start, turns=False)
    return (np.exp(2j * math.pi * found.frequency * time) * grown).real


def _sway(found: Estimate) -> float:
    """Angle, rad, of the pendulum that a load becomes whose upper end begins to move across its span: v / sqrt(g l)."""
    scene, size = found.scene, float(np.linalg.norm(found.scene.gravity))
    speeds = {i: velocity[0] for i, velocity in _moved(found, np.zeros(1), 1).items()}
    largest = 0.0
    for k, span in enumerate(found.path.spans):
        for i, j in ((k, k + 1), (k + 1, k)):
            name = getattr(scene.path[j], "body", None)
            if i in speeds and name is not None and size > 0.0:
                across = speeds[i] - float(speeds[i] @ span.e) * np.asarray(span.e)
                free = [c for c, axis in enumerate("xyz") if axis not in scene.body(name).guide]
                largest = max(largest, float(np.linalg.norm(across[free])) / math.sqrt(size * span.length))
    return largest
