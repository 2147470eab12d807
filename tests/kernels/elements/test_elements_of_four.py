"""Four elements at once: each counts once, whatever stands beside it."""

import numpy as np
import pytest

from tautline.elements.beam.bending import BENDING, Bending, new_bending
from tautline.elements.cable import Cable, Elastic
from tautline.elements.cubic import members
from tautline.elements.inertia import INERTIA, Inertia
from tautline.elements.tension import TENSION, Tension, new_tension
from tautline.kernels import groups as over
from tautline.kernels import lanes
from tautline.kernels.dofs import Dofs
from tautline.kernels.groups import link, members_of
from tautline.kernels.hermite import gauss, table
from tautline.kernels.jit import entry
from tautline.kernels.matrix import dense, new_matrix
from tautline.system.records import records_of

NODE = 7


@entry
def _residual(groups, q, v, a, r):
    over.residual(groups, 0.0, q, v, a, r)


@entry
def _force(groups, q, v, a, r):
    over.force(groups, 0.0, q, v, a, r)


@entry
def _tangent(groups, q, v, a, matrix, dofs):
    over.smooth_tangent(groups, 0.0, q, v, a, 0.7, -1.3, 2.1, matrix, dofs)


@entry
def _operations(x, y, out):
    a, b = lanes.load(x, 0), lanes.load(y, 0)
    lanes.store(out, 0, a + b * 2.0 - 1.0 / a)
    lanes.store(out, 4, -a / (3.0 - b))
    lanes.store(out, 8, lanes.sqrt(a) + 1)
    lanes.store(out, 12, lanes.where(b < 0.0, a, 0.5))
    lanes.store(out, 16, lanes.collect(x, (3, 1, 1, 0), 1))
    lanes.add_to(out, (20, 20, 22, 20), 1, a)


@entry
def _members(n, count, places, counts):
    each, counted = members(n, count)
    for k in range(4):
        places[k] = each[k]
    lanes.store(counts, 0, counted)


def test_operations_act_lane_by_lane():
    x, y, out = np.array([0.5, 2.0, 3.0, 7.0, 9.0]), np.array([1.0, -2.0, 4.0, -0.5]), np.zeros(24)
    _operations(x, y, out)
    a = x[:4]
    wanted = [a + 2.0 * y - 1.0 / a, -a / (3.0 - y), np.sqrt(a) + 1.0, np.where(y < 0.0, a, 0.5), x[[4, 2, 2, 1]]]
    assert np.allclose(out[:20], np.concatenate(wanted), rtol=1e-15)
    # What falls on one place is summed there.
    assert np.array_equal(out[20:], [0.0, a[0] + a[1] + a[3], 0.0, a[2]])


@pytest.mark.parametrize("count", range(1, 10))
def test_every_member_of_a_group_counts_once(count):
    counted = np.zeros(count)
    for n in range(0, count, lanes.LANES):
        places, counts = np.zeros(4, np.int64), np.zeros(4)
        _members(n, count, places, counts)
        np.add.at(counted, places, counts)
    assert np.array_equal(counted, np.ones(count))


def _all_free(size):
    """Unknowns that are all degrees of freedom there are."""
    each = np.arange(size)
    whole = {"start": np.arange(size + 1), "factor": np.ones(size), "unknown": each, "number": each, "free": each}
    empty = {name: np.zeros(0, float if name == "offset" else np.int64) for name in Dofs._fields if name not in whole}
    return Dofs(**whole, **empty)


def _rope(count, rng):
    """A rope of unlike elements, its nodes in any order in the full vectors; all kinds of group, row by row."""
    places = NODE * rng.permutation(count + 1)
    rows = [{"a": int(places[k]), "b": int(places[k + 1])} for k in range(count)]
    tension = [
        {"stiffness": rng.uniform(1, 3), "damping": rng.choice([0.0, 0.4]), "engineering": rng.integers(2),
         "slack": rng.integers(2)} for _ in rows
    ]  # fmt: skip
    bending = [
        {"stiffness": rng.uniform(1, 3), "damping": rng.choice([0.0, 0.4]), "smoothing": rng.uniform(0.1, 1)}
        for _ in rows
    ]
    inertia = [
        {"mass": rng.uniform(1, 3), "damping": rng.choice([0.0, 0.4]), "load": tuple(rng.uniform(-1, 1, 3))}
        for _ in rows
    ]
    points = table(*gauss(3))

    def groups(some):
        def of(kind, more):
            return records_of(kind, [rows[k] | more[k] for k in some])

        return (
            new_tension(of(TENSION, tension), points),
            new_bending(of(BENDING, bending), points),
            Inertia(of(INERTIA, inertia), np.zeros((4, 4))),
        )  # fmt: skip

    q, v, a = rng.standard_normal((3, NODE * (count + 1)))
    for k, place in enumerate(places):
        q[place : place + 3] = 0.9 * k + 0.2 * rng.standard_normal(3)
        q[place + 3 : place + 6] = [1.0, 0.2, -0.1] + 0.2 * rng.standard_normal(3)
        q[place + 6], v[place + 6], a[place + 6] = float(k), 0.0, 0.0
    return groups, q, v, a


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5, 7, 8, 9])
def test_elements_beside_each_other_are_what_each_is_alone(count):
    groups, q, v, a = _rope(count, np.random.default_rng(count))
    free = _all_free(q.size)
    alone = [groups([k]) for k in range(count)]
    for kind, together in enumerate(groups(range(count))):
        residual, of_each = np.zeros((2, q.size))
        matrix, matrix_of_each = new_matrix(q.size, q.size - 1), new_matrix(q.size, q.size - 1)
        _residual(link((together,), "residual"), q, v, a, residual)
        _tangent(link((together,), "smooth_tangent"), q, v, a, matrix, free)
        for one in alone:
            _residual(link((one[kind],), "residual"), q, v, a, of_each)
            _tangent(link((one[kind],), "smooth_tangent"), q, v, a, matrix_of_each, free)
        assert np.allclose(residual, of_each, rtol=0.0, atol=1e-13 * np.abs(of_each).max())
        wanted = dense(matrix_of_each)
        assert np.allclose(dense(matrix), wanted, rtol=0.0, atol=1e-13 * np.abs(wanted).max())


