"""A drill string's two models beside each other: the tables of docs/two_models.md. With --quick nothing is written."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from benchmarks import jwell
from benchmarks.page import between, load, machine, number, quick_asked, table
from drillstring.model.build import build
from drillstring.model.prepared import well_of
from drillstring.scene.scene import BEAM, LUMPED, DrillstringScene
from drillstring.statics.form import find_form
from tautline.results.result import Result
from tautline.scene.model import validate
from tautline.scene.reading.document import Document
from tautline.simulation import simulate

DATA = jwell.ROOT / "data"
PAGE = jwell.ROOT / "docs" / "two_models.md"
BEGIN, END = "<!-- two models: written by benchmarks/accuracy/two_models.py -->", "<!-- end of two models -->"
LEVEL = ("configuration_a", "configuration_b", "configuration_c", "hanging")
WORDS = {LUMPED: "lumps", BEAM: "elements of a beam"}
STRINGS = ((LUMPED, 12), (LUMPED, 48), (BEAM, 12), (BEAM, 48))
AT_REST = ((LUMPED, 12), (LUMPED, 48), (LUMPED, 96), (LUMPED, 192), (BEAM, 12), (BEAM, 24), (BEAM, 48))
HEAVE = ((LUMPED, 12), (LUMPED, 48), (LUMPED, 96), (LUMPED, 192), (BEAM, 24), (BEAM, 48))
FINEST = (LUMPED, 192)
"""What the others of the J-well stand beside."""
HEAVE_TIME, QUICK_TIME = 40.0, 0.1


class Ran(NamedTuple):
    """A run of the J-well: its result, and wall time of a step, s."""

    result: Result
    step: float


def scene_of(name: str, kind: str, elements: int, end: float | None = None, still: bool = False) -> DrillstringScene:
    """A shipped scene as one model, cut into so many elements; ``still``, with a block that does not move."""
    document = Document.read(DATA / f"{name}.yaml")
    changes = {("model", "kind"): (kind, kind), ("model", "elements"): (elements, str(elements))}
    if end is not None:
        changes[("solver", "end")] = (end, str(end))
    if still:
        changes[("top", "block")] = (0.0, "0")
    return validate(DrillstringScene, document.replaced(changes))


def against_the_rod(quick: bool) -> str:
    """Table of strings in free space beside the exact extensible rod."""
    rows = []
    for name in LEVEL[:1] if quick else LEVEL:
        for kind, elements in STRINGS[::2] if quick else STRINGS:
            found = find_form(scene_of(name, kind, elements))
            one, rod = found.finest, found.reference.rod
            assert rod is not None
            off = found.difference(one)
            assert off is not None
            sag = float(np.abs(rod.locate(np.linspace(0.0, rod.length, 2001))[1]).max())
            said = "rounding" if off.max() < 1e-9 else _metres(float(off.max()))
            rows.append((f"`{name}`", f"{elements} {WORDS[kind]}", said, _metres(sag) if sag > 0.0 else "–"))
    return table(("scene", "string", "farthest from the exact rod", "sag"), rows)


def at_rest(quick: bool) -> str:
    """Table of the J-well at rest."""
    cases = (AT_REST[0], AT_REST[4]) if quick else AT_REST
    well = well_of(scene_of("jwell", LUMPED, 12))
    found = {}
    for kind, elements in cases:
        scene = scene_of("jwell", kind, elements, QUICK_TIME, still=True)
        result = simulate(build(scene))
        beyond = np.hypot(*np.moveaxis(result["lateral_displacement"][0], -1, 0)) - result["clearance"]
        side, length = float(result["contact_force"][0].sum()), well.length / elements
        found[kind, elements] = float(result["hook_load"][0]), side, float(beyond.max()), length
    finest = found[FINEST if FINEST in found else cases[0]]
    rows = [
        (
            f"{elements} {WORDS[kind]}", f"{length:.0f} m", f"{hook / 1e3:.2f} kN", _share(hook, finest[0]),
            f"{side / 1e3:.2f} kN", _share(side, finest[1]), f"{1e3 * beyond:.1f} mm",
        )
        for (kind, elements), (hook, side, beyond, length) in found.items()
    ]  # fmt: skip
    head = ("string", "length of each", "hook load", "differs by", "side force in all", "differs by")
    return table((*head, "farthest in the wall"), rows)


def under_heave(quick: bool) -> str:
    """Table of the J-well under heave, friction 0.3 and 0.2."""
    end = QUICK_TIME if quick else HEAVE_TIME
    runs = {case: _run(*case, end) for case in ((HEAVE[0], HEAVE[4]) if quick else HEAVE)}
    finest = runs[FINEST if FINEST in runs else next(iter(runs))].result
    rows = []
    for (kind, elements), ran in runs.items():
        bit, hook = (ran.result[name] - finest[name] for name in ("bit_depth", "hook_load"))
        apart = f"{1e3 * np.abs(bit).max():.1f} mm", f"{np.sqrt(np.mean(hook**2)) / 1e3:.1f} kN"
        rows.append(
            (
                f"{elements} {WORDS[kind]}", f"{np.ptp(ran.result['bit_depth']):.4f} m",
                *(("–", "–") if ran.result is finest else apart), f"{1e6 * ran.step:.0f} µs",
            )
        )  # fmt: skip
    head = ("string", "bit displacement", "bit apart, at most", "hook load apart, rms", "wall time of a step")
    return table(head, rows)


def _run(kind: str, elements: int, end: float) -> Ran:
    simulate(build(scene_of("jwell", kind, elements, QUICK_TIME)))
    result = simulate(build(scene_of("jwell", kind, elements, end)))
    return Ran(result, float(result.attributes["wall_time"]) / float(result.attributes["steps"]))


def _metres(value: float) -> str:
    """A length as it reads best."""
    for least, unit in ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm")):
        if value >= least:
            return f"{number(value / least, 3)} {unit}"
    return f"{value:.1e} m"


def _share(value: float, finest: float) -> str:
    return f"{100.0 * (value / finest - 1.0):+.3f} %" if value != finest else "–"


def part(quick: bool) -> str:
    """All three tables, each below what it shows."""
    before = load()
    head = f"{FINEST[1]} {WORDS[FINEST[0]]}"
    tables = (
        f"Strings in free space beside the exact extensible rod:\n\n{against_the_rod(quick)}\n"
        f"The J-well at rest, beside {head}; a node or lump in the wall is beyond its clearance by so much:\n\n"
        f"{at_rest(quick)}\n"
        f"The J-well under {HEAVE_TIME:.0f} s of heave, friction 0.3 and 0.2, by generalized-alpha at 1 ms, beside "
        f"{head}:\n\n{under_heave(quick)}"
    )
    return f"{BEGIN}\n{tables}\nMeasured: {machine(before)}.\n{END}"


def main() -> None:
    quick = quick_asked(__doc__)
    text = part(quick)
    print(text)
    if not quick:
        PAGE.write_text(between(PAGE.read_text(encoding="utf8"), text, BEGIN, END), encoding="utf8")


if __name__ == "__main__":
    main()
