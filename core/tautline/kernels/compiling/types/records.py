"""Records: named tuples that one compiled function hands to another by their address.

Numba hands over a tuple part by part, an array of it in seven words or more: half of all lines of the code that LLVM
read of a scene took records apart for a call or put them together behind one.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from llvmlite.ir import instructions
from numba.core import cgutils, types
from numba.core.datamodel.models import StructModel
from numba.core.typeconv import Conversion
from numba.extending import lower_cast, register_model


class Record(types.NamedTuple):
    """The type of a named tuple of ours."""

    def __init__(self, parts: Any, cls: type) -> None:
        super().__init__(parts, cls)
        self.name = f"record {self.name}"

    def __hash__(self) -> int:
        # Numba asks for it at each look into a table, and makes it of all parts' parts each time.
        if "_hash" not in self.__dict__:
            self._hash = hash(self.key)
        return self._hash

    def __getstate__(self) -> dict[str, Any]:
        """What is written with code that is kept: a hash of classes is another in each process."""
        return {name: value for name, value in self.__dict__.items() if name != "_hash"}

    def can_convert_from(self, typing: Any, other: Any) -> Any:
        """What a constructor in compiled code makes is a record, too."""
        same = isinstance(other, types.BaseNamedTuple) and other.instance_class is self.instance_class
        return Conversion.safe if same and tuple(other.types) == tuple(self.types) else None


@register_model(Record)
class RecordModel(StructModel):
    """How a record lies in memory: part after part, as numba holds any tuple; as an argument it is an address."""

    def __init__(self, manager: Any, kind: Record) -> None:
        super().__init__(manager, kind, [(f"f{i}", part) for i, part in enumerate(kind)])

    def get_argument_type(self) -> ir.Type:
        """How a function takes it."""
        return self.get_value_type().as_pointer()

    def as_argument(self, builder: ir.IRBuilder, value: ir.Value) -> ir.Value:
        """Where a record is that was handed over itself, or else a place of its own: nobody changes a record."""
        place = _place_of(builder, value)
        if place is None:
            place = cgutils.alloca_once(builder, self.get_value_type())
            builder.store(value, place)
        return place

    def from_argument(self, builder: ir.IRBuilder, value: ir.Value) -> ir.Value:
        """The record at an address."""
        return builder.load(value)


@lower_cast(types.BaseNamedTuple, Record)
def _recorded(context: Any, builder: Any, given: types.BaseNamedTuple, wanted: Record, value: Any) -> Any:
    """A record of what a constructor has made."""
    if given == wanted:
        return value
    parts = [
        context.cast(builder, part, has, wants)
        for part, has, wants in zip(cgutils.unpack_tuple(builder, value), given, wanted, strict=True)
    ]
    return context.make_tuple(builder, wanted, parts)


def _place_of(builder: ir.IRBuilder, value: ir.Value) -> ir.Value | None:
    """Address of what was handed over, or was read where Python has laid it out, and of a part of it.

    What was put into a tuple and taken out of it again, as arguments are, is found where it came from.
    """
    if isinstance(value, instructions.LoadInstr):
        (place,) = value.operands
        return place if isinstance(place, (ir.Argument, instructions.CastInstr)) else None
    if isinstance(value, instructions.ExtractValue):
        whole, indices = value.aggregate, list(value.indices)
        while isinstance(whole, instructions.InsertValue) and whole.indices[0] != indices[0]:
            whole = whole.aggregate
        if isinstance(whole, instructions.InsertValue):
            return _place_of(builder, whole.value) if list(whole.indices) == indices else None
        place = _place_of(builder, whole)
        return None if place is None else cgutils.gep_inbounds(builder, place, 0, *indices)
    return None
