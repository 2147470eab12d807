"""Names of things in a scene, as people see them."""

from __future__ import annotations

import unicodedata
from typing import Annotated

from pydantic import AfterValidator

from tautline.scene.refusal import refusal

UNSEEN = ("Cc", "Zl", "Zp")
"""Unicode's categories of control characters, and of ends of lines and paragraphs: they tear tables apart."""


def named(text: str) -> str:
    """A name, as it is; raises PydanticCustomError where there is nothing to be seen in it, or what is no letter."""
    if not text.strip():
        raise refusal("is no name", "give a name such as boom tip")
    if wrong := next((letter for letter in text if unicodedata.category(letter) in UNSEEN), ""):
        cause = f"has a character in it that cannot be seen, U+{ord(wrong):04X}"
        raise refusal(cause, "give a name of letters, digits and blanks in one line, such as boom tip")
    return text


Name = Annotated[str, AfterValidator(named)]
