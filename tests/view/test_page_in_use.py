"""A page in a real browser, used as a person would: played, picked from, stepped, resized, at night.

Numbers are compared with the result file, read again by h5py; motion between pictures with the motion itself.
"""

from __future__ import annotations

import json
import math
import re
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from figures.synthetic_crane import one_fall
from figures.synthetic_crane import result as made_up
from of_the_suite import studies

from crane.view.appearance import appearance as of_crane
from tautline.system.waves import Waves, wave_number
from tautline.view.space.appearance import Appearance, History, Level, Line, Look, Solid, pose_of, ranged, stored
from tautline.view.space.mesh import box
from tautline.view.web.page import write_page

CHROMIUM = next((found for name in ("chromium", "chromium-browser") if (found := shutil.which(name))), None)
FLAGS = ["--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader"]
FRAMES, EVERY = 2001, 0.3
"""Of a run of 600 s."""
LARGEST = 4.0e6
"""Bytes of its page, at most."""


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    if CHROMIUM is None:
        pytest.skip("there is no Chromium")
    sync_api = pytest.importorskip("playwright.sync_api")
    with sync_api.sync_playwright() as playwright:
        made = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield made
        made.close()


class Opened:
    """A page in a tab: what it asked for, and what went wrong."""

    def __init__(self, browser: Any, path: Path, asked: str = "", **context: Any) -> None:
        # Without a graphics card every pixel costs.
        context.setdefault("viewport", {"width": 960, "height": 540})
        self.context = browser.new_context(**context)
        self.tab = self.context.new_page()
        self.requests: list[str] = []
        self.wrong: list[str] = []
        self.tab.on("request", lambda one: self.requests.append(one.url))
        self.tab.on("pageerror", lambda one: self.wrong.append(str(one)))
        self.tab.on("console", lambda one: self.wrong.append(one.text) if one.type == "error" else None)
        self.tab.goto(f"{path.as_uri()}#{asked}" if asked else path.as_uri())
        self.until("document.body.dataset.ready === '1'")

    def __enter__(self) -> Opened:
        return self

    def __exit__(self, *_: object) -> None:
        self.context.close()
        assert self.wrong == []

    def ask(self, script: str, given: Any = None) -> Any:
        return self.tab.evaluate(script, given)

    def settle(self) -> None:
        """Wait until what was changed is drawn."""
        self.until("!tautline.state.dirty")

    def until(self, condition: str) -> None:
        """Wait until a condition holds; Playwright's own waiting evaluates text, which the page forbids."""
        for _ in range(400):
            if self.ask(condition):
                return
            self.tab.wait_for_timeout(25)
        raise AssertionError(f"it never came to be: {condition}")

    def again(self, asked: str = "") -> Opened:
        """The page as it is when it is opened, for another test: to open one costs more than to use it."""
        assert self.wrong == []
        self.tab.mouse.move(1, 1)
        self.ask(
            "tautline.play(false); tautline.paint(tautline.page.colour); tautline.show(0); tautline.state.shown = 0;"
            "for (const one of ['close', 'reset']) document.getElementById(one).click();"
            "document.getElementById('help').hidden = true"
        )
        self.address("")
        self.address(asked)
        self.settle()
        return self

    def address(self, asked: str) -> None:
        """Change what is asked for, and wait until the page has heard of it."""
        self.ask(
            "(asked) => location.hash.slice(1) !== asked && new Promise((done) => {"
            " addEventListener('hashchange', () => done(true), { once: true }); location.hash = asked; })",
            asked.replace(" ", "%20"),
        )

    @property
    def time(self) -> float:
        return float(self.ask("document.body.dataset.time"))


