"""One storm of three hours: sixteen falls, six motions of the vessel in a sea, three frames. Time and memory of all.

    python -m benchmarks.speed.storm [--duration 10800] [--step 0.02]

prints the time of the whole command over that of the storm, the share of the compiled loop, and the most memory that
was used. It keeps statistics: every frame of this scene takes 7 kB.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks import ROOT

DATA = ROOT / "data"
MOTIONS = ("surge", "sway", "heave", "roll", "pitch", "yaw")
FRAMES = """frames:
  - {name: crane, pivot: [-12, 0, 0], slew: {constant: 0}}
  - {name: boom, parent: crane, pivot: [0, 0, 5], luff: {constant: 0}}
"""


def response() -> str:
    """A made-up vessel: it follows long waves and none that are short."""
    lines = [
        "period [s]," + ",".join(f"{m} [{'deg/m' if i > 2 else 'm/m'}],{m} phase [deg]" for i, m in enumerate(MOTIONS))
    ]
    for period in (3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 14, 16, 20, 25, 30):
        follows = 1.0 / (1.0 + (8.0 / period) ** 4)
        sizes = (0.5, 0.5, 0.9, 1.2, 0.8, 0.4)
        cells = [f"{follows * size:.4f},{phase}" for size, phase in zip(sizes, (90, 20, 0, 75, 100, -40), strict=True)]
        lines.append(f"{period}," + ",".join(cells))
    return "\n".join(lines) + "\n"


def scene(duration: float, step: float, keep: str) -> str:
    """The storm's scene."""
    text = (DATA / "sixteen_falls.yaml").read_text()
    head, _, _ = text.partition("vessel:")
    head = head.replace("pay_out: {ramp: {to: -1.0, over: 2.0}}", "pay_out: {constant: 0}")
    head = head.replace("{name: crown", "{frame: boom, name: crown").replace("{name: dead", "{frame: boom, name: dead")
    return (
        head
        + FRAMES
        + (
            "vessel:\n  reference: [-12, 0, 0]\n"
            "  motion: {sea: {significant_height: 1.0, peak_period: 7, seed: 1, ramp: 20}, rao: vessel.csv}\n"
            f"solver: {{method: generalized-alpha, rho_inf: 0.6, step: {step} s, end: {duration} s}}\n"
            f"output: {{interval: {max(step, 0.05)} s, keep: {keep}}}\n"
        )
    )


def main() -> None:
    """Run it as a command of its own, and print what it took."""
    reader = argparse.ArgumentParser()
    reader.add_argument("--duration", type=float, default=10800.0)
    reader.add_argument("--step", type=float, default=0.02)
    reader.add_argument("--keep", default="statistics")
    asked = reader.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        (place / "vessel.csv").write_text(response())
        (place / "storm.yaml").write_text(scene(asked.duration, asked.step, asked.keep))
        command = [sys.executable, "-m", "crane.main", "simulate", "storm.yaml", "--json", "-q"]
        began = time.perf_counter()
        done = subprocess.run(command, cwd=place, capture_output=True, text=True, check=False)
        wall = time.perf_counter() - began
        if done.returncode:
            sys.exit(done.stderr)
        report = json.loads(done.stdout)
        memory = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
        size = (place / "storm.nc").stat().st_size / 1e6
    print(f"storm of {asked.duration:g} s, step {asked.step:g} s, {asked.keep}")
    print(f"{wall:.1f} s in all, 1/{asked.duration / wall:.0f} of real time")
    print(f"compiled loop {report['cpu_time']:.1f} s, {1e6 * report['cpu_time'] / report['steps']:.0f} us a step")
    print(f"memory {memory:.0f} MB, result {size:.1f} MB, frames {report['frames']}")
    for key in ("newton_iterations", "max_tension", "min_tension", "energy_error", "phase_lag"):
        print(key, report.get(key))


if __name__ == "__main__":
    main()
