"""Figures of what ``static`` and ``flutter`` find, and of stability boundaries, from plain arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import linear_sum_assignment

from gardenhose.motion.curves import Plane, name_of, plane_of
from tautline.scene.values.printed import shown
from tautline.scene.values.systems import in_system
from tautline.view.figures.figure import (
    COLOURS,
    QUIET,
    SHADE,
    SHADES,
    Axes,
    Figure,
    axes,
    bar_of_shades,
    equal_scale,
    height_over_width,
    label,
    outline,
    round_numbers,
    sample_line,
    styled,
    widen,
)
from tautline.view.figures.unit_axes import use_units

NOTHING = 1.0e-6
"""Damping over the largest frequency that is none: axes show no more of it."""
STYLES = {"-": "in the plane", "--": "out of the plane"}
"""Lines of modes."""
DOTS = {"full": "in the plane", "none": "out of the plane"}
"""Dots of modes at one speed, which makes no line, by how they are filled."""
BROAD = 3.2
"""Width of the lines of modes that have a colour for the second time."""
MOST_COLOURED = 2 * len(COLOURS)
"""Modes up to which each has a look of its own and is named; of more, a bar tells the number."""
LIKE = 0.2
"""Relative distance of the eigenvalues of a mode in the plane and of its like out of it, at most."""
MOST_MARKED = 8
"""Speeds along a curve that are written, about."""
MOST_NAMED = 8
"""Static shapes up to which each is named; of more, a bar tells the speed."""


def show_in_plane(
    plot: Axes, plane: Plane, points: np.ndarray, least: float, larger: tuple[float, float] = (1.0, 1.0)
) -> None:
    """Same scale both ways, round points (n, 3), at least `least` m each way; labels with the axes' names.

    Where one way is drawn `larger` than the other, its label says how many times.
    """
    equal_scale(plot, *plane(points), least, larger)
    across, up = name_of(plane.across), name_of(plane.up)
    for name, other, factor, write in (
        (across, up, larger[0], plot.set_xlabel),
        (up, across, larger[1], plot.set_ylabel),
    ):
        write(label(f"{name}, drawn {factor:.0f} times larger than {other}" if factor > 1.0 else name, "m"))


@styled
def static_figure(
    speed: np.ndarray, shapes: Sequence[np.ndarray], tips: np.ndarray, title: str = "Static shapes", system: str = "si"
) -> Figure:
    """The hose at rest at several flow speeds, as Fig. 2.28 of the thesis, and where its tip goes.

    Parameters
    ----------
    speed : (k,) array
        m/s.
    shapes : list of k (m, 3) arrays
        Points along the hose from root to tip, m.
    tips : (k, 3) array
        m.
    title : str
        Heading.
    system : str
        Units of the figure, a key of `tautline.scene.values.systems.SYSTEMS`.
    """
    speed, tips = np.asarray(speed, float), np.asarray(tips, float)
    points = np.concatenate([np.asarray(shape) for shape in shapes])
    plane = plane_of(points, towards=(tips - np.array([shape[0] for shape in shapes])).mean(axis=0))
    length = max(float(np.linalg.norm(np.diff(shape, axis=0), axis=1).sum()) for shape in shapes)
    ratio = height_over_width(*plane(points), 0.2 * length)
    figure, plots = axes(1, 2, 10.0, min(max(5.2 * ratio, 2.6), 7.0) + 1.4, title, width_ratios=(1.5, 1.0))
    left, right = plots[0]
    span = float(np.ptp(speed)) or 1.0
    few = len(speed) <= MOST_NAMED
    for value, shape in zip(speed, shapes, strict=True):
        colour = SHADES((value - speed.min()) / span)
        left.plot(*plane(np.asarray(shape)), color=colour, label=shown(float(value), "m/s", system) if few else None)
    left.plot(*plane(points[:1]), color="black", marker="s", ms=6, ls="")
    left.plot(*plane(tips), color="black", lw=0.8, ls=":", marker="o", ms=3)
    show_in_plane(left, plane, points, 0.2 * length)
    left.set_title("Shape")
    for number, direction in enumerate(plane):
        look = {"color": COLOURS[number], "marker": "o", "ms": 3.5}
        right.plot(speed, tips @ direction, label=name_of(direction), **look)
    widen(right, tips @ np.array(plane).T, 2e-3 * length)
    right.set_xlabel(label("flow speed", "m/s"))
    right.set_ylabel(label("tip", "m"))
    right.set_title("Tip")
    right.legend(loc="lower left", bbox_to_anchor=(0.3, 1.0), ncols=2, borderaxespad=0.2)
    if few:
        figure.legend(*left.get_legend_handles_labels(), loc="outside lower left", ncols=6)
    else:
        bar_of_shades(figure, left, float(speed.min()), float(speed.max()), label("flow speed", "m/s"), shrink=0.8)
    return use_units(figure, system)


@styled
def flutter_figure(
    speed: np.ndarray,
    eigenvalues: np.ndarray,
    out_of_plane: np.ndarray,
    critical: Sequence[tuple[float, float | None]] = (),
    title: str = "Stability",
    system: str = "si",
    windows: Sequence[tuple[float, float | None]] = (),
    sure: np.ndarray | None = None,
    marks: Sequence[float] | None = None,
) -> Figure:
    """Argand diagram and growth rates of a hose's modes against flow speed.

    The diagram is that of the literature: a motion goes with exp(i omega t), omega = -i lambda, Re(omega) stands to the
    right and Im(omega) up, so that what is below the horizontal axis grows; numbers along the curves are speeds. Modes
    in the plane that the hose hangs in are solid, those out of it dashed.

    Parameters
    ----------
    speed : (k,) array
        Rising, m/s.
    eigenvalues : (k, modes) array of complex
        lambda of motions exp(lambda t), 1/s; one column a mode, followed from speed to speed; not finite where it is
        not known. Of a conjugate pair either will do.
    out_of_plane : (k, modes) array
        Bool, or share of the mode that is out of the plane.
    critical : list of (speed, frequency)
        Where the hose begins to be unstable, m/s and Hz, the slowest speed of each way of flow.
    title : str
        Heading.
    system : str
        Units of the figure, a key of `tautline.scene.values.systems.SYSTEMS`.
    windows : list of (begin, end)
        Speeds between which the hose is unstable, m/s, no end where it is at the fastest: shaded, for a growth rate
        above zero by little cannot be seen.
    sure : (k - 1, modes) array of bool, optional
        Whether a mode goes on from a speed to the next; where not, its curve has a gap.
    marks : list of float, optional
        Speeds among those given that are written along the curves, m/s; without them those that are round, or some.
    """
    modes = _modes_of(speed, eigenvalues, out_of_plane)
    numbers = _numbers(modes)
    marked = _marked(modes.speed, in_system(1.0, "m/s", system)[0]) if marks is None or not len(marks) else marks
    at = [int(np.abs(modes.speed - mark).argmin()) for mark in marked]
    modes, at = modes if sure is None else _with_gaps(modes, np.asarray(sure)), modes.speed[at]
    figure, plots = axes(1, 2, 11.0, 5.4, title, width_ratios=(1.15, 1.0))
    argand, growth = plots[0]
    wide, low, high = _limits_of(modes)
    _shade_unstable(argand, wide, low, high)
    for plot in (argand, growth):
        plot.axhline(0.0, color="black", lw=0.8)
    count = int(numbers.max(initial=0)) + 1
    looks = [_look(int(number), count) for number in numbers]
    for mode, look in enumerate(looks):
        _draw_mode(argand, growth, modes, mode, look)
    per_speed, rate = in_system(1.0, "m/s", system)
    _label_speeds(argand, modes, at, per_speed, [look["color"] for look in looks])
    for onset, marker in zip(critical, "os", strict=False):
        _mark_critical(argand, growth, *onset, system, marker)
    argand.set_xlabel("Re ω, frequency")
    argand.set_ylabel(label("Im ω, damping", "1/s"))
    argand.set_title(f"Argand diagram, flow speed in {rate}")
    growth.set_xlabel(label("flow speed", "m/s"))
    growth.set_ylabel(label("growth rate", "1/s"))
    growth.set_title("Growth rate")
    if len(modes.speed) > 1:
        growth.set_xlim(modes.speed.min(), modes.speed.max())
    for number, (begin, end) in enumerate(windows):
        end = modes.speed[-1] if end is None else end
        # Its edges are drawn too: a narrow one has no width to see.
        growth.axvspan(begin, end, color=SHADE, lw=0.8, zorder=0, label="unstable" if not number else None)
    growth.set_ylim(-high, -low)
    if count > MOST_COLOURED:
        bar_of_shades(figure, plots, 1.0, float(count), "mode", shrink=0.5)
    figure.legend(handles=_handles(growth, modes, count), loc="outside lower center", ncols=7)
    use_units(figure, system)
    # The plane of complex numbers has one unit both ways, in every system.
    argand.set_xlabel(label(argand.get_xlabel(), "rad/s"))
    return figure


def _shade_unstable(argand: Axes, wide: float, low: float, high: float) -> None:
    """Set the limits of an Argand diagram, and shade the half of it in which motions grow."""
    argand.set_xlim(-0.03 * wide, 1.08 * wide)
    argand.set_ylim(low, high)
    argand.axhspan(low, 0.0, color=SHADE, lw=0, zorder=0)
    argand.text(0.99, 0.015, "unstable", transform=argand.transAxes, ha="right", fontsize=9, color=QUIET)


class _Modes(NamedTuple):
    """Modes along the flow speed (k,), m/s: frequency rad/s and damping 1/s, each (k, modes).

    ``outside`` tells where a mode is out of the plane, ``known`` where it is known.
    """

    speed: np.ndarray
    frequency: np.ndarray
    damping: np.ndarray
    outside: np.ndarray
    known: np.ndarray


def _modes_of(speed: np.ndarray, eigenvalues: np.ndarray, out_of_plane: np.ndarray) -> _Modes:
    speed, eigenvalues = np.asarray(speed, float), np.asarray(eigenvalues, complex)
    outside = np.broadcast_to(np.asarray(out_of_plane, float) > 0.5, eigenvalues.shape)
    frequency, damping = np.abs(eigenvalues.imag), -eigenvalues.real
    return _Modes(speed, frequency, damping, outside, np.isfinite(frequency) & np.isfinite(damping))


def _limits_of(modes: _Modes) -> tuple[float, float, float]:
    """Largest frequency, rad/s, and the least and the largest damping that the diagram shows, 1/s."""
    wide = float(modes.frequency[modes.known].max(initial=0.0)) or 1.0
    unstable = float(-modes.damping[modes.known].min(initial=0.0))
    # Strong damping takes high modes far up, where nothing happens: the picture is as high as it is wide.
    top = min(float(modes.damping[modes.known].max(initial=0.0)), wide)
    high = max(top, unstable, NOTHING * wide)
    return wide, -max(1.25 * unstable, 0.15 * high), 1.08 * high


def _look(number: int, count: int) -> dict[str, Any]:
    """Colour and width of the lines of a mode, by its number from 0 and how many there are."""
    if count > MOST_COLOURED:
        return {"color": SHADES(number / (count - 1))}
    look: dict[str, Any] = {"color": COLOURS[number % len(COLOURS)]}
    # A broad line hides none of the others: it lies below them.
    return look if number < len(COLOURS) else look | {"lw": BROAD, "zorder": 1.5}


def _dot(fill: str) -> dict[str, Any]:
    """Look of a dot: a hollow one is a ring about a full one in the same place."""
    return {"fillstyle": fill, "ms": 5.0 if fill == "full" else 8.0}


def _draw_mode(argand: Axes, growth: Axes, modes: _Modes, mode: int, looks: Mapping[str, Any]) -> None:
    """One mode's curve in the diagram and its growth rate, solid where it is in the plane and dashed out of it."""
    known, outside = modes.known[:, mode], modes.outside[:, mode]
    for side, style, fill in zip((~outside, outside), STYLES, DOTS, strict=True):
        chosen = side & known
        if not chosen.any():
            continue
        # One speed makes no line.
        look = {**looks, "ls": style, "marker": "o" if len(modes.speed) == 1 else ""} | _dot(fill)
        # A mode that turns out of the plane keeps its line whole: the point before it belongs to both.
        chosen = chosen | (np.append(chosen[1:], False) & known)
        right, up = (np.where(chosen, values[:, mode], np.nan) for values in (modes.frequency, modes.damping))
        argand.plot(right, up, **look)
        growth.plot(modes.speed, -up, **look)


