"""A figure that is rounding reads 0, and one that is merely small does not."""

import numpy as np
import pytest
from physics.wells.strings import shipped

from drillstring.model.build import build
from drillstring.warnings import figures
from tautline.results.assessment.rounding import unrounded, without_rounding
from tautline.simulation import simulate

EPS = np.finfo(float).eps
SIZE, STEP = 3000.0, 1e-3


def told(value, unit):
    headline = {"figure": {"value": value, "unit": unit, "text": "a figure"}}
    return without_rounding(headline, {"position": np.array([[0.0, -SIZE]])}, STEP)["figure"]["value"]


@pytest.mark.parametrize(("unit", "scale"), [("m", SIZE), ("m/s", SIZE / STEP)])
def test_lengths_and_speeds_within_the_rounding_of_their_coordinates_read_0_and_larger_ones_stay(unit, scale):
    for value in (EPS * scale, -EPS * scale, 0.0):
        assert told(value, unit) == 0.0
    for value in (100.0 * EPS * scale, -100.0 * EPS * scale):
        assert told(value, unit) == value


@pytest.mark.parametrize("value", [1e-300, 7, "limit cycle", None, True])
def test_other_figures_are_left_as_they_are(value):
    assert told(value, "N") == value and told(7, "m") == 7


def test_places_are_asked_for_only_where_a_figure_could_be_their_rounding():
    asked = []

    class Places(dict):
        def __getitem__(self, name):
            asked.append(name)
            return super().__getitem__(name)

    places = Places(position=np.array([[0.0, -SIZE]]))
    for value, known in ((0.3, []), (1e-15, ["position"])):
        headline = {
            "way": {"value": value, "unit": "m", "text": ""},
            "force": {"value": 1e-12, "unit": "N", "text": ""},
        }
        found = without_rounding(headline, places, STEP)
        assert asked == known and found["way"]["value"] == (value if value > 0.1 else 0.0)


def test_each_of_a_list_has_its_own():
    assert unrounded([1.0, 1e-15, -1e-3], 1.0) == [1.0, 0.0, -1e-3]


def test_a_string_that_hangs_still_has_no_speed_no_travel_and_no_loss_and_one_that_moves_a_nanometre_has():
    still = simulate(build(shipped("hanging", solver__end=0.5)))
    assert np.abs(still["bit_speed"]).max() > 0.0, "there is rounding to be taken away"
    figures = {name: figure["value"] for name, figure in still.headline.items()}
    assert figures["bit_speed_max"] == figures["bit_displacement"] == still.attributes["numerical_dissipation"] == 0.0
    assert figures["stretch_start"] == pytest.approx(0.376529, rel=1e-5)
    block = {"harmonic": {"amplitude": 1e-9, "period": 0.1, "ramp": 0.05}}
    moved = simulate(build(shipped("hanging", solver__end=0.5, top__block=block))).headline
    assert 1e-10 < moved["bit_displacement"]["value"] < 1e-8 and 1e-9 < moved["bit_speed_max"]["value"] < 1e-6


def test_a_well_towards_the_south_ends_0_m_east():
    assert figures(shipped("iscwsa"))["well"]["east"] == 0.0
