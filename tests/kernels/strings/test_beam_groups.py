"""A beam in the hole: twist, welds, mud, eccentricity and the wall: tangents are differences, powers balance."""

import numpy as np
import pytest
from kernels.strings import short_string as string
from kernels.strings.short_string import WELLS, State, check_tangent
from test_contact_groups import LAWS

from drillstring.groups.beam_contact import BeamContact
from drillstring.groups.beam_eccentricity import OFF_AXIS, BeamEccentricity
from drillstring.groups.beam_mud import SLEEVE, BeamMud
from drillstring.groups.beam_points import NODE, TURN, hole_of, nodes_as_points, points_of
from drillstring.groups.contact import PAD
from drillstring.results.beam_observe import nearest
from drillstring.string.lumps import Tube, cut
from drillstring.well.in_hole import hold_points, spot, write_frame
from tautline.elements.beam.twist import TWISTED, Twist
from tautline.elements.beam.weld import Welds
from tautline.kernels.jit import entry
from tautline.system.records import records

LENGTH, COUNT = 4.5, 3
"""One element of a beam, m: its points are three, one of them its lower node."""
MESH = cut([Tube("pipe", LENGTH, 0.1, 0.05, 0.1, 1.0, 1.0, 1.0, 1.0, 1.0)], 1)
POINTS = points_of(MESH)


@entry
def _hold(hole, q):
    hold_points(hole, q)


@entry
def _spot(hole, i, q, out, m1, m2):
    s = spot(hole, i, q)
    out[:] = s
    write_frame(hole, i, q, m1, m2)


def random_state(rng, well, offset=0.25):
    """A beam near the axis of a well, off it by about ``offset``, turned anyhow, moving at about 1 m/s and 1 rad/s."""
    q = np.zeros((2, NODE))
    place = np.array([0.2, LENGTH])
    q[:, :3] = well.position(place) + offset * rng.standard_normal((2, 3))
    q[:, 3:6] = well.frame(place)[2] + 0.1 * rng.standard_normal((2, 3))
    q[:, 6] = 0.0, LENGTH
    q[:, TURN] = rng.uniform(-3.0, 3.0, 2)
    v, a = rng.standard_normal((2, 2, NODE))
    v[:, 6] = a[:, 6] = 0.0
    return State(q.ravel(), v.ravel(), a.ravel())


def held(well, state, points=POINTS):
    hole = hole_of(well, points)
    _hold(hole, state.q)
    return hole


def twist(well, state, rng):
    names = [name for name in TWISTED.names if name not in "ab"]
    columns = {name: rng.uniform(0.3, 1.5, 1) for name in names}
    return Twist(records(1, TWISTED, a=[TURN], b=[NODE + TURN], **columns))


def welds(well, state, rng):
    return Welds(np.array([3]), np.array([NODE + 3]), np.array([1.7]))


def mud(well, state, rng):
    columns = {name: rng.uniform(0.3, 1.5, COUNT) for name in SLEEVE.names}
    return BeamMud(held(well, state), records(COUNT, SLEEVE, **columns), np.zeros((3, 3)))


def eccentricity(well, state, rng):
    columns = {name: rng.uniform(0.3, 1.5, 1) for name in ("mass", "weight", "e1", "e2")}
    hole = held(well, state, nodes_as_points(MESH, np.array([1])))
    group = BeamEccentricity(hole, records(1, OFF_AXIS, **columns))
    _spot(hole, 0, state.q, np.zeros(13), group.rows.m1[0], group.rows.m2[0])
    return group


KINDS = {"twist": twist, "welds": welds, "mud": mud, "eccentricity": eccentricity}
SEEDS = range(3)


@pytest.fixture(params=[(kind, well, seed) for kind in KINDS for well in WELLS for seed in SEEDS], ids=str)
def case(request):
    """A group of one kind at a random state in one of the wells."""
    kind, well, seed = request.param
    rng = np.random.default_rng([seed, list(WELLS).index(well), list(KINDS).index(kind)])
    state = random_state(rng, WELLS[well])
    return (KINDS[kind](WELLS[well], state, rng),), state


def test_each_part_of_the_tangent_is_the_difference_of_the_residual(case):
    parts = check_tangent(*case)
    assert np.allclose(parts["hook"], parts["mass"], rtol=1e-14, atol=1e-14)


