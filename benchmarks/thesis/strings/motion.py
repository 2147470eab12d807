"""Figure 2.42 of the thesis again: configuration C let go straight, with and without mass-proportional damping."""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import find_peaks

from benchmarks.page import table
from benchmarks.thesis.strings.forms import Mesh, cable_text, string_scene
from benchmarks.thesis.strings.forms_figures import IMAGES
from benchmarks.thesis.strings.rod import CASES, LENGTH, rod
from drillstring.model.build import build as build_string
from tautline.cable.input.scene import parse
from tautline.cable.model.build import build as build_cable
from tautline.results.result import Result
from tautline.simulation import simulate
from tautline.view.figures.figure import COLOURS, QUIET, axes, label, save, styled

CASE = CASES["C"]
MESH = Mesh(240.0)
"""Four elements of 220 m and the collar: the third node stands at 440 m."""
PLACE = 440.0
FRAMES = 20
"""Frames a second."""
DAMPING = 0.1
"""alpha_1 of the thesis, 1/s."""
UNDAMPED = ((1.0, 0.01), (0.8, 0.01), (0.1, 0.01), (0.1, 0.15))
"""rho_inf and step, s, of the runs without damping. 0.15 s is the step of the thesis' Appendix A."""
DRAWN = (0.8, 0.01)
SHORTEST = 6.0
"""Time, s, that lies between two troughs: the first mode has a period of 8.8 s."""


class Motion(NamedTuple):
    """Times s and heights m (n,) of the point at 440 m, and the share of the energy that the string has lost."""

    time: np.ndarray
    height: np.ndarray
    lost: np.ndarray


def _run(start: str, damping: float, rho_inf: float, step: float, end: float) -> tuple[Result, np.ndarray]:
    """A run, and its energy (n,), J: what the force can still do is counted as potential energy."""
    frames = min(FRAMES, 1.0 / step)
    keys = {"massDamp": damping, "rho_inf": rho_inf, "time_step": step, "time_end": end, "plotpoints": frames}
    result = simulate(build_cable(parse(cable_text(MESH, *CASE, start=start, **keys))))
    energy = sum(result[name] for name in ("kinetic_energy", "strain_energy", "potential_energy"))
    return result, energy - CASE.force * (result["position"][:, -1, 0] - LENGTH)


@functools.cache
def energy_at_rest() -> float:
    """Energy, J, of the string at rest."""
    return float(_run("static", 0.0, 1.0, 0.01, 0.01)[1][0])


def release(damping: float, rho_inf: float, step: float, end: float) -> Motion:
    """Let the straight, unstretched string go."""
    result, energy = _run("as given", damping, rho_inf, step, end)
    node = MESH.places.index(PLACE)
    lost = (energy[0] - energy) / (energy[0] - energy_at_rest())
    return Motion(result["time"], result["position"][:, node, 2], lost)


def release_lumps(damping: float, elements: int, end: float) -> tuple[np.ndarray, np.ndarray]:
    """The same by lumps: times s and heights m (n,) at 440 m, of the smooth beam through the lumps."""
    keys = {"solver__step": 0.01, "solver__end": end, "output__interval": 1.0 / FRAMES, "start": "straight"}
    scene = string_scene("configuration_c", model__elements=elements, damping={"mass_proportional": damping}, **keys)
    model = build_string(scene)
    result = simulate(model)
    places = model.coordinates["unstretched_depth"][1]
    beam = CubicSpline(places, -result["position"][..., 2], axis=1, bc_type="natural")
    return result["time"], beam(PLACE)


def troughs(motion: Motion) -> np.ndarray:
    """Frames in which the point is lowest in each oscillation."""
    frames = max(1, round(SHORTEST / float(motion.time[1] - motion.time[0])))
    return find_peaks(-motion.height, distance=frames)[0]


def left_by_method(rho_inf: float, step: float, period: float, time: float) -> float:
    """Share of its energy that generalized-alpha leaves to a linear vibration: by its amplification matrix.

    Chung & Hulbert (J. Appl. Mech. 60, 1993), x'' + omega^2 x = 0, unknowns x, h v, h^2 a.
    """
    alpha_m, alpha_f = (2 * rho_inf - 1) / (rho_inf + 1), rho_inf / (rho_inf + 1)
    gamma = 0.5 + alpha_f - alpha_m
    beta = 0.25 * (gamma + 0.5) ** 2
    square = (2 * np.pi * step / period) ** 2
    after = np.array([[1.0, 0.0, -beta], [0.0, 1.0, -gamma], [(1 - alpha_f) * square, 0.0, 1 - alpha_m]])
    before = np.array([[1.0, 1.0, 0.5 - beta], [0.0, 1.0, 1 - gamma], [-alpha_f * square, 0.0, -alpha_m]])
    radius = float(np.abs(np.linalg.eigvals(np.linalg.solve(after, before))).max())
    return radius ** (2 * time / step)


