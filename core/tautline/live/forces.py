"""Forces that a user adds to a simulation: a Python function, a compiled one, or a group of his own."""

from __future__ import annotations

import ctypes
import inspect
import sys
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, NamedTuple

import numpy as np

from tautline.arguments import is_list, is_number, is_whole
from tautline.elements.outside import NO_NUMBER, RAISED, OutsideForces
from tautline.kernels.groups import KINDS
from tautline.kernels.jit import Kernel, in_python
from tautline.live.errors import SimulationError, plain_numbers
from tautline.system.system import System

DOUBLES = ctypes.POINTER(ctypes.c_double)
C_KIND = ctypes.CFUNCTYPE(None, ctypes.c_double, DOUBLES, DOUBLES, DOUBLES, ctypes.c_int64)


class Force:
    """A force that was added: its group, and what must live as long as that does.

    Attributes
    ----------
    group : NamedTuple
    failed : exception or None
        What the Python function raised since `begin`: it is not called again before the next one.
    calls : int
        Its calls that began and that ended: odd while it is called.
    """

    def __init__(self, function: Any, places: np.ndarray, known: np.ndarray, code: Any = None) -> None:
        self.failed: BaseException | None = None
        self.calls = 0
        self._function, n = function, places.size
        if _is_compiled(function):
            self._code = code or compiled(function)
            address = int(self._code.address)
        else:
            self._code = C_KIND(self._wrapped(function, n))
            address = int(ctypes.cast(self._code, ctypes.c_void_p).value or 0)
        vectors = [np.zeros(size) for size in (n, n, n + 1, n + 1)]
        self.group = OutsideForces(places, np.array([address]), known, *vectors)

    @property
    def name(self) -> str:
        """What a result calls it."""
        return str(getattr(self._function, "__name__", type(self._function).__name__))

    @property
    def fault(self) -> str:
        """What the function did since `begin` that no force may do; empty where all is well."""
        marks = {self.group.f[-1], self.group.g[-1]}
        if RAISED in marks:
            return "it raised an error: call its `py_func` to see which"
        return "it gave what is no finite number" if NO_NUMBER in marks else ""

    def begin(self) -> None:
        """Forget what the function did before."""
        self.failed = None
        self.group.f[-1] = self.group.g[-1] = 0.0

    def copy(self) -> Force:
        """The same force for another simulation, with scratch of its own: both may run at the same time."""
        code = self._code if _is_compiled(self._function) else None
        return Force(self._function, self.group.places, self.group.known, code)

    def _wrapped(self, function: Callable[..., Any], n: int) -> Callable[..., None]:
        """The function as C calls it; what it raises is kept, and the force is no number then."""

        def call(t: float, q: Any, v: Any, f: Any, k: int) -> None:
            force = np.ctypeslib.as_array(f, (n,))
            if self.failed is not None:
                # The loop halves its step and asks again: what the function does besides is not done once more.
                force[:] = np.nan
                return
            self.calls += 1
            try:
                x, rate = np.ctypeslib.as_array(q, (n,)).copy(), np.ctypeslib.as_array(v, (n,)).copy()
                known = np.isfinite(x).all() and np.isfinite(rate).all()
                force[:] = _numbers(function(t, x, rate), n)
                if known and not np.isfinite(force).all():
                    f[n] = NO_NUMBER
            except BaseException as error:  # there is no way for it through compiled code
                self.failed = error
                force[:] = np.nan
            self.calls += 1

        return call


@contextmanager
def calls_of(forces: Sequence[Force | Group]) -> Iterator[None]:
    """While functions that were added as forces are called outside of an advance; raises what one of them raised."""
    for force in forces:
        force.begin()
    try:
        yield
    finally:
        for force in forces:
            if force.failed is not None:
                raise force.failed
    for force in forces:
        if force.fault:
            raise SimulationError(f"force {force.name}: {force.fault}", "correct the function")


def _numbers(given: Any, n: int) -> np.ndarray:
    """What a function of the user's returned as a vector of forces; raises SimulationError."""
    cure = f"return {n} numbers"
    try:
        found = plain_numbers(np.asarray(given))
    except (TypeError, ValueError):  # rows of different lengths
        raise SimulationError("the force is no vector of numbers", cure) from None
    if found.dtype.kind not in "iuf":
        kinds = {"c": "complex numbers", "b": "yes or no, which is no number"}
        kind = kinds.get(found.dtype.kind, f"{type(given).__name__}, which is no numbers")
        raise SimulationError(f"the force is {kind}", cure)
    if found.shape != (n,):
        raise SimulationError(f"the force has the shape {found.shape}, and acts on {n} degrees of freedom", cure)
    return found


