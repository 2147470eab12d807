"""The verbs that only hoses have: ``static`` and ``flutter``. What they print with ``--json`` is a contract."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tautline.cli.output.findings import figure_place, write_figure
from tautline.cli.output.scene_warnings import print_warnings, warning_records, warnings_without_a_run
from tautline.cli.run import searched
from tautline.cli.verbs import Changes, Json, Picture, Scene
from tautline.scene.errors import option_error

if TYPE_CHECKING:
    from gardenhose.scene import HoseScene
    from gardenhose.stability import Critical, Stability, Way, Window
    from gardenhose.static import Form
    from tautline.results.tables.finding import Finding
    from tautline.scene.errors import SceneWarning

DEFAULT_SPEEDS = 7
"""Speeds of form finding from rest to the scene's fastest flow, where none are given."""
MOST_SPEEDS = 10_000
MANY = 100
"""Elements from which a search for the critical speed takes so long that it is said."""
NO_SPEED = 1.0e-4
"""Flow speed, m/s, other than 0, below which a hose becomes unstable at no speed that is worth a number."""
SPEEDS_HELP = "Flow speeds, in m/s or with a unit: 0:40:10 or '0 ft/s:40 ft/s:10 ft/s'."
STATIC_HELP = f"{SPEEDS_HELP} [dim]\\[default: from 0 to the scene's fastest][/]"

StaticSpeeds = Annotated[str | None, typer.Option("--speed", metavar="FROM:TO:STEP|A,B,C", help=STATIC_HELP)]
FlutterSpeeds = Annotated[
    str | None,
    typer.Option(
        "--speed",
        metavar="FROM:TO:STEP|A,B,C",
        help=f"{SPEEDS_HELP} [dim]\\[default: past the first instability][/]",
    ),
]
AS_FINE = (
    "A narrower range of --speed about it, with a smaller step, may tell. Where two modes meet, no step does: a hose "
    "without damping begins to flutter so"
)
"""What is said where modes are not told apart at speeds as near as any that are looked at in a range as wide."""
NEGATIVE_PIVOTS = "negative pivots of the tangent: 0 is stable, none where it is not judged"
USUAL_MODES, MOST_MODES = 8, 100
Modes = Annotated[int, typer.Option("--modes", min=1, max=MOST_MODES, help="Modes to follow, besides those that grow.")]


def static(
    scene: Scene,
    speed: StaticSpeeds = None,
    output: Picture = None,
    changes: Changes = None,
    as_json: Json = False,
) -> None:
    """Find the shape at rest at each flow speed, and draw them."""
    from gardenhose.scene import read
    from gardenhose.static import forms
    from tautline.cli.options.changes import read_changed

    hose = read_changed(read, scene, changes)
    speeds = parse_speeds(speed) if speed is not None else _up_to_fastest(hose)
    figure = figure_place(output, f"{scene.stem}_static")
    of_scene = warnings_without_a_run(hose)
    print_warnings(of_scene)
    found = searched(scene, as_json, lambda: forms(hose, speeds))
    negative = [one.negative for one in found]
    _print_forms(found, hose)
    _warn_of_unstable(hose, found, negative)
    warnings = _of_shapes(hose, found, negative)
    print_warnings(warnings)
    _draw_forms(hose, found, figure)
    if as_json:
        from tautline.cli.output.console import print_json

        tips = [one.tip for one in found]
        pivots = [None if count < 0 else count for count in negative]
        report = {"scene": str(scene), "status": "done", "figure": str(figure)}
        print_json(
            report
            | {"speed": [one.speed for one in found], "tip": tips, "negative_pivots": pivots}
            | {"sag": [one.sag[0] for one in found], "position": [one.position for one in found]}
            | {"warnings": warning_records([*of_scene, *warnings])}
        )


