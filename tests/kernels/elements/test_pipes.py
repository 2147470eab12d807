"""The fused element of pipe and fluid is the sum of the groups it stands for, entry by entry."""

from pathlib import Path

import numpy as np
import pytest

from gardenhose.build import assembled
from gardenhose.scene import HoseScene
from tautline.integrators.linearise import evaluate
from tautline.integrators.state import new_state
from tautline.kernels import groups as over
from tautline.kernels.groups import link
from tautline.kernels.jit import entry
from tautline.kernels.matrix import dense, new_matrix

SCENE = """
hose:
  segments:
    - {{length: 0.3, elements: 2, axial_stiffness: 3, bending_stiffness: {EJ}, mass_per_length: 0.7, damping: {c}}}
    - {{length: 0.5, elements: 2, axial_stiffness: 5, bending_stiffness: {EJ}, mass_per_length: 0.4, damping: {c},
       water_mass_per_length: {bore}}}
  direction: [1, 2, -0.5]
  strain: {strain}
  tip_mass: 0.1 kg
water: {{mass_per_length: 0.9, speed: {{harmonic: {{amplitude: 2.0, mean: 3.0, frequency: 0.7 Hz}}}}, outlet: {outlet}}}
gravity: [0.3, -0.2, -9.81]
solver: {{step: 1 ms, end: 1 s}}
output: {{interval: 10 ms}}
"""
CASES = {
    "all": {"EJ": 0.4, "c": 0.2, "bore": 0.9, "strain": "green", "outlet": 1.0},
    "a narrower bore and a nozzle": {"EJ": 0.4, "c": 0.2, "bore": 0.5, "strain": "green", "outlet": 1.7},
    "engineering strain": {"EJ": 0.4, "c": 0.2, "bore": 0.9, "strain": "engineering", "outlet": 1.0},
    "no damping": {"EJ": 0.4, "c": 0.0, "bore": 0.9, "strain": "green", "outlet": 1.0},
    "no bending": {"EJ": 0.0, "c": 0.2, "bore": 0.9, "strain": "green", "outlet": 1.0},
}


@entry
def _ask(groups, t, q, v, e, p):
    over.energy(groups, t, q, v, e)
    over.dissipation(groups, t, q, v, p)
    over.supply(groups, t, q, v, p[1:])


def answers(scene, fused):
    """Residual, tangents by a, v, q, energies and powers of a scene at one state, anything but at rest."""
    system = assembled(scene, fused).system
    state, rng = new_state(system), np.random.default_rng(5)
    # Both have the same unknowns in the same order of nodes: those of the hose.
    hose = np.argsort(system.free)
    for vector, size in ((state.q, 0.05), (state.v, 0.3), (state.a, 1.0)):
        vector[hose] += size * rng.standard_normal(system.size)
    parts = []
    for part in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)):
        matrix, residual = new_matrix(system.size, system.bandwidth, system.border), np.zeros(system.size)
        evaluate(system, state, 0.23, 1e-3, False, *part, matrix, residual)
        parts.append(dense(matrix)[np.ix_(hose, hose)])
    e, p = np.zeros(3), np.zeros(3)
    _ask(link(system.groups, "energy", "dissipation", "supply"), 0.23, state.full_q, state.full_v, e, p)
    return residual[hose], np.array(parts), e, p, [type(g).__name__ for g in system.groups]


@pytest.mark.parametrize("name", CASES)
def test_the_fused_element_is_the_sum_of_its_parts(name):
    scene = HoseScene.parse(SCENE.format(**CASES[name]), Path("hose.yaml"))
    one, many = answers(scene, True), answers(scene, False)
    assert "Pipes" in one[4] and "SharedFlow" not in one[4]
    assert "SharedFlow" in many[4] and "Pipes" not in many[4]
    for word, mine, theirs in zip(("residual", "tangent", "energy", "power"), one, many, strict=False):
        size = np.abs(theirs).max()
        assert np.abs(mine - theirs).max() <= 1e-13 * size, word
