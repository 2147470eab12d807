"""Each test says in its name what it claims."""

import ast
from functools import cache
from pathlib import Path

TESTS = Path(__file__).parents[1]
MERE = {"basic", "basics", "simple", "misc", "smoke", "stuff", "various"}


@cache
def functions():
    """File and node of every test."""
    return list(_functions())


def _functions():
    for path in sorted(TESTS.rglob("test_*.py")):
        text = path.read_text(encoding="utf8")
        # Pytest finds functions of a file and methods of its classes; bodies are not visited, which would take long.
        for node in _defined(ast.parse(text)):
            if node.name.startswith("test_"):
                yield path.relative_to(TESTS), node


def _defined(place):
    """Functions of a file or of a class in it, below conditions as well."""
    for node in ast.iter_child_nodes(place):
        if isinstance(node, ast.FunctionDef):
            yield node
        elif isinstance(node, (ast.stmt, ast.excepthandler)):
            yield from _defined(node)


def test_the_name_of_each_test_is_a_sentence_of_three_words_or_more():
    mere = []
    for file, node in functions():
        words = node.name.split("_")[1:]
        if len(words) < 3 or MERE & set(words) or any(word.isdecimal() for word in words[-1:] if len(words) < 5):
            mere.append(f"{file}:{node.lineno} {node.name}")
    assert mere == []


def test_no_two_tests_of_a_file_have_one_name():
    """The later one would take the place of the other, which would never run."""
    seen, twice = set(), []
    for file, node in functions():
        if (file, node.name) in seen:
            twice.append(f"{file}:{node.lineno} {node.name}")
        seen.add((file, node.name))
    assert twice == []