def flutter(
    scene: Scene,
    speed: FlutterSpeeds = None,
    modes: Modes = USUAL_MODES,
    output: Picture = None,
    changes: Changes = None,
    as_json: Json = False,
) -> None:
    """Find where the hose becomes unstable: eigenvalues against flow speed, critical speed and frequency."""
    from gardenhose.flutter import stability
    from gardenhose.scene import read
    from tautline.cli.options.changes import read_changed

    hose = read_changed(read, scene, changes)
    speeds = parse_speeds(speed) if speed is not None else None
    figure = figure_place(output, f"{scene.stem}_flutter")
    of_scene = warnings_without_a_run(hose)
    print_warnings(of_scene)
    if speeds is None and hose.water is not None and hose.hose.element_count >= MANY:
        from tautline.cli.output.console import say

        say(
            f"searching without --speed: eigenvalues of {hose.hose.element_count} elements at some sixty speeds. "
            "This may take minutes"
        )
    found = searched(scene, as_json, lambda: stability(hose, speeds, modes))
    _print_stability(found, hose.units)
    warnings = [
        *_of_speeds(hose, found, speeds),
        *_between(found, speeds, hose.units),
        *_uncertain_curves(found, hose.units),
    ]
    print_warnings(warnings)
    _draw_stability(hose, found, figure)
    if as_json:
        from tautline.cli.output.console import print_json

        first = found.critical[0] if found.critical else None
        print_json(
            {
                "scene": str(scene),
                "status": "done",
                "figure": str(figure),
                "critical_speed": first.speed if first else None,
                "critical_frequency": first.frequency if first else None,
                "plane": first.plane if first else None,
                "kind": first.kind if first else None,
                "critical": [one._asdict() for one in found.critical],
                "stable_from": found.stable_from,
                "windows": _windows_in_json(found.windows),
                "ways": [_way_in_json(way) for way in found.ways],
                "resolution": found.resolution,
                "direction": _flow_direction(found),
                "warnings": warning_records([*of_scene, *warnings]),
                "speed": found.speed,
                "eigenvalues": [[[x.real, x.imag] for x in row] for row in found.eigenvalues.tolist()],
                "out_of_plane": found.out_of_plane,
                "doubtful": [dict(zip(("mode", "from", "to"), one, strict=True)) for one in _doubtful(found)],
                "unstable": found.grows.tolist(),
                "unstable_at": found.unstable_at,
                # Without end where nothing flows in waves: null, as JSON has no infinity.
                "fine_up_to": found.fine_up_to if math.isfinite(found.fine_up_to) else None,
            }
        )


def parse_speeds(text: str) -> list[float]:
    """Speeds of ``FROM:TO:STEP`` with both ends, or of ``A,B,C``: bare numbers in m/s, or with units; m/s.

    They go one way, upwards where they were typed as neither rising nor falling: a shape is sought from the one before.

    Raises
    ------
    SceneError
        Naming the option, the value, and what would do.
    """
    from typing import Annotated

    from pydantic import TypeAdapter, ValidationError

    from tautline.cli.options.lists import stepped, three_of
    from tautline.scene.values.quantity import as_in_a_file, quantity

    refuse = partial(option_error, "--speed", text)

    example = "write 0:12:3 or 0,3,6,9,12 in m/s, or '0 ft/s:40 ft/s:10 ft/s'"
    given = [as_in_a_file(part.strip()) for part in text.split(":" if ":" in text else ",")]
    if any(isinstance(one, float) and not math.isfinite(one) for one in given):
        raise refuse("holds what is not a finite number", example)
    adapter: Any = TypeAdapter(list[Annotated[float, quantity("m/s")]])
    try:
        numbers = adapter.validate_python(given)
    except ValidationError as error:
        wrong = error.errors()[0]
        said = str(wrong["msg"])
        said = said if said.startswith("'") else f"'{given[int(wrong['loc'][0])]}' {said}"
        raise refuse(f"is no range of speeds: {said}", example) from None
    bare = [one for one in given if isinstance(one, float) and one != 0.0]
    if bare and any(isinstance(one, str) for one in given):
        raise refuse(f"has units, and {bare[0]:g} has none", f"give each its unit; {example}")
    if ":" not in text:
        rising = sorted(numbers)
        return numbers if numbers == rising[::-1] else rising
    three_of(text, "--speed", example)
    first, last, step = numbers
    if (last - first) * step < 0.0:
        raise refuse("never gets to its end by such a step", example)
    return stepped((first, last, step), text, "--speed", MOST_SPEEDS, "speeds")


def _up_to_fastest(hose: HoseScene) -> list[float]:
    import numpy as np

    from gardenhose.estimates import speeds

    sampled = speeds(hose)
    fastest = float(sampled[np.argmax(np.abs(sampled))])
    return [0.0] if fastest == 0.0 else np.linspace(0.0, fastest, DEFAULT_SPEEDS).tolist()