def test_power_of_the_residual_is_the_energys_rate_and_what_is_lost(case):
    groups, state = case
    power = string.rate(
        lambda h: string.energy(groups, state._replace(q=state.q + h * state.v, v=state.v + h * state.a)).sum()
    )
    lost, driven = string.losses(groups, state)
    assert string.residual(groups, state) @ state.v == pytest.approx(power + lost, rel=1e-7, abs=1e-8)
    assert lost >= 0.0 == driven


def wall(well, state, law, rng):
    """The wall around a beam; two tries in three touch somewhere and are clear elsewhere."""
    springs = records(COUNT, PAD, clearance=0.15, radius=0.08, viscous=0.2)
    springs["stiffness"], springs["damping"] = rng.uniform(1, 3, COUNT), rng.uniform(0.1, 0.3, COUNT)
    return BeamContact(held(well, state), law, springs, np.zeros((2, 4, 4)))


def touching(rng, well, law):
    while True:
        state = random_state(rng, well, 0.2)
        group = wall(well, state, law, rng)
        offset, rate = _offsets(group.hole, state)
        normal = group.springs.stiffness * (offset - 0.15) + group.springs.damping * rate
        # Small steps of a derivative must not cross the start of contact, at rest or moving.
        clear = np.abs(normal).min() > 0.05 and np.abs(offset - 0.15).min() > 0.02 and offset.min() > 0.08
        if clear and 0 < np.count_nonzero(normal > 0.0) < COUNT:
            return group, state


def _offsets(hole, state):
    out, spare = np.zeros(13), np.zeros(3)
    offset, rate = np.zeros(COUNT), np.zeros(COUNT)
    for i in range(COUNT):
        _spot(hole, i, state.q, out, spare, spare.copy())
        p = hole.points[i]
        velocity = sum(p.weight[k] * state.v[p.place[k] : p.place[k] + 3] for k in range(p.vectors))
        offset[i], rate[i] = out[9], out[3:6] @ velocity
    return offset, rate


@pytest.mark.parametrize("well", WELLS)
@pytest.mark.parametrize("law", LAWS)
def test_the_walls_tangent_is_the_difference_of_its_residual_under_every_law(law, well):
    rng = np.random.default_rng([list(LAWS).index(law), list(WELLS).index(well)])
    group, state = touching(rng, WELLS[well], LAWS[law](rng))
    check_tangent((group,), state)


@pytest.mark.parametrize("well", WELLS)
def test_the_walls_power_is_its_energys_rate_and_what_is_lost(well):
    rng = np.random.default_rng([7, list(WELLS).index(well)])
    group, state = touching(rng, WELLS[well], LAWS["Karnopp, slipping"](rng))
    power = string.rate(lambda h: string.energy((group,), state._replace(q=state.q + h * state.v)).sum())
    lost, _ = string.losses((group,), state)
    assert string.residual((group,), state) @ state.v == pytest.approx(power + lost, rel=1e-7)


@pytest.mark.parametrize("well", WELLS)
def test_a_point_is_where_the_well_says_that_it_is(well):
    rng = np.random.default_rng(list(WELLS).index(well))
    state = random_state(rng, WELLS[well])
    hole = held(WELLS[well], state)
    node = state.q[NODE : NODE + 3]
    s, u, v = nearest(WELLS[well], node, np.array(LENGTH))
    assert np.allclose(WELLS[well].point(s, u, v), node, atol=1e-12)
    m1, m2, t = WELLS[well].frame(s)
    out, own1, own2 = np.zeros(13), np.zeros(3), np.zeros(3)
    _spot(hole, COUNT - 1, state.q, out, own1, own2)
    e = (u * m1 + v * m2) / np.hypot(u, v)
    expected = np.concatenate([t, e, np.cross(t, e), [np.hypot(u, v)]])
    assert np.allclose(out[:10], expected, atol=1e-9)
    assert np.allclose([own1, own2], [m1, m2], atol=1e-12)
    k1, k2 = WELLS[well].curvature(s)
    assert out[12] == pytest.approx(1.0 - k1 * u - k2 * v, abs=1e-12)
    assert out[10] == pytest.approx((k1 * u + k2 * v) / np.hypot(u, v), abs=1e-9)
