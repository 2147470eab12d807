"""Rainflow cycles of a tension: the standard's own example, closed forms, and histories that hardly are any."""

import numpy as np
import pytest

from crane.rope_life.fatigue import SLOPE, equivalent_range, rainflow_counts

STANDARD = np.array([-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0])
"""ASTM E1049-85, figure 6: peaks and valleys A to I."""


def test_the_example_of_astm_e1049_comes_out_as_published():
    cycles = rainflow_counts(np.arange(9.0), STANDARD)
    table = {size: cycles.count[cycles.range == size].sum() for size in range(1, 11)}
    assert table == {1: 0, 2: 0, 3: 0.5, 4: 1.5, 5: 0, 6: 0.5, 7: 0, 8: 1.0, 9: 0.5, 10: 0}
    # Its cycles by their ends: D-G, C-D, G-H, H-I, B-C, E-F, A-B.
    found = {("ABCDEFGHI"[int(a)], "ABCDEFGHI"[int(b)]) for a, b in zip(cycles.begin, cycles.end, strict=True)}
    assert found == {("D", "G"), ("C", "D"), ("G", "H"), ("H", "I"), ("B", "C"), ("E", "F"), ("A", "B")}
    assert cycles.mean[cycles.range == 9] == 0.5 and cycles.mean[cycles.range == 3] == -0.5


def test_samples_between_peaks_change_nothing():
    fine = np.linspace(0.0, 8.0, 161)
    coarse, dense = (
        rainflow_counts(np.arange(9.0), STANDARD),
        rainflow_counts(fine, np.interp(fine, range(9), STANDARD)),
    )
    for name in ("range", "mean", "count", "begin", "end"):
        np.testing.assert_allclose(getattr(dense, name), getattr(coarse, name), atol=1e-12)


def test_a_sine_has_its_range_and_mean_in_as_many_cycles_as_periods():
    time = np.linspace(0.0, 7.0, 2801)
    cycles = rainflow_counts(time, 5e4 - 2e4 * np.cos(2 * np.pi * time))
    assert cycles.count.sum() == 7.0
    np.testing.assert_allclose(cycles.range, 4e4)
    np.testing.assert_allclose(cycles.mean, 5e4)
    assert equivalent_range(cycles, 5.0) == pytest.approx(4e4)


def test_damage_of_the_equivalent_range_is_that_of_all_cycles():
    cycles = rainflow_counts(np.arange(9.0), STANDARD)
    damage = 0.5 * 3.0**3 + 1.5 * 4.0**3 + 0.5 * 6.0**3 + 8.0**3 + 0.5 * 9.0**3
    assert equivalent_range(cycles, 3.0) == pytest.approx((damage / 4.0) ** (1 / 3))
    assert equivalent_range(cycles, 3.0, count=1.0) == pytest.approx(damage ** (1 / 3))
    assert equivalent_range(cycles, 400.0) == pytest.approx(9.0, rel=0.01)
    assert np.isfinite(equivalent_range(rainflow_counts(np.arange(9.0), 1e9 * STANDARD), 50.0))


def test_the_default_slope_weighs_ranges_by_their_fifth_power():
    """Counts 0.5, 1.5, 0.5, 1, 0.5 of the ranges 3, 4, 6, 8, 9: the sum of n S^5 is 67838, in 4 cycles."""
    cycles = rainflow_counts(np.arange(9.0), STANDARD)
    assert equivalent_range(cycles, SLOPE) == pytest.approx((67838.0 / 4.0) ** 0.2)


def test_a_run_that_only_rises_is_half_a_cycle_even_of_two_frames():
    for count in (2, 3, 50):
        cycles = rainflow_counts(np.linspace(0.0, 1.0, count), np.linspace(1e3, 5e3, count))
        assert cycles.range.tolist() == [4e3] and cycles.count.tolist() == [0.5]
        assert (cycles.begin[0], cycles.end[0]) == (0.0, 1.0)


@pytest.mark.parametrize("count", [1, 2, 3, 100])
def test_a_constant_tension_has_no_cycle(count):
    cycles = rainflow_counts(np.arange(float(count)), np.full(count, 4e4))
    assert cycles.range.size == cycles.mean.size == cycles.count.size == cycles.begin.size == cycles.end.size == 0
    assert equivalent_range(cycles, 3.0) == 0.0


def test_small_ranges_are_left_out_and_large_ones_stay_whole():
    time = np.linspace(0.0, 1.0, 1001)
    smooth, rough = 100.0 * np.sin(20.0 * time), 0.1 * np.cos(1e3 * np.pi * time)
    assert rainflow_counts(time, smooth + rough).range.size > 30
    kept, alone = rainflow_counts(time, smooth + rough, least=1.0), rainflow_counts(time, smooth)
    np.testing.assert_allclose(kept.range, alone.range, atol=0.3)
    assert kept.count.tolist() == alone.count.tolist()


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_what_is_not_finite_is_refused_with_its_frame(value):
    with pytest.raises(ValueError, match=r"tension: frame 2 \(time 0.2 s\) is not finite"):
        rainflow_counts(np.arange(4) * 0.1, np.array([1.0, 2.0, value, 3.0]))


def test_no_frame_and_times_that_fall_are_refused():
    with pytest.raises(ValueError, match="at least one frame"):
        rainflow_counts(np.zeros(0), np.zeros(0))
    with pytest.raises(ValueError, match=r"0\.5 s at frame 2 comes after 1 s"):
        rainflow_counts(np.array([0.0, 1.0, 0.5]), np.zeros(3))
    with pytest.raises(ValueError, match="one history"):
        rainflow_counts(np.arange(3.0), np.zeros((3, 2)))


@pytest.mark.parametrize("slope", [0.0, -3.0, np.nan, np.inf])
def test_a_slope_of_no_sn_curve_is_refused(slope):
    with pytest.raises(ValueError, match="slope"):
        equivalent_range(rainflow_counts(np.arange(9.0), STANDARD), slope)
