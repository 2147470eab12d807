"""Error against run time: closed forms of a mass on a spring, meshes of a bar, and scenes that nobody would study."""

import time

import numpy as np
import pytest
from of_the_suite import studies
from study.oscillators import (
    OMEGA,
    START,
    amplification,
    bar,
    chain,
    lag_constant,
    oscillator,
    rk4,
    rk4_factor,
    run,
    subject,
)

from tautline.results.errors import ResultError
from tautline.run import Run
from tautline.scene.errors import SceneError
from tautline.study.accuracy.grid import settings
from tautline.study.accuracy.precision import Grid, study
from tautline.study.trials import trial as trial_module
from tautline.study.trials.trial import Setting

END = 3.0


def studied(text, methods=None, steps=None, **more):
    """A study of a scene with one run of each setting."""
    options = {"repetitions": 1} | {k: more.pop(k) for k in list(more) if k not in ("elements", "constraints")}
    return study(subject(text), Grid(methods, steps, **more), **options)


def rows_of(found):
    return {row.trial.setting.step: row for row in found.rows}


# errors of the methods
STEPS = {"newmark": (0.02, 0.01, 0.005), "generalized-alpha": (0.02, 0.01, 0.005), "rk4": (0.06, 0.03, 0.015)}


@pytest.mark.parametrize(
    ("method", "rho"), [("newmark", None), ("generalized-alpha", 0.8), *studies(("generalized-alpha", 1.0))]
)
def test_errors_of_second_order_methods_are_their_period_error_times_the_angle_turned(method, rho):
    """Late by c (omega h)^2 omega T at the end: half of that is the distance over the way 2 A, and the mean phase.

    The root of the mean of (A lag(t) sin)^2, lag growing with t, is A lag / sqrt 6.
    """
    text = oscillator(time_end=END, rho_inf=0.8 if rho is None else rho)
    for h, row in rows_of(studied(text, (method,), STEPS[method])).items():
        lag = lag_constant(rho) * (OMEGA * h) ** 2 * OMEGA * END
        assert row.errors.position == pytest.approx(lag / 2.0, rel=0.1)
        assert row.errors.phase == pytest.approx(lag / 2.0, rel=0.05)
        assert row.errors.rmse == pytest.approx(START * lag / np.sqrt(6.0), rel=0.1)
        assert row.errors.force < 5e-3


def test_errors_of_rk4_are_the_fifth_power_over_120_a_step():
    """And with its damping the powers of the cut-off exponential; the reference may be wrong by a fraction of that."""
    for h, row in rows_of(studied(oscillator(time_end=END, plotpoints=1 / 0.06), ("rk4",), STEPS["rk4"])).items():
        late = (OMEGA * h) ** 4 / 120.0 * OMEGA * END
        assert row.errors.phase == pytest.approx(late / 2.0, rel=0.15)
        n = np.arange(round(END / h) + 1)
        off = np.abs(np.real(rk4_factor(1j * OMEGA * h) ** n) - np.cos(OMEGA * h * n))[:: round(0.06 / h)].max()
        assert row.errors.position == pytest.approx(off / 2.0, rel=0.08)


@pytest.mark.parametrize(("method", "order"), [("rk4", 4.0), ("generalized-alpha", 2.0), *studies(("newmark", 2.0))])
def test_errors_fall_in_the_order_of_the_method(method, order):
    found = rows_of(studied(oscillator(time_end=END), (method,), STEPS[method]))
    logs = np.log([[h, row.errors.position] for h, row in found.items()])
    assert np.polyfit(*logs.T, 1)[0] == pytest.approx(order, abs=0.2)


def test_the_force_error_is_what_damping_takes_of_its_range():
    """By the powers of Chung and Hulbert's matrix: what rho 0 takes of the first swing to the other side."""
    found = studied(oscillator(time_end=END, rho_inf=0.0), ("generalized-alpha",), (0.02,))
    (row,) = found.rows
    start = np.array([1.0, 0.0, -0.04])
    motion = np.array([(np.linalg.matrix_power(amplification(0.2, 0.0), n) @ start)[0] for n in range(151)])
    exact = np.ptp(np.cos(0.2 * np.arange(151)))
    assert row.errors.force == pytest.approx((exact - np.ptp(motion)) / exact, rel=1e-2)


