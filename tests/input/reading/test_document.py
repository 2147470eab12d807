"""YAML as scenes use it: the numbers of YAML 1.2, a line for every key, nothing evaluated."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tautline.scene.errors import Problem, SceneError
from tautline.scene.reading.document import Document, join_key, split_key


@pytest.mark.parametrize(
    ("written", "value"),
    [
        ("8.0e7", 8.0e7),
        ("1e-3", 1e-3),
        ("1E3", 1e3),
        (".5", 0.5),
        ("5.", 5.0),
        ("-1", -1),
        ("010", 10),
        ("0o17", 15),
        ("0x1F", 31),
        ("no", "no"),
        ("on", "on"),
        ("Yes", "Yes"),
        ("true", True),
        ("False", False),
        ("null", None),
        ("~", None),
        ("", None),
        ("1_000", "1_000"),
        ("12:30:00", "12:30:00"),
        ("2026-01-01", "2026-01-01"),
        ("'1'", "1"),
        ('"true"', "true"),
        ("nan", "nan"),
        ("3 m", "3 m"),
        ("=", "="),
    ],
)
def test_scalars_are_those_of_yaml_1_2(written, value):
    root = Document.parse(f"a: {written}").root
    assert root["a"] == value
    assert type(root["a"]) is type(value)


def test_every_key_has_its_line():
    document = Document.parse("a: 1\nb:\n  - x: 1\n    y: 2\n  - {x: 3,\n     y: 4}\nc: &c [1,\n 2]\nd: *c\n")
    lines = {"a": 1, "b": 2, "b[0].x": 3, "b[0].y": 4, "b[1].x": 5, "b[1].y": 6, "c[0]": 7, "c[1]": 8, "d": 9}
    assert {key: document.line(key) for key in lines} == lines
    assert document.line("b[1].z") == 5
    assert document.line(("nothing",)) is None
    assert document.root["d"] == [1, 2]


def test_an_alias_repeats_a_value():
    assert Document.parse("a: &pipe {od: 1}\nb: [*pipe, *pipe]").root["b"] == [{"od": 1}, {"od": 1}]


def test_what_was_written_is_kept_as_written():
    assert Document.parse("a: {b: [0.10]}").written("a.b[0]") == "0.10"


def test_a_problem_is_one_line():
    problem = Problem("jwell.yaml", 17, "string[1].od", "0.10", "smaller than id = 0.1086", "swap them")
    assert str(problem) == "jwell.yaml:17: string[1].od = 0.10: smaller than id = 0.1086; swap them"
    assert "\n" not in str(Problem("f", 1, "k\n", "x\n" * 500, "cause"))
    assert len(str(SceneError([problem] * 1000)).splitlines()) == 21


def test_an_alias_bomb_is_refused_at_once():
    # a thousand million values, were they written out
    rows = ["a0: &a0 [x, x]"] + [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 8)}]" for i in range(1, 11)]
    with pytest.raises(SceneError, match=r":8: .*more than 1000000 values once its aliases are written out"):
        Document.parse("\n".join(rows))


def test_a_file_of_too_many_values_without_an_alias_is_not_told_to_remove_one(monkeypatch):
    monkeypatch.setattr("tautline.scene.reading.document.MOST_VALUES", 3)
    with pytest.raises(SceneError, match=r"1: .*holds more than 3 values; keep long tables in a CSV file"):
        Document.parse("{a: 1, b: 2, c: 3, d: 4}")


def test_replacing_a_value_leaves_the_original_alone():
    document = Document.parse("a: {b: [1, 2]}")
    other = document.replaced({("a", "b", 1): (5, "vary"), ("c", "d"): (6, "vary")})
    assert other.root == {"a": {"b": [1, 5]}, "c": {"d": 6}}
    assert document.root == {"a": {"b": [1, 2]}}
    assert other.written("a.b[1]") == "5"


@settings(max_examples=40, deadline=None)
@given(st.lists(st.one_of(st.integers(0, 99), st.from_regex(r"\A[a-z_]{1,6}\Z")), min_size=1, max_size=5))
def test_key_paths_read_back_as_they_are_written(path):
    path = ["root", *path]
    assert split_key(join_key(tuple(path))) == tuple(path)


@settings(max_examples=80, deadline=None)
@given(st.text(alphabet="ab:-[]{}&*!|>'\"#%@`,?\t\n 01.", max_size=40))
def test_any_text_is_a_mapping_or_refused(text):
    try:
        assert isinstance(Document.parse(text).root, dict)
    except SceneError as error:
        assert str(error).startswith("scene.yaml")


SLIPS_OF_YAML = {
    "a dash without a space": (
        "path:\n  - drum: {radius: 1}\n  -sheave: {radius: 1}\n", 3, "'-sheave' is taken for a key", "- sheave:"
    ),
    "a bracket that is not closed on the last line": (
        "title: a\noutput: {interval: 50 ms\n", 2, "the bracket { is not closed", "write }"
    ),
    "a list that is not closed": ("title: a\ngravity: [0, 0\n\n", 2, "the bracket [ is not closed", "write ]"),
}  # fmt: skip


@pytest.mark.parametrize("case", SLIPS_OF_YAML)
def test_a_slip_of_yaml_is_named_on_its_own_line_with_what_to_type(case):
    text, line, cause, cure = SLIPS_OF_YAML[case]
    with pytest.raises(SceneError) as found:
        Document.parse(text)
    (problem,) = found.value.problems
    assert problem.line == line and cause in problem.cause and cure in problem.cure


def test_a_tab_is_not_said_of_the_key_before_it():
    with pytest.raises(SceneError) as found:
        Document.parse("title: a\n\trope: {diameter: 28 mm}\n")
    (problem,) = found.value.problems
    assert (problem.line, problem.key) == (2, "") and "a tab" in problem.cause
