"""What figures of one result and of several have in common: names, headings, the time axis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Any

import numpy as np

from tautline.results.errors import ResultError
from tautline.results.naming import shortfall, stem, title_of
from tautline.results.result import Result
from tautline.view.figures.figure import Axes, Figure, label, shortened

MOST_LISTED = 12
"""Words that a refusal lists before it counts the rest."""


class NothingToShow(ResultError):
    """A result lacks what a figure shows."""

    def __init__(self, result: Result, what: str, cure: str = "draw another figure: see plot --help") -> None:
        super().__init__(result.path or "result", f"has {what}", cure)


def one_kind(results: Sequence[Result]) -> None:
    """Raise ResultError if results are of several applications, which have nothing to compare."""
    kinds = [str(result.attributes.get("application", "")) for result in results]
    for result, kind in zip(results, kinds, strict=True):
        if kind and kinds[0] and kind != kinds[0]:
            cause = f"is a result of {kind}, and {results[0].path or 'the first'} one of {kinds[0]}"
            raise ResultError(result.path or "result", cause, "plot results of one application together")


def nearest(word: str, known: Sequence[str]) -> str:
    """``did you mean 'tension'? ``, or nothing if no known word is near."""
    close = get_close_matches(word, known, 1, 0.6) or [one for one in known if word and word in one]
    return f"did you mean '{close[0]}'? " if close else ""


def listed(words: Sequence[str] | Mapping[str, Any]) -> str:
    """Words between commas, the first of many."""
    words = list(words)
    more = f" and {len(words) - MOST_LISTED} more" if len(words) > MOST_LISTED else ""
    return ", ".join(words[:MOST_LISTED]) + more


def names(results: Sequence[Result]) -> list[str]:
    """Names for a legend: the titles if they tell the results apart, else files, folders and files, or numbers too."""
    stems = [stem(result) for result in results]
    titles = [str(result.attributes.get("title") or "") for result in results]
    folders = [result.path.absolute().parent.name if result.path else "" for result in results]
    placed = [f"{folder}/{one}" for folder, one in zip(folders, stems, strict=True)]
    numbered = [f"{number + 1}: {one}" for number, one in enumerate(stems)]
    for chosen in (titles, stems, placed, numbered):
        short = [shortened(name) for name in chosen]
        if all(short) and len(set(short)) == len(short):
            return short
    return numbered


def title(results: Sequence[Result], what: str = "") -> str:
    """Heading of a figure: the result's title, what is shown of it, and a line that says what of a run is missing."""
    head = title_of(results[0]) if len(results) == 1 else "Comparison of results"
    missing = [shortfall(result) for result in results]
    if len(results) > 1:
        missing = [f"{name} {why}" for name, why in zip(names(results), missing, strict=True) if why]
    return "\n".join([f"{head}: {what}" if what else head, *filter(None, ["; ".join(missing)])])


def title_of_runs(runs: Sequence[Any]) -> str:
    """The same of what is read of each result, which stands under `result`."""
    return title([run.result for run in runs])


def marker(time: np.ndarray) -> dict[str, Any]:
    """A run of one frame is a dot: a line through one point would be invisible."""
    return {"marker": "o"} if len(time) == 1 else {}


def over_time(figure: Figure, plots: np.ndarray, times: Sequence[np.ndarray]) -> Figure:
    """Finish panels that share their time axis: label it, and show all of it.

    Parameters
    ----------
    plots : (rows, 1) array of Axes
    times : sequence of (frames,) array
        Of each result, s.
    """
    last: Axes = plots[-1, 0]
    last.set_xlabel(label("time", "s"))
    first, end = min(time[0] for time in times), max(time[-1] for time in times)
    if end > first:
        last.set_xlim(first, end)
    figure.align_ylabels(plots[:, 0])
    return figure