def test_a_finer_mesh_is_compared_with_one_that_is_finer_still():
    """A bar let go in the shape x + 0.01 x: elements 1, 2, 4 come closer to a reference of eight."""
    found = studied(bar(1, start=0.01, time_end=1.0, time_step=0.01), ("newmark",), (0.005,), elements=(1.0, 2.0, 4.0))
    assert found.reference.setting.elements == 8.0
    errors = [row.errors.position for row in found.rows]
    assert [row.trial.setting.elements for row in found.rows] == [1.0, 2.0, 4.0]
    assert errors[0] > errors[1] > errors[2] > 0.0 and errors[0] > 2.0 * errors[2]


def test_a_mesh_that_cannot_be_coarser_is_not_run_under_a_false_name():
    found = studied(bar(1, start=0.01, time_end=0.5, time_step=0.01), ("newmark",), (0.01,), elements=(0.5, 1.0))
    assert [row.trial.setting.elements for row in found.rows] == [1.0]


def test_ways_to_impose_constraints_agree_but_for_the_penaltys_own_error():
    """A penalty of 1e5 N/m holds two masses of one kilogram that pull with 0.5 N: they part by some micrometres."""
    found = studied(chain(100.0, time_end=1.0), ("newmark",), (0.005,), constraints=("all",))
    by = {row.trial.setting.constraint: row.errors.position for row in found.rows}
    assert list(by) == ["lagrange", "penalty", "augmented"]
    assert by["augmented"] == pytest.approx(by["lagrange"], rel=1e-3)
    assert by["penalty"] == pytest.approx(by["lagrange"], rel=0.1)


@pytest.mark.parametrize("scene", [chain(100.0, time_end=0.5), oscillator(time_end=0.5)])
def test_a_way_to_impose_constraints_that_a_scene_does_not_have_is_refused(scene):
    with pytest.raises(SceneError) as error:
        studied(scene, ("newmark",), (0.01,), constraints=("glue",))
    (problem,) = error.value.problems
    assert "--constraints" in str(problem) and "glue" in str(problem) and problem.cure


# which settings
def test_the_usual_grid_is_of_rk4_and_the_scenes_method_each_from_coarse_to_fine():
    found = settings(subject(oscillator()), Grid(), 0.01, 1.0, reduced=False)
    assert [s.method for s in found] == ["rk4"] * 4 + ["generalized-alpha"] * 6
    for method in ("rk4", "generalized-alpha"):
        steps = [s.step for s in found if s.method == method]
        assert steps == sorted(steps, reverse=True)
    assert max(s.step for s in found if s.method == "rk4") < 2.8 / OMEGA
    assert 0.01 in [s.step for s in found]


def test_a_quick_look_takes_every_other_step():
    whole, half = (settings(subject(oscillator()), Grid(), 0.01, 1.0, reduced) for reduced in (False, True))
    assert len(half) == len(whole) / 2 and set(half) < set(whole)


@pytest.mark.parametrize(
    ("solver", "methods"), [(rk4(), ["rk4", "generalized-alpha"]), ({"type": "Newmark"}, ["rk4", "newmark"])]
)
def test_of_a_scene_of_another_method_the_grid_is_of_that_and_of_an_implicit_one(solver, methods):
    found = settings(subject(oscillator(**({"rho_inf": None} | solver))), Grid(), 0.001, 1.0, reduced=False)
    assert list(dict.fromkeys(s.method for s in found)) == methods


@pytest.mark.parametrize("control", [{"time_step": "auto"}, {"control": "error", "tolerance": 1e-6}])
def test_a_scene_whose_steps_are_controlled_is_run_with_other_errors_of_a_step_too(control):
    found = studied(oscillator(time_end=1.0, **control), ("generalized-alpha",))
    controlled = [row for row in found.rows if row.trial.setting.step_error is not None]
    errors = [row.errors.position for row in sorted(controlled, key=lambda row: -row.trial.setting.step_error)]
    assert len(controlled) == 4 and errors[0] > 10.0 * errors[-1]
    assert all(row.trial.done for row in found.rows)


