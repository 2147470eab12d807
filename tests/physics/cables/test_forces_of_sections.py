"""The axial force of what bends balances the forces on what lies beyond the section.

The energy of bending EJ kappa^2 / 2 per metre of material has the geometric curvature, which a stretch flattens: beside
EA epsilon lambda the section carries -EJ kappa^2 / lambda. References: equilibrium of what lies beyond a section; the
inextensible elastica (scipy's solve_ivp and brentq); a circle, a clothoid that is bent and stretched at given rates.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

import tautline
from tautline.cable.model.bending_force import BendingForce
from tautline.cable.model.observe import Observer
from tautline.kernels.hermite import SECOND, THIRD, table

FREE, CLAMPED = [0, 0, 0, 0, 0, 0, 1], [1, 1, 1, 0, 1, 1, 1]


def node(number, place, held=FREE, slope=None):
    return {"Node7Dof": {"id": number, "xyz": place, "BC": held} | ({"xyz_d": slope} if slope else {})}


def scene(*items, gravity=0.0, **solver):
    chosen = {
        "type": "G-alpha",
        "rho_inf": 0.8,
        "time_step": 0.001,
        "time_end": 0.001,
        "eps_energy": 1e-12,
        "start": "static",
    }
    return {
        "CableModelMaterial": {"Gravity": [0.0, 0.0, -gravity]},
        "CableModel": list(items),
        "GeneralizedAlpha": chosen | solver,
    }


def bar(elements, load, length=2.0, EJ=3.0, **more):
    """A clamped bar along x with a dead load at its end."""
    line = {"id": 0, "nodes7": [0, 1], "elements": elements, "EA": 1e5, "EJ": EJ, "rhoA": 1.0} | more
    ends = node(0, [0.0, 0.0, 0.0], CLAMPED, [1.0, 0.0, 0.0]), node(1, [length, 0.0, 0.0])
    return [*ends, {"CableLine": line}, {"PointForce": {"id": 0, "nodes7": [1], "force": load}}]


def elastica(load, places):
    """sin of the angle at places, as shares of the length, of a bar clamped along x under P L^2 / EJ across it."""

    def shape(moment):
        return solve_ivp(
            lambda s, y: [y[1], -load * np.cos(y[0])], [0, 1], [0, moment], rtol=1e-11, atol=1e-12, dense_output=True
        ).sol

    clamp = brentq(lambda moment: shape(moment)(1.0)[1], 0.5 * load**0.5, 1.5 * load**0.5)
    return np.sin(shape(clamp)(places)[0])


@pytest.mark.parametrize(
    ("strain", "quadrature"), [("green", "lobatto"), ("engineering", "lobatto"), ("green", "gauss")]
)
def test_the_axial_force_of_the_elastica_is_the_share_of_its_load_along_the_section(strain, quadrature):
    n, load = 64, 7.5
    result = tautline.simulate(scene(*bar(n, [0.0, 0.0, load], strain=strain, quadrature=quadrature)))
    expected = load * elastica(10.0, (np.arange(n) + 0.5) / n)
    # Gauss points lock: their strain wavers along an element.
    assert result["axial_force"][0] == pytest.approx(expected, abs=0.004 if quadrature == "lobatto" else 0.1)
    figures = result.attributes["headline"]
    at_tip, at_clamp = load * elastica(10.0, np.array([1.0, 0.0]))
    assert figures["axial_force_max"]["value"] == pytest.approx(at_tip, abs=0.004 if quadrature == "lobatto" else 0.1)
    assert result["end_force"][0, [0, -1], [0, 1]] == pytest.approx([at_clamp, at_tip], abs=1e-3)
    # Its strain is that of EA alone: at the clamp it holds EJ kappa^2 = 14.6 N as well.
    (strained,) = (one for one in result.attributes["limits"] if one["name"] == "strain")
    assert strained["value"] == pytest.approx(14.6e-5, rel=0.01) and strained["place"] == "element 0"


def test_a_rod_that_is_closed_to_a_ring_carries_no_axial_force():
    n, way = 16, {"LagMultipl7": {"id": 0, "nodes7": [16, 0], "constr": 0}}
    angles = 2.0 * np.pi * np.arange(n + 1) / n
    nodes = [node(i, [np.cos(a), np.sin(a), 0.0], FREE, [-np.sin(a), np.cos(a), 0.0]) for i, a in enumerate(angles)]
    nodes[1]["Node7Dof"]["BC"], nodes[n // 2]["Node7Dof"]["BC"] = [0, 0, 1, 0, 0, 0, 1], [0, 1, 1, 0, 0, 0, 1]
    nodes[0]["Node7Dof"]["BC"] = [1, 1, 1, 0, 0, 0, 1]
    parts = [{"CableALEelement": {"id": i, "nodes7": [i, i + 1], "EA": 1e5, "EJ": 2.0, "rhoA": 1.0}} for i in range(n)]
    result = tautline.simulate(scene(*nodes, *parts, way, {"LagMultipl7": {"id": 1, "nodes7": [16, 0], "constr": 2}}))
    assert np.abs(result["axial_force"]).max() < 0.01, "of EJ / R^2 = 2 N, by the mesh"
    # The tie of slopes carries the moment EJ / R, the tie of positions nothing.
    force, moment = (np.asarray(result[name])[-1] for name in ("multiplier", "multiplier_moment"))
    assert force.shape == (3,) and np.abs(force).max() < 1e-6 and moment[0] == pytest.approx(-2.0, rel=1e-3)
    assert [result.data[name].attrs["units"] for name in ("multiplier", "multiplier_moment")] == ["N", "N m"]


def test_a_buckled_column_carries_its_load_at_the_clamp():
    load = 1.1 * np.pi**2 * 3.0 / 4.0**2
    result = tautline.simulate(scene(*bar(32, [-load, 0.0, 0.0], EA=1e6)))
    assert np.asarray(result["position"])[0, :, 0].max() < 1.9, "buckled"
    assert result["axial_force"][0, 0] == pytest.approx(-load, rel=1e-3)
    assert result["axial_force"].min() == pytest.approx(-load, rel=1e-3)


@pytest.mark.parametrize("speed", [0.0, 8.0])
def test_a_hose_that_hangs_from_a_level_clamp_carries_the_weight_and_the_turn_of_its_water_beyond_each_section(speed):
    """Water enters the part beyond with M U^2 along the section, and leaves it with M U^2 along the tip."""
    text = f"""
