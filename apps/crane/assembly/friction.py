"""Which contacts of a scene stick and slip: capstans, sheaves with an efficiency, bearings, brakes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from crane.assembly.layout import Layout
from crane.geometry.reeving import Path
from crane.groups.capstan_friction import BEARING, CAPSTAN, EFFICIENCY, NONE, TORQUE
from crane.groups.span import STATION, Spans
from crane.scene.scene import Drum, Efficiency, Sheave
from tautline.scene.functions import Constant, FunctionOfTime, Ramp
from tautline.system.time_functions import FunctionRequest, Steering

CLOSES = 1.0e-3
"""Time that a brake takes to close or open, s."""
HELD = 1.0e3
"""Stiffness of a drum that is held, over EA / R. With EA / R it would give way as R more of rope do: the load would
bounce slower and snap softer. With this the rope seems longer by a thousandth of R, less than any drawing says."""
MOST_EXPONENT = 100.0
"""Of Euler and Eytelwein's ratio: beyond it no rope slips, and the numbers come to an end."""
Row = dict[str, Any]


def contacts_of(layout: Layout) -> list[Row]:
    """Rows of ``SLIP`` of all contacts, in the order of the path."""
    rows: list[Row] = []
    for i, item in enumerate(layout.scene.path):
        if isinstance(item, Drum) and not item.prescribed:
            rows += _of_drum(layout, i, item)
        elif isinstance(item, Sheave):
            rows += _of_sheave(layout, i, item)
    return rows


def slips(sheave: Sheave) -> bool:
    """Whether a rope can slip on a sheave, by its law; that a bearing slips is no slip of the rope."""
    if isinstance(sheave.law, Efficiency):
        return sheave.law.efficiency < 1.0
    return sheave.law == "capstan" and sheave.groove_friction > 0.0


def groove_ratio(sheave: Sheave, path: Path, i: int) -> float:
    """Ratio of the tensions, 1 or more, up to which item i's rope sticks in its groove; infinite of `no_slip`."""
    if isinstance(sheave.law, Efficiency):
        return 1.0 / sheave.law.efficiency
    if sheave.law == "capstan":
        return math.exp(min(sheave.groove_friction * float(path.wraps[i]), MOST_EXPONENT))
    return 1.0 if sheave.law == "frictionless" else math.inf


def bearing_ratio(sheave: Sheave, path: Path, i: int) -> float:
    """Ratio of the tensions up to which the bearing of item i holds it against turning; 1 without its friction.

    With c = mu_b r_b / R and theta between the spans, T_2 - T_1 = c |F| and F^2 = T_1^2 + T_2^2 - 2 T_1 T_2 cos theta.
    The ratio q then has q + 1/q = 2 (1 - c^2 cos theta) / (1 - c^2), and from c = 1 on there is none.
    """
    if sheave.bearing is None:
        return 1.0
    c = sheave.bearing.friction * sheave.bearing.radius / sheave.radius
    if c >= 1.0:
        return math.inf
    half = (1.0 - c * c * float(path.spans[i - 1].e @ path.spans[i].e)) / (1.0 - c * c)
    return half + math.sqrt(max(0.0, half * half - 1.0))


def sticks_in_bearing(sheave: Sheave, path: Path, i: int) -> bool:
    """Whether item i, a capstan that may turn, never does from rest: its rope slips before its bearing gives way."""
    turns = sheave.law == "capstan" and not sheave.locked
    return turns and groove_ratio(sheave, path, i) < bearing_ratio(sheave, path, i)


def held_ratio(sheave: Sheave, path: Path, i: int) -> float:
    """Ratio of the tensions up to which item i holds its rope at rest, as drawn.

    A sheave that turns holds nothing but what its bearing does, and its groove has to bear that too.
    """
    groove = groove_ratio(sheave, path, i)
    turns = not sheave.locked and not isinstance(sheave.law, Efficiency)
    return min(groove, bearing_ratio(sheave, path, i)) if turns else groove


def stands_still(layout: Layout, i: int) -> bool:
    """Whether item i, a sheave, never turns: it is locked, or without inertia its bearing holds more than its groove.

    Without inertia the same force acts in both, and the weaker of them, with the wrap as drawn, gives way.
    """
    sheave = layout.scene.path[i]
    assert isinstance(sheave, Sheave)
    return sheave.locked or (i not in layout.rim and sticks_in_bearing(sheave, layout.path, i))


def most_groove_friction(layout: Layout, i: int) -> float:
    """Friction of the groove of item i, which stands still, from which its bearing would give way; else infinite."""
    sheave, wrap = layout.scene.path[i], float(layout.path.wraps[i])
    assert isinstance(sheave, Sheave)
    if sheave.locked or i in layout.rim or wrap <= 0.0:
        return math.inf
    return math.log(bearing_ratio(sheave, layout.path, i)) / wrap


