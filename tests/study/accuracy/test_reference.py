"""A reference that proves itself: on made-up runs whose error is known, and on scenes that are smooth or are not."""

from pathlib import Path

import numpy as np
import pytest
from physics.wells.strings import straight_hole
from study.oscillators import OMEGA, START, node, oscillator, rk4, spring, subject, text_of

import tautline
from drillstring.application import Drillstring
from tautline.results.result import Result
from tautline.results.variable import Variable
from tautline.scene.methods import method_of, names
from tautline.study.accuracy import reference
from tautline.study.accuracy.judge import Sharpened
from tautline.study.accuracy.precision import Grid, study
from tautline.study.accuracy.reference import find_reference
from tautline.study.trials.errors import compare
from tautline.study.trials.history import History, watch
from tautline.study.trials.trial import Setting, Subject, Trial

ROOT = Path(__file__).parents[3]
ORDERS = {name: method_of(name).order for name in names()}

TIME = np.linspace(0.0, 2.0, 101)


class MadeUp:
    """Runs of a point that goes one metre, wrong by ``error(step)`` m in the shape of t; some do not end."""

    def __init__(self, error, fails=lambda step: False, wall=1e-3):
        self.error, self.fails, self.wall = error, fails, wall
        self.steps = []

    def run(self, setting):
        step = float(setting.step)
        self.steps.append(step)
        if self.fails(step):
            return Trial(setting, "UNSTABLE", "grew")
        way = np.sin(0.25 * np.pi * TIME) + self.error(step) * TIME / TIME[-1]
        position = np.zeros((TIME.size, 2, 3))
        position[:, 1, 0] = way
        variables = [Variable("time", ("time",), "s", ""), Variable("position", ("time", "node", "axis"), "m", "")]
        attributes = {"step": step, "wall_time": self.wall / step, "steps": int(2.0 / step)}
        arrays = {"time": TIME, "position": position}
        taken = (self.wall / step,)
        return Trial(setting, "done", "", Result(None, (variables, arrays, {}, attributes, {})), taken, taken)


def found_for(made, method="newmark", first=0.1, tolerance=0.01, budget=1e9, **more):
    watched = watch(MadeUp(lambda step: 0.0).run(Setting(method, first)).result)
    return find_reference(made, watched, Setting(method, first), tolerance, budget, **more)


@pytest.mark.parametrize("method", ORDERS)
@pytest.mark.parametrize("size", [0.5, 20.0])
def test_runs_whose_error_falls_in_the_order_of_the_method_prove_themselves(method, size):
    found = found_for(MadeUp(lambda step: size * step ** ORDERS[method]), method)
    assert found.converged and found.why == ""
    assert found.observed_order == pytest.approx(ORDERS[method], abs=0.05)


@pytest.mark.parametrize("method", ORDERS)
def test_the_error_that_a_reference_tells_of_itself_is_its_error(method):
    """Richardson is exact for a pure power: what is left is the difference over 2^p - 1."""
    for size in (0.5, 20.0):
        found = found_for(MadeUp(lambda step, size=size: size * step ** ORDERS[method]), method)
        assert found.error == pytest.approx(size * found.step ** ORDERS[method], rel=0.02)
        assert found.error <= 0.1 * 0.01


@pytest.mark.parametrize(
    ("method", "order"), [("newmark", 1.0), ("rk4", 1.0), ("rk4", 2.0), ("generalized-alpha", 0.5)]
)
def test_runs_of_another_order_are_not_proved_however_close(method, order):
    found = found_for(MadeUp(lambda step: 1e-3 * step**order), method, budget=1.0)
    assert not found.converged
    assert found.observed_order == pytest.approx(order, abs=0.05)
    assert f"{order:.2g}, not {ORDERS[method]:g}" in found.why


def test_the_error_of_runs_of_a_lower_order_is_not_underrated():
    """By the method's own order it would be told as a third of what it is, or less."""
    for order in (0.5, 1.0):
        found = found_for(MadeUp(lambda step, order=order: 0.3 * step**order), "newmark")
        assert 0.3 * found.step**order <= 1.02 * found.error <= 10.0 * 0.3 * found.step**order


def test_one_lucky_triple_among_runs_of_order_one_proves_nothing():
    """Differences of a string that sticks and slips, as they were seen: one of seven orders is that of the method."""
    orders = [0.5, 1.4, 0.7, 1.3, 0.8, 0.9, 1.8, 0.7, 1.2, 0.9, 1.1, 0.8, 1.2, 1.0, 0.9]
    differences = 1e-4 * 2.0 ** -np.cumsum([0.0, *orders])
    errors = np.append(np.cumsum(differences[::-1])[::-1], 0.0)
    stuck = MadeUp(lambda step: errors[round(np.log2(0.1 / step))])
    found = found_for(stuck, "newmark")
    assert not found.converged and "observed order" in found.why


