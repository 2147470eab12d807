"""Single pictures of a stage."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import numpy as np

from tautline.results.errors import ResultError, unwritten
from tautline.results.output_path import check_drawn, check_folder, check_made, names_folder
from tautline.results.variable import outside
from tautline.view.space.stage import Stage

FORMATS = ("png", "jpg")
OTHERS = {"html": "html", "htm": "html", "mp4": "movie", "gif": "movie"}
"""Endings of what is no picture, and the option that writes it."""


def frame_of(asked: str, time: np.ndarray) -> int:
    """Frame that is asked for.

    Parameters
    ----------
    asked : str
        ``t=12.5``, ``12.5``, ``2 min``, ``first`` or ``last``.
    time : (frames,) array
        s.

    Returns
    -------
    int
        The nearest frame.

    Raises
    ------
    ResultError
        If it is no time, or outside of the run.
    """
    word = asked.strip().lower()
    if word in ("first", "last"):
        return 0 if word == "first" else len(time) - 1
    number = _seconds(word.removeprefix("t").lstrip().removeprefix("=").strip())
    cure = f"give a time from {time[0]:g} to {time[-1]:g} s, such as t={0.5 * (time[0] + time[-1]):.3g}, first or last"
    if number is None or not np.isfinite(number):
        raise ResultError("--image", f"'{asked}' is no time", cure)
    if outside(number, time):
        raise ResultError("--image", f"t = {number:g} s is outside of the run", cure)
    return int(np.abs(time - number).argmin())


def _seconds(text: str) -> float | None:
    """A time with a unit, or in s; None if it is none."""
    from pydantic import TypeAdapter, ValidationError

    from tautline.scene.values.quantity import quantity

    try:
        return float(text)
    except ValueError:
        pass
    adapter: Any = TypeAdapter(Annotated[float, quantity("s")])
    try:
        return float(adapter.validate_python(text))
    except ValidationError:
        return None


def places(output: Path | str | None, result: Path, time: np.ndarray, frames: list[int]) -> list[Path]:
    """Files of pictures: as asked, and by their times where there are several.

    As of figures, what has no ending, or ends in a slash, is a folder. It may have to be made before they are written.
    """
    folder = output is not None and (names_folder(output) or not Path(output).suffix)
    path = Path(output or f"{result.stem}.png")
    if folder:
        check_made(path)
        path /= f"{result.stem}.png"
    else:
        check_folder(path)
    if len(frames) == 1 and output is not None and not folder:
        return [check_drawn(path)]
    return [check_drawn(path.with_name(f"{path.stem}_{time[frame]:g}s{path.suffix}")) for frame in frames]


def check_format(path: Path) -> None:
    """Raise ResultError for a name whose ending is of no picture that can be written."""
    ending = path.suffix[1:].lower()
    if ending not in (*FORMATS, "jpeg"):
        other = OTHERS.get(ending)
        instead = f", or give --{other} {path} in place of -o {path}" if other else ""
        cure = f"use {' or '.join(FORMATS)}{instead}"
        raise ResultError(path, f"is no picture that can be written: '{ending}'", cure)


def still(stage: Stage, frame: int, path: Path) -> Path:
    """Write a frame as a picture.

    Raises
    ------
    ResultError
        If the format is unknown, or the file cannot be written.
    """
    from PIL import Image

    check_format(path)
    stage.show(frame)
    try:
        Image.fromarray(stage.picture()).save(path)
    except OSError as error:
        raise unwritten(path, error) from None
    return path
