"""Which stretches of buckling the summary of torque-drag names, and which titles of measured loads are read."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from drillstring.modes.bha import _check
from drillstring.scene.scene import LUMPED
from drillstring.statics.back_calculation import Fit, read_measured
from drillstring.view.torque_summary import _long_enough, _spans, _without, fit_in_words
from tautline.scene.errors import SceneError


def test_a_sine_that_is_no_helix_is_told_beside_the_helix():
    sine, helix = [(0.0, 800.0), (1461.0, 2960.0)], [(0.0, 800.0), (1461.0, 2102.0)]
    assert _without(sine, helix) == [(2102.0, 2960.0)]
    assert _without([(0.0, 100.0)], [(20.0, 30.0), (50.0, 60.0)]) == [(0.0, 20.0), (30.0, 50.0), (60.0, 100.0)]


def test_what_is_left_of_a_sine_beside_a_helix_is_told_where_its_ends_are_printed_as_two_numbers():
    left = _without([(674.23, 726.58), (913.38, 990.0)], [(913.42, 990.0)])
    assert _spans(_long_enough(left, "metric"), "metric") == "674.2 m to 726.6 m"
    # 0.04 m are 0.13 ft: 2996.7 and 2996.8 ft are both printed as 2997 ft
    assert _spans(_long_enough(left, "field"), "field") == "2212 ft to 2384 ft"
    assert _long_enough([(913.38, 913.52)], "metric") == [(913.38, 913.52)]


def test_no_stretch_is_left_out_without_a_word():
    places = [(100.0 * k, 100.0 * k + 10.0 + k) for k in range(10)]
    told = _spans(places, "metric")
    assert told.count(" to ") == 8 + 1 and "and 2 shorter ones, down to 919 m in all" in told
    assert _spans(places[:5], "metric").count(" to ") == 5


@pytest.mark.parametrize(
    "titles",
    [
        "pick up [kN],Slack-off [kN]",
        "PU [kN],SO [kN]",
        "Pick-up weight [kN],slack_off_weight [kN]",
        "PU Weight [kN],SO [kN]",
        "pu_weight [kN],SO Weight [kN]",
    ],
)
def test_a_hyphen_or_a_short_name_does_not_lose_half_of_the_measured_loads(tmp_path, titles):
    path = tmp_path / "loads.csv"
    path.write_text(f"depth [m],{titles}\n3000,830,380\n3381,952,384\n")
    found = read_measured(path)
    assert found.unused == () and np.array_equal(found.slack_off, [380e3, 384e3])
    assert np.array_equal(found.pick_up, [830e3, 952e3])


@pytest.mark.parametrize(("why", "offered"), [("", False), (" for bending waves of 3 Hz", True)])
def test_a_depth_to_begin_at_is_offered_for_bending_waves_alone(why, offered):
    """`campbell --modes axial,torsional` proposed `--from`, and refused it then."""
    scene = SimpleNamespace(model=SimpleNamespace(kind=LUMPED), string=[None] * 4)
    with pytest.raises(SceneError) as error:
        _check(scene, 100_000, why)
    assert ("--from" in str(error.value)) is offered and "--up-to" in str(error.value)


def test_as_many_loads_as_factors_are_not_told_as_a_perfect_fit():
    fitted = Fit(0.3, math.nan, 5.9e-9, math.nan, math.nan, 2, 0.2, math.nan, (), 0.013, 0.017)
    told = fit_in_words(fitted)
    assert "as many loads as factors" in told and "rms" not in told
