"""The one sentence that a study ends with, for made-up runs."""

import re
from dataclasses import replace

from tautline.study.accuracy.findings import advice, good_enough, real_time
from tautline.study.accuracy.precision import Row, Study
from tautline.study.accuracy.reference import Reference
from tautline.study.trials.errors import Errors
from tautline.study.trials.trial import Setting, Trial


class Stored:
    """As much of a result as a row looks at: ten seconds."""

    def __init__(self):
        self.time, self.attributes = [0.0, 10.0], {"step": 0.01}


def row(name, error, factor, status="done", step=0.01):
    """A run called by its method with a relative error, None if it has none, and a real-time factor."""
    stored = Stored() if factor is not None else None
    wall = () if factor is None else (10.0 * factor,)
    trial = Trial(Setting(name, step), status, "", stored, wall, wall)
    return Row(trial, None if error is None else Errors(error, None, None, 0.0))


def made(*rows, tolerance=0.01, own=1e-5, mesh=0.0, reference=True, force=None, unseen=""):
    judge = Reference(None, None, Setting("rk4", 1e-4), (), 4.0, own, True, "", mesh, force) if reference else None
    return Study(tuple(rows), judge, None, tolerance, None, (0.0, 0.0), unseen=unseen)


def with_errors(name, factor, position=1e-4, force=None, phase=None):
    return replace(row(name, position, factor), errors=Errors(position, force, phase, 0.0))


def names(rows):
    return [r.trial.setting.method for r in rows]


SLOW, FAIR, QUICK = row("slow", 1e-4, 3.0), row("fair", 5e-3, 0.5), row("quick", 0.3, 0.01)


def test_the_cheapest_below_the_error_asked_for_is_advised_and_the_most_accurate_in_real_time():
    text = advice(made(SLOW, FAIR, row("better", 1e-3, 0.9), QUICK))
    assert text.startswith("cheapest with an error below 1 %: fair, step 0.01 s (error 0.5 %, real-time factor 0.5)")
    assert "most accurate in real time: better" in text


def test_where_one_run_is_both_it_is_named_once():
    text = advice(made(SLOW, FAIR, QUICK))
    assert "and it is the most accurate in real time as well" in text and text.count("fair") == 1


def test_where_the_cheapest_is_not_real_time_that_is_said():
    text = advice(made(SLOW, QUICK))
    assert text.startswith("cheapest with an error below 1 %: slow") and "which is not real time" in text
    assert "most accurate in real time: quick" in text


def test_where_none_is_faster_than_real_time_that_is_said():
    assert advice(made(SLOW, row("slower", 1e-6, 30.0))).endswith("none is faster than real time")


def test_where_none_is_good_enough_the_best_is_named_with_what_to_do():
    text = advice(made(QUICK, row("worse", 0.5, 0.001), tolerance=0.002))
    assert text.startswith("no run has an error below 0.2 %: the best is quick") and "--steps" in text


def test_where_the_finest_mesh_is_not_good_enough_elements_are_advised_and_not_steps():
    text = advice(made(row("fair", 1e-3, 0.5), tolerance=0.005, mesh=0.02))
    assert "the reference's mesh alone is 2 % off" in text and "--elements" in text and "--steps" not in text


def test_where_an_error_has_stopped_falling_with_the_step_smaller_ones_are_not_advised():
    stalled = made(row("fair", 0.029, 0.1, step=0.02), row("fair", 0.028, 0.2), tolerance=0.005)
    assert "smaller steps do not help" in advice(stalled)
    falling = made(row("fair", 0.029, 0.1, step=0.02), row("fair", 0.008, 0.2), tolerance=0.005)
    assert "--steps" in advice(falling)


def test_where_no_run_came_to_its_end_there_is_no_advice():
    for rows in ((), (row("stopped", None, 0.1, "UNSTABLE"),), (row("refused", None, None, "refused"),)):
        assert advice(made(*rows)) == "no advice: no run came to its end"


def test_the_step_that_is_advised_is_the_one_that_was_taken():
    """A step of 0.0123 s that was asked for is 0.01 s between frames of 0.02 s."""
    asked = Row(Trial(Setting("fair", 0.0123), "done", "", Stored(), (1.0,), (1.0,)), FAIR.errors)
    assert "fair, step 0.01 s" in advice(made(asked))


def test_without_a_reference_there_is_no_advice():
    assert advice(made(SLOW, FAIR, reference=False)) == "no advice: there is no reference to judge by"


def test_the_references_own_error_counts_against_a_run():
    """A run 0.8 % off a reference that is 0.5 % off itself cannot be called good to one per cent."""
    near = row("near", 8e-3, 0.1)
    assert names(good_enough(made(near, own=1e-3))) == ["near"]
    assert names(good_enough(made(near, own=5e-3))) == []
    assert names(good_enough(made(near, mesh=5e-3))) == []


