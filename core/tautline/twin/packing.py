"""What things hold, as JSON beside one block of bytes: floats and arrays to the bit, and nothing in it can be run.

Arrays and records are written once, however many things hold them, and are one again when they are read.
"""

from __future__ import annotations

import re
from collections import Counter, deque
from collections.abc import Collection, Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any

import numpy as np

KINDS = re.compile(r"[<|][fiub][1248]")
"""Kinds of numbers that an array may have."""


class Packing:
    """Writes values.

    Parameters
    ----------
    records : collection of type
        Dataclasses, named tuples and enumerations, such as rows: they are made anew with the values that they had, and
        a dataclass has no other attributes than its fields. Of anything else that has
        attributes only the values are written, to be put into a thing that there is already.

    Attributes
    ----------
    data : uint8 (n,)
        The block of bytes so far.
    """

    def __init__(self, records: Collection[type]) -> None:
        self._blocks: list[np.ndarray] = []
        self._size = 0
        self._names = {one: _name_of(one) for one in records}
        self._known: dict[int, int] = {}
        self._alive: list[Any] = []

    @property
    def data(self) -> np.ndarray:
        """The block of bytes."""
        return np.concatenate(self._blocks) if self._blocks else np.zeros(0, np.uint8)

    def held(self, thing: Any) -> dict[str, Any]:
        """All that a thing holds, for JSON, but for what it names in ``MADE_ANEW``."""
        without = getattr(thing, "MADE_ANEW", ())
        return {name: self.packed(value) for name, value in vars(thing).items() if name not in without}

    def packed(self, value: Any) -> Any:
        """A value for JSON; raises TypeError for what cannot be kept."""
        if type(value) in self._names:
            return self._once(value, self._record)
        if value is None or type(value) in (bool, int, float, str):
            return value
        if isinstance(value, np.ndarray):
            return self._once(value, self._array)
        if isinstance(value, np.generic):
            return {"scalar": self._array(np.asarray(value))}
        if isinstance(value, Mapping):
            kind = "counts" if isinstance(value, Counter) else "pairs"
            return {kind: [[self.packed(key), self.packed(one)] for key, one in value.items()]}
        if isinstance(value, deque):
            return {"deque": [self.packed(one) for one in value], "most": value.maxlen}
        if isinstance(value, (set, frozenset)):
            return {"set": [self.packed(one) for one in sorted(value)]}
        if isinstance(value, tuple) and not hasattr(value, "_fields"):
            return {"tuple": [self.packed(one) for one in value]}
        if isinstance(value, list):
            return [self.packed(one) for one in value]
        if hasattr(value, "__dict__") and not isinstance(value, type):
            return {"thing": self.held(value)}
        raise TypeError(f"{type(value).__name__} cannot be kept")

    def _once(self, value: Any, write: Any) -> Any:
        """Written where it comes first, and named after that."""
        known = self._known.get(id(value))
        if known is not None:
            return {"same": known}
        self._alive.append(value)  # its id is no other's meanwhile
        number = self._known[id(value)] = len(self._known)
        return {"number": number, **write(value)}

    def _record(self, value: Any) -> dict[str, Any]:
        name = self._names[type(value)]
        if isinstance(value, Enum):
            return {"record": name, "value": self.packed(value.value)}
        fields = dict(zip(value._fields, value, strict=True)) if hasattr(value, "_fields") else vars(value)
        return {"record": name, "of": {key: self.packed(one) for key, one in fields.items()}}

    def _array(self, value: np.ndarray) -> dict[str, Any]:
        begin, block = self._size, np.ascontiguousarray(value).reshape(-1).view(np.uint8)
        self._blocks.append(block)
        self._size += block.size
        return {"array": value.dtype.str, "shape": list(value.shape), "at": begin}


