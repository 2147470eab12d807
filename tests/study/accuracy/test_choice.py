"""Method and step that are chosen for an accuracy: of an oscillator with a closed form, of what cannot be reached."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from cli.in_process import commands_of, files, only_object
from study.oscillators import OMEGA, START, oscillator

from tautline.cable.application import Cable
from tautline.cable.input.scene import parse
from tautline.integrators.status import Interrupted, Status, StoppedEarly
from tautline.results.result import Result
from tautline.run import Run
from tautline.simulation import simulate
from tautline.study.accuracy import choice as module
from tautline.study.accuracy.choice import NONE, Choice, Made, Seen, changes, differences, finer, run_to_accuracy
from tautline.study.trials.history import History, watch

TIMES = np.linspace(0.0, 1.0, 21)


def seen(offset, force=1.0, every=1, shape=TIMES):
    """A run whose point is off by so much of its motion, and the amplitude of its force by another."""
    path = np.outer(np.sin(3.0 * TIMES) + offset * shape, (1.0, 0.0, 0.0))
    return with_force(History(TIMES[::every], path[::every], NONE), force * np.cos(7.0 * TIMES[::every]))


def with_force(history, force):
    """A run with another force."""
    return Seen(history._replace(force=force), force[:, None])


def choice_of(offsets, divisors=(1, 2, 4, 8, 16, 32, 64), asked=0.01, friction=False, alike=True):
    """What is known after runs that are off by so much, alike at all times, or each at times of its own."""
    made = Choice(asked, 0.05, 1.0, friction)
    made.watched = SimpleNamespace(moves=True, extent=1.0, force=SimpleNamespace(column=0))
    for i, (offset, divisor) in enumerate(zip(offsets, divisors, strict=False)):
        run = seen(offset) if alike else seen(offset, shape=np.sin((i + 1) * np.pi * TIMES))
        made.made.append(Made("generalized-alpha", divisor, 0.05 / divisor, 20 * divisor, 1e-3 * divisor, run))
        made.estimates.append(max(made.errors().values(), default=math.inf))
        made.following()
    return made


# what is chosen
@pytest.mark.parametrize(
    "number, expected", [(0.1, 1), (1, 1), (1.1, 2), (2.5, 3), (3.1, 4), (5, 6), (7, 8), (97, 128)]
)
def test_steps_in_an_interval_are_the_next_power_of_two_or_three_quarters_of_one(number, expected):
    assert finer(number) == expected


def test_of_a_second_order_method_the_error_is_stated_from_three_runs_and_is_no_less_than_it_is():
    made = choice_of([0.16, 0.04, 0.01])
    size = np.abs(seen(0.01).history.position[:, 0]).max()
    assert 0.01 / size <= made.errors()["position"] < 1.5 * 0.01 / size
    assert made.met is False and made.following() is not None


@pytest.mark.parametrize("apart", [0.6, 0.9, 1.3])
@pytest.mark.parametrize("asked", [0.02, 0.05, 0.1, 0.2])
def test_runs_that_differ_by_as_much_with_any_step_are_never_taken_for_accurate(apart, asked):
    """Of a chaotic motion every run has its own end, however much shorter its steps are."""
    size = np.abs(seen(0.0).history.position[:, 0]).max()
    for divisors in ((1, 3, 24, 192, 1536), (1, 16, 48, 384), (1, 3, 4.5, 9)):
        for last in range(2, len(divisors) + 1):
            made = choice_of([apart * size * (i % 2) for i in range(last)], divisors, asked)
            assert made.met is False
            assert max(made.errors().values()) > 0.2
    made = choice_of([apart * size * (i % 2) for i in range(5)], (1, 3, 12, 48, 192), asked)
    assert made.following() is None and "chaotic" in made.why


def test_an_estimate_that_is_no_number_is_not_taken_for_reached():
    made = choice_of([0.16, 0.04, 0.01])
    made.estimates[-2:] = [math.nan, math.nan]
    assert made.met is False


def test_two_runs_are_enough_where_twice_what_they_show_is_less_than_was_asked_for():
    size = np.abs(seen(0.0).history.position[:, 0]).max()
    assert choice_of([0.04, 0.0], (1, 3)).errors()["position"] == pytest.approx(2.0 * 0.04 / size / 8.0)
    assert choice_of([0.03, 0.0], (1, 3)).met is True
    assert choice_of([0.05, 0.0], (1, 3)).met is False


def test_where_friction_acts_two_runs_are_enough_only_if_they_agree_far_better_than_was_asked_for():
    """Both may have missed the same slip."""
    far, near = 0.007, 0.002
    assert choice_of([far, 0.0], (1, 3)).met is True
    assert choice_of([far, 0.0], (1, 3), friction=True).met is False
    assert choice_of([near, 0.0], (1, 3), friction=True).met is True


def test_where_friction_acts_the_estimate_before_has_to_be_near_what_was_asked_for():
    assert choice_of([0.2, 0.004, 0.0], (1, 8, 16), friction=True, alike=False).met is False
    assert choice_of([0.044, 0.004, 0.0], (1, 8, 16), friction=True, alike=False).met is True


def test_where_friction_acts_an_order_over_time_counts_if_motion_and_force_are_both_near_two():
    """A slip that all runs miss alike is in none of their differences; one that is late is of a lower order."""

    def stated(motion, force):
        made = choice_of([0.01 * step**motion for step in (4.0, 2.0, 1.0)], (1, 2, 4), friction=True)
        for run, step in zip(list(made.made), (4.0, 2.0, 1.0), strict=True):
            off = np.cos(7.0 * TIMES) * (1.0 + 0.01 * step**force)
            made.made[made.made.index(run)] = run._replace(seen=with_force(run.seen.history, off))
        return made.errors()

    near, low = stated(2.0, 2.0), stated(2.0, 1.4)
    assert near["position"] < 0.7 * low["position"]
    assert stated(1.4, 2.0)["force"] > 2.0 * near["force"]


def test_where_the_force_alone_needs_more_steps_the_next_run_takes_no_more_than_four_times_as_many():
    def runs(friction):
        made = choice_of([0.0, 0.0], (1, 3), friction=friction)
        made.made[0] = made.made[0]._replace(seen=with_force(made.made[0].seen.history, 2.0 * np.cos(7.0 * TIMES)))
        made.estimates[1] = max(made.errors().values())
        return made.following()[1]

    assert (runs(True), runs(False)) == (12.0, 24.0)


def test_a_run_that_has_nothing_in_common_with_the_others_tells_nothing_of_the_order(monkeypatch):
    """Differences grow no further than the motion itself: the order that such a run shows is too low."""
    size = np.abs(seen(0.0).history.position[:, 0]).max()
    made = choice_of([0.9, 0.05, 0.0], (1, 3, 24))
    assert made.errors()["position"] == pytest.approx(2.0 * 0.05 / size / 63.0)
    monkeypatch.setattr(module, "UNLIKE", 2.0)
    assert made.errors()["position"] > 2.0 * 0.05 / size / 63.0


def test_the_next_run_takes_as_many_steps_as_the_error_needs_and_at_most_eight_times_as_many():
    nexts = [choice_of([offset, 0.0], (1, 3)).following()[1] for offset in (0.06, 0.2, 0.9)]
    assert nexts == sorted(nexts) and nexts[0] == 6 and nexts[-1] == 24


def test_where_friction_may_decide_the_next_run_takes_more_steps():
    """What slips a step too late is an error of first order."""
    coarse = [0.06, 0.0]
    assert choice_of(coarse, (1, 3), friction=True).following()[1] > choice_of(coarse, (1, 3)).following()[1]


def test_a_force_that_agrees_in_amplitude_by_chance_is_not_taken_to_agree():
    """Its highest and its lowest value are both off, to the same side."""
    one = seen(0.0)
    other = with_force(one.history, one.history.force + 0.1)
    assert changes(one, other, 1.0, 0)["force"] == pytest.approx(0.1, rel=0.05)
    assert differences(one, other, 1.0)["force"] == pytest.approx(0.0, abs=1e-12)


def test_two_runs_whose_forces_have_their_extremes_alone_in_common_are_not_enough():
    """The same amplitude, a tenth of a period apart: extremes agree, and what lies between does not."""

    def runs(late):
        made = choice_of([1e-4, 1e-5])
        made.made[1] = made.made[1]._replace(seen=with_force(made.made[1].seen.history, np.cos(7.0 * (TIMES - late))))
        made.estimates[1] = max(made.errors().values())
        return made

    assert runs(0.0).met and runs(0.001).met
    assert runs(0.09).estimates[1] < 0.01 and not runs(0.09).met


def test_three_runs_whose_forces_draw_together_over_time_at_second_order_are_enough():
    """Late by 16, 4 and 1 parts, runs differ by 12 and 3, and one is left. Late by 7, 4 and 1, who knows."""

    def runs(*late):
        made = choice_of([1e-4, 1e-5, 1e-6])
        for i, each in enumerate(late):
            force = np.cos(7.0 * (TIMES - each))
            made.made[i] = made.made[i]._replace(seen=with_force(made.made[i].seen.history, force))
        made.estimates[1:] = [0.05, max(made.errors().values())]  # the run before was not near
        return made

    part = 0.0027
    assert runs(16.0 * part, 4.0 * part, part).met
    assert not runs(7.0 * part, 4.0 * part, part).met


def test_extremes_that_agree_twice_by_chance_are_not_enough_unless_the_run_before_was_near_enough():
    def met(before):
        made = choice_of([1e-4, 1e-5, 1e-6])
        for i, late in enumerate((0.09, 0.0, 0.09)):
            force = np.cos(7.0 * (TIMES - late))
            made.made[i] = made.made[i]._replace(seen=with_force(made.made[i].seen.history, force))
        made.estimates[1:] = [before, 0.004]
        return made.met

    assert met(0.009) is True and met(0.02) is False


def test_of_a_force_that_converges_alike_at_all_times_the_error_is_of_the_order_that_it_shows():
    """Of first order, as a force counts otherwise, five times as much would be stated."""

    def stated(*errors, alike):
        made = choice_of([0.0] * len(errors))
        for i, error in enumerate(errors):
            off = np.cos(7.0 * TIMES) if alike else np.roll(np.cos(7.0 * TIMES), 5 * i)
            force = np.cos(7.0 * TIMES) + error * off
            made.made[i] = made.made[i]._replace(seen=with_force(made.made[i].seen.history, force))
        return made.errors()["force"]

    size = 0.01 / 1.01
    assert size <= stated(0.16, 0.04, 0.01, alike=True) < 1.3 * size
    assert stated(0.16, 0.04, 0.01, alike=False) > 2.5 * size


def test_forces_are_kept_of_the_runs_that_are_compared_and_of_no_others():
    result = run_to_accuracy(Cable(), parse(oscillator()), 1e-3)
    made = Choice(1e-3, 0.05, 5.0, False)
    for divisor in (1.0, 2.0, 4.0, 8.0, 16.0):
        made.take("generalized-alpha", divisor, result)
    assert [run.seen.forces.size > 0 for run in made.made] == [False, False, True, True, True]


def test_the_force_of_a_rope_that_falls_into_its_bearings_is_as_accurate_as_was_asked():
    """10 m of rope let go in a straight line: waves meet, and two runs agree by chance in how high they go.

    Against RK4 with steps of 0.1 ms, which differ from those of 0.2 ms by 1e-6.
    """
    text = (
        "CableModelMaterial: {Gravity: [0, 0, -9.81]}\nCableModel:\n"
        "  - Node7Dof: {id: 0, xyz: [0, 0, 0], BC: [1, 1, 1, 0, 0, 0, 1]}\n"
        "  - Node7Dof: {id: 1, xyz: [10, 0, 0], BC: [1, 1, 1, 0, 0, 0, 1]}\n"
        "  - CableLine: {id: 0, nodes7: [0, 1], elements: 8, length: 10, EA: 1e4, "
        "EJ: 0, rhoA: 1, strain: engineering}\n"
        "GeneralizedAlpha: {type: G-alpha, rho_inf: 0.8, time_step: 0.005, time_end: 3, plotpoints: 100}\n"
    )
    found = run_to_accuracy(Cable(), parse(text), 0.02)
    exact = simulate(Cable().build(Cable().with_overrides(parse(text), method="rk4", step=1e-4)))
    force, right = (run["axial_force"] for run in (found, exact))
    assert found.accuracy["met"]
    assert np.abs(force.max(axis=0) - right.max(axis=0)).max() < 0.02 * np.ptp(right, axis=0).max()


def test_the_force_that_is_looked_at_is_the_one_that_varies_most_in_the_last_run():
    """Long steps do not show which that is."""
    result = run_to_accuracy(Cable(), parse(oscillator()), 1e-3)
    made, tension = Choice(1e-3, 0.05, 5.0, False), np.array(result["axial_force"])
    assert tension.shape[1] > 0
    first = SimpleNamespace(column=99)
    made.watched = watch(result)._replace(force=first)
    made.take("generalized-alpha", 1.0, result)
    assert np.ptp(made.watched.of(result).force) >= np.ptp(tension, axis=0).max()


def test_what_does_not_converge_is_given_up_and_says_why():
    made = choice_of([0.1, -0.1, 0.1, -0.1, 0.1, -0.1])
    assert made.met is False and made.following() is None
    assert "chaotic" in made.warning and "1 % was asked for and is not reached" in made.warning
    assert made.record()["met"] is False and made.record()["reached"] > 0.1


def test_a_run_without_all_frames_tells_nothing_of_the_force():
    made = Choice(0.01, 0.05, 1.0, False)
    made.watched = SimpleNamespace(moves=True, extent=1.0, force=SimpleNamespace(column=0))
    for divisor, force in ((0.5, 3.0), (1.0, 1.0)):
        made.made.append(Made("generalized-alpha", divisor, 0.1, 1, 1e-3, seen(0.0, force, 2 if divisor < 1 else 1)))
    assert set(made.errors()) == {"position"}


def test_forces_are_compared_by_their_amplitude():
    assert differences(seen(0.0, 1.1), seen(0.0, 1.0), 1.0)["force"] == pytest.approx(0.1)


# runs
@pytest.mark.parametrize("asked", [0.05, 0.01, 1e-3])
def test_an_oscillator_is_as_accurate_as_was_asked(asked):
    result = run_to_accuracy(Cable(), parse(oscillator()), asked)
    exact = 1.0 + START * np.cos(OMEGA * result.time)
    error = np.abs(result["position"][:, 1, 0] - exact).max() / (2.0 * START)
    told = result.accuracy
    assert told["met"] is True and told["reached"] <= asked
    assert error <= told["position"]
    assert result.step_error["position"] == told["position"]
    assert told["runs"][-1]["step"] == result.attributes["step"] == told["step"]


def test_a_scene_that_is_asked_for_an_accuracy_needs_no_step():
    scene = parse(oscillator(time_step=None, accuracy="1 %"))
    assert (scene.solver.accuracy, scene.solver.step) == (0.01, "auto")


def test_where_nothing_moves_nothing_is_judged_and_the_run_is_kept():
    result = run_to_accuracy(Cable(), parse(oscillator(start=0.0)), 0.01)
    assert result.accuracy["met"] is None and "nothing moves" in result.warnings[-1]
    assert result.time[-1] == pytest.approx(5.0)


def test_steps_that_stop_early_are_made_shorter_and_too_many_of_them_are_told(monkeypatch):
    usual, tried = module.simulate, []

    def stopping(model, *given, **further):
        tried.append(model.solver.step)
        if model.solver.step > longest:
            raise StoppedEarly(Status.NOT_CONVERGED, 0.1, "somewhere")
        return usual(model, *given, **further)

    monkeypatch.setattr(module, "simulate", stopping)
    longest = 0.006
    told = run_to_accuracy(Cable(), parse(oscillator(plotpoints=50)), 0.01).accuracy
    assert told["met"] is True and told["runs"][0]["stopped"] and told["runs"][0]["estimate"] is None
    longest = 0.0
    with pytest.raises(StoppedEarly):
        run_to_accuracy(Cable(), parse(oscillator(plotpoints=50)), 0.01)
    assert tried[-5:] == pytest.approx([0.02 / 4**k for k in range(5)])


# the command
@pytest.fixture
def command(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mass.yaml").write_text(oscillator())
    return commands_of(Cable(), capsys)


def test_of_rehearsals_that_all_stop_nothing_is_said_to_be_written(command, monkeypatch):
    advance = Run.advance

    def stop_soon(run, store):
        advance(run, store)
        raise StoppedEarly(Status.NOT_CONVERGED, run.reached, "somewhere")

    monkeypatch.setattr(Run, "advance", stop_soon)
    code, out, err = command("simulate", "mass.yaml", "--accuracy", "1 %", "--json")
    assert code == 3 and only_object(out)["result"] is None
    assert "None" not in err and "wrote" not in err


def test_simulate_says_what_was_reached_in_its_json_its_summary_and_the_result(command):
    code, out, err = command("simulate", "mass.yaml", "--accuracy", "1 %", "--json")
    told = only_object(out)["accuracy"]
    assert code == 0 and told["met"] is True and told["reached"] <= 0.01
    assert "accuracy of 1 % asked for" in err and "reached" in err
    assert Result.read("mass.nc").accuracy == told


@pytest.mark.parametrize(
    "given, cause",
    [
        (["0"], "must be greater than zero"), (["-1"], "must be greater than zero"),
        (["200 %"], "give a share such as 0.01"), (["100 %"], "must be less than 1"),
        (["good"], "is not a number"), (["1 %", "--step", "1 ms"], "beside --step"),
        (["1 %", "--method", "rk4"], "beside --method"), (["1 %", "--verify"], "beside --verify"),
    ],
)  # fmt: skip
def test_what_cannot_be_asked_for_ends_with_code_2_and_writes_nothing(command, tmp_path, given, cause):
    before = files(tmp_path)
    code, _, err = command("simulate", "mass.yaml", f"--accuracy={given[0]}", *given[1:])
    assert code == 2 and "--accuracy" in err and cause in err
    assert files(tmp_path) == before


@pytest.mark.parametrize("given, asked", [("60 %", False), ("0.6", True)])
def test_a_unit_is_asked_for_only_where_none_was_typed(command, given, asked):
    code, _, err = command("simulate", "mass.yaml", "--accuracy", given)
    told = " ".join(err.split())
    assert code == 0 and "is unusual for a relative error" in told
    assert ("Then write the unit" in told) is asked


def test_an_accuracy_that_is_not_reached_ends_with_code_3_and_keeps_the_result(command, monkeypatch):
    monkeypatch.setattr(module, "RUNS", 3)
    code, out, err = command("simulate", "mass.yaml", "--accuracy", "1e-7", "--json")
    told = only_object(out)["accuracy"]
    assert code == 3 and told["met"] is False and told["why"] and "is not reached" in " ".join(err.split())
    assert Result.read("mass.nc").time[-1] == pytest.approx(5.0)


def test_a_step_that_is_given_leaves_the_accuracy_of_a_scene_aside_and_says_so(command, tmp_path):
    (tmp_path / "mass.yaml").write_text(oscillator(accuracy="1 %"))
    code, out, err = command("simulate", "mass.yaml", "--step", "10 ms", "--json")
    assert code == 0 and only_object(out)["accuracy"] is None and "--step is given" in err


def test_a_run_whose_step_was_chosen_is_gone_on_with_at_that_step(command, tmp_path):
    (tmp_path / "mass.yaml").write_text(oscillator(accuracy="1 %"))
    assert command("simulate", "mass.yaml", "-o", "first.nc")[0] == 0
    code, out, _ = command("simulate", "mass.yaml", "--end", "6", "--resume", "first.nc", "-o", "on.nc", "--json")
    assert code == 0
    assert only_object(out)["step"] == Result.read("first.nc").attributes["step"]


def test_a_run_that_is_left_while_its_step_is_chosen_is_gone_on_with_at_the_step_it_had(command, tmp_path):
    text = oscillator(accuracy="1 %")
    (tmp_path / "mass.yaml").write_text(text)
    scene = parse(text)
    left = Cable().build(Cable().with_overrides(scene, step=0.0025, control="fixed"))

    def leave(*_):
        raise KeyboardInterrupt

    with pytest.raises(Interrupted):
        simulate(left, tmp_path / "left.nc", leave)
    assert Result.read(tmp_path / "left.nc").accuracy is None
    code, out, _ = command("simulate", "mass.yaml", "--resume", "left.nc", "-o", "on.nc", "--json")
    assert code == 0
    assert only_object(out)["step"] == pytest.approx(0.0025, rel=1e-9)
    assert Cable().build(scene).solver.step != pytest.approx(0.0025)
