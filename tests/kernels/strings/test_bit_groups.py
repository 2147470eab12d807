"""The bit on bottom: tangents are differences of residuals, powers balance, and a step's rate is solved for exactly."""

from types import SimpleNamespace

import numpy as np
import pytest
from kernels.strings import short_string as string

from drillstring.drilling.bit_group import OWN
from drillstring.drilling.bit_numbers import BIT, rate_at, speed_factor, torque_at, weight_by
from drillstring.drilling.bit_rock import BladeBit, RockBit
from drillstring.groups.friction import SLIP, STICK
from tautline.kernels import groups as over
from tautline.kernels.jit import entry

PLACES, DIRECTION, TURN = np.array([12, 13]), np.array([0.8, 0.6]), 15
LAST = 0.4
"""Time of the last accepted step, s; the state asked for is that of t = 1."""
NUMBERS = dict(
    stiffness=3.0, damping=0.0, threshold=0.2, cut=0.3, weight_exponent=1.0, speed_exponent=1.0, slow=0.1, limit=0.5,
    below=0.4, above=0.7, back=0.25, excess=0.3, decay=1.4, c=2.0, force=-0.3, way=1.0, time=LAST, drilled=0.1,
    placed=1, status=SLIP, settled=SLIP, inertia=1.0, spring=1.0,
)  # fmt: skip
UNPLACED = "before the bottom is placed"
LAWS = {
    "turning": {},
    "turning backwards": {"way": -1.0},
    "stuck and pushed backwards": {"status": STICK, "settled": STICK, "force": 9.0},
    "stuck": {"status": STICK, "settled": STICK},
    "just let go": {"settled": STICK, "level": 1},
    "with a damper": {"damping": 0.8},
    "with powers": {"weight_exponent": 1.6, "speed_exponent": 0.7},
    "with powers below one and a damper": {"weight_exponent": 0.6, "speed_exponent": 1.4, "damping": 0.5},
    "without drilling": {"cut": 0.0},
    "regularised": {"slip_speed": 0.6},
    "regularised, slow": {"slip_speed": 9.0},
    "off bottom": {"hole": 9.0},
    UNPLACED: {"placed": 0, "weight": 2.0, "torque": 0.5},
}
BLADES = {
    "blades": {},
    "stuck blades": {"status": STICK, "settled": STICK},
    "blades on pressed flats": {"limit": 9.0},
    "blades turned back": {"turned": 1.0},
    "blades turning backwards": {"turned": 1.0, "way": -1.0},
    "blades that begin to turn backwards": {"way": -1.0},
    "blades off the bottom": {"lift": 3.0},
}
CASES = [("rock", name, seed) for name in LAWS for seed in range(2)]
CASES += [("blades", name, seed) for name in BLADES for seed in range(2)]


def row(**changes):
    numbers = NUMBERS | changes
    return string.records(1, BIT, **numbers)


def rock_bit(hole=None, **changes):
    """A bit some way into its spring."""
    return RockBit(PLACES, DIRECTION, 4.2, TURN, row(hole=-1.2 if hole is None else hole, **changes), *scratch())


def scratch():
    return np.zeros(4), np.zeros((3, 4))


def blade_bit(state, turned=0.0, lift=0.0, **changes):
    """A bit whose blades have passed over a bottom that falls as a wave does."""
    depth = DIRECTION @ state.q[PLACES]
    newest = state.q[TURN] - 0.35 + turned
    angle = newest + np.linspace(-4.0, 0.0, 40)
    ring = np.column_stack([angle, depth - 0.6 + lift + 0.1 * angle - 0.1 * newest + 0.02 * np.sin(3.0 * angle)])
    ring = np.roll(ring, 7, axis=0)
    numbers = dict(cut_weight=1.3, cut_torque=0.6, blades=3.0, seat=depth - 0.3 + lift, limit=0.5) | changes
    return BladeBit(PLACES, DIRECTION, 4.2, TURN, row(**numbers), *scratch(), ring, np.array([6]))


def of(cases):
    """A parametrised ``case``."""
    return pytest.mark.parametrize("case", cases, ids=lambda case: f"{case[1]}-{case[2]}", indirect=True)


@pytest.fixture
def case(request):
    """A bit at a random state, turning clockwise unless its law says otherwise."""
    kind, name, seed = request.param
    rng = np.random.default_rng([seed, 5])
    state = string.random_state(rng)
    changes = LAWS[name] if kind == "rock" else BLADES[name]
    state.v[TURN] = abs(state.v[TURN]) * changes.get("way", 1.0)
    return (rock_bit(**changes) if kind == "rock" else blade_bit(state, **changes)), state


def close(one, other):
    return np.allclose(one, other, rtol=1e-6, atol=1e-6 * np.abs(one).max(initial=0.0) + 1e-9)


