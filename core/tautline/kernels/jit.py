"""The one decorator of compiled code.

It acts on the functions that it decorates alone: numba's compiler, its cache and its settings are what they were for
all other code of the process. What is done otherwise than numba does it is in :mod:`tautline.kernels.compiling.inlined`
(how inner kernels are compiled), :mod:`tautline.kernels.compiling.indices` (what a subscript means) and
:mod:`tautline.kernels.compiling.caching` (where compiled code is kept). ``TAUTLINE_PLAIN_NUMBA=1`` leaves the first two
to numba.
"""

from __future__ import annotations

import contextlib
import functools
import inspect
from collections.abc import Callable
from typing import Any

from numba import config, types
from numba.core.errors import TypingError
from numba.core.registry import CPUDispatcher
from numba.extending import overload

from tautline.kernels.compiling.caching import KernelCache
from tautline.kernels.compiling.inlined import PLAIN, UNFUSED, compiler_for
from tautline.kernels.compiling.sources import is_ours
from tautline.kernels.memory import ARRAYS, kind_of

OPTIONS = {
    "nopython": True,
    "boundscheck": None,
    "nogil": True,
    "error_model": "numpy",
    "no_cfunc_wrapper": True,
    "_nrt": False,
    "fastmath": False if UNFUSED else {"contract"},
}
"""``_nrt=False`` takes numba's reference counts away: they are half of the time of a small kernel, and without them
code that would allocate an array does not compile. The time loop allocates nothing, by construction. ``contract`` lets
a product and a sum be one instruction with one rounding; no sum is reordered, and what is no number stays so."""


def entry(function: Any = None, *, part: bool = False, **options: Any) -> Any:
    """Decorator of compiled code that Python calls: cached across processes, releases the GIL."""
    if function is None:
        return functools.partial(entry, part=part, **options)
    return _compiled(Outer, function, part, options)


def _compiled(kind: type[CPUDispatcher], function: Any, part: bool, options: dict[str, Any]) -> Any:
    """What numba's ``njit`` makes of a function, by itself: for hundreds of kernels its decorator takes as long again.

    The function itself where nothing is compiled.
    """
    if config.DISABLE_JIT:
        return function
    if not inspect.isfunction(function):
        raise TypeError(f"a kernel is made of a plain function, not of {function!r}")
    function.__signature__ = _signature_of(function)
    compiled = kind(function, {}, OPTIONS | options, pipeline_class=compiler_for(part, is_ours(function)))
    compiled._cache = KernelCache(function)
    return compiled


def _signature_of(function: Any) -> inspect.Signature:
    """What `inspect` says of a function's arguments: numba asks it twice, and that is most of making a kernel."""
    code = function.__code__
    plain = not (code.co_posonlyargcount or code.co_kwonlyargcount or code.co_flags & NAMELESS)
    if plain and not (function.__defaults__ or function.__annotations__):
        return inspect.Signature([_argument(name) for name in code.co_varnames[: code.co_argcount]])
    return inspect.signature(function)


NAMELESS = inspect.CO_VARARGS | inspect.CO_VARKEYWORDS
"""Marks of functions that take any number of arguments."""


@functools.cache
def _argument(name: str) -> inspect.Parameter:
    return inspect.Parameter(name, inspect.Parameter.POSITIONAL_OR_KEYWORD)


class Outer(CPUDispatcher):
    """Compiled code that Python calls."""

    def typeof_pyval(self, val: Any) -> Any:
        """The type of an argument, where numba's own code for it knows none yet.

        Numba asks of the first arrays whether they are masked, and loads all that masked arrays need.
        """
        if type(val) in ARRAYS or isinstance(val, tuple):
            with contextlib.suppress(TypingError, ValueError):
                if (kind := kind_of(val)) is not None:
                    self._types_active_call.add(kind)
                    return kind
        return super().typeof_pyval(val)


class Inner(CPUDispatcher):
    """Compiled code that only compiled code can call."""

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Compile for a call; once for all whole numbers, not once more for each that stands in a call.

        Where the code is inlined the number is still known, and what depends on it is left out there.
        """
        if PLAIN:
            return super().get_call_template(args, kws)
        kinds = tuple(types.unliteral(kind) if isinstance(kind, types.IntegerLiteral) else kind for kind in args)
        return super().get_call_template(kinds, kws)

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Refuse; without this the process would end, for there is nothing that could take Python's objects."""
        raise TypeError(f"{self.py_func.__qualname__} can be called by compiled code only; its .py_func by Python")


def addressed(function: Any = None, *, part: bool = False, **options: Any) -> Any:
    """Decorator of compiled code that is called by its address.

    It goes without the wrappers that unpack a scene's many arrays, which would take longer to compile than the code.
    """
    if function is None:
        return functools.partial(addressed, part=part, **options)
    return _compiled(Inner, function, part, {"no_cpython_wrapper": True} | options)


kernel = functools.partial(addressed, part=True)
"""Decorator of compiled code that only compiled code calls, as a part of it."""


def stands_for(stub: Any) -> Callable[[Any], Any]:
    """Decorator of a function of types that returns what compiled code calls for them: ``@stands_for(stub)``."""

    def registered(choose: Any) -> Any:
        return overload(stub, jit_options={"pipeline_class": compiler_for(True, is_ours(choose))})(choose)

    return registered


def is_compiled(function: Any, signature: tuple[types.Type, ...]) -> bool:
    """Whether a kernel is compiled for the types of its arguments, in this process or in the cache.

    What is in the cache is read for it, and need not be read again when the kernel is compiled.
    """
    if signature in function.overloads:
        return True
    return bool(function._cache.holds(signature, function.targetctx))


def address_of(function: Any, signature: tuple[types.Type, ...]) -> int:
    """Address of a kernel's machine code for the types of its arguments, compiled or loaded now if it was not yet.

    It follows numba's own calling convention and stays where it is for the life of the process.
    """
    if signature not in function.overloads:
        function.compile(signature)
    compiled = function.overloads[signature]
    return int(compiled.library.get_pointer_to_function(compiled.fndesc.llvm_func_name))