def _print_forms(found: list[Form], hose: HoseScene) -> None:
    from rich.markup import escape
    from rich.table import Table

    from tautline.cli.output.console import console
    from tautline.scene.values.systems import in_system

    # All in one unit, that of a metre: columns with feet and inches could not be compared.
    per_length, length = in_system(1.0, "m", hose.units)
    per_speed, rate = in_system(1.0, "m/s", hose.units)
    table = Table(box=None, padding=(0, 2, 0, 0))
    # The tip of a hose that is held there is a support.
    free = hose.hose.end == "free"
    names = [f"tip {axis} [{length}]" for axis in "xyz"] if free else [f"sag [{length}]", "at node"]
    for name in (f"flow [{rate}]", *names):
        table.add_column(escape(name), justify="right")
    for one in found:
        numbers = one.tip if free else one.sag[:1]
        words = [f"{round(per_length * x, 6) + 0.0:.6f}" for x in numbers] + ([] if free else [str(one.sag[1] + 1)])
        table.add_row(f"{per_speed * one.speed:g}", *words)
    console().print(table)


def _warn_of_unstable(hose: HoseScene, found: list[Form], negative: list[int]) -> None:
    from gardenhose.static import stable_beside
    from tautline.cli.output.console import say
    from tautline.scene.values.printed import shown

    for one, count in zip(found, negative, strict=True):
        if count > 0:
            pivots = "one negative pivot" if count == 1 else f"{count} negative pivots"
            text = f"the shape at {shown(one.speed, 'm/s', hose.units)} is unstable: the tangent has {pivots}"
            text += ". The least push moves it away"
            beside = stable_beside(hose, one)
            if beside is not None:
                sag, node = beside.sag
                text += f". Another shape is stable. Its sag is {shown(sag, 'm', hose.units)}, at node {node + 1}"
            say(text, "yellow")


def _of_shapes(hose: HoseScene, found: list[Form], negative: list[int]) -> list[SceneWarning]:
    """Say of shapes at rest where the water is too fast for the hose or its elements, and what is not judged."""
    from gardenhose.cables import arc_lengths
    from gardenhose.static import stretched_at_rest
    from gardenhose.warnings import aspiration_at, mesh_at, momentum_at
    from tautline.scene.errors import SceneWarning

    speeds = [one.speed for one in found]
    stretched = stretched_at_rest(arc_lengths(hose), found, hose.units)
    warnings = [*momentum_at(hose, speeds), *stretched, *mesh_at(hose, speeds), *aspiration_at(hose, speeds)]
    if hose.hose.end == "free" and any(count < 0 and speed for count, speed in zip(negative, speeds, strict=True)):
        text = (
            "whether the shapes are stable is not judged: water flows from a free end, and the hose may flutter about "
            "a shape at rest; `gardenhose flutter` finds the speed from which it does"
        )
        warnings.append(SceneWarning("hose.end", text))
    return warnings


def _draw_forms(hose: HoseScene, found: list[Form], path: Path) -> None:
    import numpy as np

    from gardenhose.cables import arc_lengths
    from gardenhose.view.figures import static_figure

    s = arc_lengths(hose)
    curves, tips = [one.curve(s) for one in found], np.array([one.tip for one in found])
    title = f"{hose.title or path.stem}: shapes at rest"
    write_figure(static_figure(np.array([one.speed for one in found]), curves, tips, title, hose.units), path)


def words_of(critical: Critical, system: str = "si") -> str:
    """A critical speed in words, in the units of a system."""
    from tautline.scene.values.printed import shown

    where = {"in": " in the plane", "out": " out of the plane", "any": ""}[critical.plane]
    how = "diverges" if critical.kind == "divergence" else f"flutters at {critical.frequency:.4g} Hz"
    slow = 0.0 < abs(critical.speed) < NO_SPEED
    return f"{how}{where} from {'almost no speed' if slow else shown(critical.speed, 'm/s', system, 6)}"


