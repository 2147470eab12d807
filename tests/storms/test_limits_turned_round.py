"""A limit with its sign turned round, or a percentile that is, allows all seas or none: the command says so."""

from __future__ import annotations

import math

import pytest
from storms.test_operability import ALONE, application, asked, scene  # noqa: F401

from crane.operability.criteria import read_criteria, reversed_notes
from crane.operability.storms import operability, share_notes
from crane.verbs.operability_options import _headings

FIGURES = {
    "min_tension": "N",
    "max_tension": "N",
    "safety_factor": "",
    "max_rise": "m",
    "longest_slack": "s",
    "rise": "m",
}


@pytest.mark.parametrize(
    ("text", "meant", "kind"),
    [
        ("min_tension < 60 kN", "min_tension > 60 kN", "smallest"),
        ("max_tension > 60 kN", "max_tension < 60 kN", "largest"),
        ("max_tension >= 60 kN", "max_tension <= 60 kN", "largest"),
        ("safety_factor < 3", "safety_factor > 3", "smallest"),
        ("longest_slack > 1 s", "longest_slack < 1 s", "largest"),
    ],
)
def test_a_limit_that_wants_a_largest_value_large_or_a_smallest_small_is_told_with_what_was_probably_meant(
    text, meant, kind
):
    (told,) = reversed_notes(read_criteria([text], FIGURES, {}))
    assert told.startswith(f"--limit '{text}'") and f"the {kind} of a storm" in told and f"Was '{meant}' meant?" in told


@pytest.mark.parametrize(
    "texts",
    [
        ["min_tension > 5 kN"], ["max_tension < 60 kN"], ["rise > 1 m"], ["rise < 1 m"],
        # Both sides of one figure are a window, and meant.
        ["min_tension > 5 kN", "min_tension < 60 kN"],
    ],
)  # fmt: skip
def test_a_limit_the_right_way_round_is_not_told(texts):
    assert reversed_notes(read_criteria(texts, FIGURES, {})) == []


@pytest.mark.parametrize(
    ("share", "compared", "text", "said"),
    [
        (
            0.1,
            "percentile",
            "min_tension > 30 kN",
            "P10: in a sea that is allowed 90 % of the storms may pass the limit",
        ),
        (0.25, "percentile", "max_tension < 60 kN", "P25: in a sea that is allowed 75 % of the storms may pass"),
        (0.5, "percentile", "min_tension > 30 kN", ""),
        (0.9, "percentile", "min_tension > 30 kN", ""),
        (0.1, "most_probable", "min_tension > 30 kN", ""),
    ],
)
def test_a_percentile_below_half_is_told_with_the_share_of_storms_that_may_pass_the_limit(share, compared, text, said):
    given = asked().__class__(**{**vars(asked()), "share": share, "compared": compared})
    criteria = read_criteria([text], FIGURES, {})
    told = share_notes(given, criteria)
    assert (len(told) == 1 and said in told[0]) if said else told == []
    assert not told or ("P10 of the smallest is what P90 compares" in told[0]) == text.startswith("min")
    assert share_notes(given, []) == []


def test_both_are_warnings_of_the_command_and_said_before_anything_runs(application, scene):  # noqa: F811
    given = asked((0.3,), 3, 10.0, limits=["min_tension < 60 kN"])
    given = given.__class__(**{**vars(given), "share": 0.1})
    found = operability(application, scene, given, ALONE)
    assert [text.split()[0] for text in found.warnings[-2:]] == ["--limit", "--percentile"]


@pytest.mark.parametrize(
    ("text", "degrees"),
    [
        ("0,360,90", [0.0, 90.0]), ("0,360,-360", [0.0]), ("-90,270", [-90.0]),
        ("450,90 deg,1.5707963267948966 rad", [90.0]),
        ("180,-180,540", [180.0]), ("0,90,180,270", [0.0, 90.0, 180.0, 270.0]), ("0.1,0.2", [0.1, 0.2]),
    ],
)  # fmt: skip
def test_headings_that_differ_by_whole_turns_are_one_and_count_once(text, degrees):
    assert [math.degrees(angle) for angle in _headings(text)] == pytest.approx(degrees, abs=1e-9)
