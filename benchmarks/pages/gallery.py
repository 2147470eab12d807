"""The gallery: every scene of data/, run and drawn as its engineers would first look at it.

Writes docs/gallery.md and the pictures in docs/images/gallery, and the film that the README shows. Pages are opened in
Chromium, by Playwright; without them the pictures of pages stay as they are. Nothing is drawn by hand, and no picture
is touched up. ``--quick`` runs a tenth of every scene into a temporary folder: whether it works at all.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

import tautline
from benchmarks import ROOT
from tautline.cli.main import main as command
from tautline.results.result import Result

IMAGES = Path("images") / "gallery"
BROWSER = ["--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader"]
WIDE, SMALL = "1280x720", "640x360"
FILM = ("hoist", ("--rate", "8", "--size", SMALL, "--speed", "1.5"))
QUICK = 0.1
PAGES = (
    ("hoist", "hoist", "t=5&thing=drum winch", "light"),
    ("hoist", "night", "t=5&thing=payload", "dark"),
    ("jwell", "jwell", "t=20&line=1&node=9", "light"),
    ("landing", "landing", "t=20&go=sheave tip", "light"),
)
"""Scene, name of the picture, what is asked of its page, and the hour."""


class Shot(NamedTuple):
    """A scene: what is said of it, how it is rendered, and the figures that are shown."""

    scene: str
    text: str
    render: tuple[tuple[str, ...], ...]
    figures: tuple[str, ...]


SHOTS = (
    Shot(
        "hoist",
        "Five tonnes are hoisted at 2 m/s from a vessel that heaves by half a metre. The load moves up and down on"
        " its rope for as long as nothing damps it; the tension shows each swing.",
        (("--image", "last"), ("--image", "t=6", "--camera", "35,12,9@drum winch")),
        ("tension", "payload"),
    ),
    Shot("hookblock", "Two falls through a hook block.", (("--image", "last"),), ("tension",)),
    Shot("sixteen_falls", "Sixteen falls on a moving vessel.", (("--image", "last"),), ("tension",)),
    Shot(
        "slewing",
        "A boom that slews while it hoists: the load lags behind.",
        (("--image", "t=8", "--camera", "corner"),),
        ("payload",),
    ),
    Shot(
        "landing",
        "A template on its way to the sea floor, two kilometres down, with heave compensation. The first picture cuts"
        " the rope, the second follows the template.",
        (("--image", "last", "--view", "crane"), ("--image", "last", "--camera", "20,12@template")),
        ("tension",),
    ),
    Shot(
        "jwell",
        "A string in slips, following the vessel's heave. In the second picture the well is straightened, and what lies"
        " across it enlarged: in the bend its tension pulls the string to the high side of"
        " the hole, and below it lies on the low side.",
        (("--image", "t=20"), ("--image", "t=20", "--view", "unrolled")),
        ("overview", "waterfall"),
    ),
    Shot("iscwsa", "The same heave in a surveyed well.", (("--image", "last"),), ("forces",)),
    Shot(
        "drilling",
        "A bit that drills at 3000 m sticks and slips: the drive turns steadily, the string winds up while the bit"
        " stands, and throws it round at twice the speed. `drillstring stick-slip` maps where that ends.",
        (),
        ("drilling", "phase"),
    ),
    Shot(
        "hose", "Thirty-five metres a second through half a metre of hose.", (("--image", "t=4"),), ("phase", "shape")
    ),
    Shot("reeled_span", "A span that is reeled in past an eyelet, with a mass on it.", (("--image", "last"),), ()),
)


def run(*words: str) -> None:
    """Run a command of the project, as a user would, but in this process: most of such a command is its imports."""
    sys.argv = ["tautline", *words]
    try:
        command()
    except SystemExit as ended:
        if ended.code:
            raise


def result_of(scene: str, folder: Path, quick: bool) -> Path:
    """Run a scene, and return where its result is."""
    path = folder / f"{scene}.nc"
    source = ROOT / "data" / f"{scene}.yaml"
    end = ["--end", repr(QUICK * tautline.read(source).solver.end)] if quick else []
    run("simulate", str(source), "-o", str(path), "--quiet", *end)
    return path


def pictures(shot: Shot, result: Path, images: Path, quick: bool) -> list[Path]:
    """Render and plot a result; files in the order in which they are shown."""
    made = []
    for number, options in enumerate(shot.render):
        path = images / f"{shot.scene}_{number + 1}.png"
        run("render", str(result), *(_early(options) if quick else options), "--size", WIDE, "-o", str(path))
        made.append(path)
    for figure in shot.figures:
        path = images / f"{shot.scene}_{figure}.png"
        run("plot", str(result), "--what", figure, "-o", str(path))
        made.append(path)
    return made


def _early(options: tuple[str, ...]) -> tuple[str, ...]:
    return tuple("last" if word.startswith("t=") else word for word in options)


def pages(work: Path, images: Path) -> None:
    """Pictures of pages, as a browser shows them."""
    browser = next((found for name in ("chromium", "google-chrome") if (found := shutil.which(name))), None)
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        browser = None
    if browser is None:
        print("no browser: pictures of pages are left as they are")
        return
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=browser, args=BROWSER)
        for scene, name, asked, hour in PAGES:
            page = work / f"{scene}.html"
            if not page.exists():
                run("render", str(work / f"{scene}.nc"), "--html", str(page))
            tab = opened.new_page(viewport={"width": 1280, "height": 720}, color_scheme=hour)
            tab.goto(f"{page.as_uri()}#{asked}")
            while tab.evaluate("document.body.dataset.ready") != "1":
                tab.wait_for_timeout(50)
            tab.wait_for_timeout(500)
            tab.screenshot(path=str(images / f"page_{name}.jpg"), type="jpeg", quality=85)
            tab.close()
        opened.close()


def commands(shot: Shot) -> str:
    """What a user types for the pictures."""
    lines = [f"tautline simulate data/{shot.scene}.yaml"]
    lines += [f"tautline render {shot.scene}.nc {' '.join(map(_quoted, options))}" for options in shot.render]
    lines += [f"tautline plot {shot.scene}.nc --what {' --what '.join(shot.figures)}"] if shot.figures else []
    return "```\n" + "\n".join(lines) + "\n```"


def _quoted(word: str) -> str:
    return f'"{word}"' if " " in word else word


def main() -> None:
    """Write the gallery."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="a tenth of every scene, into a temporary folder")
    quick = parser.parse_args().quick
    with tempfile.TemporaryDirectory() as work:
        docs = Path(work) / "docs" if quick else ROOT / "docs"
        (docs / IMAGES).mkdir(parents=True, exist_ok=True)
        parts = ["# Gallery", "", "Made by `python -m benchmarks.pages.gallery`, as they come.", ""]
        for shot in SHOTS:
            result = result_of(shot.scene, Path(work), quick)
            title = str(Result.read(result).attributes.get("title") or shot.scene)
            parts += [f"## {title}", "", shot.text, "", commands(shot), ""]
            for path in pictures(shot, result, docs / IMAGES, quick):
                parts.append(f"![{title}: {path.stem}]({path.relative_to(docs).as_posix()})\n")
        pages(Path(work), docs / IMAGES)
        scene, options = FILM
        run("render", str(Path(work) / f"{scene}.nc"), "--movie", str(docs / IMAGES / f"{scene}.gif"), *options)
        (docs / "gallery.md").write_text("\n".join(parts), encoding="utf8")
        print(f"wrote {docs / 'gallery.md'}")


if __name__ == "__main__":
    main()
