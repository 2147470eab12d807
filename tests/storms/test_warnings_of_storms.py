"""`operability` judges the seas that it runs, and not the sea of the scene, whose height and direction it replaces."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from storms.test_operability import SCENE, asked

import tautline
from crane.application import Crane
from crane.operability.conditions import Condition, sea_keys, sea_notes
from crane.operability.storms import warnings_of_storms

HEADS, BEAM = 0.0, math.radians(90.0)
MOTION = """\
  motion: {sea: {significant_height: 1 m, peak_period: 8 s, components: 600}, rao: rao.csv, direction: 0 deg}
solver:"""


@pytest.fixture
def at_sea(tmp_path):
    """A scene whose responses are in doubt in beam seas alone, and which has head seas itself."""
    phases = {0: (-1, -6, -13, -22, -140), 90: (-1, -3, -187, -13, -80)}
    rows = [
        f"{w},{direction},{size},{phase}\n"
        for direction, column in phases.items()
        for w, size, phase in zip((0.2, 0.4, 0.6, 0.8, 4.0), (0.9, 0.8, 0.7, 0.6, 0.1), column, strict=True)
    ]
    head = "frequency [rad/s],direction [deg],heave [m/m],heave phase [deg]\n"
    (tmp_path / "rao.csv").write_text("".join([head, *rows]))
    place = tmp_path / "at_sea.yaml"
    before, after = SCENE.index("  motion:"), SCENE.index("solver:") + len("solver:")
    place.write_text(SCENE[:before] + MOTION + SCENE[after:])
    return Crane().read(place)


def told(scene, *each):
    """Warnings of the sea and of the responses to it, for each list of sea states."""
    of_scene = Crane().warnings(scene)
    found = [warnings_of_storms(of_scene, scene, replace(asked(), conditions=conditions)) for conditions in each]
    others = [one for one in of_scene if "motion." not in one.where]
    assert all([one for one in texts if "motion." not in one.where] == others for texts in found)
    return [[one for one in texts if "motion." in one.where] for texts in found]


def test_phases_are_judged_in_the_headings_that_run_and_in_no_others(at_sea):
    heads, beam, own = (Condition(1.0, 8.0, heading) for heading in (HEADS, BEAM, None))
    no_waves = Condition(20.0, 8.0, BEAM)
    in_beam, *sound = told(at_sea, [heads, beam, Condition(2.0, 8.0, BEAM)], [heads], [own], [heads, no_waves])
    assert sound == [[], [], []], "waves that cannot be are not run"
    (found,) = in_beam
    line = next(k for k, row in enumerate(SCENE.splitlines(), 1) if row.startswith("  motion:"))
    assert (found.where, found.line) == ("vessel.motion.rao", line)
    assert "phase of heave at direction 90 deg goes from -3 to -187 deg" in found.text
    of_beam = at_sea.replace({"vessel.motion.direction": "90 deg"})
    in_heads, (as_it_is,) = told(of_beam, [heads], [own])
    assert in_heads == [] and as_it_is.text == found.text, "the scene's own direction runs where none is given"


def test_the_steepness_of_a_sea_that_is_replaced_is_not_told(at_sea):
    steep = at_sea.replace({"vessel.motion.sea.significant_height": 7.0})
    assert "vessel.motion.sea.significant_height" in [one.where for one in Crane().warnings(steep)]
    assert told(steep, [Condition(1.0, 8.0, None)]) == [[]]


@pytest.mark.parametrize(("components", "words"), [(20, None), (40, "some 7 to 25"), (200, "a few"), (600, None)])
def test_what_few_components_do_to_the_largest_is_said_once_and_by_their_number(components, words):
    """A sum of n equal sines is sqrt(2 n) deviations at most, and a Gaussian sea of 1350 waves has 3.8 in the mean."""
    scene = tautline.read(SCENE).replace({"vessel.motion.heave.spectrum.components": components})
    notes = [one for one in sea_notes(scene, sea_keys(scene, False)) if "too few components" in one]
    warned = [one for one in told(scene, [Condition(1.0, 8.0, None)])[0] if one.where.endswith("components")]
    assert len(notes) == (words is not None) and all(f"is {words} per cent too low" in one for one in notes)
    assert len(warned) == (components == 20)
