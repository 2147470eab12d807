"""A load that is set down rests on the ground as deep as its weight presses it in, and the rope goes slack."""

import numpy as np
import pytest

from crane.model.build import build
from crane.scene.scene import CraneScene
from tautline.scene.errors import SceneError
from tautline.scene.model import validate
from tautline.scene.reading.document import Document
from tautline.simulation import simulate

SCENE = """
rope: {{mass_per_length: 6.5, axial_stiffness: 8.0e7, damping: 1.0e-3}}
bodies: [{{name: load, mass: 5 t, position: [12.4, 0, {height}], bottom: 1.0}}]
path:
  - drum: {{name: winch, center: [0, 0, 0], radius: 0.5, axis: [0, 1, 0], wrap: over,
            pay_out: {{table: {{time: [0, 1, 6, 7], value: [0, 0.2, 0.2, 0]}}}}}}
  - sheave: {{name: tip, center: [12, 0, 30], radius: 0.4, axis: [0, 1, 0], wrap: over, inertia: 20}}
  - end: {{name: hook, body: load}}
ground: {{level: 0, stiffness: 1.0e7, damping: 2.0e5, friction: 0.5}}
solver: {{method: generalized-alpha, rho_inf: 0.6, step: 5 ms, end: 10 s}}
output: {{interval: 20 ms}}
"""
WEIGHT = 5000.0 * 9.81


def scene(height):
    return validate(CraneScene, Document.parse(SCENE.format(height=height)))


def test_a_load_set_down_rests_as_deep_as_its_weight_presses_it_in():
    """1.2 m are paid out, the ground is 0.6 m below: what the slack rope still carries is its own weight, at most."""
    result = simulate(build(scene(1.6)))
    height, speed = result["body_position"][:, 0, 2], result["body_velocity"][:, 0]
    rope = 40.0 * 6.5 * 9.81
    assert height[-1] - 1.0 == pytest.approx(-WEIGHT / 1.0e7, abs=rope / 1.0e7)
    assert np.abs(speed[-1]).max() < 1e-3
    assert result["tension"][-1].max() < 1.5 * rope and result["tension"][0, 1, 1] == pytest.approx(WEIGHT, rel=1e-6)
    assert result.attributes["energy_error"] < 1e-3
    # It touches when 0.6 m are out: 0.1 m in the first second, and 0.2 m/s from then on.
    touched = result.time[np.argmax(height - 1.0 < 0.0)]
    assert touched == pytest.approx(1.0 + 0.5 / 0.2, abs=0.05)


def test_a_load_drawn_above_the_sheave_that_carries_it_is_refused():
    with pytest.raises(SceneError) as refused:
        build(scene(35.0))
    (problem,) = refused.value.problems
    assert problem.key == "bodies[0].position" and "above" in problem.cause and problem.cure
