"""Pictures and films as files."""

import hashlib
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pytest
from drawn import TIME, appearance
from PIL import Image

from tautline.results.errors import ResultError, WriteError
from tautline.view.space.film import Cut, cut, film
from tautline.view.space.stage import Stage
from tautline.view.space.still import frame_of, places, still

SMALL = (322, 181)


@pytest.fixture(scope="module")
def stage():
    made = Stage(appearance(), size=SMALL)
    yield made
    made.close()


@pytest.mark.parametrize(
    ("text", "frame"),
    [("t=5", 20), ("5", 20), ("t = 4.9 s", 20), ("5000 ms", 20), ("first", 0), ("last", 40), ("t=10.2", 40)],
)
def test_a_time_is_the_nearest_frame(text, frame):
    assert frame_of(text, TIME) == frame


@pytest.mark.parametrize("text", ["t=11", "-1", "soon", "5 kg", "nan", ""])
def test_a_time_outside_of_the_run_or_none_at_all_is_refused_with_the_runs_own(text):
    with pytest.raises(ResultError, match="from 0 to 10 s"):
        frame_of(text, TIME)


@pytest.mark.parametrize("ending", ["png", "jpg"])
def test_a_picture_has_the_size_that_is_asked_for_and_shows_the_frame(stage, tmp_path, ending):
    first, last = (still(stage, frame, tmp_path / f"{frame}.{ending}") for frame in (0, 40))
    one, two = (np.asarray(Image.open(path).convert("RGB"), int) for path in (first, last))
    assert one.shape == (SMALL[1], SMALL[0], 3)
    assert np.abs(one - two).max() > 100


def test_pictures_are_named_by_their_times_where_there_are_several(tmp_path):
    assert [path.name for path in places(None, tmp_path / "run.nc", TIME, [0, 20])] == ["run_0s.png", "run_5s.png"]
    assert places(tmp_path / "a.jpg", tmp_path / "run.nc", TIME, [3]) == [tmp_path / "a.jpg"]
    assert places(tmp_path, tmp_path / "run.nc", TIME, [20]) == [tmp_path / "run_5s.png"]


def test_a_picture_of_another_format_or_in_no_folder_is_refused(stage, tmp_path):
    with pytest.raises(ResultError, match="use png or jpg"):
        still(stage, 0, tmp_path / "a.tga")
    for name, option in (("a.html", "--html"), ("a.mp4", "--movie"), ("a.gif", "--movie")):
        with pytest.raises(ResultError, match=f"use png or jpg, or give {option} .*{name} in place of -o"):
            still(stage, 0, tmp_path / name)
    with pytest.raises(ResultError, match="there is no folder"):
        places(tmp_path / "none" / "a.png", tmp_path / "run.nc", TIME, [0])


def test_a_film_at_lifes_speed_shows_every_frame_once_where_they_are_far_apart():
    made = cut(TIME)
    assert made.frames.tolist() == list(range(41))
    assert (made.rate, made.speed) == pytest.approx((4.0, 1.0))


def test_a_film_of_many_frames_has_25_pictures_a_second_evenly_spread():
    time = np.linspace(0.0, 12.0, 2401)
    made = cut(time)
    assert made.rate == pytest.approx(25.0)
    assert (made.frames[0], made.frames[-1]) == (0, 2400)
    assert np.abs(np.diff(time[made.frames]) - 0.04).max() < 0.006


def test_a_long_run_is_shown_faster_than_life_and_a_speed_is_kept():
    time = np.linspace(0.0, 600.0, 6001)
    assert cut(time).speed == pytest.approx(20.0)
    made = cut(time, speed=60.0)
    assert (len(made.frames) - 1) / made.rate == pytest.approx(10.0)


@pytest.mark.parametrize("time", [np.zeros(1), np.array([0.0, 1e-3])])
def test_a_film_of_one_or_two_frames_is_a_film(stage, tmp_path, time):
    made = cut(time)
    assert len(made.frames) == len(time)
    assert film(stage, tmp_path / "short.mp4", made).stat().st_size > 0


