"""Steps whose iteration leaves what it seeks: they are divided before an element comes to rest folded."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.race.scenes import CATENARY, cases, text
from tautline.cable.input.scene import parse
from tautline.cable.model.build import build
from tautline.simulation import simulate

HANGING = CATENARY["rhoA"] * 9.81 * 110.0 / CATENARY["EA"]
"""Strain under the weight of the whole rope: 5.4e-4. Each run below stretches it by at most three times that."""


def rope(elements: int, step: float, tolerance: float, end: float = 2.0) -> str:
    """110 m over a span of 100 m, one end moved to and fro by 1 m within 2 s; a wave passes a rope in 80 ms."""
    one = next(case for case in cases(False) if case.scene == "catenary")
    return text(replace(one, elements=elements, step=step, tolerance=tolerance), end, 0.1)


def strains(result, elements: int) -> np.ndarray:
    chords = np.linalg.norm(np.diff(result["position"], axis=1), axis=2)
    return chords * elements / 110.0 - 1.0


@pytest.mark.parametrize(
    ("elements", "step", "tolerance"), [(100, 0.03, 0.1), (200, 0.02, 0.2), (200, 0.02, 0.09), (300, 0.02, 0.15)]
)
def test_long_steps_of_a_stiff_rope_do_not_fold_its_elements(elements, step, tolerance):
    """Without the bound the first two end by themselves at 1.4 and 1.2 s, with elements stretched by a half."""
    result = simulate(build(parse(rope(elements, step, tolerance))))
    assert result.attributes["status"] == "done"
    assert np.abs(strains(result, elements)).max() < 3.0 * HANGING


def test_a_step_that_may_not_be_divided_is_iterated_to_its_end():
    """Nothing else is left to try, and a residual that rises may come back: in this run it does."""
    model = build(parse(rope(1000, 0.01, 0.1, end=0.1)))
    divided = simulate(model)
    whole = simulate(replace(model, solver=replace(model.solver, max_halvings=0)))
    assert divided.attributes["halvings"] > 0
    assert whole.attributes["status"] == "done" and whole.attributes["halvings"] == 0
    assert np.abs(strains(whole, 1000)).max() < 3.0 * HANGING
