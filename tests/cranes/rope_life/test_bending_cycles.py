"""Bending cycles: closed forms of ropes that run to and fro, and the same count done place by place."""

import numpy as np
import pytest

from crane.rope_life.bending import Contact, bending_cycles, drum_contact


def saw(times, travel, frames=40):
    """Time and position of a rope that runs forth and back `times` times over a travel; frames at every turn."""
    position = np.interp(np.linspace(0.0, 2.0 * times, 2 * times * frames + 1), range(2 * times + 1),
                         [travel * (k % 2) for k in range(2 * times + 1)])  # fmt: skip
    return np.arange(position.size) * 0.1, position


def sheave(position, at=50.0, arc=1.2, tension=4e4, radius=0.4, side=1.0, name="tip"):
    low = at - np.asarray(position, float)
    return Contact(name, low, low + arc, np.broadcast_to(tension, low.shape), radius, side)


def counted_at(places, contacts, reach, parts=400):
    """Cycles and reversals at places, from which contact holds each at ever so many times between the frames."""
    frames = len(contacts[0].on)
    fine = np.linspace(0.0, frames - 1.0, (frames - 1) * parts + 1)
    low, high = (
        np.array([np.interp(fine, range(frames), end(c.on, c.off)) for c in contacts])
        for end in (np.minimum, np.maximum)
    )
    cycles, reversals = [], []
    for p in places:
        bent = (low < p) & (p < high)
        cycles.append(0.5 * np.abs(np.diff(bent.astype(int), axis=1)).sum())
        seen = np.flatnonzero(bent.any(axis=0))
        last = bent[:, seen].argmax(axis=0)
        turned = 0
        for k in np.flatnonzero(np.diff(last)):
            first, when = min(last[k], last[k + 1]), seen[k + 1]
            other_way = contacts[first].side * contacts[first + 1].side < 0.0
            turned += other_way and low[first + 1, when] - high[first, when] < reach
        reversals.append(turned)
    return np.array(cycles), np.array(reversals)


def test_a_rope_over_one_sheave_makes_a_cycle_each_way_where_all_of_it_passes():
    times, travel = 5, 10.0
    time, position = saw(times, travel)
    edges = np.arange(30.0, 60.01, 0.1)
    found = bending_cycles(time, [sheave(position)], edges)
    middle = 0.5 * (edges[:-1] + edges[1:])
    expected = np.zeros(middle.size)
    # Straight at first and over the sheave to the far side, there and back; but only onto it at one end of the
    # travel, or off it at the other: one cycle for there and back.
    expected[(middle > 41.2) & (middle < 50.0)] = 2 * times
    expected[(middle > 40.0) & (middle < 41.2) | (middle > 50.0) & (middle < 51.2)] = times
    np.testing.assert_array_equal(found.cycles, expected)
    np.testing.assert_allclose(found.mean, expected, atol=1e-9)
    assert found.cycles.sum() * 0.1 == pytest.approx(2 * times * travel)
    assert found.most_worked() == (int(np.argmax(expected)), "tip")
    assert (found.worst == np.where(expected > 0, 0, -1)).all()


def test_a_passage_is_one_cycle_and_an_end_on_the_sheave_a_half():
    time = np.linspace(0.0, 5.0, 11)
    found = bending_cycles(time, [sheave(2.0 * time)], [30, 39.9, 40.1, 41.1, 41.3, 49.9, 50.1, 51.1, 51.3])
    assert found.cycles.tolist() == [0.0, 0.5, 0.5, 1.0, 1.0, 1.0, 0.5, 0.5]
    assert found.mean[1] == pytest.approx(0.25)


@pytest.mark.parametrize("amplitude", [0.25, 0.5, 2.0])
def test_a_compensated_rope_is_worked_within_the_amplitude_only(amplitude):
    periods, arc = 20, 1.2
    time = np.linspace(0.0, 10.0 * periods, 80 * periods + 1)
    edges = np.arange(45.0, 56.0, 0.01)
    found = bending_cycles(time, [sheave(amplitude * np.sin(0.2 * np.pi * time), arc=arc)], edges, diameter=0.036)
    middle = 0.5 * (edges[:-1] + edges[1:])
    # A place that either end of the arc sweeps makes one cycle a period at it, one that both sweep makes two.
    swept = [(np.abs(middle - end) < amplitude).astype(float) for end in (50.0, 50.0 + arc)]
    away = np.min([np.abs(np.abs(middle - end) - amplitude) for end in (50.0, 50.0 + arc)], axis=0) > 0.01
    np.testing.assert_array_equal(found.cycles[away & (found.cycles == 0)], 0.0)
    np.testing.assert_allclose(found.cycles[away], periods * (swept[0] + swept[1])[away], atol=0.0)
    assert (found.mean * 0.01).sum() == pytest.approx(4.0 * amplitude * periods, rel=1e-9)


