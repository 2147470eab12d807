"""Self-tests of the cable references: other methods, limits, tabulated values, the numbers of the thesis."""

import numpy as np
import pytest
from numpy.polynomial import Legendre, Polynomial
from scipy.integrate import solve_ivp
from scipy.linalg import eigh, expm

from references import cables


def ritz(stiffness, mass, basis):
    """Angular frequencies for quadratic forms (weight function, order of derivative) of a basis on [0, 1]."""
    x, w = np.polynomial.legendre.leggauss(60)
    x, w = (1 + x) / 2, w / 2

    def form(terms):
        total = 0
        for weight, derivative in terms:
            f = np.array([b.deriv(derivative)(x) if derivative else b(x) for b in basis])
            total = total + (f * w * weight(x)) @ f.T
        return total

    return np.sqrt(eigh(form(stiffness), form(mass), eigvals_only=True))


def constant(value):
    return lambda x: value + 0 * x


def legendre(n):
    return Legendre.basis(n, domain=[0, 1])


def wall(*roots):
    """Polynomial with the roots given, to hold the ends of a Ritz basis."""
    return Polynomial.fromroots(roots).convert(kind=Legendre, domain=[0, 1], window=[-1, 1])


# statics
SPANS = [
    (100.0, 0.0, 110.0, 1e6, 50.0),
    (100.0, 20.0, 101.0, 1e6, 50.0),
    (100.0, -30.0, 104.0, 1e5, 50.0),
    (1000.0, 300.0, 2000.0, 1e8, 200.0),
    (10.0, 0.0, 9.9, 1e6, 5.0),
    (1.0, 0.0, 20.0, 1e6, 1.0),
]