def _print_stability(found: Stability, system: str) -> None:
    from tautline.cli.output.console import say

    for way in found.ways:
        if len(found.ways) > 1:
            which = " (negative speeds)" if way.sign < 0.0 else ""
            say(f"the water flows from the {way.direction.replace(' to ', ' to the ')}{which}:")
        elif way.sign < 0.0:
            say("negative speeds: the water flows from the tip to the root")
        _print_way(way, found, system)


def _print_way(way: Way, found: Stability, system: str) -> None:
    """Say what becomes unstable, and where it is not, as the water goes faster one way."""
    from tautline.cli.output.console import say
    from tautline.scene.values.printed import shown

    def speed_in_words(speed: float, digits: int = 4) -> str:
        return shown(float(speed), "m/s", system, digits)

    if not way.critical and way.stable_from is None:
        say(_nothing_found(way, found, system), "yellow")
        _hint_below(way, speed_in_words)
        return
    at_once = [one for one in way.critical if one.speed == way.slowest]
    for critical in at_once:
        say(f"the hose {words_of(critical, system)}", "yellow")
    if way.stable_from is not None:
        begin = "it" if at_once else f"the hose is unstable at {speed_in_words(way.slowest)}; it"
        beyond = [one.begin for one in way.windows if abs(one.begin) > abs(way.stable_from)]
        until = f" to {speed_in_words(min(beyond, key=abs), 6)}" if beyond else ""
        until += ", by elements that are too coarse" if abs(way.stable_from) > found.fine_up_to else ""
        say(f"{begin} is stable from {speed_in_words(way.stable_from, 6)}{until}", "green")
        if not at_once:
            _hint_below(way, speed_in_words)
    elif at_once:
        say(f"it is stable at none of the speeds looked at, up to {speed_in_words(way.fastest)}", "yellow")
    for critical in way.critical[len(at_once) :]:
        coarse = abs(critical.speed) > found.fine_up_to
        but = ", by elements that are too coarse for this speed" if coarse else ""
        say(f"the hose {words_of(critical, system)}{but}", "yellow" if coarse else "green")
    if _has_windows(way):
        for line in _sentences_on_windows(way, found.resolution, speed_in_words):
            say(line, "yellow")


def _nothing_found(way: Way, found: Stability, system: str) -> str:
    """A sentence on speeds at none of which a hose becomes unstable."""
    from tautline.scene.values.printed import in_words, shown

    words = "unstable" if way.grows.all() else "unstable in part" if way.grows.any() else "stable"
    words = words if found.eigenvalues.size else "nothing can move"
    first, last = way.speed[0], way.speed[-1]
    span = f"from {first:g} to {last:g} m/s" if first != last else f"at {shown(float(first), 'm/s', system)}"
    fine = way.sign * found.fine_up_to
    if not found.eigenvalues.size or abs(way.fastest) <= abs(fine):
        text = f"{words} {span}"
    elif way.grows.any():
        coarse = "by elements that are too coarse"
        where = f"{coarse} for these speeds" if abs(way.slowest) > abs(fine) else f"beyond {fine:.4g} m/s {coarse}"
        text = f"{words} {span}, {where}"
    elif abs(way.slowest) >= abs(fine):
        text = f"the elements are too coarse to tell whether the hose is stable {span}"
    else:
        text = (
            f"stable from {way.slowest:g} to {fine:.4g} m/s. Beyond, up to {way.fastest:g} m/s, the elements are too "
            "coarse to tell"
        )
    return in_words(text, system) if first != last else text


def _hint_below(way: Way, speed_in_words: Callable[..., str]) -> None:
    """Say how to find a critical speed that lies below all speeds looked at."""
    from tautline.cli.output.console import say

    if way.grows[abs(way.speed).argmin()] and way.slowest != 0.0:
        say(
            f"the critical speed lies below {speed_in_words(abs(way.slowest))}. Leave out --speed to search from 0, "
            "or give lower speeds",
            "yellow",
        )


def _has_windows(way: Way) -> bool:
    """Whether a hose that has become unstable is stable once more at a higher speed."""
    return any(one.end is not None and one.begin != way.slowest for one in way.windows) or len(way.windows) > 2


