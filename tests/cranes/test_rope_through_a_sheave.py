"""Rope that runs through a sheave is warned of once, with how deep it cuts and what helps."""

from __future__ import annotations

import re

import pytest
from cli.in_process import commands_of

from crane.application import Crane

SCENE = """
title: Two falls, the dead end behind the crown
rope: {{mass_per_length: 6.5, axial_stiffness: 80 MN}}
bodies:
  - {{name: block, mass: 5 t, position: [20, 0, 10]}}
path:
  - drum: {{name: winch, center: [0, 0, 5], radius: 0.5, axis: [0, 1, 0], wrap: over, pay_out: 0}}
  - sheave: {{name: crown, center: [19.6, 0, 40], radius: 0.4, axis: [0, 1, 0], wrap: over}}
  - sheave: {{name: hook, body: block, radius: 0.5, axis: [0, 1, 0], wrap: under}}
  - anchor: {{name: dead end, position: [{x}, {y}, 40]}}
mesh: {{elements_per_span: 1}}
solver: {{step: 10 ms, end: 1 s}}
output: {{interval: 50 ms}}
"""


def checked(tmp_path, capsys, x, y=0.0):
    (tmp_path / "falls.yaml").write_text(SCENE.format(x=x, y=y))
    code, out, err = commands_of(Crane(), capsys)("check", tmp_path / "falls.yaml")
    assert code == 0
    return [line for line in (out + err).splitlines() if "runs through" in line]


def test_it_is_said_once_with_its_depth_and_a_cure_that_helps(tmp_path, capsys):
    (line,) = checked(tmp_path, capsys, 19.7)
    assert line.startswith("warning: path") and "aside along the axis of the sheave" in line
    # The rope ends at the height of the crown's centre, 0.1 m beside it: as deep as can be seen in the drawing.
    depth = float(re.search(r"up to ([0-9.]+) m inside", line)[1])
    assert depth == pytest.approx(0.4 - 0.1, abs=0.01) and "radius of 0.4 m" in line
    assert checked(tmp_path, capsys, 19.7, y=0.3) == []
