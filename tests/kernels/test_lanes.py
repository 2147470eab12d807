"""Four members at a time: lanes against NumPy, and strings of any number of lumps against each lump alone."""

import numpy as np
import pytest
from kernels.strings import short_string as string
from kernels.strings.short_string import PER_BODY, WELLS

from drillstring.groups.contact import SPRING, WallContact, nothing_kept
from drillstring.groups.drag import Drag
from drillstring.groups.friction import PROJECTED, SLIP, STICK, Projection
from tautline.kernels.groups import members_of
from tautline.kernels.jit import entry
from tautline.kernels.lanes import (
    LANES,
    add_at_places,
    add_pairs_at_places,
    add_rows,
    any_of,
    collect_fours,
    collect_pairs,
    cos,
    equals,
    exp,
    gather,
    keep_rows,
    lane,
    larger,
    largest,
    load,
    load_fields,
    load_rows,
    negated,
    same_rows,
    scatter,
    sin,
    sqrt,
    store,
    store_fields,
    total,
    transposed,
    where,
    within,
)
from tautline.lumped.string import String
from tautline.system.records import records

COUNTS = (1, 3, 4, 5, 8, 11)
RECORD = np.dtype([("kind", "i8"), ("a", "f8"), ("b", "f8"), ("c", "f8"), ("d", "f8"), ("e", "f8")])


@entry
def _all_at_once(q, r, rows, out, sums):
    """Every function of lanes once, on rows of four numbers."""
    last = rows.size
    kept = out[4 * last :]
    for i in range(0, last, LANES):
        x, y, z, w = load_rows(q, i, last)
        a, b, c, d = load_fields(rows.a, i, last)
        e = gather(rows.e, i, last)
        first = equals(rows.kind, i, last, 1)
        y = where(first & negated(y > 0.5), sqrt(abs(x)), larger(y, 0.25) - 2)
        z *= a / (1.5 + b * b)
        if any_of((w < 0.1) | (w >= 0.9) | (w == 0.5) | (w <= -9.0)):
            w += exp(-w) * lane(w, 1)
        add_rows(r, i, last, x * sin(1000.0 * y), cos(z), -c * w, d)
        scatter(out, i, last, e * x)
        scatter(rows.kind, i, last, where(first, 7, 8))
        store_fields(rows.b, i, last, b * x, 3.0, -a, y)
        sums[0] += total(where(within(i, last), x, 0.0))
        sums[1] = max(sums[1], largest(y))
        keep_rows(q, i, last, kept, 0)
        sums[2] += 1.0 if same_rows(q, i, last, kept, 0) else 0.0
        kept[5] += 1.0
        sums[2] += 10.0 if same_rows(q, i, last, kept, 0) else 0.0
        store(kept, 0, load(kept, 4) + x)


def _numbers(count):
    rng = np.random.default_rng(count)
    rows = np.zeros(count, RECORD).view(np.recarray)
    for name in RECORD.names[1:]:
        rows[name] = rng.standard_normal(count)
    rows["kind"] = rng.integers(0, 2, count)
    return rng.standard_normal(4 * count), rng.standard_normal(4 * count), rows, np.zeros(4 * count + 16), np.zeros(3)


@pytest.mark.parametrize("count", COUNTS)
def test_lanes_give_what_arrays_give_and_leave_all_beyond_the_last_member_alone(count):
    compiled, plain = _numbers(count), _numbers(count)
    _all_at_once(*compiled)
    getattr(_all_at_once, "py_func", _all_at_once)(*plain)
    for one, other in zip(compiled, plain, strict=True):
        if one.dtype == RECORD:
            assert np.array_equal(one.tolist(), other.tolist())
        else:
            np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-13)


@entry
def _in_single(x, singles, out):
    for i in range(0, x.size, LANES):
        store(singles, i, 0.1 + load(x, i))
        store(out, i, 3.0 * load(singles, i))


def test_in_an_array_of_single_precision_lanes_are_rounded_and_read_as_they_stand():
    x, out, singles = np.random.default_rng(6).standard_normal(12), np.zeros(12), np.zeros(12, np.float32)
    _in_single(x, singles, out)
    assert np.array_equal(singles, (0.1 + x).astype(np.float32))
    assert np.array_equal(out, 3.0 * singles.astype(float))


