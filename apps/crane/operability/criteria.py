"""Limits that a storm is judged by: ``max_tension < 60 kN``, read by what a run of the scene finds."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Any, NamedTuple

import numpy as np
from pydantic_core import PydanticCustomError

from crane.results.summary import INVERSE, extreme_over_time
from tautline.results.assessment.limits import AT_LEAST, AT_MOST
from tautline.scene.errors import Problem, SceneError, option_error
from tautline.scene.limits import ABOVE, extreme_of
from tautline.scene.values.quantity import Quantity, as_in_a_file
from tautline.scene.values.systems import usual_unit
from tautline.sweeps.verbs import no_number, no_part, output_of
from tautline.system.handles import word_of

WRITTEN = re.compile(r"\s*(?P<name>[^<>=]+?)\s*(?P<sense><=?|>=?)\s*(?P<value>[^<>=]+?)\s*")
SAME = 1.0e-12
"""Share by which one limit in two units differs: rounding."""
SI, METRIC = "si", "metric"
OPTION, EXAMPLE = "--limit", 'write such as --limit "max_tension < 60 kN"'


class Criterion(NamedTuple):
    """A limit, in SI.

    Attributes
    ----------
    text : str
        As it was written; a bare number with the unit that it was read in.
    name : str
        A figure of ``simulate``, or an output of the simulation.
    sense : str
        `AT_MOST` or `AT_LEAST`.
    limit : float
    unit : str
    output : bool
        Whether it is an output over time, of which the largest or smallest counts.
    bare : str
        The number as it was typed, where it lacks a unit that it should have. Zero is zero in all units.
    """

    text: str
    name: str
    sense: str
    limit: float
    unit: str
    output: bool
    bare: str = ""

    @property
    def way(self) -> float:
        """1 where large values are bad, -1 where small ones are."""
        return 1.0 if self.sense == AT_MOST else -1.0

    @property
    def sign(self) -> float:
        """1 where what is fitted has the sign of the figure, or of what it is divided by; -1 where the other."""
        return -self.way if self.name in INVERSE else self.way

    @property
    def extreme(self) -> bool:
        """Whether each storm has one extreme of it, on the side that is bad: that grows with the length of a storm.

        Sums and counts over time, means, and values at the end are none.
        """
        bad = "largest" if self.sense == AT_MOST else "smallest"
        return self.output or extreme_over_time(self.name) == bad

    def badness(self, values: Any) -> Any:
        """Values as they are fitted, with large ones bad.

        Of a constant over an extreme it is the extreme, over that constant: a safety factor is judged as the tension
        that it is of, whose largest values have a distribution of extremes.
        """
        return self.sign * (_inverse(values) if self.name in INVERSE else values)

    def known(self, values: Any) -> Any:
        """Which of some values can be fitted: those that are finite as they are fitted."""
        return np.isfinite(self.badness(values))

    def from_badness(self, values: Any) -> Any:
        """The figure, of values as they are fitted."""
        return _inverse(self.sign * values) if self.name in INVERSE else self.sign * values

    @property
    def strict(self) -> bool:
        """Whether what is equal to the limit is beyond it: ``<`` and ``>``, not ``<=`` and ``>=``."""
        return "=" not in self.text

    def same_as(self, other: Criterion) -> bool:
        """Whether it is the same limit, however each is written."""
        one, two = ((each.name, each.sense, each.strict, each.output) for each in (self, other))
        # Conversion of units rounds: 60 kN and 60000 N are one.
        return one == two and math.isclose(self.limit, other.limit, rel_tol=SAME)

    def broken_by(self, value: float) -> bool:
        """Whether a value is beyond the limit."""
        beyond = self.way * (value - self.limit)
        return beyond > 0.0 or (self.strict and beyond == 0.0)

    @property
    def floor(self) -> float:
        """What the smallest of the figure cannot fall below: no tension is less than none. Else minus infinity."""
        return 0.0 if self.sense == AT_LEAST and self.unit == "N" else -math.inf

    @property
    def of_storm(self) -> str:
        """What each storm has one of: the largest or smallest of a run, whichever way that is limited, or a figure."""
        kind = {"max": "largest", "min": "smallest"}[self.statistic] if self.output else extreme_of(self.name)
        return f"the {kind}" if kind else self.name

    @property
    def column(self) -> str:
        """Name of what a sweep collects for it."""
        return f"{self.name} {self.statistic}" if self.output else self.name

    @property
    def statistic(self) -> str:
        """Of an output."""
        return "max" if self.sense == AT_MOST else "min"

    @property
    def collected(self) -> Any:
        """What a sweep is asked for."""
        return {"output": self.name, "statistic": self.statistic, "name": self.column} if self.output else self.name


def _inverse(values: Any) -> Any:
    """1 / x of values above zero; no tension at all has a safety factor without end."""
    values = np.asarray(values, float)
    return np.divide(1.0, values, out=np.where(np.isnan(values), np.nan, np.inf), where=values > 0.0)[()]


def read_criteria(
    texts: Sequence[str],
    figures: Mapping[str, str],
    outputs: Mapping[str, Any],
    instead: Mapping[str, str] | None = None,
) -> list[Criterion]:
    """Read limits.

    Parameters
    ----------
    texts : sequence of str
        ``name < value unit``, or with ``<=``, ``>``, ``>=``.
    figures : mapping
        Figures that a run of the scene finds, by name, with their SI units.
    outputs : mapping
        Outputs of its simulation (`tautline.system.handles.Output`).
    instead : mapping, optional
        What to name for words that are no name here (`tautline.system.handles.Handles`).

    Raises
    ------
    SceneError
        Listing every limit that cannot be read.
    """
    found: list[Criterion] = []
    problems: list[Problem] = []
    for text in texts:
        try:
            one = _read(text, figures, outputs, instead or {})
        except SceneError as error:
            problems += error.problems
            continue
        if not any(one.same_as(other) for other in found):
            found.append(one)
    if problems:
        raise SceneError(problems)
    return found


def _read(text: str, figures: Mapping[str, str], outputs: Mapping[str, Any], instead: Mapping[str, str]) -> Criterion:
    match = WRITTEN.fullmatch(text)
    if match is None:
        raise option_error(OPTION, text, "is no limit", EXAMPLE)
    name, unit, of_output = match["name"], figures.get(match["name"]), False
    if unit is None:
        try:
            output = output_of(outputs, name)
        except IndexError as error:
            raise option_error(OPTION, text, *no_part(name, error)) from None
        except KeyError:
            close = get_close_matches(name, [*figures, *outputs], n=1, cutoff=0.5)
            cure = f"did you mean '{close[0]}'?" if close else f"figures: {', '.join(figures)}"
            cure = instead.get(word_of(name), cure)
            raise option_error(OPTION, text, f"a run of this scene finds no '{name}'", cure) from None
        told = no_number(outputs, name)
        if told is not None and output.has_components:
            raise option_error(OPTION, text, *told)
        unit, of_output = output.unit, True
    try:
        given = as_in_a_file(match["value"])
        value = float(Quantity(unit, any_size=True).read(given))
    except PydanticCustomError as error:
        raise option_error(OPTION, text, error.message(), str((error.context or {}).get("cure", ""))) from None
    sense = AT_MOST if match["sense"].startswith("<") else AT_LEAST
    bare = match["value"] if isinstance(given, float) and unit and value != 0.0 else ""
    written = " ".join(text.split()) + (f" {unit}" if bare else "")
    return Criterion(written, name, sense, value, unit, of_output, bare)


def bare_notes(criteria: Sequence[Criterion], system: str) -> list[str]:
    """What limits without a unit were read as, and how to write what is meant.

    Parameters
    ----------
    system : str
        The scene's ``units``: its usual unit is offered, or the metric one for SI.
    """
    found = []
    for one in criteria:
        if not one.bare:
            continue
        begin = one.text.removesuffix(f"{one.bare} {one.unit}")
        other = usual_unit(one.unit, system if system != SI else METRIC)
        also = f", or '{begin}{one.bare} {other}' if that is meant" if other else ""
        found.append(
            f"{OPTION} '{begin}{one.bare}' has no unit, and was read as {one.bare} {one.unit}. Write '{one.text}'{also}"
        )
    return found


def reversed_notes(criteria: Sequence[Criterion]) -> list[str]:
    """Limits that ask a largest value to be large, or a smallest to be small: nearly any storm keeps them, or none."""
    found = []
    for one in criteria:
        kind = extreme_of(one.name)
        meant = AT_MOST if kind == "largest" else AT_LEAST
        if not kind or meant in [other.sense for other in criteria if other.name == one.name]:
            continue
        side, other = ("above", "below") if one.sense == AT_MOST else ("below", "above")
        turned = one.text.translate(str.maketrans("<>", "><"))
        found.append(
            f"{OPTION} '{one.text}' allows seas whose {one.name} is {other} this value, however far, and none where it "
            f"is {side} it. But {one.name} is the {kind} of a storm. Was '{turned}' meant?"
        )
    return found


def limits_of_scene(scene: Any) -> list[str]:
    """Limits that a scene gives itself under ``limits``, as ``--limit`` takes them: here they join those given.

    A run keeps such a limit at equality, hence ``<=`` and ``>=``. Which of the two follows from the side that fails,
    and not from the key: `at_most` is `above`. A limit that has to be passed for some time to count is taken as one
    that must not be passed at all.
    """
    given = getattr(scene, "limits", ())
    sides = [(one.output, side) for one in given or () if hasattr(one, "sides") for side in one.sides]
    return [f"{name} {'<=' if side.fails == ABOVE else '>='} {side.written}" for name, side in sides]


COUNTS = frozenset(
    {
        "slack_events",
        "undamped_snaps",
        "snap_frames",
        "tension_cycles",
        "max_bending_cycles",
        "longest_slack",
        "max_snap",
    }
)
"""Figures that many storms have none of, or that are whole numbers: Gumbel's distribution is a rough one of them."""


