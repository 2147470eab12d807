"""Which rotary speed and which weight on bit would end stick-slip, in closed form.

A bit whose torque falls with speed, T = W (t_k + e exp(-Omega / d)), feeds an oscillation. Of one that just does not
stick, Omega (1 + cos(phi)), the first harmonic of the torque is (harmonic balance, with the modified Bessel function)

    N = (1 / pi Omega) int T cos(phi) dphi = -2 e W exp(-x) I1(x) / Omega,    x = Omega / d,

and the string with its drive takes R from it, the real part of the impedance that the bit meets at the frequency at
which it swings by itself (torsional_line.py). Sticking ends where R + N = 0: above that speed, below that weight. With
exp(-x) I1(x) -> x / 2 for a small x no speed sticks where e W / d < R.
"""

from __future__ import annotations

from math import hypot, inf
from typing import Any, NamedTuple

from drillstring.scene.scene import scene_of
from drillstring.twin.torsional_line import TorsionalLine

MODEL = 0.07
"""Relative standard deviation of the limits by what harmonic balance leaves out, from runs of the model."""
DAMPING = 0.3
"""Relative standard deviation of the damping along the string."""
FASTEST = 1e3
"""rad/s, above which no limit is looked for."""


class StickingLimit(NamedTuple):
    """What would end stick-slip.

    At ``weight`` N it ends above ``speed_needed`` rad/s (0 where it sticks at no speed), at ``speed`` rad/s below
    ``weight_allowed`` N (inf where no weight makes it stick); each with its standard deviation.
    """

    weight: float
    speed: float
    speed_needed: float
    speed_sd: float
    weight_allowed: float
    weight_sd: float

    @property
    def sticks(self) -> bool:
        """Whether it is expected to stick as it is drilled."""
        return self.speed < self.speed_needed


def sticking_limit(scene: Any, line: TorsionalLine, weight: float, speed: float) -> StickingLimit | str:
    """What would end stick-slip at a weight on bit, N, and a rotary speed, rad/s.

    Returns
    -------
    StickingLimit or str
        In place of one, why there is none: the scene's bit has no torque that falls with speed in a known way.

    Raises
    ------
    SceneError, ArgumentTypeError
        As `scene_of` does, for what is no scene of a drill string.
    """
    scene = scene_of(scene)
    law = scene.bit.torque
    if law is None or law.static <= law.kinetic:
        return "the scene's bit has no torque that falls with speed: what makes it stick is not known (bit.torque)"
    if law.decay is None:
        return "the torque of the scene's bit falls at once: give bit.torque.decay, or run `drillstring stick-slip`"
    at = law.weight or scene.bit.weight
    if not at:
        return "the scene's bit torque holds at no known weight: give bit.torque.weight"
    excess = (law.static - law.kinetic) / at
    speeds, weights = [], []
    for damped in (1.0, 1.0 + DAMPING):
        resistance = line.resonance(damped)[1]
        speeds.append(_speed_needed(excess * weight, law.decay, resistance))
        feeding = -fed(excess, law.decay, abs(speed))
        weights.append(resistance / feeding if feeding > 0.0 else inf)
    needed, allowed = speeds[0], weights[0]
    return StickingLimit(
        weight, speed, needed, hypot(MODEL * needed, speeds[1] - needed), allowed,
        hypot(MODEL * allowed, weights[1] - allowed) if allowed < inf else inf,
    )  # fmt: skip


def fed(excess: float, decay: float, speed: float) -> float:
    """Torque that the bit feeds into an oscillation that just reaches rest, over its amplitude, N m s/rad: negative.

    ``excess`` N m at rest above the torque at high speed, ``decay`` and ``speed`` rad/s.
    """
    from scipy.special import ive

    if speed == 0.0:
        return -excess / decay
    return -2.0 * excess * float(ive(1, speed / decay)) / speed


def _speed_needed(excess: float, decay: float, resistance: float) -> float:
    """Rotary speed, rad/s, at which feeding is as large as the resistance; the former falls with speed."""
    from scipy.optimize import brentq

    if excess / decay <= resistance:
        return 0.0
    if resistance + fed(excess, decay, FASTEST) < 0.0:
        return inf
    return float(brentq(lambda speed: resistance + fed(excess, decay, speed), 0.0, FASTEST))