def _sentences_on_windows(way: Way, resolution: float | None, speed_in_words: Callable[..., str]) -> list[str]:
    """Sentences: between which speeds a hose is unstable, and how narrow a window may be missed."""
    parts = [
        f"from {speed_in_words(one.begin, 6)}" + (f" to {speed_in_words(one.end, 6)}" if one.end is not None else " on")
        for one in way.windows
    ]
    lines = [f"it is unstable in windows of speed: {', '.join(parts)}. Between the windows it is stable"]
    if resolution is not None:
        lines.append(f"a window narrower than {speed_in_words(resolution, 2)} may be missed")
    return lines


def _windows_in_json(windows: Sequence[Window]) -> list[dict[str, float | None]]:
    return [{"from": one.begin, "to": one.end} for one in windows]


def _way_in_json(way: Way) -> dict[str, Any]:
    """What is told of one way of flow, with the names that the whole report has."""
    first = way.critical[0]._asdict() if way.critical else dict.fromkeys(("speed", "frequency", "plane", "kind"))
    return {
        "direction": way.direction,
        "critical_speed": first["speed"],
        "critical_frequency": first["frequency"],
        "plane": first["plane"],
        "kind": first["kind"],
        "stable_from": way.stable_from,
        "windows": _windows_in_json(way.windows),
    }


def _flow_direction(found: Stability) -> str:
    """Which way the water flows at the speeds looked at."""
    return "both" if len(found.ways) > 1 else found.ways[0].direction


def _of_speeds(hose: HoseScene, found: Stability, speeds: list[float] | None) -> list[SceneWarning]:
    """Say where elements or stiffness are little for the speed that was found, or for the fastest asked for."""
    from gardenhose.warnings import aspiration_at, mesh_at, momentum_at, short_waves_at

    # Speeds that were not asked for go past the first instability: only where there is none do they count.
    looked_at = speeds if speeds is not None else [] if found.critical else found.speed.tolist()
    all_of_them = [*(one.speed for one in found.critical), *looked_at]
    return [
        *momentum_at(hose, all_of_them),
        *_stretched(hose, all_of_them),
        *mesh_at(hose, all_of_them),
        *short_waves_at(hose, found.speed.tolist()),
        *aspiration_at(hose, found.speed.tolist()),
    ]


def _stretched(hose: HoseScene, speeds: list[float]) -> list[SceneWarning]:
    """Say where the shape whose stability was looked at is squashed or stretched beyond belief.

    Each way of flow has its shapes from rest on. Where none is found the search has told it.
    """
    from gardenhose.cables import arc_lengths
    from gardenhose.static import forms, stretched_at_rest
    from tautline.integrators.status import StoppedEarly

    found: list[Form] = []
    for way in (1.0, -1.0):
        asked = sorted({abs(one) for one in speeds if one * way > 0.0})
        try:
            found += forms(hose, [0.0, *(way * one for one in asked)]) if asked and hose.water is not None else []
        except StoppedEarly:
            continue
    return stretched_at_rest(arc_lengths(hose), found, hose.units)


def _between(found: Stability, speeds: list[float] | None, system: str) -> list[SceneWarning]:
    """Say which windows of instability lie between speeds that were asked for, where no motion grows at these."""
    from tautline.scene.errors import SceneWarning
    from tautline.scene.values.printed import shown

    hidden = [
        one
        for one in found.windows
        if speeds is not None
        and one.end is not None
        and not any(min(one) <= speed <= max(one) for speed in found.speed)
    ]
    return [
        SceneWarning(
            "--speed",
            f"the hose is unstable from {shown(one.begin, 'm/s', system, 6)} to {shown(one.end, 'm/s', system, 6)}. "
            "None of the speeds given lies there; take a smaller step",
        )
        for one in hidden
    ]


def _doubtful(found: Stability) -> list[tuple[int, float, float]]:
    """Columns of the eigenvalues, from 0, and the speeds between which it is not sure that they are one mode."""
    return found.curves.doubtful() if found.curves is not None else []


