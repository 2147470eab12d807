"""Compiled code with its arguments laid out in memory once: a call costs a microsecond, however many arrays there are.

Python hands over the arrays of named tuples one by one, about a tenth of a microsecond each: for a time loop and its
scene that is as long as a step. Here they are laid out as compiled code holds them (:mod:`tautline.kernels.memory`),
and what is called reads them from there.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import config
from numba.core import cgutils, types
from numba.extending import intrinsic

from tautline.kernels.jit import address_of, addressed, entry
from tautline.kernels.memory import kind_of, words_of

HEAD = 4
"""Words before the arguments: the address of the function, and room for three numbers that it gives back."""


class Bound:
    """A kernel with its arguments.

    Parameters
    ----------
    function : kernel
        Made by :func:`tautline.kernels.jit.entry`. It gives back two integers and a float.
    *arguments
        Arrays, integers, floats and named tuples of them. What an array holds may change; the array itself stays. A
        number is what `set_float` makes it.
    """

    def __init__(self, function: Any, *arguments: Any) -> None:
        self.function, self.arguments, self._found = function, list(arguments), (0, 0, 0.0)
        if config.DISABLE_JIT:
            return
        signature = tuple(kind_of(x) for x in arguments)
        if signature not in function.overloads:
            function.compile(signature)
        returned = function.overloads[signature].signature.return_type
        kind = types.TypeRef(types.Tuple((types.Tuple(signature), returned)))
        self._places = np.cumsum([HEAD] + [len(words_of(x)) for x in arguments])
        self._words = np.zeros(int(self._places[-1]), np.int64)
        self._words[0] = address_of(function, signature)
        self._words[HEAD:] = [word for x in arguments for word in words_of(x)]
        self._floats = self._words.view(np.float64)
        self._code = address_of(_run, (kind, types.intp))
        self._at = self._words.ctypes.data

    def set_float(self, i: int, value: float) -> None:
        """Make a number of the i-th argument, a float."""
        self.arguments[i] = value
        if not config.DISABLE_JIT:
            self._floats[self._places[i]] = value

    def __call__(self) -> tuple[int, int, float]:
        """What the function gives back; the interpreter's lock is released meanwhile."""
        if config.DISABLE_JIT:
            self._found = self.function(*self.arguments)
        else:
            _call(self._code, self._at)
        return self.found

    @property
    def found(self) -> tuple[int, int, float]:
        """What the last call has given back, also where Ctrl-C was heard as it ended."""
        if config.DISABLE_JIT:
            return self._found
        return int(self._words[1]), int(self._words[2]), float(self._floats[3])


@intrinsic(prefer_literal=True)
def _run_at(typing, kind, packet):
    """Call the function in a packet with the arguments there, and write down there what it gives back."""
    arguments, returned = kind.instance_type.types
    given = tuple(arguments.types)

    def code(context, builder, _, values):
        word = context.get_value_type(types.intp)
        base = builder.inttoptr(values[1], word.as_pointer())
        kind_of = context.call_conv.get_function_type(returned, given)
        function = builder.inttoptr(builder.load(base), kind_of.as_pointer())
        first = builder.gep(base, [word(HEAD)])
        whole = builder.load(builder.bitcast(first, context.get_value_type(arguments).as_pointer()))
        parts = [builder.extract_value(whole, i) for i in range(len(given))]
        status, found = context.call_conv.call_function(builder, function, returned, given, parts)
        with cgutils.if_unlikely(builder, status.is_error):
            context.call_conv.return_status_propagate(builder, status)
        for i, wanted in enumerate((types.int64, types.int64, types.float64)):
            x = context.cast(builder, builder.extract_value(found, i), returned.types[i], wanted)
            place = builder.gep(base, [word(1 + i)])
            builder.store(x, builder.bitcast(place, x.type.as_pointer()))
        return context.get_dummy_value()

    return types.void(kind, packet), code


@addressed
def _run(kind, packet):
    """The function whose address stands in a `Bound`: the same signature for every function and its arguments."""
    _run_at(kind, packet)


@intrinsic
def _call_at(typing, address, packet):
    def code(context, builder, _, values):
        given = (types.TypeRef(types.none), types.intp)
        function = context.call_conv.get_function_type(types.none, given)
        result, error = (cgutils.alloca_once(builder, t.pointee) for t in function.args[:2])
        # A type that is handed over stands for nothing in a call.
        rest = [cgutils.get_null_value(t) for t in function.args[2:-1]]
        builder.call(builder.inttoptr(values[0], function.as_pointer()), [result, error, *rest, values[1]])
        return context.get_dummy_value()

    return types.void(address, packet), code


@entry
def _call(address, packet):
    _call_at(address, packet)
