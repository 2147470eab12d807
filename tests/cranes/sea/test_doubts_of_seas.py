"""Seas that no waves make, and phases of responses that can be read in two ways, are told before a run."""

from __future__ import annotations

import math

import pytest
from storms.test_operability import SCENE

import tautline
from crane.application import Crane
from crane.sea.sea_doubts import doubts_of_phases
from crane.sea.vessel import read_response


def told(**sea):
    scene = tautline.read(SCENE).replace({f"vessel.motion.heave.spectrum.{key}": value for key, value in sea.items()})
    return {one.where.rpartition(".")[2]: one.text for one in Crane().warnings(scene) if "spectrum" in one.where}


def test_waves_that_are_steeper_than_waves_can_be_are_told_with_the_highest():
    # DNV-RP-C205, 3.5.4: 1/15 up to 8 s.
    most = 9.81 * 4.0**2 / (2.0 * math.pi) / 15.0
    found = told(significant_height=12.0, peak_period=4.0)
    assert list(found) == ["significant_height"] and f"are {most:.3g} m high at most" in found["significant_height"]
    assert told(significant_height=0.999 * most, peak_period=4.0) == {}


@pytest.mark.parametrize(("components", "doubtful"), [(1, True), (3, True), (200, False)])
def test_a_sea_of_next_to_no_components_is_told(components, doubtful):
    found = told(components=components)
    assert list(found) == (["components"] if doubtful else [])
    # One sine has the energy of one wave, whatever the spectrum.
    assert components > 1 or "no more than 1 if all were of one size" in found["components"]


@pytest.mark.parametrize(
    ("phases", "between"),
    [
        # Written out beyond a turn: -90 to -300 and -300 to -700 are more than half a turn.
        ((0, -90, -300, -700, -700), "from -90 to -300 deg between 0.8 and 1.2 rad/s"),
        # Wrapped, and so far apart that either way may be meant.
        ((0, 90, -110, -120, -120), "from 90 to -110 deg between 0.8 and 1.2 rad/s"),
        # Wrapped where the sign changes, or at zero; written out in small steps but for a row without a response.
        ((160, 175, -170, -140, -140), ""), ((20, 5, 355, 340, 340), ""), ((0, -140, -280, -420, -820), ""),
    ],
)  # fmt: skip
def test_a_phase_that_may_go_either_way_between_two_rows_is_told(phases, between, tmp_path):
    found = doubts(phases, tmp_path)
    assert (len(found) == 1 and f"phase of heave goes {between}" in found[0]) if between else found == []


def doubts(phases, folder, sizes=(1.0, 0.9, 0.8, 0.3, 0.0)):
    place = folder / "rao.csv"
    rows = [f"{w},{size},{phase}\n" for w, size, phase in zip((0.4, 0.8, 1.2, 2.0, 6.0), sizes, phases, strict=True)]
    place.write_text("".join(["frequency [rad/s],heave [m/m],heave phase [deg]\n", *rows]))
    return list(doubts_of_phases(read_response(place)))


@pytest.mark.parametrize(
    ("phases", "words", "not_said"),
    [
        # A heave that goes through zero and changes its sign.
        ((0, 0, 180, 180, 180), ("half a turn: both ways are as long", "a row with the amplitude 0"), "short way"),
        ((90, 90, -90, -90, -90), ("half a turn: both ways are as long", "a row with the amplitude 0"), "short way"),
        # The same phase, written a turn apart.
        ((700, 710, 350, 360, 0), ("a whole turn, and is taken as no step", "within one turn"), "short way"),
        ((0, -90, -300, -700, -700), ("the short way, by 150 deg", "or write the phases within one turn"), "half"),
        ((0, 90, -110, -120, -120), ("the short way, by 160 deg", "Add rows"), "within one turn"),
    ],
)  # fmt: skip
def test_what_a_doubtful_phase_is_taken_as_and_the_cure_are_those_of_its_step(phases, words, not_said, tmp_path):
    (text,) = doubts(phases, tmp_path)
    assert all(word in text for word in words) and not_said not in text


def test_a_null_with_a_row_of_its_own_and_a_step_of_150_deg_are_not_doubtful(tmp_path):
    assert doubts((0, 90, 180, 180, 180), tmp_path, (1.0, 0.0, 0.8, 0.3, 0.0)) == []
    # -100 to -250 deg is 150 deg and a rounding more, in radians.
    assert doubts((0, -100, -250, -320, -350), tmp_path) == []