@entry
def _to_places(x, out, places):
    """Columns of lanes added as rows: by fours to places that overlap, and by pairs."""
    for i in range(0, x.size, 4 * LANES):
        a, b, c, d = load(x, i), load(x, i + LANES), load(x, i + 2 * LANES), load(x, i + 3 * LANES)
        add_at_places(out, places, 1, transposed(a, b, c, -d))
        add_pairs_at_places(out, places, 5, a * b, c)


def test_columns_are_added_as_rows_of_four_and_two_also_where_these_overlap():
    x, places = np.random.default_rng(2).standard_normal(32), (3, 0, 5, 5)
    found, plain, expected = np.zeros((3, 20))
    _to_places(x, found, places)
    getattr(_to_places, "py_func", _to_places)(x, plain, places)
    for a, b, c, d in x.reshape(2, 4, LANES):
        for k, place in enumerate(places):
            expected[place + 1 : place + 7] += a[k], b[k], c[k], -d[k], 0.0, 0.0
            expected[place + 5 : place + 7] += a[k] * b[k], c[k]
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-14)
    np.testing.assert_allclose(plain, expected, rtol=0.0, atol=1e-14)


@entry
def _from_places(x, out, places):
    """Rows of four numbers and of two, read from places that overlap, written column by column."""
    columns = (*collect_fours(x, places, 2), *collect_pairs(x, places, 6))
    store(out, 0, columns[0])
    store(out, LANES, columns[1])
    store(out, 2 * LANES, columns[2])
    store(out, 3 * LANES, columns[3])
    store(out, 4 * LANES, columns[4])
    store(out, 5 * LANES, columns[5])


def test_rows_of_four_and_two_at_any_places_are_read_as_columns():
    x, places = np.random.default_rng(3).standard_normal(16), (8, 0, 3, 3)
    found, plain = np.zeros((2, 6 * LANES))
    _from_places(x, found, places)
    getattr(_from_places, "py_func", _from_places)(x, plain, places)
    expected = np.array([x[place + 2 : place + 8] for place in places]).T.ravel()
    assert found.tolist() == expected.tolist() == plain.tolist()


@entry
def _angles(x, sines, cosines):
    for i in range(0, x.size, LANES):
        store(sines, i, sin(load(x, i)))
        store(cosines, i, cos(load(x, i)))


@pytest.mark.parametrize("size", [0.1, 3.0, 1e3, 1e6])
def test_sine_and_cosine_in_lanes_are_those_of_the_library_within_two_units_in_the_last_place(size):
    x = np.concatenate([size * np.random.default_rng(5).standard_normal(4000), np.pi / 4 * np.arange(-200, 200)])
    sines, cosines = np.zeros((2, x.size))
    _angles(x, sines, cosines)
    for found, exact in ((sines, np.sin(x)), (cosines, np.cos(x))):
        assert np.abs(found - exact).max() <= 2.5e-16


def _long_string(count, well, seed):
    """A string of ``count`` lumps off the axis, all kinds of its groups, and a random state."""
    rng = np.random.default_rng([count, seed])
    places = np.linspace(0.1, 4.4, count)
    q = np.zeros((count, PER_BODY))
    q[:, 0] = 0.3 / count * rng.uniform(-1.0, 1.0, count)
    q[:, 1:3], q[:, 3] = 0.2 * rng.standard_normal((count, 2)), rng.uniform(-3.0, 3.0, count)
    state = string.State(q.ravel(), rng.standard_normal(q.size), rng.standard_normal(q.size))
    seats = string.curve(WELLS[well], state, places)
    touching = count - 1
    law = records(touching, PROJECTED, static=0.5, kinetic=0.35, c=rng.uniform(2, 5, touching), factor=0.4)
    law["status"] = law["settled"] = rng.choice([SLIP, STICK], touching)
    law["force_a"], law["force_c"] = 0.05 * rng.standard_normal((2, touching))
    springs = records(touching, SPRING, body=np.arange(1, count), clearance=0.15, radius=0.08, viscous=0.2)
    springs["stiffness"], springs["damping"] = rng.uniform(1, 3, touching), rng.uniform(0.1, 0.3, touching)
    wall = WallContact(seats, Projection(law), springs, np.zeros((2, 4, 4)), nothing_kept(touching))
    groups = (
        string.bodies(seats, rng), string.bodies(seats, rng, eccentric=True), string.links(seats, rng, 0.3),
        string.bends(seats, rng), Drag(seats, rng.uniform(0.1, 0.5, count)), wall,
    )  # fmt: skip
    return groups, seats, state


