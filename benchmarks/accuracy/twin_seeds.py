"""How true deviations, alarms and health of twins are, over many seeds of noise: into docs/twin_accuracy.md.

``python -m benchmarks.accuracy.twin_seeds [--seeds 40] [--only SCENE]``. The machine is a finer model than the twin's:
more elements, shorter steps, another load or other friction. It runs once; its sensors get another noise by every seed.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

import numpy as np

import tautline
from benchmarks import ROOT
from benchmarks.page import table
from drillstring.twin.records import Connecting, connections
from tautline.integrators.status import StoppedEarly
from tautline.twin.twin import Twin

PAGE = ROOT / "docs" / "twin_accuracy.md"
BEGIN, END = "<!-- seeds: written by benchmarks/accuracy/twin_seeds.py -->\n", "<!-- end of seeds -->\n"
SEEDS = 40
QUIET = 4.0
"""Of a hoist, s: until then the weight is looked for, and nothing is judged."""
WRONG = 3.0
"""Standard deviations beyond which an estimate is wrong."""
AHEAD, LATEST = 2.0, 1.0
"""How far is looked ahead, and how long before a danger an alarm has to stand at the latest, s."""

HOIST = """
sensors:
  - {column: winch, unit: m, input: winch.pay_out}
  - {column: heave, unit: m, input: vessel.heave}
  - {column: rope, unit: N, output: winch.tension, sd: 500 N}
estimate:
  - {parameter: payload.mass, start: 9 t, sd: 4 t, range: [0.5 t, 20 t], drift: 1 kg/s^0.5}
window: 3 s
watch:
  - {output: winch.tension, above: 65 kN, ahead: 2 s, name: overload}
  - {output: min_tension, below: 1 kN, ahead: 2 s, name: slack rope ahead}
keep: [payload.position, winch.tension]
"""
RIG = """
sensors:
  - {column: block, unit: m, input: top.block, zero: first}
  - {column: rotary_speed, unit: rad/s, input: top.rotary_speed}
  - {column: hook_load, unit: N, output: top.hook_load, sd: 1 %}
  - {column: torque, unit: N m, output: surface_torque, sd: 1 %}
  - {column: bit_depth, unit: m, signal: bit_depth}
  - {column: hole_depth, unit: m, signal: hole_depth}
estimate:
  - {parameter: wall.friction, start: 0.4, sd: 0.2, range: [0.02, 0.8]}
  - {parameter: casing.friction, start: 0.1, sd: 0.2, range: [0.02, 0.8]}