def _uncertain_curves(found: Stability, system: str) -> list[SceneWarning]:
    """Say between which speeds it is not sure how curves go on."""
    from tautline.integrators.vibration.following import FINEST
    from tautline.scene.errors import SceneWarning
    from tautline.scene.values.printed import shown

    doubtful = _doubtful(found)
    if not doubtful:
        return []
    _, low, high = min(doubtful, key=lambda one: abs(one[1]))
    where = f"between {shown(low, 'm/s', system)} and {shown(high, 'm/s', system)}"
    if len(doubtful) > 1:
        where += f", and at {len(doubtful) - 1} more places"
    finest = FINEST * float(max(found.speed) - min(found.speed))
    cure = "Take a smaller step" if any(high - low > finest for _, low, high in doubtful) else AS_FINE
    text = (
        f"it is not sure which mode goes on as which {where}. The curves have gaps there. The eigenvalues at each "
        f"speed and the critical speed do not depend on it. {cure}"
    )
    return [SceneWarning("--speed", text)]


def _draw_stability(hose: HoseScene, found: Stability, path: Path) -> None:
    from gardenhose.view.figures import flutter_figure

    onsets = [(way.critical[0].speed, way.critical[0].frequency) for way in found.ways if way.critical]
    title = f"{hose.title or path.stem}: stability"
    drawn = found.curves or found
    more = {} if found.curves is None else {"sure": found.curves.sure, "marks": found.curves.marks}
    # A window without an end goes on to the fastest speed of its own way of flow.
    windows = [(one.begin, way.fastest if one.end is None else one.end) for way in found.ways for one in way.windows]
    figure = flutter_figure(
        drawn.speed, drawn.eigenvalues, drawn.out_of_plane, onsets, title, hose.units, windows, **more
    )
    write_figure(figure, path)


def read_static(scene: HoseScene, options: Mapping[str, Any]) -> list[float]:
    """Flow speeds at which a sweep looks for the shape at rest; raises SceneError naming the option."""
    return parse_speeds(str(options["speed"])) if options.get("speed") is not None else _up_to_fastest(scene)


def static_findings(scene: HoseScene, speeds: list[float]) -> dict[str, Finding]:
    """Where the tip is, and whether the shape is stable, along ``speed``."""
    from gardenhose.static import forms
    from tautline.results.tables.finding import Finding

    found = forms(scene, speeds)
    made = {
        f"tip_{axis}": Finding([float(one.tip[k]) for one in found], "m", f"{axis} of the tip at rest", "speed")
        for k, axis in enumerate("xyz")
    }
    made["sag"] = Finding(
        [one.sag[0] for one in found], "m", "largest distance from the line between the ends", "speed"
    )
    negative = [None if one.negative < 0 else float(one.negative) for one in found]
    made["negative_pivots"] = Finding(negative, "", NEGATIVE_PIVOTS, "speed")
    return made | {"speed": Finding([float(speed) for speed in speeds], "m/s", "flow speed", "speed")}


def read_flutter(scene: HoseScene, options: Mapping[str, Any]) -> tuple[list[float] | None, int]:
    """Flow speeds and number of modes of a search for flutter in a sweep; raises SceneError naming the option."""
    speeds = parse_speeds(str(options["speed"])) if options.get("speed") is not None else None
    modes = options.get("modes", USUAL_MODES)
    if isinstance(modes, bool) or not isinstance(modes, int) or not 1 <= modes <= MOST_MODES:
        raise option_error("--modes", str(modes), "is no number of modes", f"give 1 to {MOST_MODES}")
    return speeds, modes


def flutter_findings(scene: HoseScene, asked: tuple[list[float] | None, int]) -> dict[str, Finding]:
    """Critical speed and frequency, and whether the hose is unstable at none, part or all of the speeds looked at.

    Of speeds of both signs the critical one is the slowest of both ways of flow, with its sign. Whether the hose is
    unstable is unknown where it is at none, on elements that are too coarse for the fastest.

    The first two are None where it is stable, and where it is unstable at all speeds, the slowest of which is not 0.
    """
    from gardenhose.flutter import stability
    from tautline.results.tables.finding import Finding

    searched_for = stability(scene, *asked)
    first = searched_for.critical[0] if searched_for.critical else None
    return {
        "critical_speed": Finding(first and first.speed, "m/s", "critical flow speed"),
        "critical_frequency": Finding(first and first.frequency, "Hz", "frequency at the critical speed"),
        "kind": Finding(first and first.kind, "", "flutter or divergence"),
        "plane": Finding(first and first.plane, "", "plane of the motion"),
        "unstable_at": Finding(
            searched_for.unstable_at, "", "speeds looked at where the hose is unstable: none, part, all, unknown"
        ),
    }
