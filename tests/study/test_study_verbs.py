"""The verbs study and stability at the command line: exit codes, files, JSON, and what a person is told."""

import json
import re
import signal
import sys
from pathlib import Path

import pytest
from study.oscillators import OMEGA, chain, oscillator, rk4

from tautline.cable.application import Cable
from tautline.cli.run import run
from tautline.cli.verbs import make_app
from tautline.scene.errors import SceneWarning
from tautline.study.robustness import stability
from tautline.study.robustness import variants as variants_module

STUDY = ("study", "bar.yaml", "--methods", "newmark", "--steps", "10 ms,5ms", "--repeat", "1")
FEW = ("as it stands", "step x 0.1", "step x 10")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("bar.yaml").write_text(oscillator(time_end=0.6), encoding="utf8")
    Path("tied.yaml").write_text(chain(100.0, time_end=0.5), encoding="utf8")
    Path("stops.yaml").write_text(oscillator(**rk4(time_step=0.5, time_end=5.0, plotpoints=0)), encoding="utf8")
    # A quick look is of twenty frames.
    Path("looked.yaml").write_text(oscillator(time_end=1.0, plotpoints=50), encoding="utf8")
    Path("broken.yaml").write_text(oscillator().replace("EA: 100.0", "EA: much"), encoding="utf8")
    return tmp_path


@pytest.fixture
def cable(folder, monkeypatch, capsys):
    """Run a command in this process, as a console script does: exit code, standard output, standard error."""

    def command(*arguments):
        monkeypatch.setattr(sys, "argv", ["cable", *map(str, arguments)])
        with pytest.raises(SystemExit) as left:
            run(make_app(Cable(), sys.argv[1:]))
        captured = capsys.readouterr()
        return left.value.code or 0, captured.out, captured.err

    return command


@pytest.fixture
def sketched(monkeypatch):
    """Figures are written as empty files: drawing takes as long as all else."""
    for name in ("work_precision", "stability_figure"):
        monkeypatch.setattr(f"tautline.study.figures.{name}", lambda found, title, path: path.touch() or path)


@pytest.fixture
def few(monkeypatch):
    """Stability with three variants and without its bisection."""
    # It takes the function as it is imported: not the one that stands in here.
    assert stability.changes is not None
    chosen = [change for change in variants_module.changes(False) if change.name in FEW]
    monkeypatch.setattr(variants_module, "changes", lambda quick: chosen)
    monkeypatch.setattr("tautline.study.robustness.critical.bisect", lambda *_: (0.28, 0.283))


def only_object(out):
    """The one JSON object on standard output; Python's own reader would let NaN pass."""
    return json.loads(out, parse_constant=lambda word: pytest.fail(f"{word} in JSON"))


def made(folder):
    return sorted(file.name for file in folder.iterdir() if file.suffix != ".yaml")


# study
def test_study_writes_its_files_and_ends_with_a_sentence_of_advice(cable, folder):
    code, out, err = cable(*STUDY)
    assert (code, out) == (0, "")
    assert made(folder) == ["bar_study.csv", "bar_study.nc", "bar_study.png"]
    for name in made(folder):
        assert f"wrote {name}" in err
    for words in (
        "newmark",
        "reference (proved): rk4",
        "observed order 4",
        "compared: position of node 1",
        "cores",
        "load",
    ):
        assert words in err
    assert re.search(r"cheapest with an error below 1 %|no run has an error below 1 %", err)


def test_study_prints_one_json_object_and_all_else_on_standard_error(cable, sketched):
    code, out, err = cable(*STUDY, "--json", "--tolerance", "5 %")
    report = only_object(out)
    assert code == 0 and "wrote bar_study.csv" in err
    assert (report["scene"], report["status"], report["tolerance"]) == ("bar.yaml", "done", 0.05)
    assert [run["step"] for run in report["runs"]] == pytest.approx([0.01, 0.005])
    assert report["files"] == ["bar_study.csv", "bar_study.nc", "bar_study.png"]
    assert report["reference"]["converged"] is True and report["advice"].startswith("cheapest")