ahead: 0 s
"""
RATE, RIG_RATE = 20.0, 2.5
"""Rows a second."""
HOW = Connecting(in_slips=30.0, drilling=60.0, travel=12.0, turning=16.0)


@dataclass
class Machine:
    """What there is: columns without noise (n,) by name, hidden quantities (n,) by name, and dangers by alarm, s."""

    time: np.ndarray
    columns: dict[str, np.ndarray]
    hidden: dict[str, np.ndarray]
    dangers: dict[str, float] = field(default_factory=dict)


@dataclass
class Study:
    """A twin beside a machine.

    Attributes
    ----------
    title : str
    scene, map : scene, str
        Of the twin.
    machine : callable
        Makes the machine.
    absolute, relative : mapping
        Column -> standard deviation of its noise, in its unit or as a share of what it shows.
    judged_from : float
        s.
    """

    title: str
    scene: Any
    map: str
    machine: Callable[[], Machine]
    absolute: Mapping[str, float] = field(default_factory=dict)
    relative: Mapping[str, float] = field(default_factory=dict)
    judged_from: float = QUIET


@dataclass
class Found:
    """What a twin said of one seed.

    Attributes
    ----------
    errors : dict
        Quantity -> errors (n,) and stated deviations (n,) of all rows that are judged.
    health : list of str
    false : list of str
        Names of alarms that came without a danger, and were not told as uncertain.
    missed : list of str
        Names of those that did not stand when they had to.
    length : float
        s.
    """

    errors: dict[str, tuple[np.ndarray, np.ndarray]]
    health: list[str]
    false: list[str]
    missed: list[str]
    length: float


def hoist() -> Machine:
    """The shipped hoist with a load of 5.3 t, twice the elements and shorter steps, until two blocks come together."""
    finer = {"mesh.elements_per_span": 8, "solver.step": "2 ms", "bodies[0].mass": "5.3 t", "solver.end": "20 s"}
    scene = tautline.read(ROOT / "data" / "hoist.yaml").replace(finer)
    sim = tautline.Simulation(scene, inputs=["winch.pay_out", "vessel.heave"], keep=False)
    rows: list[list[float]] = []
    stopped = np.inf
    for k in range(int(20.0 * RATE)):
        try:
            if k:
                sim.advance_to(k / RATE)
        except StoppedEarly:
            stopped = sim.time
            break
        height = float(sim["payload.position"][2])
        inputs = [float(sim.inputs[name]) for name in ("winch.pay_out", "vessel.heave")]
        rows.append([sim.time, *inputs, float(sim["winch.tension"]), height])
    time, winch, heave, rope, height_ = np.array(rows).T
    hidden = {"payload.mass": np.full(time.size, 5300.0), "payload.position": height_, "winch.tension": rope}
    columns = {"winch": winch, "heave": heave, "rope": rope}
    return Machine(time, columns, hidden, {"two-blocking ahead": stopped})


def _well(open_hole: float, cased: float, finer: bool) -> Any:
    """The shipped field well with a casing."""
    casing = {"shoe": 1200.0, "friction": cased}
    values: dict[Any, Any] = {("well", "wall", "friction"): open_hole, ("well", "wall", "casing"): casing}
    values |= {("solver", "step"): 5e-3, ("output", "interval"): 1.0 / RIG_RATE}
    if finer:
        values |= {("model", "elements"): 48, ("solver", "step"): 2e-3}
    return tautline.read(ROOT / "data" / "field_well.yaml").with_values(
        {path: (value, "the study over seeds") for path, value in values.items()}
    )


def rig() -> Machine:
    """Two connections of a string of twice the elements."""
    scene = _well(0.25, 0.2, finer=True)
    columns = connections(scene, count=2, rate=RIG_RATE, how=HOW, noise={})
    time = columns.pop("time")
    size = time.size
    return Machine(time, columns, {"wall.friction": np.full(size, 0.25), "casing.friction": np.full(size, 0.2)})


def studies() -> dict[str, Study]:
    """All of them by name."""
    scene = ROOT / "data" / "hoist.yaml"
    found = {"hoist": Study("hoist, 0.5 kN of noise of the load cell", scene, HOIST, hoist, {"rope": 500.0})}
    winch = "the same, 2 mm of the winch's encoder"
    found["winch_2"] = Study(winch, scene, HOIST, hoist, {"rope": 500.0, "winch": 0.002})
    for mm in (2.0, 5.0):
        noise = {"rope": 500.0, "winch": 1e-3 * mm, "heave": 1e-3 * mm}
        found[f"both_{mm:g}"] = Study(f"the same, {mm:g} mm of encoder and of heave", scene, HOIST, hoist, noise)
    noise = {"hook_load": 0.01, "torque": 0.01}
    title = "rig, two connections, 1 % of noise of hook load and torque"
    found["rig"] = Study(title, _well(0.4, 0.1, finer=False), RIG, rig, relative=noise, judged_from=0.0)
    return found


def rows_of(study: Study, machine: Machine, seed: int) -> Iterator[tuple[float, dict[str, float]]]:
    """Rows with the noise of a seed."""
    random = np.random.default_rng(seed)
    noisy = {}
    for name, values in machine.columns.items():
        size = study.absolute.get(name, 0.0) + study.relative.get(name, 0.0) * np.abs(values)
        noisy[name] = values + size * random.standard_normal(values.size)
    for k, t in enumerate(machine.time):
        yield float(t), {name: float(values[k]) for name, values in noisy.items()}


def found_with(study: Study, machine: Machine, seed: int) -> Found:
    """What a twin says of the noise of a seed."""
    twin = Twin(study.scene, study.map)
    lines: list[dict[str, Any]] = []
    for stamp, readings in rows_of(study, machine, seed):
        lines += twin.add(stamp, readings)
        twin.work()
    with suppress(StoppedEarly):  # The hoist ends 0.03 s before its blocks meet, and noise may take it there.
        lines += twin.finish()
    return judged(study, machine, lines)


def judged(study: Study, machine: Machine, lines: list[dict[str, Any]]) -> Found:
    """What lines are worth, beside what there is."""
    lines = [line for line in lines if line["time"] >= study.judged_from and line["outputs"]]
    at = np.searchsorted(machine.time, [line["time"] - 1e-6 for line in lines])
    errors = {}
    for name, truth in machine.hidden.items():
        pairs = np.array([_told(line, name) for line in lines])
        errors[name] = pairs[:, 0] - truth[at], pairs[:, 1]
    false: list[str] = []
    active: set[str] = set()
    for line in lines:
        now = {one["name"] for one in line["alarms"] if one["known"]}
        for name in now - active:
            danger = machine.dangers.get(name, np.inf)
            if not line["time"] <= danger <= line["time"] + AHEAD + 1.0:
                false.append(name)
        active = now
    missed = []
    for name, danger in machine.dangers.items():
        last = [line for line in lines if line["time"] <= danger - LATEST]
        if name not in {one["name"] for one in last[-1]["alarms"]}:
            missed.append(name)
    span = lines[-1]["time"] - lines[0]["time"]
    return Found(errors, [line["health"] for line in lines], false, missed, span)


def _told(line: Mapping[str, Any], name: str) -> tuple[float, float]:
    """Value and standard deviation of a quantity in a line; of a place its height."""
    if name in line["estimates"]:
        return line["estimates"][name]["value"], line["estimates"][name]["sd"]
    value, sd = line["outputs"][name], line["deviations"][name]
    return (value[2], sd[2]) if isinstance(value, list) else (value, sd)


def summary(study: Study, machine: Machine, all_found: Sequence[Found]) -> tuple[list[list[str]], list[str]]:
    """Rows of the table of quantities, and the row of alarms."""
    rows = []
    good = np.concatenate([np.array(one.health) == "good" for one in all_found])
    for name in machine.hidden:
        # The last row of every seed is one trial; rows of a seed are alike, and all of them count beside it.
        last = np.array([[one.errors[name][0][-1], one.errors[name][1][-1]] for one in all_found])
        off = np.concatenate([one.errors[name][0] for one in all_found])
        sd = np.concatenate([one.errors[name][1] for one in all_found])
        within = [f"{100.0 * np.mean(np.abs(off) <= times * sd):.0f} %" for times in (1.0, 2.0)]
        at_end = [f"{100.0 * np.mean(np.abs(last[:, 0]) <= times * last[:, 1]):.0f} %" for times in (1.0, 2.0)]
        of_trials = last[:, 0].mean(), np.sqrt(np.mean(last[:, 0] ** 2)), np.median(last[:, 1])
        numbers = [f"{one:.3g}" for one in of_trials]
        too_good = f"{100.0 * np.mean(good & (np.abs(off) > WRONG * sd)):.1f} %"
        rows.append([study.title, name, *numbers, *at_end, *within, too_good])
    hours = sum(one.length for one in all_found) / 3600.0
    false = [name for one in all_found for name in one.false]
    kinds = ", ".join(f"{name} {false.count(name)}" for name in sorted(set(false))) or "none"
    dangers = len(machine.dangers) * len(all_found)
    missed = f"{sum(len(one.missed) for one in all_found)} of {dangers}" if dangers else "no danger"
    alarms = [
        study.title, f"{hours:.2f} h", f"{len(false) / hours:.1f} ({kinds})", missed, f"{100.0 * good.mean():.0f} %"
    ]  # fmt: skip
    return rows, alarms


def text_of(names: Sequence[str], seeds: int) -> str:
    """Both tables."""
    rows: list[list[str]] = []
    alarms: list[list[str]] = []
    made: dict[Callable[[], Machine], Machine] = {}
    for name, study in studies().items():
        if names and name not in names:
            continue
        machine = made.setdefault(study.machine, made.get(study.machine) or study.machine())
        all_found = []
        for seed in range(seeds):
            all_found.append(found_with(study, machine, seed))
            print(f"{name}: seed {seed} of {seeds}", file=sys.stderr)
        more, alarm = summary(study, machine, all_found)
        rows += more
        alarms.append(alarm)
        print(table(HEADER, more) + "\n" + table(ALARMS, [alarm]), file=sys.stderr)
    return table(HEADER, rows) + "\n" + table(ALARMS, alarms)


HEADER = (
    "twin", "quantity", "bias at the end", "rms", "stated sd, median", "within 1 sd at the end", "2 sd",
    "1 sd, all rows", "2 sd, all rows", "good health, and 3 sd off",
)  # fmt: skip
ALARMS = ("twin", "watched for", "false alarms an hour", "missed dangers", "rows with good health")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the studies, and write the tables where all of them were run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=SEEDS, help="of noise")
    parser.add_argument("--only", nargs="+", default=(), choices=sorted(studies()), help="these, and write nothing")
    given = parser.parse_args(arguments)
    text = text_of(given.only, given.seeds)
    if not given.only:
        before, _, rest = PAGE.read_text(encoding="utf8").partition(BEGIN)
        said = f"{given.seeds} seeds:\n\n"
        PAGE.write_text(before + BEGIN + said + text + END + rest.partition(END)[2], encoding="utf8")
    print(text)


if __name__ == "__main__":
    main()
