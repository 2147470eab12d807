"""Draw the rooms of the program from its imports, and list them: docs/architecture.md and its picture.

A room is a folder with an ``__init__``, or a file beside such folders. An arrow points from a room to
one that it imports; an import that other arrows imply is not drawn. What ``application.py`` names as text, to be
loaded when it is needed, counts as imported. With --check nothing is written: the command fails if the page or the
picture differs from the imports.
"""

from __future__ import annotations

import argparse
import ast
import itertools
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import matplotlib
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch
from matplotlib.path import Path as Curve

from benchmarks import ROOT
from benchmarks.page import between, table
from tautline.view.figures.figure import COLOURS, QUIET, SHADE, Figure, styled

PAGE = ROOT / "docs" / "architecture.md"
PICTURE = ROOT / "docs" / "images" / "architecture.svg"
BEGIN, END = "<!-- rooms: begin -->\n", "<!-- rooms: end -->"
SOURCES = {"tautline": "core", "drillstring": "apps", "crane": "apps", "gardenhose": "apps"}
PANELS = (("drillstring", "crane", "gardenhose"), ("tautline", "tautline.cable"))
"""What is drawn beside what, from the top; each panel shows the rooms that stand directly in a package."""

SMALL = ("tautline.interruption", "tautline.threads", "tautline.version")
"""Files that any room may import; not drawn."""

PARTS = (ast.stmt, ast.excepthandler, ast.match_case)
"""What statements are made of; imports are among them."""

Edges = dict[str, set[str]]


class Panel(NamedTuple):
    """The rooms of a package, the imports between them, and the rooms outside that they import."""

    package: str
    edges: Edges
    outside: set[str]


def modules() -> dict[str, Path]:
    """All modules of the program: dotted name -> file."""
    found = {}
    for package, source in SOURCES.items():
        for file in sorted((ROOT / source / package).rglob("*.py")):
            parts = file.relative_to(ROOT / source).with_suffix("").parts
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = file
    return found


def imported(name: str, file: Path, known: dict[str, Path]) -> Iterator[str]:
    """Modules of ours that a module imports, deferred imports and names in text included."""
    for node in _nodes(ast.parse(file.read_text(encoding="utf8")), with_texts=file.name == "application.py"):
        if isinstance(node, ast.Import):
            given = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            given = [f"{node.module}.{alias.name}" for alias in node.names] + [node.module]
            given = [next((one for one in (full, node.module) if one in known), "") for full in given[:-1]]
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            given = [f"{name.rpartition('.')[0]}.{node.value}", node.value]
        else:
            continue
        yield from (one for one in given if one in known)


def _nodes(tree: ast.AST, with_texts: bool) -> Iterator[ast.AST]:
    """Nodes of a file: statements alone, in a tenth of the time, where texts in its expressions are not asked for."""
    waiting = [tree]
    while waiting:
        node = waiting.pop()
        yield node
        parts = ast.iter_child_nodes(node)
        waiting += parts if with_texts else [one for one in parts if isinstance(one, PARTS)]


def room_of(name: str, package: str) -> str:
    """The room of a module among those that stand directly in a package; the package itself for its ``__init__``."""
    rest = name.removeprefix(package).lstrip(".")
    return f"{package}.{rest.split('.')[0]}" if rest else package


def inside(name: str, package: str) -> bool:
    """Whether a module belongs to a package."""
    return name == package or name.startswith(f"{package}.")


def panels() -> list[Panel]:
    """What the picture shows."""
    known = modules()
    imports = {name: set(imported(name, file, known)) for name, file in known.items()}
    return [_panel(package, imports) for row in PANELS for package in row]


def _panel(package: str, imports: dict[str, set[str]]) -> Panel:
    edges: Edges = {}
    outside: set[str] = set()
    for name, targets in imports.items():
        if not inside(name, package) or name == package:
            continue
        room = room_of(name, package)
        for target in targets:
            if inside(target, package):
                if target != package and room_of(target, package) != room:
                    edges.setdefault(room, set()).add(room_of(target, package))
            elif target != "tautline" and inside(target, "tautline"):
                outside.add(room_of(target, "tautline"))
    drawn = {room_of(name, package) for name in imports if inside(name, package) and name != package} - set(SMALL)
    joined = {room for room in drawn if edges.get(room) or any(room in targets for targets in edges.values())}
    return Panel(package, reduced({room: edges.get(room, set()) & joined for room in sorted(joined)}), outside)


def reach(edges: Edges, start: str) -> set[str]:
    """All rooms that a room imports, by way of others too."""
    seen: set[str] = set()
    todo = list(edges.get(start, ()))
    while todo:
        room = todo.pop()
        if room not in seen:
            seen.add(room)
            todo += edges.get(room, ())
    return seen


def reduced(edges: Edges) -> Edges:
    """The imports without those that others imply; raises SystemExit where rooms import each other in a circle."""
    for room in edges:
        if room in reach(edges, room):
            sys.exit(f"{room} imports itself by way of others: the rooms must not import in a circle")
    return {
        room: {one for one in targets if not any(one in reach(edges, other) for other in targets - {one})}
        for room, targets in edges.items()
    }