def test_every_run_stands_in_a_row_of_the_table_whatever_became_of_it(cable, sketched):
    code, _, err = cable("study", "bar.yaml", "--methods", "RK4,G-alpha", "--steps", "0.5,10ms", "--repeat", "1")
    assert code == 0
    rows = [line.split() for line in err.splitlines() if line.startswith(("rk4", "generalized-alpha"))]
    assert [(row[0], row[-1]) for row in rows] == [
        ("rk4", "UNSTABLE"), ("rk4", "done"), ("generalized-alpha", "done"), ("generalized-alpha", "done"),
    ]  # fmt: skip


def test_files_go_where_they_are_sent_and_keep_their_points(cable, folder, sketched):
    Path("there").mkdir()
    assert cable(*STUDY, "-o", "there/run1.5")[0] == 0
    assert made(folder / "there") == ["run1.5.csv", "run1.5.nc", "run1.5.png"]
    assert cable(*STUDY, "-o", "there/other.csv")[0] == 0
    assert "other.csv" in made(folder / "there") and "other.png" in made(folder / "there")


def test_a_reference_can_be_chosen_and_a_coarse_one_is_not_proved(cable, sketched):
    code, out, err = cable(*STUDY, "--reference", "newmark", "--reference-step", "50 ms", "--json")
    reference = only_object(out)["reference"]
    assert code == 0 and (reference["method"], reference["converged"]) == ("newmark", False)
    assert reference["step"] == pytest.approx(0.05, rel=0.2)
    assert "reference (NOT proved): newmark" in err and "warning: the reference is not proved" in err
    reference = only_object(cable(*STUDY, "--reference", "newmark", "--json")[1])["reference"]
    assert (reference["method"], reference["converged"]) == ("newmark", True)


def test_constraints_meshes_ends_and_points_can_be_named(cable, sketched):
    report = only_object(
        cable("study", "tied.yaml", "--methods", "newmark", "--steps", "5ms", "--repeat", "1", "--constraints",
              "penalty,lagrange", "--end", "0.3", "--point", "2", "--json")[1]
    )  # fmt: skip
    assert [run["constraint"] for run in report["runs"]] == ["penalty", "lagrange"]
    assert report["point"] == "position 2" and report["runs"][0]["steps"] == 60


def test_a_quick_look_is_short(cable, sketched):
    code, out, _ = cable("study", "looked.yaml", "--quick", "--json")
    report = only_object(out)
    assert code == 0 and all(run["repetitions"] == 1 for run in report["runs"] if run["status"] == "done")
    assert {run["method"] for run in report["runs"]} == {"rk4", "generalized-alpha"}
    assert max(run["steps"] for run in report["runs"]) <= 0.4 / 0.0025
    assert "the first 0.4 s of 1 s" in report["left_out"] and "every other step" in report["left_out"][1]


BAD = [
    (("--steps", "soon"), "--steps", "soon"), (("--methods", "euler"), "--methods", "euler"),
    (("--elements", "0"), "--elements", "0"), (("--tolerance", "1,5 %"), "--tolerance", "1,5 %"),
    (("--tolerance", "90 %"), "--tolerance", "90 %"), (("--constraints", "glue"), "--constraints", "glue"),
    (("--newton", "half"), "--newton", "half"),
    (("--reference", "rk4,newmark"), "--reference", "rk4"), (("--reference-step", "-1"), "--reference-step", "-1"),
    (("--point", "hook"), "--point", "hook"), (("--repeat", "0"), "--repeat", ""), (("--budget", "0"), "--budget", ""),
    (("--end", "-1"), "--end", "-1"), (("--end", "0.001"), "--end", "0.001"), (("--end", "nan"), "--end", "nan"),
    (("-o", "nowhere/x"), "nowhere", "folder"), (("--stepp", "1"), "--stepp", ""),
]  # fmt: skip
"""Options that cannot be, what the message names, and the value or the word that it says."""


