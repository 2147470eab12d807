"""Bending stiffness of a rope of straight elements: its derivatives, its energy, and closed forms of elastic curves."""

import numpy as np
import pytest
from cranes.hooks import SUMS, Hooks
from scipy.linalg import eigh
from scipy.special import ellipe, ellipk

from crane.geometry.line import POINT, WHEEL
from crane.groups.arcs import new_arcs
from crane.groups.bends import new_bends, stencils
from crane.groups.span import MATERIAL, SPAN, STATION, new_spans
from tautline.kernels import groups as over
from tautline.kernels.groups import link
from tautline.kernels.jit import entry
from tautline.kernels.matrix import dense, new_matrix

FRAME = 12
STIFFNESS, DAMPING, SMOOTHING = 1.7, 0.3, 0.4


# -- ropes -------------------------------------------------------------------------------------------------------------
def chain(count, wheels=(POINT, POINT), axial=0.0, mass=0.0, load=(0.0, 0.0, 0.0), start=0):
    """Records of the spans between `count` + 1 stations, of which the first and the last may be wheels."""
    rows = np.zeros(count, SPAN).view(np.recarray)
    for n in range(count):
        a = start + STATION * n
        before, after = wheels[0] if n == 0 else POINT, wheels[1] if n == count - 1 else POINT
        rows[n] = (a, a + STATION, before, after, axial, mass, 0.0, load, 0, 0, 0, 0)
    return rows


def no_wheels():
    return np.zeros(0, WHEEL).view(np.recarray)


class Ropes(Hooks):
    """Hooks with the tangent of spans too, which may go slack."""

    def __init__(self, groups, count, start=0):
        places = start + STATION * np.arange(count - 1)[:, None] + np.arange(3 * STATION)
        super().__init__(groups, start + STATION * (count + 1), [places])
        self.linked = link(groups, *SUMS, "switching_tangent")

    def tangent(self, q, v, a, cm, cc, ck):
        matrix = new_matrix(self.system.size, self.system.bandwidth, self.system.border)
        _tangent(self.linked, q, v, a, float(cm), float(cc), float(ck), matrix, self.system.dofs)
        return dense(matrix)[np.ix_(self.order, self.order)]


@entry
def _tangent(groups, q, v, a, cm, cc, ck, matrix, dofs):
    over.smooth_tangent(groups, 0.0, q, v, a, cm, cc, ck, matrix, dofs)
    over.switching_tangent(groups, 0.0, q, v, a, cm, cc, ck, matrix, dofs)


def wheels_of(turns=0):
    """Two wheels whose axes are neither parallel nor across the rope."""
    found = np.zeros(2, WHEEL).view(np.recarray)
    for k, (radius, axis) in enumerate([(0.3, [0.1, 1.0, 0.2]), (-0.4, [-0.3, 1.0, 0.1])]):
        axis = np.array(axis) / np.linalg.norm(axis)
        mark = np.cross(axis, [1.0, 0.2, 0.1])
        found[k] = (FRAME * k, radius, axis, mark / np.linalg.norm(mark), turns)
    return found


def rope(seed, wheels=False, turns=0, damping=DAMPING, spread=0.3):
    """Hooks of kinks and arcs of a rope of four spans, with its state; frames first, if it has wheels."""
    rng = np.random.default_rng(seed)
    start = 2 * FRAME if wheels else 0
    wheels = wheels_of(turns) if wheels else no_wheels()
    spans = chain(4, (0, 1) if start else (POINT, POINT), start=start)
    q, v, a = (np.zeros(start + 5 * STATION) for _ in range(3))
    for place in range(0, start, FRAME):
        turn, _ = np.linalg.qr(np.eye(3) + 0.3 * rng.standard_normal((3, 3)))
        turn *= np.sign(np.diag(turn))
        q[place + 3 : place + 12] = turn.T.ravel()
        if turns:
            v[place + 3 : place + 12] = np.cross(rng.standard_normal(3), turn.T).ravel()
    stations = np.zeros((5, STATION))
    stations[:, 0] = [0.0, 1.5, 2.3, 3.4, 5.0]
    stations[:, MATERIAL] = [0.0, 1.6, 2.3, 3.5, 5.3]
    stations[:, :MATERIAL] += spread * rng.standard_normal((5, 3))
    q[start:] = stations.ravel()
    v[start:] = rng.standard_normal(5 * STATION)
    group = new_bends(spans, wheels, STIFFNESS, damping, SMOOTHING if damping else 0.0)
    groups = (group, new_arcs(spans, wheels, STIFFNESS)) if start else (group,)
    return Ropes(groups, 4, start), q, v, a, start


