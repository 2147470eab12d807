"""Run the notebooks of docs/tutorials and keep what they show: `python -m benchmarks.pages.tutorials [NAME...]`."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from benchmarks import ROOT

FOLDER = ROOT / "docs" / "tutorials"
LONGEST = 60.0
"""Processor time, s, that one may take, once its kernels are compiled."""
INLINE = "module://matplotlib_inline.backend_inline"
"""What lets a notebook show its figures."""


def run(path: Path) -> tuple[Any, float]:
    """The notebook with what its cells show, and the processor time that it took, s.

    Raises
    ------
    nbclient.exceptions.CellExecutionError
        Where a cell fails, with the cell and its traceback.
    """
    import nbformat
    from nbclient import NotebookClient

    notebook = nbformat.read(path, as_version=4)
    begun = _spent()
    with TemporaryDirectory() as folder:
        client = NotebookClient(notebook, kernel_name="python3", timeout=600, record_timing=False)
        # Where figures are drawn without a window, as in CI, a notebook still shows its own.
        client.execute(cwd=folder, env={**os.environ, "MPLBACKEND": INLINE})
    return _plain(notebook), _spent() - begun


def _spent() -> float:
    """Processor time of all children that have ended, s."""
    now = os.times()
    return now.children_user + now.children_system


def figures(notebook: Any) -> int:
    """Number of pictures that its cells show."""
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    return sum("image/png" in output.get("data", {}) for output in outputs)


def _plain(notebook: Any) -> Any:
    """Without what differs from machine to machine."""
    notebook.metadata.pop("language_info", None)
    for cell in notebook.cells:
        cell.metadata.clear()
        if cell.cell_type == "code":
            cell.execution_count = None
            for output in cell.outputs:
                output.pop("execution_count", None)
                if "image/png" in output.get("data", {}):
                    output["data"].pop("text/plain", None)
            # Python's own warnings, of this machine's versions, are not what a reader wants to see.
            cell.outputs = [output for output in cell.outputs if output.get("name") != "stderr"]
    return notebook


def main() -> None:
    import nbformat

    for path in [FOLDER / f"{name}.ipynb" for name in sys.argv[1:]] or sorted(FOLDER.glob("*.ipynb")):
        notebook, seconds = run(path)
        nbformat.write(notebook, path)
        print(f"{path.stem}: {figures(notebook)} figures, {seconds:.0f} s", file=sys.stderr)


if __name__ == "__main__":
    main()