def part(quick: bool) -> str:
    """The section on Figure 2.42; draws the figure unless ``quick``."""
    end = 20.0 if quick else 105.0
    kept = (DRAWN,) if quick else UNDAMPED
    free = {key: release(0.0, *key, end) for key in kept}
    damped = release(DAMPING, *DRAWN, end)
    rest = float(rod("C").at(np.array([PLACE]))[1][0])
    if not quick:
        draw(free, damped, release_lumps(DAMPING, 50, end), rest)
    period = float(np.mean(np.diff(free[DRAWN].time[troughs(free[DRAWN])])))
    lines = [
        (f"{rho:g}", f"{step:g}", f"{100 * motion.lost[-1]:.2g} %",
         f"{100 * (1 - left_by_method(rho, step, period, end)):.2g} %", _range(motion))
        for (rho, step), motion in free.items()
    ]  # fmt: skip
    header = (
        "rho_inf", "step, s", f"energy lost in {end:g} s, all modes",
        "the first mode alone would lose, by the amplification matrix", "troughs at 440 m",
    )  # fmt: skip
    text = (
        "\n### Fig. 2.42: configuration C in motion\n\nFour elements of 220 m and the collar, so that the third node "
        "stands at 440 m; straight and unstretched at t = 0, with the force and all gravity on it at once. The thesis "
        "gives neither rho_inf nor the step of its run; the blue line has rho_inf 0.8 at 10 ms.\n\n"
        + table(("what", "ours", "the thesis", "difference, and why"), _rows(damped, free[DRAWN], period, rest))
        + "\n![Configuration C let go](images/thesis/fig_2_42.png)\n\nWhat differs: without damping our motion does "
        "not decrease. The energy below is that above the string at rest. Numerical damping takes it from axial and "
        "high bending modes and leaves the first one alone; troughs are unequal because modes exchange energy, which "
        "rho_inf = 1 shows as well. At 0.15 s the sudden load even brings energy in during the first step.\n\n"
        + table(header, lines)
    )
    return text


def _range(motion: Motion) -> str:
    heights = motion.height[troughs(motion)]
    return f"{heights[0]:.1f}, then {heights[1:].min():.1f} to {heights[1:].max():.1f} m"


def _rows(damped: Motion, free: Motion, period: float, rest: float) -> list[tuple[str, ...]]:
    """What the thesis says of the figure."""
    amplitude, undamped = (rest - motion.height[troughs(motion)] for motion in (damped, free))
    once = np.exp(-0.5 * DAMPING * period)
    rows = [(
        "second trough over the first, below rest, alpha_1 = 0.1", f"{100 * amplitude[1] / amplitude[0]:.0f} %",
        "“from the first oscillation … significantly damped”",
        f"closed form exp(-alpha_1 T/2) with T = {period:.1f} s: {100 * once:.0f} %; other modes make the rest: "
        f"{100 * undamped[1] / undamped[0]:.0f} % without damping",
    )]  # fmt: skip
    if amplitude.size > 10:
        rows.append((
            "the same after ten oscillations", f"{100 * amplitude[10] / amplitude[0]:.1f} %",
            "“fully damped by 10 oscillations”", f"none; closed form {100 * once**10:.1f} %",
        ))  # fmt: skip
    rows.append((
        "decrease with alpha_1 = 0", f"none: troughs at {_range(free)}", "a decrease, “due to numerical damping”",
        "no numerical damping of this mode at such steps: table below",
    ))  # fmt: skip
    return rows


@styled
def draw(
    free: dict[tuple[float, float], Motion], damped: Motion, lumps: tuple[np.ndarray, np.ndarray], rest: float
) -> None:
    """Fig. 2.42: heights above, energy below."""
    figure, plots = axes(2, 1, 9.0, 7.0, "Fig. 2.42: configuration C let go straight, point at 440 m", sharex=True,
                         height_ratios=[1.7, 1.0])  # fmt: skip
    top, bottom = plots[:, 0]
    rho, step = DRAWN
    one = free[DRAWN]
    top.plot(one.time, one.height, color=COLOURS[0], lw=1.1, label=f"alpha_1 = 0, rho_inf {rho:g}, {1e3 * step:g} ms")
    top.plot(damped.time, damped.height, color=COLOURS[1], label="alpha_1 = 0.1 1/s")
    top.plot(*lumps, color="black", lw=0.8, ls=":", label="alpha_1 = 0.1 1/s, 50 lumps")
    envelope = np.exp(-0.5 * DAMPING * one.time)
    for sign in (1, -1):
        words = "rest ± fall times exp(-alpha_1 t/2)" if sign > 0 else ""
        top.plot(one.time, rest * (1 + sign * envelope), color=COLOURS[4], lw=0.9, ls="--", label=words)
    top.axhline(rest, color=QUIET, lw=0.9, zorder=0)
    top.set_ylabel(label("height of the point at 440 m", "m"))
    for colour, ((rho, step), motion) in zip((QUIET, *COLOURS[:1], *COLOURS[2:4]), free.items(), strict=True):
        bottom.plot(motion.time, 100 * motion.lost, color=colour, label=f"rho_inf {rho:g}, {1e3 * step:g} ms")
    bottom.set_ylabel(label("energy lost, alpha_1 = 0", "%"))
    bottom.set_xlabel(label("time", "s"))
    bottom.set_xlim(0.0, float(one.time[-1]))
    top.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
    bottom.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=4)
    save(figure, IMAGES / "fig_2_42.png")
