"""Wall contact under every law of friction in every status, drag, the top drive, loads."""

import numpy as np
import pytest
from kernels.strings import short_string as string
from kernels.strings.short_string import PER_BODY, WELLS

from drillstring.drilling.top_drive import TopDrive
from drillstring.groups.contact import SPRING, WallContact
from drillstring.groups.drag import Drag
from drillstring.groups.friction import BANDED, FORCED, PROJECTED, SLIP, STICK, Karnopp, Projection, Regularised
from tautline.elements.nodal.load import Loads
from tautline.kernels import changes
from tautline.kernels import groups as over
from tautline.kernels.jit import entry
from tautline.kernels.lanes import LANES
from tautline.scene.functions import Ramp
from tautline.system.records import records
from tautline.system.time_functions import FunctionRequest, compile_functions

CLEARANCE, RADIUS = 0.15, 0.08
TOUCHING, COUNT = np.array([1, 2, 3]), 3


def projection(rng, status):
    rows = records(COUNT, PROJECTED, static=0.5, kinetic=0.35, c=rng.uniform(2, 5, COUNT), factor=0.4)
    rows["status"] = rows["settled"] = status
    rows["force_a"], rows["force_c"] = 0.05 * rng.standard_normal((2, COUNT))
    return Projection(rows)


def karnopp(rng, held):
    rows = records(COUNT, BANDED, static=0.5, kinetic=0.35, mass_a=1.0, mass_c=1.0)
    rows["held"] = held
    rows["force_a"], rows["force_c"] = 0.05 * rng.standard_normal((2, COUNT))
    return Karnopp(rows, 1e-3)


def regularised(static, kinetic, slip_velocity):
    """The same factors at every contact."""
    return Regularised(np.full(COUNT, static), np.full(COUNT, kinetic), slip_velocity, 2.0)


LAWS = {
    "projection, slip": lambda rng: projection(rng, SLIP),
    "projection, stick": lambda rng: projection(rng, STICK),
    "projection, forced stick": lambda rng: projection(rng, FORCED),
    "Karnopp, slipping": lambda rng: karnopp(rng, 0),
    "Karnopp, held": lambda rng: karnopp(rng, 1),
    "regularised, slipping": lambda rng: regularised(0.5, 0.35, 0.01),
    "regularised, creeping": lambda rng: regularised(0.5, 0.35, 50.0),
    "frictionless": lambda rng: regularised(0.0, 0.0, 0.01),
}
FACTORS = {
    "projection, slip": lambda speed: 0.4,
    "Karnopp, slipping": lambda speed: 0.35,
    "regularised, slipping": lambda speed: 0.35 + 0.15 * np.exp(-(speed - 0.01) / 2.0),
    "regularised, creeping": lambda speed: 0.5 * speed / 50.0,
    "frictionless": lambda speed: 0.0,
}
"""Factor of friction while slipping at a speed, by docs/lumped_string.md."""
SLIPPING = list(FACTORS)


def wall(seats, law, rng, viscous=0.2):
    springs = records(COUNT, SPRING, body=TOUCHING, clearance=CLEARANCE, radius=RADIUS, viscous=viscous)
    springs["stiffness"], springs["damping"] = rng.uniform(1, 3, COUNT), rng.uniform(0.1, 0.3, COUNT)
    return WallContact(seats, law, springs, np.zeros((2, 4, 4)))


def offsets(state):
    q, v = state.q.reshape(-1, PER_BODY)[1:], state.v.reshape(-1, PER_BODY)[1:]
    offset = np.hypot(q[:, 1], q[:, 2])
    return offset, (q[:, 1] * v[:, 1] + q[:, 2] * v[:, 2]) / offset


def touching_state(rng, well, law):
    """A random state with a lump that touches, one that does not, all well away from where the normal force begins."""
    while True:
        state = string.random_state(rng)
        group = wall(string.curve(WELLS[well], state), law, rng)
        offset, rate = offsets(state)
        normal = group.springs.stiffness * (offset - CLEARANCE) + group.springs.damping * rate
        # Small steps of a derivative must not cross the start of contact, at rest or moving.
        clear = np.abs(normal).min() > 0.05 and np.abs(offset - CLEARANCE).min() > 0.02 and offset.min() > 0.08
        if clear and 0 < np.count_nonzero(normal > 0.0) < COUNT:
            return group, state