CASES = {
    "points": {}, "hardly bent": {"spread": 1e-4}, "undamped": {"damping": 0.0}, "far bent": {"spread": 0.8},
    "wheels": {"wheels": True}, "turning wheels, undamped": {"wheels": True, "turns": 1, "damping": 0.0},
}  # fmt: skip
POWERS = CASES | {"turning wheels": {"wheels": True, "turns": 1}}


@entry
def _alarm(groups, q, alarm):
    over.alarm(groups, 0.0, q, alarm)


# -- derivatives -------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("weights", [(0.0, 1.0), (1.0, 0.0), (0.7, 1.3)], ids=["stiffness", "damping", "both"])
def test_tangent_is_the_residuals_difference(case, weights):
    for seed in range(3):
        made, q, v, a, start = rope(seed, **CASES[case])
        cc, ck = weights
        found = made.tangent(q, v, a, 0.0, cc, ck)[start:, start:]
        slopes = np.zeros((q.size, q.size))
        # the residual is linear in rates
        h = 3e-4 if ck else 1.0
        for j in range(start, q.size):
            step = np.zeros(q.size)
            step[j] = min(h, 1e-5) if case == "hardly bent" and ck else h
            # central differences of the sixth order
            for k, weight in ((1, 3 / 2), (2, -3 / 5), (3, 1 / 10)):
                ends = [made.residual(q + s * k * ck * step, v + s * k * cc * step, a) for s in (1, -1)]
                slopes[:, j] += weight * (ends[0] - ends[1]) / (2.0 * k * step[j])
        expected = slopes[start:, start:]
        size = np.abs(expected).max()
        assert np.abs(found - expected).max() <= 1e-7 * size + 1e-12


@pytest.mark.parametrize("case", POWERS)
def test_power_is_what_is_stored_lost_and_put_in(case):
    for seed in range(3):
        made, q, v, a, _ = rope(seed, **POWERS[case])
        lost, given = made.powers(q, v)
        assert made.imbalance(q, v, a) < 1e-8
        assert (lost > 0.0) == ("undamped" not in case)
        assert (given != 0.0) == ("turning" in case)


def test_a_rigid_motion_stores_nothing_and_loses_nothing():
    made, q, v, a, _ = rope(1)
    bare = rope(1, damping=0.0)[0]
    spin, speed = np.array([0.7, -2.0, 1.1]), np.array([3.0, 1.0, -2.0])
    turn, _ = np.linalg.qr(np.random.default_rng(3).standard_normal((3, 3)))
    v, elsewhere, force = np.zeros_like(q), q.copy(), bare.residual(q, v, a)
    turned = force.copy()
    for at in range(0, q.size, STATION):
        v[at : at + 3] = speed + np.cross(spin, q[at : at + 3])
        elsewhere[at : at + 3] = turn @ q[at : at + 3] + speed
        turned[at : at + 3] = turn @ force[at : at + 3]
    size = np.abs(force).max()
    assert np.abs(made.residual(q, v, a) - force).max() < 1e-14 * size
    assert np.abs(bare.residual(elsewhere, v, a) - turned).max() < 1e-14 * size
    assert made.powers(q, v)[0] < 1e-28
    assert abs(force @ v) < 1e-13 * size
    assert made.energies(elsewhere, v) == pytest.approx(made.energies(q, v), rel=1e-14)


def test_a_straight_rope_feels_nothing_and_a_folded_one_stays_finite():
    made, q, v, a, _ = rope(1, spread=0.0)
    assert not made.residual(q, v, a)[np.arange(q.size) % STATION != 0].any()
    assert made.energies(q, v)[1] == 0.0
    q[2 * STATION : 3 * STATION : MATERIAL] = 0.2, 2.3
    folded = made.residual(q, v, a), made.tangent(q, v, a, 0.0, 1.0, 1.0)
    assert np.isfinite(folded[0]).all() and np.isfinite(folded[1]).all()


def test_an_arc_of_a_circle_has_the_energy_of_its_curvature():
    """Up to the eighth power of the kinks."""
    for count, turning in ((16, np.pi), (16, 2.0 * np.pi), (4, 2.0 * np.pi)):
        q = np.zeros((count + 1, STATION))
        angle = turning / count * np.arange(count + 1)
        q[:, 0], q[:, 2], q[:, MATERIAL] = np.cos(angle), np.sin(angle), angle
        made = Ropes((new_bends(chain(count), no_wheels(), STIFFNESS),), count)
        kink = turning / count
        expected = 0.5 * STIFFNESS * kink * (count - 1)
        found = made.energies(q.ravel(), np.zeros(q.size))[1]
        assert found == pytest.approx(expected, rel=3e-3 * kink**6 + 1e-12)


