"""The notebooks of the tutorials run, each from a question to a figure."""

from pathlib import Path

import matplotlib.pyplot as plt
import nbformat
import pytest

ROOT = Path(__file__).parents[2]
QUICK = "lift_in_waves"
"""Stands for all where a kernel of Jupyter is started."""
SHORTER = {
    "friction_from_hook_loads": {"np.arange(1200.0, 2401.0, 200.0)": "np.arange(1200.0, 2401.0, 400.0)"},
    "operability_of_a_lift": {"[8.0, 10.0, 12.0]": "[8.0, 12.0]"},
}
"""What a notebook has, and what stands for it where its checks hold of less: fewer depths, fewer periods."""
NAMES = sorted(path.stem for path in (ROOT / "docs" / "tutorials").glob("*.ipynb"))


@pytest.fixture
def tutorials():
    from benchmarks.pages import tutorials

    return tutorials


def test_there_are_six_notebooks():
    assert len(NAMES) == 6


@pytest.mark.parametrize("name", NAMES)
def test_the_cells_of_a_notebook_run_one_after_another_and_its_own_checks_hold(name, tutorials, monkeypatch, tmp_path):
    """In this process, which has loaded what it needs; some do less here, and all where a kernel runs them."""
    stored = nbformat.read(tutorials.FOLDER / f"{name}.ipynb", as_version=4)
    monkeypatch.chdir(tmp_path)
    shown, space = [], {"__name__": "notebook"}
    monkeypatch.setattr(plt, "show", lambda: shown.extend(plt.get_fignums()) or plt.close("all"))
    cells = [cell.source for cell in stored.cells if cell.cell_type == "code"]
    for long, short in SHORTER.get(name, {}).items():
        assert sum(long in text for text in cells) == 1
        cells = [text.replace(long, short) for text in cells]
    for number, text in enumerate(cells):
        exec(compile(text, f"{name}, cell {number}", "exec"), space)
    assert shown


@pytest.mark.parametrize("name", [pytest.param(n, marks=pytest.mark.study if n != QUICK else ()) for n in NAMES])
def test_a_notebook_runs_in_a_kernel_of_its_own_within_a_minute(name, tutorials):
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
    assert tutorials.figures(stored) >= 1, "python -m benchmarks.pages.tutorials keeps what it shows"


def test_a_cell_that_fails_is_told(tutorials, tmp_path):
    from nbclient.exceptions import CellExecutionError

    broken = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell("assert 1 > 2")])
    nbformat.write(broken, tmp_path / "broken.ipynb")
    with pytest.raises(CellExecutionError, match="AssertionError"):
        tutorials.run(tmp_path / "broken.ipynb")