@pytest.mark.parametrize("strain", ["engineering", "green"])
@pytest.mark.parametrize(("span", "rise", "length", "EA", "weight"), SPANS)
def test_catenary_is_in_equilibrium_and_meets_its_supports(span, rise, length, EA, weight, strain):
    line = cables.catenary(span, rise, length, EA, weight, strain)

    def rates(s, _):
        pull = np.array([line.horizontal, line.vertical + weight * s])
        size = np.hypot(*pull)
        return cables.stretch_of(size, EA, strain) * pull / size

    end = solve_ivp(rates, (0, length), [0.0, 0.0], method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    assert end == pytest.approx([span, rise], abs=1e-9 * length)
    assert line.shape(length) == pytest.approx([span, rise], abs=1e-11 * length)
    assert line.end_forces.sum(axis=0) == pytest.approx([0, weight * length], rel=1e-12, abs=1e-9)


def test_inextensible_catenary_has_the_classical_parameter():
    line = cables.catenary(100.0, 0.0, 110.0, 1e13, 50.0)
    a = line.horizontal / 50.0
    assert 2 * a * np.sinh(50 / a) == pytest.approx(110.0, rel=1e-9)
    assert line.shape(55.0)[1] == pytest.approx(-a * (np.cosh(50 / a) - 1), rel=1e-9)


def test_catenary_of_a_nearly_weightless_cable_is_the_straight_cable():
    for strain in ("engineering", "green"):
        line = cables.catenary(10.0, 0.0, 9.9, 1e6, 1e-6, strain)
        assert line.horizontal == pytest.approx(cables.force_of(10 / 9.9, 1e6, strain), rel=1e-11)


def test_catenary_that_cannot_be_found_is_refused():
    with pytest.raises(ValueError, match="no catenary found"):
        cables.catenary(100.0, 0.0, 110.0, 1e6, np.nan)


@pytest.mark.parametrize("strain", ["engineering", "green"])
def test_stretch_and_force_invert_each_other(strain):
    force = np.array([-0.05, 0.0, 1e-6, 0.3, 2.0])
    assert cables.force_of(cables.stretch_of(force, 1.0, strain), 1.0, strain) == pytest.approx(force, abs=1e-15)


def test_hanging_rope_stretches_by_half_its_weight():
    depth, force = cables.hanging_rope([0.0, 50.0, 100.0], 100.0, 1e6, 50.0, 1e4)
    assert depth[-1] - 100 == pytest.approx(1e4 * 100 / 1e6 + 50.0 * 100**2 / 2e6, rel=1e-12)
    assert force[0] == 1e4 + 5000
    green, _ = cables.hanging_rope([0.0, 50.0, 100.0], 100.0, 1e6, 50.0, 1e4, "green")
    assert np.all(green[1:] < depth[1:])
    assert green == pytest.approx(depth, rel=4e-4)


@pytest.mark.parametrize(
    ("load", "sideways", "forward"),
    # Bisshopp and Drucker 1945 / Mattiasson 1981, Int. J. Numer. Meth. Eng. 17, 145-153: w/L and u/L
    [(1.0, 0.30172, 0.05643), (2.0, 0.49346, 0.16064), (5.0, 0.71379, 0.38763), (10.0, 0.81061, 0.55500)],
)
def test_elastica_has_the_tabulated_deflections(load, sideways, forward):
    tip = cables.elastica(load, 1.0, 1.0)
    assert tip.y == pytest.approx(sideways, abs=6e-6)
    assert 1 - tip.x == pytest.approx(forward, abs=6e-6)


@pytest.mark.parametrize("load", [0.01, 1.0, 10.0, 20.0])
@pytest.mark.parametrize("curvature", ["material", "geometric"])
def test_shooting_finds_the_elliptic_integrals_where_the_bar_does_not_stretch(load, curvature):
    length, EI = 2.0, 3.0
    force = load * EI / length**2
    exact = cables.elastica(force, length, EI)
    shot = cables.extensible_cantilever(force, length, 1e14, EI, curvature=curvature)
    for name in ("x", "y", "slope", "moment"):
        assert getattr(shot, name) == pytest.approx(getattr(exact, name), rel=1e-10), name


@pytest.mark.parametrize("strain", ["engineering", "green"])
@pytest.mark.parametrize("curvature", ["material", "geometric"])
def test_extensible_cantilever_is_stationary_in_its_energy(strain, curvature):
    """Ritz: theta and stretch as polynomials, energy per unstretched metre minimised by Newton's method."""
    load, EA, EI = 5.0, 200.0, 1.0
    tip = cables.extensible_cantilever(load, 1.0, EA, EI, strain, curvature)
    x, w = np.polynomial.legendre.leggauss(40)
    s, w = (1 + x) / 2, w / 2
    n = 14
    angles = np.array([(wall(0) * legendre(k))(s) for k in range(n)])
    turns = np.array([(wall(0) * legendre(k)).deriv()(s) for k in range(n)])
    stretches = np.array([legendre(k)(s) for k in range(n)])

    def gradient(unknown):
        theta, turn, stretch = unknown[:n] @ angles, unknown[:n] @ turns, 1 + unknown[n:] @ stretches
        pull = cables.force_of(stretch, EA, strain) - load * np.sin(theta)
        bend = EI * turn
        if curvature == "geometric":
            pull, bend = pull - EI * turn**2 / stretch**3, bend / stretch**2
        across = -load * stretch * np.cos(theta)
        return np.concatenate([turns @ (w * bend) + angles @ (w * across), stretches @ (w * pull)])

    unknown = np.zeros(2 * n)
    for part in np.linspace(0.1, 1, 10):  # follow the load
        for _ in range(8):
            steps = np.eye(2 * n) * 1e-30j
            scale = lambda z, p=part: gradient(z) + (1 - p) * _tip_load(z, angles, stretches, w, load)  # noqa: E731
            matrix = np.array([scale(unknown + h).imag / 1e-30 for h in steps]).T
            unknown = unknown - np.linalg.solve(matrix, scale(unknown))
    theta, stretch = unknown[:n] @ angles, 1 + unknown[n:] @ stretches
    assert w @ (stretch * np.cos(theta)) == pytest.approx(tip.x, rel=1e-7)
    assert w @ (stretch * np.sin(theta)) == pytest.approx(tip.y, rel=1e-7)


def _tip_load(unknown, angles, stretches, w, load):
    n = len(angles)
    theta, stretch = unknown[:n] @ angles, 1 + unknown[n:] @ stretches
    return np.concatenate([angles @ (w * load * stretch * np.cos(theta)), stretches @ (w * load * np.sin(theta))])


# frequencies
def test_axial_frequencies_of_one_two_and_four_elements():
    first = [cables.hermite_bar_frequencies(n, 1000.0, 1.0, 1.0)[0] for n in (1, 2, 4)]
    assert first == pytest.approx([7.906234, 7.905709, 7.905694], abs=5e-7)
    assert cables.axial_frequencies(1000.0, 1.0, 1.0, 1)[0] == pytest.approx(7.905694150, abs=1e-9)


def test_axial_frequencies_converge_from_above_with_the_sixth_power():
    exact = cables.axial_frequencies(1.0, 1.0, 1.0, 3)
    coarse, fine = (cables.hermite_bar_frequencies(n, 1.0, 1.0, 1.0)[:3] for n in (16, 32))
    assert np.all(fine > exact)
    # the third is clear of rounding
    assert np.log2((coarse[2] - exact[2]) / (fine[2] - exact[2])) == pytest.approx(6, abs=0.15)
    held = cables.hermite_bar_frequencies(16, 1.0, 1.0, 1.0, held=(0, 32))[:3]
    assert held == pytest.approx(cables.axial_frequencies(1.0, 1.0, 1.0, 3, "clamped-clamped"), rel=1e-6)


def test_hermite_bar_is_the_textbook_element():
    h, (stiffness, mass) = 0.5, cables.hermite_bar(1, 7.0, 3.0, 0.5)
    size = np.array([1, h, 1, h])
    k = np.array([[36, 3, -36, 3], [3, 4, -3, -1], [-36, -3, 36, -3], [3, -1, -3, 4]]) / (30 * h)
    m = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) * h / 420
    assert stiffness == pytest.approx(7.0 * k * np.outer(size, size), rel=1e-12)
    assert mass == pytest.approx(3.0 * m * np.outer(size, size), rel=1e-12)


