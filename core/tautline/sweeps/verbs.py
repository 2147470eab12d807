"""What a verb finds in a scene, as findings by name: ``simulate``, and what an application has besides."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from difflib import get_close_matches
from typing import Any

import numpy as np

from tautline.application.installed import key_of_setting
from tautline.results.assessment.limits import AT_MOST
from tautline.results.tables.finding import Finding, Table
from tautline.statistics.trends import TREND
from tautline.sweeps.file import SIMULATE, Collected, SweepFile, percentile
from tautline.system.handles import Handles, Output, part_named, word_of

RUN = {
    "step": ("s", "time step"),
    "steps": ("", "steps"),
    "newton_iterations": ("", "Newton iterations"),
    "wall_time": ("s", "time of the compiled loop"),
    "cpu_time": ("s", "processor time of the compiled loop"),
    "real_time_factor": ("", "real-time factor"),
    "energy_error": ("", "energy balance, relative error"),
    "numerical_dissipation": ("J", "numerical dissipation"),
    "motion_frequency": ("Hz", "oscillation frequency"),
    "phase_lag": ("rad", "accumulated phase error of free vibration"),
}
"""Attributes of a run that ``simulate --json`` tells and that are numbers: unit and text."""
LIMITS_FAILED = "limits_failed"
EVERY_FRAME = "give the scene `output: {keep: frames}`, or leave it out"
OF_LIMIT = "limit."
"""Begins the names of what a limit of the scene came to: ``limit.overload.margin``."""
OF_RUN_LIMIT = "run_limit."
"""Begins the names of what a limit came to that every run is judged by: ``run_limit.breaking_load.failed``."""
LONGEST = ".longest"
"""Ends the name of the longest time beyond the bound."""
OF_ONE = re.compile(r" \(.*\)$")
"""Place and time at the end of a figure's text."""


def tables_of(application: Any) -> Mapping[str, Table]:
    """Verbs of an application besides ``simulate`` whose findings a sweep can collect, by name."""
    return getattr(application, "tables", {})


def check_verb(read: SweepFile, application: Any) -> None:
    """Raise SceneError for a verb that the application has not, and for options of ``simulate``, which has none."""
    from tautline.scene.errors import SceneError
    from tautline.scene.refusal import nearest

    known = (SIMULATE, *tables_of(application))
    if read.verb not in known:
        cause = f"is no verb with a table of {application.name}"
        raise SceneError([read.problem_at(("verb",), cause, nearest(read.verb, known))])
    if read.verb == SIMULATE and read.options:
        name, value = next(iter(read.options.items()))
        key = key_of_setting(application, name)
        cure = "fixed values are given with --set, and others under vary, by the keys of the scene"
        if key:
            cure = f"vary {key} of the scene"
            # What has several values is no value of the key, but what it is to be varied over.
            cure = cure if isinstance(value, (list, dict)) else f"for all cases give --set '{key}={value}', or {cure}"
        raise SceneError([read.problem_at(("options",), "simulate takes none in a sweep", cure)])
    if read.verb != SIMULATE:
        of_verb = tables_of(application)[read.verb].options
        for name in read.options:
            if name not in of_verb:
                cure = nearest(name, of_verb) if of_verb else "remove it"
                raise SceneError([read.problem_at(("options", name), f"{read.verb} has no such option", cure)])
    outputs = [i for i, one in enumerate(read.collected()) if one.output]
    if read.verb != SIMULATE and outputs:
        cause = f"{read.verb} has no outputs over time"
        raise SceneError([read.problem_at(("collect", outputs[0]), cause, "name figures that it finds")])


def check_options(read: SweepFile, application: Any, scene: Any) -> None:
    """Raise SceneError for options of a verb that it cannot read, at their lines."""
    from tautline.scene.errors import SceneError

    if read.verb == SIMULATE:
        return
    try:
        tables_of(application)[read.verb].read(scene, read.options)
    except SceneError as error:
        moved = []
        for problem in error.problems:
            name = problem.file.removeprefix("--")
            there = problem.file.startswith("--") and name in read.options
            at = read.problem_at(("options", name), problem.cause, problem.cure, problem.value) if there else problem
            moved.append(at)
        raise SceneError(moved) from None


