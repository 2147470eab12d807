"""The order by which three runs converge, from the shape of their differences over time."""

import numpy as np
import pytest

from tautline.study.accuracy.shape import order_of_one_shape

TIMES = np.linspace(0.0, 1.0, 101)
MOTION, ERROR = np.sin(5.0 * TIMES), TIMES * np.cos(40.0 * TIMES)


def runs(order, steps=(0.12, 0.04, 0.01), errors=(ERROR, ERROR, ERROR)):
    """Runs that are off by an error that goes with a power of the step."""
    return [MOTION + error * step**order for step, error in zip(steps, errors, strict=True)], (4.0, 3.0)


@pytest.mark.parametrize("order", [0.5, 0.8, 1.0, 1.5, 2.0])
def test_the_order_is_that_of_the_error_though_it_changes_its_sign_at_all_times(order):
    assert order_of_one_shape(*runs(order)) == pytest.approx(order, abs=1e-6)


def test_orders_count_between_a_half_and_two():
    assert order_of_one_shape(*runs(3.0)) == pytest.approx(2.0, abs=1e-6)
    assert order_of_one_shape(*runs(0.1)) == 0.5


def test_a_path_in_space_has_one_order():
    histories, ratios = runs(2.0)
    paths = [np.stack([each, -2.0 * each, 0.0 * each], axis=1) for each in histories]
    assert order_of_one_shape(paths, ratios) == pytest.approx(2.0, abs=1e-6)


def test_events_that_each_run_has_at_its_own_time_have_no_shape_in_common():
    steps = [np.where(TIMES > at, 1.0, 0.0) * np.exp(-9.0 * (TIMES - at) ** 2) for at in (0.1, 0.5, 0.8)]
    assert order_of_one_shape(*runs(1.0, errors=steps)) is None


def test_a_run_that_swings_back_shows_no_order():
    """The second differs from the first one way and the third from the second the other."""
    assert order_of_one_shape([MOTION, MOTION + ERROR, MOTION + 0.5 * ERROR], (2.0, 2.0)) is None


def test_runs_that_do_not_differ_or_are_not_finite_show_no_order():
    assert order_of_one_shape([MOTION, MOTION, MOTION], (2.0, 2.0)) is None
    assert order_of_one_shape([MOTION, MOTION + ERROR, MOTION + ERROR], (2.0, 2.0)) is None
    assert order_of_one_shape([MOTION, np.full_like(MOTION, np.inf), MOTION], (2.0, 2.0)) is None
    assert order_of_one_shape([MOTION[:5], MOTION, MOTION], (2.0, 2.0)) is None
