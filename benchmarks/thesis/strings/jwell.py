"""Figures 2.43 and 2.44 of the thesis again: the J-well under heave, by RK4 and by generalized-alpha."""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np

import tautline
from benchmarks import jwell
from benchmarks.page import table
from benchmarks.thesis import table_2_5
from benchmarks.thesis.strings.forms import at_rest
from benchmarks.thesis.strings.forms_figures import IMAGES
from benchmarks.thesis.strings.rod import COLLAR, PIPE
from drillstring.model.build import build
from drillstring.model.prepared import well_of
from tautline.view.figures.figure import COLOURS, QUIET, Axes, axes, equal_scale, label, save, styled

END = 40.0
HOLE = 0.2032
"""Diameter of the hole, m (Table 2.4)."""
WINDOW = (18.0, 21.0)
"""The thesis' magnified window, s."""
FINE, COARSE = 0.005, 0.1
"""Time between frames, s: for speeds, and for errors, where every step of the table divides it."""
LAWS = {"rk4": "regularised", "generalized-alpha": "projection"}
"""RK4 with the thesis' own friction law, generalized-alpha with exact friction: what the scene chooses for each."""
NAMES = {"rk4": "RK4", "generalized-alpha": "generalized-alpha"}
SETTLED = 1.0
"""Last part of the window, s, in which the bit stands still."""
PRINTED = ("what", "ours", "the thesis prints or draws", "difference, and why")
WHY_STILL = {
    "rk4": "the regularised law holds a load only by slipping (1e-5 m/s at most), and at this step it chatters",
    "generalized-alpha": "none: exact friction sticks",
}
STYLES = {1e-4: "-", 1e-3: "--", 1e-2: ":", 1e-1: "-."}
"""The thesis' lines."""
ERROR_COLOURS = {1e-4: COLOURS[0], 1e-3: COLOURS[1], 1e-2: COLOURS[2], 1e-1: COLOURS[3]}


class Speeds(NamedTuple):
    """Times s (n,), speed of the block and of the bit m/s, position of the bit (n, 3) m."""

    time: np.ndarray
    block: np.ndarray
    bit: np.ndarray
    position: np.ndarray


def run(method: str, step: float, end: float, interval: float) -> jwell.Run:
    """The J-well with the law that the scene chooses for the method."""
    return jwell.run(method, step, end, output__interval=interval, **jwell.friction(0.3, 0.2, LAWS[method]))


def speeds(method: str, step: float, end: float) -> Speeds:
    """A run with frames that are close enough to see the bit tremble."""
    result = run(method, step, end, FINE).result
    velocity = np.linalg.norm(result["velocity"], axis=2)
    return Speeds(result["time"], velocity[:, 0], velocity[:, -1], result["position"][:, -1])


def part(quick: bool) -> str:
    """The sections on Figures 2.43 and 2.44; draws them unless ``quick``."""
    end, base, others = (2.0, 1e-3, (1e-2,)) if quick else (END, 1e-4, table_2_5.STEPS)
    pair = {method: speeds(method, base, end) for method in LAWS}
    every = round(COARSE / FINE)
    reference = np.linalg.norm(pair["rk4"].position[::every], axis=1)
    errors, failures = {}, {}
    for method in LAWS:
        for step in others:
            if step == base:
                bit = pair[method].position[::every]
            else:
                found = run(method, step, end, max(COARSE, step))
                if found.failure is not None:
                    failures[method, step] = found.failure
                    continue
                bit = found.bit
            errors[method, step] = (np.linalg.norm(bit, axis=1) - reference) ** 2
    errors.pop(("rk4", base), None)
    if not quick:
        draw_well()
        draw(pair, pair["rk4"].time[::every], errors)
    return _well() + _heave(pair, errors, failures)


def _well() -> str:
    scene = tautline.read(jwell.SCENE)
    well, (line, string) = well_of(scene), _at_rest()
    north, _, down = line[-1]
    rows = [
        ("vertical and horizontal reach", f"{down:g} m and {north:g} m", "3200 m and 1000 m (Table 2.4)",
         "none; the curve is ours (kick-off 2200 m, radius 1000 m), for the thesis prints none: "
         f"{well.length:.1f} m along it"),
        ("elements", f"{scene.model.elements}", "12 (Table 2.4)", "none"),
        ("where the bit hangs", f"{string['measured_depth'][-1] - well.length:.2f} m past that", "not printed",
         "the string stretches by its weight"),
    ]  # fmt: skip
    return (
        "\n### Fig. 2.43: the J-well and its string\n\n`data/jwell.yaml` at rest.\n\n"
        + table(PRINTED, rows)
        + "\n![The J-well](images/thesis/fig_2_43.png)\n\nWhat differs: the well's curve is ours, and on the right we "
        "show what the thesis' figure cannot: which side of the hole each lump lies on.\n"
    )


@functools.cache
def _at_rest() -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """The well's centre line (n, 3), m, and the string at rest in it."""
    scene = tautline.read(jwell.SCENE)
    well = well_of(scene)
    return well.position(np.linspace(0.0, well.length, 400)), at_rest(build(scene))


