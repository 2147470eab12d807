"""Readings of a machine whose derivatives grow for good, as a load that stood still begins to swing."""

import numpy as np
import pytest
import yaml
from twin.rehearsal import STILL, lines_of, rows_of

import tautline
from tautline.twin.twin import Twin

MAP = """
sensors:
  - {column: winch, unit: m, input: winch.pay_out}
  - {column: z, unit: m, output: "payload.position[2]", sd: 5 mm}
estimate:
  - {parameter: rope.axial_stiffness, start: 3 MN, sd: 1 MN, range: [0.5 MN, 10 MN]}
ahead: 0 s
"""


def test_what_has_been_wild_for_a_window_is_usual_and_until_then_health_is_not_good_and_told():
    scene = yaml.safe_load(STILL)
    scene["rope"] |= {"axial_stiffness": 2e6, "damping": 1e-3}
    scene["bodies"][0]["position"] = [0.5, 0, -3]
    scene["path"][0]["drum"]["pay_out"] = 0.0
    scene["solver"] |= {"end": 20, "step": "10 ms"}
    scene["output"]["interval"] = "0.2 s"
    twin = Twin(scene, MAP)
    lines = lines_of(twin, rows_of(tautline.read(scene), end=15.0, map=MAP, rate=5.0))
    found = {round(line["time"], 1): line for line in lines}
    # At rest the derivative is 5e-17 m/N, and 1e-8 later: when it had grown none was believed again, for ever.
    assert found[9.0]["health"] == "degraded" and found[14.0]["health"] == "good"
    assert any("most readings cannot be used" in note for note in twin.notes)
    values = [found[t]["estimates"]["rope.axial_stiffness"]["value"] for t in (11.0, 12.0, 13.0, 14.0)]
    assert np.ptp(values) > 100.0
    # At rest nothing tells of the stiffness: it was known to 166 kN after two seconds, from a swing of the simulation.
    sd = {time: line["estimates"]["rope.axial_stiffness"]["sd"] for time, line in found.items()}
    assert sd[3.0] == pytest.approx(1e6, rel=1e-3) and sd[14.0] < 300e3
