"""What ``campbell`` found, on one screen and as rows of a file."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, Any

import numpy as np

from drillstring.scene.scene import BEAM, LUMPED
from tautline.scene.values.printed import shown, significant
from tautline.scene.values.systems import length_unit
from tautline.scene.values.units import RPM

if TYPE_CHECKING:
    from rich.table import Table

    from drillstring.modes.campbell import Campbell
    from drillstring.modes.natural_modes import Mode

MOST_ROWS, MOST_SUPPORTS = 8, 8
"""Modes of a kind, and supports, that are told on the screen."""
LEAST_SHARE = 0.01
"""Errors below so many per cent are all the same to a reader."""
DOUBTFUL, MUCH = 0.02, 0.5
"""Relative error of a frequency, and share of the part that lies on the wall, that are warned of."""


MODELS = {LUMPED: "lumps", BEAM: "a beam (ale-ancf)"}
PARTS = {LUMPED: "links", BEAM: "elements"}
"""Kinds of model as a reader knows them, and what they are cut into."""


def name_of(order: float) -> str:
    """How a line of the diagram is called: ``1x``."""
    return f"{order:g}x"


def moves_most(mode: Mode) -> float:
    """Measured depth at which a mode moves most, m."""
    return float(mode.depth[np.abs(mode.shape).max(axis=1).argmax()])


def model_of(found: Campbell) -> str:
    """The model and how fine it is, in words: ``lumps, 80 links (lateral), 120 (torsional)``."""
    counts = [
        f"{count}{'' if i else f' {PARTS[found.model]}'} ({kind})"
        for i, (kind, count) in enumerate(found.links.items())
    ]
    return ", ".join([MODELS[found.model], *counts])


def table(found: Campbell, system: str = "si") -> Table:
    """Modes with their critical speeds within the range of speeds."""
    from rich.markup import escape
    from rich.table import Table

    made = Table(box=None, padding=(0, 2, 0, 0))
    _, place = length_unit(system)
    heads = ["", "motion", "Hz", "error", f"most at [{place}]", *(f"{name_of(order)} rpm" for order in found.orders)]
    for number, head in enumerate(heads):
        made.add_column(escape(head), justify="left" if number < 2 else "right", no_wrap=True)
    names = names_of(found.modes)
    for kind in dict.fromkeys(mode.kind for mode in found.modes):
        own = [k for k, mode in enumerate(found.modes) if mode.kind == kind]
        for k in own[:MOST_ROWS]:
            made.add_row(*_row(found, found.modes[k], names[k], system))
        if len(own) > MOST_ROWS:
            made.add_row("", f"{len(own) - MOST_ROWS} more", f"to {significant(found.modes[own[-1]].frequency, 3)}")
    return made


def names_of(modes: list[Mode]) -> list[str]:
    """Modes by the letter of their kind and their number: L1, T3."""
    count: dict[str, int] = {}
    named = []
    for mode in modes:
        count[mode.kind] = count.get(mode.kind, 0) + 1
        named.append(f"{mode.kind[0].upper()}{count[mode.kind]}")
    return named


def _row(found: Campbell, mode: Mode, name: str, system: str) -> list[str]:
    start = [name, mode.plane or mode.kind]
    if mode.frequency <= 0.0:
        return [*start, "unstable", "", _depth(moves_most(mode), system)]
    low, high = found.speeds
    speeds = [2.0 * pi * mode.frequency / order for order in found.orders]
    cells = [f"{speed / RPM:.1f}" if low <= speed <= high else "–" for speed in speeds]
    return [*start, significant(mode.frequency, 4), _share(mode), _depth(moves_most(mode), system), *cells]


def _share(mode: Mode) -> str:
    """Error of a frequency in per cent."""
    if not np.isfinite(mode.error):
        return "–"
    share = 100.0 * mode.error / mode.frequency
    return f"{significant(share, 2)} %" if share >= LEAST_SHARE else f"<{LEAST_SHARE:g} %"


def _depth(depth: float, system: str) -> str:
    return shown(depth, "m", system).split()[0]


def unstable_told(found: Campbell) -> list[str]:
    """A sentence where the string does not rest as it stands."""
    if not found.unstable:
        return []
    text = f"{len(found.unstable)} of the modes grow: the string does not rest so, it buckles as far as the wall"
    return [f"{text}; take weight off the bit, or --hold it"]


def sentences(found: Campbell, system: str = "si") -> list[tuple[str, str]]:
    """Sentences and their colours: what was looked at, what holds it, and how far the frequencies can be trusted."""
    said: list[tuple[str, str]] = [(f"model: {model_of(found)}", "")]
    if found.supports:
        said += [(text, "") for text in _held(found, system)]
    if "axial" in found.links:
        said.append((_end(found, system), ""))
    if found.loose:
        text = f"{', '.join(found.loose)}: clear of the wall as the string rests, so it holds nothing"
        said.append((f"{text}; --hold '{','.join(found.loose)}' holds it", "yellow"))
    said += [(text, "red") for text in unstable_told(found)]
    if not found.modes:
        said.append((f"no natural frequency is below {significant(found.up_to, 4)} Hz: see --up-to", "yellow"))
    names = names_of(found.modes)
    doubtful = [
        name
        for name, m in zip(names, found.modes, strict=True)
        if m.frequency > 0.0 and m.error > DOUBTFUL * m.frequency
    ]
    if doubtful:
        listed = ", ".join(doubtful[:MOST_ROWS]) + (", ..." if len(doubtful) > MOST_ROWS else "")
        said.append((f"uncertain by more than {100 * DOUBTFUL:.0f} %, as what touches the wall is: {listed}", "yellow"))
    lying = sum(one.bottom - one.top for one in found.supports if one.how == "on the wall")
    if found.supports and lying > MUCH * (found.bottom - found.top):
        text = "most of this part lies on the wall: its lateral modes rock in the hole, as if there were no friction"
        said.append((f"{text}; --from looks at less of it", "yellow"))
    lateral = [mode for mode in found.modes if mode.kind == "lateral"]
    if lateral:
        split = max(mode.gyroscopic(found.speeds[1]) for mode in lateral)
        fall = max(mode.rotatory for mode in lateral)
        terms = f"gyroscopic terms, up to ±{100 * split:.1g} % of a frequency", f"rotatory inertia, {100 * fall:.1g} %"
        said.append((f"not in the model: {terms[0]}, and {terms[1]}", ""))
    return said


def _end(found: Campbell, system: str) -> str:
    """What the bit is to axial modes."""
    if found.rock == 0.0:
        return "axial modes are those of a bit that is free along the hole"
    text = f"axial modes are those of a bit that the rock holds by {shown(found.rock, 'N/m', system)}"
    return f"{text}; `bit: {{on_bottom: false}}`, with its weight as `force`, frees it"


def _held(found: Campbell, system: str) -> list[str]:
    """The part that is looked at, and what holds it, from the top down."""
    said = [f"lateral modes are those from {shown(found.top, 'm', system)} to {shown(found.bottom, 'm', system)}:"]
    for one in found.supports[:MOST_SUPPORTS]:
        place = shown(one.top, "m", system)
        if one.bottom > one.top:
            place = f"{place} to {shown(one.bottom, 'm', system)}"
        force = f", {shown(one.force, 'N', system)}" if one.force > 0.0 else ""
        said.append(f"  {place}: {one.section} {one.how}{force}")
    if len(found.supports) > MOST_SUPPORTS:
        said.append(f"  and {len(found.supports) - MOST_SUPPORTS} more")
    return said


def header(found: Campbell) -> list[str]:
    """Names of the columns of the file of modes."""
    columns = ["mode", "kind", "plane", "frequency [Hz]", "error [Hz]", "moves most at [m]"]
    return [*columns, *(f"{name_of(order)} [rpm]" for order in found.orders), "model"]


def rows(found: Campbell) -> list[list[Any]]:
    """Rows of the file of modes: all there are, with empty cells for what does not swing."""
    made: list[list[Any]] = []
    for name, mode in zip(names_of(found.modes), found.modes, strict=True):
        stable = mode.frequency > 0.0
        speeds = [2.0 * pi * mode.frequency / order / RPM if stable else "" for order in found.orders]
        frequency = mode.frequency if stable else "unstable"
        error = mode.error if stable and np.isfinite(mode.error) else ""
        made.append([name, mode.kind, mode.plane, frequency, error, moves_most(mode), *speeds, found.model])
    return made
