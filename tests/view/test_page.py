"""Web pages of results, opened in a real browser and looked at: pictures by their pixels, words in the document."""

from __future__ import annotations

import html
import re
import shutil
import subprocess
import zlib
from base64 import b64decode
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tautline.results.errors import ResultError
from tautline.view.space.appearance import (
    Appearance,
    Arrows,
    Label,
    Level,
    Line,
    Ruler,
    Solid,
    pose_of,
    ranged,
    still,
    stored,
)
from tautline.view.space.colours import table
from tautline.view.space.mesh import box
from tautline.view.web.page import MOST, Pack, thinned, write_page

BROWSER = next(
    (found for name in ("chromium", "chromium-browser", "google-chrome") if (found := shutil.which(name))), ""
)
needs_browser = pytest.mark.skipif(not BROWSER, reason="no Chromium here to open a page in")
FLAGS = (
    "--headless --no-sandbox --disable-gpu --enable-unsafe-swiftshader --disable-quic --no-first-run --disable-sync "
    "--disable-background-networking --disable-component-update --enable-logging=stderr --force-device-scale-factor=1 "
    "--virtual-time-budget=3000"
).split()
WIDE, HIGH = 1100, 800

HOSTILE = "</title></script><script>document.body.dataset.harmed=1</script><img src=x onerror=alert(1)> {{data}} &amp;"
CORNER = np.array([10.0, 0.0, 0.0])
FRAMES, ACROSS = 5, 41


def bent_rope() -> Appearance:
    """A rope in the plane y = 0 seen from the front: 10 m along x at a height that grows, then 10 m down to a load."""
    time = np.linspace(0.0, 8.0, FRAMES)
    share = np.linspace(0.0, 1.0, ACROSS)
    flat = np.stack([10.0 * share, 0.0 * share, 0.0 * share], axis=-1)
    points = np.concatenate([flat, CORNER - flat[1:, [1, 1, 0]]])
    lift = np.zeros((FRAMES, 1, 3))
    lift[:, 0, 2] = 0.5 * time
    points = points + lift
    load = Solid(HOSTILE, *box((1, 1, 1)), pose=lambda k: pose_of(points[k, -1]), colour="#FF0000", smooth=False)
    along = np.linspace(0.0, 1.0, len(points[0]))
    tension = 1000.0 * along + 0.0 * time[:, None]
    twist = np.where(along < 0.5, -30.0, 70.0) + 0.0 * time[:, None]
    push = np.zeros((FRAMES, 1, 3))
    push[2:, 0] = (0.0, 0.0, 300.0)
    rope = Line(
        HOSTILE, stored(points), 0.3, nodes=np.arange(0, len(along), 10),
        quantities=(
            ranged("tension", f"tension {HOSTILE}", "N", tension),
            ranged("torque", "torque", "N m", twist, where="at the nodes"),
        ),
    )  # fmt: skip
    return Appearance(
        HOSTILE, time, lines=(rope,), eye=(0.0, -1.0, 0.0), notes=(HOSTILE,),
        solids=(load,),
        arrows=(
            Arrows("push", HOSTILE, "N", still(np.array([[7.0, 0.0, -4.0]])), stored(push), 300.0, "#00AA00"),
            Arrows("wall", "wall", "N", still(np.array([[5.0, 0.0, -1.5]])), stored(push), 300.0, "#AA00AA", True),
        ),
        levels=(Level(HOSTILE, -11.0),),
        labels=(Label("start", lambda k: points[k, 0]), Label("end", lambda k: points[k, -1]),
                Label(HOSTILE, still(np.array([3.0, 0.0, -8.0])))),
        rulers=(Ruler(HOSTILE, "m", np.array([[0.0, 0, -1], [0, 0, -9]]), np.array([1.0, 9.0])),),
    )  # fmt: skip


@dataclass
class Seen:
    """What a browser made of a page: its document, what it complained of, and its picture (high, wide, 3)."""

    document: str
    complaints: str
    picture: np.ndarray

    def word(self, text: str) -> np.ndarray:
        """Place on the page, px, that a label is written beside."""
        found = re.search(rf"translate\(([-\d.]+)px, ([-\d.]+)px\);\">{re.escape(html.escape(text))}<", self.document)
        assert found, f"no label {text}"
        return np.array([float(found[1]) - 10.0, float(found[2]) + 8.0])

    def pixel(self, at: np.ndarray) -> np.ndarray:
        return self.picture[round(float(at[1])), round(float(at[0]))].astype(float)


