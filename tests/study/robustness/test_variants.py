"""Stiff and extreme variants of a scene: right, inaccurate by how much, or stopped by which error, and never silent."""

import numpy as np
import pytest
from study.oscillators import OMEGA, amplification, bar, chain, lag_constant, oscillator, rk4, subject

from tautline.scene.errors import Problem, SceneError
from tautline.study.robustness import variants as module
from tautline.study.robustness.variants import Variant, changes, variants
from tautline.study.trials import trial as trial_module
from tautline.study.trials.trial import Trial, run_model

END = 2.0


def varied(text, tolerance=0.01, budget=20.0, quick=True, **more):
    return {v.name: v for v in variants(subject(text), tolerance, budget, quick=quick, **more)}


def only(monkeypatch, *wanted):
    """Run these variants and no others."""
    chosen = [change for change in changes(False) if change.name in wanted]
    monkeypatch.setattr(module, "changes", lambda quick: chosen)


def error_of(h, rho=0.8, end=END, omega=OMEGA):
    """Largest distance of generalized-alpha's oscillation from the true one over the way 2 A, at its steps."""
    n, step = np.arange(round(end / h) + 1), amplification(omega * h, rho)
    start = np.array([1.0, 0.0, -((omega * h) ** 2)])
    motion = np.array([(np.linalg.matrix_power(step, int(k)) @ start)[0] for k in n])
    return np.abs(motion - np.cos(omega * h * n)).max() / 2.0


# errors
@pytest.mark.parametrize(
    ("name", "h", "rho", "omega"),
    [
        ("as it stands", 0.01, 0.8, OMEGA), ("step x 0.1", 0.001, 0.8, OMEGA), ("rho_inf 0", 0.01, 0.0, OMEGA),
        ("rho_inf 1", 0.01, 1.0, OMEGA), ("stiffness x 10", 0.01, 0.8, OMEGA * 10**0.5),
        ("stiffness x 0.1", 0.01, 0.8, OMEGA / 10**0.5),
    ],
)  # fmt: skip
def test_the_error_of_a_variant_is_that_of_its_method_at_its_step(monkeypatch, name, h, rho, omega):
    """By runs of a sixteenth of its step: within their own error, which is 1/256 of it."""
    only(monkeypatch, name)
    found = varied(oscillator(time_end=END, plotpoints=100), quick=False)[name]
    assert found.error == pytest.approx(error_of(h, rho, omega=omega), rel=0.03)
    assert found.status == "done"
    assert found.outcome == ("right" if found.error <= 0.01 else "inaccurate")


def test_the_tolerance_divides_right_from_inaccurate(monkeypatch):
    only(monkeypatch, "as it stands")
    error = error_of(0.01)
    for tolerance, outcome in ((1.2 * error, "right"), (0.8 * error, "inaccurate")):
        assert varied(oscillator(time_end=END, plotpoints=100), tolerance)["as it stands"].outcome == outcome


def test_a_step_that_cannot_follow_the_motion_is_inaccurate_and_has_said_so(monkeypatch):
    only(monkeypatch, "step x 10")
    found = varied(oscillator(time_end=END))["step x 10"]
    assert (
        found.outcome == "inaccurate"
        and any("steps per period" in text for text in found.warnings)
        and not found.silent
    )


def test_a_step_that_is_beyond_the_critical_one_is_stopped_by_name(monkeypatch):
    only(monkeypatch, "step x 100", "stiffness x 1e+06")
    found = varied(oscillator(time_end=END, **rk4(time_step=0.01, plotpoints=0)))
    assert {v.outcome for v in found.values()} == {"stopped"}
    assert {v.status for v in found.values()} == {"UNSTABLE"}
    assert not any(v.silent for v in found.values())


def test_what_lags_as_it_says_it_does_is_not_silent(monkeypatch):
    """Late by 0.2 rad at the end, which its own estimate says."""
    only(monkeypatch, "rho_inf 0")
    found = varied(oscillator(time_end=4.0, rho_inf=0.5))["rho_inf 0"]
    assert found.outcome == "inaccurate" and not found.silent
    assert found.lag == pytest.approx(lag_constant(0.0) * 0.01 * OMEGA * 4.0, rel=0.1)