class Unpacking:
    """Reads what `Packing` has written; raises ValueError, TypeError, KeyError or IndexError for anything else.

    Fields that a record does not have any more are left out. For a record of a class that is none of `records` stands
    `Gone`: it is a fault only where something needs it.

    Parameters
    ----------
    records : collection of type
        Classes of which records may be.
    data : uint8 (n,)
    """

    def __init__(self, records: Collection[type], data: np.ndarray) -> None:
        self._data, self._records = data, {_name_of(one): one for one in records}
        self._known: dict[int, Any] = {}

    def value(self, packed: Any) -> Any:
        """The value that was packed; what a thing held is an instance of `Held`."""
        if isinstance(packed, list):
            return [self.value(one) for one in packed]
        if not isinstance(packed, dict):
            return packed
        if "same" in packed:
            return self._known[packed["same"]]
        if "array" in packed:
            return self._keep(packed, self._array(packed))
        if "record" in packed:
            return self._record(packed)
        return self._other(packed)

    def _other(self, packed: dict[str, Any]) -> Any:
        if "thing" in packed:
            return Held({name: self.value(one) for name, one in packed["thing"].items()})
        if "scalar" in packed:
            return self._array(packed["scalar"])[()]
        if "deque" in packed:
            return deque((self.value(one) for one in packed["deque"]), maxlen=packed["most"])
        for kind, make in (("set", set), ("tuple", tuple), ("pairs", dict), ("counts", _counter)):
            if kind in packed:
                values = [self.value(one) for one in packed[kind]]
                return make(values)
        raise ValueError(f"{list(packed)} says nothing")

    def _keep(self, packed: dict[str, Any], value: Any) -> Any:
        self._known[packed["number"]] = value
        return value

    def _record(self, packed: dict[str, Any]) -> Any:
        made = self._records.get(packed["record"])
        if made is None:
            return self._gone(packed)
        if issubclass(made, Enum):
            return self._keep(packed, made(self.value(packed["value"])))
        if not issubclass(made, tuple):
            return self._dataclass(packed, made)
        values = self._fields(packed, made._fields)  # type: ignore[attr-defined]
        return self._keep(packed, Gone() if holds_gone(values) else made(**values))

    def _dataclass(self, packed: dict[str, Any], made: type[Any]) -> Any:
        if not is_dataclass(made):
            raise TypeError(f"{packed['record']} has no fields")
        known = [one.name for one in fields(made)]
        needed = {name for name in known if not hasattr(made, name)}  # what has a plain default may be missing
        if not needed <= packed["of"].keys():
            raise ValueError(f"{packed['record']} lacks fields")  # it is one of another version of the program
        record = self._keep(packed, made.__new__(made))
        values = self._fields(packed, known)
        for key, one in values.items():
            object.__setattr__(record, key, one)
        return self._keep(packed, Gone()) if holds_gone(values) else record

    def _fields(self, packed: dict[str, Any], known: Collection[str]) -> dict[str, Any]:
        """Values of the fields that a record of this version has; the others are read, too: others may name them."""
        values = {key: self.value(one) for key, one in packed["of"].items()}
        return {key: one for key, one in values.items() if key in known}

    def _gone(self, packed: dict[str, Any]) -> Any:
        """Stands for a record of another version of the program, whose class is none of this one's."""
        for one in packed["of"].values() if "of" in packed else [packed["value"]]:
            self.value(one)
        return self._keep(packed, Gone())

    def _array(self, packed: dict[str, Any]) -> np.ndarray:
        kind, shape, begin = packed["array"], [int(n) for n in packed["shape"]], int(packed["at"])
        if not KINDS.fullmatch(kind) or begin < 0 or min(shape, default=1) < 0:
            raise ValueError(f"there is no array {kind} {shape} at {begin}")
        count = int(np.prod(shape, dtype=int))
        if count == 0:
            return np.zeros(shape, kind)
        return np.frombuffer(self._data, kind, count, begin).reshape(shape).copy()


class Gone:
    """What stands for a record of a class that is no more."""


def holds_gone(value: Any) -> bool:
    """Whether a value is, or holds, a record of a class that is no more; a record that needs one is none itself."""
    if isinstance(value, Mapping):
        return any(holds_gone(one) for pair in value.items() for one in pair)
    if isinstance(value, (list, tuple, deque, set)):
        return any(holds_gone(one) for one in value)
    return isinstance(value, Gone)


class Held(dict[str, Any]):
    """What a thing held, by name."""

    def lacks(self, thing: Any) -> bool:
        """Whether a thing needs what is no more. What a thing that is not laid out yet will need is not known: all."""
        if not hasattr(thing, "__dict__"):
            return holds_gone(self)
        own = vars(thing)
        return any(
            value.lacks(own[name]) if isinstance(value, Held) else holds_gone(value)
            for name, value in self.items()
            if name in own
        )

    def check(self, thing: Any) -> None:
        """Raise TypeError where a thing cannot hold it."""
        own = vars(thing)
        for name, value in self.items():
            if isinstance(value, Held) and name in own:
                value.check(own[name])

    def put(self, thing: Any) -> None:
        """Let a thing hold it. What the thing does not know, as another version of it has written it, is left out."""
        own = vars(thing)
        for name, value in self.items():
            if name not in own:
                continue
            if isinstance(value, Held):
                value.put(own[name])
            else:
                setattr(thing, name, value)


def _counter(pairs: list[Any]) -> Counter[Any]:
    return Counter(dict(pairs))


def _name_of(kind: type) -> str:
    return f"{kind.__module__}:{kind.__qualname__}"
