"""Files of what a verb finds in one scene: where they go, and that people are told of them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tautline.cli.output.console import say

if TYPE_CHECKING:
    from tautline.view.figures.figure import Figure


def figure_place(output: Path | None, name: str) -> Path:
    """Where the figure goes: the place that is asked for, else a png file of a name; refused before anything is sought.

    Raises
    ------
    ResultError
        If no figure can be written there.
    """
    from tautline.results.output_path import check_figure

    return check_figure(output or Path(f"{name}.png"))


def write_figure(figure: Figure, path: Path) -> None:
    """Save a figure and say so."""
    from tautline.view.figures.figure import save

    say(f"wrote {save(figure, path)}", "green")


def write_table(heads: Sequence[str], rows: Iterable[Sequence[Any]], path: Path) -> None:
    """Write the table that ``--csv`` asks for and say so.

    Raises
    ------
    WriteError
        If it cannot be written: what was found has been told by then.
    """
    from tautline.results.errors import WriteError
    from tautline.results.tables.rows import write_rows

    say(f"wrote {write_rows(heads, rows, path, 'name another with --csv', WriteError)}", "green")


def say_sentences(sentences: Iterable[tuple[str, str]]) -> None:
    """Say sentences, each in its style."""
    for text, style in sentences:
        say(text, style)