@pytest.mark.parametrize(("options", "named", "value"), BAD, ids=lambda x: " ".join(x) if isinstance(x, tuple) else "")
def test_a_bad_option_is_named_with_its_value_and_nothing_is_written(cable, folder, options, named, value):
    code, out, err = cable(*STUDY[:2], *options)
    assert (code, out) == (2, "") and made(folder) == []
    assert named in err and value in err and "Traceback" not in err
    assert ";" in err, "no cure"


@pytest.mark.parametrize("verb", ["study", "stability"])
@pytest.mark.parametrize("scene", ["missing.yaml", "broken.yaml"])
def test_a_bad_scene_is_refused_as_everywhere(cable, folder, verb, scene):
    code, out, err = cable(verb, scene, "--json")
    assert code == 2 and only_object(out)["status"] == "bad input"
    assert scene in err and made(folder) == []


def test_a_target_that_is_a_folder_is_refused_before_anything_is_run(cable, folder):
    (folder / "bar_study.nc").mkdir()
    code, _, err = cable(*STUDY)
    assert code == 2 and "bar_study.nc" in err and "folder" in err and made(folder) == ["bar_study.nc"]


def test_a_scene_that_stops_as_it_stands_is_studied_with_the_settings_that_do_not(cable, folder, sketched):
    code, out, err = cable("study", "stops.yaml", "--methods", "rk4,generalized-alpha", "--json")
    report = only_object(out)
    assert (code, report["status"]) == (3, "unstable") and "bar_study.nc" not in made(folder)
    assert report["stopped"]["sentence"] and "as it stands stopped" in err
    assert any(run["status"] == "done" and run["position_error"] < 0.1 for run in report["runs"])
    assert {"stops_study.csv", "stops_study.nc", "stops_study.png"} <= set(made(folder))


def test_a_scene_that_stops_with_every_setting_is_told_and_not_studied(cable, folder):
    code, out, err = cable("study", "stops.yaml", "--methods", "rk4", "--steps", "0.5", "--json")
    report = only_object(out)
    assert (code, report["status"]) == (3, "unstable") and made(folder) == []
    assert report["stopped"]["sentence"] and "as it stands stopped" in err


def test_the_critical_step_of_a_scene_that_stops_is_told(cable, few, sketched):
    """That of one element pinned at one end: 2.8 over its angular frequency, as `oscillators` has it."""
    code, out, err = cable("stability", "stops.yaml", "--json")
    report = only_object(out)
    assert (code, report["status"]) == (3, "unstable") and "as it stands stopped" in err
    assert report["critical_step"]["eigenvalue"] == pytest.approx(2.8 / OMEGA, rel=0.02)


def test_why_a_setting_is_refused_stands_below_the_table(cable, sketched):
    err = cable(*STUDY[:2], "--steps", "100,0.01", "--methods", "generalized-alpha")[2]
    assert "refused: generalized-alpha, step 100 s: " in " ".join(err.split())


def test_a_grid_of_which_nothing_can_be_run_is_refused_with_the_key_and_the_options_that_help(cable, folder):
    code, _, err = cable("study", "bar.yaml", "--steps", "100", "--methods", "generalized-alpha")
    said = " ".join(err.split())
    assert code == 2 and made(folder) == []
    assert "no setting can be run: GeneralizedAlpha.time_end = 0.6: " in said
    assert "give other --steps, --methods or --elements, or a later --end" in said


def test_an_error_that_nothing_can_be_below_is_refused_in_python(folder):
    import tautline
    from tautline.scene.errors import SceneError

    for tolerance in (-1.0, 0.0, float("nan"), float("inf")):
        for verb in (tautline.study_errors, tautline.study_stability):
            with pytest.raises(SceneError, match="tolerance"):
                verb("bar.yaml", tolerance=tolerance)
    with pytest.raises(TypeError, match="not int"):
        tautline.simulate(5)


def interrupting(monkeypatch, after):
    """Have Ctrl-C pressed in the time loop of the run with this number, as a terminal would."""
    from tautline import run as running

    run_steps, calls = running.run_steps, []

    def pressed(method, system, *rest):
        calls.append(id(system))
        if len(dict.fromkeys(calls)) > after:
            signal.raise_signal(signal.SIGINT)
        return run_steps(method, system, *rest)

    monkeypatch.setattr(running, "run_steps", pressed)


