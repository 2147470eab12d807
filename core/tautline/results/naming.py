"""What a result is called in headings: by its title, else by its file; and what is said of one that is not whole."""

from __future__ import annotations

from tautline.results.output_path import TWIN
from tautline.results.result import Result
from tautline.whole_file import legible

DONE, IMBALANCE, NO_BALANCE = "done", "imbalance", "no balance"
WORDS = {
    "running": "unfinished: the run goes on, or was killed",
    "interrupted": "stopped early: interrupted",
    IMBALANCE: "the energy of the run does not balance",
    NO_BALANCE: "the energy of the run has no value",
}
"""What is said of some statuses of runs. Any other is the cause of an early stop by itself."""


def stem(result: Result, otherwise: str = "result") -> str:
    """Name of a result's file without its ending; `otherwise` of one that is in no file."""
    return result.path.stem if result.path is not None else otherwise


def title_of(result: Result, otherwise: str = "result") -> str:
    """Title of a result, or the name of its file where it has none, as letters that can be drawn."""
    return str(result.attributes.get("title") or legible(stem(result, otherwise)))


def shortfall(result: Result) -> str:
    """Why a result is not that of a whole run, and where it ends; empty for a whole one.

    A twin goes on until somebody stops it, so that only a failure makes its result less than whole.
    """
    status = str(result.attributes.get("status", DONE))
    if status == DONE or (status in WORDS and result.attributes.get("application") == TWIN):
        return ""
    cause = WORDS.get(status, f"stopped early: {status}")
    return cause if status in (IMBALANCE, NO_BALANCE) else f"{cause}, last frame at {float(result.time[-1]):.6g} s"
