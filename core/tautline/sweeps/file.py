"""The file of a sweep: what is varied in which scene, by which plan, and what is collected."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import pydantic
from pydantic_core import PydanticCustomError, ValidationError

from tautline.scene.choices.words import word
from tautline.scene.errors import Problem, SceneError
from tautline.scene.model import MARK, Scene
from tautline.scene.reading.document import Path_, join_key, key_named, split_key
from tautline.scene.refusal import fault, nearest, refusal
from tautline.scene.unit_slips import DOUBT
from tautline.scene.values.quantity import Quantity
from tautline.sweeps.distributions import KINDS, Distribution, made
from tautline.sweeps.plans import (
    LATIN,
    ONE,
    PLAIN,
    SAMPLED,
    SOBOL,
    ZIP,
    Cases,
    Parameter,
    Plan,
    balanced,
    cases_of,
)

SIMULATE = "simulate"
ORIGIN = "vary"
"""Names the sweep in messages of the scene's reader, which are then given the line of the sweep's file."""
MOST_CASES = 1_000_000
STATISTICS = ("max", "min", "mean", "rms", "sd", "range", "last")
"""What can be collected of an output over time."""
EXAMPLE = "vary: {'bodies[0].mass': [2 t, 5 t, 10 t]}"
SERIES = ("linspace", "logspace")
OWN_COLUMNS = (
    "case", "status", "message", "case_wall_time", "case_cpu_time", "percentile", "parameter", "limits_not_satisfied",
)  # fmt: skip
"""Columns and dimensions of the result that are not collected."""


class Collected(pydantic.BaseModel):
    """One thing that is collected.

    Attributes
    ----------
    name : str
        Of the column.
    figure : str
        Name of a figure that the verb finds; empty for an output.
    output : str
        Name of an output of the simulation.
    statistic : str
        Of the output over the frames: see `STATISTICS`.
    """

    model_config = pydantic.ConfigDict(frozen=True)
    name: str
    figure: str = ""
    output: str = ""
    statistic: str = ""

    @property
    def said(self) -> str | dict[str, str]:
        """It as a file would have it, with its statistic, and with its name where that is another than the usual."""
        if self.figure:
            return self.figure
        whole = {"output": self.output, "statistic": self.statistic}
        return whole if self.name == _column(self.output, self.statistic) else whole | {"name": self.name}


def _column(output: str, statistic: str) -> str:
    """Usual name of the column of an output's statistic."""
    return f"{output} {statistic}"


