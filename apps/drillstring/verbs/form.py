"""The verb ``form``: form finding. What it prints with ``--json`` is a contract."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tautline.cli.options.places import file_named
from tautline.cli.output.findings import figure_place, write_figure, write_table
from tautline.cli.output.scene_warnings import print_warnings, warning_records, warnings_without_a_run
from tautline.cli.run import searched
from tautline.cli.verbs import Changes, Json, Picture
from tautline.scene.errors import option_error
from tautline.scene.values.systems import length_unit

if TYPE_CHECKING:
    from drillstring.scene.scene import DrillstringScene
    from drillstring.statics.form import Finding, Form
    from tautline.scene.errors import SceneWarning

MOST_MESHES = 20
DECIMALS = 4
"""Of a position in m."""
NOTHING = 1.0e-7
"""Share of the largest tension below which a hook load is what rounding leaves."""

Scenes = Annotated[
    list[Path], typer.Argument(metavar="SCENE...", help="YAML files; several make one report.", show_default=False)
]
By = Annotated[str, typer.Option("--by", metavar="static|relaxation", help="How the string is brought to rest.")]
Elements = Annotated[
    str | None,
    typer.Option(
        "--elements", metavar="N,N,...", help="Elements, between commas: 10,20,50. [dim]\\[default: the scene's][/]"
    ),
]
Models = Annotated[
    str | None,
    typer.Option(
        "--model", metavar="KIND,KIND", help="lumped, ale-ancf, or lumped,ale-ancf. [dim]\\[default: the scene's][/]"
    ),
]
Most = Annotated[
    int | None,
    typer.Option("--most", min=1, help="Steps of the relaxation after which to give up.", show_default=False),
]
Csv = Annotated[
    Path | None,
    typer.Option("--csv", metavar="FILE", parser=file_named, help="Write every lump of every mesh as a table."),
]


def form(
    scenes: Scenes,
    by: By = "static",
    elements: Elements = None,
    model: Models = None,
    most: Most = None,
    output: Picture = None,
    csv: Csv = None,
    changes: Changes = None,
    as_json: Json = False,
) -> None:
    """Find the string's shape at rest, and set the exact extensible rod beside it where there is one."""
    from drillstring.scene.scene import read
    from drillstring.statics.form import find_form
    from tautline.cli.options.changes import read_changed
    from tautline.integrators.statics.relaxation import MOST_STEPS
    from tautline.results.output_path import check_table

    way, meshes, kinds = _way(by, most), parse_elements(elements), parse_models(model)
    read_scenes = [read_changed(read, path, changes) for path in scenes]
    name = f"{scenes[0].stem}_form" if len(scenes) == 1 else "forms"
    figure, table = figure_place(output, name), check_table(csv, "scene,model,elements,node")
    warned = [_warnings(scene, meshes, kinds) for scene in read_scenes]
    for path, warnings in zip(scenes, warned, strict=True):
        print_warnings(warnings, path if len(scenes) > 1 else None)
    found = []
    for path, scene in zip(scenes, read_scenes, strict=True):
        search = partial(find_form, scene, meshes, way, most or MOST_STEPS, kinds)
        found.append(searched(path, as_json, search))
    # One table and one figure have one system of units: the first scene's.
    system = read_scenes[0].units
    _print(scenes, found, system)
    _draw(scenes, found, figure, system)
    if table is not None:
        _write(scenes, found, table)
    if as_json:
        from tautline.cli.output.console import print_json

        said = {"status": "done", "figure": str(figure), "csv": None if table is None else str(table)}
        reports = [
            report(path, one) | {"warnings": warning_records(warnings)}
            for path, one, warnings in zip(scenes, found, warned, strict=True)
        ]
        print_json(reports[0] | said if len(reports) == 1 else {"scenes": reports} | said)


def _warnings(scene: DrillstringScene, elements: list[int], kinds: list[str]) -> list[SceneWarning]:
    """Warnings of a scene, and of the meshes that are computed in place of its own."""
    from drillstring.mesh import ELEMENTS, mesh_warnings
    from drillstring.statics.form import meshes

    found = [one for one in warnings_without_a_run(scene) if one.where != ELEMENTS]
    return found + mesh_warnings(meshes(scene, elements, kinds))


