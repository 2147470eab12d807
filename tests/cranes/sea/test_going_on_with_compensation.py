"""A run with heave compensation that is gone on with to a later end."""

import numpy as np
import pytest
from physics.lifting.crane_scenes import body, crane, drum, end, model_of, solved

from tautline.results.errors import ResultError
from tautline.simulation import simulate

WAVE = {"harmonic": {"amplitude": 1.0, "period": 6.0, "ramp": 2.0}}
CHIRP = {"chirp": {"amplitude": 0.3, "period": 8.0, "rate": 0.2}}


def compensated(heave, until):
    """A load on one fall from a drum that an actuator of small stroke and speed turns."""
    limits = {"stroke": 0.8, "speed": 0.9}
    return crane(
        [drum((0.0, 0.0, 30.0)), end("payload")],
        [body("payload", 2000.0, [0.3, 0.0, -20.0])],
        vessel={"reference": [0, 0, 0], "motion": {"heave": heave}},
        heave_compensation={"gain": 1.0, "limits": limits},
        mesh={"elements_per_span": 2},
        solver={"end": until, "step": 0.01},
        interval=0.05,
    )


def test_a_run_that_is_gone_on_with_is_the_run_to_the_later_end():
    scene = compensated(WAVE, 14.0)
    whole = simulate(model_of(scene))
    part = simulate(model_of(solved(scene, end=9.1)))
    both = simulate(model_of(scene), resume=part)
    assert np.ptp(whole["compensator"]) > 1.5
    shared = whole["time"] <= 9.1 + 1e-9
    assert np.allclose(part["compensator"], whole["compensator"][shared], rtol=0.0, atol=1e-9)
    assert np.allclose(both["compensator"], whole["compensator"], rtol=0.0, atol=1e-9)
    assert np.allclose(both["drum_tension"], whole["drum_tension"], rtol=0.0, atol=1e-3)


def test_a_chirp_whose_frequency_grows_with_the_run_is_not_gone_on_with():
    scene = compensated(CHIRP, 12.0)
    part = simulate(model_of(solved(scene, end=3.0)))
    with pytest.raises(ResultError, match="prepared otherwise") as refused:
        simulate(model_of(scene), resume=part)
    assert "from its start" in refused.value.cure
