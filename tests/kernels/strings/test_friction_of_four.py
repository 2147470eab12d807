"""The laws of friction of four contacts at a time against those of one contact alone, through a step."""

import numpy as np
import pytest

from drillstring.groups import friction as alone
from drillstring.groups import friction_of_four as together
from drillstring.groups.friction import BANDED, PROJECTED, SLIP, STICK, Karnopp, Projection, Regularised
from drillstring.groups.friction_of_four import Slip
from drillstring.groups.sliding import SLIDING, Sliding
from tautline.kernels.jit import entry
from tautline.kernels.lanes import LANES, any_of, gather, lane, scatter, where
from tautline.system.records import records

COUNT, STEPS = 11, 4
H, BETA, GAMMA = 0.01, 2.0e4, 150.0
SEEDS = range(40)


@entry
def _alone(law, slips, rates, forces, statuses):
    """Start, two iterations and a converged state; then the step is accepted. Force of each, and what has changed."""
    for i in range(slips.shape[2]):
        start = Slip(slips[0, 0, i], slips[0, 1, i], slips[0, 2, i])
        alone.prepare(law, i, H, BETA, GAMMA, start, rates[0, i], rates[1, i])
        for k in range(1, slips.shape[0]):
            touch = Slip(slips[k, 0, i], slips[k, 1, i], slips[k, 2, i])
            statuses[k, i] = alone.status(law, i, touch, k == slips.shape[0] - 1)
            forces[k, 0, i], forces[k, 1, i] = alone.act(law, i, touch)[0:2]
        alone.commit(law, i, touch)
        forces[0, 0, i], forces[0, 1, i] = alone.force_now(law, i, touch)


@entry
def _together(law, slips, rates, forces, statuses):
    last = slips.shape[2]
    for i in range(0, last, LANES):
        start = Slip(gather(slips[0, 0], i, last), gather(slips[0, 1], i, last), gather(slips[0, 2], i, last))
        together.prepare(law, i, last, H, BETA, GAMMA, start, gather(rates[0], i, last), gather(rates[1], i, last))
        for k in range(1, slips.shape[0]):
            touch = Slip(gather(slips[k, 0], i, last), gather(slips[k, 1], i, last), gather(slips[k, 2], i, last))
            converged = k == slips.shape[0] - 1
            asks = together.may_change(law, i, last, touch, converged)
            if any_of(asks):
                asked = where(asks, 1.0, 0.0)
                for n in range(i, min(i + LANES, last)):
                    if lane(asked, n - i) > 0.0:
                        statuses[k, n] = alone.status(law, n, together.slip_of(touch, n - i), converged)
            along, around = together.resist(law, i, last, touch)
            scatter(forces[k, 0], i, last, along)
            scatter(forces[k, 1], i, last, around)
        along, around = together.commit(law, i, last, touch)
        scatter(forces[0, 0], i, last, along)
        scatter(forces[0, 1], i, last, around)


def projection(rng):
    rows = records(COUNT, PROJECTED, static=0.5, kinetic=0.35, mass=30.0, mass_c=60.0, links=1e4)
    for name, size in (("force_a", 4.0), ("force_c", 4.0), ("rate_a", 0.2), ("rate_c", 0.2)):
        rows[name] = size * rng.standard_normal(COUNT)
    rows["seen_a"], rows["seen_c"] = 1e-9 * rng.standard_normal((2, COUNT))
    rows["settled"] = rng.choice([SLIP, STICK], COUNT)
    return Projection(rows)


def karnopp(rng):
    rows = records(COUNT, BANDED, static=0.5, kinetic=0.35, mass_a=30.0, mass_c=60.0)
    rows["settled_a"], rows["settled_c"] = 4.0 * rng.standard_normal((2, COUNT))
    return Karnopp(rows, 1e-3)


def sliding(rng):
    rows = records(COUNT, SLIDING, factor=0.3)
    angle = rng.uniform(0.0, 6.0, COUNT)
    rows["along"], rows["around"] = np.cos(angle), np.sin(angle)
    return Sliding(rows)


LAWS = {
    "projection": projection,
    "Karnopp": karnopp,
    "regularised": lambda rng: Regularised(np.full(COUNT, 0.5), np.full(COUNT, 0.35), 0.01, 2.0),
    "sliding": sliding,
}
UNCHANGED_WITHOUT = ("nx", "ny")
"""Of a direction only the sign of a product is asked for: it has any length."""


@pytest.mark.parametrize("law", LAWS)
def test_a_law_of_friction_is_the_same_for_four_contacts_as_for_each_alone(law):
    seen = set()
    for seed in SEEDS:
        rng = np.random.default_rng([seed, 7])
        # Slips from those that a stuck contact has to those of one that slides, and some contacts that do not press.
        sizes = 10.0 ** rng.uniform(-11.0, -1.0, COUNT)
        slips = np.concatenate(
            [rng.uniform(-3.0, 15.0, (STEPS, 1, COUNT)), sizes * rng.standard_normal((STEPS, 2, COUNT))], axis=1
        )
        rates, found = 0.2 * rng.standard_normal((2, COUNT)), []
        for run in (_alone, _together):
            rule = LAWS[law](np.random.default_rng(seed))
            forces, statuses = np.zeros((STEPS, 2, COUNT)), np.zeros((STEPS, COUNT), np.int64)
            run(rule, slips, rates, forces, statuses)
            found.append((rule, forces, statuses))
        (one, forces, statuses), (other, forces_of_four, statuses_of_four) = found
        np.testing.assert_array_equal(statuses_of_four, statuses)
        # At the end the forces of the accepted state stand in the first place.
        presses = (slips[[STEPS - 1, *range(1, STEPS)], 0] > 0.0)[:, None] & np.ones((1, 2, 1), bool)
        np.testing.assert_allclose(forces_of_four[presses], forces[presses], rtol=1e-12, atol=1e-12)
        if law in ("projection", "Karnopp"):
            for name in one.rows.dtype.names:
                if name not in UNCHANGED_WITHOUT:
                    np.testing.assert_allclose(other.rows[name], one.rows[name], rtol=1e-12, atol=1e-12, err_msg=name)
        if law == "projection":
            seen |= {(int(a), int(b)) for a, b in zip(one.rows.settled, one.rows.status, strict=True)}
    assert law != "projection" or {(SLIP, SLIP), (STICK, STICK)} <= seen


@pytest.mark.parametrize("run", [_alone, _together])
def test_what_goes_on_sliding_against_its_weight_is_not_taken_to_have_turned_back(run):
    """Coulomb: friction is against the slip, which is forward in all iterations, though the lump slows down."""
    normal, factor, mass, weight = 100.0, 0.35, 30.0, 20.0
    rows = records(COUNT, PROJECTED, static=0.35, kinetic=factor, mass=mass, mass_c=60.0, links=1e4)
    slowing = -(factor * normal + weight) / mass
    rows["settled"], rows["force_a"], rows["rate_a"], rows["seen_a"] = SLIP, -factor * normal, slowing, 1.0e-9
    slips = np.zeros((STEPS, 3, COUNT))
    slips[:, 0], slips[:, 1] = normal, 1.0e-9
    forces, statuses = np.zeros((STEPS, 2, COUNT)), np.zeros((STEPS, COUNT), np.int64)
    run(Projection(rows), slips, np.tile([[slowing], [0.0]], COUNT), forces, statuses)
    assert not statuses.any() and (rows["status"] == SLIP).all()
    np.testing.assert_allclose(forces[:, 0], -factor * normal, rtol=1e-12)