def _sums(groups, q, v, a, free, bandwidth):
    """Residual, force without inertia, and tangent of some groups."""
    linked = link(groups, "residual", "force", "smooth_tangent")
    residual, force, matrix = np.zeros(q.size), np.zeros(q.size), new_matrix(free.free.size, bandwidth)
    _residual(linked, q, v, a, residual)
    _force(linked, q, v, a, force)
    _tangent(linked, q, v, a, matrix, free)
    return residual, force, dense(matrix)


def _some_held(size, rng):
    """The same unknowns but for some that are held, and two that are one."""
    held = np.sort(rng.choice(size, size // 5, replace=False))
    number = np.full(size, -1)
    free = np.setdiff1d(np.arange(size), held)
    number[free] = np.arange(free.size)
    masters = [[number[i]] if number[i] >= 0 else [] for i in range(size)]
    one, other = free[1], free[-1]
    masters[other], number[other] = [number[one]], number[one]
    flat = [m for each in masters for m in each]
    start = np.concatenate([[0], np.cumsum([len(each) for each in masters])])
    kept = free[:-1]
    numbers = {"start": start, "unknown": np.array(flat), "number": number, "free": kept, "held": held}
    numbers |= {"tied": np.array([other])}
    whole = {name: np.ascontiguousarray(value, np.int64) for name, value in numbers.items()}
    whole["factor"] = np.ones(len(flat))
    empty = {name: np.zeros(0, float if name == "offset" else np.int64) for name in Dofs._fields if name not in whole}
    return Dofs(**whole, **empty)


@pytest.mark.parametrize("held", [False, True])
@pytest.mark.parametrize("count", [1, 3, 4, 6, 9])
def test_terms_of_the_same_elements_do_together_what_each_does_alone(count, held):
    rng = np.random.default_rng(count)
    groups, q, v, a = _rope(count, rng)
    free = _some_held(q.size, rng) if held else _all_free(q.size)
    tension, bending, inertia = groups(range(count))
    alone = [_sums((one,), q, v, a, free, q.size - 1) for one in (tension, bending, inertia)]
    for some, kinds in (((0, 1), {Elastic}), ((0, 1, 2), {Cable}), ((0, 2), {Cable}), ((1, 2), {Bending, Inertia})):
        chosen = tuple((tension, bending, inertia)[k] for k in some)
        running = members_of(chosen)
        assert {type(running.groups[i]) for i, _ in running.that_run("residual")} == kinds
        for together, parts in zip(_sums(chosen, q, v, a, free, q.size - 1), zip(*alone, strict=True), strict=True):
            wanted = sum(parts[k] for k in some)
            assert np.allclose(together, wanted, rtol=0.0, atol=1e-13 * np.abs(wanted).max())


def test_terms_of_other_elements_or_in_another_order_run_alone():
    groups, *_ = _rope(5, np.random.default_rng(5))
    tension, bending, inertia = groups(range(5))
    _, some, _ = groups(range(3))
    _, turned, _ = groups([1, 0, 2, 3, 4])
    for other in (some, turned):
        running = members_of((tension, other, inertia))
        assert [type(running.groups[i]) for i, _ in running.that_run("residual")] == [Bending, Cable]
    # Of a rope that is stiff in a part of it inertia is that of all elements: it runs alone.
    less, *_ = groups(range(3))
    running = members_of((tension, less, some, inertia))
    assert [type(running.groups[i]) for i, _ in running.that_run("residual")] == [Elastic, Cable]
    running = members_of((less, some, inertia))
    assert [type(running.groups[i]) for i, _ in running.that_run("residual")] == [Inertia, Elastic]
    # Two ropes: each term goes with those of its own rope, wherever it stands in the list.
    apart, *_ = groups([4, 3])
    running = members_of((tension, apart, bending, inertia))
    assert running.parts == ((3, 0, 2),)
    assert [type(running.groups[i]) for i, _ in running.that_run("residual")] == [Tension, Cable]


def test_what_is_not_gone_through_together_is_asked_of_each_term():
    tension, bending, inertia = _rope(4, np.random.default_rng(4))[0](range(4))
    running = members_of((tension, bending, inertia))
    for name in ("energy", "dissipation", "mass"):
        kinds = [type(running.groups[i]) for i, _ in running.that_run(name)]
        assert kinds == ([Inertia] if name == "mass" else [Tension, Bending, Inertia])