def _mark_critical(argand: Axes, growth: Axes, speed: float, frequency: float | None, system: str, marker: str) -> None:
    """A ring where the hose begins to be unstable; a square for the other way of flow."""
    at = (shown(float(speed), "m/s", system), "" if frequency is None else f", {frequency:.3g} Hz")
    dot: dict[str, Any] = {"ls": "", "marker": marker, "ms": 8, "mfc": "none", "mec": "black", "mew": 1.4, "zorder": 5}
    growth.plot(speed, 0.0, label="critical: " + "".join(at), **dot)
    if frequency is not None:
        argand.plot(2.0 * np.pi * frequency, 0.0, **dot)


def _handles(growth: Axes, modes: _Modes, count: int) -> list[Any]:
    """What the legend explains: the modes' colours, both kinds of line where there are both, and the critical speed."""
    marked, _ = growth.get_legend_handles_labels()
    both = [sample_line(text, color="black", ls=style) for style, text in STYLES.items()]
    if len(modes.speed) == 1:
        both = [sample_line(text, color="black", ls="", marker="o", **_dot(fill)) for fill, text in DOTS.items()]
    present = both if modes.outside[modes.known].any() else []
    named = [sample_line(f"mode {i + 1}", **_look(i, count)) for i in range(count)] if count <= MOST_COLOURED else []
    return [*named, *present, *marked]