CASES = [(law, well, seed) for law in LAWS for well in ("vertical", "spatial") for seed in (1, 2)]


@pytest.fixture(params=CASES, ids=str)
def contact(request):
    law, well, seed = request.param
    rng = np.random.default_rng([seed, list(LAWS).index(law), list(WELLS).index(well)])
    return (law, *touching_state(rng, well, LAWS[law](rng)))


def close(one, other):
    return np.allclose(one, other, rtol=1e-6, atol=1e-6 * max(1.0, np.abs(one).max()))


def test_the_contacts_tangent_is_the_difference_of_its_residual(contact):
    _, group, state = contact
    parts = string.evaluate((group,), state)[2]
    for field, name in (("q", "stiffness"), ("v", "damping"), ("a", "mass")):
        slope = string.derivative(
            lambda x, field=field: string.residual((group,), state._replace(**{field: x})), getattr(state, field), 5e-4
        )
        assert close(parts[name], slope), name


def test_a_contact_at_rest_is_a_spring_with_an_energy(contact):
    law, group, state = contact
    if "held" in law or "stick" in law or "projection" in law:
        group.law.rows["force_a"] = group.law.rows["force_c"] = 0.0
    still = state._replace(v=np.zeros_like(state.v))
    gradient = string.derivative(lambda q: string.energy((group,), still._replace(q=q))[1], still.q, 5e-4)
    assert close(string.residual((group,), still), gradient)


def test_power_of_a_contact_is_its_springs_rate_and_what_is_lost(contact):
    law, group, state = contact
    if "projection" in law:
        group.law.rows["force_a"] = group.law.rows["force_c"] = 0.0
    power = string.residual((group,), state) @ state.v
    stored = string.rate(lambda h: string.energy((group,), state._replace(q=state.q + h * state.v))[1], 5e-4)
    lost, driven = string.losses((group,), state)
    assert power == pytest.approx(stored + lost, rel=1e-6, abs=1e-9)
    assert driven == 0.0
    if law in SLIPPING:
        assert lost >= 0.0


@entry
def _begin(groups, h, q, v, a):
    over.begin(groups, 0.0, h, 4.0 / h**2, 2.0 / h, q, v, a)


@entry
def _switch(groups, q, v, converged, changed):
    over.switch(groups, 0.0, q, v, converged, changed)


class Attempt:
    """A step under way, at a state where contacts that stuck slide far too fast to be held."""

    def __init__(self, status):
        law = projection(np.random.default_rng(3), status)
        # The linked list refers to the group's arrays: they must live on.
        self.group, self.state = touching_state(np.random.default_rng(3), "spatial", law)
        self.rows = law.rows
        self.rows["mass"], self.rows["links"] = 1.0, 1.0
        offset, rate = offsets(self.state)
        springs = self.group.springs
        clear = springs.stiffness * (offset - CLEARANCE) + springs.damping * rate <= 0.0
        self.rows["settled"][clear] = SLIP
        self.linked = over.link((self.group,), "begin", "switch")
        _begin(self.linked, 1e-3, *self.state)

    def switch(self, converged=False):
        """How many contacts change their status."""
        changed = changes.new_changed()
        _switch(self.linked, self.state.q, self.state.v, converged, changed)
        return changed[changes.COUNT]


