"""The notebooks of the tutorials run: each goes from a question to a figure in less than a minute."""

from pathlib import Path

import nbformat
import pytest

ROOT = Path(__file__).parents[2]
NAMES = sorted(path.stem for path in (ROOT / "docs" / "tutorials").glob("*.ipynb"))


@pytest.fixture
def tutorials(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    import tutorials

    return tutorials


def test_there_are_six():
    assert len(NAMES) == 6


@pytest.mark.parametrize("name", NAMES)
def test_a_notebook_runs_and_its_own_checks_hold(name, tutorials):
    notebook, seconds = tutorials.run(tutorials.FOLDER / f"{name}.ipynb")
    assert tutorials.figures(notebook) >= 1
    # The first to come in an empty cache compiles the kernels besides.
    assert seconds < tutorials.LONGEST + 60.0


@pytest.mark.parametrize("name", NAMES)
def test_a_notebook_asks_answers_checks_and_shows(name, tutorials):
    stored = nbformat.read(tutorials.FOLDER / f"{name}.ipynb", as_version=4)
    nbformat.validate(stored)
    text = "\n".join(cell.source for cell in stored.cells)
    assert "**Question.**" in text and "assert " in text
    assert any(word in text for word in ("**Answer", "**Check"))
    assert tutorials.figures(stored) >= 1, "python benchmarks/tutorials.py keeps what it shows"


def test_a_cell_that_fails_is_told(tutorials, tmp_path):
    from nbclient.exceptions import CellExecutionError

    broken = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell("assert 1 > 2")])
    nbformat.write(broken, tmp_path / "broken.ipynb")
    with pytest.raises(CellExecutionError, match="AssertionError"):
        tutorials.run(tmp_path / "broken.ipynb")
