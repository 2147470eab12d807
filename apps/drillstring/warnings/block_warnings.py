"""What to tell a user about the block over a bit on bottom: the weight on bit that its way makes within the run."""

from __future__ import annotations

import numpy as np

from drillstring.drilling.weight_of_run import WeightOfRun, drills, is_of_the_scene, weight_of_run
from drillstring.model.prepared import Prepared
from drillstring.scene.scene import DrillstringScene
from drillstring.warnings.hole_warnings import Sentences
from tautline.scene.values.printed import shown

OFF = 0.05
"""Change of the weight on bit over what it is at the start, that is reported."""


def penetration(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """A block whose way changes the weight on bit: one that is not lowered as fast as the bit drills, or moved else."""
    if not scene.bit.on_bottom or not is_of_the_scene(scene):
        return
    run = weight_of_run(scene, ready.lumps.tubes)
    if not _changes(run, scene.bit.weight or 0.0):
        return
    what, then = _cause(scene, run), _of_the_run(scene, run)
    yield "top.block", f"{what}. {then[0].upper()}{then[1:]}" if then else what


def _changes(run: WeightOfRun, start: float) -> bool:
    """Whether the weight leaves that of the start, N, in the run or behind its end."""
    told = [float(run.weight[-1]), float(run.weight.max()), float(run.weight.min())]
    if run.to_come is not None:
        told.append(run.to_come)
    return any(abs(weight - start) > OFF * start for weight in told)


def _cause(scene: DrillstringScene, run: WeightOfRun) -> str:
    """How the block moves at the end, and where the weight goes by it if all goes on so."""
    if run.to_come is None:
        return "changes the weight on bit, and does not move steadily at the end of the run"
    if np.isinf(run.to_come):
        return _pushed_on(_rate(scene, run.feed), run.spin) if drills(scene) else _not_drilled(_rate(scene, run.feed))
    found = shown(run.to_come, "N", scene.units)
    drilled = f" and the bit drills {_rate(scene, run.rate)} with the weight of the start" if run.rate > 0.0 else ""
    turned = ""
    if run.feed > 0.0 and not run.keeps:
        speed = shown(run.spin * 30.0 / np.pi, "rpm", scene.units)
        turned = f" with the rotary's last speed, {speed}, which it does not keep"
    return f"{_moves(scene, run)}{drilled}: the weight on bit goes to {found}{turned}"


def _moves(scene: DrillstringScene, run: WeightOfRun) -> str:
    """What the block does at the end."""
    if run.feed == 0.0:
        return "is held" if run.still else "is held at the end"
    return f"is {'raised' if run.feed < 0.0 else 'lowered'} at {_rate(scene, abs(run.feed))} at the end"


def _of_the_run(scene: DrillstringScene, run: WeightOfRun) -> str:
    """Weight on bit at the end of the run where it is still on its way, and the largest and least where they differ."""
    last, peak, low = float(run.weight[-1]), int(run.weight.argmax()), int(run.weight.argmin())
    start, said = scene.bit.weight or 0.0, []
    goes = last if run.to_come is None else run.to_come
    if run.to_come is None or abs(goes - last) > OFF * max(start, last):
        said.append(f"{shown(last, 'N', scene.units)} at the end of the run")
    if run.weight[peak] > (1.0 + OFF) * max(start, last):
        said.append(f"{shown(float(run.weight[peak]), 'N', scene.units)} at most, at t = {run.time[peak]:.4g} s")
    if run.weight[low] < min(start, last, goes) - OFF * max(start, last):
        said.append(f"{shown(float(run.weight[low]), 'N', scene.units)} at least, at t = {run.time[low]:.4g} s")
    return f"without friction it is {', and '.join(said)}{_seen(run)}" if said else ""


def _seen(run: WeightOfRun) -> str:
    """How much of a run with too many waves is looked at."""
    if run.followed >= run.time[-1]:
        return ""
    part = f"{run.followed:.4g} s"
    return f". That is from every wave of the first and of the last {part}, and from single instants between them"


def _not_drilled(feed: str) -> str:
    """That a bottom is pushed on which nothing drills."""
    cause = f"lowers the bit at {feed} onto a bottom that is not drilled"
    return f"{cause}; give bit.penetration or bit.cutting, or hold the block"


def _pushed_on(feed: str, spin: float) -> str:
    """That a bit which does not cut is pushed onto the bottom at a rate, and what to do."""
    why = "The bit does not turn then, and does not cut"
    cure = "Give top.rotation a speed"
    if spin < 0.0:
        why = "The bit turns backwards then, and a bit that turns backwards does not cut"
        cure = "Give top.rotation a positive speed, which is clockwise looking down the hole"
    return (
        f"is lowered at {feed} at the end. {why}. The hole gets no deeper, so the weight on bit grows for as long as "
        f"the block is lowered. {cure}, or hold the block"
    )


def _rate(scene: DrillstringScene, rate: float) -> str:
    """A rate of penetration in the units of the scene."""
    return shown(3600.0 * rate, "m/h", scene.units, digits=3)
