"""The verbs ``check`` and ``simulate``."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from tautline.application.installed import Catalogue, key_of_setting, overridden
from tautline.cli.options.changes import as_given, change_of, changed
from tautline.cli.output.called import typed
from tautline.cli.output.console import console, print_json, say
from tautline.cli.output.disk_space import room_warning
from tautline.cli.output.duration import total_time
from tautline.cli.output.first_run import compiling
from tautline.cli.output.numba_version import version_note
from tautline.cli.output.preparing import preparing
from tautline.cli.output.progress import Bar
from tautline.cli.output.scene_warnings import print_warnings, warning_records
from tautline.cli.output.summary import limit_said, limits_of_scene, table, two_columns
from tautline.cli.run import Ended, ExitCode
from tautline.scene.errors import option_error
from tautline.scene.reading.document import in_turn
from tautline.scene.values.printed import in_words, printed_in, quantity

if TYPE_CHECKING:
    from tautline.application.protocol import Application
    from tautline.results.result import Result
    from tautline.scene.errors import SceneWarning
    from tautline.scene.reading.document import Document
    from tautline.simulation import Afterwards

COPIED = (
    "method", "step", "steps", "newton_iterations", "wall_time", "cpu_time", "real_time_factor", "energy_error",
    "numerical_dissipation", "motion_frequency", "phase_lag",
)  # fmt: skip
"""Keys of the report that are attributes of the result."""

SHARES = {
    1.0 / 3.0: "runs with a half and a third of the step", 4.0: "two runs with longer steps",
    0.5: "a run with half the step",
}  # fmt: skip
"""Other runs by the step of the last of them, over the run's own; of any other last there is one run.

