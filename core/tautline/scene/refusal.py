"""How a validator refuses a value: with a cause and a cure, at a key.

pydantic collects these; `tautline.scene.model.validate` turns them into `Problem`.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Sequence
from typing import Annotated, Any

from pydantic import TypeAdapter
from pydantic.fields import FieldInfo
from pydantic_core import InitErrorDetails, PydanticCustomError, ValidationError

from tautline.scene.errors import LONGEST

KIND = "problem"
"""The pydantic error type that carries a cause and a cure."""
OTHER_WORDS = {
    "wob": ("weight",), "weight_on_bit": ("weight",), "tob": ("torque",), "torque_on_bit": ("torque",),
    "weight": ("mass", "mass_per_length"), "mbl": ("breaking_load",), "ea": ("axial_stiffness",),
    "rpm": ("rotation", "speed"), "rop": ("penetration", "rate"), "dls": ("rate",), "bha": ("string",),
    "md": ("hold", "length"), "od": ("diameter",), "ff": ("friction",), "friction_factor": ("friction",),
    "hs": ("significant_height",), "h_s": ("significant_height",), "swh": ("significant_height",),
    "tp": ("peak_period",), "t_p": ("peak_period",), "cd": ("drag", "rope_drag"),
    "dt": ("step", "time_step"), "delta_t": ("step", "time_step"), "diameter": ("radius",),
    "pulley": ("sheave",), "roller": ("sheave",), "winch": ("drum",), "hoist": ("drum",), "line_type": ("rope",),
    "line": ("rope",), "cable": ("rope",), "wire": ("rope",), "wire_rope": ("rope",),
}  # fmt: skip
"""Words that people write for a key, in small letters, and the keys that may be meant."""
IN_UNITS = {"rpm": "60 rpm", "rop": "15 m/h", "dls": "3 deg/30m"}
"""Those that say the unit as well: a bare number of them would be another one under the key; with an example."""
DIFFERS = {("diameter", "radius"): "it is half of the diameter"}
"""What is to be written otherwise where a key has another word: (word, key)."""


def refusal(
    cause: str, cure: str = "", file: str | None = None, line: int | None = None, beside: str = "", wanted: str = ""
) -> PydanticCustomError:
    """Build the error by which a field's validator refuses its value.

    Parameters
    ----------
    cause, cure : str
        What is wrong and what to do, in plain words.
    file, line
        Where the fault lies if not in the scene itself: a row of a table that the scene names.
    beside : str
        As of `fault`.
    wanted : str
        SI unit of the quantity that is wanted, where one of another kind was given.
    """
    context: dict[str, str | int] = {"cause": cause, "cure": cure}
    if file is not None:
        context["file"] = file
    if line is not None:
        context["line"] = line
    if beside:
        context["beside"] = beside
    if wanted:
        context["wanted"] = wanted
    return PydanticCustomError(KIND, "{cause}", context)


def fault(key: str | int | tuple[str | int, ...], cause: str, cure: str = "", beside: str = "") -> ValidationError:
    """Build the error by which a model refuses one of its keys after all were read.

    Parameters
    ----------
    key : str, int or tuple
        Key, or path of keys, below the model that raises this.
    cause, cure : str
        What is wrong and what to do.
    beside : str
        Key, from the top of the file, of the value that this one contradicts: it is shown as it was written, with its
        line. One that begins with a point, ``.id``, stands beside this key.
    """
    path = key if isinstance(key, tuple) else (key,)
    return ValidationError.from_exception_data(
        "scene", [InitErrorDetails(type=refusal(cause, cure, beside=beside), loc=path, input=None)]
    )


def raise_all(faults: Iterable[tuple[str | tuple[str | int, ...], str, str]]) -> None:
    """Refuse several keys at once: (key or path, cause, cure) of each; none is no fault."""
    details = [
        InitErrorDetails(type=refusal(cause, cure), loc=key if isinstance(key, tuple) else (key,), input=None)
        for key, cause, cure in faults
    ]
    if details:
        raise ValidationError.from_exception_data("scene", details)


def one_of(words: Sequence[str]) -> str:
    """Words of which one is to be written: ``over, under, left or right``."""
    return " or ".join(filter(None, (", ".join(words[:-1]), words[-1])))


def must_be(words: Sequence[str], guess: str = "") -> str:
    """The cure of a word that is not known: ``did you mean 'static'? It must be static or as drawn``."""
    rule = f"t must be {one_of(words)}"
    return f"did you mean '{guess}'? I{rule}" if guess else f"i{rule}"


def meant(word: str, known: Iterable[str]) -> str:
    """Say which known word was probably meant; nothing where none is near."""
    words = list(known)
    close = difflib.get_close_matches(word[:LONGEST].lower(), [w.lower() for w in words], n=1, cutoff=0.6)
    return f"did you mean '{next(w for w in words if w.lower() == close[0])}'?" if close else ""


def nearest(word: str, known: Iterable[str]) -> str:
    """Say which known word was probably meant, or list those there are."""
    words = list(known)
    if close := meant(word, words):
        return close
    if len(words) == 1:
        return f"known: {words[0]}"
    return f"known: {', '.join(words)}" if words else "remove it"


def other_word(key: str, known: Iterable[str]) -> str:
    """The key for which a word of the trade stands; nothing where it stands for none of those there are."""
    words = set(known)
    return next((word for word in OTHER_WORDS.get(key.lower(), ()) if word in words), "")


def nearest_key(key: str, known: Iterable[str], fields: Mapping[str, FieldInfo] | None = None) -> str:
    """Say which key was probably meant, by another word for the same or by its letters, or list those there are.

    A word that says its unit, too, stands for no key of another quantity: of a pipe's `rate` in m/s `dls` is none.
    That is asked of the `fields` of a model, where they are given.
    """
    words, example = list(known), IN_UNITS.get(key.lower(), "")
    kinds = {word: _takes((fields or {}).get(word), example) for word in words} if example else {}
    if not (word := other_word(key, [word for word in words if kinds.get(word) is not False])):
        return nearest(key, words)
    said = f"did you mean '{word}'?"
    if differs := DIFFERS.get((key.lower(), word)):
        return f"{said} Note: {differs}"
    return f"{said} Write its unit too, such as {word}: {example}" if kinds.get(word) else said


def _takes(field: FieldInfo | None, example: str) -> bool | None:
    """Whether a field takes a number with a unit; False where it takes another quantity, None where that is not known.

    None is also what takes no number, such as a mapping of keys.
    """
    if field is None:
        return None
    kind: Any = Annotated[field.annotation, *field.metadata, None]
    try:
        TypeAdapter(kind).validate_python(example)
    except ValidationError as error:
        return False if any((one.get("ctx") or {}).get("wanted") for one in error.errors()) else None
    return True
