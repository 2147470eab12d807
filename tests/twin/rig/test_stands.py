"""The scene of a string that has grown by a stand."""

from pathlib import Path

import numpy as np
import pytest

import tautline
from drillstring.model.prepared import prepared, well_of
from drillstring.twin.stands import bit_depth, with_stand
from tautline.scene.errors import SceneError

DATA = Path(__file__).parents[3] / "data"


def tubes(scene):
    return {tube.name: tube.length for tube in prepared(scene).lumps.tubes}


@pytest.mark.parametrize("name", ["drilling", "field_well"])
def test_a_stand_lengthens_the_pipe_at_the_top_and_the_hole_and_nothing_else(name):
    scene = tautline.read(DATA / f"{name}.yaml")
    grown = with_stand(scene, 28.5)
    before, after = tubes(scene), tubes(grown)
    first = next(iter(before))
    assert after.pop(first) == pytest.approx(before.pop(first) + 28.5, rel=1e-12)
    assert after == pytest.approx(before, rel=1e-12)
    assert well_of(grown).length == pytest.approx(well_of(scene).length + 28.5, rel=1e-12)
    end = well_of(scene).length
    assert np.allclose(well_of(grown).position(0.7 * end), well_of(scene).position(0.7 * end), rtol=0, atol=1e-9)
    for key in ("title", "gravity", "material", "mud", "damping", "top", "bit", "model", "start", "solver", "output"):
        assert getattr(grown, key) == getattr(scene, key)
    assert grown.well.wall == scene.well.wall


def test_the_string_weighs_more_by_the_buoyed_weight_of_the_stand():
    scene = tautline.read(DATA / "drilling.yaml")
    added = 28.5
    hanging = {"bit.on_bottom": False, "top.rotation": 0.0, "top.block": 0.0}
    loads = [tautline.Simulation(one.replace(hanging))["top.hook_load"] for one in (scene, with_stand(scene, added))]
    # A metre of the pipe weighs its mass, with tool joints, less the mud that its steel displaces.
    mass = next(iter(prepared(scene).lumps.tubes)).mass_per_length
    assert loads[1] - loads[0] == pytest.approx(mass * (1.0 - 1200.0 / 7850.0) * 9.81 * added, rel=1e-3)


def test_a_string_that_ends_above_the_bottom_goes_down_in_the_hole_there_is_and_comes_out_again():
    scene = tautline.read(DATA / "jwell.yaml").replace({"string[0].length": 2500.0})
    deeper = with_stand(scene, 29.0)
    assert bit_depth(deeper) == pytest.approx(2769.0) and deeper.well.sections == scene.well.sections
    assert bit_depth(with_stand(deeper, -29.0)) == pytest.approx(2740.0)


def test_a_stand_beyond_the_survey_or_beyond_an_arc_is_refused_with_the_cure(tmp_path):
    (tmp_path / "survey.csv").write_text("md [m],inc [deg],azi [deg]\n0,0,0\n400,0,0\n800,20,30\n1020,35,30\n")
    text = (DATA / "drilling.yaml").read_text().replace("  sections:\n    - {hold: 3000 m}\n", "  survey: survey.csv\n")
    (tmp_path / "surveyed.yaml").write_text(text)
    surveyed = tautline.read(tmp_path / "surveyed.yaml")
    shorter = surveyed.replace({"string[0].length": 700.0})
    assert bit_depth(with_stand(shorter, 28.0)) == pytest.approx(998.0)
    with pytest.raises(SceneError, match=r"well.survey.*ends at 1020 m, and the bit would be at 1026 m.*add"):
        with_stand(with_stand(shorter, 28.0), 28.0)
    with pytest.raises(SceneError, match=r"well.sections\[1\].*ends in an arc.*add what is planned"):
        with_stand(tautline.read(DATA / "jwell.yaml"), 28.0)
    with pytest.raises(SceneError, match="lay down less"):
        with_stand(shorter, -701.0)
