"""The figures of docs/hose.md and docs/hose_validation.md."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from benchmarks.hose import runs as hoses
from gardenhose.cables import arc_lengths
from gardenhose.flutter import stability
from gardenhose.static import forms
from gardenhose.view.figures import draw
from gardenhose.view.stability_figures import flutter_figure, static_figure
from tautline.view.figures.figure import COLOURS, QUIET, Figure, axes, label, save, styled

IMAGES = hoses.ROOT / "docs" / "images"


class Curve(NamedTuple):
    """A method's runs: name; run time s, error to the converged run and to the exact hose, m, each (n,)."""

    name: str
    time: np.ndarray
    to_converged: np.ndarray
    to_exact: np.ndarray


@styled
def precision(curves: Sequence[Curve]) -> None:
    """Error of the tip against run time."""
    figure, plots = axes(1, 1, 7.6, 5.2, "Tip of the hose at 1 s, 15 m/s")
    plot = plots[0, 0]
    for number, curve in enumerate(curves):
        look = {"color": COLOURS[number], "marker": "o", "ms": 4.5}
        plot.loglog(curve.time, curve.to_converged, label=f"{curve.name}: error of time", **look)
        look |= {"ls": ":", "mfc": "white"}
        plot.loglog(curve.time, curve.to_exact, label=f"{curve.name}: to the exact hose", **look)
    plot.set_xlabel(label("run time of the time loop", "s"))
    plot.set_ylabel(label("distance of the tip from where it should be", "m"))
    figure.legend(*plot.get_legend_handles_labels(), loc="outside lower center", ncols=2)
    save(figure, IMAGES / "hose_precision.png")


@styled
def boundary_figure(
    beta: np.ndarray,
    u: np.ndarray,
    published: tuple[np.ndarray, np.ndarray] | None = None,
    published_label: str = "published",
    computed_label: str = "computed",
    title: str = "Stability boundary",
    xlabel: str = "mass ratio β = M/(M + m) [–]",
    ylabel: str = "critical flow speed u = U L √(M/EJ) [–]",
) -> Figure:
    """Critical flow speed against the mass ratio, both without dimension, beside a published curve.

    Parameters
    ----------
    beta, u : (k,) array
        Ours, drawn as dots; several u at one beta are fine, as where the boundary is S-shaped.
    published : ((n,) array, (n,) array), optional
        beta and u along a curve, in the order in which to join them.
    published_label, computed_label, title, xlabel, ylabel : str
        Words in the figure.
    """
    figure, plots = axes(1, 1, 7.2, 5.0, title)
    plot = plots[0, 0]
    if published is not None:
        plot.plot(*published, color=QUIET, lw=1.8, label=published_label)
    plot.plot(beta, u, color=COLOURS[0], marker="o", ms=4.5, ls="", label=computed_label)
    plot.set_xlim(0.0, 1.0 if np.max(beta) > 0.85 else 1.05 * float(np.max(beta)))
    plot.set_ylim(0.0, 1.08 * max(float(np.max(u)), 0.0 if published is None else float(np.max(published[1]))))
    plot.text(0.97, 0.06, "stable", transform=plot.transAxes, ha="right", color=QUIET)
    plot.text(0.03, 0.93, "flutter", transform=plot.transAxes, ha="left", color=QUIET)
    plot.set_xlabel(xlabel)
    plot.set_ylabel(ylabel)
    plot.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, borderaxespad=0.2)
    return figure


def boundary(dots: np.ndarray, curve: np.ndarray) -> None:
    """Our onsets (n, 2) of beta and u on the exact curve (beta, u, ...)."""
    figure = boundary_figure(
        *dots.T, (curve[0], curve[1]), "exact (problem of Gregory & Païdoussis 1966)", "Tautline, 20 elements",
        "Stability of a cantilever that conveys fluid",
    )  # fmt: skip
    save(figure, IMAGES / "hose_boundary.png")


def portraits() -> None:
    """Phase portraits at three speeds, as Fig. 2.30 of the thesis."""
    keys = {"output__interval": "2 ms"}
    runs = [hoses.run(flow, 10.0, 5e-4, title=f"{flow:g} m/s", **keys) for flow in hoses.SPEEDS]
    figure = draw([run.result for run in runs], ["phase"])["phase"]
    figure.suptitle("Garden hose: limit cycles", x=0.01, ha="left", fontsize=12)
    save(figure, IMAGES / "hose_portraits.png")


def ramp() -> None:
    """Onset and amplitude while the speed rises from 0 to 40 m/s, with the ripple of a pump to start the motion."""
    rising, ripple = {"table": {"time": [0, 80], "value": [0, 40]}}, {"amplitude": 0.01, "frequency": "4.4 Hz"}
    speed = {"sum": [rising, {"harmonic": ripple}]}
    run = hoses.run(speed, 80.0, 1e-3, title="Garden hose: 0 to 40 m/s in 80 s", start="static")
    save(draw([run.result], ["ramp"])["ramp"], IMAGES / "hose_ramp.png")


def static() -> None:
    """Shapes at rest, as Fig. 2.28 of the thesis."""
    scene = hoses.changed({})
    found, s = forms(scene, [0.0, 3.0, 6.0, 9.0, 12.0]), arc_lengths(scene)
    tips = np.array([one.tip for one in found])
    speeds, curves = np.array([one.speed for one in found]), [one.curve(s) for one in found]
    save(static_figure(speeds, curves, tips, "Garden hose at rest"), IMAGES / "hose_static.png")


def flutter() -> None:
    """Modes against speed, finely enough to follow them through where pairs meet."""
    found = stability(hoses.changed({}), np.linspace(0.0, 21.0, 85))
    onset = (found.critical[0].speed, found.critical[0].frequency)
    figure = flutter_figure(
        found.speed, found.eigenvalues, found.out_of_plane, [onset], "Garden hose: modes", windows=found.windows
    )
    save(figure, IMAGES / "hose_flutter.png")


def write() -> None:
    """Draw those figures that need no table beside them."""
    for one in (static, flutter, portraits, ramp):
        one()
        print(f"wrote hose_{one.__name__}.png")