def report(path: Path, found: Finding) -> dict[str, Any]:
    """What ``--json`` tells of a scene: its finest mesh, the rod at the same lumps, and a summary of each mesh."""
    import numpy as np

    finest, reference = found.finest, found.reference
    rod = reference.rod
    exact = None
    if rod is not None:
        s = np.linspace(0.0, rod.length, 2001)
        exact = {
            "hook_load": rod.hook_load,
            "tension_max": float(rod.tension(s).max()),
            "stretch": rod.stretch,
            "end": reference.position(np.array([rod.length]))[0],
            "error": rod.error,
        }
    return {
        "scene": str(path),
        "by": found.by,
        "model": finest.kind,
        "node": list(range(finest.elements + 1)),
        "measured_depth": finest.measured_depth,
        "position": finest.position,
        "reference": None if rod is None else reference.position(finest.unstretched),
        "difference": found.difference(finest),
        "reference_said": reference.said,
        "rod": exact,
        "unstretched_depth": finest.unstretched,
        "meshes": [
            {
                "model": one.kind,
                "elements": one.elements,
                "end": one.position[-1],
                "end_moved": one.moved[-1],
                "offset_max": float(one.offset.max()),
                "difference_max": _largest(found, one),
                "hook_load": one.hook_load,
                "tension_max": one.tension_max,
                "stretch": one.stretch,
                "touching": one.touching,
                "iterations": one.iterations,
                "negative_pivots": None if one.negative < 0 else one.negative,
            }
            for one in found.forms
        ],
    }


def parse_elements(text: str | None) -> list[int]:
    """Numbers of elements of ``10,20,50``, rising and each once; none for None.

    Raises
    ------
    SceneError
        Naming the option, the value, and what would do.
    """
    if text is None:
        return []
    words = [word.strip() for word in text.split(",")]
    if not all(word.isascii() and word.isdigit() and len(word) < 10 and int(word) > 0 for word in words):
        raise option_error("--elements", text, "is no list of numbers of elements", "write 10,20,50")
    counts = sorted({int(word) for word in words})
    if len(counts) > MOST_MESHES:
        raise option_error("--elements", text, f"are {len(counts)} meshes, more than {MOST_MESHES}", "take fewer")
    return counts


def parse_models(text: str | None) -> list[str]:
    """Kinds of model of ``lumped,ale-ancf``, each once; none for None.

    Raises
    ------
    SceneError
        Naming the option, the value, and what would do.
    """
    from drillstring.scene.scene import BEAM, LUMPED

    if text is None:
        return []
    meant = {"lumped": LUMPED, "ale-ancf": BEAM, "ancf": BEAM}
    words = [word.strip().lower().replace("_", "-") for word in text.split(",")]
    for word in words:
        if word not in meant:
            raise option_error(
                "--model", text, f"'{word}' is no kind of model", f"write {LUMPED}, {BEAM} or {LUMPED},{BEAM}"
            )
    return list(dict.fromkeys(meant[word] for word in words))


def _way(by: str, most: int | None) -> str:
    from drillstring.statics.form import WAYS

    if by not in WAYS:
        raise option_error("--by", by, "is no method of finding rest", "write static or relaxation")
    if most is not None and by == "static":
        cause = "is given without --by relaxation: the static solver takes no steps"
        raise option_error("--most", str(most), cause, "leave it out, or add --by relaxation")
    return by


def _largest(found: Finding, one: Form) -> float | None:
    difference = found.difference(one)
    return None if difference is None else float(difference.max())


def _print(scenes: list[Path], found: list[Finding], system: str) -> None:
    from rich.table import Table
    from rich.text import Text

    from tautline.cli.commands.study import show
    from tautline.cli.output.console import say

    table = Table(box=None, padding=(0, 2, 0, 0))
    table.add_column("scene")
    spent = "steps" if found[0].by == "relaxation" else "iterations"
    names = (
        "model",
        "n",
        f"end north, east, down [{length_unit(system)[1]}]",
        f"end moved [{length_unit(system)[1]}]",
        "off axis",
        "off the rod",
        "hook load",
        "largest tension",
    )
    for name in (*names, "stretch", spent):
        table.add_column(Text(name), justify="right")
    for path, one in zip(scenes, found, strict=True):
        for number, form_ in enumerate(one.forms):
            table.add_row(path.stem if number == 0 else "", *_row(one, form_, system))
        if one.reference.rod is not None:
            table.add_row("", *_exact_row(one, system))
    show(table)
    for path, one in zip(scenes, found, strict=True):
        rod = one.reference.rod
        error = f", to {rod.error:.0e} m" if rod is not None and rod.error > 0.0 else ""
        doubtful = rod is None or "may" in one.reference.said
        say(f"{path.stem}: {one.reference.said}{error}", "yellow" if doubtful else "")
        if touching := one.finest.touching:
            parts = "lumps" if one.finest.kind == "lumped" else "nodes"
            say(f"{path.stem}: {touching} of the {one.finest.elements + 1} {parts} lie on the wall", "yellow")
        for form_ in one.forms:
            if form_.negative > 0:
                text = (
                    f"{path.stem}, {form_.elements} elements: this shape is unstable. The string is pressed beyond its "
                    "buckling load. The least push moves it aside"
                )
                say(text, "yellow")