@pytest.mark.parametrize("well", ["vertical", "spatial"])
@pytest.mark.parametrize("count", [3, 6, 11])
def test_forces_on_a_lump_are_the_same_asked_for_it_alone(count, well):
    # Alone it stands in another lane, beside other members or repeated ones.
    groups, seats, state = _long_string(count, well, 1)
    for group in groups:
        whole = string.residual((group,), state).reshape(-1, PER_BODY)
        for i in range(count):
            seats.window[:] = PER_BODY * i, PER_BODY * (i + 1)
            alone = string.residual((group,), state).reshape(-1, PER_BODY)[i]
            np.testing.assert_allclose(alone, whole[i], rtol=1e-13, atol=1e-13, err_msg=type(group).__name__)
        seats.window[:] = 0, PER_BODY * count


@pytest.mark.parametrize("well", ["vertical", "spatial"])
@pytest.mark.parametrize("damping", [0.0, 0.3])
@pytest.mark.parametrize("count", [3, 4, 5, 6, 7, 9, 13])
def test_a_string_does_together_what_its_bodies_links_and_bends_do_alone(count, damping, well):
    (plain, eccentric, links, bends, drag, wall), seats, state = _long_string(count, well, 3)
    links = links._replace(damping=damping)
    for bodies in (plain, eccentric):
        groups = (wall, bends, links, drag, bodies)
        running = members_of(groups)
        assert {type(running.groups[i]) for i, _ in running.that_run("residual")} == {WallContact, Drag, String}
        wanted, found = string.residual(groups, state), string.residual_together(groups, state)
        np.testing.assert_allclose(found, wanted, rtol=0.0, atol=1e-13 * np.abs(wanted).max())
        for first in range(count):
            for last in range(first + 1, count + 1):
                seats.window[:] = PER_BODY * first, PER_BODY * last
                inside = string.residual_together(groups, state)[PER_BODY * first : PER_BODY * last]
                whole = wanted[PER_BODY * first : PER_BODY * last]
                np.testing.assert_allclose(inside, whole, rtol=0.0, atol=1e-13 * np.abs(wanted).max())
        seats.window[:] = 0, PER_BODY * count


def test_bodies_links_and_bends_that_are_not_of_one_string_run_alone():
    (bodies, _, links, bends, *_), seats, state = _long_string(6, "spatial", 4)
    rng = np.random.default_rng(4)
    other = string.curve(WELLS["spatial"], state, seats.seats.place.copy())
    shorter = string.links(string.curve(WELLS["spatial"], state, seats.seats.place[:-1].copy()), rng)
    for groups in (
        (bodies, links, string.bends(other, rng)), (bodies, string.links(other, rng), bends), (bodies, shorter, bends),
        (bodies, links, bends._replace(length=1.1 * bends.length)), (bodies, links), (links, bends),
    ):  # fmt: skip
        running = members_of(groups)
        assert running.parts == ()
        assert all(running.groups[i] is g for (i, _), g in zip(running.that_run("residual"), groups, strict=True))
    (bodies, _, links, *_), seats, _ = _long_string(2, "spatial", 5)
    straight = string.bends(seats, rng)
    assert straight.stiffness.size == 0
    assert members_of((bodies, links, straight)).parts == ()


@pytest.mark.parametrize("count", [3, 6, 11])
def test_what_a_contact_keeps_is_found_anew_where_a_coordinate_or_a_rate_differs(count):
    groups, _, state = _long_string(count, "spatial", 2)
    wall = groups[-1]
    bare = wall._replace(kept=np.zeros(0))
    for place in range(PER_BODY, state.q.size):
        for name in ("q", "v"):
            string.residual((wall,), state)
            changed = getattr(state, name).copy()
            changed[place] += 1e-9
            other = state._replace(**{name: changed})
            assert np.array_equal(string.residual((wall,), other), string.residual((bare,), other))
