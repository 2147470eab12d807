"""A hoist of one second, for sweeps that are over soon."""

from pathlib import Path

import tautline

HOIST = Path(__file__).parents[2] / "data" / "hoist.yaml"
PERIOD, MASS = "vessel.motion.heave.harmonic.period", "bodies[0].mass"


def hoist(end=1.0, **changes):
    return tautline.read(HOIST).replace({"solver.end": end, **changes})


def write_sweep(folder, text, end="1 s"):
    """Write scene and sweep into a folder; returns the sweep's path."""
    scene = HOIST.read_text(encoding="utf8").replace("end: 12 s", f"end: {end}")
    (folder / "hoist.yaml").write_text(scene, encoding="utf8")
    path = folder / "limits.yaml"
    path.write_text(f"scene: hoist.yaml\n{text}", encoding="utf8")
    return path
