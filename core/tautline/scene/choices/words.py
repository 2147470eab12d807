"""Words that a key takes one of: capitals, blanks and dashes do not matter, aliases are understood."""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from tautline.scene.errors import LONGEST
from tautline.scene.refusal import must_be, one_of, refusal


def word(*known: str, aliases: dict[str, str] | None = None, forms: Sequence[str] = ()) -> BeforeValidator:
    """Annotate a choice of words: capitals, spaces and underscores do not matter, aliases are understood.

    `forms` are what else may be written in place of a word, for messages: ``{efficiency: 0.98}``.
    """
    return BeforeValidator(lambda value: read_word(value, known, aliases or {}, forms))


def fold(text: str) -> str:
    """A word without what does not matter in it: capitals, and whether its parts stand between blanks or dashes."""
    return text.lower().replace("_", "-").replace(" ", "-")


def _spelt(word: str) -> str:
    """Regular expression of all spellings of a word that `fold` makes the same."""
    ways = (f"[{c}{c.upper()}]" if c.isalpha() else "[-_ ]" if c == "-" else re.escape(c) for c in fold(word))
    return "".join(ways)


def read_word(value: Any, known: Sequence[str], aliases: Mapping[str, str], forms: Sequence[str] = ()) -> str:
    """The known word that is meant; refuses anything else with the nearest."""
    words = {fold(w): w for w in known} | {fold(a): w for a, w in aliases.items()}
    if not isinstance(value, str):
        kinds = "a word or a mapping" if forms else "a word"
        raise refusal(f"must be {kinds}", f"give {one_of([*known, *forms])}")
    if fold(value) in words:
        return words[fold(value)]
    inside = next((form for form in forms if form.startswith("{" + value.strip() + ":")), "")
    close = difflib.get_close_matches(fold(value[:LONGEST]), list(words), n=1)
    guess = inside or (words[close[0]] if close else "")
    raise refusal("is not known here", must_be([*known, *forms], guess))


UnitSystem = Annotated[Literal["si", "metric", "field"], word("si", "metric", "field")]
"""Units in which figures of a scene are printed and drawn; numbers without a unit are SI in each."""


class WordOf:
    """Annotation of a choice of words that may grow: names and aliases are asked for when a value is read."""

    def __init__(self, names: Callable[[], Sequence[str]], aliases: Callable[[], Mapping[str, str]]) -> None:
        self.names, self.aliases = names, aliases

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Read a word before anything else is made of it."""
        return core_schema.no_info_before_validator_function(
            lambda value: read_word(value, self.names(), self.aliases()), handler(source)
        )

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: Any) -> dict[str, Any]:
        """The words that there are now, and how else they may be written."""
        spellings = "|".join(_spelt(word) for word in (*self.names(), *self.aliases()))
        return handler(schema) | {"anyOf": [{"enum": list(self.names())}, {"pattern": f"^({spellings})$"}]}
