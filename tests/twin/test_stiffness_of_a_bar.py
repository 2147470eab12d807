"""A twin finds the bending stiffness of a bar by the axial force at its clamp, which tells of it."""

import pytest
from live.swinging_bar import swinging_bar
from twin.rehearsal import lines_of, rows_of

from tautline.twin.twin import Twin

SENSORS = """
sensors:
  - {column: N0, unit: N, output: element 0.axial_force, sd: 0.05 N}
"""
ESTIMATE = """
estimate:
  - {parameter: cables.bending_stiffness, start: 3.5, sd: 1.5, range: [1.0, 10.0]}
window: 2 s
"""


def bar(EJ):
    """A bar that swings about its clamp and comes to rest."""
    solver = {"rho_inf": 0.8, "time_step": 0.005, "time_end": 30, "plotpoints": 20, "massDamp": 0.3}
    return swinging_bar(2e3, EJ, 0.02, elements=6, load=3, **solver)


@pytest.mark.study
def test_a_twin_finds_the_bending_stiffness_of_a_bar_whose_scene_has_another():
    rows = rows_of(bar(4.5), end=10.0, map=SENSORS, rate=20.0, noise=0.0)
    last = lines_of(Twin(bar(3.0), SENSORS + ESTIMATE), rows)[-1]
    found = last["estimates"]["cables.bending_stiffness"]
    assert found["value"] == pytest.approx(4.5, abs=0.05) and found["sd"] < 0.1
