"""Friction, weight and rotation of strings in straight holes against closed forms; no mud, no bending."""

from math import atan, cos, pi, sin, sqrt

import numpy as np
import pytest
from physics.wells.strings import GRAVITY, E, run, straight_hole
from physics.wells.strings import mass_per_length as steel
from scipy.special import ellipk

from drillstring.warnings.scene_warnings import warnings

RADIUS = 0.165 / 2
NO_SPRING = {"material__youngs_modulus": 1.0}
"""Steel so soft that the links pull with less than a millionth of the weight: lumps move freely along the hole."""


def test_a_free_lump_falls_by_half_g_t_squared():
    # free fall in a vertical hole; the link's pull is 1e-7 of the weight
    result = run(straight_hole(0.0, start="straight", solver__end=3.0, **NO_SPRING))
    t = result.time
    assert result["bit_depth"] - 100.0 == pytest.approx(GRAVITY * t**2 / 2, abs=2e-6)
    assert result["bit_speed"] == pytest.approx(GRAVITY * t, abs=2e-6)


@pytest.mark.parametrize("friction", [0.0, 0.2, 0.5])
def test_a_lump_slides_down_a_slant_hole_with_g_cos_less_mu_g_sin(friction):
    # 60 deg, friction below tan(30 deg) = 0.577; after its fall on the wall; within 1e-4
    result = run(straight_hole(pi / 3, friction=friction, start="straight", solver__end=4.0, **NO_SPRING))
    late = result.time > 2.0
    slope = np.polyfit(result.time[late], result["bit_speed"][late], 1)[0]
    assert slope == pytest.approx(GRAVITY * (cos(pi / 3) - friction * sin(pi / 3)), rel=1e-4)


def test_a_lump_let_go_level_is_a_pendulum_of_quarter_period_k_of_one_half():
    # exact: T/4 = K(m = 1/2) sqrt(L/g); 500 m wide hole, nothing lost; stretch of the steel is 6e-5 of the length
    result = run(straight_hole(pi / 2, diameter=500.0, start="straight", solver__end=7.0, solver__rho_inf=1.0))
    north, t = result["position"][:, -1, 0], result.time
    i = np.flatnonzero(north < 0.0)[0]
    lowest = t[i - 1] + (t[i] - t[i - 1]) * north[i - 1] / (north[i - 1] - north[i])
    assert lowest == pytest.approx(ellipk(0.5) * sqrt(100.0 / GRAVITY), rel=2e-4)
    assert result["velocity"][i, -1, 0] == pytest.approx(-sqrt(2 * GRAVITY * 100.0), rel=2e-4)
    # three times the weight of half the collar, which belongs to the lump
    assert result["tension"][i, 0] == pytest.approx(3 * steel() * 50.0 * GRAVITY, rel=2e-3)


STOPPED = {"velocity": {"ramp": {"from": 0.3, "to": 0.0, "over": 1.0, "at": 1.0}}}


@pytest.mark.parametrize(("inclination", "friction"), [(pi / 3, 1.2), (pi / 2, 0.3)])
def test_a_string_on_the_wall_stopped_in_motion_sticks_without_creep(inclination, friction):
    # friction above tan(30 deg) or level; 5 s: speed < 1e-8 m/s, drift < 1e-8 m
    result = run(
        straight_hole(
            inclination, length=400.0, elements=4, friction=friction, top__block=STOPPED, solver__end=9.0,
            output__interval=0.05, damping={"structural": 0.01},
        )
    )  # fmt: skip
    assert result["bit_speed"].max() > 0.05, "it did move"
    still = result.time >= 4.0
    assert np.abs(result["axial_velocity"][still]).max() < 1e-8
    assert np.ptp(result["measured_depth"][still], axis=0).max() < 1e-8
    assert np.ptp(result["position"][still], axis=0).max() < 1e-8


