"""What moves and carries nothing of the rope is told: its motion changes no run, and no sea may be judged by it."""

import pytest
from figures.synthetic_crane import HOOK, LOAD, TIP, WINCH, one_fall

from crane.operability.conditions import sea_keys
from crane.scene.carried import idle
from crane.warnings import warnings
from tautline.scene.errors import SceneError

LUFFED = {"ramp": {"to": 0.1, "over": 2.0}}
BOOM = {"name": "boom", "pivot": [0, 0, 0], "luff": LUFFED}
SEA = {"spectrum": {"significant_height": 1.0, "peak_period": 8.0, "ramp": 2.0}}
AFLOAT = {"reference": [0, 0, 0], "motion": {"heave": SEA}}


def mounted(frame, **more):
    """A fall whose winch and boom tip are said to ride on a frame."""
    winch, tip = ({kind: item[kind] | {"frame": frame}} for item, kind in ((WINCH, "drum"), (TIP, "sheave")))
    return one_fall(path=[winch, tip, HOOK], bodies=[LOAD], **more)


def keys(scene):
    return [key for key, _ in idle(scene)]


def test_a_boom_that_luffs_and_carries_nothing_is_told_with_what_to_write():
    bare = one_fall(frames=[BOOM])
    ((key, text),) = idle(bare)
    assert key == "frames[0]" and "rides on boom." in text and "Write frame: boom at winch and boom tip" in text
    assert (key, text) in [(one.where, one.text) for one in warnings(bare)]
    assert keys(mounted("boom", frames=[BOOM])) == []
    assert keys(one_fall(frames=[BOOM | {"luff": 0}])) == [], "a boom that is still does nothing, and is to do nothing"


def test_a_vessel_that_moves_and_carries_nothing_is_told_and_one_that_is_still_is_not():
    ((key, text),) = idle(mounted("ground", vessel=AFLOAT))
    assert key == "vessel" and "Write frame: vessel at winch and boom tip" in text
    assert keys(one_fall(vessel=AFLOAT)) == []
    assert keys(mounted("ground", vessel={"reference": [0, 0, 0]})) == []


def test_what_is_turned_for_good_is_not_said_to_move():
    """It was told with "moves" as well, and stands still: what is said of it is that it is turned for nothing."""
    turned = [*idle(one_fall(frames=[BOOM | {"luff": {"constant": 0.5}}]))]
    heeled = [*idle(mounted("ground", vessel=AFLOAT | {"motion": {"roll": {"constant": 0.05}}}))]
    for (key, text), where in zip(turned + heeled, ("frames[0]", "vessel"), strict=True):
        assert key == where and " moves," not in text and "How it is turned or moved changes nothing" in text


def test_what_rides_on_a_frame_rides_on_all_that_the_frame_stands_on():
    standing = [BOOM | {"name": "jib", "parent": "boom"}, BOOM]
    assert keys(mounted("jib", frames=standing, vessel=AFLOAT)) == []
    assert keys(mounted("boom", frames=standing, vessel=AFLOAT)) == ["frames[0]"]


def test_of_frames_that_stand_on_each_other_the_outermost_is_told_alone():
    """To mount the path there cures the others as well."""
    standing = [BOOM, BOOM | {"name": "jib", "parent": "boom"}]
    assert keys(mounted("ground", frames=standing, vessel=AFLOAT)) == ["frames[1]"]


def test_operability_refuses_a_sea_that_moves_nothing():
    """All its storms were one, and the highest sea was allowed."""
    ashore = mounted("boom", frames=[{"name": "boom", "pivot": [0, 0, 0], "parent": "ground"}], vessel=AFLOAT)
    with pytest.raises(SceneError, match=r"vessel: .* the sea moves nothing; write parent: vessel at boom"):
        sea_keys(ashore, False)
    with pytest.raises(SceneError, match="write frame: vessel at winch and boom tip"):
        sea_keys(mounted("ground", vessel=AFLOAT), False)
    assert sea_keys(one_fall(vessel=AFLOAT), False).spectra == ("vessel.motion.heave.spectrum",)