@of(CASES)
def test_each_part_of_the_tangent_is_the_difference_of_the_residual(case):
    group, state = case
    _, _, parts = string.evaluate((group,), state, t=1.0)
    for field, name in zip(state._fields, ("stiffness", "damping", "mass"), strict=True):
        # The bottom that blades have left is straight from one angle kept to the next: a short step stays on one piece.
        slope = string.derivative(
            lambda x, field=field: string.residual((group,), state._replace(**{field: x}), t=1.0),
            getattr(state, field), step=1e-4,
        )  # fmt: skip
        assert close(parts[name], slope), name


@of(CASES)
def test_weight_is_along_the_hole_and_torque_about_it(case):
    group, state = case
    r = string.residual((group,), state, t=1.0)
    other = np.setdiff1d(np.arange(r.size), [*PLACES, TURN])
    assert np.all(r[other] == 0.0)
    assert r[PLACES] == pytest.approx(DIRECTION * (r[PLACES] @ DIRECTION), abs=1e-14)
    assert r[PLACES] @ DIRECTION >= 0.0


@entry
def _commit(groups, t, h, q, v, a):
    over.commit(groups, t, h, q, v, a)


def commit(group, state, t, h=0.1):
    _commit(over.link((group,), "commit"), t, h, *state)


@entry
def _record(groups, out, at):
    over.record(groups, out, at)


def recorded(group):
    out = np.zeros(OWN)
    _record(over.link((group,), "record"), out, np.zeros(1, np.int64))
    return out


@of([case for case in CASES if case[0] == "rock" and case[1] != UNPLACED])
def test_the_hole_deepens_by_the_mean_of_the_rates_at_both_ends_of_a_step(case):
    """And the weight is that of the spring on the hole as deep as it then is: the local equation was solved."""
    group, state = case
    b = group.row[0]
    before, rate = 4.2 + b.hole, b.drilled
    commit(group, state, 1.0)
    weight, _, now, hole = recorded(group)
    assert hole == pytest.approx(before + 0.5 * (1.0 - LAST) * (rate + now), rel=1e-13)
    depth, speed = 4.2 + DIRECTION @ state.q[PLACES], DIRECTION @ state.v[PLACES]
    pressed = b.stiffness * (depth - hole) + b.damping * (speed - now)
    assert weight == pytest.approx(max(0.0, pressed), rel=1e-12, abs=1e-12)
    assert now == pytest.approx(rate_at(b, weight, state.v[TURN]), rel=1e-12, abs=1e-300)


@of([case for case in CASES if case[1] != UNPLACED])
def test_power_that_the_bit_takes_is_stored_or_lost(case):
    group, state = case
    r = string.residual((group,), state, t=1.0)
    lost, driven = string.losses((group,), state, t=1.0)
    b, rate = group.row[0], group.value[3]
    hole = b.hole

    def energy(h):
        b.hole = hole + h * rate
        return string.energy((group,), state._replace(q=state.q + h * state.v), t=1.0).sum()

    stored = string.rate(energy, 1e-4)
    if isinstance(group, BladeBit) and group.row[0].limit == NUMBERS["limit"]:
        stored = max(0.0, min(0.0, stored))  # flats that carry all they can yield
    assert r @ state.v == pytest.approx(stored + lost, rel=1e-6, abs=1e-8)
    assert driven == 0.0


def test_the_torque_of_a_bit_that_turns_is_that_of_the_law_and_none_exceeds_it_when_stuck():
    rng = np.random.default_rng(3)
    state = string.random_state(rng)
    state.v[TURN] = 0.8
    group = rock_bit()
    commit(group, state, 1.0)
    weight, torque, _, _ = recorded(group)
    assert torque == pytest.approx(torque_at(group.row[0], weight, 0.8), rel=1e-13)
    # 0.4 N m a newton up to 0.5 N, 0.7 beyond, and 0.3 exp(-0.8 / 1.4) of all
    assert torque == pytest.approx(0.2 + 0.7 * (weight - 0.5) + 0.3 * weight * np.exp(-0.8 / 1.4), rel=1e-13)


@pytest.mark.parametrize("exponents", [(1.0, 1.0), (1.7, 0.6), (0.5, 2.0)])
def test_weight_for_a_rate_is_the_inverse_of_the_rate_for_a_weight(exponents):
    b = row(weight_exponent=exponents[0], speed_exponent=exponents[1])[0]
    assert rate_at(b, weight_by(b, 0.02, speed_factor(b, 1.3)), 1.3) == pytest.approx(0.02, rel=1e-12)
    assert (
        weight_by(b, 0.02, speed_factor(b, -1.0)) == np.inf and weight_by(b, 0.0, speed_factor(b, 1.0)) == b.threshold
    )