def test_rope_at_rest_on_a_sheave_is_bent_but_not_worked():
    found = bending_cycles([0.0, 1.0], [sheave([0.0, 0.0], tension=[3e4, 5e4])], [49, 50, 51, 51.2, 52], diameter=0.04)
    assert found.cycles.tolist() == [0, 0, 0, 0] and found.most_worked() is None
    assert found.tension.tolist() == [0, 5e4, 5e4, 0]
    assert found.ratio.tolist() == [np.inf, pytest.approx(20.0), pytest.approx(20.0), np.inf]


def test_a_single_frame_bends_what_lies_on_the_sheave():
    found = bending_cycles([0.0], [sheave([0.0])], [49, 50, 51, 52], diameter=0.04)
    assert found.tension.tolist() == [0, 4e4, 4e4] and found.cycles.tolist() == [0, 0, 0]


def test_ends_of_the_arc_may_come_in_any_order():
    time, position = saw(2, 3.0)
    one = sheave(position)
    other = one._replace(on=one.off, off=one.on)
    edges = np.linspace(40.0, 60.0, 101)
    np.testing.assert_array_equal(
        bending_cycles(time, [one], edges).cycles, bending_cycles(time, [other], edges).cycles
    )


def test_winding_onto_a_drum_is_half_a_cycle():
    time = np.linspace(0.0, 10.0, 101)
    tension = 4e4 + 100.0 * time
    for stored, travel in (("before", 8.0), ("after", -8.0)):
        drum = drum_contact("winch", 50.0 + travel * time / 10.0, tension, 0.5, stored=stored)
        found = bending_cycles(time, [drum], np.arange(40.0, 61.0), diameter=0.036)
        wound = (np.arange(40, 60) >= min(50, 50 + travel)) & (np.arange(40, 60) < max(50, 50 + travel))
        np.testing.assert_array_equal(found.cycles, 0.5 * wound)
        deep = np.arange(40, 60) < 50 if stored == "before" else np.arange(40, 60) >= 50
        np.testing.assert_array_equal(found.ratio < np.inf, wound | deep)
        # The outer turn alone, of 3.14 m, feels the tension; what lies deeper keeps its own, which is not known.
        np.testing.assert_array_equal(found.tension > 0.0, wound | deep & (np.abs(np.arange(40, 60) + 0.5 - 50) < 4.0))
        assert found.tension.max() == pytest.approx(4.1e4)


def test_every_sheave_on_the_way_adds_its_cycle():
    time = np.linspace(0.0, 30.0, 61)
    contacts = [sheave(time, at=60.0 + 4.0 * k, radius=0.4 - 0.05 * k, name=f"sheave {k}") for k in range(4)]
    contacts[2] = contacts[2]._replace(tension=np.full(61, 6e4))
    found = bending_cycles(time, contacts, np.arange(44.0, 60.01, 0.5), diameter=0.02)
    np.testing.assert_array_equal(found.cycles, 4.0)
    np.testing.assert_array_equal(found.by_contact, 1.0)
    np.testing.assert_array_equal(found.tension, 6e4)
    np.testing.assert_allclose(found.ratio, 2.0 * 0.25 / 0.02)
    assert not found.reversals.any()


def test_the_sheave_that_does_most_is_named():
    time, position = saw(3, 0.8)
    contacts = [sheave(0.0 * position, at=48.0, name="still"), sheave(position, name="busy")]
    found = bending_cycles(time, contacts, [47.0, 48.5, 49.3, 49.9, 53.0])
    assert found.worst.tolist() == [-1, 1, 1, 1] and found.most_worked()[1] == "busy"
    assert found.by_contact[:, 0].tolist() == [0, 0, 0, 0]


def test_the_largest_tension_is_that_while_the_bin_is_on_the_sheave():
    time = np.array([0.0, 1.0])
    contact = Contact("tip", np.array([10.0, 0.0]), np.array([11.0, 1.0]), np.array([0.0, 1000.0]), 0.4)
    found = bending_cycles(time, [contact], np.arange(0.0, 13.0))
    # The bin (b, b + 1) leaves the sheave when its upper end at 11 - 10 t comes down to b; then T = 1000 t.
    np.testing.assert_allclose(found.tension, [*(100.0 * np.minimum(10.0, 11.0 - np.arange(11.0))), 0.0])


