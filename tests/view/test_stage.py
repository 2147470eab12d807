"""What is drawn: the right thing at the right place in the right colour, at any frame."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from drawn import NODES, TIME, appearance, load, rope, tension

from tautline.results.errors import ResultError
from tautline.view.space.appearance import Arrows, Line, still
from tautline.view.space.stage import SIZE, Stage
from tautline.view.space.window import Window


@pytest.fixture(scope="module")
def stage():
    made = Stage(appearance())
    yield made
    made.close()


@pytest.fixture(scope="module")
def shown(stage):
    """Shows a frame of it, and gives the picture; each is drawn once."""
    drawn = {}

    def show(frame: int) -> np.ndarray:
        stage.show(frame)
        if frame not in drawn:
            drawn[frame] = stage.picture()
        return drawn[frame]

    return show


def pixel(stage: Stage, point) -> tuple[int, int]:
    """Row and column of a point in the picture, by VTK's own projection."""
    renderer = stage.plotter.renderer
    renderer.SetWorldPoint(*point, 1.0)
    renderer.WorldToDisplay()
    x, y, _ = renderer.GetDisplayPoint()
    return SIZE[1] - 1 - round(y), round(x)


def around(picture: np.ndarray, place: tuple[int, int], reach: int = 3) -> np.ndarray:
    """Colours of the pixels about a place, (n, 3)."""
    row, column = place
    return picture[row - reach : row + reach + 1, column - reach : column + reach + 1].reshape(-1, 3).astype(float)


def alike(colours: np.ndarray, wanted) -> float:
    """Least angle, rad, between colours and one that is wanted: light changes how bright a thing is, not its hue."""
    wanted = np.asarray(wanted, float)
    size = np.linalg.norm(colours, axis=1) * np.linalg.norm(wanted)
    return float(np.arccos(np.clip(colours @ wanted / np.maximum(size, 1e-9), -1.0, 1.0)).min())


@pytest.mark.parametrize("frame", [0, 20, 40])
@pytest.mark.parametrize("point", [2, 18])
def test_the_rope_is_where_it_must_be_in_the_colour_of_its_tension(stage, shown, frame, point):
    picture = shown(frame)
    shade = stage.shading
    value = tension()[frame, point] / shade.factor
    wanted = shade.table[round(255 * (value - shade.low) / (shade.high - shade.low))]
    assert alike(around(picture, pixel(stage, rope(frame)[point])), wanted) < 0.12


def test_the_load_is_seen_where_it_hangs_and_not_where_it_hung(stage, shown):
    first, last = shown(0), shown(40)
    here, there = pixel(stage, load(0) - [0, 1, 1]), pixel(stage, load(40) - [0, 1, 1])
    orange = (196, 87, 43)
    assert alike(around(first, here), orange) < 0.1 < alike(around(last, here), orange)
    assert alike(around(last, there), orange) < 0.1 < alike(around(first, there), orange)


def test_the_sea_lies_below_and_a_paler_sky_above(stage, shown):
    picture = shown(0)
    sky, sea = picture[5, 5].astype(float), around(picture, pixel(stage, [-9.0, -4.0, -3.0])).mean(axis=0)
    assert sky.min() > 170 and sky[2] >= sky[0]
    assert sea[2] > sea[0] + 40 and sea.sum() < sky.sum()


def test_the_drawn_wheel_turns_with_the_rope_that_runs_over_it(stage, shown):
    first, later = shown(0).astype(int), shown(2).astype(int)
    row, column = pixel(stage, [12.0, -0.2, 30.0])
    window = (slice(row - 25, row + 25), slice(column - 25, column + 25))
    assert np.abs(later[window] - first[window]).max() > 50


def words(stage: Stage) -> list[str]:
    """All that is written in the picture."""
    found = []
    for actor in stage.plotter.actors.values():
        for name in ("GetInput", "input"):
            text = getattr(actor, name, None)
            text = text() if callable(text) else text
            if isinstance(text, str):
                found.append(text)
    return found


def test_the_legend_says_what_it_shows_with_unit_and_round_numbers(stage):
    said = words(stage)
    assert "tension [kN]" in said
    assert {"10", "20", "30", "40"} <= set(said)
    assert "Hoist by hand" in said


def test_the_picture_says_what_the_longest_arrow_stands_for(stage):
    assert any("weight: longest arrow 50 kN" in text for text in words(stage))


def test_the_clock_says_the_frames_time(stage):
    stage.show(7)
    assert f"t = {TIME[7]:.2f} s" in words(stage)


def test_everything_is_inside_the_picture_and_left_of_the_legend(stage):
    points = stage.appearance.extent([0, 20, 40])
    places = np.array([pixel(stage, point) for point in points])
    assert places.min() >= 0
    assert places[:, 0].max() < SIZE[1] and places[:, 1].max() < SIZE[0] * 0.88


def test_a_thin_rope_is_made_thick_enough_to_see_and_the_picture_says_so():
    line = Line("rope", rope, 0.005, appearance().lines[0].quantities)
    made = Stage(appearance(lines=(line,)))
    assert made.thickness(line).min() > 0.04
    picture = made.picture()
    assert any("rope drawn" in text and "times as thick" in text for text in words(made))
    assert alike(around(picture, pixel(made, rope(0)[2]), 2), made.shading.table[0]) < 0.4
    made.close()