# what a scene has
def test_a_scene_is_varied_in_what_it_has_and_in_nothing_else():
    found = varied(oscillator(time_end=0.2))
    assert not any("contact" in name for name in found)
    assert "as it stands" in found and "stiffness x 0.1" in found
    anchored = oscillator(items=["OneNodeSpring: {id: 0, nodes4: [1], stiffness: 10.0}"], time_end=0.2)
    assert "contact 10000 N/m" in varied(anchored)


@pytest.mark.parametrize("solver", [rk4(time_step=0.01), {"type": "Newmark", "rho_inf": None}])
def test_other_methods_have_no_spectral_radius_to_vary(solver):
    assert not any("rho_inf" in name for name in varied(oscillator(time_end=0.2, **solver)))


def test_an_element_that_is_a_hundredth_of_the_others_makes_rk4_unstable_and_leaves_implicit_methods_alone(monkeypatch):
    """Of a bar that takes 2.8 / 10.45 s: a hundredth of the element is a hundred times as fast."""
    name = "shortest element / 100"
    only(monkeypatch, "as it stands", name)
    explicit = varied(bar(1, start=1e-3, time_end=1.0, **rk4(time_step=0.02)))
    implicit = varied(bar(1, start=1e-3, time_end=1.0, time_step=0.02))
    assert explicit["as it stands"].outcome != "stopped"
    assert (explicit[name].outcome, explicit[name].status) == ("stopped", "UNSTABLE")
    assert implicit[name].outcome in ("right", "inaccurate") and not implicit[name].silent


def test_a_variant_that_cannot_be_is_refused_with_its_cause(monkeypatch):
    study = subject(oscillator(time_end=0.2))
    vary = study.application.vary

    def refusing(scene, what, *value):
        if what == "stiffness":
            raise SceneError([Problem("scene.yaml", 3, "EA", "1e99", "is more than can be", "less")])
        return vary(scene, what, *value)

    monkeypatch.setattr(study.application, "vary", refusing)
    found = {v.name: v for v in variants(study, 0.01, 20.0, quick=True)}
    refused = found["stiffness x 0.1"]
    assert (refused.outcome, refused.status) == ("refused", "is more than can be") and not refused.silent


# judging
def test_a_run_that_nothing_can_judge_is_unjudged_and_not_right(monkeypatch):
    only(monkeypatch, "as it stands")
    real = run_model

    def first_only(model, setting, **further):
        done = real(model, setting, **further)
        return done if setting.step is None else Trial(setting, "NOT_CONVERGED", "", done.result)

    monkeypatch.setattr("tautline.study.trials.trial.run_model", first_only)
    found = varied(oscillator(time_end=END))["as it stands"]
    assert found.outcome == "unjudged" and found.error is None and "no run with a shorter step" in found.status


def test_a_judge_that_would_take_too_long_is_not_asked(monkeypatch):
    only(monkeypatch, "as it stands")
    monkeypatch.setattr(Trial, "cpu_time", 6.0)
    found = varied(oscillator(time_end=END))["as it stands"]
    assert found.outcome == "unjudged" and "would take more than 20 s" in found.status


@pytest.mark.parametrize(
    ("shortest", "what"), [(1.0, "given up at t"), (0.005, "run to judge it by was given up at t")]
)
def test_a_run_that_takes_longer_than_it_may_is_given_up_and_unjudged(monkeypatch, shortest, what):
    """The clock jumps by a second with every look at a run whose steps are so short: the third is one too many."""
    only(monkeypatch, "as it stands")
    clock, real = [0.0], trial_module.Allowance

    class Slow(real):
        def __call__(self, state, t, method):
            clock[0] += float(method.last_step[0]) <= shortest and t > 0.0
            super().__call__(state, t, method)

    monkeypatch.setattr(trial_module, "Allowance", Slow)
    monkeypatch.setattr(trial_module.time, "thread_time", lambda: clock[0])
    found = varied(oscillator(time_end=END, plotpoints=20), budget=2.0)["as it stands"]
    assert found.outcome == "unjudged" and not found.silent
    assert what in found.status and "0.15 of 2 s" in found.status and "2 s that a run may take" in found.status