def test_reversed_bending_is_counted_where_the_next_sheave_bends_the_other_way():
    time, position = saw(2, 10.0)
    edges = np.arange(38.0, 60.0, 0.5)
    for side, count in ((-1.0, 4), (1.0, 0), (0.0, 0)):
        contacts = [sheave(position), sheave(position, at=52.0, side=side, name="next")]
        found = bending_cycles(time, contacts, edges, reach=1.0)
        middle = 0.5 * (edges[:-1] + edges[1:])
        # Rope that lies on one at first and reaches the other, or runs over both.
        both = (middle > 42.0) & (middle < 51.2)
        np.testing.assert_array_equal(found.reversals[both & (np.abs(middle - 51.2) > 0.5)], count)
        np.testing.assert_array_equal(found.reversals[(middle < 41.9) | (middle > 51.3)], 0)


def test_bending_the_other_way_far_away_is_not_reversed_bending():
    time, position = saw(2, 10.0)
    contacts = [sheave(position), sheave(position, at=52.0, side=-1.0, name="next")]
    edges = np.arange(38.0, 60.0, 0.5)
    assert not bending_cycles(time, contacts, edges, reach=0.7).reversals.any()
    assert not bending_cycles(time, contacts, edges).reversals.any()
    assert not bending_cycles(time, contacts, edges, diameter=0.003).reversals.any()
    assert bending_cycles(time, contacts, edges, diameter=0.02).reversals.any()


def test_a_block_that_comes_near_reverses_only_the_rope_that_passes_then():
    # The second sheave's rope moves down to within 1 m of the first's and away again.
    time = np.linspace(0.0, 2.0, 401)
    near = 5.0 * np.abs(time - 1.0)
    first = sheave(6.0 * time, at=50.0, arc=0.5)
    second = sheave(6.0 * time - near, at=51.5, arc=0.5, side=-1.0, name="block")
    places = np.arange(35.0, 60.0, 0.137)
    found = bending_cycles(time, [first, second], np.column_stack([places - 1e-4, places + 1e-4]).ravel(), reach=2.0)
    cycles, reversals = counted_at(places, [first, second], 2.0, parts=40)
    np.testing.assert_array_equal(found.cycles[::2], cycles)
    np.testing.assert_array_equal(found.reversals[::2], reversals)
    assert 0 < (reversals > 0).sum() < (cycles > 0).sum()


@pytest.mark.parametrize("seed", range(10))
def test_counts_are_those_of_watching_each_place(seed):
    rng = np.random.default_rng(seed)
    frames = 40
    # Rope positions at random, on contacts whose arcs and distances change and at times vanish.
    flow = np.cumsum(rng.normal(0.0, 0.6, frames))
    lengths = np.maximum(rng.normal(0.5, 0.5, (5, frames)), 0.0)
    ends = 20.0 - flow + np.cumsum(lengths, axis=0)
    side = rng.choice([-1.0, 1.0], 2)
    ends[1] = np.maximum(ends[1], ends[0] + 0.05)
    ends[2] = np.maximum(ends[2], ends[1] + 0.02)
    ends[3] = np.maximum(ends[3], ends[2] + 0.05)
    contacts = [Contact("a", ends[0], ends[1], np.ones(frames), 0.4, side[0]),
                Contact("b", ends[2], ends[3], np.ones(frames), 0.4, -side[0])]  # fmt: skip
    places = np.sort(rng.uniform(ends.min(), ends.max(), 60))
    found = bending_cycles(
        np.arange(frames), contacts, np.column_stack([places - 1e-9, places + 1e-9]).ravel(), reach=0.6
    )
    cycles, reversals = counted_at(places, contacts, 0.6, parts=1000)
    # Watching in steps misses what is shorter than one of them.
    assert (found.cycles[::2] != cycles).sum() <= 1 and (found.reversals[::2] != reversals).sum() <= 1
    assert cycles.max() > 2 and (reversals.max() > 0)


def test_rope_that_runs_past_a_sheave_without_touching_it_is_not_bent():
    time, position = saw(3, 5.0)
    found = bending_cycles(time, [sheave(position, arc=0.0)], np.arange(40.0, 60.0), diameter=0.03)
    assert not found.cycles.any() and not found.tension.any() and np.isinf(found.ratio).all()


def test_a_sheave_that_rope_lifts_off_from_unbends_it():
    arc = np.array([1.0, 0.0, 0.0, 1.0])
    contact = Contact("tip", 50.0 - arc, 50.0 + arc, np.full(4, 1e4), 0.4)
    found = bending_cycles(np.arange(4.0), [contact], np.arange(48.0, 53.0))
    assert found.cycles.tolist() == [0.0, 1.0, 1.0, 0.0]


