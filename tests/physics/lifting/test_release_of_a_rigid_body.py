"""A rigid body that drops a part of itself turns with the inertia that remains.

Reference: the two frequencies of a double pendulum, of a body of mass m and moment I on rope of length l that holds it
c above its centre: (m l^2, m l c; m l c, m c^2 + I) x.. + diag(m g l, m g c) x = 0.
"""

import numpy as np
import pytest
from physics.lifting.crane_scenes import GRAVITY, anchor, body, crane, end, parsed, ran

from tautline.scene.errors import SceneError

LENGTH, ARM, MASS, LEFT = 5.0, 1.5, 5000.0, 1000.0
WHOLE, REMAINS = [3000.0, 3000.0, 2000.0], [300.0, 300.0, 200.0]


def swinging(inertia=None, at=0.1, method="generalized-alpha", **release):
    """A body that is pushed along x and drops four fifths of its mass; its rope, as good as rigid, holds it above."""
    release = {"at": at, "remaining": LEFT} | ({} if inertia is None else {"inertia": inertia}) | release
    rope = {"mass_per_length": 1.0e-2, "axial_stiffness": 2.0e7, "damping": 1.0e-2}
    load = body("load", MASS, (0.0, 0.0, 0.0), inertia=WHOLE, velocity=[0.05, 0.0, 0.0], release=release)
    path = [anchor((0.0, 0.0, ARM + LENGTH)), end("load", offset=[0.0, 0.0, ARM])]
    solver = {"method": method, "step": 2.0e-3, "end": 40.0}
    return crane(path, [load], rope, mesh={"elements_per_span": 1}, solver=solver, interval=0.02)


def frequencies(inertia):
    mass = np.array([[LEFT * LENGTH**2, LEFT * LENGTH * ARM], [LEFT * LENGTH * ARM, LEFT * ARM**2 + inertia]])
    stiffness = LEFT * GRAVITY * np.diag([LENGTH, ARM])
    return np.sort(np.sqrt(np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real)) / (2.0 * np.pi)


@pytest.mark.parametrize(("given", "inertia"), [(REMAINS, 300.0), (None, 3000.0)])
def test_a_body_that_drops_most_of_itself_swings_with_the_inertia_that_remains(given, inertia):
    result = ran(swinging(given))
    turn = result["body_turn"][:, 0]
    late = result["time"] > 1.0
    angle = (2.0 * turn[:, 2] / turn[:, 0])[late] * np.hanning(late.sum())
    size = np.abs(np.fft.rfft(angle, 32 * late.sum()))
    at = np.fft.rfftfreq(32 * late.sum(), 0.02)
    slow, fast = frequencies(inertia)
    near = (at > 0.7 * fast) & (at < 1.4 * fast)
    assert at[near][size[near].argmax()] == pytest.approx(fast, rel=0.01)
    assert slow < 0.5 * fast


def test_what_remains_of_inertia_is_refused_where_it_cannot_be():
    for inertia, words in (([400.0, 100.0, 100.0], "no body is so"), ([3500.0, 3000.0, 2000.0], "more than the whole")):
        with pytest.raises(SceneError, match=words):
            parsed(swinging(inertia))
    point = swinging(REMAINS)
    del point["bodies"][0]["inertia"]
    with pytest.raises(SceneError, match="the body is a point"):
        parsed(point)
