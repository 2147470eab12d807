"""Strings, walls, steps and wells at the edge of what makes sense: right, or a named error; never NaN, never silent."""

from math import pi

import numpy as np
import pytest
from physics.wells.strings import DATA, GRAVITY, Balance, run, shipped, straight_hole
from physics.wells.strings import mass_per_length as steel
from references import planar_well_dynamics as planar
from references import soft_string as soft

from drillstring.model.build import build
from drillstring.warnings import warnings
from tautline.integrators.status import Status, StoppedEarly
from tautline.scene.errors import SceneError
from tautline.simulation import simulate

WELL, STRING = soft.jwell()
HANGS = soft.hook_load(WELL, STRING, 0.0, "rotating")
BRIEF = {"solver__end": 2.0}


@pytest.fixture(scope="module")
def usual():
    """The J-well as it is, 2 s."""
    return run(shipped("jwell", **BRIEF))


# the string
@pytest.mark.parametrize("inclination", [0.0, 1.0, pi / 2])
def test_one_element_of_one_section_hangs_in_the_weight_of_its_lower_half(inclination):
    # closed form: half the weight times cos(inc), and the top lump's own half
    result = run(straight_hole(inclination, elements=1, friction=0.3, solver__end=0.5, output__interval=0.05), np.inf)
    weight = steel() * 100.0 * GRAVITY * np.cos(inclination)
    assert result["hook_load"] == pytest.approx(weight, rel=1e-3, abs=50.0)


@pytest.mark.parametrize("bending", ["stiff", "soft", "none"])
def test_one_element_has_nothing_to_bend(bending):
    balance = Balance(straight_hole(1.0, elements=1, model__bending=bending))
    assert balance["tension"][0] == pytest.approx(steel() * 50.0 * GRAVITY * np.cos(1.0), rel=1e-3)


def test_two_elements_carry_the_jwell_string_coarsely():
    # the error of the hook load is first order in n (-0.3 % at 12): no more than a third at 2, and warned of
    scene = shipped("jwell", model__elements=2, **BRIEF)
    assert any(warning.where == "model.elements" for warning in warnings(scene))
    assert run(scene)["hook_load"][0] == pytest.approx(HANGS, rel=0.34)


def test_a_thousand_elements_run_and_hang_in_the_weight_of_the_soft_string():
    result = run(shipped("jwell", model__elements=1000, solver__end=0.05))
    assert result["position"].shape == (2, 1001, 3)
    assert result["hook_load"][0] == pytest.approx(HANGS, rel=2e-3)


@pytest.mark.parametrize("inclination", [0.0, pi / 2])
def test_a_string_that_does_not_move_has_no_energy_error(inclination):
    # nothing goes through the system: rounding over rounding must not be told as an error of 100 %
    result = run(straight_hole(inclination, elements=1, solver__end=0.5))
    assert np.ptp(result["kinetic_energy"]) < 1e-12 * result["strain_energy"][0]
    assert result.attributes["energy_error"] < 1e-6


# forces
def test_a_straight_string_without_gravity_stays_unloaded():
    result = run(straight_hole(1.0, elements=4, gravity=0.0, friction=0.3, solver__end=0.5))
    assert np.abs(result["hook_load"]).max() < 1e-3
    assert np.ptp(result["measured_depth"], axis=0).max() < 1e-9


def test_the_jwell_string_follows_the_block_without_gravity():
    # weightless lumps strike the wall again and again; generalized-alpha takes 7 J of 3 kJ from that
    result = run(shipped("jwell", gravity=0.0, **BRIEF), energy=2e-3)
    assert np.abs(result["bit_depth"] - result["bit_depth"][0] - result["block_position"]).max() < 0.5


@pytest.mark.parametrize("damping", [5e6, 0.0])
def test_a_wall_of_1e12_n_per_m_gives_the_hook_load_of_the_usual_one(usual, damping):
    # penetration falls from 0.1 mm to nothing; hook load after 2 s within 1e-3
    result = run(shipped("jwell", well__wall__stiffness=1e12, well__wall__damping=damping, **BRIEF))
    assert result["hook_load"] == pytest.approx(usual["hook_load"], rel=1e-3)


def test_a_wall_of_1e3_n_per_m_yields_until_it_carries_the_weight():
    # every contact: N = k (offset - clearance), k by diameter and tributary length; they carry what lies on the wall
    balance = Balance(shipped("jwell", well__wall__stiffness=1e3))
    offset = np.hypot(*balance["lateral_displacement"].T)
    assert offset.max() > 1.0, "metres into the wall"
    assert np.isfinite(balance["tension"]).all()
    assert balance.equilibrium.residual < 1e-9