@pytest.mark.parametrize("after", [0, 3])
def test_ctrl_c_ends_a_study_with_130_and_what_there_was_is_reported(cable, folder, monkeypatch, sketched, after):
    interrupting(monkeypatch, after)
    steps = "40ms,20ms,10ms,5ms"
    code, out, err = cable("study", "bar.yaml", "--methods", "newmark", "--steps", steps, "--repeat", "1", "--json")
    assert code == 130 and "interrupted" in err and "Traceback" not in err and "fault of the program" not in err
    if after:
        report = only_object(out)
        assert report["status"] == "interrupted" and 1 <= len(report["runs"]) < 4
        assert made(folder) == ["bar_study.csv", "bar_study.nc", "bar_study.png"]


@pytest.mark.parametrize("after", [0, 4])
def test_ctrl_c_ends_stability_with_130(cable, few, monkeypatch, after):
    interrupting(monkeypatch, after)
    code, _, err = cable("stability", "bar.yaml")
    assert code == 130 and "interrupted" in err and "Traceback" not in err and "fault of the program" not in err


# stability
def test_stability_tells_what_limits_the_step_and_what_breaks(cable, few, folder):
    code, out, err = cable("stability", "bar.yaml", "--json", "--tolerance", "5 %")
    report = only_object(out)
    assert code == 0 and report["status"] == "done"
    assert report["critical_step"]["eigenvalue"] == pytest.approx(2.8 / OMEGA, rel=1e-3)
    assert [variant["name"] for variant in report["variants"]] == list(FEW)
    assert [variant["outcome"] for variant in report["variants"]] == ["right", "right", "inaccurate"]
    assert made(folder) == ["bar_stability.csv", "bar_stability.png"] == report["files"]
    for words in ("by effective length", "by eigenvalues", "set by", "stiffness of linear tension", "condition number",
                  "energy drift", "tangent", "3 variants: no wrong result without a warning"):  # fmt: skip
        assert words in err
    assert "constraint drift" not in err and "S_T" not in err and "set by " in err


def test_stability_tells_which_of_its_critical_steps_to_stay_below_and_counts_warnings_in_words(cable, few):
    """The bar's lie a few per cent apart, those of a lift a hundredfold: which of them counts was not said."""
    _, out, err = cable("stability", "bar.yaml", "--json")
    report = only_object(out)
    step = float(re.search(r"stay below, the smallest of these +(\S+) s", err)[1])
    # one element pinned at one end, by hand; the longest stable step of real runs lies below it by less than 1 %
    assert 0.97 * 2.8 / OMEGA < step <= report["critical_step"]["eigenvalue"] * (1.0 + 1e-3)
    assert any(variant["warned"] for variant in report["variants"])
    assert re.search(r" 1 warning *$", err, re.MULTILINE) and "1 x" not in err


@pytest.mark.parametrize("verb", ["study", "stability"])
def test_warnings_of_the_scene_stand_in_json_as_they_are_printed(cable, few, sketched, monkeypatch, verb):
    told = SceneWarning("mass", "10 kg is unusual")
    monkeypatch.setattr(Cable, "warnings", lambda self, scene: [told])
    words = STUDY if verb == "study" else (verb, "bar.yaml")
    _, out, err = cable(*words, "--json")
    assert only_object(out)["scene_warnings"] == [{"where": "mass", "text": "10 kg is unusual"}]
    assert f"warning: {told}" in err
    code, out, _ = cable("study", "stops.yaml", "--methods", "rk4", "--steps", "0.5", "--json")
    assert code == 3 and only_object(out)["scene_warnings"] == [{"where": "mass", "text": "10 kg is unusual"}]


def test_stability_of_a_scene_with_ties_tells_what_multipliers_do(cable, few, sketched):
    code, out, err = cable("stability", "tied.yaml", "--json", "--end", "0.3")
    report = only_object(out)
    assert code in (0, 3) and report["constraint_drift"] < 1e-12 and "constraint drift" in err
    assert "without the scaling" in err and report["conditioning"][0]["unscaled"] > report["conditioning"][0]["scaled"]