# -- closed forms ------------------------------------------------------------------------------------------------------
def settle(made, q, free, force, reach=0.2):
    """Positions of equilibrium under forces (n,), by Newton's method."""
    q, still = q.copy(), np.zeros(q.size)
    for _ in range(100):
        r = (made.residual(q, still, still) - force)[free]
        step = np.linalg.solve(made.tangent(q, still, still, 0.0, 0.0, 1.0)[np.ix_(free, free)], -r)
        q[free] += step * min(1.0, reach / np.abs(step).max())
        if np.abs(step).max() < 1e-11:
            return q
    raise AssertionError("no equilibrium")


def taut(count, length, tension, bending, axial, mass=0.0, load=(0.0, 0.0, 0.0)):
    """A straight rope along x between two points, stretched by its tension."""
    strain = tension / axial
    for _ in range(50):
        strain = tension / axial / (1.0 + strain) - 0.5 * strain**2
    q = np.zeros((count + 1, STATION))
    q[:, 0] = np.linspace(0.0, length, count + 1)
    q[:, MATERIAL] = q[:, 0] / (1.0 + strain)
    spans = chain(count, axial=axial, mass=mass, load=load)
    groups = new_spans(spans, no_wheels()), new_bends(spans, no_wheels(), bending)
    free = (STATION * np.arange(1, count)[:, None] + np.arange(3)).ravel()
    return Ropes(groups, count), q.ravel(), free


def orders(errors):
    return np.log2(np.abs(errors[:-1]) / np.abs(errors[1:]))


@pytest.mark.parametrize("bending", [0.01, 0.3, 10.0])
def test_a_taut_rope_with_bending_stiffness_has_the_frequencies_of_pinned_ends(bending):
    length, tension, mass, axial = 2.0, 50.0, 0.7, 1e7
    number = np.arange(1, 4)
    wave = number * np.pi / length
    exact = wave * np.sqrt(tension / mass * (1.0 + wave**2 * bending / tension)) / (2.0 * np.pi)
    errors = []
    for count in (8, 16, 32):
        made, q, free = taut(count, length, tension, bending, axial, mass)
        still, across = np.zeros(q.size), free[free % STATION == 1]
        stiff = made.tangent(q, still, still, 0.0, 0.0, 1.0)[np.ix_(across, across)]
        square = eigh(stiff, made.mass(q)[np.ix_(across, across)], eigvals_only=True)
        errors.append(np.sqrt(square[:3]) / (2.0 * np.pi) / exact - 1.0)
    errors = np.array(errors)
    # the error of the string alone; that of bending is of the fourth order
    assert (np.abs(errors) < 1.02 * np.pi**2 / 24.0 * (number / np.array([[8], [16], [32]])) ** 2 + 1e-5).all()
    assert (orders(errors) > 1.8).all()