# The picture -----------------------------------------------------------------------------------------------------

WIDE, HIGH, GAP, UP = 0.098, 0.32, 0.22, 0.62
"""Inches: a letter, a box, between boxes, and from one layer to the next."""
THIN = 0.12
"""Width that an arrow is given where it passes a layer."""
MARGIN, HEADING = 0.25, 0.36


class Layout:
    """Where the rooms of a panel stand, inches from its lower left corner; ``None`` rooms are where an arrow passes."""

    def __init__(self, panel: Panel) -> None:
        self.panel, edges = panel, panel.edges
        self.layer: dict[str, int] = {}
        for room in edges:
            self._depth(room)
        self.rows: list[list[str]] = [[] for _ in range(1 + max(self.layer.values()))]
        for room in edges:
            self.rows[self.layer[room]].append(room)
        self.routes = {(a, b): self._route(a, b) for a in edges for b in sorted(edges[a])}
        self._order()
        inner = max(self._width(row) for row in self.rows)
        self.width, self.height = inner + 2 * MARGIN, len(self.rows) * UP - (UP - HIGH) + 2 * MARGIN + HEADING
        self.place = {room: xy for row in self.rows for room, xy in self._places(row, inner)}

    def _depth(self, room: str) -> int:
        if room not in self.layer:
            self.layer[room] = 1 + max((self._depth(one) for one in self.panel.edges[room]), default=-1)
        return self.layer[room]

    def _route(self, above: str, below: str) -> list[str]:
        """The arrow's points: both rooms, and one in each layer between them."""
        between_them = [f"|{above}|{below}|{i}" for i in range(self.layer[above] - 1, self.layer[below], -1)]
        for i, point in zip(range(self.layer[above] - 1, self.layer[below], -1), between_them, strict=True):
            self.rows[i].append(point)
        return [above, *between_them, below]

    def _order(self) -> None:
        """Order each layer by the mean place of its neighbours, so that few arrows cross."""
        beside: dict[str, list[str]] = {}
        for route in self.routes.values():
            for a, b in itertools.pairwise(route):
                beside.setdefault(a, []).append(b)
                beside.setdefault(b, []).append(a)
        best, fewest = [list(row) for row in self.rows], self._crossings()
        for _ in range(24):
            for sweep in (self.rows, self.rows[::-1]):
                for row in sweep:
                    share = {one: (i + 0.5) / len(some) for some in self.rows for i, one in enumerate(some)}
                    mean = {o: sum(share[n] for n in beside.get(o, [o])) / len(beside.get(o, [o])) for o in row}
                    row.sort(key=lambda one, mean=mean: (mean[one], one))
                if self._crossings() < fewest:
                    best, fewest = [list(row) for row in self.rows], self._crossings()
        self.rows = best

    def _crossings(self) -> int:
        at = {one: i for row in self.rows for i, one in enumerate(row)}
        layer = {one: k for k, row in enumerate(self.rows) for one in row}
        pieces = [pair for route in self.routes.values() for pair in itertools.pairwise(route)]
        return sum(
            layer[a] == layer[c] and (at[a] - at[c]) * (at[b] - at[d]) < 0
            for i, (a, b) in enumerate(pieces)
            for c, d in pieces[:i]
        )

    @staticmethod
    def size(room: str) -> float:
        """Width of a box, inches."""
        return THIN if room.startswith("|") else WIDE * len(room.split(".")[-1]) + 0.25

    def _width(self, row: list[str]) -> float:
        return sum(self.size(room) for room in row) + GAP * (len(row) - 1)

    def _places(self, row: list[str], inner: float) -> Iterator[tuple[str, tuple[float, float]]]:
        """Middles of the boxes of a layer; what room is left is shared out between them."""
        spare = (inner - self._width(row)) / (len(row) + 1)
        x = MARGIN + spare
        for room in row:
            y = MARGIN + 0.5 * HIGH + UP * next(i for i, some in enumerate(self.rows) if some is row)
            yield room, (x + 0.5 * self.size(room), y)
            x += self.size(room) + GAP + spare


@styled
def draw() -> Figure:
    """The picture."""
    shown = {panel.package: Layout(panel) for panel in panels()}
    widths = [sum(shown[p].width for p in row) + MARGIN * (len(row) + 1) for row in PANELS]
    heights = [max(shown[p].height for p in row) for row in PANELS]
    width, height = max(widths), sum(heights) + MARGIN * (len(PANELS) + 1)
    figure = Figure(figsize=(width, height))
    plot = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    plot.set(xlim=(0.0, width), ylim=(0.0, height))
    plot.axis("off")
    top = height
    for row, high in zip(PANELS, heights, strict=True):
        top -= high + MARGIN
        spare = (width - sum(shown[p].width for p in row)) / (len(row) + 1)
        x = spare
        for package in row:
            _draw_panel(plot, shown[package], x, top, high)
            x += shown[package].width + spare
    return figure