def names_of(collected: Sequence[Collected]) -> frozenset[str]:
    """Names of the figures that are asked for; empty for all of them."""
    return frozenset(one.figure for one in collected if one.figure)


class Watch:
    """Outputs of a run over its frames, as far as they are collected; those before ``output.begin`` do not count.

    Positions and velocities of things are no variables of a result: they are taken out of the frames as they come.

    Parameters
    ----------
    model : Model
        Its ``observe`` is told to look at them too.
    collected : sequence of Collected
    begin : float
        Time, s, before which frames do not count, where the model does not say.
    """

    def __init__(self, model: Any, collected: Sequence[Collected], begin: float = 0.0) -> None:
        self.asked = [one for one in collected if one.output]
        self.outputs = {one.name: output_of(_handles(model).outputs, one.output) for one in self.asked}
        # Of an output of several numbers the largest, or the smallest, of all of them.
        self.over = {one.name: np.min if one.statistic == "min" else np.max for one in self.asked}
        self.rows: dict[str, list[np.ndarray]] = {one.name: [] for one in self.asked}
        self.times: list[np.ndarray] = []
        # The rounding of a sum of steps must not leave out the frame at `begin` itself.
        self.begin = (begin if model.keep is None else model.keep.begin) * (1.0 - 1e-12)
        if self.asked:
            observe = model.observe
            model.observe, model.on_demand = lambda frames: self._look(frames, observe(frames)), None

    def _look(self, frames: Any, variables: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        self.times.append(np.array(frames.time, float))
        for name, output in self.outputs.items():
            if output.places is not None:
                vector, places = output.places
                values = getattr(frames, vector)[:, places]
            else:
                values = output.one_by_one(variables, len(frames.time))
            values = np.array(values, float).reshape(len(frames.time), -1)
            self.rows[name].append(self.over[name](values, axis=1))
        return variables

    def findings(self) -> dict[str, Finding]:
        """The statistics that are asked for, of all frames that count, whatever the result keeps."""
        return {
            one.name: Finding(
                statistic(*self.values(one.name), one.statistic), self.outputs[one.name].unit,
                f"{one.statistic} of {one.output}",
            )
            for one in self.asked
        }  # fmt: skip

    def values(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Values and times, s, (m,) each, of all frames that count, of what is collected by a name."""
        time = np.concatenate(self.times)
        counts = time >= self.begin
        return np.concatenate(self.rows[name])[counts], time[counts]


def _findings(headline: Mapping[str, Mapping[str, Any]]) -> dict[str, Finding]:
    return {
        name: Finding(figure.get("value"), str(figure.get("unit") or ""), str(figure.get("text") or ""))
        for name, figure in headline.items()
    }


def of_run(
    result: Any, model: Any, collected: Sequence[Collected], watch: Watch, sometimes: Sequence[str] = ()
) -> dict[str, Finding]:
    """What ``simulate`` finds, as far as it is asked for; all that it could where something of that is not there."""
    found = _findings(result.headline)
    asked = names_of(collected)
    lacking = {name for name in asked if not asks_limits(name)} - found.keys() - RUN.keys() - {*sometimes}
    # Of statistics most frames are gone: what was not made as they came, those that are left do not tell.
    if lacking and model.keep is None:
        found = _findings(model.headline(result)) | found
    attributes = result.attributes
    for name, (unit, text) in RUN.items():
        if name in asked and name not in found:
            found[name] = Finding(attributes.get(name), unit, text)
    limits = result.limits
    if limits:
        failed = sum(record["passed"] is False for record in limits)
        found[LIMITS_FAILED] = Finding(failed, "", "limits that are not satisfied")
    # Those of every run are many: only what is asked for is a column.
    of_every = {name: one for name, one in _of_run_limits(limits).items() if name in asked}
    return found | _of_limits(limits) | of_every | watch.findings()


def asks_limits(name: str) -> bool:
    """Whether a name that is collected is of what limits came to."""
    return name == LIMITS_FAILED or name.startswith((OF_LIMIT, OF_RUN_LIMIT))


def _of_limits(records: Sequence[Mapping[str, Any]]) -> dict[str, Finding]:
    """What each limit that the scene gives itself came to; no number where it could not be judged."""
    found: dict[str, Finding] = {}
    for record in records:
        if "output" not in record:
            continue
        begin, text = _column(record["name"]), record["text"]
        failed = None if record["passed"] is None else int(not record["passed"])
        judged = failed is not None
        found |= {
            f"{begin}.failed": Finding(failed, "", f"{text}: 1 where it failed"),
            f"{begin}.value": Finding(record["value"] if judged else None, record["unit"], f"{text}: worst value"),
            f"{begin}.margin": Finding(
                record["margin"] if judged else None, record["unit"], f"{text}: what was left to the bound"
            ),
            f"{begin}{LONGEST}": Finding(record["longest"], "s", f"{text}: longest time beyond the bound"),
        }
    return found


def _of_run_limits(records: Sequence[Mapping[str, Any]]) -> dict[str, Finding]:
    """What each limit of every run of the application came to; no number where it could not be judged."""
    found: dict[str, Finding] = {}
    for record in records:
        if "output" in record:
            continue
        begin, text, unit = f"{OF_RUN_LIMIT}{record['name']}", record["text"], record["unit"]
        failed: int | None = None
        value = margin = None
        if record["passed"] is not None:
            failed, value = int(not record["passed"]), record["value"]
            margin = (record["limit"] - value) if record["sense"] == AT_MOST else (value - record["limit"])
        found |= {
            f"{begin}.failed": Finding(failed, "", f"{text}: 1 where the limit failed"),
            f"{begin}.value": Finding(value, unit, f"{text}: worst value"),
            f"{begin}.margin": Finding(margin, unit, f"{text}: what was left to the limit"),
        }
    return found


def _handles(model: Any) -> Handles:
    from tautline.live.readings import handles_of

    return handles_of(model)


def check_outputs(read: SweepFile, model: Any) -> None:
    """Raise SceneError for outputs that a model has not, and for those of several numbers without a place."""
    from tautline.scene.errors import SceneError
    from tautline.scene.refusal import nearest

    asked = [(i, one) for i, one in enumerate(read.collected()) if one.output]
    if not asked:
        return
    handles, problems = _handles(model), []
    outputs = handles.outputs
    for i, one in asked:
        key = ("collect", i, "output")
        try:
            output = output_of(outputs, one.output)
        except KeyError as error:
            name = str(error.args[0])
            cure = handles.instead.get(word_of(name)) or nearest(name, sorted(outputs))
            problems.append(read.problem_at(key, f"there is no output '{name}'", cure))
            continue
        except IndexError as error:
            problems.append(read.problem_at(key, *no_part(one.output, error)))
            continue
        told = no_number(outputs, one.output)
        if told and (output.has_components or one.statistic not in OVER_PLACES):
            cause, cure = told
            cure += "" if output.has_components else "; max and min take all of them"
            problems.append(read.problem_at(key, cause, cure))
    if problems:
        raise SceneError(problems)


def check_figures(read: SweepFile, model: Any, sometimes: Sequence[str] = ()) -> bool:
    """Check before the first run that a model has the figures, and say whether all could be looked up.

    Returns
    -------
    bool
        Whether the model knows all its figures: of another, names are looked up in the first run that ends.

    Raises
    ------
    SceneError
        For figures that no run of the model has.
    """
    from tautline.scene.errors import SceneError
    from tautline.scene.refusal import nearest

    known = (*model.figure_units, *sometimes, *RUN)
    if not model.figure_units:
        return False
    instead = _handles(model).instead
    problems = [
        read.problem_at(
            ("collect", i), f"the verb finds no '{one.figure}'",
            instead.get(word_of(one.figure)) or nearest(one.figure, known),
        )
        for i, one in enumerate(read.collected())
        if one.figure and one.figure not in known and not asks_limits(one.figure)
    ]  # fmt: skip
    problems += [
        read.problem_at(("collect", i), f"statistics do not tell {one.figure}: it needs every frame", EVERY_FRAME)
        for i, one in enumerate(read.collected())
        if model.keep is not None and one.figure in model.figure_units and not model.keep.makes(one.figure)
    ]
    problems += [
        read.problem_at(("collect", i), cause, EVERY_FRAME)
        for i, one in enumerate(read.collected())
        if model.keep is not None and (cause := _untold(one.figure, model))
    ]
    if problems:
        raise SceneError(problems)
    # What a limit of the scene is called is looked up in a run.
    return not any(asks_limits(one.figure) for one in read.collected())


def _untold(name: str, model: Any) -> str:
    """Why no run that keeps statistics tells what a limit of its scene came to; empty where it may."""
    if not name.startswith(OF_LIMIT):
        return ""
    if name.endswith(LONGEST):
        return f"statistics do not tell {name}: how long a value is beyond its bound needs every frame"
    of = next((one for one in model.bounds if name.startswith(f"{_column(one.name)}.")), None)
    if of is None or of.of_frames or model.keep.makes(of.output):
        return ""
    return f"statistics do not tell {name}: {of.output} needs every frame"


def _column(limit: str) -> str:
    """How the columns of a limit begin. A NetCDF file takes a slash for a group."""
    return f"{OF_LIMIT}{limit.replace('/', ' per ')}"


OVER_PLACES = ("max", "min")
"""Statistics that an output of several numbers has as a whole: the largest, and the smallest, of all of them."""


def output_of(outputs: Mapping[str, Output], name: str) -> Output:
    """An output, or the part of it that its indices name.

    Raises
    ------
    KeyError
        For a name that there is not.
    IndexError
        For indices that the output has not.
    """
    found = part_named(outputs, name)
    if found is None:
        raise KeyError(name)
    return found


def no_part(name: str, error: IndexError) -> tuple[str, str]:
    """Cause and cure of indices that an output has not."""
    cause, _, cure = str(error).partition(": ")
    return f"there is no {name}: {cause}", cure


def no_number(outputs: Mapping[str, Output], name: str) -> tuple[str, str] | None:
    """Cause and cure of an output, by its name, that is no single number; None of one that is.

    The largest of several places is one, as of the tensions at the ends of all spans. That of several components is
    none: of a force or a position it says nothing.
    """
    output = output_of(outputs, name)
    if not output.shape:
        return None
    whole = outputs[name] if name in outputs else outputs[name.rpartition("[")[0]]
    several = ": it has several components" if output.has_components else ""
    return f"{name} is no single number{several}", whole.one_of_components


def statistic(values: np.ndarray, time: np.ndarray, name: str) -> float:
    """A statistic of frames, (m,); means are over time, by the trapezoidal rule."""
    if name == "max":
        return float(values.max())
    if name == "min":
        return float(values.min())
    if name == "range":
        return float(np.ptp(values))
    if name == "last":
        return float(values[-1])
    rank = percentile(name)
    if rank is not None:
        return float(np.percentile(values, rank))
    if name == "rms":
        return float(np.sqrt(_mean(values**2, time)))
    mean = _mean(values, time)
    return mean if name == "mean" else float(np.sqrt(_mean((values - mean) ** 2, time)))


def _mean(values: np.ndarray, time: np.ndarray) -> float:
    span = float(time[-1] - time[0])
    if not span > 0.0:
        return float(values[-1])
    return float(np.sum(0.5 * (values[1:] + values[:-1]) * np.diff(time)) / span)


def of_all(found: Finding) -> Finding:
    """What a finding is in every case, without the place and the time that its text tells of one."""
    return found._replace(value=None, text=OF_ONE.sub("", found.text))


def chosen(
    found: Mapping[str, Finding], collected: Sequence[Collected], trends: Collection[str] = ()
) -> dict[str, Finding]:
    """The findings that are asked for, those that they run along and their trends among them; all for nothing."""
    if not collected:
        return dict(found)
    names = [*(one.name for one in collected), *(f"{name}{TREND}" for name in trends)]
    kept = {name: found[name] for name in names if name in found}
    along = {one.along: found[one.along] for one in kept.values() if one.along and one.along in found}
    return kept | along


def unknown(found: Mapping[str, Finding], collected: Sequence[Collected]) -> list[tuple[int, str, str]]:
    """Which of the names that are asked for were not found: place, cause and cure."""
    missing = []
    for i, one in enumerate(collected):
        if one.name not in found and not one.output:
            close = get_close_matches(one.figure, list(found), n=1, cutoff=0.6)
            cure = f"did you mean '{close[0]}'?" if close else f"known: {', '.join([*found, *RUN])}"
            missing.append((i, f"the verb finds no '{one.figure}'", cure))
    return missing