def test_radius_is_a_factor_on_the_true_one():
    line = appearance().lines[0]
    made = Stage(appearance(), radius=0.5)
    assert made.thickness(line) == pytest.approx(0.075)
    made.close()


def test_a_wellbore_hides_nothing_that_is_in_it():
    """The near side of a hollow line is left out."""
    hole = Line(
        "hole", still(np.linspace([0, 0, 0], [0, 0, -100.0], 30)), 5.0, colour="#B9A68C", hollow=True, thick=False
    )
    pipe = Line("pipe", still(np.linspace([1, 0, 0], [1, 0, -100.0], 30)), 1.0, colour="#D02020")
    made = Stage(appearance(lines=(hole, pipe), solids=(), arrows=(), levels=(), labels=(), rulers=(), eye=(0, -1, 0)))
    assert made.shading is None
    picture = made.picture()
    assert alike(around(picture, pixel(made, [1, 0, -50.0]), 1), (208, 32, 32)) < 0.1
    assert alike(around(picture, pixel(made, [-4, 0, -50.0]), 1), (185, 166, 140)) < 0.1
    made.close()


def test_an_arrow_that_pushes_has_its_head_where_it_acts():
    push = Arrows(
        "wall", "wall", "N", still(np.array([[2.0, 0.0, 15.0]])), still(np.array([[0.0, 0.0, -1.0]])), 1.0, "#AA00AA"
    )
    drawn = {}
    for pushes in (True, False):
        made = Stage(appearance(arrows=(replace(push, pushes=pushes),)))
        picture, long = made.picture(), 0.1 * made.seen
        drawn[pushes] = [
            alike(around(picture, pixel(made, [2.0, 0.0, 15.0 + way * 0.5 * long]), 1), (170, 0, 170)) < 0.1
            for way in (1.0, -1.0)
        ]
        made.close()
    assert drawn == {True: [True, False], False: [False, True]}


def test_a_picture_of_nothing_but_a_title_is_still_a_picture():
    made = Stage(appearance(lines=(), solids=(), arrows=(), levels=(), labels=(), rulers=()))
    assert made.picture().shape == (SIZE[1], SIZE[0], 3)
    made.close()


def test_an_unknown_colour_or_camera_is_refused_before_anything_is_drawn():
    with pytest.raises(ResultError, match="known: tension"):
        Stage(appearance(), colour="speed")
    with pytest.raises(ResultError, match="azimuth"):
        Stage(appearance(), camera="sideways")


def test_a_camera_that_follows_the_load_keeps_it_in_the_middle():
    made = Stage(appearance(), camera="0,10,6@load")
    for frame in (0, 40):
        made.show(frame)
        made.picture()
        row, column = pixel(made, load(frame) - [0, 0, 1.0])
        # The middle of the picture's part beside the legend, above the clock.
        assert abs(row - SIZE[1] * (1 - 0.04) / 2) < 3 and abs(column - SIZE[0] * (1 - 0.13) / 2) < 3
    made.close()


def test_what_is_not_there_cannot_be_followed():
    with pytest.raises(ResultError, match="known: rope, load, sheave"):
        Stage(appearance(), camera="@hook")


@pytest.fixture
def window():
    made = Window(Stage(appearance()), speed=1e12)
    yield made
    made.stage.close()


def test_a_window_plays_from_frame_to_frame_and_stops_at_the_end(window):
    window.show(0)
    window.toggle()
    window.tick()
    assert window.stage.frame == 40 and not window.playing
    window.go(-1)
    assert window.stage.frame == 39


def test_what_is_picked_shows_the_history_of_the_nearest_node(window):
    window.show(20)
    window.pick(rope(20)[NODES[2]] + [0.1, 0.0, 0.1])
    assert window.picked == (0, 2)
    assert np.array_equal(window.history(0, 2), tension()[:, NODES[2]] / 1e3)
    window.show(30)
    window.pick([500.0, 0.0, 0.0])
    assert window.picked == (0, 2)


def test_drawing_leaves_the_theme_the_environment_and_the_logger_of_the_process_as_they_were(monkeypatch):
    """A first picture in a process of its own, without a display, in which the user has set a theme."""
    code = (
        "import os, pyvista\n"
        "from vtkmodules.vtkCommonCore import vtkLogger\n"
        "pyvista.global_theme.background = 'black'\n"
        "def seen(): return dict(os.environ), pyvista.global_theme.to_dict(), vtkLogger.GetCurrentVerbosityCutoff()\n"
        "before = seen()\n"
        "from drawn import appearance\n"
        "from tautline.view.space.stage import Stage\n"
        "made = Stage(appearance())\n"
        "made.picture()\n"
        "made.close()\n"
        "assert seen() == before, [(a, b) for a, b in zip(seen(), before) if a != b]\n"
    )
    monkeypatch.delenv("DISPLAY", raising=False)
    ran = subprocess.run([sys.executable, "-c", code], cwd=Path(__file__).parent, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr


def test_the_pitch_of_the_grid_is_round_in_the_unit_that_it_is_told_in():
    with_floor = replace(appearance(), levels=())
    told = {}
    for units in ("si", "field"):
        stage = Stage(replace(with_floor, units=units))
        told[units] = stage._grid_notes()[-1].split(" on a floor")[0]
        stage.close()
    assert told["si"].endswith(" m") and told["field"].endswith(" ft")
    assert {text.split()[2].strip("0.") for text in told.values()} <= {"1", "2", "5"}