How long longer steps are is told by the estimate. A frame holds a whole number of them: they are seldom as asked for.
"""


def check(
    catalogue: Catalogue,
    scene: Path,
    as_json: bool,
    figure: Path | None = None,
    changes: Sequence[str] | None = None,
) -> None:
    """Validate a scene, print its warnings and what it comes to, and draw it if a `figure` is asked for.

    Parameters
    ----------
    changes : sequence of str or None
        Values in place of the scene's, ``key=value`` each.

    Raises
    ------
    SceneError, ResultError
        For a scene that cannot be run, and a figure that cannot be drawn; nothing is drawn then.
    """
    from tautline.results.output_path import check_figure

    application, read = catalogue.read(scene, change_of(changes))
    if figure is not None:
        check_figure(figure, "--figure")
    with preparing(scene, read):
        warnings = application.warnings(read)
        figures = application.check_figures(read)
    print_warnings(warnings)
    # What only the builder can tell, such as a repeated constraint, is refused here too; nothing is run.
    if note := version_note():
        say(f"warning: {note}", "yellow")
    model = application.build(read)
    if figure is not None:
        _draw(application, read, figure)
    for note in getattr(model, "notes", ()):
        say(f"note: {note}")
    rows = () if as_json else getattr(application, "describe", lambda _: ())(figures)
    if rows:
        console().print(two_columns(rows))
    count = len(warnings)
    warned = f", {count} warning{'s' * (count > 1)}" if count else ""
    following = typed(catalogue.name, "simulate", scene) + as_given(changes)
    say(f"{scene} can be run{warned}. Next: {following}", "green")
    if as_json:
        drawn = {} if figure is None else {"figure": str(figure)}
        print_json({"scene": str(scene), "status": "good", "warnings": warning_records(warnings)} | drawn | figures)


def _draw(application: Application, scene: Any, figure: Path) -> None:
    """Draw a scene; raises ResultError for an application that draws none."""
    from tautline.results.errors import ResultError

    draw = getattr(application, "draw", None)
    if draw is None:
        raise ResultError("--figure", f"scenes of {application.name} are not drawn", "leave it out")
    say(f"wrote {draw(scene, figure)}", "green")


def simulate(
    catalogue: Catalogue,
    scene: Path,
    output: Path | None,
    overrides: dict[str, Any],
    resume: Path | None,
    verify: bool | None,
    as_json: bool,
    quiet: bool,
    changes: Sequence[str] | None = None,
) -> None:
    """Run a scene and report.

    Parameters
    ----------
    output : Path or None
        The result; by default the scene's name with ``.nc`` in the current folder.
    overrides : dict
        ``method``, ``step``, ``end``, ``rho_inf``, ``accuracy``; None keeps what the scene says.
    resume : Path or None
        An earlier result to go on from.
    verify : bool or None
        Whether to estimate the error from runs with shorter steps; None does so where friction acts between fixed
        steps of an implicit method, and from longer steps without friction and where steps are controlled.
    changes : sequence of str or None
        Values in place of the scene's, ``key=value`` each.

    Raises
    ------
    SceneError, ResultError
        For a scene that cannot be run or a result that cannot be written; nothing is written then.
    Ended
        If the run stopped early, was interrupted, or does not reach the accuracy that was asked for; that was reported
        and the result is kept.
    """
    from tautline.results.output_path import check_simulated, check_target

    _check_accuracy(overrides, resume, verify)
    application, read = _scene_of(catalogue, scene, overrides, changes)
    target = check_simulated(check_target(output or Path(scene.name).with_suffix(".nc")))
    earlier = _earlier(resume)
    read, accuracy = _accuracy(application, read, overrides, earlier, verify)
    with preparing(scene, read, quiet):
        warnings = application.warnings(read)
    print_warnings(warnings)
    if note := version_note():
        say(f"warning: {note}", "yellow")
    with preparing(scene, read, quiet):
        model = application.build(read)
    if note := room_warning(model, target):
        say(f"warning: {note}", "yellow")
    end = getattr(getattr(model, "solver", None), "end", None)

    def begin() -> None:
        if not quiet:
            _announce(scene, model, end)

    def run(bar: Bar) -> Result:
        if accuracy is not None:
            begin()
            return _to_accuracy(application, read, accuracy, target, bar, quiet)
        return _as_it_stands(application, read, model, target, verify, earlier, bar, quiet, begin)

    outcome = _outcome_of(run, end, quiet)
    report = _report(scene, outcome.result, end, warnings) | outcome.report
    _finish(catalogue, application, report, outcome.result, as_json, quiet)
    if outcome.line:
        say(*outcome.line)
    if outcome.code is not None:
        raise Ended(outcome.code)


class Outcome(NamedTuple):
    """How a run ended.

    Attributes
    ----------
    result : Result or None
        None where nothing was stored.
    report : dict
        What the report says of the end.
    line : (str, str) or None
        What is printed at the end, and its colour; None for a run that came to its end.
    code : ExitCode or None
        None for 0.
    """

    result: Result | None
    report: dict[str, Any]
    line: tuple[str, str] | None = None
    code: ExitCode | None = None


def _outcome_of(run: Callable[[Bar], Result], end: float | None, quiet: bool) -> Outcome:
    """Run under a progress bar, and see how it ends."""
    from tautline.integrators.status import Interrupted, StoppedEarly

    try:
        with Bar(end, shown=not quiet) as bar:
            result = run(bar)
    except StoppedEarly as stop:
        report = {
            "status": stop.status.word,
            "stopped": {"time": stop.time, "part": stop.part, "sentence": stop.sentence},
        }
        return Outcome(stop.result, report, (stop.line, "red"), ExitCode.STOPPED_EARLY)
    except Interrupted as interruption:
        line = f"interrupted at t = {_simulated_time(interruption.result) or 0.0:.6g} s"
        return Outcome(interruption.result, {"status": "interrupted"}, (line, "yellow"), ExitCode.INTERRUPTED)
    missed = result.accuracy is not None and result.accuracy["met"] is False
    return Outcome(result, {"status": "done"}, code=ExitCode.STOPPED_EARLY if missed else None)


def _scene_of(
    catalogue: Catalogue, scene: Path, overrides: dict[str, Any], changes: Sequence[str] | None
) -> tuple[Application, Any]:
    """The scene of a file with all that the command line changes in it, and its application."""
    if overrides.get("accuracy") is None:
        # An application of somebody else may not know of it.
        overrides = {key: value for key, value in overrides.items() if key != "accuracy"}

    def change(application: Application, document: Document) -> Document:
        def with_settings(document: Document) -> Document:
            nonlocal overrides
            made = overridden(application, document, overrides)
            # What is done now need not be done to the scene.
            overrides = overrides if made is None else {}
            return document if made is None else made

        return in_turn(document, lambda document: changed(document, changes), with_settings)

    some = changes or any(value is not None for value in overrides.values())
    application, found = catalogue.read(scene, change if some else None)
    return application, application.with_overrides(found, **overrides) if overrides else found


def _announce(scene: Path, model: Any, end: float | None) -> None:
    """Print what is about to run."""
    for note in getattr(model, "notes", ()):
        say(f"note: {note}")
    length = f", {quantity(end, 's')}" if end is not None else ""
    say(f"simulating {scene}{length}")


def _check_accuracy(overrides: dict[str, Any], resume: Path | None, verify: bool | None) -> None:
    """Refuse ``--accuracy`` beside what it chooses; raises SceneError."""
    given = overrides.get("accuracy")
    if given is None:
        return
    beside = {
        "--method": overrides.get("method") is not None, "--step": overrides.get("step") is not None,
        "--resume": resume is not None, "--verify": verify is True, "--no-verify": verify is False,
    }  # fmt: skip
    for option, there in beside.items():
        if there:
            raise option_error(
                "--accuracy", given if isinstance(given, str) else f"{100.0 * given:.3g} %",
                f"stands beside {option}: it chooses method and step of a whole run itself, and estimates the error",
                f"leave --accuracy or {option} out",
            )  # fmt: skip


def _accuracy(
    application: Application, scene: Any, overrides: dict[str, Any], earlier: Result | None, verify: bool | None
) -> tuple[Any, float | None]:
    """The scene, and the accuracy that method and step are to be chosen for; None where they are as they stand.

    What is gone on with keeps the method and the step that were chosen for it.
    """
    asked = getattr(getattr(scene, "solver", None), "accuracy", None)
    if asked is None:
        return scene, None
    if earlier is not None:
        chosen = earlier.accuracy or _taken_by(earlier)
        keep = {key: chosen.get(key) for key in ("method", "step") if overrides.get(key) is None}
        return application.with_overrides(scene, **keep, control="fixed" if chosen else None), None
    given = [f"--{key}" for key in ("method", "step") if overrides.get(key) is not None]
    given += [] if verify is None else ["--verify" if verify else "--no-verify"]
    if given:
        say(f"note: nothing is chosen for an accuracy of {100.0 * asked:.3g} %, because {given[0]} is given")
        return scene, None
    return scene, float(asked)


def _taken_by(earlier: Result) -> dict[str, Any]:
    """Method and step of a run that does not say what was chosen, as one that was left; empty where its steps were not
    all as long."""
    alike = bool(earlier.attributes.get("steps_alike", False))
    return {key: earlier.attributes[key] for key in ("method", "step")} if alike else {}


def _to_accuracy(application: Application, scene: Any, asked: float, target: Path, bar: Bar, quiet: bool) -> Result:
    """The run of a scene whose method and step are chosen for an accuracy."""
    from tautline.study.accuracy.choice import run_to_accuracy

    def begin(method: str, step: float, end: float) -> None:
        if not quiet:
            say(f"for an accuracy of {100.0 * asked:.3g} %: {method}, steps of {quantity(step, 's')}")
        bar.again(end, "choosing the step")

    return run_to_accuracy(
        application, scene, asked, target, progress=bar, announce=None if quiet else compiling, begin=begin,
        interval_key=key_of_setting(application, "interval"),
    )  # fmt: skip


def _as_it_stands(
    application: Application, scene: Any, model: Any, target: Path, verify: bool | None, earlier: Result | None,
    bar: Bar, quiet: bool, begin: Callable[[], None],
) -> Result:  # fmt: skip
    """The run of a model by its own method and step, and what it says of its error.

    `begin` is called when nothing can be refused any more.
    """
    from tautline.simulation import simulate as run_model

    others = _other_runs(application, scene, model, verify, earlier, bar, quiet)
    return run_model(
        model,
        target,
        progress=bar,
        resume=earlier,
        announce=None if quiet else compiling,
        afterwards=others,
        begin=begin,
    )


def _other_runs(
    application: Application, scene: Any, model: Any, verify: bool | None, earlier: Result | None, bar: Bar, quiet: bool
) -> Afterwards | None:
    """What estimates a run's error from runs with other steps, or leaves that out where it is not to be done."""
    if getattr(model, "system", None) is None:
        return None
    from tautline.application.after_run import error_of_step
    from tautline.simulation import Afterwards

    def begin(parts: Sequence[float]) -> None:
        if not quiet:
            runs = SHARES.get(parts[-1], "a run with longer steps")
            say(f"estimating the error from {runs}; --no-verify leaves it out")
        bar.again(len(parts) * float(model.solver.end), "estimating the error")

    goes_on = verify is None and earlier is not None
    found = None if goes_on else error_of_step(application, scene, model, verify, bar, begin)
    if found is None:
        return Afterwards(lambda result: ({}, []), ({}, []))
    from tautline.study.trials.step_error import CUT_SHORT, NOT_KNOWN

    return found._replace(unless=({}, [NOT_KNOWN.format(CUT_SHORT)]))


