"""What makes the journal in a folder that of another sweep, told where it is gone on with."""

import pytest

from tautline.results.errors import ResultError
from tautline.sweeps.journal import Journal

ABOUT = {
    "vary": {"path.mass": [1.0, 2.0]}, "plan": {"sobol": {"samples": 8, "seed": 1}},
    "collect": ["max_tension", {"output": "load.position[2]", "statistic": "range"}],
}  # fmt: skip


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"collect": ["max_tension"]}, "`collect` had load.position[2] range"),
        ({"collect": [*ABOUT["collect"], "min_tension"]}, "`collect` now has min_tension"),
        ({"collect": ABOUT["collect"][::-1]}, "`collect` has another order"),
        ({"plan": {"sobol": {"samples": 16, "seed": 1}}}, "in `plan`, in `sobol`, `samples` was 8 and is 16"),
        ({"vary": {"path.mass": [1.0, 3.0]}}, "in `vary`, `path.mass` had 2.0 and now has 3.0"),
        ({"indices": "sobol"}, "`indices` was not given and is sobol"),
        ({}, "its scene, or the order of the keys under `vary`, is another one"),
    ],
)  # fmt: skip
def test_going_on_with_another_sweep_names_the_key_in_which_it_differs(tmp_path, change, words):
    folder = tmp_path / "out"
    Journal(folder, "one", 2, False, about=ABOUT).begin(False)
    with pytest.raises(ResultError) as told:
        Journal(folder, "other", 2, True, about=ABOUT | change)
    assert f"belongs to another sweep: {words}" in str(told.value)
