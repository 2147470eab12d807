"""What a verb finds in a scene, as findings by name: ``simulate``, and what an application has besides."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Any

import numpy as np

from tautline.results.tables.finding import Finding, Table
from tautline.sweeps.file import SIMULATE, Collected, SweepFile, percentile

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
OF_LIMIT = "limit."
"""Begins the names of what a limit of the scene came to: ``limit.overload.margin``."""
OF_ONE = re.compile(r" \(.*\)$")
"""Place and time at the end of a figure's text."""
PART = re.compile(r"(.+)\[(\d+)\]")


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
        cause, cure = "simulate takes none in a sweep", "vary keys of the scene: solver.step, solver.method, solver.end"
        raise SceneError([read.problem_at(("options",), cause, cure)])
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
    """

    def __init__(self, model: Any, collected: Sequence[Collected]) -> None:
        self.asked = [one for one in collected if one.output]
        self.outputs = {one.name: output_of(_handles(model), one.output) for one in self.asked}
        # Of an output of several numbers the largest, or the smallest, of all of them.
        self.over = {one.name: np.min if one.statistic == "min" else np.max for one in self.asked}
        self.rows: dict[str, list[np.ndarray]] = {one.name: [] for one in self.asked}
        self.times: list[np.ndarray] = []
        # The rounding of a sum of steps must not leave out the frame at `begin` itself.
        self.begin = model.keep.begin * (1.0 - 1e-12) if model.keep is not None else 0.0
        if self.asked:
            observe = model.observe
            model.observe, model.on_demand = lambda frames: self._look(frames, observe(frames)), None

    def _look(self, frames: Any, variables: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        self.times.append(np.array(frames.time, float))
        for name, (output, part) in self.outputs.items():
            if output.places is not None:
                vector, places = output.places
                values = getattr(frames, vector)[:, places]
            else:
                values = output.one_by_one(variables, len(frames.time))
            values = np.array(values if part is None else values[:, part], float).reshape(len(frames.time), -1)
            self.rows[name].append(self.over[name](values, axis=1))
        return variables

    def findings(self) -> dict[str, Finding]:
        """The statistics that are asked for, of all frames that count, whatever the result keeps."""
        if not self.asked:
            return {}
        time = np.concatenate(self.times)
        counts = time >= self.begin
        return {
            one.name: Finding(
                statistic(np.concatenate(self.rows[one.name])[counts], time[counts], one.statistic),
                self.outputs[one.name][0].unit, f"{one.statistic} of {one.output}",
            )
            for one in self.asked
        }  # fmt: skip


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
    if {name for name in asked if not asks_limits(name)} - found.keys() - RUN.keys() - {*sometimes}:
        found = _findings(model.headline(result)) | found
    attributes = result.attributes
    for name, (unit, text) in RUN.items():
        if name in asked and name not in found:
            found[name] = Finding(attributes.get(name), unit, text)
    limits = result.limits
    if limits:
        failed = sum(record["passed"] is False for record in limits)
        found[LIMITS_FAILED] = Finding(failed, "", "limits that are not satisfied")
    return found | _of_limits(limits) | watch.findings()


def asks_limits(name: str) -> bool:
    """Whether a name that is collected is of what limits came to."""
    return name == LIMITS_FAILED or name.startswith(OF_LIMIT)


def _of_limits(records: Sequence[Mapping[str, Any]]) -> dict[str, Finding]:
    """What each limit that the scene gives itself came to; no number where it could not be judged."""
    found: dict[str, Finding] = {}
    for record in records:
        if "output" not in record:
            continue
        # A NetCDF file takes a slash for a group.
        begin, text = f"{OF_LIMIT}{record['name'].replace('/', ' per ')}", record["text"]
        failed = None if record["passed"] is None else int(not record["passed"])
        judged = failed is not None
        found |= {
            f"{begin}.failed": Finding(failed, "", f"{text}: 1 where it failed"),
            f"{begin}.value": Finding(record["value"] if judged else None, record["unit"], f"{text}: worst value"),
            f"{begin}.margin": Finding(
                record["margin"] if judged else None, record["unit"], f"{text}: what was left to the bound"
            ),
            f"{begin}.longest": Finding(record["longest"], "s", f"{text}: longest time beyond the bound"),
        }
    return found


def _handles(model: Any) -> Mapping[str, Any]:
    from tautline.live.simulation import handles_of

    return handles_of(model).outputs


def check_outputs(read: SweepFile, model: Any) -> None:
    """Raise SceneError for outputs that a model has not, and for those of several numbers without a place."""
    from tautline.scene.errors import SceneError
    from tautline.scene.refusal import nearest

    asked = [(i, one) for i, one in enumerate(read.collected()) if one.output]
    if not asked:
        return
    handles, problems = _handles(model), []
    for i, one in asked:
        key = ("collect", i, "output")
        try:
            output, part = output_of(handles, one.output)
        except KeyError as error:
            name = str(error.args[0])
            problems.append(read.problem_at(key, f"there is no output '{name}'", nearest(name, sorted(handles))))
            continue
        if not single(output, part) and not (whole(output, part) and one.statistic in OVER_PLACES):
            cure = f"name one of its numbers, {one.output.partition('[')[0]}[0] the first"
            cure += "; max and min take all of them" if whole(output, part) else ""
            problems.append(read.problem_at(key, f"{one.output} is no single number", cure))
    if problems:
        raise SceneError(problems)


def check_figures(read: SweepFile, model: Any, sometimes: Sequence[str] = ()) -> bool:
    """Raise SceneError for figures that no run of a model has, before the first run.

    Returns
    -------
    bool
        Whether the model knows all its figures: of another, names are looked up in the first run that ends.
    """
    from tautline.scene.errors import SceneError
    from tautline.scene.refusal import nearest

    known = (*model.figure_units, *sometimes, *RUN)
    if not model.figure_units:
        return False
    problems = [
        read.problem_at(("collect", i), f"the verb finds no '{one.figure}'", nearest(one.figure, known))
        for i, one in enumerate(read.collected())
        if one.figure and one.figure not in known and not asks_limits(one.figure)
    ]
    if problems:
        raise SceneError(problems)
    # What a limit of the scene is called is looked up in a run.
    return not any(asks_limits(one.figure) for one in read.collected())


OVER_PLACES = ("max", "min")
"""Statistics that an output of several numbers has as a whole: the largest, and the smallest, of all of them."""


def single(output: Any, part: int | None) -> bool:
    """Whether an output, or the part of it that is named, is one number."""
    if not output.shape:
        return True
    return part is not None and len(output.shape) == 1 and not (output.shape[0] and part >= output.shape[0])


def whole(output: Any, part: int | None) -> bool:
    """Whether an output stands for all its places, such as the tension at both ends of all spans.

    The three coordinates of a position are no places: the largest of them says nothing.
    """
    return bool(output.shape) and part is None and output.places is None


def output_of(outputs: Mapping[str, Any], name: str) -> tuple[Any, int | None]:
    """An output and which of its numbers is meant; KeyError for a name that there is not."""
    if name in outputs:
        return outputs[name], None
    match = PART.fullmatch(name)
    if match and match[1] in outputs:
        return outputs[match[1]], int(match[2])
    raise KeyError(name)


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


def chosen(found: Mapping[str, Finding], collected: Sequence[Collected]) -> dict[str, Finding]:
    """The findings that are asked for, those that they run along among them; all for nothing."""
    if not collected:
        return dict(found)
    kept = {one.name: found[one.name] for one in collected if one.name in found}
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
