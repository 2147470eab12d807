"""Ropes without bending stiffness that supports keep in a plane: no support bends them there, so none is told."""

import numpy as np
import pytest
from physics.cables.rope_text import GRAVITY, chain, model_of, scene
from scipy.optimize import brentq

import tautline.cable.warnings  # noqa: F401  (its warnings are registered)
from tautline.cable.input.scene import parse
from tautline.scene.warnings import warnings_of
from tautline.simulation import simulate

SPAN, ROPE, MASS, N = 20.0, 25.0, 2.0, 12
A = brentq(lambda a: 2 * a * np.sinh(0.5 * SPAN / a) - ROPE, 1.0, 100.0)
BOTH, PLACE = (0, 1, 0, 0, 1, 0, 1), (0, 1, 0, 0, 0, 0, 1)


def hanging(inner, aside=0.0, special=None):
    """Items of a rope in the plane of x and z; ``inner`` is the BC of nodes between its ends, ``aside`` m of node 6."""
    p = np.linspace(0.0, ROPE, N + 1)
    x = A * np.arcsinh((p - 0.5 * ROPE) / A)
    xyz = np.column_stack([x, 0.0 * x, A * np.cosh(x / A)])
    slopes = np.gradient(xyz, p, axis=0, edge_order=2)
    xyz[6, 1] = aside
    ends = dict.fromkeys((0, N), (1, 1, 1, 0, 0, 0, 1))
    held = dict.fromkeys(range(1, N), inner) | ends | (special or {})
    return chain(xyz, p, held, slopes=slopes, EA=1e7, rhoA=MASS)


def corners(items, **solver):
    made = parse(scene(items, **solver))
    return [one.text for one in warnings_of("cable", made) if "has a corner" in one.text]


@pytest.mark.parametrize("inner", [BOTH, PLACE], ids=["places and slopes", "places"])
def test_a_catenary_that_is_kept_in_its_plane_has_its_tension_and_no_corner_is_told(inner):
    items = hanging(inner)
    assert corners(items) == []
    result = simulate(model_of(items, start="static"))
    # measured 1.6e-3, as of a rope that nothing keeps there
    assert np.asarray(result["axial_force"])[0, 5:7].mean() == pytest.approx(MASS * GRAVITY * A, rel=2.5e-3)


@pytest.mark.parametrize(
    ("items", "gravity"),
    [
        (hanging(BOTH, special={6: (0, 1, 1, 0, 1, 0, 1)}), (0, 0, -GRAVITY)),
        (hanging(PLACE), (0, -1.0, -GRAVITY)),
        (hanging(PLACE, aside=1.0), (0, 0, -GRAVITY)),
        (hanging((0,) * 6 + (1,), special={6: PLACE}), (0, 0, -GRAVITY)),
    ],
    ids=["a support in the plane", "weight across the plane", "one stands out of it", "a single support"],
)
def test_a_support_that_bears_on_the_rope_is_told_in_a_plane_too(items, gravity):
    (text,) = corners(items, gravity=gravity)
    assert "share the slope of node " in text


def stretched(middle=(1, 1, 1), slopes=(0, 1, 1), **special):
    """Items and material coordinates of a rope of 2 m on the x axis, guided everywhere, supported in its middle."""
    n = 10
    p = np.linspace(0.0, 2.0, 2 * n + 1)
    held = {i: (int(i in (0, 2 * n)), 1, 1, *slopes, 1) for i in range(2 * n + 1)} | {n: (*middle, *slopes, 1)}
    xyz = np.column_stack([p, 0.0 * p, 0.0 * p])
    return chain(xyz, p, held, slopes=np.tile([1.0, 0.0, 0.0], (2 * n + 1, 1)), EA=1e4, rhoA=1.0, **special)


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ({}, True),
        ({"middle": (0, 1, 1)}, False),
        ({"slopes": (1, 1, 1)}, True),
        ({"EJ": 1.0}, False),
    ],
    ids=["held along the rope", "a guide across the rope", "its slope held too", "bending"],
)
def test_a_node_that_is_held_along_the_rope_is_told_of_though_its_slopes_are_held(asked, told):
    texts = corners(stretched(**asked), gravity=(0, 0, 0))
    assert bool(texts) is told
    if told:
        assert "may be off by a tenth, or more" in texts[0] and "use linear elements (nodes4)" in texts[0]