def test_runs_that_differ_by_rounding_alone_are_right_and_show_no_order():
    found = found_for(MadeUp(lambda step: 1e-15))
    assert found.converged and found.observed_order is None
    assert 0.0 < found.error <= 1e-11


def test_a_method_that_stays_wrong_by_a_constant_cannot_be_told_by_itself():
    """What Richardson cannot see: two methods that solve different problems are told apart by the study."""
    assert found_for(MadeUp(lambda step: 0.3 + step**2)).converged


def test_runs_that_come_no_closer_are_not_proved():
    found = found_for(MadeUp(lambda step: 0.1 * np.sin(7.3 / step)), "newmark")
    assert not found.converged and found.error > 1e-3 and found.why


def test_steps_are_halved_and_no_further_than_needed():
    made = MadeUp(lambda step: 0.5 * step**2)
    found = found_for(made, tolerance=0.01)
    assert np.array(made.steps[1:]) / np.array(made.steps[:-1]) == pytest.approx(0.5)
    assert found.step == made.steps[-1] and 0.5 * (4 * found.step) ** 2 > 1e-3
    assert [step for step, _ in found.differences] == pytest.approx(made.steps[:-1])


def test_it_goes_on_below_the_errors_of_what_it_judges():
    """A run that is wrong by 1e-6 cannot be judged by a reference that is wrong by 1e-4."""
    close = History(TIME, np.stack([np.sin(0.25 * np.pi * TIME) + 1e-6 * TIME, 0 * TIME, 0 * TIME], 1), np.zeros(0))
    found = found_for(MadeUp(lambda step: 0.5 * step**2), judged=[close])
    assert found.converged and found.error <= 0.3 * 2e-6


def test_a_step_that_is_named_is_the_last_and_is_not_proved_where_it_is_coarse():
    made = MadeUp(lambda step: 0.5 * step**2)
    found = found_for(made, finest=0.2)
    assert made.steps[-1] == found.step == pytest.approx(0.2)
    assert not found.converged and "more than a tenth of the tolerance" in found.why
    fine = found_for(MadeUp(lambda step: 0.5 * step**2), finest=0.01)
    assert fine.converged and fine.step == pytest.approx(0.01)


def test_coarse_runs_that_stop_are_passed_over():
    made = MadeUp(lambda step: 0.5 * step**2, fails=lambda step: step > 0.03)
    found = found_for(made)
    assert found.converged and len(found.differences) + 1 == sum(step <= 0.03 for step in made.steps)


def test_a_named_step_whose_quarter_multiples_stop_goes_as_far_below_as_four_runs_take():
    found = found_for(MadeUp(lambda step: 0.5 * step**2, fails=lambda step: step > 0.03), finest=0.02)
    assert found is not None and found.step == pytest.approx(0.0025)


def test_fewer_than_three_runs_are_no_reference():
    assert found_for(MadeUp(lambda step: 0.5 * step**2, fails=lambda step: True)) is None


def test_no_step_is_tried_that_would_take_longer_than_the_budget():
    """A run of 0.1 s takes a hundredth of a second, one of 0.0125 s eight times as long."""
    made = MadeUp(lambda step: 0.5 * step**2)
    found = found_for(made, tolerance=1e-9, budget=0.09)
    assert min(made.steps) == pytest.approx(0.0125)
    assert not found.converged and "more than a tenth" in found.why


# scenes
@pytest.mark.parametrize("method", ["rk4", "generalized-alpha", "newmark"])
def test_the_reference_of_a_smooth_scene_is_as_close_to_its_closed_form_as_it_tells(method):
    scene = subject(oscillator(time_end=2.0))
    found = study(scene, Grid((method,), (0.01,)), 0.01, 1, reference=Setting(method)).reference
    assert found.converged and found.observed_order == pytest.approx(ORDERS[method], abs=0.2)
    exact = 1.0 + START * np.cos(OMEGA * found.history.time)
    error = np.abs(found.history.position[:, 0] - exact).max() / (2.0 * START)
    assert error <= 1.2 * found.error
    assert error >= 0.5 * found.error


def test_a_coarse_step_that_is_named_is_not_proved():
    found = study(subject(oscillator(time_end=2.0)), Grid(("newmark",), (0.01,)), 0.01, 1,
                  reference=Setting("newmark", 0.05))  # fmt: skip
    assert found.reference.step == pytest.approx(0.05) and not found.reference.converged
    assert any("the reference is not proved" in warning for warning in found.warnings)


