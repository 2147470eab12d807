"""Error of the bit in the J-well with one friction factor, against a converged run and an independent simulation."""

from __future__ import annotations

import csv

import numpy as np

from benchmarks import jwell
from benchmarks.page import Section, show, table

HISTORY = jwell.ROOT / "tests" / "references" / "jwell_bit_history.csv"
MU = 0.2
STUCK_BELOW = 0.999
"""Share of mu N below which friction holds the bit."""


def independent() -> np.ndarray:
    """Displacement of the bit every 0.05 s (801,), m, by code that shares nothing with Tautline."""
    with HISTORY.open(encoding="utf8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return np.array([float(row["bit_displacement"]) for row in rows])


def stuck_speed(run: jwell.Run) -> float:
    """Largest speed of the bit in the frames where friction holds it, m/s."""
    result = run.result
    friction = np.hypot(result["friction_force"][:, -1], result["friction_around"][:, -1])
    held = friction < STUCK_BELOW * MU * result["contact_force"][:, -1]
    # The frame at t = 0 has no step behind it: friction is unknown there.
    return float(np.abs(result["bit_speed"][1:][held[1:]]).max())


def measure(quick: bool) -> Section:
    """Friction 0.2/0.2, projection, generalized-alpha at several steps."""
    end, finest, steps = (
        (2.0, 1e-3, (1e-2,)) if quick else (40.0, jwell.FINEST, (jwell.SECOND, 1e-4, 1e-3, 2e-3, 5e-3, 1e-2))
    )
    exact = jwell.converged(MU, MU, end, finest)
    other = independent()[: exact.displacement.size]
    keys = jwell.friction(MU, MU) | {"output__interval": jwell.INTERVAL}
    rows, headline = [], []
    for step in (finest, *steps):
        run = exact if step == finest else jwell.run("generalized-alpha", step, end, **keys)
        to_exact, to_other = run.displacement - exact.displacement, run.displacement - other
        errors = [size for error in (to_exact, to_other) for size in (jwell.rms(error), np.abs(error).max())]
        row = (*errors, stuck_speed(run))
        rows.append((f"{step:g}", *(f"{x:.1e}" if x > 0.0 else "–" for x in row), run.attributes["halvings"]))
        if step in (1e-3, 1e-2):
            what = f"error of the bit over {end:g} s (RMSE), friction {MU:g}, {1000 * step:g} ms"
            headline.append((what, f"{1000 * row[0]:.2g} mm", f"stroke of the bit: {np.ptp(exact.displacement):.2f} m"))
    header = (
        "step, s", "RMSE against the converged run, m", "largest", "RMSE against the independent simulation, m",
        "largest", "largest speed while stuck, m/s", "step halvings",
    )  # fmt: skip
    text = (
        f"Bit displacement along the hole over {end:g} s, every 50 ms; generalized-alpha, exact friction, static and "
        f"kinetic factor {MU:g}. The converged run has a step of {finest:g} s. The independent simulation is "
        "`tests/references/planar_well_dynamics.py`: a planar model, RK4 with every change of contact located, which "
        "states an error of 1e-9 m.\n\n" + table(header, rows)
    )
    return Section("Accuracy", text, headline)


if __name__ == "__main__":
    show(measure, __doc__)