def notes_on(criteria: Sequence[Criterion]) -> list[str]:
    """What is sound of limits and better done otherwise."""
    return [
        f"{one.text}: counts, and figures of slack, have no Gumbel distribution, and the fit is rough; better give "
        "min_tension > 0 with some margin"
        for one in criteria
        if one.name in COUNTS
    ]


def check_scaled(criteria: Sequence[Criterion], of_command: Sequence[Criterion], duration: str) -> None:
    """Refuse limits that shorter storms tell nothing of: Gumbel's rule for a longer time is one of extremes.

    Parameters
    ----------
    of_command : sequence of Criterion
        Those of them that the command gives; the scene gives the others.
    duration : str
        That is asked about, as an option takes it.

    Raises
    ------
    SceneError
        Listing every such limit.
    """
    problems: list[Problem] = []
    for one in criteria:
        if one.extreme:
            continue
        kind = extreme_over_time(one.name)
        what = (
            f"bounds the {kind} of a storm on its other side"
            if kind
            else f"{one.name} is a sum, a count or a mean over a storm, or a value at its end, and no extreme"
        )
        cause = f"{what}: it is not known for {duration} from shorter storms"
        where = OPTION if one in of_command else "limits of the scene"
        cure = f"give --simulate {duration}, as long as --duration, or leave this limit out"
        problems.append(Problem(where, None, "", one.text, cause, cure))
    if problems:
        raise SceneError(problems)


def lasting_notes(scene: Any) -> list[str]:
    """Limits of a scene that count there after some time only: here they must not be passed at all."""
    given = [one for one in getattr(scene, "limits", ()) or () if getattr(one, "for_", 0.0) > 0.0]
    return [
        f"limit {one.name or one.output}: counts in the scene after {one.for_:g} s; here it must not be passed at all"
        for one in given
    ]


def none_given(scene: Any) -> SceneError:
    """What is raised where there is no limit at all."""
    return SceneError([Problem(OPTION, None, "", None, "there is no limit to judge the storms by", EXAMPLE)])