class Group:
    """A group of a registered kind that was added as it is."""

    def __init__(self, group: Any) -> None:
        self.group, self.failed, self.calls, self.fault = group, None, 0, ""

    @property
    def name(self) -> str:
        """What a result calls it."""
        return type(self.group).__name__

    def begin(self) -> None:
        """Nothing is kept of a group's calls."""

    def copy(self) -> Group:
        """The same group for another simulation, with arrays of its own."""
        return Group(_apart(self.group))


def _apart(thing: Any) -> Any:
    """A group with copies of its arrays."""
    if isinstance(thing, np.ndarray):
        return thing.copy()
    if isinstance(thing, tuple):
        parts = [_apart(part) for part in thing]
        return type(thing)(*parts) if hasattr(thing, "_fields") else tuple(parts)
    return thing


def compiled(function: Any) -> Any:
    """A compiled function (t, q, v, force) as one for C.

    What it does not write is zero. Where it raises the force is no number. That, and what is no number by itself,
    leaves a mark behind the force.
    """

    from numba import carray, cfunc, types
    from numba.core.errors import NumbaError

    vector = types.CPointer(types.float64)

    def outer(t: Any, q: Any, v: Any, f: Any, n: Any) -> None:
        force, x, rate, mark = carray(f, (n,)), carray(q, (n,)), carray(v, (n,)), carray(f, (n + 1,))
        force[:] = 0.0
        try:
            function(t, x, rate, force)
        except Exception:
            force[:] = np.nan
            mark[n] = RAISED
        known = found = True
        for i in range(n):
            known = known and np.isfinite(x[i]) and np.isfinite(rate[i])
            found = found and np.isfinite(force[i])
        if known and not found and mark[n] == 0.0:
            mark[n] = NO_NUMBER

    try:
        code = cfunc(types.void(types.float64, vector, vector, vector, types.int64))(outer)
    except NumbaError as error:
        from tautline.kernels.compiling.errors import words_of

        raise SimulationError(f"the force cannot be compiled: {words_of(error)}", CURE_OF_FORM) from None
    _check_returned(function)
    return code


CURE_OF_FORM = "write a function of (t, q, v, force) that writes into force, with @njit and without types"


def _check_returned(function: Any) -> None:
    """Refuse a compiled function that gives back more than a number: a force is written, and nobody reads that."""
    from numba.core import types

    for each in getattr(getattr(function, "compiled", function), "nopython_signatures", ()):
        given = types.unliteral(each.return_type)
        if not isinstance(given, (types.NoneType, types.Number, types.Boolean, types.Optional)):
            raise SimulationError(f"the force returns {given}, which nobody reads", CURE_OF_FORM)


def _is_compiled(function: Any) -> bool:
    """Whether numba, or our own decorators, compile a function; without numba there is none of its own."""
    if isinstance(function, Kernel):
        return True
    return "numba" in sys.modules and sys.modules["numba"].extending.is_jitted(function)


def _check_arguments(function: Any) -> None:
    """Refuse a function that cannot be called with what a force depends on; raises SimulationError."""
    wanted = ("t", "q", "v", "force") if _is_compiled(function) else ("t", "q", "v")
    try:
        taken = inspect.signature(getattr(function, "py_func", function))
    except (TypeError, ValueError):  # some of C say nothing of their arguments
        return
    try:
        taken.bind(*wanted)
    except TypeError:
        cause = f"the function of the force takes {taken}, and is called with ({', '.join(wanted)})"
        raise SimulationError(cause, "give it these arguments") from None


class _Beyond(SimulationError, IndexError):
    """A vector of a force was asked for a place that it has not."""


class _Vector(np.ndarray):
    """A vector that a force is called with: it tells when it is asked for what it has not."""

    def __getitem__(self, at: Any) -> Any:
        try:
            return super().__getitem__(at)
        except IndexError as error:
            raise _Beyond(str(error), "") from None

    def __setitem__(self, at: Any, value: Any) -> None:
        try:
            super().__setitem__(at, value)
        except IndexError as error:
            raise _Beyond(str(error), "") from None


