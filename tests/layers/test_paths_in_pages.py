"""Paths that pages name are those of files and folders, from the folder of the repository; claims name tests."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
NAMED = re.compile(r"`(?P<path>[\w./*-]+)`(?:\]\((?P<link>[^)#\s]+))?")
"""A word of code that may be a path, with the link that it is the text of."""
PACKAGES = {"tautline", "drillstring", "crane", "gardenhose"} | {
    folder.name
    for parent in ("core/tautline", *(f"apps/{name}" for name in ("drillstring", "crane", "gardenhose")))
    for folder in (ROOT / parent).iterdir()
    if (folder / "__init__.py").is_file()
}
"""Names with which a path begins that does not begin at the folder of the repository."""
CLAIMS = ROOT / "docs" / "claims.md"
CLAIM = "| claim | reference | tolerance | test |"


def exists(path):
    return any(ROOT.glob(path.rstrip("/"))) if "*" in path else (ROOT / path).exists()


def missing(page):
    """Paths of a page that name nothing, with their lines."""
    for number, line in enumerate(page.read_text(encoding="utf8").splitlines(), 1):
        for named in NAMED.finditer(line):
            path, link = named["path"], named["link"]
            if not (path.endswith(".py") or ("/" in path and path.split("/")[0] in PACKAGES)):
                continue
            # The text of a link may be short: its target says where the file is.
            if not ((page.parent / link).exists() if link and path.endswith(".py") else exists(path)):
                yield f"{page.relative_to(ROOT)}:{number} {path}"


def claims():
    """Lines of claims.md that say what a test claims: number and cells."""
    inside = False
    for number, line in enumerate(CLAIMS.read_text(encoding="utf8").splitlines(), 1):
        inside = line == CLAIM or (inside and line.startswith("|"))
        if inside and line != CLAIM and not line.startswith("|---"):
            yield number, [cell.strip() for cell in line.strip("|").split(" | ")]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_every_path_that_a_page_names_is_there_from_the_folder_of_the_repository(page):
    assert list(missing(page)) == []


def test_a_path_that_is_gone_and_one_from_another_folder_are_both_found(tmp_path, monkeypatch):
    page = tmp_path / "page.md"
    page.write_text("`core/tautline/gone.py`, `kernels/lanes`, `tests/layers/test_*.py`, [`a.py`](page.md), `m/s`\n")
    monkeypatch.setattr(f"{__name__}.ROOT", tmp_path)
    (tmp_path / "tests" / "layers").mkdir(parents=True)
    (tmp_path / "tests" / "layers" / "test_one.py").touch()
    assert list(missing(page)) == ["page.md:1 core/tautline/gone.py", "page.md:1 kernels/lanes"]


def test_every_claim_names_a_file_of_tests_that_is_there_or_that_of_the_row_above():
    rows = list(claims())
    assert len(rows) > 100
    faults = []
    for number, cells in rows:
        named = [path for path in re.findall(r"`(tests/[^`]+)`", cells[-1]) if exists(path)]
        if len(cells) != 4 or not (named or cells[-1].startswith("the same")):
            faults.append(f"claims.md:{number} {cells[-1]}")
    assert faults == []