@pytest.fixture(scope="module")
def long_run(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Result and page of a hoist of 600 s, of a made-up motion."""
    folder = tmp_path_factory.mktemp("long")
    scene = one_fall(interval=EVERY, solver={"end": f"{EVERY * (FRAMES - 1)} s"})
    result = made_up(scene, folder / "hoist.nc", FRAMES, frequency=0.11)
    return folder / "hoist.nc", write_page(of_crane(result, Look()), folder / "hoist.html")


@pytest.fixture(scope="module")
def hoist_in_a_tab(browser: Any, long_run: tuple[Path, Path]) -> Iterator[Opened]:
    with Opened(browser, long_run[1]) as opened:
        yield opened


def test_a_page_of_600_s_holds_500_pictures_or_more_and_stays_small(hoist_in_a_tab, long_run):
    _, page = long_run
    opened = hoist_in_a_tab.again()
    time = opened.ask("tautline.page.time")
    assert 500 <= len(time) <= 1500
    assert (time[0], time[-1]) == (0.0, pytest.approx(600.0))
    assert max(np.diff(time)) < 1.2 * 600.0 / 500
    assert "1500 of 2001 stored frames" in opened.ask("document.getElementById('notes').textContent")
    assert page.stat().st_size < LARGEST


def test_play_advances_time_at_the_speed_that_is_shown_and_pauses_at_a_picture(hoist_in_a_tab):
    opened = hoist_in_a_tab.again()
    assert opened.time == 0.0
    opened.tab.click("#play")
    opened.until("Number(document.body.dataset.time) > 2")
    speed = opened.ask("tautline.state.speed")
    begun, at = opened.ask("[tautline.pace.seconds, tautline.state.clock]")
    opened.tab.wait_for_timeout(800)
    ended, later = opened.ask("[tautline.pace.seconds, tautline.state.clock]")
    assert later - at == pytest.approx(speed * (ended - begun), rel=1e-6)
    opened.tab.keyboard.press(" ")
    stopped = opened.time
    assert not opened.ask("tautline.state.when.between")
    opened.tab.wait_for_timeout(200)
    assert opened.time == stopped
    # The clock is added up: its last digits are not those of the picture.
    assert np.abs(np.array(opened.ask("tautline.page.time")) - stopped).min() < 1e-9


def rounded(values: np.ndarray, digits: int) -> list[str]:
    """Numbers as people write them, by Python's own rounding."""
    return [f"{value:.{max(digits, 0)}f}".replace("-", "−") for value in values]


def same(written: list[str], wanted: list[str]) -> bool:
    """Whether numbers are the same to the digit; a zero has no sign."""
    return [re.sub(r"^−(?=[0.]*$)", "", text) for text in wanted] == written


@pytest.mark.parametrize(
    ("thing", "quantity", "variable", "factor"),
    [
        ("drum winch", "drum_tension", "drum_tension", 1e3),
        ("drum winch", "paid_out", "paid_out", 1.0),
        ("sheave boom tip", "sheave_rotation", "sheave_rotation", 1.0),
        ("payload", "height", "body_position", 1.0),
    ],
)
def test_the_history_of_a_picked_thing_is_that_of_the_result_file_to_the_digit(
    hoist_in_a_tab, long_run, thing, quantity, variable, factor
):
    with h5py.File(long_run[0]) as file:
        values = file[variable][:, 0]
        values = (values[:, 2] if variable == "body_position" else values) / factor
        time = file["time"][:]
    opened = hoist_in_a_tab.again(f"go={thing}")
    opened.tab.click("#close")
    opened.settle()
    x, y, _ = opened.ask(f"tautline.middle({json.dumps(thing)})")
    opened.tab.mouse.click(x, y)
    picked = opened.ask("document.getElementById('picked').textContent")
    assert picked == thing
    opened.tab.click(f"button[data-name={quantity}]")
    history = opened.ask("tautline.history()")
    assert history["name"] == quantity
    assert history["time"] == list(time)
    digits = len(history["written"][1].partition(".")[2])
    assert digits >= 1
    assert same(history["written"], rounded(values, digits))
    # Enough digits: there are at least some hundreds of them in the range.
    assert np.ptp(values) * 10.0**digits > 500
    opened.ask("tautline.show(700)")
    shown = opened.ask(f"document.querySelector('button[data-name={quantity}] b').textContent")
    frame = opened.ask("tautline.page.numbers[700]")
    assert same([shown.split(" ")[0]], rounded(values[[frame]], digits))


def test_a_picked_place_of_the_rope_tells_the_tension_of_the_result_at_every_picture(hoist_in_a_tab, long_run):
    with h5py.File(long_run[0]) as file:
        tension = file["axial_force"][:, -1] / 1e3
    opened = hoist_in_a_tab.again("frame=100")
    node = opened.ask("tautline.page.lines[0].nodes.length") - 2
    opened.ask("tautline.play(false)")
    x, y, _ = opened.ask(f"tautline.place(0, tautline.page.lines[0].nodes[{node}])")
    opened.tab.mouse.click(x, y)
    assert opened.ask("document.getElementById('picked').textContent") == f"rope, node {node + 1}"
    history, numbers = opened.ask("tautline.history()"), opened.ask("tautline.page.numbers")
    digits = len(history["written"][1].partition(".")[2])
    assert (history["name"], history["unit"]) == ("tension", "kN")
    assert same(history["written"], rounded(tension[numbers], digits))


SPIN = 7.9
"""Rad/s of a wheel whose pictures are 0.8 s apart: it turns once and a bit between them."""


def swinging(frames: int = 801, end: float = 16.0) -> Appearance:
    """A rope whose end swings, a load that follows it, and a wheel that spins quickly; on waves."""
    time = np.linspace(0.0, end, frames)
    tip = motion(time)
    points = np.linspace([0.0, 0.0, 10.0], tip, 5).swapaxes(0, 1)
    load = Solid("load", *box((1, 1, 1)), lambda k: pose_of(tip[k]), histories=(History("swing", "x", "m", tip[:, 0]),))
    wheel = Solid("wheel", *box((2, 0.2, 0.2)), lambda k: pose_of([0, 0, 10], turned(SPIN * time[k])))
    force = ranged("tension", "tension", "N", 1e3 * (1.5 + 0.1 * tip[:, :1] + np.linspace(0, 1, 5)))
    line = Line("rope", stored(points), 0.02, (force,), nodes=np.arange(5))
    return Appearance(
        "swing", time, (line,), (load, wheel), levels=(Level("sea", -2.0, waves=sea()),), eye=(0.2, -1.0, 0.3),
        enlarged=(("swing", 7.0),),
    )  # fmt: skip


def motion(time: Any) -> np.ndarray:
    return np.stack([3.0 * np.sin(0.9 * time), 0.5 * np.cos(0.7 * time), 1.0 + 0.1 * time], axis=-1)


def turned(angle: float) -> np.ndarray:
    """About y."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def sea() -> Waves:
    w = np.array([0.5, 0.8, 1.3])
    way = np.array([math.cos(0.4), math.sin(0.4)])
    return Waves(
        np.array([0.8, 0.5, 0.2]), w, np.array([0.3, 2.0, 4.0]), wave_number(w, 40.0), way, np.array([3.0, -1.0]), 6.0
    )


@pytest.fixture(scope="module")
def swing(tmp_path_factory: pytest.TempPathFactory) -> Path:
    # 21 pictures of 801 frames: 0.8 s from one to the next.
    return write_page(swinging(), tmp_path_factory.mktemp("swing") / "swing.html", frames=21)


@pytest.fixture(scope="module")
def swing_in_a_tab(browser: Any, swing: Path) -> Iterator[Opened]:
    with Opened(browser, swing) as opened:
        yield opened


@pytest.mark.parametrize("at", [0.4, 3.5, 7.25, 12.6, 19.6])
def test_between_two_pictures_things_are_where_the_motion_has_them(swing_in_a_tab, at):
    opened = swing_in_a_tab.again()
    middle = np.array([*opened.ask("tautline.point(0, 0)")]) - [0.0, 0.0, 10.0]
    opened.ask(f"tautline.show({at})")
    time = opened.time
    assert time == pytest.approx(0.8 * at)
    tip = np.array(opened.ask("tautline.point(0, 4)")) - middle
    load = np.array(opened.ask("tautline.pose('load')")).reshape(4, 4).T[:3, 3] - middle
    # Between others a cubic is good to h^4; at the first and the last picture, where a parabola ends, to h^3.
    inside = 1.0 < at < 19.0
    within = 0.03 if inside else 0.07
    assert np.abs(tip - motion(time)).max() < within
    assert np.abs(load - motion(time)).max() < within
    straight = (1 - at % 1) * motion(0.8 * math.floor(at)) + (at % 1) * motion(0.8 * math.ceil(at))
    if inside:
        assert np.abs(tip - motion(time)).max() < 0.3 * np.abs(straight - motion(time)).max()


@pytest.mark.parametrize("at", [2.25, 11.5])
def test_a_wheel_that_turns_more_than_once_between_pictures_turns_by_what_was_stored(swing_in_a_tab, at):
    opened = swing_in_a_tab.again()
    opened.ask(f"tautline.show({at})")
    pose = np.array(opened.ask("tautline.pose('wheel')")).reshape(4, 4).T
    assert pose[:3, :3] == pytest.approx(turned(SPIN * 0.8 * at), abs=2e-3)


def test_a_value_between_two_stored_moments_says_that_it_is_interpolated(swing_in_a_tab):
    opened = swing_in_a_tab.again("thing=load")
    told = "document.querySelector('#values b').textContent"
    opened.ask("tautline.show(3)")
    assert not opened.ask(told).startswith("≈")
    opened.ask("tautline.show(3.337)")
    assert opened.ask(told).startswith("≈ ")
    assert float(opened.ask(told).split()[1].replace("−", "-")) == pytest.approx(motion(0.8 * 3.337)[0], abs=2e-3)


def before_a_wall() -> Appearance:
    """A rope in front of a wall, whose first number never changes, and beads on the rope, which tell nothing."""
    time = np.linspace(0.0, 2.0, 41)
    rope = np.array([[-4.0, 0.0, 1.0], [4.0, 0.0, 1.0]])
    pull = Line(
        "rope",
        lambda k: rope,
        0.02,
        (ranged("tension", "tension", "N", 1e3 + np.outer(time, [1, 1])),),
        nodes=np.arange(2),
    )
    path = Line("path", lambda k: rope + (0.0, 0.0, 0.02), 0.001, thick=False)
    told = (History("still", "x", "m", 0.0 * time), History("swing", "angle", "rad", np.sin(time)))
    wall = Solid("wall", *box((6, 0.2, 6)), lambda k: pose_of([0, 3, 1]), histories=told)
    bead = Solid("bead", *box((0.5, 0.5, 0.5)), lambda k: pose_of([-4.0, 0, 1]))
    return Appearance("wall", time, (pull, path), (wall, bead), eye=(0.0, -1.0, 0.0))


def test_of_what_is_one_behind_the_other_the_nearer_line_is_picked_and_what_varies_is_shown(browser, tmp_path):
    with Opened(browser, write_page(before_a_wall(), tmp_path / "wall.html")) as opened:
        x, y, _ = opened.ask("tautline.middle('wall')")
        ends = [opened.ask(f"tautline.place(0, {k})") for k in (0, 1)]
        assert opened.ask(f"tautline.picked({x}, {ends[0][1]})").startswith("rope, node")
        assert opened.ask(f"tautline.picked({x}, {ends[0][1] - 60})").startswith("wall")
        # Beads have no numbers: what they are strung on is picked.
        assert opened.ask(f"tautline.picked({ends[0][0] + 6}, {ends[0][1] + 6})").startswith("rope, node 1")
        opened.tab.mouse.move(x, y - 60)
        opened.tab.mouse.click(x, y - 60)
        assert opened.ask("document.getElementById('picked').textContent") == "wall"
        assert opened.ask("tautline.history()")["name"] == "swing"
        assert not opened.ask("document.getElementById('tip').hidden")
        opened.tab.keyboard.press("f")
        assert opened.ask("document.getElementById('tip').hidden")


def test_waves_have_the_height_of_the_sea_at_any_place_and_time(swing_in_a_tab):
    appearance = swinging()
    low, high = (f(appearance.extent(range(0, 801, 40)), axis=0) for f in (np.min, np.max))
    opened = swing_in_a_tab.again()
    page = opened.ask("tautline.page")
    middle = np.array(page["levels"][0]["waves"]["origin"]) - sea().origin
    assert low[0] - 2.0 < -middle[0] < high[0] + 2.0
    for x, y, time in ((0.0, 0.0, 1.0), (5.0, -7.0, 4.0), (-20.0, 3.0, 15.0)):
        there = opened.ask(f"tautline.elevation({x + middle[0]}, {y + middle[1]}, {time})")
        assert there == pytest.approx(float(sea().elevation(x, y, time)), abs=1e-6)
    # Whose waves they are, and what they act on, is among the notes: the page knows nothing of it.
    assert "waves" not in opened.ask("document.getElementById('keys').textContent")


@pytest.mark.parametrize("far", [30.0, 1000.0])
def test_water_is_drawn_where_it_is_at_a_load_far_from_where_the_phases_hold(browser, far, tmp_path):
    w = np.array([2.0 * math.pi / 7.0])
    waves = Waves(np.array([1.5]), w, np.zeros(1), wave_number(w), np.array([0.8, 0.6]), np.zeros(2), 8.0)
    points = np.tile(np.array([[far, 0.0, 20.0], [far, 0.0, 0.0]]), (2, 1, 1))
    load = Solid("load", *box((2, 2, 2)), lambda k: pose_of(points[k, 1]))
    rope = Line("rope", stored(points), 0.02)
    levels = (Level("sea", 0.5, waves=waves),)
    appearance = Appearance("far", np.array([14.0, 15.0]), (rope,), (load,), levels=levels)
    with Opened(browser, write_page(appearance, tmp_path / "far.html")) as opened:
        middle = np.array([*opened.ask("tautline.point(0, 0)")]) - points[0, 0]
        x, y, height = opened.ask(f"tautline.surface({far + middle[0]}, {middle[1]})")
    x, y = x - middle[0], y - middle[1]
    assert math.hypot(x - far, y) < 1.0
    k = w[0] ** 2 / 9.81
    assert height == pytest.approx(1.5 * math.sin(w[0] * 14.0 - k * (0.8 * x + 0.6 * y)), abs=0.02)


def test_keys_step_jump_and_play(swing_in_a_tab):
    opened = swing_in_a_tab.again()
    press, frame = opened.tab.keyboard.press, "tautline.state.frame"
    for key, wanted in (
        ("ArrowRight", 1), ("Shift+ArrowRight", 11), ("ArrowLeft", 10), ("End", 20), ("ArrowRight", 20), ("Home", 0)
    ):  # fmt: skip
        press(key)
        assert opened.ask(frame) == wanted
    press("Space")
    assert opened.ask("tautline.state.playing")
    before = opened.ask("tautline.state.speed")
    press("+")
    assert opened.ask("tautline.state.speed") > before
    press("Space")
    assert not opened.ask("tautline.state.playing")
    press("-")
    assert opened.ask("tautline.state.speed") == before


def test_the_legend_says_what_is_exaggerated_and_by_how_much(swing_in_a_tab, hoist_in_a_tab):
    opened = swing_in_a_tab.again()
    assert "swing drawn 7 times larger" in opened.ask("document.getElementById('keys').textContent")
    opened = hoist_in_a_tab.again()
    keys = opened.ask("document.getElementById('keys').textContent")
    assert "1 : 1" in keys and "times larger" not in keys


# A telephone and a small window. How many pixels a screen has for each of the page's does not change the layout, and
# without a graphics card each pixel costs.
@pytest.mark.parametrize(
    ("wide", "high", "dense"),
    [(390, 780, 1), (900, 500, 2), *studies((1280, 720, 1), (1920, 1080, 2), (390, 780, 3), (900, 500, 1))],
)
def test_the_first_camera_shows_all_of_the_scene_clear_of_what_is_written(browser, long_run, wide, high, dense):
    with Opened(browser, long_run[1], viewport={"width": wide, "height": high}, device_scale_factor=dense) as opened:
        # Corners of every body and points of the rope, at the first and the last picture, on the page.
        for frame in (0, 1499):
            opened.ask(f"tautline.show({frame})")
            opened.settle()
            count = opened.ask("tautline.page.lines[0].points.width") // 3
            places = [opened.ask(f"tautline.place(0, {k})") for k in range(0, count, 7)]
            places += [opened.ask(f"tautline.middle('{name}')") for name in ("payload", "drum winch")]
            x, y, z = np.array(places).T
            foot = opened.ask("document.querySelector('footer').getBoundingClientRect().top")
            legend = opened.ask("document.getElementById('legend').getBoundingClientRect().toJSON()")
            assert not np.any((x > legend["left"]) & (x < legend["right"]) & (y < legend["bottom"]))
            assert x.min() >= 0 and x.max() <= wide and y.min() >= 0 and y.max() <= foot and z.max() < 1.0
        # It fills the room: either way nearly, or the legend would hide it.
        assert np.ptp(y) > 0.3 * high or np.ptp(x) > 0.3 * wide


def test_the_scale_bar_has_the_length_that_it_says(hoist_in_a_tab):
    opened = hoist_in_a_tab.again()
    text = opened.ask("document.getElementById('length').textContent")
    wide = opened.ask("document.getElementById('rule').getBoundingClientRect().width")
    metres = float(text.split()[0])
    assert text.split()[1] == "m"
    # Two points in the plane through what is looked at, one bar apart across the view.
    apart = opened.ask(
        "(() => { const c = tautline.camera, t = tautline.controls.target, e = c.matrixWorld.elements;"
        f"const b = t.clone().set(t.x + {metres} * e[0], t.y + {metres} * e[1], t.z + {metres} * e[2]);"
        "const p = t.clone().project(c), q = b.project(c); return 0.5 * innerWidth * (q.x - p.x); })()"
    )
    assert wide == pytest.approx(apart, abs=1.0)


def test_lengths_of_a_page_in_field_units_are_round_feet_and_as_long_as_they_say(browser, tmp_path):
    written = write_page(replace(swinging(), units="field", levels=()), tmp_path / "feet.html", frames=21)
    with Opened(browser, written) as opened:
        number, unit = opened.ask("document.getElementById('length').textContent").split()[:2]
        assert unit == "ft" and number.strip("0.") in {"1", "2", "5"}
        wide = opened.ask("document.getElementById('rule').getBoundingClientRect().width")
        metres = 0.3048 * float(number)
        apart = opened.ask(
            "(() => { const c = tautline.camera, t = tautline.controls.target, e = c.matrixWorld.elements;"
            f"const b = t.clone().set(t.x + {metres} * e[0], t.y + {metres} * e[1], t.z + {metres} * e[2]);"
            "const p = t.clone().project(c), q = b.project(c); return 0.5 * innerWidth * (q.x - p.x); })()"
        )
        assert wide == pytest.approx(apart, abs=1.0)
        grid = [one for one in opened.ask("document.getElementById('keys').textContent").split("grid of ")[1:]]
        assert len(grid) == 1 and grid[0].split(",")[0] in {"1 ft", "2 ft", "5 ft", "0.5 ft"}


def test_who_wants_less_motion_sees_pictures_and_nothing_between(browser, swing):
    with Opened(browser, swing, reduced_motion="reduce") as opened:
        opened.ask("tautline.play(true)")
        seen = []
        for _ in range(12):
            opened.tab.wait_for_timeout(150)
            seen.append(opened.ask("[tautline.state.when.at, tautline.state.when.between]"))
        assert not any(between for _, between in seen)
        assert len({at for at, _ in seen}) > 1
        assert opened.ask("tautline.controls.enableDamping") is False


def test_at_night_the_page_is_dark_and_by_day_it_is_light(browser, swing):
    from io import BytesIO

    from PIL import Image

    bright = {}
    with Opened(browser, swing, color_scheme="dark") as opened:
        for scheme in ("dark", "light"):
            opened.tab.emulate_media(color_scheme=scheme)
            opened.until(f"tautline.state.dark === {json.dumps(scheme == 'dark')}")
            opened.settle()
            picture = np.asarray(Image.open(BytesIO(opened.tab.screenshot())).convert("L"), float)
            bright[scheme] = picture[:150, 300:650].mean(), picture[-30:, 300:600].mean()
        for dark in (True, False):
            opened.tab.keyboard.press("d")
            assert opened.ask("tautline.state.dark") is dark
    assert min(bright["light"]) > 150 > 80 > max(bright["dark"])


def test_nothing_is_asked_for_but_the_page_itself(browser, long_run):
    with Opened(browser, long_run[1]) as opened:
        opened.tab.click("#play")
        opened.tab.wait_for_timeout(300)
        assert [url for url in opened.requests if not url.startswith("data:")] == [long_run[1].as_uri()]
        # Nor could it be: what asks is refused by the page's own policy.
        refused = opened.ask("fetch('https://example.org/').then(() => false, () => true)")
        assert refused
        opened.wrong = [text for text in opened.wrong if "Content Security Policy" not in text and "Fetch" not in text]


def test_a_window_that_changes_its_size_keeps_everything_in_view(swing_in_a_tab):
    opened = swing_in_a_tab.again()
    usual = opened.tab.viewport_size
    try:
        opened.tab.set_viewport_size({"width": 500, "height": 900})
        opened.tab.wait_for_timeout(200)
        opened.settle()
        x, y, _ = np.array([opened.ask(f"tautline.place(0, {k})") for k in range(5)]).T
        assert x.min() > 0 and x.max() < 500 and y.min() > 0 and y.max() < 900
        assert opened.ask("document.getElementById('space').clientWidth") == 500
    finally:
        opened.tab.set_viewport_size(usual)
        opened.until(f"document.getElementById('space').clientWidth === {usual['width']}")


@pytest.fixture(scope="module")
def up_in_a_tab(browser: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Opened]:
    """A rope that reaches up to the right."""
    points = np.linspace([0.0, 0.0, 0.0], [40.0, 0.0, 22.0], 30)
    force = ranged("tension", "tension", "N", np.linspace([1e3, 2e3], [2e3, 4e3], 30).T)
    line = Line("rope", lambda frame: points, 0.02, (force,))
    appearance = Appearance("up", np.arange(2.0), (line,), eye=(0.0, -1.0, 0.2))
    with Opened(browser, write_page(appearance, tmp_path_factory.mktemp("up") / "up.html")) as opened:
        yield opened


@pytest.mark.parametrize(("wide", "high"), [(900, 500), (390, 780), *studies((1280, 720))])
def test_what_reaches_up_to_the_right_stays_clear_of_the_legend(up_in_a_tab, wide, high):
    opened = up_in_a_tab
    opened.tab.set_viewport_size({"width": wide, "height": high})
    opened.until(f"document.getElementById('space').clientWidth === {wide}")
    opened.again()
    x, y, _ = np.array([opened.ask(f"tautline.place(0, {k})") for k in range(30)]).T
    legend = opened.ask("document.getElementById('legend').getBoundingClientRect().toJSON()")
    assert not np.any((x > legend["left"]) & (x < legend["right"]) & (y < legend["bottom"]))
    assert x.min() >= 0.0 and x.max() <= wide and y.min() >= 0.0 and y.max() <= high
    assert max(np.ptp(x) / wide, np.ptp(y) / high) > 0.35
