"""docs/validation.md names the script that writes it, and shows every image that belongs to it; no number is tested."""

import re
from importlib.util import find_spec
from pathlib import Path

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
SCRIPT = "benchmarks.thesis.validation"


def page():
    return (DOCS / "validation.md").read_text(encoding="utf8")


def linked():
    """Images that the page shows, relative to docs/."""
    return set(re.findall(r"!\[[^\]]*\]\(([^)]+)\)", page()))


def test_the_page_begins_with_the_script_that_writes_it():
    title, words = [line for line in page().splitlines() if line][:2]
    assert title.startswith("# ")
    assert words.startswith(f"Written by `python -m {SCRIPT}`")
    assert find_spec(SCRIPT) is not None


def test_every_image_of_the_page_exists():
    assert linked()
    assert [name for name in sorted(linked()) if not (DOCS / name).is_file()] == []


def test_every_image_of_the_thesis_is_on_the_page():
    kept = {path.relative_to(DOCS).as_posix() for path in (DOCS / "images" / "thesis").iterdir()}
    assert sorted(kept - linked()) == []
