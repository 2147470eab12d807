"""The critical step of RK4 against its polynomial, and runs on both sides of it where damping sets it."""

import numpy as np
import pytest
from physics.cables.tied_cables import element, node, run, scene

from tautline.integrators.status import Status, StoppedEarly
from tautline.integrators.vibration.critical_step import critical_step

POLYNOMIAL = [1 / 24, 1 / 6, 1 / 2, 1, 1]


def growth(stiffness, damping, h):
    return np.abs(np.polyval(POLYNOMIAL, h * np.roots([1.0, damping, stiffness]))).max()


@pytest.mark.parametrize("ratio", [0.0, 0.01, 0.2, 0.9, 1.0, 1.1, 5.0, 300.0])
@pytest.mark.parametrize("omega", [1e-3, 1.0, 1e5])
def test_nothing_grows_at_the_critical_step_and_something_beyond(omega, ratio):
    h = critical_step(omega**2, 2.0 * ratio * omega)
    assert growth(omega**2, 2.0 * ratio * omega, 0.995 * h) <= 1.0 + 1e-6
    # The bound on the imaginary axis is the thesis' 2.8 and not 2.828; lightly damped modes reach farther than either.
    assert growth(omega**2, 2.0 * ratio * omega, 1.3 * h) > 1.0


def test_limits_are_those_of_both_axes():
    assert critical_step(4.0, 0.0) == pytest.approx(1.4)
    assert critical_step(0.0, 2.0) == pytest.approx(2.785 / 2.0, rel=1e-3)
    assert critical_step(0.0, 0.0) == np.inf


def damped_bar(step, c):
    """One element of a bar that vibrates, with damping: omega = 7.75, and a decay of c omega^2."""
    items = [
        node(0, (0, 0, 0), (1,) * 7),
        node(1, (1, 0, 0), (0, 1, 1, 0, 1, 1, 1)),
        element(0, 0, 1, EA=10.0, cDamp=c),
    ]
    return scene([*items, "PointForce: {id: 1, nodes7: [1], force: [0.01, 0, 0]}"], time_step=step, time_end=200 * step)


def test_a_run_is_stopped_at_the_step_that_damping_sets():
    """Measured in vain with frequency alone: damping c makes the critical step 30 times shorter here."""
    for c in (0.0, 3.0):
        assert run(damped_bar(1e-4, c)).attributes["status"] == "done"
    with pytest.raises(StoppedEarly) as stop:
        run(damped_bar(0.05, 3.0))
    assert stop.value.status == Status.UNSTABLE
    critical = float(str(stop.value).rsplit("critical step ", 1)[1].split(" s")[0])
    assert critical < 0.03
    assert run(damped_bar(0.9 * critical, 3.0)).attributes["status"] == "done"