@pytest.mark.parametrize("friction", [1.2, {"static": 1.2, "kinetic": 0.3}])
def test_a_string_at_rest_on_the_wall_of_a_slant_hole_stays_where_it_is(friction):
    result = run(
        straight_hole(pi / 3, length=400.0, elements=4, friction=friction, solver__end=5.0, output__interval=0.05)
    )
    assert np.abs(result["axial_velocity"]).max() < 1e-8
    assert np.ptp(result["measured_depth"], axis=0).max() < 1e-8
    assert np.ptp(result["hook_load"]) < 1e-3


@pytest.mark.parametrize("method", ["generalized-alpha", "newmark"])
@pytest.mark.parametrize("step", [1e-3, 1e-2, 5e-2])
def test_a_string_sticks_at_every_step_and_implicit_method(method, step):
    result = run(
        straight_hole(
            pi / 3, length=400.0, elements=4, friction=1.2, top__block=STOPPED, solver__end=8.0, solver__step=step,
            solver__method=method, output__interval=0.1, damping={"structural": 0.05},
        ),
        energy=0.05,
    )  # fmt: skip
    still = result.time >= 5.0
    assert np.abs(result["axial_velocity"][still]).max() < 1e-8
    assert np.ptp(result["measured_depth"][still], axis=0).max() < 1e-8


def slow(to):
    return {"top__block": {"velocity": {"ramp": {"to": to, "over": 1.0}}}, "damping": {"structural": 0.3}}


@pytest.mark.parametrize(("sense", "speed"), [(1.0, -0.1), (-1.0, 0.1)])
def test_hook_load_of_a_string_moved_in_a_slant_hole_is_w_l_cos_plus_or_minus_mu_sin(sense, speed):
    # exact for lumps: the half element at the top drive touches nothing, and so takes no friction: (1 - 1/2n). Narrow
    # hole, so that the top link, which comes off the axis, pulls the lump below it off the wall by 1e-4 of its weight
    n, length, mu, inclination = 10, 1000.0, 0.3, 1.0
    result = run(
        straight_hole(
            inclination, length=length, elements=n, diameter=0.17, friction=mu, solver__end=12.0, solver__step=2e-3,
            output__interval=0.05, **slow(speed),
        )
    )  # fmt: skip
    late = result.time > 11.0
    share = (result["axial_velocity"][late][:, 1:] * -sense > 0.0).all()
    assert share, "all of the string moves"
    weight = steel() * GRAVITY * length
    exact = weight * (cos(inclination) + sense * mu * sin(inclination) * (1 - 0.5 / n))
    assert result["hook_load"][late] == pytest.approx(exact, rel=3e-4)


def test_a_rotating_lump_climbs_the_wall_to_the_angle_of_friction():
    # level hole: friction and normal force carry the weight, tan(angle) = mu; clockwise rotation climbs to the right
    # (east of a hole that goes north); N = W cos, torque = mu N R. Damping calms the swing and does nothing at rest
    mu = 0.3
    result = run(
        straight_hole(
            pi / 2, friction=mu, top__rotation={"ramp": {"to": "60 rpm", "over": 2.0}}, solver__end=12.0,
            damping={"translation": 3e4, "structural": 0.01}, output__interval=0.05,
        )
    )  # fmt: skip
    late = result.time > 11.0
    east, down = result["position"][late, -1, 1], result["position"][late, -1, 2]
    weight = steel() * 50.0 * GRAVITY
    assert np.arctan2(east, down) == pytest.approx(atan(mu), rel=2e-3)
    normal = result["contact_force"][late, -1]
    pull = result["tension"][late, 0] * np.hypot(east, down) / 100.0
    assert normal == pytest.approx(weight * cos(atan(mu)) - pull, rel=1e-3)
    assert result["surface_torque"][late] == pytest.approx(mu * normal * RADIUS, rel=1e-3)


