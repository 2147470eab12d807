"""Shipped drill strings end where they did when each lump was computed by itself: lanes change rounding alone.

``tests/references/strings_one_by_one.json`` holds the last frames of the code before lanes (commit 80847d9), with
the law of friction of today. It went from lump to lump with libm's sine and cosine and solved row by row. Position m,
velocity m/s, tension and contact force N.
"""

import json
from pathlib import Path

import numpy as np
import pytest

import tautline

ROOT = Path(__file__).parents[2]
REFERENCE = json.loads((ROOT / "tests" / "references" / "strings_one_by_one.json").read_text(encoding="utf8"))
WITHIN = {"position": 1e-9, "velocity": 1e-7, "tension": 1e-3, "contact_force": 1e-3}
"""Rounding of coordinates of kilometres and forces of meganewtons, after as many steps; m, m/s, N, N."""


@pytest.mark.parametrize("case", REFERENCE)
def test_a_string_ends_where_it_did_lump_by_lump(case):
    one = REFERENCE[case]
    scene = tautline.read(ROOT / "data" / f"{one['scene']}.yaml")
    result = tautline.simulate(scene.replace(one["keys"] | {"output.interval": one["keys"]["solver.end"]}))
    for name, within in WITHIN.items():
        if name in one:
            np.testing.assert_allclose(result[name][-1], one[name], rtol=1e-9, atol=within, err_msg=name)


def test_a_sweep_gives_every_string_what_it_gets_alone_to_the_bit():
    scene = tautline.read(ROOT / "data" / "jwell.yaml").replace({"solver.end": 1.0})
    factors = [0.22, 0.26, 0.3]
    figures = ("hook_load_min", "contact_force_max")
    data = tautline.sweep(scene, {"well.wall.friction.static": factors}, collect=figures, jobs=2)
    for i, static in enumerate(factors):
        alone = tautline.simulate(scene.replace({"well.wall.friction.static": static}))
        assert data["hook_load_min"].values[i] == alone["hook_load"].min()
        assert data["contact_force_max"].values[i] == alone["contact_force"].max()
