"""Self-tests of the reference span: closed forms in the plane, the plain element, Hamilton's principle, symmetries."""

from dataclasses import replace

import numpy as np
import pytest
from of_the_suite import kept, studies
from scipy.spatial.transform import Rotation

from references import ale_ancf as ale
from references import span_lagrangian as ref

CASES = ref.cases(3)
EVERY = pytest.mark.parametrize("case", CASES, ids=[c.name for c in CASES])
SOME = [c for c in CASES if c.name in ("open", "crossed back, axes askew", "point to sheave", "frames at rest")]
PLANAR_SIGNS = [(1, 1), (-1, -1), (1, -1), (-1, 1), (0, 1), (-1, 0)]


def named(name):
    return next(c for c in CASES if c.name == name)


def moved(case, s):
    """Coordinates, rates and time after s of the motion with constant accelerations."""
    return case.q + s * case.v + s**2 / 2 * case.a, case.v + s * case.a, case.time + s


def slope(function, h):
    """Derivative at 0 by central differences of the eighth order."""
    weights = np.array([4 / 5, -1 / 5, 4 / 105, -1 / 280]) / h
    return sum(w * (function(k * h) - function(-k * h)) for k, w in enumerate(weights, start=1))


def in_space(sheave, time):
    """Axis and mark in space."""
    turned = ref.rotation(sheave, time)
    return turned @ sheave.axis, turned @ sheave.mark


def assert_forces(got, expected, tolerance):
    assert np.max(np.abs(got - expected)) < tolerance * np.max(np.abs(expected))


# geometry
@EVERY
def test_the_tangent_touches_both_rims(case):
    at = ref.geometry(case.span, case.q, case.time)
    radii = [case.span.first.radius, case.span.second.radius]
    s = case.q[4:7] + radii[1] * at.w[1] - case.q[0:3] - radii[0] * at.w[0]
    np.testing.assert_allclose(s, at.length * at.e, atol=1e-14 * np.max(np.abs(case.q)))
    for k, sheave in enumerate((case.span.first, case.span.second)):
        if sheave.radius:
            axis, mark = in_space(sheave, case.time)
            assert abs(at.w[k] @ at.e) < 1e-15 and abs(at.w[k] @ axis) < 1e-15
            assert np.cross(at.e, axis) @ at.w[k] > 0  # the rope travels right-handed about the axis where w is outward
            np.testing.assert_allclose(Rotation.from_rotvec(at.psi[k] * axis).apply(mark), at.w[k], atol=2e-15)
    assert at.path == pytest.approx(at.length + radii[0] * at.psi[0] - radii[1] * at.psi[1], rel=1e-15)


@EVERY
def test_cases_are_cranes(case):
    at = ref.geometry(case.span, case.q, case.time)
    assert 1 <= at.length <= 30 and 1.0005 < at.stretch < 1.0015
    assert abs(ref.strain_rate(case.span, case.q, case.v, case.time)) < 0.1
    arcs = at.path - at.length
    for sheave in (case.span.first, case.span.second):
        axis, _ = in_space(sheave, case.time)
        assert abs(sheave.radius) <= 1
        assert sheave.radius == 0 or np.degrees(np.arcsin(abs(axis @ at.e))) < 5.001
    assert arcs >= 0 and ("shorter" not in case.name or arcs > at.length)


def test_sheaves_too_close_have_no_tangent():
    span = ref.Span(ref.Sheave(0.6, (0, 0, 1), (1, 0, 0)), ref.Sheave(-0.6, (0, 0, 1), (1, 0, 0)), 8e7, 6.5)
    with pytest.raises(ValueError, match=r"no tangent between signed radii 0\.6 and -0\.6 m at 1\.1 m"):
        ref.geometry(span, [0, 0, 0, 0, 1.1, 0, 0, 1], 0.0)


@EVERY
def test_envelope_rule_and_its_remainder_at_a_fleet_angle(case):
    # the shift of the tangent points cancels but for the part of it across the rope; measured 2e-12 m/s
    first, second = case.span.first, case.span.second
    at = ref.geometry(case.span, case.q, case.time)

    def lengths(s):
        there = ref.geometry(case.span, *moved(case, s)[::2])
        return np.array([there.path, *there.psi])

    path, *psi = slope(lengths, 4e-3)
    points, remainder = [], []
    for k, sheave in enumerate((first, second)):
        points.append(case.v[4 * k : 4 * k + 3] + sheave.radius * np.cross(sheave.rate, at.w[k]))
        fleet_cosine = np.linalg.norm(np.cross(at.e, in_space(sheave, case.time)[0]))
        remainder.append(sheave.radius * psi[k] * (1 - fleet_cosine))
    assert path == pytest.approx(at.e @ (points[1] - points[0]) + remainder[0] - remainder[1], abs=1e-11)


