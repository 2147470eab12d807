"""Factors of single precision change what iterations cost, not what they come to."""

import numpy as np
import pytest
from physics.cables.rope_text import PINNED, chain, model_of, straight

from tautline.integrators.corrector import newton
from tautline.kernels import matrix
from tautline.simulation import simulate

SOFT = {"n": 40, "length": 40.0, "EA": 1.0e5, "EJ": 1.0, "time_step": 0.001, "time_end": 0.3}
STIFF = {"n": 400, "length": 20.0, "EA": 1.0e9, "EJ": 10.0, "time_step": 0.005, "time_end": 1.0, "eps_energy": 1e-10}
"""Of a stiff rope's equations at a long step single precision keeps too few digits.

Whether steps are halved must not hang on what iterations leave, so they leave little: energies of
1e-10 J, as rounding allows no less, which are 3e-7 m where inertia alone resists, 0.05 kg over (5 ms)^2.
"""


def _swing(n, length, EA, EJ, **solver):
    """A slanted rope that is let go at its lower end."""
    xyz, p = straight((0.0, 0.0, 0.0), (0.6 * length, 0.0, -0.8 * length), n), np.linspace(0.0, length, n + 1)
    items = chain(xyz, p, {0: PINNED}, EA=EA, EJ=EJ)
    return simulate(model_of(items, plotpoints=10.0 / solver["time_end"], rho_inf=0.8, **solver))


@pytest.mark.parametrize(("scene", "serve", "left"), [(SOFT, True, 1e-10), (STIFF, False, 1e-9)], ids=["soft", "stiff"])
def test_a_run_with_single_precision_is_that_with_others_to_the_iterations_tolerance(scene, serve, left, monkeypatch):
    exact = _swing(**scene)
    made = []

    def noted(*args, **options):
        made.append(matrix.new_factors(*args, **options))
        return made[-1]

    monkeypatch.setattr(matrix, "MANY", 1)
    monkeypatch.setattr(newton, "new_factors", noted)
    rounded = _swing(**scene)
    assert made[-1].singles.size > 0
    # Where they do not serve they are found out within the run, and are double from then on.
    assert (made[-1].integers[matrix.SINGLE], made[-1].integers[matrix.MAY_BE_SINGLE]) == (int(serve), int(serve))
    size = np.abs(np.asarray(exact["position"])).max()
    np.testing.assert_allclose(rounded["position"], exact["position"], rtol=0.0, atol=left * size)
    assert rounded.attributes["newton_iterations"] <= 1.01 * exact.attributes["newton_iterations"]
