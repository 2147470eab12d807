"""How long a twin takes for a row, and what an hour of data does to it: written into docs/twin_accuracy.md.

``python -m benchmarks.speed.twins [--hour | --noise]``. Time is that of the thread: what else runs is not in it.
"""

from __future__ import annotations

import argparse
import gc
import resource
import sys
import time
from collections.abc import Sequence
from typing import Any

import numpy as np
import yaml

import tautline
from benchmarks import ROOT
from benchmarks.page import table
from tautline.twin.map.file import read_map
from tautline.twin.record import Sensing, record
from tautline.twin.twin import Twin

PAGE = ROOT / "docs" / "twin_accuracy.md"
RATE = 20.0
HOIST = """
sensors:
  - {column: winch, unit: m, input: winch.pay_out}
  - {column: heave, unit: m, input: vessel.heave}
  - {column: rope, unit: N, output: winch.tension, sd: 1 %}
estimate:
  - {parameter: payload.mass, start: 9 t, sd: 4 t, range: [0.5 t, 20 t], drift: 1 kg/s^0.5}
window: 3 s
watch:
  - {output: winch.tension, above: 80 kN, ahead: 2 s, name: overload}
  - {output: min_tension, below: 1 kN, ahead: 2 s, name: slack rope ahead}
  - {residual: winch.tension, above: 4 sd, for: 1 s, name: irregular}
"""
FALLS = """
sensors:
  - {column: winch, unit: m, input: winch.pay_out}
  - {column: rope, unit: N, output: winch.tension, sd: 1 %}
estimate:
  - {parameter: hook block.mass, start: 240 t, sd: 60 t, range: [20 t, 600 t], drift: 10 kg/s^0.5}
window: 3 s
ahead: 2 s
"""
JWELL = """
sensors:
  - {column: block, unit: m, input: top.block}
  - {column: hook_load, unit: N, output: top.hook_load, sd: 1 %}
estimate:
  - {parameter: wall.friction, start: 0.3, sd: 0.1, range: [0.02, 0.8]}
window: 3 s
ahead: 2 s
"""
NOISES = (0.0, 0.0002, 0.0005, 0.001, 0.002, 0.005)
"""Noise of the inputs of a hoist, m."""
SCENES = {"hoist": (HOIST, 20.0, 12.5), "sixteen_falls": (FALLS, 100.0, 20.0), "jwell": (JWELL, 50.0, 30.0)}
"""Scene -> map, what a row may take in the 99th percentile, ms, and the length of the record, s."""


def timed(scene: Any, map: str, end: float, rate: float = RATE) -> tuple[np.ndarray, list[dict[str, Any]]]:
    """Thread time of every row, ms, the first second left out; lines."""
    rows = list(record(scene, read_map(map), Sensing(rate=rate, noise=0.01), end))
    twin = Twin(scene, map)
    spent, lines = [], []
    for stamp, readings in rows:
        begin = time.thread_time()
        lines += twin.add(stamp, readings)
        spent.append(1e3 * (time.thread_time() - begin))
        # A forecast is run while the twin waits for data: it is not part of the answer.
        twin.work()
    return np.array(spent[int(rate) :]), lines


def rows_of_scenes() -> str:
    """The table of times."""
    rows = []
    for name, (map, allowed, end) in SCENES.items():
        spent, _ = timed(tautline.read(f"data/{name}.yaml"), map, end)
        rows.append((name, f"{np.median(spent):.1f} ms", f"{np.percentile(spent, 99):.1f} ms", f"{allowed:.0f} ms"))
    return table(("scene, 20 Hz", "a row, median", "99th percentile", "wanted"), rows)


def calm(end: float) -> Any:
    """A load that is hoisted and lowered again and again in waves, for so long."""
    root = yaml.safe_load(open("data/hoist.yaml"))
    root["rope"]["axial_stiffness"], root["rope"]["damping"] = 8e7, 1e-4
    # Speeds: five metres up and five down, with rests.
    times, speeds = [0.0], [0.0]
    while times[-1] < end:
        for speed in (-0.5, 0.5):
            times += [times[-1] + after for after in (15.0, 17.0, 25.0, 27.0)]
            speeds += [0.0, speed, speed, 0.0]
    root["path"][0]["drum"]["pay_out"] = {"table": {"time": times, "value": speeds}}
    root["solver"]["end"] = end
    return root


