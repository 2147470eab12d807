"""The verb ``campbell``: natural frequencies against rotary speed. What it prints with ``--json`` is a contract."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tautline.cli.options.places import file_named
from tautline.cli.output.findings import figure_place, say_sentences, write_figure, write_table
from tautline.cli.output.scene_warnings import print_warnings, warning_records, warnings_without_a_run
from tautline.cli.run import searched
from tautline.cli.verbs import Changes, Json, Picture, Scene
from tautline.scene.errors import SceneWarning, option_error
from tautline.scene.values.units import RPM

if TYPE_CHECKING:
    from drillstring.modes.campbell import Campbell
    from drillstring.scene.scene import DrillstringScene
    from tautline.results.tables.finding import Finding

USUAL_SPEEDS, USUAL_ORDERS = (0.0, 200.0), (1.0, 2.0, 3.0)
"""Rotary speeds, rpm, and multiples of them where none are given."""
MOST_ORDERS, HIGHEST_ORDER, MOST_BLADES = 12, 100.0, 30
OF_BUCKLING = "modes"
"""Where a warning of modes that grow stands."""
FASTEST, HIGHEST = 1000.0, 200.0
"""Largest rotary speed, rpm, and frequency, Hz, that are taken."""

Speeds = Annotated[
    str | None,
    typer.Option(
        "--speed", metavar="FROM:TO", help="Rotary speeds, rpm or with a unit. [dim]\\[default: 0:200][/]",
    ),
]  # fmt: skip
Modes = Annotated[
    str | None,
    typer.Option("--modes", metavar="A,B,C", help="lateral, torsional, axial. [dim]\\[default: lateral][/]"),
]
Orders = Annotated[
    str | None,
    typer.Option(
        "--orders", metavar="A,B,C", help="Multiples of the rotary speed that excite. [dim]\\[default: 1,2,3][/]"
    ),
]
Blades = Annotated[
    int | None,
    typer.Option("--blades", min=1, max=MOST_BLADES, help="Blades of the bit: one more multiple.", show_default=False),
]
UpTo = Annotated[
    str | None,
    typer.Option(
        "--up-to", metavar="HZ", help="Highest frequency. [dim]\\[default: 3 times the fastest speed][/]"
    ),
]  # fmt: skip
From = Annotated[
    str | None,
    typer.Option(
        "--from", metavar="DEPTH",
        help="Upper end of the lateral modes, m, held there. [dim]\\[default: where the string lies on the wall][/]",
    ),
]  # fmt: skip
Hold = Annotated[
    str | None,
    typer.Option(
        "--hold", metavar="A,B",
        help="Held laterally: names of sections, bit, or none. [dim]\\[default: bit, if weight is on it][/]",
    ),
]  # fmt: skip
Model = Annotated[
    str | None,
    typer.Option(
        "--model", metavar="KIND", help="Model of the string: lumped or ale-ancf. [dim]\\[default: the scene's][/]"
    ),
]
Csv = Annotated[
    Path | None, typer.Option("--csv", metavar="FILE", parser=file_named, help="Write all modes as a table.")
]


def campbell(
    scene: Scene,
    speed: Speeds = None,
    modes: Modes = None,
    orders: Orders = None,
    blades: Blades = None,
    up_to: UpTo = None,
    top: From = None,
    hold: Hold = None,
    model: Model = None,
    output: Picture = None,
    csv: Csv = None,
    changes: Changes = None,
    as_json: Json = False,
) -> None:
    """Find natural frequencies of the assembly between its contact points, and the rotary speeds that excite them."""
    from drillstring.modes.campbell import campbell as compute
    from drillstring.modes.natural_modes import KINDS
    from drillstring.scene.scene import of_kind, read
    from tautline.cli.options.changes import read_changed
    from tautline.cli.options.lists import number, one_of, words
    from tautline.results.output_path import check_table

    drillstring = read_changed(read, scene, changes)
    drillstring = of_kind(drillstring, parse_model(model) or drillstring.model.kind)
    speeds = parse_speeds(speed)
    kinds = tuple(words(modes, "--modes", one_of(KINDS))) or ("lateral",)
    _check_sideways(kinds, {"--from": top, "--hold": hold})
    lines = parse_orders(orders, blades)
    highest = number(up_to, "--up-to", "Hz", HIGHEST, "ask for what the string is shaken at") if up_to else None
    upper = parse_depth(drillstring, top)
    held = parse_held(drillstring, hold)
    figure, table = figure_place(output, f"{scene.stem}_campbell"), check_table(csv, "mode,kind,plane")
    warnings = warnings_without_a_run(drillstring)
    print_warnings(warnings)
    found = searched(scene, as_json, lambda: compute(drillstring, speeds, lines, kinds, highest, upper, held))
    _print(drillstring, found)
    _draw(drillstring, scene, found, figure)
    if table is not None:
        _write(found, table)
    if as_json:
        from drillstring.view.campbell_summary import unstable_told
        from tautline.cli.output.console import print_json

        said = {"scene": str(scene), "status": "done", "figure": str(figure), "csv": None if csv is None else str(csv)}
        seen = [SceneWarning(OF_BUCKLING, text) for text in unstable_told(found)]
        print_json(said | report(found) | {"warnings": warning_records([*warnings, *seen])})


def _check_sideways(kinds: tuple[str, ...], asked: dict[str, str | None]) -> None:
    """Refuse what says how the string is held sideways where no lateral modes are asked for."""
    if "lateral" in kinds:
        return
    for option, text in asked.items():
        if text is not None:
            cause = f"is of lateral modes, and {' and '.join(kinds)} ones are asked for"
            raise option_error(option, text, cause, "leave it out, or add lateral to --modes")


def parse_model(text: str | None) -> str | None:
    """The one kind of model that is asked for; raises SceneError with the cure."""
    from drillstring.verbs.form import parse_models

    kinds = parse_models(text)
    if len(kinds) > 1:
        raise option_error(
            "--model", str(text), "are two models, and one diagram shows one", "ask for one after the other"
        )
    return kinds[0] if kinds else None


def parse_speeds(text: str | None) -> tuple[float, float]:
    """Rotary speeds of ``FROM:TO``, bare numbers in rpm, as rad/s; raises SceneError with the cure."""
    if text is None:
        return USUAL_SPEEDS[0] * RPM, USUAL_SPEEDS[1] * RPM
    parts = [part.strip() for part in text.split(":")]
    if len(parts) != 2:
        raise option_error("--speed", text, "needs two numbers, from and to", "write 0:200, or '60 rpm:180 rpm'")
    low, high = (_speed(part, text) for part in parts)
    if not low < high:
        raise option_error(
            "--speed", text, "does not end above where it begins", "write the slower speed first: 60:180"
        )
    if high > FASTEST * RPM * (1.0 + 1e-9):
        raise option_error("--speed", text, f"goes beyond {FASTEST:g} rpm", "take slower speeds")
    return low, high


def _speed(word: str, text: str) -> float:
    from typing import Annotated

    from pydantic import TypeAdapter, ValidationError

    from tautline.scene.values.quantity import quantity

    adapter: Any = TypeAdapter(Annotated[float, quantity("rad/s", nonnegative=True)])
    try:
        plain = float(word)
    except ValueError:
        plain = None
    try:
        return float(adapter.validate_python(word if plain is None else plain * RPM))
    except ValidationError as error:
        cure = "write 0:200 in rpm, or '60 rpm:180 rpm'"
        raise option_error("--speed", text, str(error.errors()[0]["msg"]), cure) from None


def parse_orders(text: str | None, blades: int | None) -> tuple[float, ...]:
    """Multiples of the rotary speed, rising, with the number of blades among them."""
    from tautline.cli.options.lists import words

    def read(word: str) -> Any:
        try:
            value = float(word.removesuffix("x"))
        except ValueError:
            raise ValueError("is no multiple of the rotary speed: write 1,2,3") from None
        if not 0.0 < value <= HIGHEST_ORDER:
            raise ValueError(f"is no multiple of the rotary speed: one lies above 0, and up to {HIGHEST_ORDER:g}")
        return value

    found: list[Any] = words(text, "--orders", read) or list(USUAL_ORDERS)
    found = sorted({*found, *([float(blades)] if blades else [])})
    if len(found) > MOST_ORDERS:
        raise option_error("--orders", str(text), f"are {len(found)} multiples, more than {MOST_ORDERS}", "give fewer")
    return tuple(found)


def parse_depth(scene: DrillstringScene, text: str | None) -> float | None:
    """Measured depth of the upper end, m; it must leave some of the string."""
    if text is None:
        return None
    from drillstring.model.prepared import tubes_of, well_of
    from tautline.cli.options.lists import number

    depth = number(text, "--from", "m")
    length = sum(tube.length for tube in tubes_of(scene, well_of(scene).length))
    if depth >= length - 1e-3:
        raise option_error(
            "--from", text, f"leaves nothing of the string, which is {length:g} m long", "give a lesser depth"
        )
    return depth


def parse_held(scene: DrillstringScene, text: str | None) -> frozenset[str]:
    """Names of what is held sideways; by default the bit where there is weight on it."""
    if text is None:
        return frozenset(["bit"] if scene.bit.load < 0.0 or scene.bit.on_bottom else [])
    if text.strip() == "none":
        return frozenset()
    from tautline.cli.options.lists import one_of, words

    known = list(dict.fromkeys([section.name for section in scene.string] + ["bit"]))
    return frozenset(words(text, "--hold", one_of(known)))


def report(found: Campbell) -> dict[str, Any]:
    """What ``--json`` tells, in SI: Hz, rad/s, m, N."""
    import numpy as np

    return {
        "speed": list(found.speeds),
        "orders": list(found.orders),
        "up_to": found.up_to,
        "part": {"from": found.top, "to": found.bottom},
        "supports": [one._asdict() for one in found.supports],
        "model": found.model,
        "links": found.links,
        "loose": list(found.loose),
        "rock_stiffness": found.rock,
        "modes": [
            {
                "kind": mode.kind,
                "plane": mode.plane,
                "stable": mode.frequency > 0.0,
                "frequency": mode.frequency if mode.frequency > 0.0 else None,
                "error": mode.error if mode.frequency > 0.0 and np.isfinite(mode.error) else None,
                "gyroscopic_split": mode.gyroscopic(found.speeds[1]),
                "rotatory_fall": mode.rotatory,
                "measured_depth": mode.depth,
                "shape": mode.shape,
            }
            for mode in found.modes
        ],
        "critical": [one._asdict() for one in found.critical],
    }


def _print(scene: DrillstringScene, found: Campbell) -> None:
    from drillstring.view.campbell_summary import sentences, table
    from tautline.cli.output.console import console

    if found.modes:
        console().print(table(found, scene.units))
    say_sentences(sentences(found, scene.units))


def _draw(scene: DrillstringScene, path: Path, found: Campbell, figure: Path) -> None:
    from drillstring.view.campbell_figures import campbell_figure

    title = f"{scene.title or path.stem}: Campbell diagram"
    write_figure(campbell_figure(found, title, scene.units), figure)


def _write(found: Campbell, path: Path) -> None:
    from drillstring.view.campbell_summary import header, rows

    write_table(header(found), rows(found), path)


OPTIONS = ("speed", "modes", "orders", "blades", "up-to", "from", "hold", "model")
"""Options that the findings of a sweep can have."""


def read_options(scene: DrillstringScene, options: Mapping[str, Any]) -> tuple[Any, ...]:
    """What `campbell` is to compute in a sweep; raises SceneError naming the option."""
    from drillstring.modes.natural_modes import KINDS
    from drillstring.scene.scene import of_kind
    from tautline.cli.options.lists import number, one_of, words

    text = {name: None if value is None else str(value) for name, value in options.items()}
    blades = options.get("blades")
    if blades is not None and (not isinstance(blades, int) or not 1 <= blades <= MOST_BLADES):
        raise option_error("--blades", str(blades), "is no number of blades", f"give 1 to {MOST_BLADES}")
    kinds = tuple(words(text.get("modes"), "--modes", one_of(KINDS))) or ("lateral",)
    _check_sideways(kinds, {"--from": text.get("from"), "--hold": text.get("hold")})
    highest = text.get("up-to")
    model = parse_model(text.get("model")) or scene.model.kind
    varied = of_kind(scene, model)
    return (
        model, parse_speeds(text.get("speed")), parse_orders(text.get("orders"), blades), kinds,
        number(highest, "--up-to", "Hz", HIGHEST, "ask for what the string is shaken at") if highest else None,
        parse_depth(varied, text.get("from")), parse_held(varied, text.get("hold")),
    )  # fmt: skip


def findings(scene: DrillstringScene, asked: tuple[Any, ...]) -> dict[str, Finding]:
    """Natural frequencies along ``mode``, and the rotary speeds that excite them along ``crossing``, rising."""
    from drillstring.modes.campbell import campbell as compute
    from drillstring.scene.scene import of_kind
    from tautline.results.tables.finding import Finding

    model, *rest = asked
    found = compute(of_kind(scene, model), *rest)
    frequencies = [mode.frequency if mode.frequency > 0.0 else None for mode in found.modes]
    speeds = sorted(one.speed for one in found.critical)
    return {
        "frequency": Finding(frequencies, "Hz", "natural frequency at rest", "mode"),
        "mode": Finding([float(k) for k in range(1, len(frequencies) + 1)], "", "number of the mode", "mode"),
        "first_frequency": Finding(frequencies[0] if frequencies else None, "Hz", "first natural frequency"),
        "critical_speed": Finding(speeds, "rad/s", "rotary speed that excites a mode", "crossing"),
        "crossing": Finding([float(k) for k in range(1, len(speeds) + 1)], "", "number of the crossing", "crossing"),
        "first_critical_speed": Finding(speeds[0] if speeds else None, "rad/s", "lowest of these rotary speeds"),
        "critical_speeds": Finding(len(speeds), "", "rotary speeds that excite a mode"),
    }
