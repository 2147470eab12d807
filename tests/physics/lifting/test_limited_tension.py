"""A winch that holds a tension, and that its torque limit holds back for a while.

The rope runs straight from the drum to an anchor, so light and so stiff that it is a spring with a dashpot: the tension
is T = k (x + tau x.), with k = EA / L and the rope x that the drum has taken in. The drum is a mass m = I / R^2 at its
rim,

    m x.. = F - T,   F = N + p (N - T) + i S within the limit / R,

    S. = N - T where F is within the limit, or N - T drives it back from there; else 0,

for a tension N that is asked for. An own loop integrates this by Heun's method in steps of a fifth of the run's.
"""

import numpy as np
import pytest
from physics.lifting.crane_scenes import anchor, crane, drum, ran

RADIUS, INERTIA, STIFFNESS, LENGTH, DAMPING = 0.3, 200.0, 2.0e7, 10.0, 0.01
PROPORTIONAL, INTEGRAL, LIMIT = 2.0, 5.0, 7500.0
ASKED = {"time": [0.0, 0.2, 0.3, 1.3, 1.4, 3.0], "value": [20.0e3, 20.0e3, 40.0e3, 40.0e3, 22.0e3, 22.0e3]}
"""N over s; the limit is 25 kN at the rim."""
NEAR = {"time": [0.0, 3.0], "value": [24.0e3, 24.0e3]}
"""So near to the limit that the overshoot of the start, which an integral alone does not damp, passes it."""
STEP = 2.0e-3


def held_back(table=ASKED, proportional=PROPORTIONAL, integral=INTEGRAL):
    """Time and tension of a run."""
    controlled = {"gains": {"proportional": proportional, "integral": integral}, "torque_limit": LIMIT}
    drive = {"tension": {"table": table | {"interpolation": "linear"}}, "inertia": INERTIA, **controlled}
    rope = {"mass_per_length": 1.0e-3, "axial_stiffness": STIFFNESS, "damping": DAMPING, "strain": "engineering"}
    path = [drum((0.0, 0.0, 0.0), RADIUS, **drive), anchor((LENGTH, 0.0, RADIUS), "wall")]
    solver = {"step": STEP, "end": table["time"][-1]}
    result = ran(crane(path, rope=rope, solver=solver, mesh={"elements_per_span": 1}, interval=5 * STEP))
    return result["time"], result["drum_tension"][:, 0]


def integrated(time, table=ASKED, proportional=PROPORTIONAL, integral=INTEGRAL, step=STEP / 5.0):
    """Tension by the equations above, at times of frames, from a rope that is not stretched."""
    stiffness, mass, most = STIFFNESS / LENGTH, INERTIA / RADIUS**2, LIMIT / RADIUS
    steps = round(time[-1] / step)
    asked = np.interp(step * np.arange(steps + 2), table["time"], table["value"]).tolist()

    def rates(k, x, v, s):
        tension = stiffness * (x + DAMPING * v)
        lack = asked[k] - tension
        force = asked[k] + proportional * lack + integral * s
        gathers = abs(force) < most or force * lack < 0.0
        return v, (min(max(force, -most), most) - tension) / mass, lack if gathers else 0.0

    x, v, s, found = 0.0, 0.0, 0.0, []
    for k in range(steps + 1):
        found.append(stiffness * (x + DAMPING * v))
        x1, v1, s1 = rates(k, x, v, s)
        x2, v2, s2 = rates(k + 1, x + step * x1, v + step * v1, s + step * s1)
        x, v, s = x + 0.5 * step * (x1 + x2), v + 0.5 * step * (v1 + v2), s + 0.5 * step * (s1 + s2)
    return np.interp(time, step * np.arange(steps + 1), found)


def test_a_winch_at_its_torque_limit_gathers_no_integral_and_holds_the_next_tension_at_once():
    time, tension = held_back()
    limited, after = (time > 1.0) & (time < 1.3), time > 2.4
    assert tension[limited] == pytest.approx(LIMIT / RADIUS, rel=5.0e-3)
    # an integral that had grown by 15 kN for a second would keep the winch at its limit for five seconds more
    assert tension[after] == pytest.approx(22.0e3, rel=5.0e-3)
    assert np.abs(tension - integrated(time)).max() < 4.0e-3 * LIMIT / RADIUS


def test_a_winch_with_an_integral_alone_comes_back_from_its_torque_limit_to_its_tension():
    gains = {"proportional": 0.0, "integral": 2.0}
    time, tension = held_back(NEAR, **gains)
    expected = integrated(time, NEAR, **gains)
    assert expected.max() > LIMIT / RADIUS
    # an integral that stays as it is at the limit holds the limit, 25 kN, for ever
    assert tension[time > 2.4] == pytest.approx(24.0e3, rel=5.0e-3)
    assert np.abs(tension - expected).max() < 4.0e-3 * LIMIT / RADIUS