# runs that fail, or take long
def test_a_run_that_stops_is_told_by_name_and_counts_nowhere():
    found = studied(oscillator(time_end=1.0), ("rk4", "newmark"), (0.5, 0.01))
    stopped = next(row for row in found.rows if row.trial.setting == Setting("rk4", 0.5))
    assert stopped.trial.status == "UNSTABLE" and "critical step" in stopped.trial.sentence
    assert stopped.errors is None
    assert "rk4, step 0.5" not in found.advice


def test_all_runs_may_fail():
    found = studied(oscillator(time_end=5.0, plotpoints=2), ("rk4",), (1.0, 0.6))
    assert {row.trial.status for row in found.rows} == {"UNSTABLE"}
    assert found.reference is not None
    assert found.advice == "no advice: no run came to its end"


def test_a_step_longer_than_the_run_is_refused_by_name():
    found = studied(oscillator(time_end=1.0), ("newmark",), (2.0, 0.01))
    refused = found.rows[0].trial
    assert refused.status == "refused" and refused.result is None and "time_end" not in refused.status
    assert refused.sentence


def test_a_run_that_would_take_longer_than_the_budget_is_left_out_and_said_to_be(monkeypatch):
    """The first run is said to have taken a second: the next, of a tenth of the step, would take ten."""
    run_model = trial_module.run_model

    def slow(model, setting, **further):
        done = run_model(model, setting, **further)
        return trial_module.replace(done, wall=(0.01 / setting.step,), cpu=(0.01 / setting.step,))

    monkeypatch.setattr(trial_module, "run_model", slow)
    found = studied(oscillator(time_end=1.0), ("newmark",), (0.01, 0.001, 0.0001), budget=5.0)
    assert [row.trial.status for row in found.rows] == ["done", "left out", "left out"]
    assert "about 10 s" in found.rows[1].trial.sentence and "5 s" in found.rows[1].trial.sentence
    assert found.rows[1].factor is None and found.rows[1].errors is None


def test_a_long_run_of_a_kind_that_was_not_run_yet_is_tried_in_part_and_left_out_by_that(monkeypatch):
    """A step is said to take a millisecond: 25000 of them take 25 s, and a fiftieth of them half a second."""
    run_model, ran = trial_module.run_model, []

    def slow(model, setting, **further):
        done = run_model(model, setting, **further)
        ran.append(model.solver.end / setting.step)
        return trial_module.replace(done, cpu=(1e-3 * ran[-1],))

    monkeypatch.setattr(trial_module, "run_model", slow)
    found = studied(oscillator(time_end=1.0, plotpoints=50), ("newmark",), (4e-5,), budget=5.0)
    assert found.rows[0].trial.status == "left out" and "about 25 s" in found.rows[0].trial.sentence
    assert ran[0] == pytest.approx(500.0)


def test_a_scene_that_comes_to_its_end_with_no_setting_is_not_studied():
    from tautline.integrators.status import StoppedEarly

    with pytest.raises(StoppedEarly, match="UNSTABLE"):
        studied(oscillator(time_end=5.0, **rk4(time_step=0.5)), ("rk4",), (0.5,))


def test_what_is_interrupted_keeps_the_runs_that_it_has(monkeypatch):
    from tautline.integrators.status import Interrupted

    calls = []
    simulate = trial_module.simulate

    def interrupted(model, **further):
        calls.append(model)
        if len(calls) == 3:
            raise Interrupted(0.1)
        return simulate(model, **further)

    monkeypatch.setattr(trial_module, "simulate", interrupted)
    found = studied(oscillator(time_end=1.0), ("newmark",), (0.04, 0.02, 0.01, 0.005))
    assert found.interrupted and len(found.rows) == 2 and found.reference is None
    assert found.advice.startswith("no advice")


# times
def test_runs_are_repeated_for_their_time_and_long_ones_are_not(monkeypatch):
    found = studied(oscillator(time_end=0.5), ("newmark",), (0.01,), repetitions=4)
    assert len(found.rows[0].trial.wall) == len(found.rows[0].trial.cpu) == 4
    monkeypatch.setattr(trial_module, "ENOUGH", 0.0)
    found = studied(oscillator(time_end=0.5), ("newmark",), (0.01,), repetitions=4)
    assert len(found.rows[0].trial.wall) == 1


