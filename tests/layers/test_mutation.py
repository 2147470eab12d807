"""The mutations of kernels can be made: each names a text that its kernel has, and tests that there are."""

import ast
from collections import Counter
from pathlib import Path

import pytest

from benchmarks.pages import mutation

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("mutant", mutation.MUTANTS, ids=lambda mutant: f"{mutant.file}:{mutant.function}")
def test_a_mutation_changes_its_kernel_and_nothing_else(mutant):
    text = (ROOT / mutant.file).read_text(encoding="utf8")
    before, after = (
        {node.name: ast.dump(node) for node in ast.parse(one).body if isinstance(node, ast.FunctionDef)}
        for one in (text, mutation.mutated(text, mutant))
    )
    assert [name for name in before if before[name] != after[name]] == [mutant.function]
    assert mutant.tests and all((ROOT / "tests" / test.partition("::")[0]).exists() for test in mutant.tests)


def test_a_mutation_whose_text_has_changed_is_refused():
    mutant = mutation.MUTANTS[0]
    with pytest.raises(ValueError, match=f"{mutant.function} has .* 0 times"):
        mutation.mutated((ROOT / mutant.file).read_text(encoding="utf8"), mutant._replace(was="no such text"))


def test_at_least_twenty_kernels_are_changed():
    places = Counter((mutant.file, mutant.function) for mutant in mutation.MUTANTS)
    assert len(places) >= 20 and max(places.values()) == 1


def test_the_page_says_of_each_mutation_which_test_fails_and_at_most_one_is_survived():
    page = (ROOT / "docs" / "claims.md").read_text(encoding="utf8")
    begin, end = mutation.MARKS
    rows = [line for line in page.partition(begin)[2].partition(end)[0].splitlines() if line.startswith("| `")]
    assert len(rows) == len(mutation.MUTANTS)
    assert sum("**survived**" in row for row in rows) <= 1
    for row, mutant in zip(rows, mutation.MUTANTS, strict=True):
        assert f"`{mutant.function}` | {mutant.what} |" in row