title: A hose at rest
hose: {{length: 0.5, elements: 40, axial_stiffness: 1000 N, bending_stiffness: 0.00108, mass_per_length: 0.0031316,
  damping: 0.0031316, root: [0, 0, 0], direction: [1, 0, 0]}}
water: {{mass_per_length: 0.0007854, speed: {speed}}}
gravity: [0, 0, -9.81]
start: static
solver: {{method: generalized-alpha, rho_inf: 0.9, step: 1 ms, end: 1 ms}}
output: {{interval: 1 ms}}
"""
    result = tautline.simulate(text)
    position, slope = (np.asarray(result[name])[0] for name in ("position", "slope"))
    h = 0.5 / 40
    # r' in the middle of a cubic.
    along = 1.5 * np.diff(position, axis=0) / h - 0.25 * (slope[1:] + slope[:-1])
    along /= np.linalg.norm(along, axis=1)[:, None]
    weight = (0.0031316 + 0.0007854) * 9.81 * (0.5 - h * (np.arange(40) + 0.5))
    turned = 0.0007854 * speed**2 * (1.0 - along @ slope[-1] / np.linalg.norm(slope[-1]))
    assert np.abs(0.00108 * np.asarray(result["curvature"])[0] ** 2).max() > 0.1 * weight[0]
    assert result["axial_force"][0] == pytest.approx(turned - weight * along[:, 2], abs=1e-4 * weight[0])


@pytest.mark.parametrize("smoothing", [0.0, 0.6])
def test_damping_of_bending_pulls_on_a_section_as_the_moment_that_it_adds(smoothing):
    """r' = lambda (cos theta, sin theta, 0) with given lambda, lambda', theta' and rates: N = -kappa M / lambda."""
    EJ, c, stretch, along, turning = 3.0, 0.2, 1.3, 0.4, 0.9
    stretch_rate, along_rate, turning_rate, angle, angle_rate = 0.7, -0.3, 1.1, 0.5, 2.0
    t, n = np.array([np.cos(angle), np.sin(angle), 0.0]), np.array([-np.sin(angle), np.cos(angle), 0.0])
    e, turn = stretch * t, along * t + stretch * turning * n
    e_rate = stretch_rate * t + stretch * angle_rate * n
    turn_rate = along_rate * t + along * angle_rate * n
    turn_rate += (stretch_rate * turning + stretch * turning_rate) * n - stretch * turning * angle_rate * t
    kappa = turning / stretch
    kappa_rate = turning_rate / stretch - turning * stretch_rate / stretch**2
    moment = EJ * kappa + EJ * c * kappa_rate * kappa**2 / (kappa**2 + smoothing**2)
    bent = BendingForce.__new__(BendingForce)
    bent.smoothing = np.array([smoothing])
    vectors = (x[None, None] for x in (e, e_rate, turn, turn_rate))
    found = bent.of(*vectors, np.array([EJ]), np.array([EJ * c]))
    assert found[0, 0] == pytest.approx(-kappa * moment / stretch, rel=1e-12)


