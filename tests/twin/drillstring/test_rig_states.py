"""States of the rig are told from what is measured at the surface; the truth is that of a rig played from scripts."""

import numpy as np
import pytest

from drillstring.twin.states import RigStates, Settings
from twin.drillstring.scripted_rig import (
    Rig, circulate, connect, drill, play, ream, rest, rotate, slide, slips, trip,
)  # fmt: skip

STAND = 28.0
CONNECTION = [ream(40, -0.15), circulate(20), rest(10), trip(15, -0.2), trip(15, 0.2), rest(10), slips(20),
              connect(150, -STAND), rest(15), circulate(15), rotate(20)]  # fmt: skip
DRILLING = [rest(20), circulate(30), rotate(30), drill(600), *CONNECTION, drill(600), *CONNECTION, slide(400), drill(200)]
TRIP_OUT = [rest(20), *3 * [trip(60, -0.45), rest(8), slips(15), connect(110, STAND), rest(8)]]
TRIP_IN = [slips(25), *3 * [connect(110, -STAND), rest(8), trip(60, 0.45), rest(8), slips(15)], connect(110, -STAND),
           rest(10)]  # fmt: skip
REAMING = [ream(20, -0.15), rotate(60), *2 * [ream(100, -0.2), rotate(15), ream(90, 0.2), circulate(30)], drill(300)]
WELL = [*DRILLING, *REAMING, *TRIP_OUT]


def told(columns, **settings):
    rig = RigStates(Settings(**settings))
    names = [name for name in columns if name != "time"]
    return rig, [
        str(rig.add(t, **{name: columns[name][k] for name in names})) for k, t in enumerate(columns["time"])
    ]


def right(states, truth, time, tolerance):
    """Share of samples told rightly; within ``tolerance`` s after a change of the true state the old one passes too."""
    passed, old, changed = 0, truth[0], -np.inf
    for k, (state, true) in enumerate(zip(states, truth, strict=True)):
        if k and true != truth[k - 1]:
            # Of states that are passed through within the tolerance the one before them all is the old one.
            old = truth[k - 1] if time[k] - changed > tolerance else old
            changed = time[k]
        passed += state == true or (time[k] - changed < tolerance and state == old)
    return passed / len(truth)
