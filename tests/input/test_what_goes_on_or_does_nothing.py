"""A cable scene is warned of rates that are held outside of their times, and of masses and springs on held nodes."""

import numpy as np
import pytest

import tautline
import tautline.cable.warnings
from tautline.cable.input.scene import parse
from tautline.scene.warnings import warnings_of

SCENE = """
CableModelMaterial: {Gravity: [0, 0, 0]}
CableModel:
  - Node4Dof: {id: 0, xyz: [0, 0, 0], BC: [1, 1, 1, 1]}
  - Node4Dof: {id: 1, xyz: [10, 0, 0], BC: [1, 1, 1, 1], BC_functions: [0, 0, 1, 0]}
  - Node4Dof: {id: 2, xyz: [20, 0, 0], BC: [0, 0, 0, 1]}
  - CableALEelementLin: {id: 0, nodes4: [0, 1], EA: 1.0e3, rhoA: 1}
  - CableALEelementLin: {id: 1, nodes4: [1, 2], EA: 1.0e3, rhoA: 1}
  - Function_VelocityDefined: {id: 1, pos0: 0, timeList: TIMES, velocityList: RATES}
ITEM
GeneralizedAlpha: {type: G-alpha, rho_inf: 0.8, time_step: 0.01, time_end: 1}
"""


def text(times="[0, 1]", rates="[0, 0.1]", item=""):
    made = SCENE.replace("TIMES", times).replace("RATES", rates)
    return made.replace("ITEM", f"  - {item}" if item else "")


def told(word, **given):
    return [one for one in warnings_of("cable", parse(text(**given))) if word in one.text]


@pytest.mark.parametrize(
    ("times", "rates", "words"),
    [
        ("[0, 0.5]", "[0, 0.1]", ["ends at 0.5 s, before the run (1 s). The last rate, 0.1 m/s, is held after it"]),
        ("[0.2, 1]", "[0.1, 0.1]", ["begins at 0.2 s. The first rate, 0.1 m/s, is held before it"]),
        ("[0.2, 0.5]", "[0.1, 0.2]", ["begins at 0.2 s", "ends at 0.5 s"]),
        ("[0, 0.5]", "[0.1, 0]", []),
        ("[0.2, 1]", "[0, 0.1]", []),
        ("[0, 1]", "[0.1, 0.1]", []),
        ("[0, 2]", "[0.1, 0.1]", []),
        ("[0]", "[0.1]", []),
        # what rounding leaves of times and rates
        ("[0, 0.9999999999]", "[0.1, 0.1]", []),
        ("[1e-12, 1]", "[0.1, 0.1]", []),
        ("[0, 0.5]", "[0.1, 1e-17]", []),
        ("[0, 0.5]", "[1e-17, 1e-17]", ["The last rate, 1e-17 m/s, is held after it"]),
    ],
)
def test_a_rate_that_is_held_outside_of_its_times_is_told(times, rates, words):
    found = told("is held", times=times, rates=rates)
    assert len(found) == len(words)
    for one, word in zip(found, words, strict=True):
        assert word in one.text and one.where.startswith("CableModel[5].Function_VelocityDefined.timeList")


def test_a_motion_begins_with_the_run_and_goes_on_after_its_last_time_at_the_rates_there():
    """At 1 m/s from 0.2 to 0.5 s and held outside: a metre in a second."""
    result = tautline.simulate(text("[0.2, 0.5]", "[1, 1]"))
    height = np.asarray(result["position"])[:, 1, 2]
    assert height == pytest.approx(np.asarray(result["time"]), abs=1e-12)


MASS, SPRING = "PointMass: {id: 0, nodes4: [NODE], mass: 5}", "OneNodeSpring: {id: 0, nodes4: [NODE], stiffness: 1}"


@pytest.mark.parametrize("item", [MASS, SPRING], ids=["mass", "spring"])
@pytest.mark.parametrize(("node", "count"), [(0, 1), (1, 0), (2, 0)], ids=["held", "driven", "free"])
def test_a_mass_or_a_spring_on_a_node_whose_place_is_held_is_told(item, node, count):
    found = told("does nothing there", item=item.replace("NODE", str(node)))
    assert len(found) == count
    assert all("node 0 is held (BC)" in one.text for one in found)


def test_the_rate_of_a_slope_is_told_by_its_unit():
    """A slope is a length over a length."""
    end = "BC: [1, 1, 1, 0, 1, 0, 1], BC_functions: [0, 0, 0, 0, 1, 0, 0]"
    items = (
        "  - Node7Dof: {id: 0, xyz: [0, 0, 0], xyz_d: [1, 0, 0], BC: [1, 1, 1, 1, 1, 1, 1]}\n"
        f"  - Node7Dof: {{id: 1, xyz: [1, 0, 0], xyz_d: [1, 0, 0], {end}}}\n"
        "  - CableALEelement: {id: 0, nodes7: [0, 1], EA: 1e5, EJ: 1, rhoA: 1}\n"
        "  - Function_VelocityDefined: {id: 1, timeList: [0, 0.5], velocityList: [0, 0.1]}\n"
    )
    begin, rest = SCENE.split("  - Node4Dof", 1)
    written = begin + items + rest[rest.index("GeneralizedAlpha") :]
    found = [one.text for one in warnings_of("cable", parse(written)) if "is held" in one.text]
    assert len(found) == 1 and "The last rate, 0.1 1/s, is held after it" in found[0]