@pytest.mark.parametrize("control", [{"time_step": "auto"}, {"control": "error", "tolerance": 1e-7}])
def test_a_run_whose_steps_are_controlled_is_judged_by_shorter_ones(monkeypatch, control):
    """Steps of a hundredth of a second and frames of half a second: the judge's steps must be shorter than its own."""
    only(monkeypatch, "as it stands")
    found = varied(oscillator(time_end=END, plotpoints=2, **control))["as it stands"]
    assert found.error < 0.05 and not found.silent


def test_a_scene_at_rest_is_right_in_every_variant_that_can_be():
    found = varied(oscillator(start=0.0, time_end=0.5))
    # Nodes between massless elements are refused.
    assert all(v.outcome in ("right", "stopped", "refused") for v in found.values())
    assert found["as it stands"].outcome == "right" and found["as it stands"].error < 1e-6


def test_ties_are_varied_with_their_scene():
    found = varied(chain(100.0, time_end=1.0))
    assert found["stiffness x 1000"].outcome in ("right", "inaccurate") and not any(v.silent for v in found.values())


# silence
@pytest.mark.parametrize(
    ("outcome", "error", "told", "lag", "energy", "silent"),
    [
        ("inaccurate", 0.5, (), 0.0, 0.0, True), ("inaccurate", 0.5, ("careful",), 0.0, 0.0, False),
        ("inaccurate", 0.5, (), 0.3, 0.0, False), ("inaccurate", 0.5, (), 0.1, 0.0, True),
        ("inaccurate", 0.5, (), 0.0, 0.3, False), ("inaccurate", 0.5, (), 0.0, 0.1, True),
        ("inaccurate", np.inf, (), 0.1, 0.0, True), ("right", 0.005, (), 0.0, 0.0, False),
        ("stopped", None, (), 0.0, 0.0, False), ("unjudged", None, (), 0.0, 0.0, False),
    ],
)  # fmt: skip
def test_silent_is_what_is_wrong_by_more_than_it_says_of_itself(outcome, error, told, lag, energy, silent):
    """Twice its lag, or the root of the energy that it has lost."""
    assert Variant("x", outcome, error, "done", told, 1.0, lag, energy).silent is silent


def test_a_run_that_is_wrong_and_says_nothing_is_silent(monkeypatch):
    """The runs that judge get a spring of half the stiffness: what is judged is then wrong without knowing it."""
    only(monkeypatch, "as it stands")
    model = module.Subject.model

    def softer(self, setting):
        if setting.step is not None and setting.step < 0.009:
            return model(module.Subject(self.application, self.application.vary(self.scene, "stiffness", 0.5),
                                        interval=self.interval), setting)  # fmt: skip
        return model(self, setting)

    monkeypatch.setattr(module.Subject, "model", softer)
    found = varied(oscillator(time_end=END))["as it stands"]
    assert found.outcome == "inaccurate" and found.error > 0.3 and found.silent


def test_a_judge_whose_result_has_nothing_of_the_kind_makes_no_run_right(monkeypatch):
    """A result that lacks what is looked at is an error without measure, and not a small one."""
    only(monkeypatch, "as it stands")
    monkeypatch.setattr(module, "compare", lambda *_: (_ for _ in ()).throw(module.ResultError("x", "no", "")))
    found = varied(oscillator(time_end=END))["as it stands"]
    assert found.outcome == "inaccurate" and found.error == np.inf


def test_names_of_variants_are_each_others_only():
    names = [change.name for change in changes(False)]
    assert len(set(names)) == len(names)
    assert {change.name for change in changes(True)} < set(names)


# what the run states
def test_a_smooth_run_is_asked_for_what_simulate_states_of_its_error(monkeypatch):
    """Without friction nobody asked: what is found out by longer steps stands beside the error now."""
    only(monkeypatch, "rho_inf 0")
    found = varied(oscillator(time_end=4.0, rho_inf=0.5))["rho_inf 0"]
    assert found.outcome == "inaccurate" and not found.warnings
    assert found.error <= found.stated < 1.0


@pytest.mark.parametrize(("share", "silent"), [(0.4, True), (0.6, False)])
def test_a_run_that_states_less_than_half_of_its_error_is_silent(share, silent):
    assert Variant("x", "inaccurate", 0.19, "done", stated=share * 0.19).silent == silent