def test_effective_lengths_are_those_of_table_2_1():
    lengths = cables.effective_lengths()
    assert lengths["f/f"] == pytest.approx([0.1533, 0.2582, 0.6364], abs=5e-5)
    assert lengths["p/f"] == pytest.approx([0.1914, 0.4135, 1.2732], abs=5e-5)
    assert lengths["p/p"] == pytest.approx([0.3086, 0.6325], abs=5e-5)
    assert lengths["+/-"] == pytest.approx([0.6325, 0.6362], abs=5e-5)
    assert lengths["+/+"] == pytest.approx([0.3086], abs=5e-5)


def test_effective_lengths_bound_the_highest_frequency_of_any_mesh():
    lengths = cables.effective_lengths()
    for n in (1, 2, 4, 8):
        free, pinned = (2 / cables.mesh_highest_frequency(n, ends=e) * n for e in ("pinned-free", "pinned-pinned"))
        assert free >= lengths["p/f"][0] * (1 - 1e-12)
        assert pinned == pytest.approx(lengths["p/p"][0], rel=1e-10)
    # the pinned-free length is met by one element only: with a neighbour the end is softer, in the limit by 9 %
    assert 2 / cables.mesh_highest_frequency(16) * 16 == pytest.approx(0.209460, abs=1e-6)


def test_chain_frequencies_are_those_of_a_ritz_solution():
    # potential T w'^2/2 with T = rhoA g z, z above the free end; w = 0 at z = 1
    found = ritz([(lambda z: z, 1)], [(constant(1.0), 0)], [wall(1) * legendre(k) for k in range(20)])
    chain = cables.hanging_chain_frequencies(1.0, 1.0, 4) * 2 * np.pi
    assert found[:4] == pytest.approx(chain, rel=1e-10)
    assert cables.hanging_chain_mode(3, np.array([0.0, 1.0])) == pytest.approx([1, 0], abs=1e-14)
    assert chain[0] == pytest.approx(2.404825557695773 / 2, rel=1e-14)


@pytest.mark.parametrize("tension", [1e-3, 10.0, 1000.0])
def test_frequencies_of_a_stiff_string_are_those_of_a_ritz_solution(tension):
    forms = [(constant(2.0), 2), (constant(tension), 1)], [(constant(3.0), 0)]
    for ends, roots in (("pinned", (0, 1)), ("clamped", (0, 0, 1, 1))):
        found = ritz(*forms, [wall(*roots) * legendre(k) for k in range(34)]) / (2 * np.pi)
        exact = cables.string_frequencies(tension, 2.0, 3.0, 1.0, 5, ends)
        assert found[:5] == pytest.approx(exact, rel=1e-6), ends


def test_stiff_string_has_the_limits_of_the_string_and_of_the_clamped_beam():
    beam = cables.string_frequencies(1e-9, 1.0, 1.0, 1.0, 3, "clamped") * 2 * np.pi
    assert np.sqrt(beam) == pytest.approx([4.730040745, 7.853204624, 10.995607838], abs=1e-8)
    for ends in ("pinned", "clamped"):
        string = cables.string_frequencies(4.0, 1e-12, 1.0, 1.0, 3, ends)
        assert string == pytest.approx([1, 2, 3], rel=3e-6)


