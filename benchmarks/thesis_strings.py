"""The drill strings of the thesis' section 2.9 again: figures 2.37 and 2.39 to 2.44."""

from __future__ import annotations

import numpy as np
import thesis_forms_figures as figures
import thesis_strings_jwell
import thesis_strings_motion
from page import Section, number, show, table
from thesis_forms import (
    Mesh,
    hanging_cable,
    hanging_lumps,
    level_cable,
    level_lumps,
    lumps_of_whole_elements,
)
from thesis_forms_figures import Form, Hung
from thesis_strings_rod import CASES, LENGTH, WHERE, Curve, exact, hanging, linear, rod

LUMPS = (10, 20)
PRINTED = ("what", "ours", "the thesis prints or draws", "difference, and why")
FIGURES = {"A": 39, "B": 40, "C": 41}
LONG = {"A": 240.0, "B": 440.0, "C": 240.0}
"""Length, m, of the long elements that the thesis draws."""


def measure(quick: bool) -> Section:
    """All figures of section 2.9 but 2.38, which is a sketch; ``quick`` draws none and takes fewer cases."""
    down, stretch = _hanging(quick)
    names = ("A",) if quick else tuple(CASES)
    parts = [_opening(), down, *(_level(name, quick) for name in names)]
    parts += [thesis_strings_motion.part(quick), thesis_strings_jwell.part(quick)]
    what = "drill string of 1000 m hanging dry: its stretch"
    beside = f"closed form {hanging(np.array([LENGTH]))[0]:.6f} m; thesis' FEM 0.38 m"
    return Section("Drill strings (thesis, section 2.9)", "".join(parts), [(what, f"{stretch:.6f} m", beside)])


def _opening() -> str:
    return (
        "The string of Table 2.3 (880 m of pipe, 120 m of collar) by lumps (`data/hanging.yaml`, "
        "`data/configuration_a.yaml` and so on, with other numbers of elements) and by ALE-ANCF cables written in the "
        "syntax of the thesis' Appendix A. Both are set beside solutions without a mesh that this script finds by "
        "itself: the closed form of the hanging bar, and the exact extensible rod by a boundary value solver. Second "
        "moments are those that Table 2.3 prints; the collar's is 0.3 % above that of its diameters. The thesis draws "
        "its curves and prints few numbers, so most rows have none to stand beside.\n"
    )


def _hanging(quick: bool) -> tuple[str, float]:
    """Section on Fig. 2.37, and the stretch by the fewest lumps, m."""
    fewest, most = (2, 4) if quick else (2, 50)
    chains = {n: hanging_lumps(n) for n in (fewest, 12, most)}
    hung = [
        Hung(f"{n} lumps", s, down, down - hanging(s)) for n, (s, down) in chains.items() if n != most
    ]  # fmt: skip
    meshes = {
        "ALE-ANCF, one element of pipe, one of collar": Mesh(LENGTH),
        "ALE-ANCF, elements of 40 m": Mesh(40.0),
        "ALE-ANCF, one and one, slopes apart": Mesh(LENGTH, apart=True),
    }
    bars = {name: _bar(name, mesh) for name, mesh in meshes.items()}
    linear_strain = _bar("", Mesh(LENGTH, apart=True, strain="engineering"))
    exact_stretch = float(hanging(np.array([LENGTH]))[0])
    whole = [
        Hung(f"{n} lumps of whole elements", s, lumps_of_whole_elements(s), s)
        for n, s in ((n, hanging_lumps(n)[0]) for n in (4, 12, 50))
    ]
    if not quick:
        s = np.linspace(0.0, LENGTH, 401)
        figures.hanging((s, hanging(s)), [*hung[:1], *bars.values()], whole)
    return _hanging_words(chains, bars, linear_strain, whole, exact_stretch), float(chains[fewest][1][-1])


def _bar(name: str, mesh: Mesh) -> Hung:
    s = np.unique(mesh.places)
    down = hanging_cable(mesh, s)
    return Hung(name, s, down, down - hanging(s))
