"""How a parameter is spread: distributions by name, and their quantiles."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

SMALLEST = 2.0**-53
"""Distance from 0 and 1 that a probability keeps: at these a distribution without bounds has no quantile."""


class Kind(NamedTuple):
    """A distribution: what is given of it, which of these are in the unit of the parameter, how it is made.

    ``make`` takes the numbers and returns what has ``ppf``, or says in a ValueError why there is none.
    """

    given: tuple[str, ...]
    measured: tuple[bool, ...]
    make: Callable[..., Any]
    text: str


@dataclass(frozen=True)
class Distribution:
    """A distribution with its numbers, in SI."""

    name: str
    numbers: tuple[float, ...]

    def quantiles(self, probability: np.ndarray) -> np.ndarray:
        """Values below which the parameter stays with so much probability, of the same shape."""
        inside = np.clip(probability, SMALLEST, 1.0 - SMALLEST)
        return np.asarray(KINDS[self.name].make(*self.numbers).ppf(inside), float)


def _normal(mean: float, sd: float) -> Any:
    from scipy.stats import norm

    return norm(mean, _positive(sd, "standard deviation"))


def _truncated(mean: float, sd: float, low: float, high: float) -> Any:
    from scipy.stats import truncnorm

    sd = _positive(sd, "standard deviation")
    _rising(low, high)
    return truncnorm((low - mean) / sd, (high - mean) / sd, mean, sd)


def _lognormal(mean: float, sd: float) -> Any:
    """Log-normal by its own mean and standard deviation, not by those of its logarithm."""
    from scipy.stats import lognorm

    mean, sd = _positive(mean, "mean"), _positive(sd, "standard deviation")
    variance = np.log1p((sd / mean) ** 2)
    return lognorm(np.sqrt(variance), scale=mean * np.exp(-0.5 * variance))


def _uniform(low: float, high: float) -> Any:
    from scipy.stats import uniform

    _rising(low, high)
    return uniform(low, high - low)


def _triangular(low: float, mode: float, high: float) -> Any:
    from scipy.stats import triang

    _rising(low, high)
    if not low <= mode <= high:
        raise ValueError("its mode lies outside its bounds")
    return triang((mode - low) / (high - low), low, high - low)


def _weibull(scale: float, shape: float) -> Any:
    from scipy.stats import weibull_min

    return weibull_min(_positive(shape, "shape"), scale=_positive(scale, "scale"))


def _gumbel(location: float, scale: float) -> Any:
    from scipy.stats import gumbel_r

    return gumbel_r(location, _positive(scale, "scale"))


def _rayleigh(scale: float) -> Any:
    from scipy.stats import rayleigh

    return rayleigh(scale=_positive(scale, "scale"))


def _exponential(mean: float) -> Any:
    from scipy.stats import expon

    return expon(scale=_positive(mean, "mean"))


def _positive(value: float, what: str) -> float:
    if not value > 0.0:
        raise ValueError(f"its {what} must be greater than zero")
    return value


def _rising(low: float, high: float) -> None:
    if not low < high:
        raise ValueError("its lower bound must be below its upper bound")


KINDS: dict[str, Kind] = {
    "normal": Kind(("mean", "standard deviation"), (True, True), _normal, "{normal: [5 t, 0.5 t]}"),
    "truncated_normal": Kind(
        ("mean", "standard deviation", "lower bound", "upper bound"), (True,) * 4, _truncated,
        "{truncated_normal: [5 t, 0.5 t, 4 t, 6 t]}",
    ),
    "lognormal": Kind(("mean", "standard deviation"), (True, True), _lognormal, "{lognormal: [5 t, 0.5 t]}"),
    "uniform": Kind(("lower bound", "upper bound"), (True, True), _uniform, "{uniform: [4 t, 6 t]}"),
    "triangular": Kind(
        ("lower bound", "mode", "upper bound"), (True,) * 3, _triangular, "{triangular: [4 t, 5 t, 6 t]}"
    ),
    "weibull": Kind(("scale", "shape"), (True, False), _weibull, "{weibull: [2 m, 1.5]}"),
    "gumbel": Kind(("location", "scale"), (True, True), _gumbel, "{gumbel: [2 m, 0.3 m]}"),
    "rayleigh": Kind(("scale",), (True,), _rayleigh, "{rayleigh: 2 m}"),
    "exponential": Kind(("mean",), (True,), _exponential, "{exponential: 2 m}"),
}  # fmt: skip
"""Distributions by name. Numbers that are measured are in the unit of the parameter; others are pure numbers."""


def made(name: str, numbers: Sequence[float]) -> Distribution:
    """A distribution of a name; raises ValueError, which says why, for numbers that it cannot have."""
    kind = KINDS[name]
    if len(numbers) != len(kind.given):
        raise ValueError(f"{name} takes {len(kind.given)} numbers: {', '.join(kind.given)}")
    kind.make(*numbers)
    return Distribution(name, tuple(float(number) for number in numbers))
