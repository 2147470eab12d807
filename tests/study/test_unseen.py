"""A look at a part of a run says what it has not seen."""

from pathlib import Path

import pytest
from study.oscillators import oscillator, subject

from crane.application import Crane
from drillstring.application import Drillstring
from tautline.study.trials.omissions import unseen
from tautline.study.trials.trial import Subject

DATA = Path(__file__).parents[2] / "data"


@pytest.mark.parametrize(
    ("application", "name", "end", "whole", "said"),
    [
        (Drillstring, "jwell", 4.0, 40.0, ["the first 4 s of 40 s", "period of", "changes its frequency", "contacts"]),
        (Crane, "hoist", 1.2, 12.0, ["the first 1.2 s of 12 s", "period of 8 s was seen"]),
    ],
)
def test_a_quick_look_names_the_time_and_the_events_that_it_has_not_seen(application, name, end, whole, said):
    scene = application().read(DATA / f"{name}.yaml")
    text = unseen(Subject(application(), scene, end=end, whole=whole))
    assert text.startswith("only ") and all(each in text for each in said)


def test_events_before_the_end_of_the_look_are_not_named():
    scene = Crane().read(DATA / "hoist.yaml")
    assert "changes at" not in unseen(Subject(Crane(), scene, end=11.0, whole=12.0))


def test_a_whole_run_leaves_nothing_unseen():
    assert unseen(subject(oscillator())) == ""