def run(path: Path, asked: str, high: int, *wanted: str) -> subprocess.CompletedProcess[str]:
    profile = path.parent / f"profile {asked} {high}"
    command = [BROWSER, *FLAGS, f"--window-size={WIDE},{high}", f"--user-data-dir={profile}", *wanted]
    return subprocess.run([*command, f"{path.as_uri()}#{asked}"], capture_output=True, text=True, timeout=60)


def height(document: str) -> int:
    """Height of the view that a document was laid out for, px."""
    found = re.search(r'<canvas id="space"[^>]* height="(\d+)"', document)
    assert found, "the page drew nothing"
    return int(found[1])


def opened(path: Path, asked: str) -> Seen:
    shot = path.parent / f"{asked}.png"
    # One browser gives both, as its start costs more than the page.
    drawn = told = run(path, asked, HIGH, f"--screenshot={shot}", "--dump-dom")
    assert shot.exists(), drawn.stderr
    # A screenshot is as large as the window, but some browsers lay a document out for less: the frame of a window.
    if height(told.stdout) != HIGH:
        told = run(path, asked, 2 * HIGH - height(told.stdout), "--dump-dom")
    assert height(told.stdout) == HIGH
    said = [*drawn.stderr.splitlines(), *told.stderr.splitlines()]
    complaints = "\n".join(line for line in said if "CONSOLE" in line and "GL Driver Message" not in line)
    return Seen(told.stdout, complaints, np.asarray(Image.open(shot).convert("RGB")))


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_page(bent_rope(), tmp_path_factory.mktemp("page") / "rope.html")


@pytest.fixture(scope="module")
def first(page: Path) -> Seen:
    return opened(page, "frame=0")


@pytest.fixture(scope="module")
def last(page: Path) -> Seen:
    return opened(page, "frame=4&colour=torque&line=1&node=8")


def on_page(seen: Seen, share_across: float, share_down: float) -> np.ndarray:
    """Place of a point of the rope's plane, as shares of the way from its start to its end across and down.

    The plane is square to the view, so that its picture is to scale, and two labels tell where it lies.
    """
    start, end = seen.word("start"), seen.word("end")
    return start + np.array([share_across, share_down]) * (end - start)


def hue(colour: np.ndarray) -> np.ndarray:
    """Colour without its brightness, which the lamp changes."""
    return colour / np.linalg.norm(colour)


@needs_browser
def test_the_rope_is_where_it_must_be_in_the_colour_of_its_tension(first):
    for share in (0.2, 0.4, 0.6, 0.8):
        across, down = min(2.0 * share, 1.0), max(2.0 * share - 1.0, 0.0)
        seen, wanted = (
            first.pixel(on_page(first, across, down)),
            table(0.0, 1.0, False)[round(255 * share)].astype(float),
        )
        assert hue(seen) @ hue(wanted) > 0.985, (share, seen, wanted)
        assert 0.65 < np.linalg.norm(seen) / np.linalg.norm(wanted) < 1.25


@needs_browser
def test_beside_the_rope_is_the_sky(first):
    seen = [first.pixel(on_page(first, *place)) for place in ((0.5, 0.15), (0.8, 0.5), (0.5, -0.1))]
    assert np.min(seen) > 180.0 and np.ptp(seen, axis=0).max() < 45.0


@needs_browser
def test_lengths_across_and_down_are_to_the_same_scale(first):
    across, down = np.abs(first.word("end") - first.word("start"))
    assert across == pytest.approx(down, abs=0.3)
    assert across > 250.0


@needs_browser
def test_a_later_frame_shows_the_rope_higher_and_in_the_other_quantity(first, last):
    assert np.mean(np.any(first.picture != last.picture, axis=2)) > 0.01
    # 4 m of rise are 0.4 of the rope's height; the ruler stands still.
    moved = first.word("start")[1] - last.word("start")[1]
    assert moved == pytest.approx(0.4 * (first.word("end")[1] - first.word("start")[1]), abs=0.3)
    for place, share in (((0.5, 0.0), 0.0), ((1.0, 0.5), 1.0)):
        seen, wanted = last.pixel(on_page(last, *place)), table(-30.0, 70.0, True)[round(255 * share)].astype(float)
        assert hue(seen) @ hue(wanted) > 0.985, (place, seen, wanted)