@pytest.mark.parametrize("diameter", [0.1650002, 0.166, 5.0])
def test_from_a_tenth_of_a_micrometre_of_clearance_to_metres(usual, diameter):
    result = run(shipped("jwell", well__diameter=diameter, **BRIEF))
    assert result["hook_load"][0] == pytest.approx(usual["hook_load"][0], rel=5e-3)


def test_no_clearance_at_all_is_an_error_that_names_both_diameters():
    with pytest.raises(SceneError, match=r"string\[1\]\.od.*well\.diameter"):
        shipped("jwell", well__diameter=0.165)


def test_without_friction_the_bit_follows_the_block(usual):
    result = run(shipped("jwell", well__wall__friction=0.0, **BRIEF))
    assert np.abs(result["friction_force"]).max() == 0.0
    assert np.ptp(result["bit_depth"]) > 100 * np.ptp(usual["bit_depth"])


def test_friction_of_2_holds_the_bit_through_20_s_of_heave():
    # capstan: the drag of the curve at mu = 2 is more than the weight of what is below it
    result = run(shipped("jwell", well__wall__friction=2.0, solver__end=20.0))
    assert np.ptp(result["bit_depth"][1:]) < 1e-4
    assert np.abs(result["bit_speed"][1:]).max() < 1e-8


def test_2000_rpm_runs():
    result = run(shipped("jwell", top__rotation="2000 rpm", solver__end=1.0))
    assert result["rotation"][-1, 0] == pytest.approx(2000 / 60 * 2 * pi, rel=1e-9)


# steps
@pytest.mark.parametrize("rho_inf", [0.0, 0.5, 1.0])
def test_steps_of_1_s_are_warned_of_and_keep_the_bit_within_half_a_metre(rho_inf):
    scene = shipped("jwell", solver__step=1.0, output__interval=1.0, solver__rho_inf=rho_inf, well__wall__friction=0.2)
    assert any(warning.where == "solver.step" for warning in warnings(scene))
    try:
        result = run(scene, energy=np.inf)
    except StoppedEarly as stop:  # without full damping by the algorithm up to a sixth of the energy comes from nowhere
        assert stop.status == Status.IMBALANCE and rho_inf > 0.0
        result = stop.result
    history = planar.history()
    bit = result["bit_depth"] - result["bit_depth"][0]
    assert np.abs(bit - history["bit_displacement"][::20]).max() < 0.5


@pytest.mark.parametrize("rho_inf", [0.0, 1.0])
def test_both_ends_of_rho_inf_give_the_bit_of_the_independent_history(rho_inf):
    # 10 s at 1 ms, within 2 mm
    result = run(shipped("jwell", solver__rho_inf=rho_inf, solver__end=10.0, well__wall__friction=0.2))
    bit = result["bit_depth"] - result["bit_depth"][0]
    assert np.abs(bit - planar.history()["bit_displacement"][:201]).max() < 2e-3


def test_rk4_with_a_step_of_1_s_stops_as_unstable():
    scene = shipped("jwell", solver__method="rk4", solver__step=1.0, output__interval=1.0)
    with pytest.raises(StoppedEarly) as stop:
        simulate(build(scene))
    assert stop.value.status in (Status.UNSTABLE, Status.NOT_FINITE)


def test_an_interval_that_is_no_multiple_of_the_step_keeps_its_times_with_shorter_steps(usual):
    result = run(shipped("jwell", output__interval=0.0333, **BRIEF))
    assert result.time[:-1] == pytest.approx(0.0333 * np.arange(61), abs=1e-12)
    assert result.time[-1] == 2.0
    # 34 steps to a frame of 33.3 ms, and for the last 2 ms as many as are no longer than those
    assert result.attributes["steps"] == 60 * 34 + 3
    assert result["hook_load"][-1] == pytest.approx(usual["hook_load"][-1], rel=1e-4)


def test_an_end_shorter_than_the_interval_is_an_error_at_output_interval():
    with pytest.raises(SceneError, match=r"output\.interval"):
        shipped("jwell", solver__end=0.02)


def test_an_end_between_two_frames_is_a_frame():
    assert run(shipped("jwell", solver__end=0.0505)).time == pytest.approx([0.0, 0.05, 0.0505])


def test_a_single_step_is_a_run():
    result = run(shipped("jwell", solver__end=1e-3, output__interval=1e-3))
    assert result.attributes["steps"] == 1