class SweepFile(Scene):
    """The whole file."""

    scene: str
    verb: str = SIMULATE
    options: dict[str, Any] = pydantic.Field(default_factory=dict)
    vary: Annotated[dict[str, Any], pydantic.Field(min_length=1, examples=["{'bodies[0].mass': [2 t, 5 t]}"])]
    plan: Any = "grid"
    collect: tuple[Any, ...] = ()
    indices: Annotated[Literal["sobol"] | None, word("sobol")] = None
    title: str = ""

    @pydantic.field_validator("vary", mode="before")
    @classmethod
    def _varies(cls, given: Any) -> Any:
        if isinstance(given, dict) and not given:
            raise refusal("varies nothing", EXAMPLE)
        return given

    @pydantic.field_validator("collect", mode="before")
    @classmethod
    def _listed(cls, given: Any) -> Any:
        return [given] if isinstance(given, (str, dict)) else given

    @pydantic.model_validator(mode="after")
    def _sound(self) -> SweepFile:
        ends = self.chosen_plan().makes(self.indices is not None)
        names = [one.name for one in self.collected()]
        for i, name in enumerate(names):
            if name in names[:i]:
                raise fault(("collect", i), f"'{name}' stands twice", "leave one of them out, or give it another name")
            if name in (*OWN_COLUMNS, *self.vary):
                raise fault(("collect", i), f"'{name}' is a column that every result has", "give it another name")
            other = next((one for one in names for end in ends if name == one + end), None)
            if other is not None:
                cause = f"'{name}' is a column that the plan makes of '{other}'"
                raise fault(("collect", i), cause, "give one of them another name")
        return self

    def chosen_plan(self) -> Plan:
        """The plan, of one of two forms: a word, or a name with samples and a seed."""
        given, example = self.plan, f"{{{LATIN}: {{samples: 100, seed: 1}}}}"
        if isinstance(given, str):
            name = given.strip().lower().replace(" ", "_").replace("-", "_")
            if name in PLAIN:
                return Plan(name)
            if name in SAMPLED:
                raise fault(
                    ("plan",), "needs a number of samples", f"write plan: {{{name}: {{samples: 100, seed: 1}}}}"
                )
            raise fault(("plan",), "is not one of the known plans", nearest(name, (*PLAIN, *SAMPLED)))
        if not isinstance(given, dict) or len(given) != 1:
            raise fault(("plan",), "is no plan", f"write one of {', '.join(PLAIN)}, or such as {example}")
        name, about = next(iter(given.items()))
        if name not in SAMPLED:
            raise fault(("plan", str(name)), "is no plan that samples", nearest(str(name), SAMPLED))
        if not isinstance(about, dict):
            raise fault(("plan", name), "is not a mapping", f"write plan: {example}")
        for key in about:
            if key not in ("samples", "seed"):
                raise fault(("plan", name, key), "unknown key", nearest(str(key), ("samples", "seed")))
        samples, seed = about.get("samples"), about.get("seed", 0)
        if isinstance(samples, bool) or not isinstance(samples, int) or not 1 <= samples <= MOST_CASES:
            raise fault(("plan", name, "samples"), "must be a whole number above zero", f"write plan: {example}")
        if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
            raise fault(("plan", name, "seed"), "must be a whole number, not negative", f"write plan: {example}")
        return Plan(name, samples, seed)

    def said(self) -> dict[str, Any]:
        """What makes it this sweep, by the keys of the file and with its defaults, but for which scene it is.

        A file that leaves a default out and one that writes it are of one sweep.
        """
        plan = self.chosen_plan()
        sampled = {plan.name: {"samples": plan.samples, "seed": plan.seed}}
        return {
            "verb": self.verb, "options": self.options, "vary": self.vary,
            "plan": sampled if plan.name in SAMPLED else plan.name,
            "collect": [one.said for one in self.collected()], "indices": self.indices,
        }  # fmt: skip

    def problem_at(self, path: Path_, cause: str, cure: str = "", value: str | None = None) -> Problem:
        """A problem at a key path, with the value that is meant where not all that stands there is."""
        assert self.document is not None
        return self.document.problem(path, cause, cure, value)

    def collected(self) -> list[Collected]:
        """What is collected; nothing for all figures of the verb."""
        return [_collected(i, given) for i, given in enumerate(self.collect)]


def _collected(i: int, given: Any) -> Collected:
    if isinstance(given, str) and given.strip():
        return Collected(name=given.strip(), figure=given.strip())
    example = "a figure such as max_tension, or {output: winch.tension, statistic: max}"
    if not isinstance(given, dict) or not isinstance(given.get("output"), str):
        raise fault(("collect", i), "names nothing that can be collected", f"write {example}")
    for key in given:
        if key not in ("output", "statistic", "name"):
            raise fault(("collect", i, key), "unknown key", nearest(str(key), ("output", "statistic", "name")))
    statistic = given.get("statistic", "max")
    if statistic not in STATISTICS and percentile(statistic) is None:
        known = f"known: {', '.join(STATISTICS)}, and percentiles such as p95"
        raise fault(("collect", i, "statistic"), "is not one of the known statistics", known)
    name = given.get("name", _column(given["output"], statistic))
    if not isinstance(name, str) or not name.strip() or "/" in name:
        raise fault(("collect", i, "name"), "is no name of a column", "give a word without a slash")
    return Collected(name=name.strip(), output=given["output"], statistic=statistic)


def percentile(statistic: Any) -> float | None:
    """``p95`` -> 95; None for anything else."""
    text = statistic[1:] if isinstance(statistic, str) and statistic[:1] == "p" else ""
    try:
        value = float(text)
    except ValueError:
        return None
    return value if 0.0 <= value <= 100.0 else None


