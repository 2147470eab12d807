"""The verb render: what it writes, what it says, what it refuses; the result stays as it is."""

import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import tautline
from gardenhose.application import Gardenhose
from tautline.cli.commands.render import _film_said
from tautline.cli.run import run
from tautline.cli.verbs import make_app
from tautline.results.result import Result
from tautline.view.space.film import cut

DATA = Path(__file__).parents[2] / "data"
SMALL = ("--size", "320x180")


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    """A fifth of a second of the hose, stored: few frames, for a picture is fitted to the poses of all of them."""
    path = tmp_path_factory.mktemp("hose") / "hose.nc"
    scene = tautline.read(DATA / "hose.yaml").replace({"output.interval": "20 ms", "hose.elements": 4})
    tautline.simulate(Gardenhose().with_overrides(scene, end=0.2), path)
    return path


@pytest.fixture
def render(stored, tmp_path, monkeypatch, capsys):
    """Run the command in this process without a display: exit code, standard output, standard error."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)

    def command(*arguments):
        words = ["render", str(stored), *map(str, arguments)]
        with pytest.raises(SystemExit) as left:
            run(make_app(Gardenhose(), words), words)
        captured = capsys.readouterr()
        return left.value.code or 0, captured.out, captured.err

    return command


def digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def test_pictures_a_film_and_a_page_are_written_in_one_go_and_the_result_stays_as_it_is(render, stored, tmp_path):
    before = digest(stored), stored.stat().st_mtime_ns
    code, out, _ = render(
        "--image", "t=0.1", "--image", "last", "--movie", "a.gif", "--html", "a.html", "--json", *SMALL
    )
    report = json.loads(out)
    assert (code, report["status"]) == (0, "done")
    assert {Path(name).name for name in report["files"]} == {"a.html", "a.gif", "hose_0.1s.png", "hose_0.2s.png"}
    assert {path.name for path in tmp_path.iterdir()} == {"a.html", "a.gif", "hose_0.1s.png", "hose_0.2s.png"}
    assert (digest(stored), stored.stat().st_mtime_ns) == before
    with Image.open("a.gif") as film:
        assert film.n_frames == 6


def test_without_a_display_a_picture_is_written_and_the_reader_is_told(render):
    code, _, err = render(*SMALL)
    assert code == 0 and "there is no display" in err
    assert np.asarray(Image.open("hose_0.2s.png")).shape == (180, 320, 3)


def test_another_colour_another_radius_another_camera_make_another_picture(render):
    pictures = {}
    for name, options in {
        "usual": (), "colour": ("--colour", "curvature"), "radius": ("--radius", "3"), "camera": ("--camera", "top"),
        "swing": ("--exaggerate", "2"), "plain": ("--color", "none"),
    }.items():  # fmt: skip
        code, _, err = render("--image", "last", "-o", f"{name}.png", *SMALL, *options)
        assert code == 0, err
        pictures[name] = digest(Path(f"{name}.png"))
    assert len(set(pictures.values())) == len(pictures)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--image", "t=7"), "outside of the run"),
        (("--image", "soon"), "no time"),
        (("--image", "last", "--colour", "tension"), "known: axial_force"),
        (("--image", "last", "--view", "unrolled"), "there is no view 'unrolled'"),
        (("--image", "last", "--camera", "@nozzle"), "known: hose"),
        (("--image", "last", "--size", "big"), "1920x1080"),
        (("--image", "last", "-o", "a.bmp"), "png or jpg"),
        (("--movie", "a.avi"), "mp4 or .gif"),
        (("--movie", "none/a.mp4"), "there is no folder"),
        (("--html", "none/a.html"), "none"),
        (("--html", "a.page"), "is to be a web page"),
    ],
)
def test_what_cannot_be_drawn_is_refused_with_its_cure_and_nothing_is_written(render, tmp_path, options, said):
    code, _, err = render(*options)
    assert code == 2 and said in err and "Traceback" not in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--image", "last", "-o", "none/folder"), "there is no folder"),
        (("--image", "last", "-o", "a.bmp"), "png or jpg"),
        (("--image", "t=99"), "outside of the run"),
        (("--image", "last", "--camera", "@nozzle"), "known: hose"),
        (("--movie", "b.avi"), "mp4 or .gif"),
    ],
)
def test_where_one_of_several_outputs_is_refused_none_of_the_others_is_written(render, tmp_path, options, said):
    film = () if "--movie" in options else ("--movie", "a.gif")
    code, _, err = render("--html", "a.html", *film, *options)
    assert code == 2 and said in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--image", "last", "--speed", "2"), "--speed: is of a film or a window"),
        (("--image", "last", "--rate", "5"), "--rate: is of a film"),
        (("--rate", "5"), "add --movie"),
        (("--html", "a.html", "--speed", "7"), "--speed"),
        (("--html", "a.html", "--size", "100x100"), "--size: is of pictures and films"),
        (("--html", "a.html", "--camera", "top"), "--camera"),
        (("--movie", "a.gif", "-o", "b.gif"), "-o: is the place of pictures"),
    ],
)
def test_an_option_that_nothing_asked_for_heeds_is_refused(render, tmp_path, options, said):
    code, _, err = render(*options)
    assert code == 2 and said in err
    assert list(tmp_path.iterdir()) == []


def test_a_page_replaces_a_page_and_no_other_file(render, stored, tmp_path):
    before = digest(stored)
    for name in (str(stored), "scene.html"):
        Path("scene.html").write_text("hose: {length: 1 m}\n", encoding="utf8")
        code, _, err = render("--html", name)
        assert code == 2 and ("it would be lost" in err or "is to be a web page" in err)
        assert digest(stored) == before and Path("scene.html").read_text(encoding="utf8").startswith("hose")
    assert render("--html", "page.html")[0] == 0 and render("--html", "page.html")[0] == 0


def test_without_opengl_it_says_what_to_install(stored, tmp_path):
    quiet = {key: value for key, value in os.environ.items() if key not in ("DISPLAY", "WAYLAND_DISPLAY")}
    environment = quiet | {"__EGL_VENDOR_LIBRARY_FILENAMES": "/nonexistent"}
    code = "from gardenhose.main import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", code, "render", str(stored), "--image", "last"],
        cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    if done.returncode == 0:
        pytest.skip("OSMesa is installed, and draws")
    assert done.returncode == 2
    assert "there is no OpenGL" in done.stderr and "libegl1" in done.stderr and "export --vtk" in done.stderr


def test_python_gives_the_plotter_of_a_frame(stored):
    result = Result.read(stored)
    plotter = result.render(time=0.1, size=(320, 180))
    assert plotter.screenshot(return_img=True).shape == (180, 320, 3)
    plotter.close()


def test_python_gives_figures_by_name(stored):
    result = Result.read(stored)
    assert "overview" in dir(result.plot)
    assert len(result.plot.tip().axes) >= 2
    with pytest.raises(AttributeError, match="there is no figure 'tipp'"):
        _ = result.plot.tipp


def test_a_film_of_one_frame_is_said_to_be_one_picture():
    assert _film_said(cut(np.zeros(1))) == "one picture"
    assert _film_said(cut(np.linspace(0.0, 1.0, 11))) == "11 pictures, 10 a second"
