"""Films of a stage: frames piped into ffmpeg as they are rendered, so that memory holds one of them."""

from __future__ import annotations

import contextlib
import re
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tautline.results.errors import FULL, ResultError, WriteError, unwritten
from tautline.results.output_path import check_drawn, check_folder
from tautline.view.space.stage import Stage
from tautline.whole_file import whole_file

FORMATS = ("mp4", "gif")
RATE = 25.0
"""Pictures a second, at most, unless another rate is asked for."""
LONGEST = 30.0
"""Seconds that a film lasts, at most, unless a speed is asked for."""
MANY = 100.0
"""Pictures a second that players still show."""

WRITERS = {
    "mp4": ("-c:v", "libx264", "-preset", "veryfast", "-crf", "18", "-pix_fmt", "yuv420p", "-movflags", "+faststart"),
    "gif": (),
}
PALETTE = "split[a][b];[a]palettegen=stats_mode=diff[p];[b][p]paletteuse=dither=bayer:bayer_scale=4"
LARGER = 1.5
"""Size of a rendered picture over that in the film."""


class Cut(NamedTuple):
    """Which frames a film shows, how many pictures a second, and how much faster than life.

    `frames` is an array of numbers of frames.
    """

    frames: np.ndarray
    rate: float
    speed: float


def cut(time: np.ndarray, rate: float | None = None, speed: float | None = None) -> Cut:
    """Choose the frames of a film.

    Parameters
    ----------
    time : (frames,) array
        s.
    rate : float or None
        Pictures a second; None for as many as there are frames, up to `RATE`.
    speed : float or None
        Simulated over shown time; None for life's, or faster where the film would last longer than `LONGEST`.

    Returns
    -------
    Cut
        No frame is shown twice: where frames are stored farther apart than pictures, the rate is lower than asked for.
    """
    span = float(time[-1] - time[0])
    if len(time) == 1 or span <= 0.0:
        return Cut(np.zeros(1, dtype=int), rate or RATE, speed or 1.0)
    speed = speed or max(1.0, span / LONGEST)
    shown = span / speed
    stored = (len(time) - 1) / shown
    rate = min(rate or RATE, MANY, stored)
    pictures = max(2, round(shown * rate) + 1)
    wanted = np.linspace(time[0], time[-1], pictures)
    after = np.clip(np.searchsorted(time, wanted), 1, len(time) - 1)
    nearest = np.where(wanted - time[after - 1] < time[after] - wanted, after - 1, after)
    frames = np.unique(nearest)
    return Cut(frames, max((len(frames) - 1) / shown, 1e-3), speed)


def large(size: tuple[int, int]) -> tuple[int, int]:
    """Size that pictures of a film are rendered in, pixels: ffmpeg makes them smaller, and with that smooth.

    Drawn by software, several samples a pixel take three times as long as this.
    """
    return round(LARGER * size[0]), round(LARGER * size[1])


def film(
    stage: Stage,
    path: Path,
    made: Cut,
    progress: Callable[[int, int], None] | None = None,
    size: tuple[int, int] | None = None,
) -> Path:
    """Write a film; an earlier one of the name is replaced when the new one is whole.

    Parameters
    ----------
    stage : Stage
    path : Path
        Its ending says the format.
    made : Cut
    progress : callable, optional
        Called with the number of pictures that are done, and of all.
    size : tuple of int, optional
        Of the film, pixels; by default the stage's.

    Raises
    ------
    ResultError
        If the format is unknown, ffmpeg is missing, or the file cannot be written; WriteError where the disk is full.
    """
    ending = check_name(path)
    width, height = stage.plotter.window_size
    try:
        with (
            whole_file(path) as part,
            _ffmpeg(path, part, ending, (width, height), size or (width, height), made.rate) as pipe,
        ):
            for number, frame in enumerate(made.frames):
                stage.show(int(frame))
                pipe.write(stage.picture())
                if progress is not None:
                    progress(number + 1, len(made.frames))
    except OSError as error:
        raise unwritten(path, error) from None
    return path


def check_name(path: Path) -> str:
    """Ending of a film's name; raises ResultError if none can be written there."""
    ending = path.suffix[1:].lower()
    if ending not in FORMATS:
        raise ResultError(path, f"is no film that can be written: '{ending}'", f"use .{' or .'.join(FORMATS)}")
    check_folder(path, "--movie")
    check_drawn(path, "--movie")
    return ending


def writer(path: Path) -> str:
    """The ffmpeg that is to write a film; raises ResultError where there is none."""
    try:
        from imageio_ffmpeg import get_ffmpeg_exe

        return str(get_ffmpeg_exe())
    except (ImportError, RuntimeError) as error:
        raise ResultError(path, f"cannot be written: no ffmpeg ({error})", "`pip install imageio-ffmpeg`") from None


@contextlib.contextmanager
def _ffmpeg(path: Path, part: Path, ending: str, given: tuple[int, int], size: tuple[int, int], rate: float) -> Any:
    """A pipe that takes raw pictures for a film, which is written as `part`; messages name `path`."""
    program = writer(path)
    # libx264 wants an even number of pixels each way.
    width, height = size if ending == "gif" else (size[0] // 2 * 2, size[1] // 2 * 2)
    filters = [f"scale={width}:{height}:flags=bilinear"] if (width, height) != given else []
    filters += [PALETTE] if ending == "gif" else []
    command = [
        program, "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{given[0]}x{given[1]}",
        "-r", f"{rate:.6g}", "-i", "-", "-an", *(["-vf", ",".join(filters)] if filters else []), *WRITERS[ending],
        str(part),
    ]  # fmt: skip
    run = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE)
    assert run.stdin is not None and run.stderr is not None
    try:
        yield run.stdin
        run.stdin.close()
        said = run.stderr.read().decode(errors="replace").strip()
        if run.wait() != 0:
            raise _unwritten(path, said)
    except BrokenPipeError:
        raise _unwritten(path, run.stderr.read().decode(errors="replace").strip()) from None
    except BaseException:
        run.kill()
        raise
    finally:
        run.wait()
        run.stderr.close()


def _unwritten(path: Path, said: str) -> ResultError:
    """What to raise for what ffmpeg said as it failed: WriteError where it names a disk that is full or fails."""
    cure = "name another with --movie, or make room"
    if full := next((reason for reason in sorted(FULL) if reason in said), None):
        return WriteError(path, f"cannot be written: {full}", cure)
    cause = said.splitlines()[-1] if said else "ffmpeg stopped"
    cause = re.sub(r"\S*\.part\.\w+", path.name, cause)  # the name under which it waits is nobody's business
    cause = re.sub(r"^\[\S+ @ 0x[0-9a-f]+\] ", "", cause)  # which of its parts says so is nobody's, either
    return ResultError(path, f"cannot be written: {cause}", cure)
