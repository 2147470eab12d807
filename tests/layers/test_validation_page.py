"""docs/validation.md names the script that writes it and shows every image that belongs to it; no number is tested.

docs/validation_index.md names every script that writes into docs/ and is not one of `benchmarks.pages.everything`.
"""

import re
from importlib.util import find_spec
from pathlib import Path

from benchmarks.pages import everything

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


def test_every_script_that_writes_a_page_is_one_of_everything_or_named_in_the_index_of_validation():
    index = (DOCS / "validation_index.md").read_text(encoding="utf8")
    texts = {
        ".".join(path.relative_to(ROOT / "benchmarks").with_suffix("").parts): path.read_text(encoding="utf8")
        for path in (ROOT / "benchmarks").rglob("*.py")
    }
    writers = {name for name, text in texts.items() if re.search(r"(PAGE|place\(name\))\.write_text", text)}
    assert "thesis.validation" in writers
    run = set(everything.SCRIPTS)
    # The report takes the sections of modules that can write them alone, too.
    run |= {name for name in writers if re.search(rf"import .*\b{name.split('.')[-1]}\b", texts["speed.report"])}
    assert [name for name in sorted(writers - run) if f"`python -m benchmarks.{name}`" not in index] == []
    assert [name for name in everything.SCRIPTS if name not in texts] == []
