"""What it costs to step a simulation: an advance beside its steps, an input, an output, a state saved and restored."""

from __future__ import annotations

import time
from statistics import median

import numba
import numpy as np

import tautline
from benchmarks import jwell
from benchmarks.page import Section, number, show, table

SCENES = {
    "hoist": ("winch.pay_out_speed", "payload.position", "winch.tension"),
    "sixteen_falls": ("winch.pay_out_speed", "hook block.position", "winch.tension"),
    "jwell": ("top.block_speed", "bit.speed", "hook_load"),
    "hose": ("water.speed", "tip.position", "axial_force"),
    "cantilever_bar": (None, "node 2.position", "axial_force"),
}
"""Scenes, an input of each, an output that is read from the state and one that is computed."""
ADVANCES, TIMES = 2000, 200
AT_MOST, BOTH_AT_MOST = 20.0, 100.0
"""Microseconds that an advance may cost beside its steps, and that save and restore may take together."""


def timed(function: object, times: int) -> float:
    """Median time of a call, us."""
    found = []
    for _ in range(times):
        began = time.perf_counter()
        function()  # type: ignore[operator]
        found.append(time.perf_counter() - began)
    return 1e6 * median(found)


def of(name: str, advances: int) -> tuple[float, ...]:
    """Advance beside its steps, its steps, input, both outputs, save, restore: us; of advances of one step each."""
    sim = tautline.Simulation(jwell.ROOT / "data" / f"{name}.yaml", keep=False)
    given, quick, computed = SCENES[name]
    h = sim.model.solver.step
    beside, steps = [], []
    for _ in range(advances):
        before, began = sim.wall_time, time.perf_counter()
        sim.advance(h)
        whole, own = time.perf_counter() - began, sim.wall_time - before
        beside.append(whole - own)
        steps.append(own)
    value = 0.0 if given is None else sim.inputs[given]

    def set_input() -> None:
        sim.inputs[given] = value

    def read_computed() -> None:
        sim._observed = None
        sim[computed]

    state = sim.save()
    return (
        1e6 * median(beside), 1e6 * median(steps), timed(set_input, TIMES) if given else 0.0,
        timed(lambda: sim[quick], TIMES), timed(read_computed, TIMES), timed(sim.save, TIMES),
        timed(lambda: sim.restore(state), TIMES),
    )  # fmt: skip


SPRING = {"stiffness": [1.0e4, 1.0e4, 0], "damping": [200, 200, 0], "rest": [12.4, 0, 5]}


def _spring(t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    force = -1.0e4 * (q - (12.4, 0.0, 5.0)) - 200.0 * v
    force[2] = 0.0
    return force


@numba.njit
def _compiled(t, q, v, force):
    force[0] = -1.0e4 * (q[0] - 12.4) - 200.0 * v[0]
    force[1] = -1.0e4 * q[1] - 200.0 * v[1]
    force[2] = 0.0


def forces(rounds: int) -> list[tuple[str, str]]:
    """Time of a step, us, of `hoist` with a spring at its load: of the scene, added as Python, added compiled."""
    free = tautline.read(jwell.ROOT / "data" / "hoist.yaml").replace({"start": "as drawn"})
    sims = {
        "none": tautline.Simulation(free, keep=False),
        "of the scene": tautline.Simulation(free.replace({"bodies[0].spring": SPRING}), keep=False),
        "added, compiled by numba": tautline.Simulation(free, keep=False),
        "added, in Python": tautline.Simulation(free, keep=False),
    }
    sims["added, compiled by numba"].add_force(_compiled, on="payload.position")
    sims["added, in Python"].add_force(_spring, on="payload.position")
    taken: dict[str, list[float]] = {name: [] for name in sims}
    for _ in range(rounds):
        for name, sim in sims.items():
            before = sim.wall_time
            sim.advance(0.25)
            taken[name].append(1e6 * (sim.wall_time - before) / 50.0)
    return [(name, number(median(times))) for name, times in taken.items()]


def measure(quick: bool) -> Section:
    """Each scene by itself; an advance is one step of the scene."""
    rows, worst, hoist = [], 0.0, 0.0
    for name in SCENES:
        beside, steps, given, place, computed, save, restore = of(name, 300 if quick else ADVANCES)
        worst = max(worst, beside)
        hoist = save + restore if name == "hoist" else hoist
        shown = (beside, steps, given, place, computed, save, restore)
        rows.append((f"`{name}`", *(number(x) for x in shown)))
    header = (
        "scene", "advance beside its steps", "one step", "input given", "position read", "force read", "save", "restore"
    )  # fmt: skip
    text = (
        "Microseconds, medians. An advance is one step of the scene; what it costs beside its steps is the same for "
        "many. A position or velocity is read from the state; a force is computed with all variables of a frame, once "
        "an advance, however many are read.\n\n"
        + table(header, rows)
        + "\nA step of `hoist` with a spring at its load, us:\n\n"
        + table(("spring", "step, us"), forces(6 if quick else 40))
    )
    headline = [
        ("an advance beside its steps, worst of five scenes", f"{number(worst)} us", f"at most {AT_MOST:g} us"),
        ("state of `hoist` saved and restored", f"{number(hoist)} us", f"at most {BOTH_AT_MOST:g} us"),
    ]
    return Section("Stepping", text, headline)


if __name__ == "__main__":
    show(measure, __doc__)
