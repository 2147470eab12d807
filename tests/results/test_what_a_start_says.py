"""What a run says of its start is the same wherever its scene lies, and in what goes on from it or is a copy of it."""

from pathlib import Path

import numpy as np
import pytest
from physics.cables.rope_text import PINNED, chain, scene

import tautline
from tautline.results.assessment.start import Start, size_of, static_start
from tautline.results.result import Result

DATA = Path(__file__).parents[2] / "data"
SPAN, LENGTH = 80.0, 120.0


def sagging(at=(0.0, 0.0, 0.0), end=0.1):
    """120 m of rope over a level span of 80 m, drawn as a straight strut: its middle hangs 40 m lower."""
    x = np.linspace(0.0, 1.0, 21)
    xyz = np.outer(SPAN * x, [1.0, 0.0, 0.0]) + np.array(at)
    items = chain(xyz, LENGTH * x, {0: PINNED, 20: PINNED}, EA=2.0e7, rhoA=3.7, strain="engineering", linear=True)
    return scene(items, start="static", time_step=0.01, time_end=end, plotpoints=10)


def column(end=0.1):
    """Five metres that stand upright, w L^3 / EJ = 12.3 where Greenhill has 7.84."""
    n, free = 8, (0,) * 6 + (1,)
    z = np.linspace(0.0, 5.0, n + 1)
    up = np.outer(np.ones(n + 1), [0.0, 0.0, 1.0])
    held = {i: free for i in range(1, n + 1)} | {0: (1,) * 7}
    items = chain(np.outer(z, [0.0, 0.0, 1.0]), z, held, up, EA=1e7, EJ=100.0)
    return scene(items, start="relaxed", rho_inf=0.8, time_step=0.01, time_end=end, plotpoints=10)


@pytest.fixture
def read(tmp_path):
    def put(text):
        path = tmp_path / "scene.yaml"
        path.write_text(text, encoding="utf8")
        return tautline.read(path)

    return put


@pytest.mark.parametrize("at", [(0.0, 0.0, 0.0), (500.0, 0.0, 0.0), (0.0, -3000.0, 200.0)])
def test_a_start_far_from_the_drawing_is_told_wherever_the_scene_lies(read, at):
    result = tautline.simulate(read(sagging(at)))
    # a rope half as long again as its span hangs by more than half of it, and 8 m are a tenth of the scene
    assert result.attributes["start"]["far"] and result.attributes["start"]["moved"] > 0.4 * SPAN
    assert sum("far from the initial geometry" in told for told in result.warnings) == 1


def test_the_size_of_a_scene_is_that_of_its_places_held_ones_too_and_of_nothing_else():
    places = ["a: rx", "a: rz", "a: r'x", "b: rx", "b: rz", "b: p", "c: z", "lump: rotation"]
    assert size_of(places, np.array([500.0, 7.0, -90.0, 503.0, 8.0, 4000.0, 3.0, 60.0])) == 5.0
    assert size_of(["lump: rotation"], np.array([9.0])) == 0.0
    # one free place that moves by 0.4 m in a scene of 5 m does not lie far, and by 0.6 m it does
    for moved, far in ((0.4, False), (0.6, True)):
        found = static_start(["b: rx"], np.array([-moved]), ["a: rx", "b: rx"], np.array([500.0, 505.0]), 0)
        assert (found.far, found.moved, found.moved_most) == (far, moved, "b: rx")


@pytest.mark.parametrize(("text", "told"), [(sagging, "far from the initial geometry"), (column, "It was perturbed")])
def test_a_run_that_is_gone_on_with_says_what_its_start_said(read, text, told, tmp_path):
    whole = tautline.simulate(read(text(end=0.2)))
    tautline.simulate(read(text(end=0.1)), tmp_path / "first.nc")
    first = Result.read(tmp_path / "first.nc")
    later = tautline.simulate(read(text(end=0.2)), tmp_path / "on.nc", resume=first)
    assert Start.of_attribute(later.attributes["start"]) == Start.of_attribute(whole.attributes["start"]) != Start()
    assert sum(told in one for one in later.warnings) == 1
    assert later.warnings == whole.warnings


@pytest.mark.parametrize(("text", "told"), [(sagging, "far from the initial geometry"), (column, "It was perturbed")])
def test_a_copy_of_a_simulation_says_what_its_start_said(read, text, told):
    sim = tautline.Simulation(read(text()))
    other = sim.copy()
    for one in (sim, other):
        one.advance(0.05)
    assert other.result.attributes["start"] == sim.result.attributes["start"] != {}
    assert sum(told in one for one in other.result.warnings) == 1


def test_an_unstable_relaxed_start_is_told_after_it_was_stored():
    found = Start("relaxed", stable=False, pushed=True)
    again = Start.of_attribute(found.attribute | {"of a later version": 1})
    assert again == found and len(again.warnings) == 1 and "relaxed start is unstable" in again.warnings[0]
    assert Start().attribute == {} and Start.of_attribute(None) == Start() and Start().warnings == []


def test_a_start_that_was_pushed_nowhere_has_no_arbitrary_side_and_a_push_of_an_older_record_has():
    still = tautline.simulate(tautline.read(DATA / "hanging.yaml").replace({"solver.end": 0.1})).attributes["start"]
    assert (still["pushed"], still["side"]) == (False, "drawn") and Start().side == "drawn"
    older = {"found": "static", "stable": True, "pushed": True}
    assert any("The side is arbitrary" in told for told in Start.of_attribute(older).warnings)
    assert Start.of_attribute(older | {"pushed": False}).side == "drawn"
