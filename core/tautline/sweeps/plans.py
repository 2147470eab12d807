"""Plans: which values the parameters have in each case."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from tautline.sweeps.distributions import Distribution

GRID, ZIP, ONE = "grid", "zip", "one_at_a_time"
LATIN, SOBOL, RANDOM = "latin_hypercube", "sobol", "monte_carlo"
PLAIN, SAMPLED = (GRID, ZIP, ONE), (LATIN, SOBOL, RANDOM)
CASE = "case"
"""Dimension of every plan but a grid."""
PERCENTILES, COUNTED = "_percentiles", "_percentiles_of"
"""How columns end that a plan that samples makes of another."""
LEFT, OF_INDICES = "_indices_of", ("_first", "_total", "_first_interval", "_total_interval")
"""How those end that Sobol' indices are."""
TAILS = (0.1, 0.9)
"""Probabilities of the two values that a distribution has in a plan of one parameter at a time."""


class _AsInTheScene:
    """What a parameter is where the scene's own value stays; null is another thing, and takes that away."""

    def __repr__(self) -> str:
        return "as in the scene"


AS_IN_THE_SCENE = _AsInTheScene()


class Plan(NamedTuple):
    """A plan: its name; of one that samples, the number of samples and the seed."""

    name: str = GRID
    samples: int = 0
    seed: int = 0

    def makes(self, indices: bool) -> tuple[str, ...]:
        """How columns end that it makes of others, with indices or without."""
        if indices:
            return (LEFT, *OF_INDICES)
        return (PERCENTILES, COUNTED) if self.name in SAMPLED else ()


@dataclass(frozen=True)
class Parameter:
    """What is varied.

    Attributes
    ----------
    key : str
        Dotted name of the key in the scene.
    unit : str
        SI unit of its numbers.
    values : tuple
        Values as they stand in the scene: numbers in SI, texts with units, words, mappings; of a list.
    numbers : tuple of float
        The same in SI; NaN for what is no number.
    spread : Distribution or None
        In place of a list.
    base : float
        The scene's own value, SI; NaN where it has none.
    """

    key: str
    unit: str = ""
    values: tuple[Any, ...] = ()
    numbers: tuple[float, ...] = ()
    spread: Distribution | None = None
    base: float = math.nan

    @property
    def numeric(self) -> bool:
        """Whether all its values are numbers."""
        return self.spread is not None or not any(math.isnan(number) for number in self.numbers)

    def at(self, probability: np.ndarray) -> tuple[list[Any], list[float]]:
        """Values and numbers at probabilities (n,); those of a list are equally likely, in their order."""
        if self.spread is not None:
            found = self.spread.quantiles(probability).tolist()
            return found, found
        places = np.minimum((probability * len(self.values)).astype(int), len(self.values) - 1)
        return [self.values[k] for k in places], [self.numbers[k] for k in places]


@dataclass(frozen=True)
class Cases:
    """All cases of a sweep.

    Attributes
    ----------
    parameters : tuple of Parameter
    plan : Plan
    dims, shape : tuple
        Of the result: a dimension a parameter, or ``case``; cases are in row-major order.
    values : dict of str to list
        Key -> its value in each case, None for null; `AS_IN_THE_SCENE` where the scene's own stays.
    numbers : dict of str to array
        Key -> the same in SI, NaN for what is no number.
    indices : bool
        Whether the cases are those of Saltelli's design, from which Sobol' indices are found.
    """

    parameters: tuple[Parameter, ...]
    plan: Plan
    dims: tuple[str, ...]
    shape: tuple[int, ...]
    values: dict[str, list[Any]]
    numbers: dict[str, np.ndarray]
    indices: bool = False

    def __len__(self) -> int:
        return math.prod(self.shape)

    def changes(self, case: int) -> dict[str, Any]:
        """What the scene is changed by in a case, for ``scene.replace``."""
        of_case = ((key, values[case]) for key, values in self.values.items())
        return {key: value for key, value in of_case if value is not AS_IN_THE_SCENE}


def cases_of(parameters: Sequence[Parameter], plan: Plan, indices: bool = False) -> Cases:
    """The cases of a plan.

    Parameters
    ----------
    parameters : sequence of Parameter
    plan : Plan
    indices : bool
        Whether Sobol' indices are wanted: then the plan, which has to be ``sobol``, is Saltelli's.

    Raises
    ------
    ValueError
        For parameters that the plan cannot have; the sentence says why, and after a semicolon what to do.
    """
    parameters = tuple(parameters)
    if indices and plan.name != SOBOL:
        raise ValueError(f"gives no Sobol' indices; write plan: {{{SOBOL}: {{samples: 256}}}}")
    if plan.name in SAMPLED:
        table = _saltelli(plan, len(parameters)) if indices else _probabilities(plan, len(parameters))
        columns = [parameter.at(column) for parameter, column in zip(parameters, table.T, strict=True)]
        return _of_columns(parameters, plan, columns, indices)
    if plan.name == ONE:
        return _of_columns(parameters, plan, _one_at_a_time(parameters))
    for parameter in parameters:
        if parameter.spread is not None:
            cure = f"take a plan that samples, such as {{{LATIN}: {{samples: 100, seed: 1}}}}, or give a list"
            raise ValueError(f"has no place for a distribution ({parameter.key}); {cure}")
    if plan.name == ZIP:
        lengths = {parameter.key: len(parameter.values) for parameter in parameters}
        if len(set(lengths.values())) > 1:
            told = ", ".join(f"{key} has {count}" for key, count in lengths.items())
            raise ValueError(f"takes the n-th value of each, and their numbers differ: {told}; give as many of each")
        return _of_columns(parameters, plan, [(list(one.values), list(one.numbers)) for one in parameters])
    return _grid(parameters, plan)