# closed forms
def planar(signs, seed=0):
    """A case in a plane of any direction: both axes normal to it, all motion and gravity in it; and that normal."""
    rng = np.random.default_rng(seed)
    plane = Rotation.random(rng=rng).as_matrix()
    normal = plane[:, 2]
    sheaves = []
    for sign in signs:
        mark = plane[:, :2] @ rng.normal(size=2)
        rate = rng.uniform(-0.3, 0.3) * normal
        sheaves.append(ref.Sheave(sign * rng.uniform(0.2, 1.0), normal, mark, np.eye(3), rate))
    q, v, a = rng.uniform(-2, 2, 8), 2 * rng.normal(size=8), 3 * rng.normal(size=8)
    for x in (q, v, a):
        x[0:3], x[4:7] = plane[:, :2] @ x[0:2], plane[:, :2] @ x[4:6]
    q[4:7] += 6 * plane[:, 0]
    span = ref.Span(*sheaves, EA=8e7, rhoA=6.5, damping=1e-3, gravity=plane[:, :2] @ [3.0, -9.0])
    q[7] = q[3] + ref.geometry(span, q, 0.7).path / 1.001
    v[7] = v[3] + rng.normal()
    return ref.Case("planar", span, q, v, a, 0.7), normal


def closed_form(case, normal):
    """Residual and power of the frames for parallel axes, in doubles, as one would program it."""
    span, (q, v, a) = case.span, (case.q, case.v, case.a)
    rho = [span.first.radius, span.second.radius]
    turning = [s.rate @ normal for s in (span.first, span.second)]
    c1, p1, c2, p2 = q[:3], q[3], q[4:7], q[7]
    d, delta = c2 - c1, rho[0] - rho[1]
    l = np.sqrt(d @ d - delta**2)
    e = (l * d + delta * np.cross(normal, d)) / (d @ d)
    w = np.cross(e, normal)
    arcs = 0.0
    for sign, r, sheave in ((1, rho[0], span.first), (-1, rho[1], span.second)):
        mark = Rotation.from_rotvec(case.time * np.asarray(sheave.rate)).apply(sheave.mark)
        arcs += sign * r * np.arctan2(np.cross(mark, w) @ normal, mark @ w)
    L, Ldot = p2 - p1, v[7] - v[3]
    stretch = (l + arcs) / L
    t = stretch * e
    psidot = -(w @ (v[4:7] - v[:3])) / l
    turned = -rho[0] * turning[0] + rho[1] * turning[1]
    stretch_dot = (e @ (v[4:7] - v[:3]) + turned - stretch * Ldot) / L
    tdot = stretch_dot * e - stretch * w * psidot
    v1, v2 = v[:3] - t * v[3], v[4:7] - t * v[7]
    a1, a2 = a[:3] - t * a[3] - tdot * v[3], a[4:7] - t * a[7] - tdot * v[7]
    k, kdot = span.rhoA * L / 6, span.rhoA * Ldot / 6
    m1, m2 = k * (2 * v1 + v2), k * (v1 + 2 * v2)
    n1, n2 = k * (2 * a1 + a2) + kdot * (2 * v1 + v2), k * (a1 + 2 * a2) + kdot * (v1 + 2 * v2)
    P = v[3] * m1 + v[7] * m2
    G = e * (e @ P) / L + stretch * w * (w @ P) / l
    tau = ((v1 @ m1 + v2 @ m2) / 2 + P @ t) / L
    strain = (stretch**2 - 1) / 2
    N = span.EA * (strain + span.damping * stretch * stretch_dot) * stretch
    W = span.EA * strain**2 / 2
    weight = span.rhoA * np.asarray(span.gravity)
    rows = [n1 - G - N * e - weight * L / 2]
    rows.append([-tdot @ m1 - t @ n1 + tau - (W - N * stretch) + weight @ (c1 + c2) / 2])
    rows.append(n2 + G + N * e - weight * L / 2)
    rows.append([-tdot @ m2 - t @ n2 - tau + (W - N * stretch) - weight @ (c1 + c2) / 2])
    return np.concatenate(rows), (N + e @ P / L) * turned


