"""Tool joints in the torsion of a string: their inertia and stiffness, spread over the pipe, against each of them.

The reference is a transfer matrix of its own along every tube and every joint of the pipe: 290 pieces of pipe of 8.87 m
with 0.53 m of tool joint between. 5 in 19.50 lb/ft S135 with NC50 joints has 1.31 times the rotary inertia of its bare
tube and 1.05 times the stiffness, so that the wave is 0.90 times as fast and the impedance 1.17 times as large. The
first torsional frequency of data/drilling.yaml falls from 0.2078 to 0.1986 Hz.
"""

import re

import numpy as np
import pytest
import yaml
from physics.wells.strings import DATA, shipped
from scipy.optimize import brentq

from drillstring.drilling.impedance import note_of_drive, torsional_frequency
from drillstring.model.build import build
from drillstring.model.prepared import tubes_of
from drillstring.modes.campbell import campbell
from drillstring.scene.scene import DrillstringScene
from tautline.scene.errors import SceneError

INCH, G, RHO = 0.0254, 79e9, 7850.0
PIPE, JOINT, HEAVY, COLLAR = (5.0, 4.276), (6.625, 2.75), (5.0, 3.0), (6.5, 2.8125)
LENGTH, SPACING, WHOLE = 0.53, 9.4, 2730.0
KEYS = {"tool_joint_length": LENGTH, "tool_joint_spacing": SPACING}


def moment(diameters):
    od, bore = (INCH * inches for inches in diameters)
    return np.pi / 32.0 * (od**4 - bore**4)


def area(diameters):
    od, bore = (INCH * inches for inches in diameters)
    return np.pi / 4.0 * (od**2 - bore**2)


def apart():
    """Length m and diameters of each piece, from the rotary table down."""
    number = int(WHOLE // SPACING)
    pipe = [(SPACING - LENGTH, PIPE), (LENGTH, JOINT)] * number + [(WHOLE - number * SPACING, PIPE)]
    return [*pipe, (110.0, HEAVY), (160.0, COLLAR)]


def first_frequency(pieces):
    """Held at the top and free at the bit, Hz."""

    def torque(omega):
        angle, moved = 0.0, 1.0
        for length, diameters in pieces:
            z, way = moment(diameters) * np.sqrt(G * RHO) * omega, omega * length * np.sqrt(RHO / G)
            c, s = np.cos(way), np.sin(way)
            angle, moved = angle * c + moved / z * s, moved * c - angle * z * s
        return moved

    return brentq(torque, 0.5, 2.0, xtol=1e-12) / (2.0 * np.pi)


def drilling(keys=KEYS, **changes):
    scene = yaml.safe_load((DATA / "drilling.yaml").read_text(encoding="utf8"))
    scene["string"][0] |= keys
    scene["model"] |= changes
    return DrillstringScene.parse(yaml.safe_dump(scene))


def tubes(scene):
    return tubes_of(scene, 3000.0)


def test_first_torsional_frequency_is_that_of_a_string_with_each_tool_joint():
    exact, bare = first_frequency(apart()), first_frequency([(WHOLE, PIPE), *apart()[-2:]])
    assert exact == pytest.approx(0.1986, abs=1e-4) and bare == pytest.approx(0.2078, abs=1e-4)
    assert torsional_frequency(tubes(drilling())) == pytest.approx(exact, rel=1e-4)
    assert torsional_frequency(tubes(shipped("drilling"))) == pytest.approx(bare, rel=1e-6)


def test_lumps_have_the_torsional_frequency_of_a_string_with_each_tool_joint():
    held = {"top": {"rotation": 0.0}, "bit": {"on_bottom": False}}
    scene = yaml.safe_load(drilling(elements=60).document.text)
    scene = DrillstringScene.parse(yaml.safe_dump({**scene, **held, "damping": {}}))
    (mode, *_) = campbell(scene, (0.0, 10.0), kinds=("torsional",), up_to=0.5).modes
    assert mode.frequency == pytest.approx(first_frequency(apart()), rel=1e-3)


@pytest.mark.parametrize("kind", ["lumped", "ale-ancf"])
def test_inertia_and_stiffness_of_either_model_are_those_of_tubes_and_tool_joints(kind):
    groups = build(drilling(kind=kind)).system.groups
    inertia = sum(length * RHO * moment(one) for length, one in apart())
    compliance = sum(length / (G * moment(one)) for length, one in apart())
    if kind == "lumped":
        (links,) = (g.springs for g in groups if type(g).__name__ == "Links")
        (bodies,) = (g for g in groups if type(g).__name__ in ("Bodies", "EccentricBodies"))
        found = bodies[1].polar.sum(), (1.0 / links.torsional).sum()
    else:
        (twist,) = (g[0] for g in groups if type(g).__name__ == "Twist")
        found = 2.0 * twist.inertia.sum(), (1.0 / twist.stiffness).sum()
    # The pipe that is left at the end has no joint here.
    assert found == pytest.approx((inertia, compliance), rel=1e-3)


def test_soft_torque_takes_the_impedance_of_pipe_with_its_tool_joints():
    scene = drilling()
    share = LENGTH / SPACING
    inertia = RHO * ((1.0 - share) * moment(PIPE) + share * moment(JOINT))
    stiffness = G / ((1.0 - share) / moment(PIPE) + share / moment(JOINT))
    zeta = np.sqrt(inertia * stiffness)
    assert zeta / (moment(PIPE) * np.sqrt(G * RHO)) == pytest.approx(1.17, abs=0.005)
    drive = scene.top.rotation.model_copy(update={"kind": "soft-torque", "proportional": None, "integral": None})
    told = re.search(r"proportional ([\d.]+) N m s/rad", note_of_drive(drive, tubes(scene)))
    assert float(told[1]) == pytest.approx(zeta, rel=1e-3)


def test_mass_of_a_section_without_one_is_that_of_tubes_and_tool_joints():
    keys = {"od": "5 in", "id": "4.276 in", "tool_joint_od": "6.625 in", "tool_joint_id": "2.75 in"}
    scene = yaml.safe_load((DATA / "drilling.yaml").read_text(encoding="utf8"))
    scene["string"][0] = {"name": "pipe", "length": "rest"} | keys | KEYS
    (pipe, *_) = tubes(DrillstringScene.parse(yaml.safe_dump(scene)))
    exact = RHO * ((SPACING - LENGTH) * area(PIPE) + LENGTH * area(JOINT)) / SPACING
    assert pipe.mass_per_length == pytest.approx(exact, rel=1e-9)
    # The catalogue's weight, which it keeps where a tubular is named.
    assert tubes(drilling())[0].mass_per_length == tubes(shipped("drilling"))[0].mass_per_length
    assert exact == pytest.approx(tubes(drilling())[0].mass_per_length, rel=0.015)


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"tool_joint_length": 0.5}, "has no tool_joint_spacing beside it"),
        ({"tool_joint_spacing": 9.4}, "has no tool_joint_length beside it"),
        ({"tool_joint_length": 9.4, "tool_joint_spacing": 9.4}, "not shorter than tool_joint_spacing"),
        (KEYS | {"tool_joint_id": "7 in"}, "not smaller than tool_joint_od"),
        ({"tool_joint_id": "3 in"}, "has no effect without tool_joint_length"),
    ],
)
def test_tool_joints_that_are_given_in_part_or_cannot_be_are_refused(keys, said):
    with pytest.raises(SceneError, match=said):
        drilling(keys)