def test_a_quick_look_at_stability_names_what_it_has_not_tried(cable, sketched, monkeypatch):
    monkeypatch.setattr("tautline.study.robustness.critical.bisect", lambda *_: (0.28, 0.283))
    code, out, err = cable("stability", "looked.yaml", "--quick", "--json")
    report = only_object(out)
    time, names, judge = report["left_out"]
    assert code == 0 and time == "the first 0.4 s of 1 s" and "quarter" in judge
    missing = names.removeprefix("not tried: ").split(", ")
    assert {"stiffness x 0.001", "step x 100", "rho_inf 0.5"} <= set(missing) and "contact" not in names
    assert not set(missing) & {variant["name"] for variant in report["variants"]}
    assert "a quick look: the first 0.4 s of 1 s; not tried: stiffness x 0.001" in " ".join(err.split())


def test_variants_that_nobody_could_judge_are_counted_beside_those_that_are_right(cable, few, sketched, monkeypatch):
    monkeypatch.setattr("tautline.study.trials.trial.Trial.cpu_time", 15.0)
    code, out, err = cable("stability", "bar.yaml", "--json")
    assert code == 0 and {variant["outcome"] for variant in only_object(out)["variants"]} == {"unjudged"}
    assert "3 variants, 3 of them not judged" in err and "3 variants: none" not in err


def test_a_variant_that_is_wrong_without_a_word_ends_with_3_and_is_shown(cable, few, sketched, monkeypatch):
    """What a run says of itself is taken away: no warning, no lag, no energy, no error of its step."""
    monkeypatch.setattr("tautline.study.robustness.variants.runs_for", lambda *_: ())
    monkeypatch.setattr("tautline.run.Run.warnings", lambda *_: [])
    monkeypatch.setattr("tautline.run.Run.phase_lag", lambda *_: 0.0)
    monkeypatch.setattr("tautline.run.Run.energy_gained", lambda *_: 0.0)
    code, out, err = cable("stability", "bar.yaml", "--json")
    report = only_object(out)
    assert code == 3
    assert [variant["silent"] for variant in report["variants"] if variant["name"] == "step x 10"] == [True]
    assert "SILENT" in err and "ended with a wrong result and no warning" in err
    assert any("step x 10: wrong by" in warning for warning in report["warnings"])


@pytest.mark.parametrize(
    ("options", "named"),
    [(("--tolerance", "1,5"), "--tolerance"), (("--budget", "0"), "--budget"), (("--end", "0.001"), "--end"),
     (("--point", "hook"), "--point"), (("-o", "nowhere/x"), "nowhere"), (("--steps", "1ms"), "--steps")],
)  # fmt: skip
def test_bad_options_of_stability_are_refused_and_nothing_is_written(cable, few, folder, options, named):
    code, out, err = cable("stability", "bar.yaml", *options)
    assert (code, out) == (2, "") and named in err and made(folder) == [] and "Traceback" not in err


# the same from Python, and what simulate says
def test_both_are_one_call_from_python(folder, few):
    import tautline
    from tautline.study.accuracy.precision import Grid

    found = tautline.study_errors("bar.yaml", end=0.5, grid=Grid(("newmark",), (0.01,)), repetitions=1)
    assert found.reference.converged and found.rows[0].trial.attribute("steps") == 50
    assert tautline.study_stability(tautline.read("bar.yaml"), end=0.5).critical.omega_max == pytest.approx(OMEGA)


def test_simulate_tells_its_numerical_dissipation_and_warns_of_few_steps(cable):
    code, out, err = cable("simulate", "bar.yaml", "--step", "0.1", "--rho-inf", "0.5", "--json")
    report = only_object(out)
    assert code == 0 and report["numerical_dissipation"] > 0.0 and "numerical dissipation" in err
    assert report["motion_frequency"] == pytest.approx(OMEGA / 6.2832, rel=0.3)
    assert (
        any("steps per period" in warning for warning in report["warnings"])
        and "warning: the motion oscillates at" in err
    )
