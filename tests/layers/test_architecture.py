"""The page of the architecture shows the imports as they are."""

from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def imports():
    """What the files import, read once."""
    from benchmarks.pages import architecture

    return architecture.panels()


@pytest.fixture
def architecture(imports, monkeypatch):
    from benchmarks.pages import architecture

    monkeypatch.setattr(architecture, "panels", lambda: imports)
    return architecture


def test_the_picture_and_the_table_of_the_architecture_are_those_of_the_imports(architecture):
    assert architecture.differences() == []


def test_a_folder_that_the_picture_does_not_show_and_one_that_is_gone_are_both_reported(
    architecture, monkeypatch, tmp_path
):
    text = architecture.PICTURE.read_text(encoding="utf8")
    picture = tmp_path / "architecture.svg"
    picture.write_text(text.replace("drillstring.well", "drillstring.hole"), encoding="utf8")
    monkeypatch.setattr(architecture, "PICTURE", picture)
    found = "\n".join(architecture.differences())
    assert "shows drillstring.hole, which is not so" in found
    assert "does not show drillstring.well" in found


def test_the_picture_is_the_same_each_time_it_is_drawn(architecture, monkeypatch, tmp_path):
    page = tmp_path / "architecture.md"
    page.write_bytes(architecture.PAGE.read_bytes())
    monkeypatch.setattr(architecture, "PAGE", page)
    drawn = []
    for name in ("once.svg", "twice.svg"):
        monkeypatch.setattr(architecture, "PICTURE", tmp_path / name)
        architecture.write()
        drawn.append((tmp_path / name).read_bytes())
    assert drawn[0] == drawn[1]


def test_an_import_that_others_imply_is_not_drawn(architecture):
    edges = {"a": {"b", "c"}, "b": {"c"}, "c": set()}
    assert architecture.reduced(edges) == {"a": {"b"}, "b": {"c"}, "c": set()}


def test_rooms_that_import_each_other_in_a_circle_are_refused(architecture):
    with pytest.raises(SystemExit, match="imports itself by way of others"):
        architecture.reduced({"a": {"b"}, "b": {"c"}, "c": {"a"}})
