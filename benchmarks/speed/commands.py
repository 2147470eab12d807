"""How long whole commands take: imports, reading, building and files included, of large scenes and of a short run.

``python -m benchmarks.speed.commands`` prints a table; ``--quick`` runs each once, on scenes of a tenth. The kernel
cache is filled first. Wall time is what a person waits, and needs an idle machine; processor time does not.
"""

from __future__ import annotations

import math
import tempfile
from pathlib import Path
from statistics import median

from benchmarks import jwell
from benchmarks.page import number, quick_asked, table
from benchmarks.speed.cold_start import seconds

ROWS, SECTIONS, LUMPS, ELEMENTS, PIECES = 60_000, 60_000, 100_000, 20_000, 100_000
DEPTH = 6000.0
"""Of the wells, m."""
REST = """  diameter: 0.2032 m
  wall: {{stiffness: 1.0e9, damping: 5.0e6, friction: {{static: 0.3, kinetic: 0.2}}}}
string: [{{name: drill pipe, length: rest, od: 0.127, id: 0.1086}}, {{name: BHA, length: 240 m, od: 0.165, id: 0.0572}}]
material: {{youngs_modulus: 200 GPa, shear_modulus: 79 GPa, density: 7850 kg/m^3}}
mud: {{density: 1200 kg/m^3}}
model: {{kind: lumped, elements: {elements}}}
solver: {{method: generalized-alpha, rho_inf: 0.1, step: 1 ms, end: {end}}}
output: {{interval: {end}}}
"""


def by_survey(folder: Path, rows: int) -> Path:
    """A smooth well in a CSV file: vertical, built to 80 degrees, turning all the way."""
    lines = ["md [m],inc [deg],azi [deg]"]
    for i in range(rows):
        s = DEPTH * i / (rows - 1)
        x = min(max((s - 600.0) / 3000.0, 0.0), 1.0)
        lines.append(f"{s:.6f},{80.0 * x * x * (3.0 - 2.0 * x):.6f},{40.0 + 60.0 * math.sin(s / 4000.0):.6f}")
    (folder / "rows.csv").write_text("\n".join(lines))
    return _written(folder / "survey.yaml", "well:\n  survey: rows.csv\n" + REST.format(elements=12, end="1 s"))


def by_sections(folder: Path, sections: int) -> Path:
    """A smooth well in the scene itself: builds and turns by turns, each one arc."""
    lines = ["well:", "  azimuth: 0.7", "  sections:", "    - {hold: 600 m}"]
    lines.append("    - {build: {radius: 1000 m, to: 5 deg}}")
    for i in range(1, (sections - 2) // 2 + 1):
        part = 2.0 * i / sections
        lines.append(f"    - {{build: {{radius: 1500 m, to: {5.0 + 75.0 * part:.8f} deg}}}}")
        lines.append(f"    - {{turn: {{radius: 1500 m, to: {0.7 + 0.8 * part:.9f}}}}}")
    return _written(folder / "sections.yaml", "\n".join(lines) + "\n" + REST.format(elements=12, end="1 s"))


def by_lumps(folder: Path, lumps: int) -> Path:
    """A vertical string of many lumps."""
    well = f"well:\n  sections: [{{hold: {DEPTH} m}}]\n"
    return _written(folder / "lumps.yaml", well + REST.format(elements=lumps, end="10 ms"))


def by_elements(folder: Path, elements: int) -> Path:
    """A level cable in the thesis' syntax; a file holds a million values at most, which are 50 000 elements."""
    lines = ["CableModelMaterial: {Gravity: [0, 0, -9.81], CableStiffness: 1.0e6, CableMass: 1.0}", "CableModel:"]
    for i in range(elements + 1):
        held = "1, 1, 1" if i in (0, elements) else "0, 0, 0"
        lines.append(f"  - Node7Dof: {{id: {i}, xyz: [{1000.0 * i / elements!r}, 0, 0], BC: [{held}, 0, 0, 0, 1]}}")
    lines += [f"  - CableALEelement: {{id: {i}, nodes7: [{i}, {i + 1}]}}" for i in range(elements)]
    lines.append("GeneralizedAlpha: {type: G-alpha, rho_inf: 0.6, time_step: 0.005, time_end: 0.05, plotpoints: 50}")
    return _written(folder / "cable.yaml", "\n".join(lines) + "\n")


def by_length(folder: Path, elements: int) -> Path:
    """A hose with water running through it, given by its length."""
    text = f"""hose:
  {{length: 1000 m, elements: {elements}, axial_stiffness: 1.0e6, bending_stiffness: 100, mass_per_length: 2}}
water: {{mass_per_length: 1.0, speed: 1.0}}
gravity: [0, 0, 0]
solver: {{method: generalized-alpha, step: 1 ms, end: 10 ms}}
output: {{interval: 10 ms}}
"""
    return _written(folder / "hose.yaml", text)


def by_line(folder: Path, elements: int) -> Path:
    """A hanging cable in the thesis' syntax, given as one item."""
    held = "BC: [1, 1, 1, 0, 0, 0, 1]"
    text = f"""CableModelMaterial: {{Gravity: [0, 0, -9.81]}}
CableModel:
  - Node7Dof: {{id: 0, xyz: [0, 0, 0], {held}}}
  - Node7Dof: {{id: 1, xyz: [1000, 0, 0], {held}}}
  - CableLine: {{id: 0, nodes7: [0, 1], elements: {elements}, length: 1100 m, EA: 1.0e7, EJ: 10, rhoA: 5}}
GeneralizedAlpha: {{type: G-alpha, rho_inf: 0.6, time_step: 0.005, time_end: 0.05}}
"""
    return _written(folder / "line.yaml", text)


def _written(path: Path, text: str) -> Path:
    path.write_text(text)
    return path


def main() -> None:
    """Print the table."""
    part, runs = (10, 1) if quick_asked(__doc__) else (1, 5)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        survey, sections = by_survey(folder, ROWS // part), by_sections(folder, SECTIONS // part)
        lumps, cable = by_lumps(folder, LUMPS // part), by_elements(folder, ELEMENTS // part)
        hose, line = by_length(folder, PIECES // part), by_line(folder, PIECES // part)
        commands = (
            (f"check, survey of {ROWS // part} rows", ("check", survey)),
            (f"simulate 1 s, survey of {ROWS // part} rows", ("simulate", survey)),
            (f"check, {SECTIONS // part} sections in the scene", ("check", sections)),
            (f"check, {LUMPS // part} lumps", ("check", lumps)),
            (f"simulate 10 steps, {LUMPS // part} lumps", ("simulate", lumps, "--no-verify")),
            (f"check, {ELEMENTS // part} elements of cable, each written", ("check", cable)),
            (f"check, {PIECES // part} elements of hose", ("check", hose)),
            (f"check, {PIECES // part} elements of cable, one item", ("check", line)),
            ("simulate data/jwell.yaml --end 1", ("simulate", jwell.SCENE, "--end", "1")),
        )
        rows = []
        for what, words in commands:
            times = [seconds(folder, folder, *map(str, words), command="tautline") for _ in range(1 + runs)]
            walls, cpus = zip(*times[1:], strict=True)
            rows.append((what, number(median(walls), 3), number(min(walls), 3), number(median(cpus), 3), runs))
    print(table(("command", "wall, s, median", "least", "processor, s, median", "runs"), rows))


if __name__ == "__main__":
    main()