def _earlier(resume: Path | None) -> Result | None:
    if resume is None:
        return None
    from tautline.results.result import Result

    return Result.read(resume)


def _simulated_time(result: Result | None) -> float | None:
    """From the first frame to the last, s; None where there is none."""
    times: Any = result["time"] if result is not None else []
    return float(times[-1] - times[0]) if len(times) else None


def _report(scene: Path, result: Result | None, end: float | None, warnings: Sequence[SceneWarning]) -> dict[str, Any]:
    """Keys of ``simulate --json``; null where a run that stopped has no number."""
    attributes = result.attributes if result is not None else {}
    times: Any = result["time"] if result is not None else []
    stored = None if result is None or result.path is None else str(result.path)
    report: dict[str, Any] = {"scene": str(scene), "result": stored, "status": None}
    report |= {key: attributes.get(key) for key in COPIED}
    report["step_error"] = result.step_error if result is not None else None
    report["between_frames"] = result.between_frames if result is not None else None
    report["accuracy"] = result.accuracy if result is not None else None
    report["warnings"] = result.warnings if result is not None else []
    report["start"] = attributes.get("start") or None
    report["limits"] = result.limits if result is not None else []
    report["scene_warnings"] = warning_records(warnings)
    # The loop's time is not what a person waits for; it is told when all else is known.
    report["total_time"] = None
    report |= {"end": attributes.get("end", end), "frames": len(times)}
    report["simulated_time"] = _simulated_time(result)
    figures = {name: figure.get("value") for name, figure in (result.headline if result is not None else {}).items()}
    return report | {name: value for name, value in figures.items() if name not in report}