@styled
def draw_well() -> None:
    """Fig. 2.43: the well in its plane, and the lumps' offset across the hole."""
    line, string = _at_rest()
    position, depth = string["position"], string["measured_depth"]
    joint = depth[-2]
    figure, plots = axes(1, 2, 9.0, 6.2, "Fig. 2.43: J-well, 12 lumps at rest", width_ratios=[1.0, 1.3])
    section, across = plots[0]
    section.plot(line[:, 0], line[:, 2], color=QUIET, lw=1.2, label="well")
    section.plot(position[:, 0], position[:, 2], color=COLOURS[0], ls="none", marker="o", mfc="white", label="lump")
    equal_scale(section, line[:, 0], line[:, 2], 10.0)
    section.invert_yaxis()
    section.set_xlabel(label("north", "m"))
    section.set_ylabel(label("true vertical depth", "m"))
    across.plot(1e3 * string["lateral_displacement"][:, 0], depth, color=COLOURS[0], marker="o", mfc="white", lw=0.8)
    for sign in (-1.0, 1.0):
        walls = [sign * 500.0 * (HOLE - od) for od in (PIPE.od, PIPE.od, COLLAR.od, COLLAR.od)]
        across.plot(walls, [0.0, joint, joint, depth[-1]], color=QUIET, lw=1.2)
    across.axvline(0.0, color=QUIET, lw=0.8, ls=":")
    across.set_xlabel(label("offset from the well's axis, to the inside of the bend", "mm"))
    across.set_ylabel(label("measured depth", "m"))
    across.invert_yaxis()
    figure.legend(*section.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    save(figure, IMAGES / "fig_2_43.png")


def _heave(
    pair: dict[str, Speeds], errors: dict[tuple[str, float], np.ndarray], failures: dict[tuple[str, float], str]
) -> str:
    rows = []
    first, last = WINDOW[1] - SETTLED, WINDOW[1]
    for method, drawn in (("rk4", "oscillations"), ("generalized-alpha", "“more stable … with no oscillations”")):
        one = pair[method]
        still = (one.time >= first) & (one.time <= last)
        if still.any():
            rows.append((
                f"largest speed of the stuck bit, {first:g} to {last:g} s, {NAMES[method]}",
                f"{one.bit[still].max():.1e} m/s", drawn, WHY_STILL[method],
            ))  # fmt: skip
    for (method, step), failure in failures.items():
        rows.append((f"{NAMES[method]} at {step:g} s", failure, "“did not converge”", "none: beyond the critical step"))
    spread = [float(np.sqrt(np.mean(error))) for error in errors.values()]
    rows.append((
        "RMSE against RK4 at the smallest step", f"{min(spread):.1e} to {max(spread):.1e} m",
        "“centimeters or millimeters”: 5.18e-04 to 6.45e-02 m",
        "[docs/performance.md](performance.md#the-thesis-table-25) has Table 2.5 row by row",
    ))  # fmt: skip
    return (
        "\n### Fig. 2.44: the J-well under heave\n\nRK4 takes the thesis' regularised friction, generalized-alpha "
        "(rho_inf 0.1) exact Coulomb friction. Errors are eq. 2.172's, squared, every 0.1 s.\n\n"
        + table(PRINTED, rows)
        + "\n![The J-well under heave](images/thesis/fig_2_44.png)\n\nWhat differs: our RK4 does not oscillate visibly "
        "in the window, but on a logarithmic axis it trembles where the bit should stand; and our errors do not grow "
        "with the step: with static friction above kinetic they are set by whether a lump stops for a moment, and the "
        "base case has such errors too.\n"
    )


@styled
def draw(pair: dict[str, Speeds], time: np.ndarray, errors: dict[tuple[str, float], np.ndarray]) -> None:
    """Fig. 2.44: on the left speeds and the window of 18 to 21 s, on the right squared errors."""
    figure, plots = axes(3, 2, 12.0, 10.5, "Fig. 2.44: J-well under heave")
    for plot, window in zip(plots[:, 0], ((0.0, END), WINDOW, WINDOW), strict=True):
        _draw_speeds(plot, pair, window)
    plots[0, 0].set_title("Block and bit")
    plots[1, 0].set_title("18 to 21 s")
    plots[2, 0].set_title("18 to 21 s, logarithmic")
    plots[2, 0].set_yscale("log")
    plots[2, 0].set_ylim(1e-16, 2.0)
    plots[2, 0].legend(*plots[0, 0].get_legend_handles_labels(), loc="lower left", bbox_to_anchor=(0.0, 0.04))
    shown = (("rk4", (1e-3, 1e-2)), ("generalized-alpha", (1e-4, 1e-3)), ("generalized-alpha", (1e-2, 1e-1)))
    for plot, (method, steps) in zip(plots[:, 1], shown, strict=True):
        for step in steps:
            look = {"color": ERROR_COLOURS[step], "ls": STYLES[step], "lw": 1.1, "label": f"step {step:g} s"}
            plot.semilogy(time[1:], errors[method, step][1:], **look)
        plot.set_title(f"{NAMES[method]}: squared error against RK4 at 1e-4 s")
        plot.set_ylabel(label("squared error of the bit", "m²"))
        plot.set_xlabel(label("time", "s"))
        plot.set_xlim(0.0, END)
        plot.set_ylim(1e-14, 1e-2)
        plot.legend(loc="lower right", bbox_to_anchor=(1.0, 0.04))
    save(figure, IMAGES / "fig_2_44.png")


def _draw_speeds(plot: Axes, pair: dict[str, Speeds], window: tuple[float, float]) -> None:
    for number, (method, one) in enumerate(pair.items()):
        seen = (one.time >= window[0]) & (one.time <= window[1])
        if number == 0:
            plot.plot(one.time[seen], one.block[seen], color=QUIET, lw=1.2, label="block")
        name = f"bit, {NAMES[method]} at 1e-4 s"
        plot.plot(one.time[seen], one.bit[seen], color=COLOURS[1 - number], lw=1.0, label=name)
    plot.set_xlim(window)
    plot.set_xlabel(label("time", "s"))
    plot.set_ylabel(label("speed", "m/s"))
