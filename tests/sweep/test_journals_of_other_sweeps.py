"""What makes the journal in a folder that of another sweep, told where it is gone on with."""

import pytest

from tautline.results.errors import ResultError
from tautline.sweeps.cases import Row
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
        ({}, "its scene, of which the title counts too, or the order of the keys under `vary`, is another one"),
    ],
)  # fmt: skip
def test_going_on_with_another_sweep_names_the_key_in_which_it_differs(tmp_path, change, words):
    folder = tmp_path / "out"
    first = Journal(folder, "one", 2, False, about=ABOUT)
    first.claim()
    first.begin()
    first.close()
    with pytest.raises(ResultError) as told:
        Journal(folder, "other", 2, True, about=ABOUT | change)
    assert f"belongs to another sweep: {words}" in str(told.value)


@pytest.mark.parametrize("done", [1, 2])
def test_the_cure_of_a_resumed_sweep_that_is_another_one_is_not_refused_itself(tmp_path, done):
    """Leaving out --resume is told only where no finished case of an unfinished sweep would be lost by it."""
    folder = tmp_path / "out"
    first = Journal(folder, "one", 2, False, about=ABOUT)
    first.claim()
    first.begin()
    for k in range(done):
        first.add(Row(k, "done", values={}))
    first.close()
    with pytest.raises(ResultError) as told:
        Journal(folder, "other", 2, True, about=ABOUT | {"collect": ["max_tension"]})
    finished = done == 2
    assert ("leave out --resume" in str(told.value)) == finished
    assert ("go on with the sweep as it was" in str(told.value)) != finished
    if finished:
        Journal(folder, "other", 2, False, about=ABOUT)
        return
    with pytest.raises(ResultError) as lost:
        Journal(folder, "other", 2, False, about=ABOUT)
    # Of one that goes on it is not known that it can: what is typed has to be the same sweep.
    assert "they would be lost; go on with --resume" not in str(lost.value)
    assert "put the sweep back as it was and go on with --resume" in str(lost.value)
    with pytest.raises(ResultError, match="go on with --resume, or name another folder"):
        Journal(folder, "one", 2, False, about=ABOUT)
