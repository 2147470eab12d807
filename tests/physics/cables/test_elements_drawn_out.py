"""Elements out of which functions of time draw all material: how `check` foresees them, and how a run tells of them."""

import math
import weakref

import numpy as np
import pytest

import tautline
from tautline.cable.application import Cable
from tautline.cable.input.scene import parse
from tautline.cable.model.build import build
from tautline.integrators.status import Status, StoppedEarly
from tautline.integrators.stops import emptied
from tautline.simulation import simulate

REEL = """
CableModelMaterial: {Gravity: [0, 0, 0]}
CableModel:
  - Node%(kind)sDof: {id: 0, xyz: [0, 0, 0], BC: %(held)s}
  - Node%(kind)sDof: {id: 1, xyz: [3, 0, 0], BC: %(held)s, BC_functions: %(follows)s}
  - CableLine: {id: 0, nodes%(kind)s: [0, 1], elements: 3, EA: 1e5, rhoA: 1.5}
  - %(function)s
GeneralizedAlpha: {type: %(method)s, time_step: %(step)s, time_end: %(end)s, plotpoints: 0}
"""
FASTER = "Function_VelocityDefined: {id: 1, pos0: 3, timeList: [0, 0.01], velocityList: [0, -10]}"
"""Draws 1 m in by 0.105 s: 0.05 m while it speeds up for 0.01 s, the rest at 10 m/s."""
GONE = 0.105


def reel(kind=7, function=FASTER, method="G-alpha", step=1e-3, end=0.12):
    held, follows = [[1, 1, 1] + [0] * (kind - 4) + [1], [0] * (kind - 1) + [1]]
    return REEL % {
        "kind": kind, "held": held, "follows": follows, "function": function, "method": method, "step": step, "end": end
    }  # fmt: skip


def foreseen(text):
    return [str(warning) for warning in Cable().warnings(parse(text)) if "NO_LENGTH" in str(warning)]


@pytest.mark.parametrize("step", [1e-2, 1e-3])
@pytest.mark.parametrize("method", ["G-alpha", "Newmark"])
@pytest.mark.parametrize("kind", [7, 4])
def test_an_element_that_a_winch_draws_empty_stops_the_run_by_its_own_name_at_any_step(kind, method, step):
    with pytest.raises(StoppedEarly) as stop:
        simulate(build(parse(reel(kind, method=method, step=step))))
    assert stop.value.status is Status.NO_LENGTH
    assert stop.value.time == pytest.approx(GONE, abs=step)
    assert "element 2 of line 6, between nodes 3 and 1, began with 1 m" in stop.value.sentence
    assert "begin with a longer element" in stop.value.sentence and "smaller step" not in stop.value.sentence


def test_a_simulation_that_is_advanced_past_an_empty_element_stops_by_its_name():
    simulation = tautline.Simulation(parse(reel()))
    with pytest.raises(StoppedEarly, match="element 2 of line 6") as stop:
        simulation.advance(0.12)
    assert stop.value.status is Status.NO_LENGTH


def test_a_step_that_fails_before_an_element_is_empty_is_not_blamed_on_it():
    """One iteration solves no step of a rope that is drawn taut; the element has half of its cable then."""
    text = reel(end=0.06).replace("plotpoints: 0", "plotpoints: 0, maxIter: 1")
    with pytest.raises(StoppedEarly) as stop:
        simulate(build(parse(text)))
    assert stop.value.status is Status.NOT_CONVERGED


SLOW = "Function_VelocityDefined: {id: 1, pos0: 3, timeList: [0, 0.01], velocityList: [0, -2]}"
"""Draws 1 m in by 0.505 s."""


@pytest.mark.parametrize(("step", "frames"), [(0.6, 0), ("auto", 1)])
def test_a_failure_is_not_blamed_on_an_element_that_one_whole_step_would_have_emptied(step, frames):
    """The step failed in all of its parts: 0.99 m of cable are left where the run stops, by 0.01 s at the latest."""
    text = reel(function=SLOW, step=step, end=0.6).replace("plotpoints: 0", f"plotpoints: {frames}, maxIter: 1")
    with pytest.raises(StoppedEarly) as stop:
        simulate(build(parse(text)))
    assert stop.value.time < 0.011
    assert stop.value.status is Status.NOT_CONVERGED