def test_times_are_of_the_time_loop_alone(monkeypatch):
    """Storing, starting and looking are made slow; what is told stays what it was."""
    store, start = Run._store, Run.start

    def slow_store(self, *given):
        time.sleep(0.02)
        return store(self, *given)

    def slow_start(self):
        time.sleep(0.2)
        return start(self)

    monkeypatch.setattr(Run, "_store", slow_store)
    monkeypatch.setattr(Run, "start", slow_start)
    began = time.perf_counter()
    result = run(oscillator(time_end=0.1), look=lambda *_: time.sleep(0.02))
    assert time.perf_counter() - began > 0.25
    assert result.attributes["wall_time"] < 0.1 and result.attributes["cpu_time"] < 0.1


def test_the_real_time_factor_of_a_row_is_the_median_wall_time_over_the_time_simulated():
    found = studied(oscillator(time_end=2.0), ("newmark",), (0.01,), repetitions=3)
    (row,) = found.rows
    assert row.factor == pytest.approx(sorted(row.trial.wall)[1] / 2.0)
    assert row.trial.attribute("steps") == 200 and row.trial.attribute("newton_iterations") > 0


# scenes that nobody would study
def test_a_scene_at_rest_is_right_with_every_setting():
    found = studied(oscillator(start=0.0, time_end=0.4))
    assert all(row.trial.done and row.errors.position < 1e-6 and row.errors.phase is None for row in found.rows)
    assert found.reference.converged and found.advice.startswith("cheapest")


def test_a_run_shorter_than_a_period_has_no_phase():
    found = studied(oscillator(time_end=0.1, time_step=0.005, plotpoints=0), ("newmark",), (0.005, 0.0025))
    assert all(row.errors.phase is None and row.errors.position < 1e-2 for row in found.rows)


@pytest.mark.parametrize("plotpoints", [0.5, 1, 3])
def test_a_scene_of_few_frames_is_studied_by_those(plotpoints):
    found = studied(oscillator(time_end=2.0, plotpoints=plotpoints), ("newmark",), (0.01, 0.005))
    lag = 2.0 * OMEGA * (OMEGA * 0.01) ** 2 / 12.0
    for row in found.rows:
        # Of the first and the last frame alone the way is shorter than 2 A.
        assert row.errors.phase is None and 0.0 < row.errors.position < 2.0 * lag
    assert found.reference.converged


def test_a_scene_whose_force_nobody_stores_is_studied_without(monkeypatch):
    monkeypatch.setattr("tautline.study.trials.history.FORCES", ())
    found = studied(oscillator(time_end=1.0), ("newmark",), (0.01,))
    assert found.watched.force is None and found.rows[0].errors.force is None


def test_frames_that_do_not_divide_the_steps_are_compared_at_their_own_times():
    found = rows_of(studied(oscillator(time_end=END, plotpoints=33.3), ("newmark",), (0.011, 0.007)))
    for row in found.values():
        lag = (OMEGA * row.trial.attribute("step")) ** 2 / 12.0 * OMEGA * END
        assert row.errors.phase == pytest.approx(lag / 2.0, rel=0.06)


def test_a_point_that_nothing_is_called_is_refused():
    with pytest.raises(ResultError, match="nothing is called 'hook'"):
        studied(oscillator(time_end=0.5), ("newmark",), (0.01,), point="hook")


def test_a_point_is_looked_at_that_is_named():
    found = studied(chain(100.0, time_end=1.0), ("newmark",), (0.01,), point="2")
    assert found.watched.point.label == "2"


# two methods that solve different problems
def test_a_method_that_stays_off_the_reference_as_its_step_falls_is_named(monkeypatch):
    """Runs of Newmark get a spring that is a tenth softer: late by 1.5 of 30 rad, off by sin(1.5 / 2) of the way."""
    build = trial_module.Subject.model

    def other(self, setting):
        scene = self.scene
        if setting.method == "newmark":
            return build(trial_module.replace(self, scene=self.application.vary(scene, "stiffness", 0.9)), setting)
        return build(self, setting)

    monkeypatch.setattr(trial_module.Subject, "model", other)
    found = studied(oscillator(time_end=END, plotpoints=50), ("newmark", "rk4"), (0.01, 0.005, 0.0025))
    (warning,) = found.warnings
    assert "do not converge to the reference" in warning and "newmark by 65 %" in warning and "rk4" not in warning
    assert studied(oscillator(time_end=END), ("rk4",), (0.01, 0.005)).warnings == ()