def test_surface_torque_of_steady_rotation_is_the_sum_of_friction_and_viscous_torques():
    rotation = {"ramp": {"to": "90 rpm", "over": 3.0}}
    damping = {"translation": 3e4, "rotation": 40.0, "contact_rotation": 5.0, "structural": 0.05}
    result = run(
        straight_hole(
            1.2, length=500.0, elements=5, friction=0.25, top__rotation=rotation, damping=damping, solver__end=20.0,
            solver__step=2e-3, output__interval=0.05,
        )
    )  # fmt: skip
    late = result.time > 18.0
    turning = result["rotation_rate"][late]
    assert turning == pytest.approx(3 * pi, rel=2e-3)
    coulomb = -RADIUS * result["friction_around"][late].sum(axis=1)
    # c_r on every lump by its share of the length, the top one's too; c_fc on those that touch
    share = np.array([0.5, 1.0, 1.0, 1.0, 1.0, 0.5])
    touching = result["contact_force"][late] > 0.0
    viscous = (40.0 * share * turning + 5.0 * share * touching * turning).sum(axis=1)
    assert viscous.mean() > 0.02 * coulomb.mean()
    assert result["surface_torque"][late].mean() == pytest.approx((coulomb + viscous).mean(), rel=2e-3)


def drive(**limits):
    controller = {"proportional": 2500.0, "integral": 600.0, "inertia": 2000.0}
    controller["speed"] = {"ramp": {"to": "120 rpm", "over": 2.0}}
    return run(
        straight_hole(
            pi / 2, length=300.0, elements=3, friction=0.3, top__rotation={"controller": controller | limits},
            damping={"translation": 3e4, "structural": 0.02}, solver__end=25.0, solver__step=2e-3,
            output__interval=0.05,
        )
    )  # fmt: skip


FRICTION_TORQUE = 0.3 / sqrt(1.09) * steel() * 250.0 * GRAVITY * RADIUS
"""Of the lumps below the drive, which touch with their whole weight."""


def test_top_drive_under_control_reaches_its_speed_and_gives_the_friction_torque():
    result = drive()
    late = result.time > 22.0
    assert result["rotation_rate"][late, 0] == pytest.approx(4 * pi, rel=1e-2)
    assert result["rotation_rate"][late, -1].mean() == pytest.approx(4 * pi, rel=1e-2)
    assert result["surface_torque"][late].mean() == pytest.approx(FRICTION_TORQUE, rel=1e-2)


def test_top_drive_with_too_low_a_torque_limit_stalls():
    limit = 0.6 * FRICTION_TORQUE
    result = drive(torque_limit=limit)
    late = result.time > 22.0
    # The limit is the drive's; its inertia swings on the wound-up string about that.
    assert result["surface_torque"][late].mean() == pytest.approx(limit, rel=0.05)
    assert abs(result["rotation_rate"][late, 0].mean()) < 0.01 * 4 * pi
    # the bit never turns a radian, and the drive does not turn on: it winds the string up and stops
    assert np.abs(result["rotation"][:, -1]).max() < 1.0
    assert np.abs(result["rotation_rate"][late].mean(axis=0)).max() < 0.05 * 4 * pi


def test_an_eccentric_lump_whirls_with_the_amplitude_of_the_force_m_e_omega_squared():
    # vertical hole, no wall near: m u'' + c u' + (m g / L) u = m e Omega^2 turning at Omega; amplitude within 2e-3
    omega, e, c = 2 * pi, 1e-3, 3000.0
    result = run(
        straight_hole(
            0.0, diameter=3.0, top__rotation="60 rpm", string__0__eccentricity=[0.0, e], solver__rho_inf=1.0,
            damping={"translation": 2 * c}, solver__end=60.0, solver__step=2e-3, output__interval=0.05,
        )
    )  # fmt: skip
    late = result.time > 50.0
    mass = steel() * 50.0
    exact = e * mass * omega**2 / abs(mass * GRAVITY / 100.0 - mass * omega**2 + 1j * c * omega)
    x, y = result["lateral_displacement"][late, -1].T
    assert np.hypot(x, y) == pytest.approx(exact, rel=2e-3)
    turned = np.unwrap(np.arctan2(y, x))
    assert np.polyfit(result.time[late], turned, 1)[0] == pytest.approx(omega, rel=1e-4), "synchronous, the same way"


