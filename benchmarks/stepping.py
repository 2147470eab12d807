"""What it costs to step a simulation: an advance beside its steps, an input, an output, a state saved and restored."""

from __future__ import annotations

import time
from statistics import median

import jwell
from page import Section, number, show, table

import tautline

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
        "an advance, however many are read.\n\n" + table(header, rows)
    )
    headline = [
        ("an advance beside its steps, worst of five scenes", f"{number(worst)} us", f"at most {AT_MOST:g} us"),
        ("state of `hoist` saved and restored", f"{number(hoist)} us", f"at most {BOTH_AT_MOST:g} us"),
    ]
    return Section("Stepping", text, headline)


if __name__ == "__main__":
    show(measure, __doc__)