# the well and the block
@pytest.mark.parametrize("distance", [-50.0, 50.0])
def test_the_block_moved_by_50_m_takes_the_string_along(distance):
    result = run(shipped("jwell", top__block={"ramp": {"to": distance, "over": 20.0}}, solver__end=25.0))
    assert result["block_position"][-1] == distance
    # less the stretch by friction, at most 165 kN over the compliance of the string
    assert result["bit_depth"][-1] - result["bit_depth"][0] == pytest.approx(distance, abs=0.6)


@pytest.mark.parametrize("rotation", [0.0, "60 rpm"])
def test_a_vertical_string_in_a_vertical_hole_touches_nothing(rotation):
    # no direction to the wall is defined on the axis
    result = run(straight_hole(0.0, length=600.0, elements=6, friction=0.3, top__rotation=rotation), np.inf)
    assert result["contact_force"].max() == 0.0
    assert result["hook_load"] == pytest.approx(steel() * 600.0 * GRAVITY, rel=1e-6)


def test_a_vertical_hole_with_stiff_wall_under_heave_touches_nothing_either():
    block = {"harmonic": {"amplitude": 1.0, "period": 5.0}}
    result = run(shipped("jwell", well__sections=[{"hold": 2000.0}], top__block=block, **BRIEF))
    assert result["contact_force"].max() == 0.0
    assert np.ptp(result["bit_depth"]) > 1.0


def test_a_surveyed_well_runs_and_follows_its_survey():
    result = run(shipped("iscwsa", **BRIEF))
    table = DATA / "iscwsa_reference.csv"
    md, inc, azi = np.loadtxt(table, delimiter=",", skiprows=5, usecols=(0, 1, 2), unpack=True)
    ends = np.array([soft.angles_to_tangent(i, a) for i, a in zip(np.radians(inc), np.radians(azi), strict=True)])
    # trapezoidal path of the tangents: a metre in kilometres; the string is within the hole's clearance of it
    path = np.vstack([np.zeros(3), np.cumsum(0.5 * (ends[1:] + ends[:-1]) * np.diff(md)[:, None], axis=0)])
    for s, position in zip(result["measured_depth"][-1, 1:-1], result["position"][-1, 1:-1], strict=True):
        assert position == pytest.approx([np.interp(s, md, path[:, k]) for k in range(3)], abs=2.0)


def test_a_string_that_starts_straight_falls_on_the_wall_and_stays_finite():
    # unstretched on the axis: it drops by 1.64 m and swings about the hook load at rest
    result = run(shipped("jwell", start="straight", top__block=0.0, solver__end=20.0))
    assert result["hook_load"][-1] == pytest.approx(HANGS, rel=0.25)


def test_a_pull_of_5_mn_on_the_bit_is_carried_to_the_hook():
    # straight vertical hole: hook load = weight + pull
    vertical = {"well__sections": [{"hold": 2000.0}], "well__wall": "none", "mud": None}
    balance = Balance(shipped("jwell", top__block=0.0, bit__force=5e6, **vertical))
    weight = 7850.0 * GRAVITY * pi / 4 * ((0.127**2 - 0.1086**2) * 1760.0 + (0.165**2 - 0.0572**2) * 240.0)
    # the top lump's own weight is not in the tension below it
    top = 7850.0 * GRAVITY * pi / 4 * (0.127**2 - 0.1086**2) * balance.model.coordinates["link_length"][1][0] / 2
    assert balance["tension"][0] == pytest.approx(weight - top + 5e6, rel=1e-6)
    assert balance["hook_load"] == pytest.approx(weight + 5e6, rel=1e-6)


# turned about the vertical, and under other gravity
@pytest.mark.parametrize("azimuth", ["37 deg", "90 deg", "180 deg", "-90 deg", "359.999 deg", "3600 deg"])
def test_a_well_that_is_turned_about_the_vertical_bears_its_string_as_before(azimuth):
    usual = Balance(shipped("jwell"))
    sections = [{"hold": 2200.0}, {"build": {"radius": 1000.0, "to": "90 deg", "azimuth": azimuth}}]
    turned = Balance(shipped("jwell", well__sections=sections))
    for name in ("hook_load", "tension", "contact_force"):
        assert turned[name] == pytest.approx(usual[name], rel=1e-7, abs=1e-2), name


@pytest.mark.parametrize("gravity", [1e-6, 1.62, 24.8, 981.0])
@pytest.mark.parametrize("elements", [1, 7])
def test_a_plumb_string_weighs_in_proportion_to_gravity(gravity, elements):
    hangs = Balance(straight_hole(0.0, elements=elements, gravity=gravity))
    assert hangs["hook_load"] == pytest.approx(steel() * 100.0 * gravity, rel=1e-7)