def test_an_eccentric_lump_presses_on_the_wall_with_the_centrifugal_force_of_its_centre_of_mass():
    # vertical hole, no friction: whirl in contact at radius r: N = m Omega^2 (r + e cos phi) - W r / L; the centre of
    # mass leads the point of contact by phi, for the lateral damping: m e Omega^2 sin phi = c Omega r
    omega, e, c = 4 * pi, 5e-3, 5000.0
    result = run(
        straight_hole(
            0.0, diameter=0.175, top__rotation="120 rpm", string__0__eccentricity=[e, 0.0], solver__end=40.0,
            output__interval=0.05, damping={"translation": 2 * c},
        )
    )  # fmt: skip
    late = result.time > 38.0
    mass, r = steel() * 50.0, np.hypot(*result["lateral_displacement"][late, -1].T)
    lag = np.arcsin(c * r / (mass * e * omega))
    exact = mass * omega**2 * (r + e * np.cos(lag)) - mass * GRAVITY * r / 100.0
    assert result["contact_force"][late, -1] == pytest.approx(exact, rel=3e-3)
    assert result["contact_force"][late, -1].mean() == pytest.approx(exact.mean(), rel=1e-3)


def test_axial_wave_of_a_stopped_block_swings_at_the_lumps_frequency():
    # one lump on its link: omega^2 = (EA / L) / (m / 2), exact for n = 1; friction none
    stopped = {"velocity": {"ramp": {"from": 0.1, "to": 0.0, "over": 0.01}}}
    result = run(straight_hole(0.0, top__block=stopped, solver__rho_inf=1.0))
    x = result["bit_depth"] - result["bit_depth"][2:].mean()
    crossings = np.flatnonzero(np.diff(np.sign(x[2:])) > 0) + 2
    t = result.time[crossings] - x[crossings] * np.diff(result.time)[0] / (x[crossings + 1] - x[crossings])
    area = steel() / 7850.0
    exact = sqrt(E * area / 100.0 / (steel() * 50.0))
    assert 2 * pi / np.diff(t).mean() == pytest.approx(exact, rel=5e-3)


@pytest.mark.parametrize("elements", [5, 20, 60])
def test_the_side_force_that_the_first_half_element_lacks_is_told_where_the_hole_is_inclined_there(elements):
    # w sin(i) h / 2 of w sin(i) L: 1 / (2 n), told from 1 % on; and the run lacks as much
    scene = straight_hole(pi / 4, length=400.0, elements=elements, friction=0.3, solver__end=8.0)
    told = [one.text for one in warnings(scene) if "inclined at the rotary table" in one.text]
    assert len(told) == (elements < 50)
    if told:
        assert f"{100.0 / (2 * elements):.2g} % of the side force" in told[0]
        assert "With 50 elements it is 1 %" in told[0]


def test_a_run_lacks_the_side_force_that_is_told():
    # of long elements; of short ones the pull towards the axis at the drive takes more
    found = run(straight_hole(pi / 4, length=400.0, elements=5, friction=0.3, solver__end=8.0))
    pushed = found["contact_force"][found.time > 4.0].sum(axis=1).mean()
    whole = steel() * 400.0 * GRAVITY * sin(pi / 4)
    assert 1.0 - pushed / whole == pytest.approx(0.1, abs=2e-3)


def test_a_hole_that_is_vertical_at_the_table_is_not_told_of_its_first_half_element():
    assert not any("rotary table" in one.text for one in warnings(straight_hole(0.0, friction=0.3)))