@pytest.mark.parametrize("kind", ["rock", "blades"])
def test_the_first_commit_puts_the_bottom_where_it_carries_the_weight_at_the_start(kind):
    state = string.random_state(np.random.default_rng(4))
    state = state._replace(v=np.zeros_like(state.v))
    changes = {"placed": 0, "weight": 2.5, "status": STICK, "settled": STICK, "force": 0.0}
    group = rock_bit(**changes) if kind == "rock" else blade_bit(state, **changes)
    commit(group, state, 0.0, h=0.2)
    assert group.row[0].placed == 0, "a step before the run opens"
    commit(group, state, 0.0, h=0.0)
    assert recorded(group)[0] == pytest.approx(2.5, rel=1e-13)
    assert string.residual((group,), state)[PLACES] == pytest.approx(2.5 * DIRECTION, rel=1e-13)


def test_blades_that_drill_steadily_remember_the_bottom_and_cut_what_the_delay_left():
    """u = rate t, angle = Omega t: each blade cuts rate (2 pi / n) / Omega, the bit n times that: 2 pi rate / Omega."""
    state = string.State(*np.zeros((3, 16)))
    group = blade_bit(state, limit=0.0, seat=99.0)
    rate, spin, h = 0.03, 2.0, 0.05
    for step in range(1, 200):
        q, v = np.zeros(16), np.zeros(16)
        q[PLACES], v[PLACES] = DIRECTION * rate * step * h, DIRECTION * rate
        q[TURN], v[TURN] = spin * step * h, spin
        commit(group, string.State(q, v, np.zeros(16)), step * h, h)
        if step == 99:
            before = recorded(group)[3]
    cut = 2.0 * np.pi * rate / spin
    weight, torque, now, hole = recorded(group)
    assert (weight, torque, now) == pytest.approx((1.3 * cut, 0.6 * cut, rate), rel=1e-9)
    assert hole - before == pytest.approx(rate * 100 * h, rel=1e-12)


def test_a_bit_that_creeps_does_not_use_up_the_memory_of_its_blades():
    state = string.State(*np.zeros((3, 16)))
    group = blade_bit(state, limit=0.0, seat=99.0)
    for step in range(1, 500):
        q = np.zeros(16)
        q[TURN] = 1e-5 * step
        commit(group, string.State(q, np.zeros(16), np.zeros(16)), 0.01 * step, 0.01)
    angles = np.sort(group.ring[:, 0])
    assert angles[-1] - angles[0] > 2.0 * np.pi / 3.0


PATHS = {
    "picked up and turned": lambda x: (-2.0 * np.sin(np.pi * x), 20.0 * x),
    "picked up and not turned": lambda x: (-2.0 * np.sin(np.pi * x), 0.0),
    "picked up and turned back": lambda x: (-2.0 * np.sin(np.pi * x), -20.0 * x),
    "lowered half way and lifted again": lambda x: (-np.sin(np.pi * x) * (1.3 + np.cos(6.0 * np.pi * x)), 20.0 * x),
    "bouncing by less than it is pressed in": lambda x: (-0.3 * np.sin(9.0 * np.pi * x) ** 2, 9.0 * x),
}


def bit_at_start(weight):
    """Three blades that have drilled steadily with a weight, at depth and angle 0."""
    state = string.State(*np.zeros((3, 16)))
    group = blade_bit(state, placed=0, weight=weight, status=STICK, settled=STICK, force=0.0)
    commit(group, state, 0.0, h=0.0)
    return group


def set_to(group, t, depth, angle, spin=0.0):
    q, v = np.zeros(16), np.zeros(16)
    q[PLACES], q[TURN], v[TURN] = DIRECTION * depth, angle, spin
    commit(group, string.State(q, v, np.zeros(16)), t, 0.01)


@pytest.mark.parametrize("path", PATHS.values(), ids=list(PATHS))
@pytest.mark.parametrize("weight", [0.4, 0.5], ids=["rubbing", "flats that bear all they can"])
def test_a_bit_off_bottom_bears_nothing_and_its_flats_meet_the_rock_where_they_left_it(path, weight):
    """Flats of 0.5 N at most, on 3 N/m: they are pressed in by weight / 3, and come back to it along the same line."""
    group = bit_at_start(weight)
    unloaded, steps = -weight / 3.0, 400
    for step in range(1, steps + 1):
        depth, angle = path(step / steps)
        set_to(group, 0.01 * step, depth, angle)
        if depth < unloaded:
            assert recorded(group)[:2] == pytest.approx(0.0, abs=1e-15)
    assert recorded(group)[3] == pytest.approx(4.2, abs=1e-12), "nothing is drilled on the way"
    for share in (0.1, 0.7):
        set_to(group, 5.0, (1.0 - share) * unloaded, angle)
        assert recorded(group)[0] == pytest.approx(share * weight, rel=1e-9)