@needs_browser
def test_an_arrow_is_drawn_in_frames_where_it_is_not_zero_only(first, last):
    # It stands at 0.7 of the way across, from 4 m below where the rope is at first, beside what is told of a picked
    # node; a tenth of the picture long.
    left, foot = np.round(on_page(first, 0.7, 0.4)).astype(int)
    tall = int(0.9 * 0.1 * 14.5 * (first.word("end") - first.word("start"))[1] / 10.0)
    for seen, some in ((first, False), (last, True)):
        part = seen.picture[foot - tall : foot, left - 6 : left + 7].astype(float)
        green = (part[..., 1] > 1.6 * part[..., 0]) & (part[..., 1] > 1.6 * part[..., 2])
        assert green.any(axis=1).mean() > 0.95 if some else not green.any()


@needs_browser
def test_an_arrow_that_pushes_has_its_head_where_it_acts(first, last):
    at, tall = (
        np.round(on_page(first, 0.5, 0.15)).astype(int),
        int(0.1 * 14.5 * (first.word("end") - first.word("start"))[1] / 10.0),
    )
    column = last.picture[:, at[0] - 6 : at[0] + 7].astype(float)
    purple = np.any(np.minimum(column[..., 0], column[..., 2]) > 1.6 * column[..., 1], axis=1)
    assert purple[at[1] + 2 : at[1] + int(0.9 * tall)].mean() > 0.95
    assert not purple[at[1] - tall : at[1] - 2].any()


@needs_browser
def test_the_load_hangs_at_the_end_of_the_rope(first, last):
    for seen in (first, last):
        red, green, blue = seen.pixel(seen.word("end") + (0.0, 6.0))
        assert red > 120.0 and green < 60.0 and blue < 60.0


@needs_browser
def test_the_legend_tells_range_unit_and_round_numbers(first, last):
    assert ">0 to 1 kN in the stored frames<" in first.document
    assert ">−30 to 70 N m at the nodes, in the stored frames<" in last.document
    ticks = re.findall(r'<span style="--at: ([\d.]+)%;">([^<]*)<', last.document)
    assert [float(text.replace("−", "-")) for _, text in ticks] == [-20.0, 0.0, 20.0, 40.0, 60.0]
    assert [float(at) for at, _ in ticks] == pytest.approx([10.0, 30.0, 50.0, 70.0, 90.0])


@needs_browser
def test_a_picked_node_tells_its_number_and_its_values(last):
    name = re.search(r'<h2 id="picked">([^<]*)</h2>', last.document)[1]
    told = dict(re.findall(r"<span>([^<]*)</span><b>([^<]*)</b>", last.document))
    # Node 8 is point 70 of 81 points, so 0.875 of the rope: 0.875 kN.
    assert "node 8" in name
    assert list(told.values()) == ["0.875 kN", "70.0 N m"]


@needs_browser
def test_the_page_says_time_and_frame(first, last):
    assert 'data-frame="0"' in first.document and ">t = 0.0 s of 8.0 s<" in first.document
    assert 'data-frame="4"' in last.document and ">t = 8.0 s of 8.0 s<" in last.document


@needs_browser
def test_names_that_would_be_script_stay_text_and_nothing_complains(first, last):
    for seen in (first, last):
        assert 'data-ready="1"' in seen.document
        assert "data-harmed" not in seen.document
        assert "<img" not in seen.document
        assert seen.complaints == ""
        assert seen.document.count("<script") == 4 - 1  # the element of the data is gone once it is read
        assert f'<h1 id="title">{html.escape(HOSTILE, quote=False)}</h1>' in seen.document


def test_no_name_of_a_scene_becomes_markup(page):
    text = page.read_text()
    assert text.count("<script") == text.count("</script>") == 4
    assert "<img" not in text
    assert f"<title>{html.escape(HOSTILE)}</title>" in text


def test_nothing_outside_the_page_is_asked_for(page):
    text = page.read_text()
    assert not re.findall(r"""(?:src|href)\s*=\s*["']?\s*(?:https?:)?//""", text)
    policy = re.search(r'http-equiv="Content-Security-Policy" content="([^"]*)"', text)[1]
    assert policy.startswith("default-src 'none';")
    assert "unsafe" not in policy and "http" not in policy


