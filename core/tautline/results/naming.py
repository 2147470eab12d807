"""What a result is called in headings: by its title, else by its file."""

from __future__ import annotations

from tautline.results.result import Result


def stem(result: Result, otherwise: str = "result") -> str:
    """Name of a result's file without its ending; `otherwise` of one that is in no file."""
    return result.path.stem if result.path is not None else otherwise


def title_of(result: Result, otherwise: str = "result") -> str:
    """Title of a result, or the name of its file where it has none."""
    return str(result.attributes.get("title") or stem(result, otherwise))
