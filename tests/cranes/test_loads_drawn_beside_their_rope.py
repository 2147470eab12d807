"""`check` tells, before anything runs, of a load that the static start moves far to below what it hangs from."""

import re

import pytest
from figures.synthetic_crane import HOOK, LOAD, TIP, WINCH, elevator, falls, one_fall

from crane.application import Crane
from crane.assembly.estimates import estimate
from crane.warnings.drawn_askew import drawn_askew
from tautline.results.assessment.start import FAR
from tautline.simulation import simulate


def said(scene):
    return list(drawn_askew(estimate(scene)))


def at(x, y=0.0, z=5.0, path=(WINCH, TIP, HOOK), load=None, **more):
    return one_fall(path=path, bodies=[LOAD | {"position": [x, y, z]} | (load or {})], **more)


@pytest.mark.parametrize(("x", "y", "off"), [(20.1, 0.0, "7.7 m"), (12.4, 9.0, "9 m"), (4.4, 0.0, "8 m")])
def test_a_load_far_from_its_plumb_line_is_told_by_how_much(x, y, off):
    """The rope leaves the sheave of 0.4 m at x = 12.4 m when it hangs plumb, wherever the load is drawn."""
    path = [WINCH, {"sheave": TIP["sheave"] | {"fleet_limit": "80 deg"}}, HOOK]
    ((key, text),) = said(at(x, y, path=path))
    assert key == "bodies[0].position" and f"payload is drawn {off} beside the plumb line below boom tip" in text


def test_a_load_at_the_other_end_of_the_path_and_one_at_an_anchor_are_told_alike():
    lifted = at(20.1, path=[HOOK, TIP, WINCH])
    assert "7.7 m beside the plumb line below boom tip" in said(lifted)[0][1]
    anchored = at(9.0, path=[{"anchor": {"name": "top", "position": [0, 0, 30]}}, HOOK])
    assert "9 m beside the plumb line below top" in said(anchored)[0][1]


def test_the_distance_told_is_the_one_by_which_the_start_moves_the_load():
    scene = at(20.1)
    ((_, text),) = said(scene)
    short = scene.replace({"solver.end": 0.005, "output.interval": 0.005})
    start = simulate(Crane().build(short)).attributes["start"]
    assert start["far"]
    assert float(re.findall(r"drawn ([0-9.]+) m beside", text)[0]) == pytest.approx(start["moved"], 0.001)


@pytest.mark.parametrize("x", [12.4, 14.0, 11.0])
def test_a_load_not_far_from_its_plumb_line_is_not_told(x):
    """A tenth of the scene, 30 m high here, is what a run warns of when it has moved the load."""
    assert FAR * 30.0 > abs(x - 12.4)
    assert said(at(x)) == []


@pytest.mark.parametrize(
    "more",
    [
        {"start": "as drawn"},
        {"load": {"force": [{"constant": 20000.0}, 0, 0]}},
        {"load": {"guide": ["x"]}},
        {"load": {"spring": {"stiffness": [1e5, 0, 0]}}},
    ],
)
def test_a_load_that_something_holds_aside_is_not_told(more):
    assert said(at(20.1, **more)) == []


def test_blocks_on_two_falls_and_masses_over_a_sheave_are_not_told():
    assert said(falls(2)) == said(elevator()) == []