def unpacked(pack: Pack, said: dict) -> np.ndarray:
    """The rows of a packed array, added up again by other means than the page does."""
    data = zlib.decompress(b64decode(pack.text()))
    rows, width, at = said["rows"], said["width"], said["at"]
    middle = np.frombuffer(data, "<f4", width, at).astype(float)
    planes = np.frombuffer(data, np.uint8, 2 * rows * width, at + 4 * width).reshape(2, width, rows).astype(int)
    code = planes[0] + 256 * planes[1]
    change = np.where(code % 2, -(code + 1) // 2, code // 2)
    steps = np.cumsum(change, axis=1)
    for k in range(said["stride"], width):
        steps[k] += steps[k - said["stride"]]
    steps %= 65536
    return np.where(steps == 65535, np.nan, middle[:, None] + said["step"] * (steps - 32767.0)).T


def test_places_are_stored_to_a_hundred_thousandth_of_their_range():
    rng = np.random.default_rng(4)
    points = np.cumsum(rng.normal(size=(30, 50, 3)), axis=0) + 4000.0
    pack = Pack(np.arange(30))
    pack.track(still(np.arange(3.0)))
    said = pack.track(stored(points))
    error = np.abs(unpacked(pack, said) - points.reshape(30, -1)).max()
    # The middle is a float32 of its own, which costs no more than rounding of its last bit: the steps start from it.
    assert error <= 0.5001 * said["step"]
    assert error < 1.0e-5 * np.ptp(points)


def test_a_value_that_is_missing_stays_missing_and_what_stands_still_is_stored_once():
    values = np.array([[1.0, np.nan, 3.0], [2.0, np.nan, np.nan]])
    pack = Pack(np.arange(2))
    said, same = pack.track(stored(values)), pack.track(still(values[0]))
    assert np.allclose(unpacked(pack, said), values, atol=1e-4, equal_nan=True)
    assert same["rows"] == 1
    assert np.allclose(unpacked(pack, same), values[:1], equal_nan=True)


def large(frames: int, points: int) -> Appearance:
    shape = np.zeros((points, 3))
    quantities = tuple(ranged(name, name, "N", np.array([0.0, 1.0]), still(np.zeros(points))) for name in "abcdef")
    return Appearance("large", np.arange(float(frames)), lines=(Line("rope", still(shape), 0.1, quantities),))


def test_long_results_are_thinned_evenly_between_their_first_and_last_frame():
    kept = thinned(large(10_000, 1000), 400)
    assert len(kept) == 400 and kept[0] == 0 and kept[-1] == 9999
    assert np.ptp(np.diff(kept)) <= 1
    assert list(thinned(large(7, 10), 400)) == list(range(7))


def test_large_results_are_thinned_until_they_fit():
    appearance = large(10_000, 20_000)
    kept = thinned(appearance, 400)
    assert 2 < len(kept) < 400 and kept[-1] == 9999
    assert 0.9 * MOST < len(kept) * 20_000 * 9 * 2 <= MOST


def test_a_page_says_that_frames_were_left_out(tmp_path):
    text = write_page(bent_rope(), tmp_path / "few.html", frames=3).read_text()
    assert '"frames":5' in text and '"numbers":[0,2,4]' in text


def test_what_cannot_be_shown_is_refused_with_a_cure(tmp_path):
    with pytest.raises(ResultError, match=r"nothing here has 'heat'.*known: tension, torque"):
        write_page(bent_rope(), tmp_path / "no.html", colour="heat")
    with pytest.raises(ResultError, match="--radius: -1 is no factor on a thickness; give a number above 0"):
        write_page(bent_rope(), tmp_path / "no.html", radius=-1.0)
    with pytest.raises(ResultError, match=r"missing.no\.html: cannot be written"):
        write_page(bent_rope(), tmp_path / "missing" / "no.html")
    assert not list(tmp_path.iterdir())


def test_a_page_that_finds_no_room_leaves_the_earlier_one_whole(tmp_path, monkeypatch):
    path = tmp_path / "rope.html"
    path.write_text("the earlier page")

    def half(self, text, **_):
        with self.open("w") as file:
            file.write(text[:100])
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_text", half)
    with pytest.raises(ResultError, match="No space left on device; name another with --html, or make room"):
        write_page(bent_rope(), path)
    assert path.read_text() == "the earlier page"
    assert [one.name for one in tmp_path.iterdir()] == ["rope.html"]
