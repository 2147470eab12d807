"""Velocities of a cable's nodes that are changed at once: a blow."""

import pytest

import tautline

LOOSE = """
CableModelMaterial: {Gravity: [0, 0, 0]}
CableModel:
  - Node4Dof: {id: 0, xyz: [0, 0, 0], BC: [0, 0, 0, 1]}
  - Node4Dof: {id: 1, xyz: [2, 0, 0], BC: [0, 0, 0, 1]}
  - CableLine: {id: 0, nodes4: [0, 1], elements: 1, EA: 1e5, rhoA: 1.5}
GeneralizedAlpha: {type: G-alpha, time_step: 0.01, time_end: 1}
"""


def test_a_cable_whose_nodes_are_struck_alike_flies_on_as_a_whole():
    """3 kg at 2 m/s have 6 J, and are 1 m further after half a second."""
    simulation = tautline.Simulation(tautline.read(LOOSE))
    simulation.advance(0.1)
    for node in (0, 1):
        simulation.displace(f"node {node}.velocity", [0.0, 0.0, 2.0])
    assert simulation["kinetic_energy"] == pytest.approx(6.0, rel=1e-12)
    simulation.advance(0.5)
    assert simulation["node 1.position"] == pytest.approx([2.0, 0.0, 1.0], abs=1e-9)
    assert simulation["external_work"] == pytest.approx(6.0, rel=1e-9)


def test_a_node_that_is_held_takes_no_blow():
    simulation = tautline.Simulation(tautline.read(LOOSE.replace("BC: [0, 0, 0, 1]", "BC: [1, 1, 1, 1]", 1)))
    with pytest.raises(tautline.TautlineError, match=r"held or prescribed"):
        simulation.displace("node 0.velocity", [0.0, 0.0, 2.0])
