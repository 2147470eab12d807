"""All that a twin holds, so that another one goes on from it to the bit: also with a window that is half gone through.

What the scene and the map say is made anew. Of all else nothing is chosen: what a part holds is kept, whatever it is.
"""

from __future__ import annotations

import json
import time as clock
from typing import TYPE_CHECKING, Any

import numpy as np

from tautline.live.memory import State
from tautline.twin.alarms import Active
from tautline.twin.estimation.horizon import Sample
from tautline.twin.estimation.log import Checkpoint, Logged
from tautline.twin.estimation.passage import Passage
from tautline.twin.forecast import Found
from tautline.twin.operation import Blur
from tautline.twin.packing import Packing, Unpacking, holds_gone
from tautline.twin.restrictions import Departure
from tautline.twin.signals.row import Row

if TYPE_CHECKING:
    from tautline.twin.estimation.family import Family
    from tautline.twin.twin import Twin

RECORDS = (Active, Blur, Checkpoint, Departure, Found, Logged, Passage, Row, Sample, State)
OF_TWIN = (
    "now", "unsettled", "unsure", "doubts", "rests", "paused", "restarts", "_ends", "_ends_told", "starved", "blur",
)  # fmt: skip
OF_READINGS = ("zeros", "far", "stepped", "step_found", "rare_told")
OF_ESTIMATE = (
    "from_rest", "_plain", "_passage", "_pending", "_gathered", "_slopes", "_bounce", "_steep", "_steep_at", "_begin",
    "_held", "_without_start",
)  # fmt: skip
OF_FAMILY = ("at", "apart", "mixed", "trust", "steady", "rough", "blows_due")
OF_WATCH = ("_told_ahead", "_before", "_seen", "_seen_before_rest", "_irregular", "_down_from")
OF_OUTLOOK = (
    "found", "restricted", "_under_way", "_due", "_shown", "_next_forecast", "_next_restrict", "_waiting", "_begun",
)  # fmt: skip
"""What of those parts is kept that are mostly made of others."""


def memory_of(twin: Twin) -> tuple[np.ndarray, np.ndarray]:
    """All that a twin holds: as JSON, and the block of bytes beside it, uint8 (n,) both."""
    packing = Packing(_records(twin))
    families = {
        name: {"states": one.save(), "numbers": {key: vars(one)[key] for key in OF_FAMILY}}
        for name, one in _families(twin).items()
        if name != "spare" or twin.estimate.relinearising
    }
    some = {name: {key: vars(part)[key] for key in names} for name, (part, names) in _some(twin).items()}
    words = packing.packed({"families": families, "some": some, "whole": _whole(twin)})
    return np.frombuffer(json.dumps(words).encode(), np.uint8), packing.data


class Memory:
    """What `memory_of` gave of another twin, read and found whole: nothing is missing when it is put into a twin.

    Raises
    ------
    ValueError, TypeError, KeyError, IndexError, AttributeError
        For anything else, such as that of another version of the program.
    """

    def __init__(self, twin: Twin, words: np.ndarray, data: np.ndarray) -> None:
        read = Unpacking(_records(twin), data).value(json.loads(words.tobytes()))
        self._families, self._some, self._whole = read["families"], read["some"], read["whole"]
        self._check(twin)

    def _check(self, twin: Twin) -> None:
        """Find whether all is there that is put into a twin: it is refused before anything has been replaced."""
        count = len(twin.estimate.family.simulations)
        for one in self._families.values():
            if len(one["states"]) != count or not all(isinstance(state, State) for state in one["states"]):
                raise ValueError("there are other simulations")
        # What an operation has is laid out by what it recalls, and that comes yet.
        later = twin.operation.kept() if twin.operation is not None else {}
        parts = [*(self._some[name] for name in _some(twin)), *(one["numbers"] for one in self._families.values())]
        for held in (*parts, *(self._whole[name] for name in later if name in self._whole)):
            held.keys()
        for name in self._whole.keys() & (whole := _whole(twin)).keys() - later.keys():
            self._whole[name].check(whole[name])
        if self._lacks(twin):
            raise ValueError("it needs records of a class that is no more")

    def _lacks(self, twin: Twin) -> bool:
        """Whether something of it that this program needs was a record of another version, whose class is no more."""
        whole = {name: part for name, part in _whole(twin).items() if name in self._whole}
        some = [self._named(name, names) for name, (_, names) in _some(twin).items()]
        return holds_gone([self._families, some]) or any(self._whole[name].lacks(part) for name, part in whole.items())

    def put_watch(self, twin: Twin) -> None:
        """Let a twin go on with what sensors and alarms have shown, whatever its simulations hold.

        An overload that nothing shows to be over is none of the simulations' affair.
        """
        vars(twin.watch).update(self._named("watch", OF_WATCH))
        for name, part in _whole(twin).items():
            if name in self._whole and (name == "alarms" or name.startswith("health ")):
                self._whole[name].put(part)

    def put(self, twin: Twin) -> None:
        """Let a twin of the same scene and map go on from it."""
        for name, family in _families(twin).items():
            if name in self._families:
                family.restore(self._families[name]["states"])
                vars(family).update(self._families[name]["numbers"])
        for name, (part, names) in _some(twin).items():
            vars(part).update(self._named(name, names))
        for name, part in _whole(twin).items():
            if name in self._whole:
                self._whole[name].put(part)
        if "loss" not in self._whole:  # a twin of an earlier version ended where no simulation went on
            twin.loss.begun = twin.estimate.log.begun or twin.paused
        twin.readings.rows.gone_on(clock.monotonic())

    def _named(self, part: str, names: tuple[str, ...]) -> dict[str, Any]:
        """What is kept of a part that is mostly made of others, but for what it does not hold any more."""
        return {key: value for key, value in self._some[part].items() if key in names}


def _records(twin: Twin) -> tuple[type, ...]:
    return (*RECORDS, *(twin.operation.records if twin.operation is not None else ()))


def _families(twin: Twin) -> dict[str, Family]:
    """Families by name; the spare one says something only while it goes through a window."""
    return {"family": twin.estimate.family, "spare": twin.estimate.spare}


def _some(twin: Twin) -> dict[str, tuple[Any, tuple[str, ...]]]:
    """Parts that are mostly made of others, and the names of what they hold themselves."""
    begin = "at", "apart"
    return {
        "twin": (twin, OF_TWIN), "readings": (twin.readings, OF_READINGS), "estimate": (twin.estimate, OF_ESTIMATE),
        "begin": (twin.estimate.begin, begin), "watch": (twin.watch, OF_WATCH), "outlook": (twin.outlook, OF_OUTLOOK),
    }  # fmt: skip


def _whole(twin: Twin) -> dict[str, Any]:
    """Parts of which all is kept, but for what they name in ``MADE_ANEW``."""
    readings = twin.readings
    parts: dict[str, Any] = {
        "rows": readings.rows, "log": twin.estimate.log, "horizon": twin.estimate.horizon,
        "settling": twin.settling, "alarms": twin.watch.alarms, "loss": twin.loss,
    }  # fmt: skip
    parts |= {f"track {i}": one for i, one in enumerate(readings.tracks)}
    parts |= {f"health {i}": one for i, one in enumerate(readings.health)}
    parts |= {f"waves {name}": one for name, one in readings.waves.items()}
    return parts | (twin.operation.kept() if twin.operation is not None else {})