def test_a_simulation_that_fails_is_not_blamed_on_an_element_that_one_whole_step_would_have_emptied():
    text = reel(function=SLOW, step=0.6, end=0.6).replace("plotpoints: 0", "plotpoints: 0, maxIter: 1")
    with pytest.raises(StoppedEarly) as stop:
        tautline.Simulation(parse(text)).advance(0.6)
    assert stop.value.status is Status.NOT_CONVERGED


def test_an_advance_that_fails_is_not_blamed_on_an_element_that_a_step_of_the_scene_would_have_emptied():
    """An advance of 0.01 s leaves 0.99 m; a thousandth of the scene's step of 600 s would leave nothing."""
    text = reel(function=SLOW, step=600, end=600).replace("plotpoints: 0", "plotpoints: 0, maxIter: 1")
    with pytest.raises(StoppedEarly) as stop:
        tautline.Simulation(parse(text)).advance(0.01)
    assert stop.value.status is Status.NOT_CONVERGED


def test_a_failure_late_in_a_run_is_not_blamed_on_an_element_that_is_full_as_yet():
    """A thousandth of 1000 s is more than a step: in that all would be drawn out, and nothing is when the run stops."""
    late = "Function_VelocityDefined: {id: 1, pos0: 3, timeList: [0, 1000, 1000.01], velocityList: [0, 0, -2]}"
    text = reel(function=late, step=0.6, end=1001.2).replace("plotpoints: 0", "plotpoints: 0, maxIter: 1")
    with pytest.raises(StoppedEarly) as stop:
        simulate(build(parse(text)))
    assert stop.value.status is Status.NOT_CONVERGED


def test_a_group_lives_while_its_alarm_is_asked_at_the_end_of_a_run(monkeypatch):
    """Linked groups are addresses: of one that is gone, compiled code would read what lies there by now."""
    copies, asked = [], []

    def linked(groups, *sums):
        copies[:] = [weakref.ref(part) for group in groups for part in group if isinstance(part, np.ndarray)]
        return link(groups, *sums)

    def ask(*given):
        asked.append(all(part() is not None for part in copies))
        return _ask(*given)

    link, _ask = emptied.link, emptied._ask
    monkeypatch.setattr(emptied, "link", linked)
    monkeypatch.setattr(emptied, "_ask", ask)
    with pytest.raises(StoppedEarly):
        simulate(build(parse(reel())))
    assert copies and asked and all(asked)


def test_a_run_with_a_chosen_step_still_stops_by_the_name_of_an_element_that_is_drawn_empty():
    with pytest.raises(StoppedEarly, match="element 2 of line 6") as stop:
        simulate(build(parse(reel(step="auto").replace("plotpoints: 0", "plotpoints: 1"))))
    assert stop.value.status is Status.NO_LENGTH
    assert stop.value.time == pytest.approx(GONE, abs=1e-4)


def test_check_foresees_when_an_element_has_no_cable_left():
    (told,) = foreseen(reel())
    assert "line 6" in told and "element 2 between nodes 3 and 1" in told
    assert f"at {GONE:g} s" in told and "1.15 m" in told


def test_check_foresees_it_of_a_function_that_is_the_value_itself():
    """1.1 m times sin(pi t) is 1 m of the way down for the first time at 1 + asin(1/1.1)/pi s."""
    wave = "Function: {id: 1, value: {harmonic: {amplitude: 1.1, period: 2, mean: 3}}}"
    (told,) = foreseen(reel(function=wave, end=2.0))
    assert f"at {1.0 + math.asin(1.0 / 1.1) / math.pi:.3g}" in told


@pytest.mark.parametrize("end", [0.05, 0.1])
def test_check_says_nothing_of_a_run_that_ends_before_an_element_is_empty(end):
    assert not foreseen(reel(end=end))


def test_check_says_nothing_of_rope_that_runs_through_as_fast_as_it_is_drawn():
    held = "BC: [1, 1, 1, 0, 0, 0, 1]"
    text = reel().replace(f"{held}}}", f"{held}, BC_functions: [0, 0, 0, 0, 0, 0, 2]}}", 1)
    text = text.replace(FASTER, FASTER + "\n  - " + FASTER.replace("id: 1, pos0: 3", "id: 2, pos0: 0"))
    text = text.replace("elements: 3", "elements: 1")
    assert not foreseen(text)
