"""The options of ``operability`` as one value, and what they ask of a scene."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from tautline.scene.errors import option_error

if TYPE_CHECKING:
    from crane.operability.asked import Asked
    from crane.operability.scatter import Scatter

MOST = 200
"""Values that one of the lists may have."""
LEAD = "give a time in which the sea grows and the load settles, such as 100 s"
SAME_HEADING = 1.0e-9
"""Angle, rad, within which two headings are one: rounding of degrees and of turns."""


@dataclass(frozen=True, kw_only=True)
class OperabilityOptions:
    """What the command line gave for an operability study, as it is written there."""

    hs: str | None
    tp: str | None
    heading: str | None
    seeds: int
    first_seed: int
    duration: str
    simulated: str | None
    lead_in: str
    limit: Sequence[str] | None
    percentile: str
    confidence: str
    scatter: Path | None
    sn_constant: float | None


def read_options(given: OperabilityOptions, gravity: Sequence[float]) -> Asked:
    """What an operability study asks of a scene.

    Parameters
    ----------
    gravity : sequence of 3 floats
        Of the scene, m/s^2: it limits how steep waves can be.

    Raises
    ------
    SceneError
        Naming the option that cannot be read, or is missing.
    """
    from crane.operability.asked import Asked
    from crane.operability.conditions import conditions_of
    from crane.operability.scatter import read_scatter
    from tautline.cli.options.lists import number

    diagram = None if given.scatter is None else read_scatter(given.scatter)
    heights = _range(given.hs, "--hs", "m", "0.5:4:0.5", None if diagram is None else diagram.heights.tolist())
    periods = _range(given.tp, "--tp", "s", "5:15:1", None if diagram is None else diagram.periods.tolist())
    headings: list[float | None] = list(_headings(given.heading)) if given.heading is not None else [None]
    length = number(given.duration, "--duration", "s")
    compared, share = _compared(given.percentile)
    certain = _share(given.confidence, "--confidence", "90 %")
    _check_sn_constant(given.sn_constant, diagram)
    return Asked(
        conditions=conditions_of(heights, periods, headings, gravity),
        seeds=range(given.first_seed, given.first_seed + given.seeds),
        duration=length,
        simulated=length if given.simulated is None else number(given.simulated, "--simulate", "s"),
        limits=tuple(given.limit or ()),
        share=share,
        confidence=certain,
        compared=compared,
        scatter=diagram,
        constant=given.sn_constant,
        lead=number(given.lead_in, "--lead-in", "s", example=LEAD),
        not_reached=tuple(
            filter(None, (_not_reached(*one) for one in ((given.hs, "--hs", "m"), (given.tp, "--tp", "s"))))
        ),
        bare=given.duration.strip()[-1:].isdigit(),
    )


def _check_sn_constant(constant: float | None, diagram: Scatter | None) -> None:
    if constant is None:
        return
    if diagram is None:
        cause = "is for the fatigue over a scatter diagram, and none is given"
        raise option_error("--sn-constant", f"{constant:g}", cause, "give --scatter, or leave it out")
    if not 0.0 < constant < math.inf:
        cause = "is no constant of an S-N curve: N (S / breaking load)^5 is a number above zero"
        raise option_error("--sn-constant", f"{constant:g}", cause, "give the one of the rope, such as 1e3")


def _range(text: str | None, option: str, unit: str, example: str, other: list[float] | None) -> list[float]:
    """Increasing values of ``FROM:TO:STEP`` or ``A,B,C``; `other` where nothing is given."""
    from tautline.cli.options.lists import number, numbers, stepped, three_of

    if text is None:
        if other is None:
            raise option_error(option, "", "is missing", f"give {option} {example}")
        return other
    if ":" not in text:
        return sorted(numbers(text, option, unit, example=f"write {option} {example}, or values between commas"))
    first, last, step = (number(word, option, unit) for word in three_of(text, option, f"write {option} {example}"))
    if last < first:
        raise option_error(option, text, "goes downwards", f"write {option} {example}")
    # Without the rounding of sums: 0.30000000000000004 is no height that anybody gave.
    return [float(f"{value:.12g}") for value in stepped((first, last, step), text, option, MOST, "values")]


def _not_reached(text: str | None, option: str, unit: str) -> str:
    """A note on a range whose step does not meet its end; empty for others."""
    from tautline.cli.options.lists import number

    if text is None or ":" not in text:
        return ""
    values, last = _range(text, option, unit, "", None), number(text.split(":")[1], option, unit)
    if values[-1] >= last * (1.0 - 1e-9):
        return ""
    return (
        f"{option} {text} ends at {values[-1]:.6g} {unit}: its step does not meet {last:.6g} {unit}. For both ends "
        "give another step, or values between commas"
    )


def _headings(text: str) -> list[float]:
    """Headings between commas, in degrees where they have no unit, as rad; each once, for whole turns do not count."""
    from pydantic_core import PydanticCustomError

    from tautline.scene.values.quantity import Quantity

    found = []
    for word in text.split(","):
        written = word.strip()
        try:
            plain = written.replace(".", "", 1).lstrip("+-").isdigit()
            found.append(float(Quantity("rad", any_size=True).read(f"{written} deg" if plain else written)))
        except PydanticCustomError as error:
            cure = "write such as --heading 0,90,180"
            raise option_error("--heading", written or text, error.message(), cure) from None
    once: list[float] = []
    for angle in sorted(found, key=lambda angle: (abs(angle), -angle)):
        if not any(abs(math.remainder(angle - other, 2.0 * math.pi)) < SAME_HEADING for other in once):
            once.append(angle)
    return sorted(once)


def _compared(text: str) -> tuple[str, float]:
    """What is compared with limits, and the share of storms that keep them."""
    word = text.strip().lower().replace("_", "-").replace(" ", "-")
    if word in ("most-probable", "mpm"):
        return "most_probable", 0.9
    return "percentile", _share(word.removeprefix("p"), "--percentile", "P90", given=text)


def _share(text: str, option: str, example: str, given: str | None = None) -> float:
    """A percentage between 0 and 100, as a share."""
    word = text.strip()
    try:
        value = float(word.removesuffix("%"))
    except ValueError:
        value = math.nan
    if 0.0 < value <= 1.0 and not word.endswith("%"):
        # Taken as a percentage, 0.9 would give an interval of next to nothing, and the smallest of the largest.
        raise option_error(
            option, given or text, f"may mean {100.0 * value:g} % or {value:g} %", f"write such as {example}"
        )
    if not 0.0 < value < 100.0:
        raise option_error(option, given or text, "is no percentage between 0 and 100", f"write such as {example}")
    return value / 100.0
