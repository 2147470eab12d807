"""What has bent each piece of a rope over all operations: counted sample by sample, kept in a file.

A place of the rope counts half a bending cycle each time that an end of the rope on a sheave or a drum passes it, as in
`crane.rope_life.bending`. Each counts as many cycles at a fifth of the breaking load as its tension makes of it,

    (5 T / F_b)^m,    m = 5,

the S-N curve of wire ropes by which tension ranges are weighed too. Divided by the number of cycles that the rope lasts
at that tension, by its maker's tests, the sum is the damage (Palmgren and Miner).

Places are cells of a centimetre or so, counted from an end of the rope without a drum: this stays the same rope
whatever has been paid out. The file says which end: counted from the other one, damage would be that of another place.
"""

from __future__ import annotations

import json
import os
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from crane.rope_life.bending import RESOLUTION, Contact
from crane.rope_life.fatigue import SLOPE
from tautline.results.disk import cure_of
from tautline.results.errors import ResultError
from tautline.whole_file import whole_file

SHARE = 0.2
"""Tension, over the breaking load, at which the life of a rope is given."""
CELL = 0.01
"""Length of a cell, m."""
METRE = 1.0
FORMAT = 1


@dataclass(frozen=True)
class RopeOf:
    """What makes a rope this one: an account is refused for another. m, N; cycles at a fifth of the breaking load."""

    diameter: float
    breaking_load: float
    mass_per_length: float
    axial_stiffness: float
    life: float | None = None


@dataclass(frozen=True)
class CountedFrom:
    """The end of the path that places count from: what it is, as in the scene, and its name."""

    kind: str
    name: str

    @property
    def said(self) -> str:
        """In words."""
        return f"the {self.kind} {self.name}"


class Ripple:
    """An end of an arc without its turns to and fro of less than a length: `passages.without_ripple`, as it comes."""

    def __init__(self, least: float) -> None:
        self.least = least
        self.low = self.high = np.nan
        self.way = 0

    def moved(self, x: float) -> tuple[float, float] | None:
        """Where the end has gone from and to with one more position, m; None where it has not moved."""
        if not np.isfinite(self.low):
            self.low = self.high = x
            return None
        if self.way == 0:
            low, high = min(self.low, x), max(self.high, x)
            self.low, self.high = low, high
            if high - low < self.least or high == low:
                return None
            self.way = 1 if x == high else -1
            begin = low if self.way > 0 else high
            self.low = self.high = x
            return begin, x
        at = self.high if self.way > 0 else self.low
        further = (x - at) * self.way
        if further <= 0.0 and -further < max(self.least, 1e-12):
            return None
        self.way = self.way if further > 0.0 else -self.way
        self.low = self.high = x
        return at, x

    def memory(self) -> list[float]:
        """What another process needs to go on."""
        return [self.low, self.high, float(self.way)]

    def recall(self, memory: Sequence[float]) -> None:
        """Go on from that."""
        self.low, self.high, self.way = float(memory[0]), float(memory[1]), int(memory[2])