def read_sweep(source: Any, folder: Any = None) -> SweepFile:
    """Read the file of a sweep, or what it says as a text or a dict.

    Raises
    ------
    SceneError
        Listing every fault with its line, key and cure.
    """
    from tautline.scene.reading.source import document_of

    return SweepFile.read(document_of(source, folder))


def plan_cases(read: SweepFile, application: Any, scene: Any) -> Cases:
    """The cases of a sweep of a scene.

    Raises
    ------
    SceneError
        For keys that the scene has not, values that they cannot have, and a plan that does not fit the parameters.
    """
    reader = _Reader(read, application, scene)
    parameters = [reader.parameter(key, given) for key, given in read.vary.items()]
    reader.apart()
    if reader.problems:
        raise SceneError(reader.problems)
    plan, found = read.chosen_plan(), [one for one in parameters if one is not None]
    wanted = _count(found, plan, read.indices is not None)
    if wanted > MOST_CASES:
        cure = f"give fewer values, or a plan that samples, such as {{{LATIN}: {{samples: 100, seed: 1}}}}"
        raise SceneError([read.problem(("plan",), f"makes {wanted} cases, more than {MOST_CASES}", cure)])
    try:
        return cases_of(found, plan, read.indices is not None)
    except ValueError as error:
        cause, _, cure = str(error).partition("; ")
        raise SceneError([read.problem(("plan",), cause, cure)]) from None


def _count(parameters: Sequence[Parameter], plan: Plan, indices: bool) -> int:
    if plan.name in SAMPLED:
        return plan.samples * (len(parameters) + 2 if indices else 1)
    lengths = [len(one.values) for one in parameters]
    if plan.name in (ONE, ZIP):
        return sum(lengths) + 2 * len(parameters)
    return math.prod(lengths)


def notes_of(read: SweepFile) -> list[str]:
    """What is sound and better done otherwise."""
    plan = read.chosen_plan()
    if plan.name == SOBOL and not balanced(plan.samples):
        below = 2 ** (plan.samples.bit_length() - 1)
        return [f"{plan.samples} points of Sobol's sequence are not balanced: take {below} or {2 * below}"]
    return []


def refused(read: SweepFile, error: SceneError, case: str = "") -> SceneError:
    """What the scene's reader refuses of a varied scene, at the lines of the sweep's file."""
    return SceneError([_moved(read, problem, case) for problem in error.problems])


def _moved(read: SweepFile, problem: Problem, case: str) -> Problem:
    if problem.file != ORIGIN:
        if not case:
            return problem
        return Problem(
            problem.file, problem.line, problem.key, problem.value, f"{problem.cause} ({case})", problem.cure
        )
    key = problem.key or problem.value or ""
    varied = [name for name in read.vary if key == name or key.startswith((f"{name}.", f"{name}["))]
    varied += [name for name in read.vary if not varied and (name.startswith(key) or not key)]
    path: Path_ = ("vary", varied[0]) if varied else ("vary",)
    value = problem.value if problem.key else None
    cause = problem.cause if not varied or key in (varied[0], "") else f"{key}: {problem.cause}"
    return read.problem_at(path, cause, problem.cure, value)