@pytest.mark.parametrize(("settled", "moves"), [(SLIP, [TURN]), (STICK, [])])
def test_a_bit_that_sticks_does_not_move_on_whatever_its_creep(settled, moves):
    q, v = np.zeros(18), np.zeros(18)
    v[TURN] = 4.6e-11
    group = blade_bit(SimpleNamespace(q=q), settled=settled, status=settled)
    q[TURN] = group.ring[group.head[0], 0]
    assert over.known_of(group).onward(group, q, v) == moves


@pytest.mark.parametrize("angle", [0.7, 5.0, 20.0])
def test_blades_that_are_lifted_off_and_set_down_meet_the_steps_that_they_left(angle):
    """Blades that drilled steadily with a cut c left a saw: an angle x behind a tooth it lies c (p - x) / 2 pi higher
    than the bit was, p the angle between blades. The flats have met the tips of the teeth, and push all the way.
    """
    cut, pitch = 1.5, 2.0 * np.pi / 3.0
    group = bit_at_start(1.3 * cut + 0.5)
    for step in range(1, 401):
        set_to(group, 0.01 * step, -1.0, angle * step / 400)
        assert recorded(group)[0] == pytest.approx(0.0, abs=1e-15) or step * angle / 400 < 1e-9
    set_to(group, 5.0, 0.0, angle)
    left = -cut * (pitch - angle % pitch) / (2.0 * np.pi)
    weight, kinetic = group.value[0], group.value[1]
    assert group.row[0].hole == pytest.approx(0.0, abs=1e-12)
    assert weight == pytest.approx(0.5 + 1.3 * 3.0 * -left, rel=1e-6)
    assert kinetic == pytest.approx(0.4 * 0.5 + 0.6 * 3.0 * -left, rel=1e-6)


def test_a_bit_that_was_turned_back_drills_on_from_where_it_is():
    """The blades are alike: turned back by a pitch each stands where another stood, and no turn has to be made up."""
    group = bit_at_start(0.5)
    group.row[0].limit = 0.0
    back, deep, spin, h = 40.0, 0.02, 2.0, 0.05
    ways = [(-2.0, -back * k / 50.0) for k in range(51)] + [(deep, spin * h * k - back) for k in range(200)]
    for step, (depth, angle) in enumerate(ways, 1):
        set_to(group, step * h, depth, angle, spin)
    # Held at one depth, three blades have cut all of it within less than three pitches.
    weight, _, rate, hole = recorded(group)
    assert (weight, rate) == pytest.approx((0.0, 0.0), abs=1e-12)
    # The rate falls from one step to the next where the blades come to what they cut first.
    assert hole == pytest.approx(4.2 + deep, abs=0.02 * deep)


def test_a_bit_with_blades_that_is_pressed_in_and_not_turned_forward_drills_nothing():
    group = bit_at_start(0.5)
    for step, (depth, angle) in enumerate([(0.3, 0.0), (0.6, -0.5), (0.9, -1.5), (0.2, -0.2), (0.9, 0.0)], 1):
        set_to(group, 0.01 * step, depth, angle, spin=3.0 if angle < 0.0 else 0.0)
        assert recorded(group)[2] == 0.0
    assert recorded(group)[3] == 4.2 and group.row[0].hole == 0.0


CUTS = {
    "bouncing": lambda t: (0.4 * t + 0.5 * np.sin(6.0 * t), 3.0 * t),
    "sticking and slipping": lambda t: (0.4 * t, 3.0 * t - np.sin(3.0 * t)),
    "turning back and on": lambda t: (0.4 * t, 3.0 * t - 1.5 * np.sin(3.0 * t)),
}


@pytest.mark.parametrize("path", CUTS.values(), ids=list(CUTS))
def test_the_hole_deepens_by_what_the_bottom_that_blades_leave_has_sunk_in_the_mean_over_a_turn(path):
    """The bottom is that between two blades: they are alike. It began as a saw, a cut of 1.5 a turn deep."""
    pitch, steps, last = 2.0 * np.pi / 3.0, 20000, 6.0
    group = bit_at_start(1.3 * 1.5 + 0.5)
    first = _mean_bottom(group, pitch)
    for t in np.linspace(0.0, last, steps + 1)[1:]:
        (depth, angle), (_, later) = path(t), path(t + 1e-7)
        set_to(group, t, depth, angle, (later - angle) / 1e-7)
    assert recorded(group)[3] - 4.2 == pytest.approx(_mean_bottom(group, pitch) - first, rel=0.01)


def _mean_bottom(group, pitch):
    ring = group.ring[np.argsort(group.ring[:, 0])]
    angle = ring[-1, 0] - np.linspace(0.0, pitch, 20001)
    return np.interp(angle, ring[:, 0], ring[:, 1]).mean()