def _grid(parameters: tuple[Parameter, ...], plan: Plan) -> Cases:
    for one in parameters:
        for twice in _repeated(one):
            cause = f"has {one.key} = {word_of(twice)} twice, and would run its cases twice"
            raise ValueError(f"{cause}; give each value once")
    shape = tuple(len(parameter.values) for parameter in parameters)
    places = np.indices(shape).reshape(len(shape), -1)
    columns = [
        ([one.values[k] for k in place], [one.numbers[k] for k in place])
        for one, place in zip(parameters, places, strict=True)
    ]
    return _of_columns(parameters, plan, columns, False, tuple(one.key for one in parameters), shape)


def word_of(value: Any) -> str:
    """A value that is no number in words, as a file has it."""
    return "null" if value is None else str(value)


def _repeated(one: Parameter) -> Iterator[Any]:
    """Values that a parameter has had already, by their numbers where they are some."""
    seen: set[Any] = set()
    for value, number in zip(one.values, one.numbers, strict=True):
        mark = repr(value) if math.isnan(number) else number
        if mark in seen:
            yield value
        seen.add(mark)


def _of_columns(
    parameters: tuple[Parameter, ...],
    plan: Plan,
    columns: Sequence[tuple[list[Any], list[float]]],
    indices: bool = False,
    dims: tuple[str, ...] = (CASE,),
    shape: tuple[int, ...] = (),
) -> Cases:
    values = {one.key: column[0] for one, column in zip(parameters, columns, strict=True)}
    numbers = {one.key: np.array(column[1]) for one, column in zip(parameters, columns, strict=True)}
    return Cases(parameters, plan, dims, shape or (len(columns[0][0]),), values, numbers, indices)


def _one_at_a_time(parameters: Sequence[Parameter]) -> list[tuple[list[Any], list[float]]]:
    """The scene as it is, then each parameter at each of its values, while the others stay as they are."""
    columns: list[tuple[list[Any], list[float]]] = [([AS_IN_THE_SCENE], [one.base]) for one in parameters]
    for varied, one in enumerate(parameters):
        values, numbers = one.at(np.array(TAILS)) if one.spread is not None else (one.values, one.numbers)
        for value, number in zip(values, numbers, strict=True):
            for place, (of_values, of_numbers) in enumerate(columns):
                of_values.append(value if place == varied else AS_IN_THE_SCENE)
                of_numbers.append(number if place == varied else parameters[place].base)
    return columns


def _probabilities(plan: Plan, dimensions: int) -> np.ndarray:
    """Points of the unit cube, (samples, dimensions)."""
    from scipy.stats import qmc

    if plan.name == RANDOM:
        return np.random.default_rng(plan.seed).random((plan.samples, dimensions))
    engine: Any = qmc.LatinHypercube if plan.name == LATIN else qmc.Sobol
    return _drawn(engine(dimensions, seed=plan.seed), plan.samples)


def _drawn(engine: Any, samples: int) -> np.ndarray:
    """Points of an engine; that so many of Sobol's sequence are not balanced is said by `balanced`, in our words."""
    import warnings

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        return engine.random(samples)


def balanced(samples: int) -> bool:
    """Whether a number of points keeps the balance of Sobol's sequence: a power of two does."""
    return samples & (samples - 1) == 0


def _saltelli(plan: Plan, dimensions: int) -> np.ndarray:
    """Saltelli's design, (samples * (dimensions + 2), dimensions), in the order that SALib reads.

    For each sample: A, then A with each coordinate in turn from B, then B, where A and B are the two halves of a
    point of Sobol's sequence of twice as many dimensions (Saltelli and others 2010, Comput. Phys. Commun. 181, 259).
    """
    from scipy.stats import qmc

    both = _drawn(qmc.Sobol(2 * dimensions, seed=plan.seed), plan.samples)
    first, second = both[:, :dimensions], both[:, dimensions:]
    blocks = [first]
    for k in range(dimensions):
        mixed = first.copy()
        mixed[:, k] = second[:, k]
        blocks.append(mixed)
    return np.stack([*blocks, second], axis=1).reshape(-1, dimensions)