def test_a_scene_that_sticks_and_slips_is_not_proved():
    """Three lumps under Karnopp's friction, driven at the top: events inside the steps leave an order of one."""
    friction = {"static": 0.4, "kinetic": 0.2, "law": "karnopp"}
    scene = straight_hole(
        1.4, 1000.0, 3, friction=friction, top__block={"harmonic": {"amplitude": 0.6, "period": 1.0}},
        solver__step=0.01, output__interval=0.02, solver__end=1.0,
    )  # fmt: skip
    found = study(Subject(Drillstring(), scene), Grid(("generalized-alpha",), (0.02, 0.01)), 0.01, 1, budget=0.25)
    assert not found.reference.converged and "observed order" in found.reference.why
    assert found.reference.setting.method == "generalized-alpha"
    assert any("the reference is not proved" in warning for warning in found.warnings)


def test_the_reference_of_a_smooth_scene_is_rk4s_and_of_one_too_stiff_for_it_its_own():
    grid = Grid(("newmark",), (0.01,))
    assert study(subject(oscillator(time_end=1.0)), grid, 0.01, 1).reference.setting.method == "rk4"
    held, end = node(0, 0.0, 0.0, (1, 1, 1, 1)), node(2, 2.01, 2.0)
    rigid = [held, node(1, 1.01, 1.0), end, spring(0, (0, 1), 100.0), spring(1, (1, 2), 1e9)]
    stiff = subject(text_of([*rigid, "PointMass: {id: 0, nodes4: [1, 2], mass: 1.0}"], time_end=1.0))
    # RK4 would take more than twenty times the steps of the scene.
    assert study(stiff, grid, 0.01, 1).reference.setting.method == "generalized-alpha"


def test_without_three_runs_there_is_no_reference_and_the_study_says_so(monkeypatch):
    monkeypatch.setattr("tautline.study.accuracy.precision.choose_reference", lambda *_: None)
    found = study(subject(oscillator(time_end=1.0, **rk4(time_step=0.01))), Grid(("rk4",), (0.01,)), 0.01, 1)
    assert found.reference is None and all(row.errors is None for row in found.rows)
    assert any("no reference" in warning for warning in found.warnings)
    assert found.advice == "no advice: there is no reference to judge by"


# the floor of rounding
class FarAway(MadeUp):
    """The same a thousand kilometres from the origin, where a coordinate is known to 1e-10 m."""

    def run(self, setting):
        trial = super().run(setting)
        trial.result._contents[1]["position"][...] += 1e6
        return trial


def test_a_reference_at_the_floor_of_rounding_is_proved():
    """Differences of 2e-9 that do not fall are what the digits of such coordinates leave, and no lack of order."""
    found = found_for(FarAway(lambda step: 1e-9 * (-1) ** round(np.log2(0.1 / step))))
    assert found.converged and found.why == "" and found.observed_order is None
    assert 2e-9 <= 3.0 * found.error <= 1e-6


def test_what_does_not_fall_and_is_no_rounding_is_not_proved():
    found = found_for(MadeUp(lambda step: 1e-9 * (-1) ** round(np.log2(0.1 / step))), budget=1.0)
    assert not found.converged and "observed orders" in found.why


def test_the_rounding_of_large_coordinates_hides_the_order_as_any_rounding_does():
    """A millimetre of motion a thousand kilometres from the origin is known to seven digits of it."""
    far = np.zeros((TIME.size, 3))
    far[:, 0] = 1e6 + 1e-3 * np.sin(TIME)
    assert reference._rounding(History(TIME, far, np.zeros(0)), 1.0, 100) > 1e-6
    near = History(TIME, far - far[0], np.zeros(0))
    assert reference._rounding(near, 1.0, 100) == reference.ROUNDING


def test_the_error_that_a_reference_tells_holds_what_its_iterations_leave_by_rk4():
    """The payload of a slewing crane: what iterations leave falls with no step, and was four times the rest."""
    scene = tautline.read(ROOT / "data" / "slewing.yaml")
    slewing = Subject(tautline._installed().of(scene), scene, end=1.2)
    truth = slewing.run(Setting("rk4", 7.2e-5)).result
    watched = watch(truth)
    found = find_reference(Sharpened(slewing), watched, Setting("generalized-alpha", 1e-3), 0.01, 1e9, finest=1e-4)
    assert found.converged
    assert compare(watched.of(truth), found.history, watched.extent).position <= found.error < 1e-7


def test_a_reference_whose_sharper_iterations_fail_is_made_as_the_scene_says():
    made = MadeUp(lambda step: 0.5 * step**2)
    sharpened = Sharpened.__new__(Sharpened)
    sharpened.subject, sharpened.sharp = made, MadeUp(made.error, fails=lambda step: True)
    trial = sharpened.run(Setting("newmark", 0.1))
    assert trial.done and sharpened.sharp.steps == made.steps == [0.1]
