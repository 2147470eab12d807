"""Syntax trees of our own files, for tests that read them: each is made once."""

import ast
from functools import cache


@cache
def tree_of(path):
    """The syntax tree of a file; nobody changes it."""
    return ast.parse(path.read_text(encoding="utf8"))
