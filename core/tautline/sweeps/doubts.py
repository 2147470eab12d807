"""What makes the rows of a sweep less sure than they read: limits that cases fail, and values that are hardly meant.

A case that fails a limit has come to its end, and its numbers stand among those of the others: a rope that has parted
has a largest tension like any other. `simulate` says both of one run; here each is said once for all cases.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tautline.errors import TautlineError
from tautline.scene.values.printed import shown
from tautline.sweeps.cases import DONE, Row
from tautline.sweeps.file import ORIGIN
from tautline.sweeps.plans import AS_IN_THE_SCENE, Cases, Parameter, word_of


@dataclass
class Unsatisfied:
    """Limits that cases fail which came to their end.

    Attributes
    ----------
    cases : dict
        Name of the limit -> numbers of the cases, each once, also where a journal has it twice.
    """

    cases: dict[str, set[int]] = field(default_factory=dict)

    def of(self, rows: Iterable[Row]) -> Iterator[Row]:
        """The rows as they are, looked at as they pass."""
        for row in rows:
            for name in row.limits if row.status == DONE else ():
                self.cases.setdefault(name, set()).add(row.case)
            yield row

    def marked(self, name: str, count: int) -> np.ndarray:
        """Which of so many cases fail a limit, (count,) bool."""
        found = np.zeros(count, bool)
        found[sorted(self.cases.get(name, ()))] = True
        return found

    def warnings(self, count: int) -> list[str]:
        """A sentence for each limit, of so many cases in all."""
        if count == 1:
            return [f"{name} failed in the one case. Its numbers are given all the same" for name in self.cases]
        return [
            f"{name} failed in {len(cases)} of {count} cases, first case {min(cases)}. The numbers of such a case are "
            "among those of the others"
            for name, cases in self.cases.items()
        ]

    def told(self) -> list[dict[str, Any]]:
        """The same as records: limit, number of cases, and the first of them."""
        return [{"limit": name, "cases": len(some), "first_case": min(some)} for name, some in self.cases.items()]


def doubts_of_values(cases: Cases, scene: Any, warnings_of: Callable[[Any], Sequence[Any]]) -> list[str]:
    """What the scene's check says of the smallest and the largest value of each parameter, and not of the scene itself.

    Each place of the scene is told once. Two cases for each parameter are asked, however many there are: a check may
    take as long as a short run. A case whose scene is refused has a row that says so.
    """
    try:
        known = {(one.where, one.text) for one in warnings_of(scene)}
    except TautlineError:
        known = set()
    places = {place for place, _ in known}
    found: dict[str, str] = {}
    for case in _outermost(cases):
        try:
            varied = scene.replace(cases.changes(case), origin=ORIGIN)
            doubts = warnings_of(varied)
        except TautlineError:
            continue
        for doubt in doubts:
            if (doubt.where, doubt.text) not in known and doubt.where not in found and doubt.where not in places:
                values = _values(cases, case, str(getattr(scene, "units", "si")))
                found[doubt.where] = f"case {case}, {values}: {doubt.where}: {doubt.text}"
    return list(found.values())


def _outermost(cases: Cases) -> Iterator[int]:
    """The cases with the smallest and with the largest number of each parameter; of words the first of each."""
    asked: set[int] = set()
    for one in cases.parameters:
        if one.numeric:
            numbers = np.asarray(cases.numbers[one.key], float)
            some = [int(np.nanargmin(numbers)), int(np.nanargmax(numbers))]
        else:
            words = [word_of(value) for value in cases.values[one.key]]
            some = [words.index(word) for word in dict.fromkeys(words)][:2]
        for case in some:
            if case not in asked:
                asked.add(case)
                yield case


def _values(cases: Cases, case: int, system: str) -> str:
    """What all parameters of a case are: a doubt may be due to any of them, or to two together."""
    return ", ".join(f"{one.key} = {_value(cases, one, case, system)}" for one in cases.parameters)


def _value(cases: Cases, one: Parameter, case: int, system: str) -> str:
    if one.numeric and cases.values[one.key][case] is not AS_IN_THE_SCENE:
        return shown(float(cases.numbers[one.key][case]), one.unit, system)
    return str(word_of(cases.values[one.key][case]))