def _print_limits(report: dict[str, Any], attributes: dict[str, Any]) -> None:
    """Print what came of the limits that the scene gives itself, and until when they were looked at."""
    records = [record for record in report["limits"] if "output" in record]
    if not records:
        return
    console().print()
    system = printed_in(attributes)
    console().print(limits_of_scene(records, system, attributes.get("statistics_begin")))
    if report["status"] != "done" and records[0]["until"] is not None:
        say(
            f"the limits are judged until t = {quantity(records[0]['until'], 's')}, where the run ended early", "yellow"
        )


def _finish(
    catalogue: Catalogue,
    application: Application,
    report: dict[str, Any],
    result: Result | None,
    as_json: bool,
    quiet: bool,
) -> None:
    """Print what came of a run, and how long the whole command took up to here."""
    report["total_time"] = total_time()
    if result is None:
        say("nothing was stored", "yellow")
    elif not quiet:
        aside = getattr(application, "aside", lambda figures, limits: ())(result.headline, report["limits"])
        console().print(table(report, result.attributes, result.headline, aside))
        _print_limits(report, result.attributes)
        frames = f"{report['frames']} frame" + ("" if report["frames"] == 1 else "s")
        if result.path is None:
            say("nothing was stored: the run only served to find the step", "yellow")
        elif seen := result.attributes.get("frames_seen"):
            told = f"statistics of {seen} frames, and {frames} round the extremes"
            following = typed(catalogue.name, "export", "--csv", result.path)
            say(f"wrote {result.path}: {told}. Next: {following}", "green")
            if left_out := result.attributes.get("figures_left_out"):
                say(f"statistics do not tell {left_out}. Keep frames for those: `output: {{keep: frames}}`")
        else:
            following = typed(catalogue.name, "plot", result.path)
            say(f"wrote {result.path}: {frames}. Next: {following}", "green")
    system = printed_in(result.attributes) if result is not None else "si"
    for warning in report["warnings"]:
        say(f"warning: {in_words(warning, system)}", "yellow")
    for record in report["limits"]:
        if not record["passed"]:
            say(f"warning: {record['text']}: {limit_said(record, system)}", "yellow")
    if as_json:
        print_json(report)