def most_bearing_friction(layout: Layout, i: int) -> float:
    """Friction of the bearing of item i, which turns, up to which it gives way before the groove; else infinite.

    By `bearing_ratio`: c^2 = (q - 1)^2 / (q^2 + 1 - 2 q cos theta), with the ratio q of the groove.
    """
    sheave, path = layout.scene.path[i], layout.path
    assert isinstance(sheave, Sheave) and sheave.bearing is not None
    if sheave.law != "capstan" or i in layout.rim:
        return math.inf
    q, along = groove_ratio(sheave, path, i), float(path.spans[i - 1].e @ path.spans[i].e)
    square = 1.0 + 1.0 / (q * q) - 2.0 * along / q
    return (1.0 - 1.0 / q) / math.sqrt(square) * sheave.radius / sheave.bearing.radius if square > 0.0 else math.inf


def _of_sheave(layout: Layout, i: int, sheave: Sheave) -> list[Row]:
    rim, rows = layout.rim.get(i, NONE), []
    arc = max(float(layout.path.arcs[i]), sheave.radius)
    common: Row = {
        "before": layout.item[i] - 1,
        "after": layout.item[i],
        "stiffness": layout.scene.rope.axial_stiffness / arc,
        "function": NONE,
    }
    rope = {"p": layout.material(i), "by_p": layout.stretch, "s": NONE, "by_s": 0.0}
    if isinstance(sheave.law, Efficiency) and sheave.law.efficiency < 1.0:
        rows.append({"kind": EFFICIENCY, **common, **rope, "coefficient": 1.0 / sheave.law.efficiency - 1.0})
    if sheave.law == "capstan" and (rim != NONE or stands_still(layout, i)) and sheave.groove_friction > 0.0:
        both = rope | {"s": rim, "by_s": 1.0 if rim != NONE else 0.0}
        rows.append({"kind": CAPSTAN, **common, **both, "coefficient": sheave.groove_friction})
    if sheave.bearing is not None and sheave.bearing.friction > 0.0 and not stands_still(layout, i):
        share = sheave.bearing.friction * sheave.bearing.radius / sheave.radius
        turns = {"p": NONE, "by_p": 0.0, "s": rim, "by_s": 1.0} if rim != NONE else rope
        rows.append({"kind": BEARING, **common, **turns, "coefficient": share})
    return rows


def _of_drum(layout: Layout, i: int, drum: Drum) -> list[Row]:
    """A drum's brake, and the friction that it has at any speed."""
    rows = []
    common: Row = {
        "kind": TORQUE, "p": layout.material(i), "by_p": layout.stretch, "s": NONE, "after": NONE,
        "before": 0 if i == 0 else layout.item[-1] - 1,
        "stiffness": held_stiffness(layout.scene.rope.axial_stiffness, drum),
    }  # fmt: skip
    if drum.friction_torque > 0.0:
        always = layout.requests.add(FunctionRequest(Constant(value=1.0)))
        rows.append({**common, "coefficient": drum.friction_torque / drum.radius, "function": always})
    if drum.brake is not None and drum.brake.torque > 0.0:
        closed = layout.requests.add(
            FunctionRequest(closure_of(drum), key=f"path[{i}].drum.brake", inputs=_brake(drum))
        )
        rows.append({**common, "coefficient": drum.brake.torque / drum.radius, "function": closed})
    return rows


def held_stiffness(axial_stiffness: float, drum: Drum) -> float:
    """What brake and friction of a drum resist with until they slip, N by metres of rope."""
    return HELD * axial_stiffness / drum.radius


def springs_of(drum: Drum) -> int:
    """How many springs of that stiffness may hold a drum together: one of its brake, and one of its friction."""
    brakes = drum.brake is not None and drum.brake.torque > 0.0
    return 0 if drum.prescribed else int(brakes) + int(drum.friction_torque > 0.0)


def is_held(drum: Drum) -> bool:
    """Whether a drum has a brake or friction that may hold it."""
    return springs_of(drum) > 0


def closure_of(drum: Drum) -> FunctionOfTime:
    """How far a brake is closed, as a function of time."""
    assert drum.brake is not None
    if drum.brake.closed is not None:
        return drum.brake.closed
    if drum.brake.until is None:
        return Constant(value=1.0)
    return Ramp.model_validate({"from": 1.0, "to": 0.0, "over": CLOSES, "at": drum.brake.until})


def _brake(drum: Drum) -> tuple[Steering, ...]:
    return (Steering(f"{drum.name}.brake", "", "how far the brake is closed, from 0 to 1", least=0.0, most=1.0),)


def couplings_of(rows: list[Row], spans: Spans) -> list[np.ndarray]:
    """For each contact the degrees of freedom that it couples (1, k)."""
    stencils = []
    for row in rows:
        places = [row[key] for key in ("p", "s") if row[key] != NONE]
        for n in (row["before"], row["after"]):
            if n != NONE:
                for station in (int(spans.rows["a"][n]), int(spans.rows["b"][n])):
                    places += list(range(station, station + STATION))
        stencils.append(np.array([places], dtype=np.int64))
    return stencils
