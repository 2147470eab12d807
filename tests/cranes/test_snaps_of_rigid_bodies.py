"""A rigid body that is thrown into its rope: the peak of tension is that of a mass on a spring."""

import numpy as np
import pytest
from physics.lifting.crane_scenes import GRAVITY, anchor, body, crane, drum, end, model_of, ran

from crane.groups.sockets import Sockets

MASS, STIFFNESS, SPEED = 5000.0, 2.0e7, 0.5


@pytest.mark.parametrize("length", [0.3, 1.0, 20.0])
def test_a_snap_of_a_rigid_body_is_that_of_a_mass_on_the_rope(length):
    """m g + sqrt((m g)^2 + v^2 m EA / L), of a rope that begins unstretched and has next to no mass."""
    rope = {
        "mass_per_length": 0.01,
        "axial_stiffness": STIFFNESS,
        "damping": 0.0,
        "strain": "engineering",
        "length": length,
    }
    load = body("load", MASS, (0.0, 0.0, -length - 1.0), inertia=[3000.0, 3000.0, 900.0], velocity=[0.0, 0.0, -SPEED])
    made = crane(
        [anchor((0.0, 0.0, 0.0)), end("load", offset=(0.0, 0.0, 1.0))], [load], rope, mesh={"elements_per_span": 1},
        start="as drawn", solver={"end": 0.06 if length < 2.0 else 0.2, "step": 2.0e-4, "rho_inf": 0.9},
        interval=5.0e-4,
    )  # fmt: skip
    weight = MASS * GRAVITY
    expected = weight + np.sqrt(weight**2 + SPEED**2 * MASS * STIFFNESS / length)
    assert ran(made)["tension"].max() == pytest.approx(expected, rel=5.0e-3)


def test_a_socket_is_stiff_beside_the_rope_that_is_left_when_the_load_is_hoisted():
    """Of 10 m of rope 8 m are hoisted in: a hundred times the stiffness of 2 m."""
    load = body("load", MASS, (0.0, 0.0, -11.0), inertia=[3000.0, 3000.0, 900.0])
    hoisting = -0.8
    path = [drum((-0.5, 0.0, 0.0), pay_out=hoisting), end("load", offset=(0.0, 0.0, 1.0))]
    model = model_of(crane(path, [load], {"axial_stiffness": STIFFNESS}, solver={"end": 10.0}))
    (sockets,) = [group for group in model.system.groups if isinstance(group, Sockets)]
    assert sockets.rows.stiffness[0] == pytest.approx(100.0 * STIFFNESS / 2.0)
