"""The verb ``render``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from tautline.application.installed import Catalogue
from tautline.application.space import LARGEST, appearance_of, in_units_of, look_of
from tautline.cli.output.console import print_json, say, say_missing
from tautline.cli.output.holes import told_of_holes

if TYPE_CHECKING:
    from tautline.view.space.appearance import Appearance

NO_DISPLAY = (
    "there is no display that a window can be opened on: here is a picture; see also --movie, --html and `export --vtk`"
)


def render(catalogue: Catalogue, path: Path, asked: dict[str, Any], as_json: bool) -> None:
    """Show a result in space: in a window, or as pictures, a film or a web page.

    Parameters
    ----------
    asked : dict
        ``image`` (list of times, ``t=12.5``, ``12.5 s``, ``first`` or ``last``), ``movie``, ``html`` (files),
        ``output`` of pictures, ``view``, ``colour``, ``radius``, ``exaggerate``, ``camera``, ``size``, ``rate``,
        ``speed``; None where not given.

    Raises
    ------
    ResultError
        If something asked for is unknown, a file cannot be written, or there is nothing to draw with.
    """
    from tautline.results.errors import ResultError
    from tautline.results.result import Result
    from tautline.statistics.store import check_whole

    result = Result.read(path)
    if asked["movie"] is not None or asked["html"] is not None:
        check_whole(result, "a film")
    look = in_units_of(result, look_of(asked["view"], asked["exaggerate"]))
    for option in ("radius", "speed"):
        if asked[option] is not None and not asked[option] < LARGEST:
            cure = f"give a number above 0 and below {LARGEST:,.0f}, such as 2"
            raise ResultError(f"--{option}", f"{asked[option]:g} is no factor", cure)
    warnings = say_missing(result)
    with told_of_holes([result]):
        written = _shown(appearance_of(catalogue.for_result(result), result, look), path, asked)
    for file in written:
        say(f"wrote {file}", "green")
    if as_json:
        print_json({"status": "done", "files": [str(file) for file in written], "warnings": warnings})


def _shown(appearance: Appearance, path: Path, asked: dict[str, Any]) -> list[Path]:
    """Write what is asked for, or open a window; returns the files."""
    written: list[Path] = []
    if asked["html"] is not None:
        from tautline.results.output_path import check_page
        from tautline.view.web.page import write_page

        written.append(write_page(appearance, check_page(asked["html"]), asked["colour"], asked["radius"]))
    if asked["movie"] is not None:
        written.append(_film(appearance, asked))
    if asked["image"]:
        written += _pictures(appearance, asked["image"], path, asked)
    if not written:
        from tautline.view.space.graphics import opens_windows

        if opens_windows():
            _window(appearance, asked)
        else:
            written += _pictures(appearance, ["last"], path, asked)
            say(NO_DISPLAY)
    return written


def _stage(appearance: Appearance, asked: dict[str, Any], **more: Any) -> Any:
    from tautline.view.space.stage import Stage

    given: dict[str, Any] = {"size": _size(asked["size"])} | more
    return Stage(appearance, asked["colour"], asked["radius"], asked["camera"] or "", **given)


def _size(text: str | None) -> tuple[int, int]:
    from tautline.results.errors import ResultError
    from tautline.view.space.stage import SIZE

    if text is None:
        return SIZE
    parts = text.lower().replace("×", "x").split("x")
    try:
        width, height = (int(part) for part in parts)
    except ValueError:
        width = height = 0
    if not (100 <= width <= 8192 and 100 <= height <= 8192):
        raise ResultError("--size", f"'{text}' is no size of a picture", "give pixels, such as 1920x1080") from None
    return width, height


def _window(appearance: Appearance, asked: dict[str, Any]) -> None:
    from tautline.view.space.window import KEYS, Window

    say(KEYS)
    Window(_stage(appearance, asked, window=True), asked["speed"] or 1.0).open()


def _film(appearance: Appearance, asked: dict[str, Any]) -> Path:
    from tautline.cli.output.progress import Counter
    from tautline.view.space.film import check_name, cut, film, large

    check_name(asked["movie"])
    made, size = cut(appearance.time, asked["rate"], asked["speed"]), _size(asked["size"])
    stage = _stage(appearance, asked, size=large(size), smooth=False)
    try:
        with Counter("pictures") as counter:
            written = film(stage, asked["movie"], made, counter, size)
    finally:
        stage.close()
    faster = "" if abs(made.speed - 1.0) < 1e-9 else f", {made.speed:.3g} times as fast as life"
    say(f"{len(made.frames)} pictures, {made.rate:.3g} a second{faster}")
    return written


def _pictures(appearance: Appearance, times: list[str], path: Path, asked: dict[str, Any]) -> list[Path]:
    from tautline.view.space.still import frame_of, places, still

    frames = [frame_of(text, appearance.time) for text in times]
    files = places(asked["output"], path, appearance.time, frames)
    stage = _stage(appearance, asked)
    try:
        return [still(stage, frame, file) for frame, file in zip(frames, files, strict=True)]
    finally:
        stage.close()