@pytest.mark.parametrize("signs", [*PLANAR_SIGNS[3:], *studies(*((signs,) for signs in PLANAR_SIGNS[:3]))])
def test_parallel_axes_give_the_closed_form(signs):
    # measured 1e-13: the doubles of the closed form, whose strain is a thousandth
    case, normal = planar(signs)
    expected, power = closed_form(case, normal)
    assert_forces(ref.residual(case.span, case.q, case.v, case.a, case.time), expected, 1e-11)
    scale = np.max(np.abs(expected)) * 0.3
    assert ref.frame_power(case.span, case.q, case.v, case.time) == pytest.approx(power, abs=1e-11 * scale)


def test_axes_opposite_to_each_other_are_the_same_sheaves_with_opposite_radius():
    case, normal = planar((1, 1))
    second = case.span.second
    # about the opposite axis w is opposite too, and so is the mark
    other = replace(second, radius=-second.radius, axis=-normal, mark=-np.asarray(second.mark))
    turned = replace(case.span, second=other)
    at, same = (ref.geometry(span, case.q, case.time) for span in (case.span, turned))
    assert same.path == pytest.approx(at.path, rel=1e-15)
    state = (case.q, case.v, case.a, case.time)
    assert_forces(ref.residual(turned, *state), ref.residual(case.span, *state), 1e-13)


def test_points_give_the_linear_element():
    # measured 2e-14; Lagrange's equations have the flux through the ends besides the virtual work of the particles
    case = named("point to point")
    q, v, a, span = case.q, case.v, case.a, case.span
    load = span.rhoA * np.asarray(span.gravity)
    expected = ale.inertia(q, v, a, span.rhoA, linear=True) + ale.elastic(q, span.EA, 0.0, linear=True)
    expected += ale.damping(q, v, span.EA, 0.0, span.damping, linear=True)
    expected += ale.jacobian(lambda x: ale.potential_energy(x, load, linear=True), q)
    stretched = (q[4:7] - q[0:3]) / (q[7] - q[3])
    for k, sign in ((0, -1), (4, 1)):
        particle, flow = v[k : k + 3] - stretched * v[k + 3], sign * span.rhoA * v[k + 3]
        expected[k : k + 3] += flow * particle
        expected[k + 3] -= flow * stretched @ particle + sign * span.rhoA * particle @ particle / 2
    assert_forces(ref.residual(span, q, v, a, case.time), expected, 1e-11)
    assert ref.kinetic_energy(span, q, v, case.time) == pytest.approx(ale.kinetic_energy(q, v, span.rhoA, True))
    assert ref.strain_energy(span, q, case.time) == pytest.approx(ale.strain_energy(q, span.EA, 0.0, linear=True))
    assert ref.potential_energy(span, q) == pytest.approx(ale.potential_energy(q, load, True))


def test_small_sheaves_tend_to_points():
    case = named("crossed")
    state = (case.q, case.v, case.a, case.time)

    def shrunk(factor):
        ends = (replace(s, radius=factor * s.radius) for s in (case.span.first, case.span.second))
        return ref.residual(replace(case.span, EA=1e3, first=next(ends), second=next(ends)), *state)

    point = shrunk(0.0)
    assert np.max(np.abs(shrunk(1e-9) - point)) < 1e-7 * np.max(np.abs(point))


# balances
@pytest.mark.parametrize("case", kept(CASES, SOME), ids=[c.name for c in CASES])
def test_energy_grows_by_the_work_of_the_residual_and_of_the_frames(case):
    def energy(s):
        q, v, time = moved(case, s)
        kinetic = ref.kinetic_energy(case.span, q, v, time)
        return kinetic + ref.strain_energy(case.span, q, time) + ref.potential_energy(case.span, q)

    state = (case.q, case.v, case.time)
    growth = slope(energy, 4e-3) + ref.dissipation(case.span, *state)
    residual = ref.residual(case.span, case.q, case.v, case.a, case.time)
    work = residual @ case.v + ref.frame_power(case.span, *state)
    assert growth == pytest.approx(work, abs=1e-10 * np.abs(residual) @ np.abs(case.v))  # measured 2e-11


def test_hamilton_s_principle_row_by_row():
    # the action changes by minus the residual times the variation: no derivative of the momenta; measured 2.4e-10
    case = named("shorter than its arcs, crossed")
    span, duration, h = replace(case.span, damping=0.0), 0.02, 2.0**-20  # a power of two: steps without rounding

    def lagrangian(q, v, time):
        potential = ref.strain_energy(span, q, time) + ref.potential_energy(span, q)
        return ref.kinetic_energy(span, q, v, time) - potential

    change, work = np.zeros(8), np.zeros(8)
    for x, weight in zip(*ale.rule("gauss", 4), strict=True):
        q, v, time = moved(case, x * duration)
        bump, rate = (x * (1 - x)) ** 2, 2 * x * (1 - x) * (1 - 2 * x) / duration
        work += weight * bump * ref.residual(span, q, v, case.a, time)
        for j, step in enumerate(h * np.eye(8)):
            change[j] += weight * bump * (lagrangian(q + step, v, time) - lagrangian(q - step, v, time)) / (2 * h)
            faster, slower = (ref.kinetic_energy(span, q, v + s * step, time) for s in (1 / h, -1 / h))
            change[j] += weight * rate * (faster - slower) / 2
    assert_forces(-change, work, 1e-9)