def _with_gaps(modes: _Modes, sure: np.ndarray) -> _Modes:
    """The same with each speed before a gap twice, the second time without the modes that do not go on."""
    after = np.flatnonzero(~sure.all(axis=1)) + 1
    parts = [np.insert(values, after, values[after - 1], axis=0) for values in modes]
    for number, k in enumerate(after):
        parts[-1][k + number] &= sure[k - 1]
    return _Modes(*parts)


def _numbers(modes: _Modes) -> np.ndarray:
    """Number of each mode (m,), from 0, by frequency at the first speed at which it is known.

    A mode in the plane and its like out of it, which it is near at most speeds, have one number, and so one colour.
    """
    first = modes.known.argmax(axis=0)
    columns = np.arange(first.size)
    frequency, damping = (np.where(modes.known, part, 0.0) for part in (modes.frequency, modes.damping))
    # A real one that decays belongs to no vibration.
    idle = (frequency[first, columns] == 0.0) & (damping[first, columns] >= 0.0)
    order = np.argsort(np.where(idle, np.inf, frequency[first, columns]), kind="stable")
    outside = modes.outside[first, columns]
    inner, outer = order[~outside[order]], order[outside[order]]
    value = damping + 1j * frequency
    apart = np.ones((inner.size, outer.size))
    for i, a in enumerate(inner):
        for j, b in enumerate(outer):
            both = modes.known[:, a] & modes.known[:, b]
            size = np.maximum(np.abs(value[both, a]), np.abs(value[both, b]))
            if both.any():
                apart[i, j] = np.median(np.abs(value[both, a] - value[both, b]) / np.where(size > 0.0, size, 1.0))
    like = {outer[j]: inner[i] for i, j in zip(*linear_sum_assignment(apart), strict=True) if apart[i, j] < LIKE}
    numbers = np.zeros(first.size, int)
    own = [mode for mode in order if mode not in like]
    numbers[own] = np.arange(len(own))
    for mode, its in like.items():
        numbers[mode] = numbers[its]
    return numbers


