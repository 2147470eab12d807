"""Notebooks of the pages on stepping, control, linearisation, co-simulation and sweeps: text and code, cell by cell."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

from benchmarks import ROOT

PAGES = ("stepping", "control", "linearisation", "cosimulation", "sweep")
FIRST = "import os\n\nos.chdir('../..')  # scenes are named from the folder of the project"


def cells_of(text: str) -> list[dict[str, object]]:
    """Cells of a page: Python as code, all else as text."""
    cells = [_cell("code", FIRST)]
    for part in re.split(r"^(```python\n.*?^```)\n", text, flags=re.M | re.S):
        if part.startswith("```python\n"):
            cells.append(_cell("code", part.removeprefix("```python\n").removesuffix("```").rstrip()))
        elif part.strip():
            moved = part.strip().replace("](images/", "](../images/")
            cells.append(_cell("markdown", re.sub(r"\]\((\w+\.md)([)#])", r"](../\1\2", moved)))
    return cells


def _cell(kind: str, text: str) -> dict[str, object]:
    made: dict[str, object] = {"cell_type": kind, "metadata": {}, "source": text.splitlines(keepends=True)}
    return made | ({"execution_count": None, "outputs": []} if kind == "code" else {})


def notebook(name: str) -> str:
    """The notebook of a page, as its file holds it."""
    text = (ROOT / "docs" / f"{name}.md").read_text(encoding="utf8")
    cells = [{"id": f"{name}-{k}", **cell} for k, cell in enumerate(cells_of(text))]
    kernel = {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"}}
    return json.dumps({"cells": cells, "metadata": kernel, "nbformat": 4, "nbformat_minor": 5}, indent=1) + "\n"


def place(name: str) -> Path:
    """Where the notebook of a page lies."""
    return ROOT / "docs" / "notebooks" / f"{name}.ipynb"


def main() -> None:
    """Write all of them."""
    for name in PAGES:
        place(name).parent.mkdir(exist_ok=True)
        place(name).write_text(notebook(name), encoding="utf8")
        print(f"wrote {place(name)}", file=sys.stderr)


if __name__ == "__main__":
    main()