def _check_indices(function: Any, t: float, q: np.ndarray, v: np.ndarray) -> None:
    """Refuse a compiled function that asks for a place that an array has not; raises SimulationError.

    Compiled code does not look whether an array has a place, and would end the process. So the function as it was
    written is gone through once, at the present time: what it asks for later, or in what it calls of others, is not
    seen.
    """
    source = getattr(function, "py_func", None)
    if source is None:
        return
    x, rate, force = (vector.copy().view(_Vector) for vector in (q, v, np.zeros(q.size)))
    try:
        with in_python(), np.errstate(all="ignore"):
            source(t, x, rate, force)
    except IndexError as error:
        last = next(one for one in reversed(traceback.extract_tb(error.__traceback__)) if one.filename != __file__)
        of, cure = "an array has not", f"t is {t:g} s now, and an array of n has the places 0 to n - 1"
        if isinstance(error, _Beyond):
            of, cure = "its vectors have not", f"q, v and force have the places 0 to {q.size - 1}"
        cause = f"the force asks for a place that {of} ({last.filename}:{last.lineno}: {error})"
        raise SimulationError(cause, cure) from None
    except Exception:  # what Python cannot run tells nothing of places
        return


def places_of(on: Any) -> np.ndarray:
    """Numbers of degrees of freedom as they are given; raises SimulationError for what is no list of these."""
    if not is_list(on) or not all(is_whole(one) for one in on):
        cause = f"{on!r} does not say what a force acts on"
        if is_list(on) and all(is_number(one) and float(one).is_integer() for one in on):
            cause += ": its numbers are floats, and integers are wanted"
        raise SimulationError(cause, 'give an output that is a position, "payload.position", or whole numbers: [0, 1]')
    places = np.array([int(one) for one in on if abs(int(one)) < 2**62], np.int64)
    if np.unique(places).size < len(list(on)):
        raise SimulationError(f"{on!r} names a degree of freedom twice, or none", "give each number once")
    return places


def force_of(
    function: Any, places: np.ndarray | None, system: System, now: tuple[float, np.ndarray, np.ndarray]
) -> Force | Group:
    """What adds a function, or a group, to a system, with the time, position and velocity now.

    Raises
    ------
    SimulationError, KernelError
        For what is neither a function nor a group, a function of other arguments, and places that there are not.
    """
    from tautline.system.hook_bounds import check_places  # few simulations need it

    if type(function) in KINDS:
        check_places((function,), system.dofs, system.q, system.v, filled=True)
        return Group(function)
    if not callable(function):
        cause = f"{type(function).__name__} is neither a function nor a registered group"
        raise SimulationError(cause, "give a function of (t, q, v)")
    _check_arguments(function)
    everywhere = np.arange(system.q.size)
    at = everywhere if places is None else np.asarray(places, dtype=np.int64)
    if at.ndim != 1 or at.size == 0 or at.min() < 0 or at.max() >= system.q.size:
        raise SimulationError(
            "a force has to act on some degrees of freedom", f"give numbers from 0 to {system.q.size - 1}"
        )
    if _is_compiled(function):
        t, q, v = now
        _check_indices(function, t, q[at], v[at])
    known = np.zeros((at.size, at.size), np.int64) if places is None else room_for(at, system)
    return Force(function, at, known)


class Room(NamedTuple):
    """Groups of a system, and the bandwidth of a tangent that has room for all that they tell of their forces."""

    groups: tuple[Any, ...]
    bandwidth: int


def room_for_all(system: System, added: Sequence[Force | Group]) -> Room:
    """Room for every derivative of the forces that were added, also between places that nothing else couples.

    A run does without: its iterations are slower then, and what they lead to is the same. Whoever asks for the tangent
    itself wants all of it.
    """
    told = (isinstance(one, Force) and one.group.known.all() for one in added)
    if all(told):
        return Room(system.groups, system.bandwidth)
    groups = (g._replace(known=np.ones_like(g.known)) if isinstance(g, OutsideForces) else g for g in system.groups)
    return Room(tuple(groups), max(system.bandwidth, system.size - system.border - 1))


def room_for(places: np.ndarray, system: System) -> np.ndarray:
    """Where the tangent has room for a derivative of the force at one place by another (k, k)."""
    dofs, banded = system.dofs, system.size - system.border
    unknowns: list[Sequence[int]] = []
    for i in places:
        part = dofs.unknown[dofs.start[i] : dofs.start[i + 1]]
        unknowns.append([int(k) for k in part if k >= 0])
    near = [
        [all(abs(a - b) <= system.bandwidth or max(a, b) >= banded for a in one for b in other) for other in unknowns]
        for one in unknowns
    ]
    return np.array(near, dtype=np.int64)