def _marked(speed: np.ndarray, factor: float) -> np.ndarray:
    """Speeds (k,), some of those given: the round ones in the unit of which ``factor`` make one m/s, if there are."""
    low, high = factor * float(speed.min()), factor * float(speed.max())
    wanted = np.asarray(round_numbers(low, high, MOST_MARKED)) / factor if high > low else speed[:1]
    near = [one for one in wanted if np.abs(speed - one).min() <= 1e-9 * np.abs(speed).max()]
    if len(near) > 1 or len(near) == len(speed):
        return np.array(near)
    return speed[np.unique(np.linspace(0, len(speed) - 1, min(len(speed), MOST_MARKED)).round().astype(int))]


def _label_speeds(plot: Axes, modes: _Modes, marks: np.ndarray, factor: float, colours: Sequence[Any]) -> None:
    """Mark speeds that were looked at along the curves, and write those that find room.

    They are in the unit of which ``factor`` make one m/s.
    """
    at = [int(np.abs(modes.speed - mark).argmin()) for mark in marks]
    numbers = [float(f"{factor * mark:.4g}") for mark in marks]
    plot.figure.draw_without_rendering()
    (left, end), (low, high) = plot.get_xlim(), plot.get_ylim()
    box = plot.get_window_extent()
    x, y = (np.where(modes.known, values, np.nan)[at].T for values in (modes.frequency, modes.damping))
    inside = np.isfinite(x) & np.isfinite(y) & (left <= x) & (x <= end) & (low <= y) & (y <= high)
    # Places in points, in which sizes of letters are told too.
    point = plot.figure.dpi / 72.0
    across, height = (x - left) / (end - left) * box.width / point, (y - low) / (high - low) * box.height / point
    dots = np.column_stack([across[inside], height[inside]])
    taken: list[np.ndarray] = []
    named: list[tuple[int, np.ndarray]] = []
    for mode in np.argsort(np.where(modes.known[0], modes.frequency[0], np.inf), kind="stable"):
        for i in np.flatnonzero(inside[mode]):
            if len(modes.speed) > 1:
                plot.plot(x[mode, i], y[mode, i], color=colours[mode], marker="o", ms=3, ls="")
            dot, words = np.array([across[mode, i], height[mode, i]]), f"{numbers[i]:g}"
            # A mode out of the plane that runs along its like in it needs no numbers of its own.
            if any(i == j and np.hypot(*(dot - place)) < 22.0 for j, place in named):
                continue
            size = np.array([5.2 * len(words), 8.0])
            for corner in ((5.0, 2.0), (5.0, -10.0), (-5.0 - size[0], 2.0), (-5.0 - size[0], -10.0)):
                centre = dot + corner + 0.5 * size
                others = dots[np.abs(dots - dot).max(axis=1) > 1e-9]
                hit = np.any(np.all(np.abs(others - centre) < 0.5 * size + 2.0, axis=1))
                if hit or centre[0] < 0.5 * size[0] or any(np.all(np.abs(centre - t) < size + 1.0) for t in taken):
                    continue
                taken.append(centre)
                named.append((int(i), dot))
                text = plot.annotate(words, (x[mode, i], y[mode, i]), corner, textcoords="offset points", fontsize=8)
                text.set_color(colours[mode])
                outline(text)
                break