def test_runs_are_good_enough_by_their_price_and_live_by_their_error():
    study = made(SLOW, FAIR, row("cheap", 9e-3, 0.1), QUICK)
    assert names(good_enough(study)) == ["cheap", "fair", "slow"]
    assert names(real_time(study)) == ["fair", "cheap", "quick"]


def measured(name, cpu, wall=None, steps=1000):
    """A run that is good enough, by its processor times and, where something else disturbed them, its wall times, s."""
    one = row(name, 1e-4, 1.0)
    one.trial.result.attributes = {"step": 10.0 / steps, "steps": steps}
    return replace(one, trial=replace(one.trial, cpu=cpu, wall=cpu if wall is None else wall))


def test_the_cheapest_is_that_of_the_least_processor_time_however_long_others_had_it_wait():
    """Real time is told by the wall all the same."""
    waited, dear = measured("waited", (1.0,), wall=(30.0,)), measured("dear", (2.0,))
    assert names(good_enough(made(dear, waited))) == ["waited", "dear"]
    assert "waited, step 0.01 s (error 0.01 %, real-time factor 3), which is not real time" in advice(
        made(dear, waited)
    )


def test_of_runs_whose_repetitions_differ_by_more_than_they_do_the_longest_step_is_the_cheapest():
    fine, coarse = measured("fine", (0.9, 1.0, 1.1), steps=2000), measured("coarse", (0.95, 1.05, 1.2), steps=500)
    assert names(good_enough(made(fine, coarse))) == names(good_enough(made(coarse, fine))) == ["coarse", "fine"]
    sure = measured("fine", (0.9, 0.9, 0.9), steps=2000), measured("coarse", (1.05, 1.05, 1.2), steps=500)
    assert names(good_enough(made(*sure))) == ["fine", "coarse"], "one that was disturbed once leaves the median"


def test_advice_is_one_sentence():
    for rows in ((SLOW, FAIR, QUICK), (SLOW,), (QUICK,), ()):
        assert not re.search(r"\.\s|\n|\.$", advice(made(*rows)))


# force and phase
def test_a_run_whose_force_is_wrong_is_not_advised_however_right_its_position():
    wrong, right = with_errors("wrong", 0.1, force=0.3), with_errors("right", 0.5, force=2e-3)
    assert names(good_enough(made(wrong, right))) == ["right"]
    assert "right, step 0.01 s (error 0.01 %, of the force 0.2 %" in advice(made(wrong, right))
    text = advice(made(wrong))
    assert text.startswith("no run has an error below 1 %") and "of the force 30 %" in text


def test_a_run_whose_oscillation_is_late_is_not_advised_however_right_its_position():
    """A small oscillation on a long way: a radian of it is no share of the way."""
    late, right = with_errors("late", 0.1, phase=0.4), with_errors("right", 0.5, phase=1e-3)
    assert names(good_enough(made(late, right))) == ["right"]
    assert "phase 0.001 rad" in advice(made(late, right))
    assert names(real_time(made(late, right))) == ["right", "late"]


def test_a_force_that_the_reference_does_not_know_is_not_judged_and_that_is_said():
    text = advice(made(with_errors("fair", 0.1, force=0.3), force=0.05))
    assert text.startswith("cheapest with an error below 1 % in position and phase")
    near = with_errors("near", 0.1, force=7e-3)
    assert names(good_enough(made(near, force=1e-3))) == ["near"] and names(good_enough(made(near, force=5e-3))) == []


def test_a_twist_that_is_wrong_is_not_advised_and_one_that_the_reference_does_not_know_is_not_judged():
    """What sticks and slips turns while it hardly moves."""
    twisted = replace(row("twisted", 1e-4, 0.1), errors=Errors(1e-4, 2e-3, None, 0.0, 0.06))
    right = replace(row("right", 1e-4, 0.5), errors=Errors(1e-4, 2e-3, None, 0.0, 0.004))
    study = made(twisted, right)
    assert names(good_enough(study)) == ["right"] and "of the twist 0.4 %" in advice(study)
    near, unknown = (replace(study, reference=replace(study.reference, twist_error=x)) for x in (7e-3, 0.05))
    assert names(good_enough(near)) == []
    assert advice(unknown).startswith("cheapest with an error below 1 % in position, force and phase")
    assert "(the reference does not know the twist so well)" in advice(unknown)


# a part of a run
def test_a_look_at_a_part_of_a_run_advises_nothing_for_the_whole():
    text = advice(made(SLOW, FAIR, unseen="only the first 4 s of 40 s"))
    assert text.startswith("no advice for the whole run: only the first 4 s of 40 s; in what was looked at: cheapest")
    assert advice(made(unseen="only the first 4 s of 40 s")) == "no advice: no run came to its end"
