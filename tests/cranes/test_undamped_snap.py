"""Few elements tell the snap of a slack rope as it is where nothing is said of damping, and say so where it is 0."""

import pytest
from physics.lifting.crane_scenes import anchor, crane, parsed, ran
from physics.lifting.test_crane_slack import LENGTH, MASS, SPEED, STIFFNESS, dropped
from references.slack import snap_tension_green

from crane.assembly.layout import lay_out
from crane.warnings import figures, warnings
from tautline.scene.errors import SceneError

EXACT = snap_tension_green(MASS, STIFFNESS, LENGTH, SPEED)


def snapped(elements, damping):
    scene = dropped(1.0, elements, 0.0)
    if damping is None:
        del scene["rope"]["damping"]
    scene["rope"]["breaking_load"] = 1.2 * EXACT
    return ran(scene)


@pytest.mark.parametrize("elements", [2, 4, 8, 16])
def test_a_rope_whose_damping_is_not_given_snaps_as_the_closed_form_with_few_elements(elements):
    """Within 2 % of the massless rope's; without damping 4 elements are half as much again, and break the rope."""
    result = snapped(elements, None)
    assert result["tension"].max() == pytest.approx(EXACT, rel=0.02)
    assert result.headline["safety_factor"]["value"] > 1.15
    assert "undamped_snaps" not in result.headline


def test_a_heavy_rope_snaps_with_few_elements_as_a_fine_mesh_of_the_same_damping_does():
    """6.5 kg/m, where waves of the rope's own mass count: 442.3 kN with 4 elements, 445.4 kN with 32 and 64 and steps
    of 0.1 and 0.05 ms. The damping itself stays the rope's: 0.1 ms of it would be 475 kN, also with any mesh."""
    scene = dropped(6.5, 4, 0.0)
    del scene["rope"]["damping"]
    coarse = ran(scene)["tension"].max()
    damping = figures(parsed(scene))["damping"]
    assert damping["largest"] == pytest.approx(7.87e-4, rel=0.01) and not damping["given"]
    fine = dropped(6.5, 32, damping["largest"])
    fine["solver"]["step"] = 1e-4
    assert coarse == pytest.approx(ran(fine)["tension"].max(), rel=0.01)


def test_damping_of_nothing_is_told_before_and_after_a_run():
    scene = dropped(1.0, 4, 0.0)
    assert any(warning.where == "rope.damping" for warning in warnings(parsed(scene)))
    result = snapped(4, 0.0)
    assert result.headline["safety_factor"]["value"] < 1.0
    assert result.headline["undamped_snaps"]["value"] > 0


@pytest.mark.parametrize("share", [0.5, 0.9])
def test_a_rope_shorter_than_its_path_is_refused_with_both_lengths(share):
    path = [anchor((0.0, 0.0, 0.0), "one"), anchor((40.0, 0.0, 0.0), "two")]
    with pytest.raises(SceneError) as refused:
        lay_out(parsed(crane(path, rope={"length": 40.0 * share})))
    (problem,) = refused.value.problems
    assert problem.key == "rope.length" and problem.line is not None
    assert f"{40.0 * share:g} m" in problem.cause and "40 m" in problem.cause and "40 m or more" in problem.cure
    for length in (40.0, 40.0 * (1.0 - 1.0e-3), 50.0):
        lay_out(parsed(crane(path, rope={"length": length})))