class _Reader:
    """Turns what is written of each parameter into values and numbers, and collects what is wrong."""

    def __init__(self, read: SweepFile, application: Any, scene: Any) -> None:
        self.read, self.scene = read, scene
        self.problems: list[Problem] = []
        self.application = application

    def fault(self, key: Path_, cause: str, cure: str = "", value: str | None = None) -> None:
        self.problems.append(self.read.problem_at(("vary", *key), cause, cure, value))

    def apart(self) -> None:
        """Refuse a key that stands inside another: one of the two would replace the other without a word."""
        seen: dict[Path_, str] = {}
        for key in self.read.vary:
            path = split_key(key)
            for other, name in seen.items():
                shorter = min(len(path), len(other))
                if path[:shorter] == other[:shorter]:
                    inner, outer = (key, name) if len(path) >= len(other) else (name, key)
                    self.fault((key,), f"varies with {name}, and {inner} is a part of {outer}", "keep one of the two")
            seen[path] = key

    def parameter(self, key: str, given: Any) -> Parameter | None:
        """What is varied by a key; None where it is at fault."""
        before = len(self.problems)
        try:
            key_named(key, ORIGIN)
        except SceneError as error:
            self.problems += refused(self.read, error).problems
            return None
        if isinstance(given, dict) and len(given) == 1:
            name, numbers = next(iter(given.items()))
            if name in KINDS:
                found = self._spread(key, name, numbers)
            elif name in SERIES:
                found = self._series(key, name, numbers)
            else:
                known = (*SERIES, *KINDS)
                self.fault((key, str(name)), "is no way to vary a parameter", nearest(str(name), known))
                return None
        elif isinstance(given, list):
            found = self._list(key, given)
        else:
            ways = "a list of values, {linspace: [from, to, number]}, or a distribution such as {uniform: [from, to]}"
            self.fault((key,), "says no values", f"give {ways}")
            return None
        return found if len(self.problems) == before else None

    def _base(self, key: str) -> float:
        return quantity_at(self.application, self.scene, key)[1]

    def _list(self, key: str, given: list[Any]) -> Parameter | None:
        if not given:
            self.fault((key,), "is an empty list", "give at least one value")
            return None
        quantity = self._quantity(key, given)
        numbers = tuple(_number(value, quantity) for value in given)
        return Parameter(key, _unit(quantity), tuple(given), numbers, None, self._base(key))

    def _series(self, key: str, name: str, given: Any) -> Parameter | None:
        at = (key, name)
        if not isinstance(given, list) or len(given) != 3:
            self.fault(at, "needs three numbers", f"write {{{name}: [from, to, number]}}, such as [5, 15, 11]")
            return None
        count = given[2]
        if isinstance(count, int) and count > MOST_CASES:
            self.fault(at, f"makes {count} values, more than {MOST_CASES}", "take fewer")
            return None
        if isinstance(count, bool) or not isinstance(count, int) or count < 1:
            self.fault(
                at, "must end with a whole number of values", f"write {{{name}: [from, to, number]}}", str(count)
            )
            return None
        ends = self._numbers(key, name, given[:2], (True, True))
        if ends is None:
            return None
        (first, last), quantity = ends
        if name == "linspace":
            steps = [first + (last - first) * (k / (count - 1)) for k in range(count - 1)] if count > 1 else []
        else:
            if not (first > 0.0 and last > 0.0):
                self.fault(at, "spans values that are not above zero", "take linspace, or values above zero")
                return None
            ratio = math.log(last / first)
            steps = [first * math.exp(ratio * (k / (count - 1))) for k in range(count - 1)] if count > 1 else []
        numbers = [*steps, last] if count > 1 else [first]
        if count > 1:
            numbers[0] = first
        return self._of_numbers(key, numbers, quantity, given)

    def _of_numbers(self, key: str, numbers: list[float], quantity: Quantity | None, given: list[Any]) -> Parameter:
        """A list of numbers; where whole ones were given and the key is no quantity, each that is whole is so."""
        whole = quantity is None and all(isinstance(one, int) for one in given)
        values: list[Any] = [int(number) if whole and number.is_integer() else number for number in numbers]
        return Parameter(key, _unit(quantity), tuple(values), tuple(numbers), None, self._base(key))

    def _spread(self, key: str, name: str, given: Any) -> Parameter | None:
        kind, written = KINDS[name], given if isinstance(given, list) else [given]
        if len(written) != len(kind.given):
            cause = f"takes {len(kind.given)} numbers: {', '.join(kind.given)}"
            self.fault((key, name), cause, f"write {kind.text}")
            return None
        found = self._numbers(key, name, written, kind.measured)
        if found is None:
            return None
        numbers, quantity = found
        try:
            spread: Distribution = made(name, numbers)
        except ValueError as error:
            self.fault((key, name), f"is no distribution: {error}", f"write such as {kind.text}")
            return None
        return Parameter(key, _unit(quantity), (), (), spread, self._base(key))

    def _numbers(
        self, key: str, name: str, given: list[Any], measured: Sequence[bool]
    ) -> tuple[list[float], Quantity | None] | None:
        """Numbers in SI of what is written, those that are measured in the unit of the key."""
        quantity, before = self._quantity(key, given), len(self.problems)
        if quantity is None and any(isinstance(one, (str, dict, list)) or one is None for one in given):
            self._why(key, given)
            if len(self.problems) == before:
                self.fault((key, name), "is no list of numbers", "this key takes no unit: write plain numbers")
            return None
        numbers = []
        for value, counts in zip(given, measured, strict=True):
            of = Quantity(quantity.unit if quantity is not None and counts else "", any_size=True)
            try:
                numbers.append(float(of.read(value)))
            except PydanticCustomError as error:
                self.fault((key, name), error.message(), str((error.context or {}).get("cure", "")), str(value))
        return (numbers, quantity) if len(numbers) == len(given) else None

    def _quantity(self, key: str, given: list[Any]) -> Quantity | None:
        """The quantity that a key is: of the scene as it is, or with a value that it can have, the others as they are.

        That a value cannot be had beside the others says nothing: they may vary too.
        """
        known = quantity_at(self.application, self.scene, key)[0]
        for value in given:
            if known is not None:
                break
            with contextlib.suppress(SceneError):
                known = quantity_at(self.application, self.scene.replace({key: value}, origin=ORIGIN), key)[0]
        return known

    def _why(self, key: str, given: list[Any]) -> None:
        """Keep why a key cannot have the first value."""
        try:
            self.scene.replace({key: given[0]}, origin=ORIGIN)
        except SceneError as error:
            self.problems += refused(self.read, error).problems