def test_a_film_holds_its_pictures_at_its_rate(stage, tmp_path):
    seen = []
    path = film(
        stage, tmp_path / "a.mp4", Cut(np.arange(0, 41, 2), 10.0, 2.0), lambda done, of: seen.append((done, of))
    )
    frames, seconds = imageio_ffmpeg.count_frames_and_secs(str(path))
    assert frames == 21 and seconds == pytest.approx(2.1, abs=0.06)
    assert seen[-1] == (21, 21)
    reader = imageio_ffmpeg.read_frames(str(path))
    size = next(reader)["size"]
    assert size == (322, 180)  # an even number of pixels each way
    first = np.frombuffer(next(reader), np.uint8).reshape(size[1], size[0], 3).astype(int)
    stage.show(0)
    # Compression moves colours a little, mostly at edges.
    assert np.abs(first - stage.picture()[:180].astype(int)).mean() < 3.0


def test_a_gif_holds_its_pictures(stage, tmp_path):
    path = film(stage, tmp_path / "a.gif", Cut(np.arange(0, 41, 4), 10.0, 4.0))
    with Image.open(path) as image:
        assert image.n_frames == 11 and image.info["duration"] == 100


def test_an_interrupted_film_leaves_the_earlier_one_and_nothing_else(stage, tmp_path):
    path = tmp_path / "a.mp4"
    earlier = b"\0\0\0\x18ftypmp42 the earlier one"
    path.write_bytes(earlier)

    def interrupt(done: int, total: int) -> None:
        if done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        film(stage, path, cut(TIME), interrupt)
    assert path.read_bytes() == earlier
    assert list(tmp_path.iterdir()) == [path]


def test_a_film_of_another_format_or_in_no_folder_is_refused(stage, tmp_path):
    with pytest.raises(ResultError, match=r"use \.mp4 or \.gif"):
        film(stage, tmp_path / "a.avi", cut(TIME))
    with pytest.raises(ResultError, match="there is no folder"):
        film(stage, tmp_path / "none" / "a.mp4", cut(TIME))


def test_the_same_frame_makes_the_same_picture(stage):
    def digest() -> str:
        stage.show(11)
        return hashlib.sha256(stage.picture().tobytes()).hexdigest()

    before = digest()
    stage.show(33)
    stage.picture()
    assert digest() == before


@pytest.mark.parametrize("frames", [[1], [0, 1]])
def test_a_name_without_an_ending_or_with_a_slash_behind_it_is_a_folder_there_or_not(tmp_path, frames):
    wanted, time = tmp_path / "pictures", np.array([0.0, 1.0])
    names = [f"run_{frame}s.png" for frame in frames]
    assert places(wanted, Path("run.nc"), time, frames) == [wanted / name for name in names]
    assert places(f"{wanted}.png/", Path("run.nc"), time, frames) == [
        tmp_path / "pictures.png" / name for name in names
    ]
    wanted.mkdir()
    assert places(wanted, Path("run.nc"), time, frames) == [wanted / name for name in names]


@pytest.mark.parametrize(
    "last", ["[out#0/gif @ 0x559f4f336600] Error closing file: No space left on device",
             "[out#0/gif @ 0x559f4f336600] Error closing file"],
)  # fmt: skip
def test_a_film_that_finds_no_room_is_a_failed_write_told_in_plain_words(tmp_path, last):
    """What ffmpeg 7 printed on a disk of 100 kB."""
    from tautline.view.space.film import _unwritten

    said = f"[out#0/gif @ 0x559f4f336600] Error writing trailer: No space left on device\n{last}"
    error = _unwritten(tmp_path / "a.gif", said)
    assert isinstance(error, WriteError) and error.cause == "cannot be written: No space left on device"


def test_what_ffmpeg_says_is_told_without_its_own_names_and_addresses(tmp_path):
    from tautline.view.space.film import _unwritten

    error = _unwritten(tmp_path / "a.mp4", f"[mp4 @ 0x56127baed780] {tmp_path}/.a.part.mp4: Invalid argument")
    assert not isinstance(error, WriteError) and error.cause == "cannot be written: a.mp4: Invalid argument"
