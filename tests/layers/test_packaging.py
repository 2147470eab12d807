"""What packages say of the program agrees: pyproject.toml, the conda recipe, the citation, the workflows."""

import re
import tomllib
from pathlib import Path

import pytest
import yaml

import tautline

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf8"))["project"]
RECIPE = yaml.safe_load((ROOT / "conda" / "recipe.yaml").read_text(encoding="utf8"))
OTHERWISE = {"matplotlib-base": "matplotlib"}
"""Names of conda's packages that differ."""


def requirements(lines):
    found = {}
    for line in lines:
        name, needs = re.fullmatch(r"([\w-]+)\s*(.*)", line).groups()
        found[OTHERWISE.get(name, name)] = needs.replace(" ", "")
    return found


def test_the_conda_recipe_asks_for_what_the_project_does():
    asked = requirements(RECIPE["requirements"]["run"])
    least = RECIPE["context"]["python_min"]
    assert asked.pop("python").replace("${{python_min}}", least) == PROJECT["requires-python"] == f">={least}"
    assert asked == requirements(PROJECT["dependencies"])


def test_the_conda_recipe_has_the_commands_and_the_version_of_the_project():
    points = dict(line.split(" = ") for line in RECIPE["build"]["python"]["entry_points"])
    assert points == PROJECT["scripts"]
    assert RECIPE["context"]["version"] == tautline.__version__


def test_the_citation_is_of_this_version():
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf8"))
    assert citation["version"] == tautline.__version__ and citation["license"] == PROJECT["license"]


def test_the_matrix_runs_every_python_that_the_project_names():
    named = {line.rsplit(" ", 1)[1] for line in PROJECT["classifiers"] if re.search(r"Python :: 3\.\d+$", line)}
    matrix = yaml.safe_load((ROOT / ".github" / "workflows" / "ci.yml").read_text(encoding="utf8"))["jobs"]["matrix"]
    assert set(matrix["strategy"]["matrix"]["python"]) == named


def test_the_changelog_has_the_version_and_what_comes_after():
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf8")
    headings = re.findall(r"^## \[(.*?)\]", text, re.M)
    assert headings[0] == "Unreleased" and headings[1] == tautline.__version__


def test_the_extra_docs_names_what_the_site_is_made_with():
    asked = " ".join(PROJECT["optional-dependencies"]["docs"])
    assert all(name in asked for name in ("mkdocs-material", "mkdocstrings[python]", "nbformat"))


FORMS = sorted(path for path in (ROOT / ".github" / "ISSUE_TEMPLATE").glob("*.yml") if path.name != "config.yml")
ITEM = {"type", "id", "attributes", "validations"}
ATTRIBUTES = {"textarea": {"label", "description", "placeholder", "value", "render"}}
ATTRIBUTES["input"] = ATTRIBUTES["textarea"] - {"render"}
"""What GitHub takes in an item of an issue form; a form with another key is not shown."""


@pytest.mark.parametrize("path", FORMS, ids=lambda path: path.stem)
def test_an_issue_form_has_only_what_github_takes(path):
    form = yaml.safe_load(path.read_text(encoding="utf8"))
    assert set(form) <= {"name", "description", "title", "labels", "assignees", "body"} and form["description"]
    for item in form["body"]:
        assert set(item) <= ITEM and set(item["attributes"]) <= ATTRIBUTES[item["type"]], item
        assert all(isinstance(value, str) for value in item["attributes"].values()), item
    assert len({item["id"] for item in form["body"]}) == len(form["body"])
