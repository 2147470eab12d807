"""Lists that are written in one word on the command line: ``--steps 1ms,0.5ms``."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from typing import Any

from tautline.scene.errors import option_error

EXAMPLES = {
    "s": "a time such as 1 ms", "Hz": "a frequency such as 10 Hz", "m": "a length such as 100 m",
    "m/s": "a speed such as 0.5 m/s", "rad/s": "a speed such as 60 rpm", "": "a number, or a share such as 1 %",
}  # fmt: skip
"""What an option of a unit takes, for the message about what it does not take."""
AS_A_LIST = "give entries between commas, such as 1ms,0.5ms"
DASHED = re.compile(r"[-+]?[\d.]+\s*[^\W\d]*\s*(-|–|to\b|\.\.)\s*[\d.]+.*", re.DOTALL)
"""Two numbers with a dash, ``to`` or points between them, as ranges are written in a text."""


def words(text: str | None, option: str, known: Callable[[str], str]) -> list[str]:
    """Words between commas, each as `known` reads it; empty for None.

    Raises
    ------
    SceneError
        Naming the option, for an empty list and for a word that `known` refuses by ValueError.
    """
    return _each(text, option, known)


def numbers(text: str | None, option: str, unit: str, bare: float = 1.0, example: str = "") -> list[float]:
    """Positive numbers between commas, with units, or bare numbers of `bare` SI units each; empty for None.

    An option that takes ranges, too, gives an `example` of both, the cure of what is none: ``write 0.5:4:0.5, or 1,2``.

    Raises
    ------
    SceneError
        Naming the option and the number that is none.
    """
    from pydantic import TypeAdapter, ValidationError

    from tautline.scene.values.quantity import as_in_a_file, quantity

    adapter: Any = TypeAdapter(_annotated(quantity(unit, positive=True)))

    def read(word: str) -> float:
        try:
            value = float(adapter.validate_python(as_in_a_file(word)))
        except ValidationError as error:
            ranged = example and DASHED.fullmatch(word)
            told = "a range is written with colons and a step" if ranged else str(error.errors()[0]["msg"])
            raise ValueError(told) from None
        return value * bare if _is_bare(word) else value

    return _each(text, option, read, example or (f"give {EXAMPLES[unit]}" if unit in EXAMPLES else "see --help"))


def seconds(text: str | None, option: str, known: Sequence[str] = ()) -> float | str | None:
    """A time, with a unit or in s, or one of the words that are known besides; None for None.

    Raises
    ------
    SceneError
        Naming the option, for what is neither.
    """
    return text if text is None or text in known else number(text, option, "s")


def number(
    text: str, option: str, unit: str, most: float | None = None, cure: str = "", bare: float = 1.0, example: str = ""
) -> float:
    """One positive number, with a unit; a bare one counts `bare` SI units. An `example` is the cure of what is none.

    Raises
    ------
    SceneError
        Naming the option, for more than one and for more than `most`.
    """
    if "," in text:
        raise option_error(option, text, "is more than one number", "give one, with a decimal point")
    value = numbers(text, option, unit, bare, example)[0]
    if most is not None and value > most:
        raise option_error(option, text, f"is more than {most:g}", cure)
    return value


def three_of(text: str, option: str, example: str) -> list[str]:
    """The words of ``FROM:TO:STEP``.

    Raises
    ------
    SceneError
        Naming the option, for more words or fewer, and for a step of zero; its cure is the example.
    """
    from tautline.scene.values.quantity import NUMBER

    parts = text.split(":")
    if len(parts) != 3:
        raise option_error(option, text, "needs three numbers: from, to and step", example)
    step = NUMBER.fullmatch(parts[2])
    if step is not None and float(step["number"]) == 0.0:
        raise option_error(option, text, "never gets to its end by a step of zero", example)
    return parts


def stepped(bounds: tuple[float, float, float], text: str, option: str, most: int, things: str) -> list[float]:
    """Values from the first to the last by a step, with both ends where the step meets the last but for rounding.

    Parameters
    ----------
    bounds : tuple of float
        First, last, and a step that leads from one towards the other.
    text : str
        What was given, for the message.
    most : int
        How many there may be.
    things : str
        What the values are, for the message.

    Raises
    ------
    SceneError
        Naming the option, for more than `most`.
    """
    first, last, step = bounds
    count = math.floor((last - first) / step * (1.0 + 1e-12) + 1e-9) + 1
    if count > most:
        raise option_error(option, text, f"makes {count} {things}, more than {most}", "take a larger step")
    return [first + k * step for k in range(count)]


def _is_bare(word: str) -> bool:
    """Whether a number stands without a unit."""
    try:
        float(word)
    except ValueError:
        return False
    return True


def _annotated(mark: Any) -> Any:
    from typing import Annotated

    return Annotated[float, mark]


def _each(text: str | None, option: str, read: Callable[[str], Any], cure: str = "see --help") -> list[Any]:
    if text is None:
        return []
    found: list[Any] = []
    for word in (part.strip() for part in text.split(",")):
        try:
            if not word:
                raise option_error(option, text, "an entry is empty", AS_A_LIST)
            found.append(read(word))
        except ValueError as error:
            raise option_error(option, word, str(error), cure) from None
    return list(dict.fromkeys(found))


def one_of(known: Sequence[str], aliases: dict[str, str] | None = None) -> Callable[[str], str]:
    """A reader of words that must be among some."""

    def read(word: str) -> str:
        meant = (aliases or {}).get(word, word)
        if meant not in known:
            raise ValueError(f"is not one of {', '.join(known)}")
        return meant

    return read