def _draw_panel(plot, layout: Layout, left: float, bottom: float, high: float) -> None:
    package, outside = layout.panel.package, layout.panel.outside
    frame = FancyBboxPatch(
        (left, bottom), layout.width, high, boxstyle="round,pad=0,rounding_size=0.1", facecolor="white", edgecolor=QUIET
    )
    plot.add_patch(frame)
    plot.text(left + 0.15, bottom + high - 0.24, package, fontsize=12, weight="bold", va="center")
    core = sorted(room.split(".")[-1] for room in outside)
    if core and package != "tautline.cable":
        plot.text(left + layout.width - 0.15, bottom + high - 0.24, "stands on tautline", va="center", ha="right",
                  fontsize=8.5, color="#666666")  # fmt: skip
    lift = bottom + high - layout.height
    at = {room: (left + x, lift + y) for room, (x, y) in layout.place.items()}
    for (above, below), route in layout.routes.items():
        _draw_arrow(plot, [at[room] for room in route], f"{above}->{below}")
    for room in layout.panel.edges:
        wide, (x, y) = layout.size(room), at[room]
        box = FancyBboxPatch(
            (x - 0.5 * wide, y - 0.5 * HIGH), wide, HIGH, boxstyle="round,pad=0,rounding_size=0.06",
            facecolor=SHADE, edgecolor="#666666", zorder=3, gid=room,
        )  # fmt: skip
        plot.add_patch(box)
        plot.text(x, y, room.split(".")[-1], ha="center", va="center_baseline", fontsize=10, zorder=4)


def _draw_arrow(plot, points: list[tuple[float, float]], name: str) -> None:
    """A curve that leaves and enters layers upright."""
    points = [(points[0][0], points[0][1] - 0.5 * HIGH), *points[1:-1], (points[-1][0], points[-1][1] + 0.5 * HIGH)]
    corners, codes = [points[0]], [Curve.MOVETO]
    for (x, y), (u, v) in itertools.pairwise(points):
        corners += [(x, 0.5 * (y + v)), (u, 0.5 * (y + v)), (u, v)]
        codes += [Curve.CURVE4] * 3
    plot.add_patch(
        FancyArrowPatch(
            path=Curve(corners, codes), arrowstyle="-|>", mutation_scale=9, linewidth=1.0, shrinkA=0, shrinkB=0,
            color=COLOURS[0], zorder=2, gid=name, capstyle="butt",
        )
    )  # fmt: skip


# The page --------------------------------------------------------------------------------------------------------


def rooms() -> str:
    """The table of the page: each folder and the first sentence of its docstring, the program's own first."""
    known = modules()
    folders = [name for name, file in known.items() if file.name == "__init__.py" and name not in SOURCES]
    rows = [(f"`{_folder(name)}`", _sentence(known[name])) for name in folders]
    return table(("folder", "what is in it"), rows)


def _folder(name: str) -> str:
    return "/".join((SOURCES[name.split(".")[0]], *name.split(".")))


def _sentence(file: Path) -> str:
    text = " ".join((ast.get_docstring(ast.parse(file.read_text(encoding="utf8"))) or "").split("\n\n")[0].split())
    if not text:
        sys.exit(f"{file}: the room says nothing of what is in it: give it a docstring")
    return text.replace(":mod:", "")


def drawn_names() -> set[str]:
    """Rooms and arrows that the picture must have."""
    return {name for panel in panels() for a, some in panel.edges.items() for name in (a, *(f"{a}->{b}" for b in some))}


def names_in(svg: str) -> set[str]:
    """Rooms and arrows that a picture has."""
    ids = re.findall(r'<g id="([^"]+)"', svg)
    return {name.replace("&gt;", ">") for name in ids if name.split(".")[0] in SOURCES}


def differences() -> list[str]:
    """How page and picture differ from the imports."""
    found = []
    drawn, wanted = names_in(PICTURE.read_text(encoding="utf8")), drawn_names()
    found += [f"{PICTURE.name} shows {name}, which is not so" for name in sorted(drawn - wanted)]
    found += [f"{PICTURE.name} does not show {name}" for name in sorted(wanted - drawn)]
    if BEGIN + rooms() + END not in PAGE.read_text(encoding="utf8"):
        found.append(f"the table of {PAGE.name} is not that of the folders")
    return found


def write() -> None:
    """Write the picture and the table of the page."""
    with matplotlib.rc_context({"svg.hashsalt": "tautline", "svg.fonttype": "none"}):
        draw().savefig(PICTURE, format="svg", metadata={"Date": None, "Creator": None})
    text = re.sub(r"[ \t]+$", "", PICTURE.read_text(encoding="utf8"), flags=re.MULTILINE)
    PICTURE.write_text(text, encoding="utf8")
    PAGE.write_text(between(PAGE.read_text(encoding="utf8"), BEGIN + rooms() + END, BEGIN, END), encoding="utf8")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="write nothing; fail if page or picture is not up to date")
    if not parser.parse_args().check:
        write()
        print(f"wrote {PICTURE} and the table of {PAGE}")
    elif found := differences():
        sys.exit("\n".join([*found, "run `python -m benchmarks.pages.architecture`"]))


if __name__ == "__main__":
    main()
