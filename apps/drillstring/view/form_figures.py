"""The figure of ``form``: strings at rest beside the exact rod (Figs 2.37 and 2.39 to 2.41 of the thesis)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drillstring.scene.scene import LUMPED
from drillstring.statics.form import Finding, Form
from tautline.view.figures.figure import COLOURS, Axes, Figure, axes, equal_scale, label, sample_line, styled

FLAT = 0.05
"""Sag over span below which heights are drawn larger than they are: at equal scale nothing could be seen."""
LEAST = 1.0e-13
"""Difference over the string's length that is rounding, and is not shown."""
CURVE = 1001
"""Points of the rod's curve."""
MARKS = 25
"""Lumps of a mesh that are marked, at most."""
MARKERS = ("o", "s", "^", "D", "v")


@styled
def form_figure(titles: Sequence[str], found: Sequence[Finding]) -> Figure:
    """Shapes at rest, a scene beside the other, and under each how far its lumps are from the rod.

    A string that hangs straight has no shape to show: how far each of its points goes down is drawn in its place, as in
    the thesis.

    Parameters
    ----------
    titles : sequence of str
        Of the scenes.
    found : sequence of Finding
        As many.
    """
    across = min(2, len(found))
    down = -(-len(found) // across)
    heading = "At rest, " + ("by the static solver" if found[0].by == "static" else "by dynamic relaxation")
    width, height = (8.0, 6.4) if across == 1 else (12.0, 5.6 * down + 0.4)
    figure, plots = axes(2 * down, across, width, height, heading, height_ratios=(1.5, 1.0) * down)
    # One look for a mesh of a model, in all panels.
    counts = sorted({_mesh(form) for one in found for form in one.forms})
    for k, (title, one) in enumerate(zip(titles, found, strict=True)):
        shape, off = plots[2 * (k // across), k % across], plots[2 * (k // across) + 1, k % across]
        _draw_shape(shape, title, one, counts)
        _draw_difference(off, one, counts)
    for k in range(len(found), across * down):
        for row in (0, 1):
            plots[2 * (k // across) + row, k % across].set_axis_off()
    several = len({kind for _, kind in counts}) > 1
    samples = [sample_line(_words(n, kind, several), **_look((n, kind), counts)) for n, kind in counts]
    if any(one.reference.rod is not None for one in found):
        samples.insert(0, sample_line("exact rod", color="black", lw=3.0, alpha=0.25))
    figure.legend(handles=samples, loc="outside lower center", ncols=min(6, len(samples)))
    return figure


Mesh = tuple[int, str]
"""Number of elements, and kind of the model."""


def _mesh(form: Form) -> Mesh:
    return form.elements, form.kind


def _words(elements: int, kind: str, several: bool) -> str:
    if not several:
        return f"{elements} elements"
    return f"{elements} lumps" if kind == LUMPED else f"{elements} ALE-ANCF elements"


def _look(mesh: Mesh, counts: Sequence[Mesh]) -> dict:
    number = counts.index(mesh)
    return {
        "color": COLOURS[number % len(COLOURS)], "marker": MARKERS[number % len(MARKERS)], "mfc": "none",
        "ms": 5.0, "lw": 0.9,
    }  # fmt: skip


def _every(form: Form) -> int:
    """Of so many lumps one gets its mark."""
    return max(1, -(-form.elements // MARKS))


def _plane(found: Finding) -> tuple[np.ndarray, np.ndarray, str, str]:
    """Two level or upright directions of the plane that the string lies in, and what they are called."""
    points = found.finest.position
    level = points[:, :2] - points[0, :2]
    farthest = level[int(np.argmax(np.hypot(*level.T)))]
    size = float(np.hypot(*farthest))
    ahead = np.array([1.0, 0.0]) if size == 0.0 else farthest / size
    # A hole that runs north is drawn northwards, and what it is called is told.
    named = {0: "north", 90: "east", 180: "south", -90: "west", -180: "south"}
    word = named.get(round(np.degrees(np.arctan2(ahead[1], ahead[0])), 6), "level distance")
    return np.array([*ahead, 0.0]), np.array([0.0, 0.0, 1.0]), word, "depth"


def _draw_shape(plot: Axes, title: str, found: Finding, counts: Sequence[Mesh]) -> None:
    if _straight(found):
        _draw_stretch(plot, title, found, counts)
        return
    right, down, ahead, below = _plane(found)
    rod = found.reference.rod
    shown = [form.position for form in found.forms]
    if rod is not None:
        curve = found.reference.position(np.linspace(0.0, rod.length, CURVE))
        shown.append(curve)
        plot.plot(curve @ right, curve @ down, color="black", lw=3.0, alpha=0.25)
    for form in found.forms:
        plot.plot(form.position @ right, form.position @ down, markevery=_every(form), **_look(_mesh(form), counts))
    points = np.concatenate(shown)
    x, y = points @ right, points @ down
    sag, span = float(np.ptp(y)), float(np.ptp(x))
    words = "equal scale"
    if sag < FLAT * span and sag > 0.0:
        plot.set_xlim(x.min() - 0.03 * span, x.max() + 0.03 * span)
        plot.set_ylim(y.min() - 0.1 * sag, y.max() + 0.2 * sag)
        words = "depths enlarged"
    else:
        equal_scale(plot, x, y, 0.1 * max(span, sag))
    plot.invert_yaxis()
    plot.set_xlabel(label(ahead, "m"))
    plot.set_ylabel(label(below, "m"))
    plot.set_title(f"{title} ({words})")


def _straight(found: Finding) -> bool:
    """Whether the string hangs straight down, and the rod with it."""
    rod = found.reference.rod
    level = np.ptp(found.finest.position[:, :2], axis=0)
    return rod is not None and float(level.max()) < 1.0e-9 * rod.length


def _draw_stretch(plot: Axes, title: str, found: Finding, counts: Sequence[Mesh]) -> None:
    """How far each point of a hanging string goes down, against where it is in the unstretched string."""
    reference, rod = found.reference, found.reference.rod
    assert rod is not None
    s = np.linspace(0.0, rod.length, CURVE)
    top = reference.top[2]
    plot.plot(reference.position(s)[:, 2] - s - top, s, color="black", lw=3.0, alpha=0.25)
    for form in found.forms:
        look = _look(_mesh(form), counts)
        plot.plot(form.position[:, 2] - form.unstretched - top, form.unstretched, markevery=_every(form), **look)
    plot.invert_yaxis()
    plot.set_xlabel(label("displacement downwards", "m"))
    plot.set_ylabel(label("distance from the block", "m"))
    plot.set_title(f"{title} (displacement)")


def _draw_difference(plot: Axes, found: Finding, counts: Sequence[Mesh]) -> None:
    """Distance from the rod along the string; where there is none from the hole's axis, and words that say why."""
    plot.set_xlabel(label("distance from the block in the unstretched string", "m"))
    plot.set_xlim(-0.02 * found.finest.unstretched[-1], 1.02 * found.finest.unstretched[-1])
    if found.reference.rod is None:
        for form in found.forms:
            plot.plot(form.unstretched, form.offset, markevery=_every(form), **_look(_mesh(form), counts))
        plot.set_ylabel(label("distance from the hole's axis", "m"))
        plot.set_title(_wrapped(found.reference.said), fontsize=9)
        return
    least, drawn = LEAST * found.reference.rod.length, False
    for form in found.forms:
        difference = found.difference(form)
        assert difference is not None
        seen = difference > least
        drawn = drawn or bool(seen.any())
        where = np.where(seen, difference, np.nan)
        plot.plot(form.unstretched, where, markevery=_every(form), **_look(_mesh(form), counts))
    plot.set_ylabel(label("distance from the rod", "m"))
    if drawn:
        plot.set_yscale("log")
        return
    plot.set_axis_off()
    words = f"every lump is within {least:.0e} m of the rod: rounding"
    plot.text(0.5, 0.5, words, transform=plot.transAxes, ha="center", va="center")


def _wrapped(text: str, width: int = 80) -> str:
    import textwrap

    return "\n".join(textwrap.wrap(text, width))
