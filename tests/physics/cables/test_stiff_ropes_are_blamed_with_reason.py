"""Whether EA is too large is told where it may be the cause, and not where ropes are stretched, driven or loose."""

import re
from pathlib import Path

import pytest

import tautline
from gardenhose.build import build as build_hose
from gardenhose.static import form
from tautline.application.installed import Installed
from tautline.cable.model.build import build
from tautline.cable.model.magnitudes import stiff_along
from tautline.integrators.state import new_state
from tautline.integrators.statics.equilibrium import find_equilibrium
from tautline.integrators.status import Status, StoppedEarly

DATA = Path(__file__).parents[3] / "data" / "hose.yaml"
FREE, PIN, CLAMP = "[0, 0, 0, 0, 0, 0, 1]", "[1, 1, 1, 0, 0, 0, 1]", "[1, 1, 1, 0, 1, 1, 1]"
CAUSE = "the axial stiffness EA"
SPRING = """
  - Node7Dof: {id: 500, xyz: [2.5, 0, 0], xyz_d: [1, 0, 0], BC: [1, 1, 1, 1, 1, 1, 1]}
  - TwoNodeSpring: {id: 1, nodes7: [1, 500], stiffness: 1.0e5, length: 0.5}
"""
DRIVE = """
  - Function_VelocityDefined: {id: 1, pos0: 1.0, timeList: [0, 1], velocityList: [0.1, 0.1]}
"""


def text(length=None, begin=PIN, end=PIN, axial="1.0e12", bending=1e-3, gravity=0.0, start="static", more="", drive=""):
    """A rope of 1 kg/m, drawn straight from 0 to 1 m."""
    given = "" if length is None else f", length: {length}"
    return f"""
CableModelMaterial: {{Gravity: [0, 0, -{gravity}]}}
CableModel:
  - Node7Dof: {{id: 0, xyz: [0, 0, 0], xyz_d: [1, 0, 0], BC: {begin}}}
  - Node7Dof: {{id: 1, xyz: [1, 0, 0], xyz_d: [1, 0, 0], BC: {end}{drive}}}
  - CableLine: {{id: 0, nodes7: [0, 1], elements: 10{given}, EA: {axial}, EJ: {bending}, rhoA: 1.0}}
{more}
GeneralizedAlpha: {{type: G-alpha, rho_inf: 0.8, time_step: 0.001, time_end: 0.001, start: {start}}}
"""


def scene(tmp_path, *given, **changes):
    path = tmp_path / "rope.yaml"
    path.write_text(text(*given, **changes))
    return tautline.read(path)


def told(one):
    """What `check` says of its EA, and what a search that failed would be told."""
    warned = [warning.text for warning in Installed().of(one).warnings(one) if CAUSE in warning.text]
    return warned, build(one).system.softer


def refusal(one):
    with pytest.raises(StoppedEarly) as stop:
        tautline.simulate(one)
    return stop.value


def test_a_string_that_is_stretched_between_its_ends_is_not_advised_to_be_softer(tmp_path):
    assert told(scene(tmp_path, 0.999, axial="1.0e4", bending=4e-6)) == ([], "")
    assert told(scene(tmp_path, 0.99)) == ([], "")
    # Drawn as long as it is, its weight stretches it: it sags as 1 / cbrt(EA).
    assert told(scene(tmp_path, 1.0, gravity=9.81)) == ([], "")


def test_a_rope_with_a_free_end_is_told_though_it_is_drawn_longer_than_it_is(tmp_path):
    assert CAUSE in told(scene(tmp_path, 0.999, end=FREE, gravity=9.81))[1]


@pytest.mark.parametrize("axial", ["2.0e9", "1.0e10"])
def test_a_slack_rope_without_bending_stiffness_that_finds_no_rest_is_told_that_its_stiffness_may_be_the_cause(
    tmp_path, axial
):
    assert CAUSE in refusal(scene(tmp_path, 1.1, axial=axial, bending=0, gravity=9.81)).sentence


def test_a_slack_rope_is_told_though_the_slopes_of_its_ends_are_drawn_as_they_are(tmp_path):
    assert CAUSE in told(scene(tmp_path, 1.1, gravity=9.81))[1]


def test_a_rope_that_springs_pull_or_whose_end_is_driven_is_not_advised_to_be_softer(tmp_path):
    assert CAUSE in told(scene(tmp_path, end=FREE))[1]
    assert told(scene(tmp_path, end=FREE, more=SPRING)) == ([], "")
    driven = {"more": DRIVE, "drive": ", BC_functions: [1, 0, 0, 0, 0, 0, 0]"}
    assert told(scene(tmp_path, **driven)) == ([], "")
    # It is moved as a whole where nothing else holds it.
    assert CAUSE in told(scene(tmp_path, begin=FREE, **driven))[1]


def test_a_rope_that_nothing_holds_is_not_refused_for_its_stiffness_alone(tmp_path):
    free = {"begin": FREE, "end": FREE, "gravity": 9.81}
    assert CAUSE not in refusal(scene(tmp_path, **free)).detail
    detail = refusal(scene(tmp_path, start="relaxed", **free)).detail
    assert CAUSE not in detail or "nothing holds a part of the scene" in detail


def test_a_step_without_solution_is_put_down_to_the_step_first(tmp_path):
    system = build(scene(tmp_path, end=FREE, begin=CLAMP)).system
    _, _, detail = stiff_along(system, new_state(system), Status.NOT_CONVERGED)
    assert detail.index("smaller step") < detail.index(CAUSE)
    assert stiff_along(system, new_state(system), Status.NOT_FINITE) is None


def test_what_may_be_is_not_said_as_what_always_is(tmp_path):
    one = scene(tmp_path, begin=CLAMP, end=FREE, axial="1.0e8")
    model = build(one)
    assert find_equilibrium(model.system, new_state(model.system), model.step_limit).residual < 1e-10
    assert "may not tell bending from stretch" in model.system.softer and "no search" not in model.system.softer


def test_what_is_out_of_balance_by_more_than_all_that_acts_is_told_in_times():
    with pytest.raises(StoppedEarly) as stop:
        form(tautline.read(DATA).replace({"hose.axial_stiffness": 1e15, "hose.elements": 40}), 0.0)
    found = re.search(r"iterations (\S+) (times|% of) the force that acts", stop.value.detail)
    assert found[2] == "times" and 1.0 < float(found[1]) and "e" not in found[1]


@pytest.mark.parametrize(("end", "said"), [("free", True), ("pinned", False), ("clamped", False)])
def test_a_hose_is_told_to_be_softer_only_where_its_end_is_free(end, said):
    hose = tautline.read(DATA).replace({"hose.axial_stiffness": 1e12, "hose.end": end, "start": "straight"})
    system = build_hose(hose).system
    assert bool(system.softer) == said and system.hidden