# motions
def test_elastic_pendulum_keeps_its_energy_and_bounces_at_its_frequency():
    length, EA, tip, rhoA, g = 1.0, 1000.0, 1.0, 0.3, 9.81
    times = np.linspace(0, 3, 301)
    x, z = cables.elastic_pendulum(times, length, EA, tip, rhoA, g, 0.7)
    radius = np.hypot(x, z)
    assert np.ptp(radius) > 5e-3
    mass = tip + rhoA * length / 3

    def energy(t):
        step = 2e-5
        (x0, x1, x2), (z0, z1, z2) = cables.elastic_pendulum([t - step, t, t + step], length, EA, tip, rhoA, g, 0.7)
        eps = ((x1**2 + z1**2) / length**2 - 1) / 2
        speed = ((x2 - x0) ** 2 + (z2 - z0) ** 2) / (2 * step) ** 2
        return mass / 2 * speed + EA * eps**2 / 2 * length + (tip + rhoA * length / 2) * g * z1

    start = -(tip + rhoA * length / 2) * g * np.cos(0.7)
    assert [energy(t) for t in (0.7, 1.9)] == pytest.approx([start, start], abs=2e-6)
    # plumb: bounce about the static stretch with sqrt(EA/(m L))
    times = np.linspace(0, 0.2, 301)
    _, z = cables.elastic_pendulum(times, length, 1e6, tip, 0.0, g, 0.0, strain="engineering")
    static = tip * g / 1e6
    assert z == pytest.approx(-length - static * (1 - np.cos(1e3 * times)), abs=1e-9)


def test_sliding_and_overhanging_ropes_obey_newton():
    assert cables.sliding_rope(2.0, np.pi / 6, 9.81) == pytest.approx(9.81)
    t, h = 0.8, 1e-4
    x = cables.table_rope(np.array([t - h, t, t + h]), 0.2, 2.0, 9.81)
    assert (x[0] - 2 * x[1] + x[2]) / h**2 == pytest.approx(9.81 / 2.0 * x[1], rel=1e-6)


def test_hammer_is_the_matrix_exponential_of_the_semidiscrete_bar():
    blow = cables.hammer()
    stiffness, mass = (m[1:, 1:] for m in cables.hermite_bar(2, 1.0, 1.0, 1.0))
    pull = np.zeros(5)
    pull[-2] = 0.01
    system = np.zeros((11, 11))
    system[:5, 5:10] = np.eye(5)
    system[5:10, :5] = -np.linalg.solve(mass, stiffness)
    pushed = system.copy()
    pushed[5:10, 10] = np.linalg.solve(mass, pull)
    start = np.zeros(11)
    start[10] = 1.0
    hit = expm(pushed) @ start
    assert blow.response(1.0) == pytest.approx(hit[:5], abs=1e-14)
    assert blow.response([3.5, 41.0]) == pytest.approx(
        np.array([(expm(system * t) @ hit)[:5] for t in (2.5, 40.0)]), abs=1e-12
    )


def test_hammer_has_the_five_lines_of_the_thesis():
    blow = cables.hammer()
    assert blow.frequencies[0] == pytest.approx(0.25, abs=1e-3)
    assert blow.frequencies[-1] == pytest.approx(3.1, abs=0.05)
    assert blow.frequencies == pytest.approx([0.2500005, 0.7506275, 1.2636897, 1.8492731, 3.0732367], abs=1e-6)
    # amplitudes: a least squares fit of the five cosines and sines to the motion after the blow
    t = np.linspace(1, 60, 4000)
    phase = 2 * np.pi * np.outer(t, blow.frequencies)
    fit = np.linalg.lstsq(np.hstack([np.cos(phase), np.sin(phase)]), blow.tip(t), rcond=None)[0]
    assert np.hypot(fit[:5], fit[5:]) == pytest.approx(blow.lines(), rel=1e-8)


def test_green_hammer_is_the_linear_one_for_a_small_blow_and_hangs_right_in_gravity():
    times = np.array([0.4, 1.0, 1.7, 4.0])
    excess = [
        (cables.hammer_green(times, force=f) - cables.hammer(force=f).response(times)) / f**2 for f in (1e-5, 1e-4)
    ]
    assert excess[0] == pytest.approx(excess[1], abs=0.05)  # so the difference falls with the square of the blow
    assert np.abs(excess[0]).max() == pytest.approx(24, abs=0.1)
    # weight: all particles fall alike, so its rows are those of the mass matrix times that motion
    fall, swing = cables.hammer_green(times, force=0.0, gravity=1e-7), cables.hammer()
    weight = (cables.hermite_bar(2, 1.0, 1.0, 1.0)[1] @ [1.0, 0, 1, 0, 1, 0])[1:] * 1e-7
    omega = 2 * np.pi * swing.frequencies
    modal = (1 - np.cos(np.outer(times, omega))) / omega**2 * (weight @ swing.modes)
    assert fall == pytest.approx(modal @ swing.modes.T, abs=1e-12)
