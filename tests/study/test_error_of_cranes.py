"""What a crane states of the error of its whole run, unasked, from one run with longer steps."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from study.commands import command_of
from test_study_verbs import only_object

import tautline
from crane.application import Crane
from drillstring.application import Drillstring
from tautline.results.result import Result
from tautline.study.trials.errors import apart, ends_apart, force_size
from tautline.study.trials.history import watch
from tautline.study.trials.step_error import HALF, LONGER, SHORTER, at_common_times, estimate, runs_for
from tautline.study.trials.trial import Setting, Subject

DATA = Path(__file__).parents[2] / "data"
STOP = {"table": {"time": [0, 1, 3, 3.2], "value": [0, -2, -2, 0]}}
SCENES = {
    "a payload of 20 t": ("hoist", {"bodies[0].mass": "20 t", "solver.end": "8 s"}),
    "a winch that stops within 0.2 s, and rope that goes slack": (
        "hoist", {"path[0].drum.pay_out": STOP, "solver.end": "5 s"},
    ),
    "a boom that slews": ("slewing", {}),
    "a hook block with capstan friction": ("hookblock", {"solver.end": "6 s"}),
    "a step that is chosen": ("hoist", {"solver.step": "auto", "solver.end": "8 s"}),
    "two steps a frame": (
        "slewing", {"solver.step": "25 ms", "frames[0].slew.ramp": {"rate": 0.2, "over": 1.0}},
    ),
}  # fmt: skip


def scene_of(name, **keys):
    return Crane().read(DATA / f"{name}.yaml").replace(keys)


def model_of(name, **keys):
    return Subject(Crane(), scene_of(name, **keys)).model(Setting())


@pytest.mark.parametrize("name", SCENES)
def test_a_crane_states_at_least_half_of_its_error_and_no_more_than_ten_times_it(name):
    """The error is that against a tenth of the step, with a thousandth of the error of each."""
    shipped, keys = SCENES[name]
    subject = Subject(Crane(), scene_of(shipped, **keys))
    model, run = subject.model(Setting()), subject.run(Setting())
    told = estimate(subject, run.result, parts=runs_for(model))
    exact = subject.run(Setting(step=model.solver.step / 10.0, step_error=model.solver.step_error / 1000.0))
    watched = watch(run.result)
    ours, true = at_common_times(watched.of(run.result), watched.of(exact.result))
    distance, position, amplitude = apart(ours, true, watched.extent)
    assert 0.5 * distance <= told.distance <= 10.0 * distance and 0.5 * position <= told.position
    assert 0.5 * amplitude <= told.force <= 10.0 * ends_apart(ours.force, true.force)


# Whole newtons: their differences are exact, so that the claim needs no tolerance.
FORCES = st.lists(st.integers(-(10**6), 10**6), min_size=2, max_size=8)


@given(a=FORCES, b=FORCES)
def test_ends_of_a_force_are_apart_by_no_less_than_its_amplitude(a, b):
    a, b = np.array(a, float), np.array(b, float)
    assume(force_size(b) > 0.0)
    assert ends_apart(a, b) >= abs(np.ptp(a) - np.ptp(b)) / (2.0 * force_size(b))


def test_errors_of_the_highest_and_the_lowest_force_do_not_cancel():
    assert ends_apart(np.array([1.0, 3.0]), np.array([0.0, 2.0])) == 1.0
    assert ends_apart(np.zeros(2), np.zeros(2)) == 0.0 and ends_apart(np.ones(2), np.zeros(2)) == np.inf


@pytest.mark.parametrize(("step", "part"), [("2 ms", 25 / 18), ("5 ms", 10 / 7), ("20 ms", 1.5), ("10 ms", 1.25)])
def test_the_longer_step_of_a_crane_divides_its_frames_evenly(step, part):
    model = model_of("hoist", **{"solver.step": step})
    assert (
        runs_for(model) == (pytest.approx(part),) and runs_for(model, True) == SHORTER and runs_for(model, False) == ()
    )


@pytest.mark.parametrize("step", ["auto", "50 ms", "25 ms"])
def test_a_crane_with_one_or_two_steps_a_frame_takes_half_the_step(step):
    """No step is a little longer. With twice a step of 25 ms a slewing crane stated a third of its force's error."""
    assert runs_for(model_of("hoist", **{"solver.step": step})) == HALF


def test_a_crane_with_fixed_steps_is_looked_at_as_anything_else_with_fixed_steps():
    fixed = {"solver.control": "fixed"}
    assert runs_for(model_of("hoist", **fixed)) == SHORTER and runs_for(model_of("sixteen_falls", **fixed)) == LONGER
    assert runs_for(model_of("hoist", **{"solver.method": "rk4", "solver.step": "1 ms"})) == HALF