def test_trembling_of_less_than_a_diameter_works_nothing_and_large_motion_keeps_its_extent():
    time = np.linspace(0.0, 100.0, 10001)
    tremble = 0.01 * np.sin(20.0 * np.pi * time)
    edges = np.arange(40.0, 56.0, 0.1)
    still = bending_cycles(time, [sheave(tremble)], edges, diameter=0.036)
    assert not still.cycles.any()
    assert bending_cycles(time, [sheave(tremble)], edges, diameter=0.036, resolution=0.0).cycles.max() > 100
    moving = sheave(5.0 * np.sin(0.2 * np.pi * time) + tremble)
    rough, smooth = (bending_cycles(time, [moving], edges, 0.036, resolution=r) for r in (0.0, None))
    # The ends of the travel, where the motion turns and trembles, lose what is ripple; the rest is as it was.
    assert smooth.cycles.max() == 20.0 and (smooth.mean <= rough.mean + 1e-9).all()
    assert smooth.mean.sum() < rough.mean.sum()
    np.testing.assert_allclose(smooth.mean.sum(), rough.mean.sum(), rtol=0.15)
    assert (smooth.cycles > 0).sum() == (rough.cycles > 0).sum()


def test_no_contact_bends_nothing():
    found = bending_cycles([0.0, 1.0], [], [0.0, 1.0, 2.0], diameter=0.03)
    assert found.cycles.tolist() == [0, 0] and found.by_contact.shape == (2, 0) and found.worst.tolist() == [-1, -1]


def test_bins_and_frames_do_not_change_what_the_rope_does():
    time, position = saw(4, 6.0, frames=7)
    fine = np.linspace(0.0, time[-1], 5 * (time.size - 1) + 1)
    contact = sheave(position)
    dense = Contact("tip", *(np.interp(fine, time, x) for x in contact[1:4]), 0.4)
    one = bending_cycles(time, [contact], np.arange(40.0, 60.0, 0.25))
    other = bending_cycles(fine, [dense], np.arange(40.0, 60.0, 0.25))
    np.testing.assert_array_equal(one.cycles, other.cycles)
    coarse = bending_cycles(time, [contact], np.arange(40.0, 60.0, 1.0))
    np.testing.assert_array_equal(coarse.cycles[:19], one.cycles[:76].reshape(-1, 4).max(axis=1))
    np.testing.assert_allclose(coarse.mean[:19], one.mean[:76].reshape(-1, 4).mean(axis=1))


def test_many_bins_in_blocks_give_the_same_tension(monkeypatch):
    time, position = saw(3, 6.0)
    contact = sheave(position, tension=4e4 + position)
    edges = np.arange(40.0, 60.0, 0.05)
    whole = bending_cycles(time, [contact], edges).tension
    monkeypatch.setattr("crane.rope_life.bending.PAIRS", 50)
    np.testing.assert_array_equal(bending_cycles(time, [contact], edges).tension, whole)


def test_what_cannot_be_is_refused_by_name():
    time, still = np.arange(3.0), np.zeros(3)
    good = sheave(still)
    edges = [40.0, 60.0]
    refused = {
        "tip, end of the arc: frame 1": [good._replace(on=np.array([1.0, np.nan, 1.0]))],
        "tip, end of the arc: frame 0 ": [good._replace(on=np.array([-np.inf, 1.0, 1.0]))],
        "tip, tension: frame 2": [good._replace(tension=np.array([1.0, 1.0, np.inf]))],
        r"tip, end of the arc: shape \(2,\) for 3 frames": [good._replace(off=np.zeros(2))],
        "tip: radius = 0": [good._replace(radius=0.0)],
        "tip, next: the rope on them overlaps by 0.2 m at time 0 s": [good, sheave(still, at=51.0, name="next")],
    }
    for message, contacts in refused.items():
        with pytest.raises(ValueError, match=message):
            bending_cycles(time, contacts, edges)
    for bad in ([1.0], [1.0, 1.0], [0.0, np.nan], [[0.0, 1.0]]):
        with pytest.raises(ValueError, match="edges"):
            bending_cycles(time, [good], bad)
    with pytest.raises(ValueError, match="diameter = 0"):
        bending_cycles(time, [good], edges, diameter=0.0)
    with pytest.raises(ValueError, match="reach = nan"):
        bending_cycles(time, [good], edges, reach=np.nan)
    with pytest.raises(ValueError, match="stored"):
        drum_contact("winch", still, still, 0.5, stored="left")