class RopeAccount:
    """Bending cycles and damage along a rope.

    Parameters
    ----------
    rope : RopeOf
    operation : str
        Of which operation rows will be counted: one that goes on after a kill has its name again.
    counted_from : CountedFrom, optional
        Which end places count from.

    Attributes
    ----------
    reached : float
        Time of the operation up to which rows were counted, s.
    """

    def __init__(self, rope: RopeOf, operation: str = "", counted_from: CountedFrom | None = None) -> None:
        self.rope, self.counted_from = rope, counted_from
        self.operations: list[dict[str, Any]] = []
        self._cycles, self._worked = np.zeros(1), np.zeros(1)
        self._ends: dict[str, Ripple] = {}
        self._bent: dict[str, bool] = {}
        self._told: tuple[float, float] | None = None
        self.reached = -np.inf
        self.begin(operation)

    def begin(self, operation: str) -> None:
        """Begin an operation; one that was counted last is gone on with, and no row of an earlier one counts again."""
        if self.operations and self.operations[-1]["name"] == operation:
            return
        counted = [one["to"] for one in self.operations if one["name"] == operation and one["to"] is not None]
        self.operations.append({"name": operation, "from": None, "to": None})
        # How the rope was moved between two operations nobody saw.
        self._ends, self._bent, self.reached = {}, {}, max(counted, default=-np.inf)

    # -- counting ------------------------------------------------------------------------------------------------------

    def add(self, time: float, contacts: Sequence[Contact], end: float) -> None:
        """Count a row; one that was counted already is passed over.

        Parameters
        ----------
        time : float
            s.
        contacts : sequence of Contact
            With histories of this one frame, (1,).
        end : float
            Material coordinate of the end that places count from, m: the first of the path or the last.
        """
        if time <= self.reached:
            return
        self.reached = time
        last = self.operations[-1]
        last["from"] = time if last["from"] is None else last["from"]
        last["to"] = time
        for contact in contacts:
            wrapped = bool(contact.on[0] != contact.off[0])
            bends = wrapped or self._bent.get(contact.name, False)
            self._bent[contact.name] = wrapped
            for k, place in enumerate((float(contact.on[0]), float(contact.off[0]))):
                if np.isfinite(place):
                    key = f"{contact.name} {k}"
                    ripple = self._ends.setdefault(key, Ripple(RESOLUTION * self.rope.diameter))
                    moved = ripple.moved(abs(end - place))
                    if moved is not None and bends:
                        self._pass(*moved, float(contact.tension[0]))

    def _pass(self, begin: float, end: float, tension: float) -> None:
        """Half a cycle for all cells whose middle lies in a stretch."""
        low, high = (int(np.ceil(x / CELL - 0.5)) for x in sorted((begin, end)))
        if high >= self._cycles.size:
            more = np.zeros(max(high + 1, 2 * self._cycles.size) - self._cycles.size)
            self._cycles, self._worked = np.append(self._cycles, more), np.append(self._worked, more)
        self._cycles[low:high] += 0.5
        self._worked[low:high] += 0.5 * (max(tension, 0.0) / (SHARE * self.rope.breaking_load)) ** SLOPE
        self._told = None

    # -- what it tells -------------------------------------------------------------------------------------------------

    def by_metre(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Middle of each metre from that end, m; cycles of its most bent cell; its most worked one's damage.

        Damage is in cycles at a fifth of the breaking load, or, where the rope's life is known, a share of that.
        """
        per = round(METRE / CELL)
        rows = int(np.ceil(self._cycles.size / per))
        cycles, worked = np.zeros(rows * per), np.zeros(rows * per)
        cycles[: self._cycles.size], worked[: self._worked.size] = self._cycles, self._worked
        most = worked.reshape(rows, per).max(axis=1) / (self.rope.life or 1.0)
        return METRE * (np.arange(rows) + 0.5), cycles.reshape(rows, per).max(axis=1), most

    @property
    def worst(self) -> tuple[float, float]:
        """Largest damage of all places, and where it is, m from the end that places count from."""
        if self._told is None:
            k = int(np.argmax(self._worked))
            self._told = float(self._worked[k]) / (self.rope.life or 1.0), CELL * (k + 0.5)
        return self._told

    # -- in a file -----------------------------------------------------------------------------------------------------

    def save(self, path: Path) -> None:
        """Write the account beside its place and then rename: there is a whole one at every moment.

        Raises
        ------
        ResultError
            Where that is not possible.
        """
        words = {
            "format": FORMAT, "rope": self.rope.__dict__, "cell": CELL, "operations": self.operations,
            "ends": {key: one.memory() for key, one in self._ends.items()}, "bent": self._bent,
            "reached": self.reached,
        }  # fmt: skip
        if self.counted_from is not None:
            words["from"] = self.counted_from.__dict__
        try:
            with whole_file(path) as waiting, waiting.open("wb") as file:
                text = np.frombuffer(json.dumps(words).encode(), np.uint8)
                np.savez_compressed(file, words=text, cycles=self._cycles, worked=self._worked)
                file.flush()
                os.fsync(file.fileno())
        except OSError as error:
            cause = f"the account cannot be written: {error.strerror}"
            raise ResultError(path, cause, cure_of(path, "give another file")) from None

    @classmethod
    def load(
        cls, path: Path, rope: RopeOf | None = None, operation: str | None = None,
        counted_from: CountedFrom | None = None, unsaid: CountedFrom | None = None,
    ) -> RopeAccount:  # fmt: skip
        """Read an account, to go on with it or to look at it.

        Parameters
        ----------
        rope : RopeOf, optional
            Which it must be of; its life may have been found anew.
        operation : str, optional
            Of which rows will be counted.
        counted_from : CountedFrom, optional
            Which end places must count from.
        unsaid : CountedFrom, optional
            Which one those of a file do that does not say it.

        Raises
        ------
        ResultError
            For what is no account, for that of another rope, and for one from another end.
        """
        cure = "give another file, or a name that is not taken for a new account"
        try:
            with np.load(path, allow_pickle=False) as file:
                words = json.loads(file["words"].tobytes())
                cycles, worked = file["cycles"], file["worked"]
            if words["format"] != FORMAT or words["cell"] != CELL:
                raise KeyError("format")
            kept = RopeOf(**words["rope"])
            begins = CountedFrom(**words["from"]) if "from" in words else unsaid
        except FileNotFoundError:
            raise ResultError(path, "there is no such file", cure) from None
        except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile):
            raise ResultError(path, "is no account of a rope", cure) from None
        if rope is not None:
            _same(path, kept, rope)
        if counted_from is not None and begins != counted_from:
            raise _from_another_end(path, begins, counted_from, "from" in words)
        made = cls(rope or kept, counted_from=begins)
        made.operations, made._cycles, made._worked = words["operations"], cycles, worked
        made._recall(words)
        if operation is not None:
            made.begin(operation)
        return made

    def _recall(self, words: Mapping[str, Any]) -> None:
        self._bent = {key: bool(value) for key, value in words["bent"].items()}
        self._ends = {}
        for key, memory in words["ends"].items():
            self._ends[key] = Ripple(RESOLUTION * self.rope.diameter)
            self._ends[key].recall(memory)
        self.reached = float(words["reached"])


def _same(path: Path, kept: RopeOf, rope: RopeOf) -> None:
    """Refuse an account of another rope."""
    for name in ("diameter", "breaking_load", "mass_per_length", "axial_stiffness"):
        one, other = getattr(kept, name), getattr(rope, name)
        if abs(one - other) > 1e-6 * abs(one):
            cause = f"is of another rope: its {name.replace('_', ' ')} is {one:g}, that of the scene {other:g}"
            raise ResultError(path, cause, "give the account of this rope, or a name that is not taken for a new one")


def _from_another_end(path: Path, kept: CountedFrom | None, asked: CountedFrom, written: bool) -> ResultError:
    """Places of a file count from one end, and those of the scene from another: damage would be told at wrong ones."""
    here = "those of the scene" if written else "this version counts those of the scene"
    known = f"from {kept.said}" if kept is not None else "from an end that it does not name"
    cure = "begin a new account, with a name that is not taken"
    if written:
        cure += ", or give the end in the scene the kind and name that it had"
    return ResultError(path, f"counts places of the rope {known}, and {here} from {asked.said}", cure)
