"""The verb ``render``."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tautline.application.installed import Catalogue
from tautline.application.space import LARGEST, appearance_of, in_units_of, look_of
from tautline.cli.output.console import print_json, say, say_missing
from tautline.cli.output.holes import told_of_holes

if TYPE_CHECKING:
    from tautline.view.space.appearance import Appearance
    from tautline.view.space.film import Cut

Write = Callable[[], list[Path]]
"""Writes files, and returns them."""
LEAST, MOST = 100, 8192
"""Width and height of a picture, pixels."""
NO_DISPLAY = (
    "there is no display that a window can be opened on: here is a picture; see also --movie, --html and `export --vtk`"
)


@dataclass(frozen=True, kw_only=True)
class RenderOptions:
    """What the command line gave of how a result is shown, as it is written there; None where not given.

    Attributes
    ----------
    output : Path, str or None
        Where the pictures go: a file, or a folder, which is made.
    image : sequence of str or None
        Times of pictures: ``t=12.5``, ``12.5 s``, ``first`` or ``last``.
    movie, html : Path or None
        The film and the web page that are written.
    view, colour, camera, size : str or None
        By name; ``size`` in pixels, such as ``1280x720``.
    radius, exaggerate : float or None
        Times the true thickness, and times the offset across.
    rate, speed : float or None
        Of a film: pictures a second, and simulated over shown time. ``speed`` is a window's too.
    """

    output: Path | str | None
    image: Sequence[str] | None
    movie: Path | None
    html: Path | None
    view: str | None
    colour: str | None
    radius: float | None
    exaggerate: float | None
    camera: str | None
    size: str | None
    rate: float | None
    speed: float | None


def render(catalogue: Catalogue, path: Path, asked: RenderOptions, as_json: bool) -> None:
    """Show a result in space: in a window, or as pictures, a film or a web page.

    Raises
    ------
    ResultError
        If something asked for is unknown, a file cannot be written, or there is nothing to draw with.
    """
    from tautline.results.errors import ResultError
    from tautline.results.result import Result
    from tautline.statistics.store import check_whole

    _check_heeded(asked)
    result = Result.read(path)
    if asked.movie is not None or asked.html is not None:
        check_whole(result, "a film")
    look = in_units_of(result, look_of(asked.view, asked.exaggerate))
    for option, factor in (("--radius", asked.radius), ("--speed", asked.speed)):
        if factor is not None and not factor < LARGEST:
            cure = f"give a number above 0 and below {LARGEST:,.0f}, such as 2"
            raise ResultError(option, f"{factor:g} is no factor", cure)
    warnings = say_missing(result)
    with told_of_holes([result]):
        written = _shown(appearance_of(catalogue.for_result(result), result, look), path, asked)
    for file in written:
        say(f"wrote {file}", "green")
    if as_json:
        print_json({"status": "done", "files": [str(file) for file in written], "warnings": warnings})


def _check_heeded(asked: RenderOptions) -> None:
    """Refuse options that nothing asked for heeds: whoever gives one expects something of it."""
    from tautline.results.errors import ResultError

    # Where nothing is named there is a window, or a picture where no window can be opened: which one is known later.
    neither = not (asked.image or asked.movie or asked.html)
    drawn = bool(asked.image or asked.movie) or neither
    for option, given, heeded, cause, cure in (
        ("--rate", asked.rate, asked.movie, "is of a film", "--movie"),
        ("--speed", asked.speed, asked.movie or neither, "is of a film or a window", "--movie"),
        ("--size", asked.size, drawn, "is of pictures and films", "--image or --movie"),
        ("--camera", asked.camera, drawn, "is of pictures and films", "--image or --movie"),
        ("-o", asked.output, asked.image or neither, "is the place of pictures", "--image"),
    ):
        if given is not None and not heeded:
            raise ResultError(option, f"{cause}, and none is asked for", f"add {cure}, or leave it out")


def _shown(appearance: Appearance, path: Path, asked: RenderOptions) -> list[Path]:
    """Write what is asked for, or open a window; returns the files.

    All of it is looked at before the first file is written.
    """
    from tautline.results.errors import naming_written

    ready = [
        prepared(appearance, path, asked)
        for prepared, wanted in ((_page, asked.html), (_film, asked.movie), (_pictures, asked.image))
        if wanted
    ]
    if ready:
        written: list[Path] = []
        with naming_written("files", written):
            for write in ready:
                written += write()
        return written
    from tautline.view.space.graphics import opens_windows

    if opens_windows():
        _window(appearance, asked)
        return []
    written = _pictures(appearance, path, asked)()
    say(NO_DISPLAY)
    return written


def _page(appearance: Appearance, path: Path, asked: RenderOptions) -> Write:
    """What writes the page, when it is known that it can be."""
    from tautline.results.output_path import check_page
    from tautline.view.space.colours import shading
    from tautline.view.web.page import write_page

    assert asked.html is not None
    file = check_page(asked.html)
    shading(appearance, asked.colour)
    return lambda: [write_page(appearance, file, asked.colour, asked.radius)]


def _check_drawn_with(appearance: Appearance, asked: RenderOptions) -> None:
    """Refuse what a stage would refuse, without one: there is to be nothing written by then."""
    from tautline.view.space.camera import aim
    from tautline.view.space.colours import shading
    from tautline.view.space.graphics import graphics

    _size(asked.size)
    shading(appearance, asked.colour)
    if follows := aim(asked.camera or "", appearance.eye).follows:
        appearance.place_of(follows)
    graphics()


def _stage(appearance: Appearance, asked: RenderOptions, **more: Any) -> Any:
    from tautline.view.space.stage import Stage

    given: dict[str, Any] = {"size": _size(asked.size)} | more
    return Stage(appearance, asked.colour, asked.radius, asked.camera or "", **given)


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
    if not all(LEAST <= side <= MOST for side in (width, height)):
        cure = f"give width and height from {LEAST} to {MOST} pixels, such as 1920x1080"
        raise ResultError("--size", f"'{text}' is no size of a picture", cure) from None
    return width, height


def _window(appearance: Appearance, asked: RenderOptions) -> None:
    from tautline.view.space.window import KEYS, Window

    say(KEYS)
    Window(_stage(appearance, asked, window=True), asked.speed or 1.0).open()


def _film(appearance: Appearance, path: Path, asked: RenderOptions) -> Write:
    """What writes the film, when it is known that it can be."""
    from tautline.cli.output.progress import Counter
    from tautline.view.space.film import check_name, cut, film, large, writer

    file = asked.movie
    assert file is not None
    check_name(file)
    writer(file)
    made, size = cut(appearance.time, asked.rate, asked.speed), _size(asked.size)
    _check_drawn_with(appearance, asked)

    def write() -> list[Path]:
        stage = _stage(appearance, asked, size=large(size), smooth=False)
        try:
            with Counter("pictures") as counter:
                written = film(stage, file, made, counter, size)
        finally:
            stage.close()
        say(_film_said(made))
        return [written]

    return write


def _film_said(made: Cut) -> str:
    """How many pictures a film has, and how fast it shows them."""
    if len(made.frames) == 1:
        return "one picture"
    faster = "" if abs(made.speed - 1.0) < 1e-9 else f", {made.speed:.3g} times as fast as life"
    return f"{len(made.frames)} pictures, {made.rate:.3g} a second{faster}"


def _pictures(appearance: Appearance, path: Path, asked: RenderOptions) -> Write:
    """What writes the pictures, when it is known that they can be; that of the last frame where no time was given."""
    from tautline.results.errors import naming_written
    from tautline.results.output_path import made_for
    from tautline.view.space.still import check_format, frame_of, places, still

    frames = [frame_of(text, appearance.time) for text in asked.image or ("last",)]
    files = places(asked.output, path, appearance.time, frames)
    for file in files:
        check_format(file)
    _check_drawn_with(appearance, asked)

    def write() -> list[Path]:
        with made_for(files[0].parent):
            stage, written = _stage(appearance, asked), list[Path]()
            try:
                with naming_written("files", written):
                    for frame, file in zip(frames, files, strict=True):
                        written.append(still(stage, frame, file))
            finally:
                stage.close()
        return written

    return write