def test_the_turn_of_the_particle_in_the_middle_changes_as_material_moves_through_the_nodes():
    """A cubic whose nodes stand still while p of both changes; reference: r'' where the particle is a moment later."""
    ends = [np.array([0.0, 0.1, 0.0]), np.array([1.0, 0.3, 0.1]), np.array([0.9, 0.5, 0.2]), np.array([0.8, -0.4, 0.3])]
    begin, end, rates, dt = 1.0, 2.2, (0.3, 0.8), 1e-5

    def turn(time):
        p = begin + rates[0] * time, end + rates[1] * time
        length, place = p[1] - p[0], (0.5 * (begin + end) - p[0]) / (p[1] - p[0])
        shape = table(np.array([place]), np.ones(1))[0][SECOND : SECOND + 4]
        return (shape[0] * ends[0] + length * shape[1] * ends[1] + shape[2] * ends[2] + length * shape[3] * ends[3]) / (
            length**2
        )

    observer = Observer.__new__(Observer)
    observer.middle = table(np.array([0.5]), np.ones(1))[0]
    found = observer._carried(ends, turn(0.0), end - begin, rates[1] - rates[0], 0.5 * sum(rates))
    assert THIRD and found == pytest.approx((turn(dt) - turn(-dt)) / (2.0 * dt), rel=1e-7)


def test_a_damped_bar_that_swings_carries_the_inertia_of_what_lies_beyond_a_section():
    """Acceleration by differences of the stored velocities, a spline along the bar."""
    n, length, first = 24, 2.0, 8
    items = bar(n, [0.0, 0.0, 7.5], cDamp=0.1)
    items[-1]["PointForce"]["timeInterval"] = [0.0, 0.4]
    result = tautline.simulate(scene(*items, rho_inf=1.0, time_step=5e-4, time_end=1.0, plotpoints=2000))
    order = np.argsort(np.asarray(result["material_coordinate"])[0])
    position, velocity = (np.asarray(result[name])[:, order] for name in ("position", "velocity"))
    places, middle = np.linspace(0.0, length, n + 1), (first + 0.5) * length / n
    momentum = CubicSpline(places, velocity, axis=1).antiderivative()
    beyond = momentum(length) - momentum(middle)
    drawn = CubicSpline(places, position, axis=1, bc_type="natural")
    along = drawn(middle, 1) / np.linalg.norm(drawn(middle, 1), axis=-1)[:, None]
    time = np.asarray(result["time"])
    later = np.flatnonzero(time > 0.45)[1:-1]
    pull = -((beyond[later + 1] - beyond[later - 1]) / 1e-3 * along[later]).sum(axis=-1)
    told = np.asarray(result["axial_force"])[later, first]
    # Of it EJ kappa^2 / lambda would be 2.5 N, the share of damping is up to 0.28 N.
    assert np.abs(pull).max() > 2.0 and told == pytest.approx(pull, abs=0.01)