def test_controlled_steps_of_a_drill_string_state_nothing_unasked():
    """Friction on its wall decides what slips first: a longer step stated a third of the error."""
    string = Drillstring().with_overrides(Drillstring().read(DATA / "jwell.yaml"), control="error", step_error=1e-5)
    assert runs_for(Drillstring().build(string)) == ()


@pytest.mark.parametrize("name", ["hoist", "slewing", "landing"])
def test_the_other_run_of_a_crane_takes_fewer_steps_than_the_run_itself(name):
    subject = Subject(Crane(), scene_of(name, **{"solver.end": "5 s"}))
    model = subject.model(Setting())
    (part,) = runs_for(model)
    longer = Setting(step=model.solver.step * part, step_error=model.solver.step_error * part**3)
    run, other = subject.run(Setting()), subject.run(longer)
    assert other.attribute("steps") <= 0.75 * run.attribute("steps")
    assert other.attribute("newton_iterations") <= run.attribute("newton_iterations")


def test_a_run_from_python_does_not_pay_for_an_estimate():
    """It is the verb `simulate` that states the error, as it is for a drill string."""
    assert tautline.simulate(scene_of("hoist", **{"solver.end": "0.2 s"})).step_error is None


# on the command line
@pytest.fixture
def crane(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    return command_of(Crane(), monkeypatch, capsys)


def test_a_crane_states_its_error_unasked_and_the_result_keeps_it(crane):
    code, out, err = crane("simulate", str(DATA / "slewing.yaml"), "--end", "4", "--json")
    report = only_object(out)
    told = report["step_error"]
    assert code == 0 and told["steps"] == pytest.approx([0.05 / 7]) and told["bound"] == pytest.approx(3e-5)
    assert "estimated error due to the step" in err and "a run with longer steps; --no-verify leaves" in err
    assert told["place"] == "position of payload"
    assert told["force_place"] == "axial force of winch to boom tip, element 1 of 3"
    assert Result.read("slewing.nc").step_error == told


def test_no_verify_leaves_the_error_of_a_crane_out(crane):
    code, out, err = crane("simulate", str(DATA / "slewing.yaml"), "--end", "1", "--json", "--no-verify")
    assert code == 0 and only_object(out)["step_error"] is None and "estimat" not in err


def test_a_large_error_of_a_crane_is_warned_of_with_what_bounds_its_steps(crane):
    stop = "path[0].drum.pay_out={table: {time: [0, 1, 3, 3.2], value: [0, -2, -2, 0]}}"
    code, out, _ = crane("simulate", str(DATA / "hoist.yaml"), "--end", "5", "--json", "--set", stop)
    (warning,) = [text for text in only_object(out)["warnings"] if "may be off" in text]
    assert code == 0 and "estimated from a run with 1.43 times the step, 0.00714 s" in warning
    keys = "a smaller solver.step_error (now 3e-05 m) and a smaller solver.step (now 0.005 s)"
    assert keys in warning and "run with --verify" in warning
    assert warning.startswith("the amplitude of the axial force")


def test_a_crane_on_rk4_whose_step_is_chosen_for_stability_states_no_less_than_its_error_unasked():
    keys = {"solver.method": "rk4", "solver.step": "auto", "solver.rho_inf": None, "solver.end": "0.5 s"}
    subject = Subject(Crane(), scene_of("hoist", **keys))
    model, run = subject.model(Setting()), subject.run(Setting())
    assert runs_for(model) == HALF
    told = estimate(subject, run.result, parts=HALF)
    # The other run takes half of the step that was taken, and not half of the longest there may be, which is unstable.
    assert told.step == pytest.approx(0.5 * run.result.attributes["step"], rel=0.1)
    exact = subject.run(Setting(step=1e-4))
    watched = watch(run.result)
    _, position, force = apart(*at_common_times(watched.of(run.result), watched.of(exact.result)), watched.extent)
    assert position <= told.position <= 10.0 * position and force <= told.force <= 10.0 * force


def test_simulate_prints_the_error_of_a_crane_on_rk4_with_automatic_steps(tmp_path, monkeypatch, capsys):
    result = tmp_path / "hoist.nc"
    options = ("--method", "rk4", "--step", "auto", "--end", "0.5", "-o", str(result))
    code, _, said = command_of(Crane(), monkeypatch, capsys)("simulate", str(DATA / "hoist.yaml"), *options)
    assert code == 0 and "estimating the error from a run with half the step" in said
    assert Result.read(result).step_error["position"] > 0.0