# symmetries
def in_turned_scene(case, turn, shift):
    """The case with everything in it, gravity too, rigidly moved."""

    def frame(sheave):
        return replace(sheave, rotation=turn @ np.asarray(sheave.rotation), rate=turn @ np.asarray(sheave.rate))

    span = case.span
    gravity = turn @ np.asarray(span.gravity)
    span = replace(span, first=frame(span.first), second=frame(span.second), gravity=gravity)
    vectors = np.kron(np.eye(2), np.block([[turn, np.zeros((3, 1))], [np.zeros((1, 3)), np.eye(1)]]))
    q, v, a = (vectors @ x for x in (case.q, case.v, case.a))
    q[0:3] += shift
    q[4:7] += shift
    return replace(case, span=span, q=q, v=v, a=a), vectors


@pytest.mark.parametrize("name", ["drum to point", *studies("crossed back, axes askew", "shorter than its arcs")])
def test_a_scene_rigidly_moved_has_its_forces_turned(name):
    # measured 4e-13: the rounding of the moved input over strains of a thousandth
    case, shift = named(name), np.array([3.0, -4.0, 5.0])
    other, vectors = in_turned_scene(case, Rotation.random(rng=np.random.default_rng(5)).as_matrix(), shift)
    got = ref.residual(other.span, other.q, other.v, other.a, other.time)
    expected = vectors @ ref.residual(case.span, case.q, case.v, case.a, case.time)
    lifted = case.span.rhoA * np.asarray(other.span.gravity) @ shift  # what the rope that comes in brings per metre
    assert_forces(got, expected + lifted * np.array([0, 0, 0, 1, 0, 0, 0, -1]), 1e-10)
    powers = [ref.frame_power(c.span, c.q, c.v, c.time) for c in (case, other)]
    assert powers[1] == pytest.approx(powers[0], abs=1e-10 * np.max(np.abs(expected)))


def test_a_path_reversed_has_the_same_forces():
    case = named("crossed")

    def reversed_frame(sheave):
        return replace(sheave, radius=-sheave.radius, mark=-np.asarray(sheave.mark))

    first, second = (reversed_frame(s) for s in (case.span.second, case.span.first))
    span = replace(case.span, first=first, second=second)
    order, sign = [4, 5, 6, 7, 0, 1, 2, 3], np.array([1, 1, 1, -1] * 2)
    back = [(sign * x)[order] for x in (case.q, case.v, case.a)]
    expected = (sign * ref.residual(case.span, case.q, case.v, case.a, case.time))[order]
    assert_forces(ref.residual(span, *back, case.time), expected, 1e-13)


def test_a_scene_that_turns_as_a_whole_keeps_its_rope():
    # marks left behind by the frame they ride on would stretch the rope
    case, rate, pivot = named("open"), np.array([0.2, -0.1, 0.25]), np.array([1.0, 2.0, 3.0])
    sheaves = (replace(s, rate=rate) for s in (case.span.first, case.span.second))
    span = replace(case.span, first=next(sheaves), second=next(sheaves))
    paths = []
    for time in (0.0, 1.5):
        turn, q = Rotation.from_rotvec(time * rate), case.q.copy()
        for k in (0, 4):
            q[k : k + 3] = pivot + turn.apply(case.q[k : k + 3] - pivot)
        paths.append(ref.geometry(span, q, time).path)
    assert paths[1] == pytest.approx(paths[0], rel=1e-14)


@pytest.mark.study
def test_more_digits_change_nothing(monkeypatch):
    case = named("shorter than its arcs, crossed")
    state = (case.q, case.v, case.a, case.time)
    before = ref.residual(case.span, *state), ref.frame_power(case.span, *state[:2], case.time)
    monkeypatch.setattr(ref, "DIGITS", 70)
    monkeypatch.setattr(ref, "STEP", 1e-20)
    assert_forces(ref.residual(case.span, *state), before[0], 1e-15)
    assert ref.frame_power(case.span, *state[:2], case.time) == pytest.approx(before[1], rel=1e-15)