def _place(place: Any, system: str) -> str:
    # Rounding makes -0.0000 of what is nothing.
    length, _ = length_unit(system)
    return ", ".join(f"{round(float(x) / length, DECIMALS) + 0.0:.{DECIMALS}f}" for x in place)


def _length(value: float, system: str) -> str:
    from tautline.scene.values.printed import significant

    length, name = length_unit(system)
    return f"{significant(value / length, 5)} {name}"


def _hook(load: float, tension: Any) -> float:
    """A hook load, or zero where it is rounding."""
    return 0.0 if abs(load) < NOTHING * float(abs(tension).max()) else load


def _row(found: Finding, one: Form, system: str) -> list[str]:
    import numpy as np

    from tautline.scene.values.printed import shown

    largest = _largest(found, one)
    off = "–" if largest is None else shown(largest, "m", system)
    numbers = (_hook(one.hook_load, one.tension), "N"), (one.tension_max, "N"), (one.stretch, "m")
    moved = _place([np.linalg.norm(one.moved[-1])], system)
    written = [shown(value, unit, system) for value, unit in numbers]
    return [
        one.kind, str(one.elements), _place(one.position[-1], system), moved,
        _length(float(one.offset.max()), system), off, *written, str(one.iterations),
    ]  # fmt: skip


def _exact_row(found: Finding, system: str) -> list[str]:
    import numpy as np

    from tautline.scene.values.printed import shown

    reference, finest = found.reference, found.finest
    rod = reference.rod
    assert rod is not None
    s = np.linspace(0.0, rod.length, 2001)
    end = reference.position(s[-1:])[0]
    moved = float(np.linalg.norm(end - finest.position[-1] + finest.moved[-1]))
    off = _length(float(np.abs(rod.locate(s)[1]).max()), system)
    tension = rod.tension(s)
    numbers = (_hook(rod.hook_load, tension), "N"), (float(tension.max()), "N"), (rod.stretch, "m")
    written = [shown(value, unit, system) for value, unit in numbers]
    return ["rod", "", _place(end, system), _place([moved], system), off, "", *written, ""]


def _draw(scenes: list[Path], found: list[Finding], path: Path, system: str) -> None:
    from drillstring.view.form_figures import form_figure
    from tautline.view.figures.unit_axes import use_units

    titles = [one.title or scene.stem for scene, one in zip(scenes, found, strict=True)]
    figure = form_figure(titles, found)
    use_units(figure, system)
    write_figure(figure, path)


def _write(scenes: list[Path], found: list[Finding], path: Path) -> None:
    """A row for each lump of each mesh of each scene; where there is no rod its cells are empty."""
    header = [
        "scene",
        "model",
        "elements",
        "node",
        "unstretched depth [m]",
        "measured depth [m]",
        "north [m]",
        "east [m]",
    ]
    header += ["down [m]", "rod north [m]", "rod east [m]", "rod down [m]", "difference [m]", "tension below [N]"]
    pairs = zip(scenes, found, strict=True)
    rows = (row for scene, one in pairs for form_ in one.forms for row in _rows(scene, one, form_))
    write_table(header, rows, path)


def _rows(scene: Path, found: Finding, one: Form) -> list[list[Any]]:
    difference = found.difference(one)
    exact = None if difference is None else found.reference.position(one.unstretched).tolist()
    rows = []
    for i in range(one.elements + 1):
        row: list[Any] = [
            scene.stem,
            one.kind,
            one.elements,
            i,
            float(one.unstretched[i]),
            float(one.measured_depth[i]),
        ]
        row += one.position[i].tolist()
        row += ["", "", "", ""] if exact is None or difference is None else [*exact[i], float(difference[i])]
        rows.append([*row, float(one.tension[i]) if i < one.elements else ""])
    return rows
