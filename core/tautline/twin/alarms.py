"""Alarms: what is true, since when, and why."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from tautline.scene.values.printed import Teller, told_apart
from tautline.twin.pace import ONE_STAMP

CLEAR = 1.0
"""How long a condition has to be over before its alarm ends, s: one that flutters is one alarm."""
NOT_KNOWN = "not known any more"
"""How the text of an alarm begins of which nothing shows now whether it is over."""


@dataclass
class Active:
    """An alarm, with when its condition was seen last, whether it is known to hold still, and when it was so last."""

    since: float
    seen: float
    text: str
    known: bool = True
    certain: float = -math.inf


class Alarms:
    """Alarms by name."""

    def __init__(self) -> None:
        self.active: dict[str, Active] = {}
        self._begun: dict[str, float] = {}
        self._held: dict[str, float] = {}  # when each of them was shown last

    def judge(
        self,
        name: str,
        holds: bool,
        time: float,
        text: str,
        lasting: float = 0.0,
        known: bool = True,
        read: float = math.inf,
        forgotten_after: float = math.inf,
        flutters: bool = False,
    ) -> None:
        """Take notice of a condition at a time.

        Parameters
        ----------
        lasting : float
            How long it has to hold, s.
        known : bool
            Whether that is known; False of one that was seen, and of which nothing shows now whether it is over, and of
            one by a computed value whose deviation reaches beyond the bound.
        read : float
            When the last reading came, where readings alone show the condition, s: one that stands for a while has not
            lasted. Infinite where more than readings shows it.
        forgotten_after : float
            How long nothing may show the condition, nor that it is over, for its time to go on, s. Behind a longer
            silence it begins anew: two sights of it that far apart say nothing of what was between them.
        flutters : bool
            Whether it is not known only since a value is near its bound, where the next row may be certain again. What
            was certain is so for `CLEAR` still: a weaker sign of it does not tell less than none at all.
        """
        if not holds:
            self._begun.pop(name, None)
            self._held.pop(name, None)
            alarm = self.active.get(name)
            if alarm is not None and time - alarm.seen >= CLEAR - ONE_STAMP:
                del self.active[name]
            return
        # Of what began in a state of an earlier version nobody knows when it was shown last.
        shown = self._held.get(name, -math.inf if name in self._begun else time)
        if time - shown > forgotten_after + ONE_STAMP:
            self._begun[name] = time
        begun = self._begun.setdefault(name, time)
        self._held[name] = min(time, read)
        alarm = self.active.get(name)
        if alarm is not None and alarm.known and not known and flutters and time - alarm.certain < CLEAR - ONE_STAMP:
            self.active[name] = replace(alarm, seen=time)
        elif alarm is not None:
            self.active[name] = Active(alarm.since, time, text, known, time if known else alarm.certain)
        elif time - begun >= lasting - ONE_STAMP and (lasting <= 0.0 or read > begun):
            self.active[name] = Active(time, time, text, known, time if known else -math.inf)

    def pass_over(self) -> None:
        """Take notice of a time of which nothing is known: what had not lasted before it begins anew behind it."""
        self._begun.clear()
        self._held.clear()

    def told(self) -> list[dict[str, Any]]:
        """What stands in a line of the twin."""
        return [
            {"name": name, "since": one.since, "text": one.text, "known": one.known}
            for name, one in self.active.items()
        ]

    def by_name(self) -> tuple[dict[str, Any], ...]:
        """All that is held of alarms, each by their names."""
        return self.active, self._begun, self._held

    def memory(self) -> dict[str, Any]:
        """What a later process needs to go on."""
        return {name: [one.since, one.seen, one.text, one.known, one.certain] for name, one in self.active.items()}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Go on from what an earlier process kept."""
        self.active = {name: Active(float(a), float(b), str(c), *rest) for name, (a, b, c, *rest) in memory.items()}


def beyond(value: float, above: float, below: float) -> bool:
    """Whether a value is above the one bound or below the other."""
    return bool(value > above or value < below)


def bound_said(value: float, above: float, below: float, tell: Teller) -> str:
    """``61.2 kN, above 60 kN``, where `tell` says a value of it: with more digits where they would look the same."""
    high = value > above or not math.isfinite(below)
    word, bound = ("above", above) if high else ("below", below)
    said, limit = told_apart(value, bound, tell)
    return f"{said}, {word} {limit}"