def hour(length: float) -> str:
    """Feed an hour at 10 Hz: alarms, how far the weight is off, and how memory grows."""
    scene = calm(length)
    twin = Twin(scene, HOIST)
    raised: dict[str, int] = {}
    active: set[str] = set()
    off, within, memory, spent = [], [], [], []
    for stamp, readings in record(scene, read_map(HOIST), Sensing(rate=10.0, noise=0.01), length):
        begin = time.thread_time()
        lines = twin.add(stamp, readings)
        spent.append(1e3 * (time.thread_time() - begin))
        twin.work()
        for line in lines:
            now = {one["name"] for one in line["alarms"]}
            for name in now - active:
                raised[name] = raised.get(name, 0) + 1
            active = now
            one = line["estimates"]["payload.mass"]
            if line["time"] > 20.0:
                off.append(one["value"] - 5000.0)
                within.append(abs(off[-1]) < 2.0 * one["sd"])
        if round(stamp * 10) % 3000 == 0:
            gc.collect()
            memory.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0)
            middle = np.median(spent[-3000:])
            print(f"{stamp:6.0f} s: {memory[-1]:.1f} MB at most, rows {middle:.1f} ms", file=sys.stderr)
    quarter = len(off) // 4
    said = ", ".join(f"{name} ({count})" for name, count in raised.items()) or "none"
    first, last = np.mean(off[:quarter]), np.mean(off[-quarter:])
    parts = (
        f"{length / 3600.0:.2g} h of hoisting and lowering in waves at 10 Hz, start off by 80 %: alarms {said}",
        f"memory {memory[1]:.0f} MB after five minutes, {memory[-1]:.0f} MB at the end",
        f"the weight of 5 t off by {first:.1f} kg on average in the first quarter, {last:.1f} kg in the last",
        f"with a standard deviation of {np.std(off):.1f} kg",
        f"within two stated deviations in {100.0 * np.mean(within):.0f} % of rows; {twin.restarts} restarts",
    )
    return "; ".join(parts) + ".\n"


def noise() -> str:
    """What noise of winch and motion sensor does to the weight and the tension of the hoist, by its size."""
    fine = {"mesh.elements_per_span": 8, "solver.step": "2 ms", "bodies[0].mass": "5.3 t"}
    plan, scene = HOIST.replace("1 %", "500 N"), ROOT / "data" / "hoist.yaml"
    rows = []
    for size in NOISES:
        sensing = Sensing(seed=1, rate=RATE, input_noise={"winch": size, "heave": size})
        twin = Twin(scene, plan)
        lines: list[dict[str, Any]] = []
        for stamp, readings in record(tautline.read(scene).replace(fine), read_map(plan), sensing, 12.0):
            lines += twin.add(stamp, readings)
            twin.work()
        late = [line for line in lines + twin.finish() if line["time"] > 4.0]
        off = np.array([line["outputs"]["winch.tension"] - line["measured"]["winch.tension"] for line in late]) / 1e3
        mass = late[-1]["estimates"]["payload.mass"]
        good = 100.0 * np.mean([line["health"] == "good" for line in late])
        found = f"{mass['value']:.0f} ± {2.0 * mass['sd']:.0f} kg"
        rows.append([f"{1e3 * size:g} mm", f"{off.std():.1f} kN", f"{abs(off).max():.1f} kN", found, f"{good:.0f} %"])
    header = ["noise", "computed less measured, sd", "largest", "weight at the end, two sd", "rows with good health"]
    return table(header, rows)


def write(mark: str, text: str) -> None:
    """Put a text between its marks in the page."""
    begin, end = f"<!-- {mark}: written by benchmarks/speed/twins.py -->\n", f"<!-- end of {mark} -->\n"
    before, _, rest = PAGE.read_text(encoding="utf8").partition(begin)
    PAGE.write_text(before + begin + text + end + rest.partition(end)[2], encoding="utf8")
    print(text)


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure what was asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--hour", action="store_true", help="an hour of calm hoisting in waves, in place of times")
    parser.add_argument("--length", type=float, default=3600.0, help="of it, s")
    parser.add_argument("--noise", action="store_true", help="what noise of its inputs does to a twin, instead")
    given = parser.parse_args(arguments)
    if given.noise:
        write("noise", noise())
    elif given.hour:
        write("hour", hour(given.length))
    else:
        write("times", rows_of_scenes())


if __name__ == "__main__":
    main()