def _unit(quantity: Quantity | None) -> str:
    return quantity.unit if quantity is not None else ""


def _number(value: Any, quantity: Quantity | None) -> float:
    """A value of a list in SI; NaN for what is no number, or none that the key can have."""
    if quantity is None:
        plain = isinstance(value, (int, float)) and not isinstance(value, bool)
        return float(value) if plain else math.nan
    try:
        return float(Quantity(quantity.unit, any_size=True).read(value))
    except PydanticCustomError:
        return math.nan


def quantity_at(application: Any, scene: Any, key: str) -> tuple[Quantity | None, float]:
    """The quantity that a key of a scene is, and its value in SI; None and NaN where it is none, or not there."""
    found = _quantities(application, scene)
    return found.get(join_key(split_key(key)), (None, math.nan))


def _quantities(application: Any, scene: Any) -> Mapping[str, tuple[Quantity, float]]:
    """All numbers with units of a scene, by key: a second validation names them, as it does those in doubt."""
    as_written = getattr(application, "as_written", None)
    model, document = as_written(scene) if as_written is not None else (type(scene), scene.document)
    kept: dict[str, tuple[Quantity, float]] = {}

    def name(quantity: Quantity, written: Any, value: float) -> None:
        raise PydanticCustomError(DOUBT, "quantity", {"quantity": quantity, "value": value})

    try:
        model.model_validate(document.root, context={"folder": document.folder, "doubt": name})
    except ValidationError as error:
        for one in error.errors(include_url=False, include_input=False):
            if one["type"] == DOUBT:
                path = tuple(part for part in one["loc"] if not (isinstance(part, str) and part.startswith(MARK)))
                context: Any = one.get("ctx") or {}
                kept[join_key(path)] = context["quantity"], float(context["value"])
    return kept


def scene_path(read: SweepFile) -> Path:
    """The scene's file, relative to the sweep's.

    Raises
    ------
    SceneError
        At the key that names it, where there is none, or it is no text.
    """
    from tautline.scene.reading.text import read_text

    path = read.folder / read.scene
    try:
        read_text(path)
    except SceneError as error:
        first = error.problems[0]
        if first.line is not None:
            raise
        raise SceneError([read.problem(("scene",), first.cause, first.cure)]) from None
    return path