@pytest.mark.parametrize("layer", [0.03, 0.2])
def test_a_taut_rope_under_its_weight_sags_less_by_what_its_stiffness_carries(layer):
    """T w'' - EJ w'''' = -q between pinned ends; sqrt(EJ/T) = layer L."""
    length, tension, axial, weight = 2.0, 50.0, 1e7, 1e-3
    bending = tension * (layer * length) ** 2
    carried = bending / tension * (1.0 - 1.0 / np.cosh(0.5 / layer))
    exact = weight / tension * (length**2 / 8.0 - carried)
    errors = []
    for count in (8, 16, 32):
        made, q, free = taut(count, length, tension, bending, axial, load=(0.0, 0.0, -weight))
        found = settle(made, q, free, np.zeros(q.size)).reshape(-1, STATION)
        errors.append(-found[count // 2, 2] / exact - 1.0)
    # 2e-5 is what the rope is stretched by its sag
    assert (np.abs(errors) < 2.9e-3 * np.array([1.0, 1.0 / 4.0, 1.0 / 16.0]) + 2e-5).all()


@pytest.mark.parametrize("degrees", [30, 60, 90])
def test_a_strut_buckles_into_the_elastica(degrees):
    """Between two points that a force F = (2 K(k) / L)^2 EJ pushes together, k = sin of half the slope at the ends.

    Its span is then (2 E / K - 1) L, its height k / K L.
    """
    k = np.sin(np.radians(degrees) / 2.0)
    complete, second = ellipk(k * k), ellipe(k * k)
    bending, axial = 2.0, 1e7
    errors = []
    for count in (8, 16, 32):
        spans = chain(count, axial=axial)
        made = Ropes((new_spans(spans, no_wheels()), new_bends(spans, no_wheels(), bending)), count)
        middle = (np.arange(count) + 0.5) / count
        slope = np.radians(degrees) * np.cos(np.pi * middle)
        q = np.zeros((count + 1, STATION))
        q[1:, 0], q[1:, 2] = np.cumsum(np.cos(slope)) / count, np.cumsum(np.sin(slope)) / count
        q[:, MATERIAL] = np.arange(count + 1) / count
        q[-1, 2] = 0.0
        q, force = q.ravel(), np.zeros(q.size)
        force[STATION * count] = -bending * (2.0 * complete) ** 2
        free = np.array([STATION * n + c for n in range(1, count) for c in (0, 2)] + [STATION * count])
        found = settle(made, q, free, force, 0.02).reshape(-1, STATION)
        errors.append([found[-1, 0] - (2.0 * second / complete - 1.0), found[count // 2, 2] - k / complete])
    errors = np.array(errors)
    assert (np.abs(errors[2]) < 2e-3).all()
    assert (orders(errors) > 1.9).all()


@pytest.mark.parametrize(
    ("bending", "count", "bound"),
    [(0.4, 2, 1e-4), (0.4, 8, 1e-3), (10.0, 2, 2e-3), (10.0, 8, 0.02), (40.0, 2, 0.01), (40.0, 32, 0.15)],
)
def test_stiff_rope_runs_beside_the_line_that_touches_its_wheel(bending, count, bound):
    """Far from the wheel it is EJ / (2 T R) off, to the accuracy with which h is greater than sqrt(EJ/T)."""
    radius, length, tension, axial = 0.5, 3.0, 1e3, 1e8
    wheels = np.zeros(1, WHEEL).view(np.recarray)
    wheels[0] = (0, radius, (0.0, 1.0, 0.0), (-np.sin(0.7), 0.0, np.cos(0.7)), 0)
    spans = chain(count, (0, POINT), axial=axial, start=FRAME)
    groups = new_spans(spans, wheels), new_bends(spans, wheels, bending), new_arcs(spans, wheels, bending)
    made = Ropes(groups, count, FRAME)
    q = np.zeros((count + 1, STATION))
    q[:, 0] = np.linspace(0.0, length, count + 1)
    q[1:, 2] = radius
    q[:, MATERIAL] = q[:, 0] / (1.0 + tension / axial)
    q[1:, MATERIAL] += 0.7 * radius
    q, force = np.concatenate((np.zeros(FRAME), q.ravel())), np.zeros(FRAME + q.size)
    q[[3, 7, 11]] = 1.0
    force[FRAME + STATION * count] = tension
    free = np.array([FRAME + STATION * n + c for n in range(1, count + 1) for c in (0, 2)])
    found = settle(made, q, free, force, 0.02)
    off = found[FRAME + STATION * count + 2] - radius
    assert off == pytest.approx(bending / (2.0 * tension * radius), rel=bound)


# -- what is refused ---------------------------------------------------------------------------------------------------
def test_a_kink_without_free_rope_raises_the_alarm():
    group = new_bends(chain(2), no_wheels(), STIFFNESS)
    linked, alarm = link((group,), "alarm"), np.zeros(2, np.int64)
    q = np.zeros(3 * STATION)
    q[::STATION] = 0.0, 1.0, 2.0
    q[MATERIAL::STATION] = 0.0, 1.0, 2.0
    _alarm(linked, q, alarm)
    assert not alarm.any()
    q[MATERIAL::STATION] = 0.0, 1.0, -0.1
    _alarm(linked, q, alarm)
    assert alarm.tolist() == [over.EMPTY, STATION]


def test_what_cannot_be_bent_is_refused():
    with pytest.raises(ValueError, match="smoothing"):
        new_bends(chain(2), no_wheels(), STIFFNESS, DAMPING)
    spans = chain(2)
    spans[1].b += 1
    with pytest.raises(ValueError, match="equally far"):
        new_bends(spans, no_wheels(), STIFFNESS)


def test_kinks_are_where_no_wheel_is_and_say_what_they_couple():
    wheels = wheels_of()
    spans = chain(4, (0, 1), start=24)
    spans[1].wheel2 = spans[2].wheel1 = 0
    group = new_bends(spans, wheels, STIFFNESS)
    assert [tuple(row)[:2] for row in group.rows] == [(0, 1), (2, 3)]
    assert stencils(group).tolist() == [list(range(24, 36)), list(range(32, 44))]
    arcs = new_arcs(spans, wheels, STIFFNESS)
    assert [tuple(row)[:4] for row in arcs.rows] == [
        (0, 0, STIFFNESS, 1), (1, 1, STIFFNESS, 0), (2, 0, STIFFNESS, 0), (3, 1, STIFFNESS, 1)
    ]  # fmt: skip