def test_in_a_window_only_its_contacts_act_and_change_and_it_is_known_where(contact):
    _, group, state = contact
    r, _, parts = string.evaluate((group,), state)
    for body in range(string.BODIES):
        first, last = PER_BODY * body + 1, PER_BODY * (body + 1)
        group.curve.window[:] = first, last
        inside, _, narrow = string.evaluate((group,), state)
        assert np.array_equal(inside[first:last], r[first:last])
        assert np.array_equal(narrow["mixed"][:, first:last], parts["mixed"][:, first:last])
        # Contacts go by fours, from the second body on: those before it among its four may add what is not asked for.
        begin = PER_BODY * min(body, 1 + max(0, body - 1) // LANES * LANES)
        assert not np.any(inside[:begin]) and not np.any(inside[last:])


@pytest.mark.parametrize("body", range(string.BODIES))
def test_what_changes_in_a_window_is_told_with_its_place(body):
    whole, part = Attempt(STICK), Attempt(STICK)
    whole.switch(), part.switch()
    assert whole.switch() > 0
    part.group.curve.window[:] = PER_BODY * body, PER_BODY * (body + 1)
    changed = changes.new_changed()
    _switch(part.linked, part.state.q, part.state.v, False, changed)
    # the contacts are those of the bodies below the first
    here = whole.rows["status"][body - 1] != STICK and whole.rows["settled"][body - 1] == STICK if body > 0 else False
    assert changed[changes.COUNT] == changed[changes.PLACED] == here
    if here:
        assert changed[changes.FIRST] == PER_BODY * body and changed[changes.PAST] == PER_BODY * (body + 1)


def test_a_contact_that_sticks_is_not_let_go_by_what_is_predicted_for_a_step():
    attempt = Attempt(STICK)
    assert attempt.switch() == 0
    assert attempt.switch() > 0
    assert not np.any(attempt.rows["status"] == STICK)


def test_a_contact_that_sticks_is_tested_where_the_prediction_is_the_solution():
    attempt = Attempt(STICK)
    assert attempt.switch() == 0
    assert attempt.switch(converged=True) > 0


def test_a_contact_that_is_predicted_to_slip_back_is_stuck_at_once():
    attempt = Attempt(SLIP)
    attempt.state.v[:] *= -1.0
    attempt.rows["force_a"] = attempt.rows["force_c"] = 0.0
    assert attempt.switch() > 0
    assert np.any(attempt.rows["status"] == FORCED)


@pytest.mark.parametrize("law", SLIPPING)
def test_slipping_friction_opposes_the_slip_and_is_the_factor_times_the_normal_force(law):
    rng = np.random.default_rng(3)
    rule = LAWS[law](rng)
    group, state = touching_state(rng, "spatial", rule)
    if "projection" in law:
        rule.rows["force_a"] = rule.rows["force_c"] = 0.0
    string.losses((group,), state)
    q, v = state.q.reshape(-1, PER_BODY), state.v.reshape(-1, PER_BODY)
    seats = group.curve.seats
    for p in group.springs:
        if p.normal == 0.0:
            continue
        i = p.body
        (_, x, y, _), (vs, vx, vy, spin) = q[i], v[i]
        rho = np.hypot(x, y)
        beta = 1.0 - (seats.k1[i] * x + seats.k2[i] * y) / rho * (rho + RADIUS)
        slip = np.array([beta * vs, (x * vy - y * vx) / rho + RADIUS * spin])
        force = rule_force(group, state, p)
        speed = np.linalg.norm(slip)
        assert force == pytest.approx(-FACTORS[law](speed) * p.normal * slip / speed, rel=1e-12, abs=1e-14)


def rule_force(group, state, p):
    """Friction along and around on one lump, read off the residual: (r_x / -beta, from r_theta)."""
    r = string.residual((group,), state).reshape(-1, PER_BODY)[p.body]
    q = state.q.reshape(-1, PER_BODY)[p.body]
    seats = group.curve.seats
    rho = np.hypot(q[1], q[2])
    beta = 1.0 - (seats.k1[p.body] * q[1] + seats.k2[p.body] * q[2]) / rho * (rho + RADIUS)
    around = (p.viscous * state.v[PER_BODY * p.body + 3] - r[3]) / RADIUS
    return np.array([-r[0] / beta, around])


@pytest.mark.parametrize("law", LAWS)
def test_a_lump_clear_of_the_wall_or_on_the_axis_feels_nothing(law):
    rng = np.random.default_rng(4)
    state = string.random_state(rng, offset=0.0)
    state.q[5] = 0.05
    group = wall(string.curve(WELLS["spatial"], state), LAWS[law](rng), rng)
    state.v[4:7] *= 0.01
    r, e, parts = string.evaluate((group,), state)
    assert not np.any(r) and not np.any(e) and not np.any(parts["mixed"])


def test_the_normal_force_has_no_jump_where_contact_begins():
    """N = max(0, k pen + d pen'): no gate on the penetration (docs/lumped_string.md)."""
    rng = np.random.default_rng(5)
    state = string.random_state(rng, offset=0.0)
    group = wall(string.curve(WELLS["vertical"], state), LAWS["frictionless"](rng), rng, viscous=0.0)
    state.v[5] = 0.5
    state.v[6] = 0.0
    p = group.springs[0]
    for depth in np.linspace(-0.12, 0.05, 35):
        state.q[5] = CLEARANCE + depth
        expected = max(0.0, p.stiffness * depth + p.damping * 0.5)
        assert string.residual((group,), state)[5] == pytest.approx(expected, abs=1e-14)


def test_turning_hole_and_lump_about_the_axis_turns_the_contact_force():
    rng = np.random.default_rng(6)
    group, state = touching_state(rng, "vertical", LAWS["regularised, slipping"](rng))
    c, s = np.cos(1.1), np.sin(1.1)
    turn = np.kron(np.eye(string.BODIES), np.block([
        [np.eye(1), np.zeros((1, 3))], [np.zeros((2, 1)), np.array([[c, -s], [s, c]]), np.zeros((2, 1))],
        [np.zeros((1, 3)), np.eye(1)],
    ]))  # fmt: skip
    turned = string.State(turn @ state.q, turn @ state.v, turn @ state.a)
    r = string.residual((group,), state)
    assert np.allclose(string.residual((group,), turned), turn @ r, rtol=0, atol=1e-14)


def test_drags_tangent_is_the_difference_of_its_residual_and_it_only_loses():
    rng = np.random.default_rng(7)
    state = string.random_state(rng)
    groups = (Drag(string.curve(string.WELLS["vertical"], state), rng.uniform(0.5, 2.0, string.BODIES)),)
    r, _, parts = string.evaluate(groups, state)
    slope = string.derivative(lambda v: string.residual(groups, state._replace(v=v)), state.v)
    assert close(parts["damping"], slope)
    assert not np.any(parts["stiffness"]) and not np.any(parts["mass"])
    assert string.losses(groups, state)[0] == pytest.approx(r @ state.v) and r @ state.v > 0.0
    still = state._replace(v=np.zeros_like(state.v))
    r, _, parts = string.evaluate(groups, still)
    assert not np.any(r) and np.all(np.isfinite(parts["mixed"]))


@pytest.mark.parametrize("limit", [np.inf, 0.05])
def test_the_top_drives_tangent_is_the_difference_of_its_residual_within_its_limit_and_at_it(limit):
    rng = np.random.default_rng(8)
    state = string.random_state(rng)
    speed = compile_functions([FunctionRequest(Ramp(to=3.0, over=2.0), integrate=True)])
    groups = (TopDrive(speed, 0, 3, 1.7, 0.8, 0.4, limit, -1, np.zeros(1), np.zeros(2)),)
    r, e, parts = string.evaluate(groups, state, t=1.1)
    for field, name in (("q", "stiffness"), ("v", "damping"), ("a", "mass")):
        slope = string.derivative(
            lambda x, field=field: string.residual(groups, state._replace(**{field: x}), 1.1), getattr(state, field)
        )
        assert close(parts[name], slope), name
    assert np.array_equal(parts["hook"], parts["mass"])
    lost, driven = string.losses(groups, state, t=1.1)
    assert e[0] == 0.5 * 1.7 * state.v[3] ** 2 and lost == 0.0
    assert r[3] == pytest.approx(1.7 * state.a[3] - driven / state.v[3])
    assert abs(driven / state.v[3]) <= limit


def test_a_load_is_the_gradient_of_its_potential():
    rng = np.random.default_rng(9)
    state = string.random_state(rng)
    groups = (Loads(np.array([2, 7, 8]), np.array([1.5, -0.7, 0.2])),)
    r, _, parts = string.evaluate(groups, state)
    gradient = string.derivative(lambda q: string.energy(groups, state._replace(q=q))[2], state.q)
    assert close(r, gradient) and r[[2, 7, 8]] == pytest.approx([-1.5, 0.7, -0.2])
    assert not any(np.any(x) for x in parts.values())
