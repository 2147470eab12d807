"""The dispatch: a scene is a list of groups, and the type of each chooses its code.

A *group* is a ``NamedTuple`` of contiguous arrays and numbers: all bodies of a string, all links, all wall contacts. A
kind of group registers compiled kernels for some of the hooks below. Each of them is compiled for the group's type as a
function of its own, and :func:`link` lists their addresses with that of the group in memory: the integrators call what
stands in the list. A hook that a kind does not offer, and a kind that the scene does not have, are not in the list and
cost nothing; an integrator is compiled once for all scenes, a kind of group once for all integrators.

Hooks (``g`` the group; ``q, v, a`` full vectors of position, velocity and acceleration; forces are residuals,
``r = M a - F``, so a group that pushes along +q subtracts from ``r``):

=============  ===============================================  =====================================================
hook           arguments after ``g``                            what it does
=============  ===============================================  =====================================================
begin          t, h, beta, gamma, q, v, a                       at the start of every attempt of a step from t; beta and
                                                                gamma are beta', gamma' of eqs 2.88-2.89 (0 if explicit;
                                                                gamma -1 where only the acceleration is asked for)
instant        t, next                                          lowers next[0], s, to the first time after t at which
                                                                ``begin`` changes something at once: a step ends there
jump           changed                                          counts the masses that ``begin`` has changed at once: an
                                                                implicit step then goes on from other accelerations
switch         t, q, v, converged, changed                      lets a law change its status (stick, slip); counts the
                                                                changes, or tells their places as well (changes.py)
residual       t, q, v, a, r                                    r += M a - F
kink           changed                                          counts the members whose force the last residual has
                                                                found on another branch (slack, taut) than before: the
                                                                force knows by itself, the tangent has to be made anew
force          t, q, v, a, r                                    r -= F: the residual where a is zero, which is what an
                                                                explicit method asks for where no acceleration is
                                                                prescribed; a kind without it gives its residual
mass           q, matrix, dofs                                  matrix += M, a ``Matrix`` or its diagonal
tangent        t, q, v, a, cm, cc, ck, matrix, dofs             matrix += cm dr/da + cc dr/dv + ck dr/dq
energy         t, q, v, e                                       e += (kinetic, strain, potential) in J
dissipation    t, q, v, p                                       p[0] += power lost, W; asked once a step, after
                                                                ``commit``, with t and q of its middle and its
                                                                displacement over h as v
supply         t, q, v, p                                       p[0] += power that a drive or a flow brings in at t, W,
                                                                p[1] += by how much that jumps at t
commit         t, h, q, v, a                                    the step to t is accepted
record         out, at                                          writes its own numbers from ``out[at[0]]``, moves at[0]
alarm          t, q, alarm                                      writes into ``alarm[0]`` what must not be (``EMPTY``
                                                                and so on), and where into ``alarm[1]``, a full place
violation      order, q, v, r                                   r += what is missing for an equation of its own between
                                                                positions (order 0) or velocities (1)
=============  ===============================================  =====================================================
"""

from __future__ import annotations

import inspect
import math
from collections import deque
from collections.abc import Callable
from itertools import chain, product
from typing import Any, NamedTuple

import numpy as np

from tautline.errors import ArgumentTypeError
from tautline.kernels.dofs import DOFS
from tautline.kernels.jit import Kernel as CompiledKernel
from tautline.kernels.jit import addressed, stands_for
from tautline.kernels.machine.code import KERNELS_OF
from tautline.kernels.machine.settings import UNCOMPILED
from tautline.kernels.matrix import MATRIX
from tautline.kernels.memory import Form, form_of, laid
from tautline.kernels.numba_registration import taught
from tautline.kernels.parallel_compile import Job

Kernel = Callable[..., None]

NUMBER, VECTOR, COUNTS = float, form_of(np.zeros(0)), form_of(np.zeros(0, np.int64))
HOOKS = {
    "begin": {"t": NUMBER, "h": NUMBER, "beta": NUMBER, "gamma": NUMBER, "q": VECTOR, "v": VECTOR, "a": VECTOR},
    "instant": {"t": NUMBER, "next": VECTOR},
    "jump": {"changed": COUNTS},
    "switch": {"t": NUMBER, "q": VECTOR, "v": VECTOR, "converged": bool, "changed": COUNTS},
    "residual": {"t": NUMBER, "q": VECTOR, "v": VECTOR, "a": VECTOR, "r": VECTOR},
    "kink": {"changed": COUNTS},
    "force": {"t": NUMBER, "q": VECTOR, "v": VECTOR, "a": VECTOR, "r": VECTOR},
    "mass": {"q": VECTOR, "matrix": MATRIX, "dofs": DOFS},
    "tangent": {
        "t": NUMBER, "q": VECTOR, "v": VECTOR, "a": VECTOR, "cm": NUMBER, "cc": NUMBER, "ck": NUMBER, "matrix": MATRIX,
        "dofs": DOFS,
    },
    "energy": {"t": NUMBER, "q": VECTOR, "v": VECTOR, "e": VECTOR},
    "dissipation": {"t": NUMBER, "q": VECTOR, "v": VECTOR, "p": VECTOR},
    "supply": {"t": NUMBER, "q": VECTOR, "v": VECTOR, "p": VECTOR},
    "commit": {"t": NUMBER, "h": NUMBER, "q": VECTOR, "v": VECTOR, "a": VECTOR},
    "record": {"out": VECTOR, "at": COUNTS},
    "alarm": {"t": NUMBER, "q": VECTOR, "alarm": COUNTS},
    "violation": {"order": int, "q": VECTOR, "v": VECTOR, "r": VECTOR},
}  # fmt: skip
"""Names and forms of each hook's arguments after the group."""

EMPTY, LOOSE, OFF_WHEEL, RUN_OUT, TWO_BLOCKED, DRUM_FULL, SLACK_ON_WHEEL = 1, 2, 3, 4, 5, 6, 7
"""Alarms: an element has lost its length; a node may slide along its rope without moving any of it; a rope has left a
wheel that it ran over; all of a rope has run off its drum; what hangs on a rope has come up to its wheel; a drum holds
all the rope that it can."""

Feels = Callable[[Any], bool]
"""What says of a group whether its forces depend on accelerations otherwise than by its mass."""
Keeper = Callable[[Any], str]
"""What says of a group what moves on with a run and is no unknown."""


class Integral(NamedTuple):
    """A number of a group that is no unknown and that a step of h s adds h times a rate to, which is of the step's end.

    Attributes
    ----------
    array : float (n,)
        Of the group.
    at : int
        Where in it.
    place : int
        Full place of a degree of freedom of what it belongs to.
    text : str
        What it is.
    """

    array: np.ndarray
    at: int
    place: int
    text: str


Integrals = Callable[[Any], list[Integral]]
"""What lists those of a group that its forces follow."""
Lengths = Callable[[Any], list[Any]]
"""What lists the full places of vectors of a group of which only the direction counts, each an array."""


class Stuck(NamedTuple):
    """What sticks in a group as it stands, and so moves in no linear model.

    Attributes
    ----------
    place : int
        Full place of a degree of freedom of what it belongs to.
    text : str
        What it does, as a sentence goes on after a name.
    most : float
        Force, torque or difference of these up to which it does so, in ``unit``; infinite where that is not known.
    unit : str
        ``N`` or ``N m``.
    cure : str
        What frees it, beside time.
    now : float
        What it is now, in ``unit``; NaN where that is not known.
    name : str
        Its own name, where that of the place is another's, such as the next node's.
    """

    place: int
    text: str
    most: float
    unit: str
    cure: str = ""
    now: float = math.nan
    name: str = ""


Sticks = Callable[[Any, float], list[Stuck]]
"""What lists what sticks in a group at a time, s, at which its residual was asked for; it may call kernels."""


class Edge(NamedTuple):
    """How far something is from where a one-sided law of a group, such as that of a contact, begins or ends to act.

    Attributes
    ----------
    places : tuple of int
        Full places of degrees of freedom of what it belongs to.
    acts : bool
        Whether the law acts.
    gap : float
        How far, m: beyond where it begins if it acts, else before it.
    stiffness : float
        With which it acts, N/m.
    held, free : str
        What is so where it acts and where it does not, as a sentence goes on after a name: by so many metres.
    share : float
        How much of its weight presses it there: all of it on level ground. 0 where nothing would lift it off or press
        it there.
    name : str
        Its own name, where that of the place is another's, such as the next node's.
    """

    places: tuple[int, ...]
    acts: bool
    gap: float
    stiffness: float
    held: str
    free: str
    share: float = 1.0
    name: str = ""


Edges = Callable[[Any, np.ndarray, np.ndarray], list[Edge]]
"""What lists those of a group at full positions and velocities, at which its residual was asked for; it may call
kernels."""
Onward = Callable[[Any, np.ndarray, np.ndarray], list[int]]
"""What lists full places of a group that move on from where they are, at full positions and velocities."""
Hold = Callable[[Any], None]
"""What has a law of a group stay as the last accepted step left it."""


class Kind(NamedTuple):
    """What is registered of a kind of group: its kernels by hook, and the rest as :func:`register` takes it."""

    hooks: dict[str, Kernel]
    constant_mass: bool = False
    friction: bool = False
    memory: Keeper | None = None
    feels: Feels | None = None
    hold: Hold | None = None
    integrals: Integrals | None = None
    lengths: Lengths | None = None
    sticks: Sticks | None = None
    edges: Edges | None = None
    onward: Onward | None = None


KINDS: dict[type, Kind] = {}
"""The kinds of groups that are registered."""
UNKNOWN = Kind({})


class Sum(NamedTuple):
    """A sum of a hook over the groups: over all that offer it or some of them, and the forms of its arguments."""

    hook: str
    arguments: dict[str, Form]
    among: Callable[[dict[str, Kernel]], bool]


def _any_kind(hooks: dict[str, Kernel]) -> bool:
    return True


def _switches(hooks: dict[str, Kernel]) -> bool:
    return "switch" in hooks or "kink" in hooks


def _constrains(hooks: dict[str, Kernel]) -> bool:
    return "violation" in hooks


def _is_smooth(hooks: dict[str, Kernel]) -> bool:
    return not _switches(hooks)


SUMS = {hook: Sum(hook, arguments, _any_kind) for hook, arguments in HOOKS.items() if hook != "tangent"} | {
    "diagonal_mass": Sum("mass", HOOKS["mass"] | {"matrix": VECTOR}, _any_kind),
    "constraint_mass": Sum("mass", HOOKS["mass"], _constrains),
    "smooth_tangent": Sum("tangent", HOOKS["tangent"], _is_smooth),
    "switching_tangent": Sum("tangent", HOOKS["tangent"], _switches),
}
"""What an integrator may ask for."""
ROWS = {name: row for row, name in enumerate(SUMS)}
INSTEAD = {"force": "residual"}
"""The sum whose hook stands in for one that a kind does not offer: both have the same arguments."""


def register(
    kind: type,
    *,
    constant_mass: bool = False,
    friction: bool = False,
    memory: Keeper | None = None,
    feels: Feels | None = None,
    hold: Hold | None = None,
    integrals: Integrals | None = None,
    lengths: Lengths | None = None,
    sticks: Sticks | None = None,
    edges: Edges | None = None,
    onward: Onward | None = None,
    **hooks: Kernel,
) -> None:
    """Register the kernels of a kind of group.

    Parameters
    ----------
    kind : type
        A ``NamedTuple`` class of contiguous arrays, integers, floats and other such tuples.
    constant_mass : bool
        Whether its mass matrix does not depend on positions.
    friction : bool
        Whether its damping is friction, which bounds its force.
    memory : callable or None
        Takes a group, and says what of it moves on with a run and is no unknown, such as the bottom of a hole; empty
        where nothing does.
    feels : callable or None
        Takes a group, and says whether its forces depend on accelerations otherwise than by its mass, as friction does
        that goes by a force which accelerates something.
    hold : callable or None
        Takes a group whose system is only looked at from now on and never stepped, and has what slips slip on and what
        sticks stick: the law of a step may take what has just slipped for stuck. None where the hooks say that anyway.
    integrals : callable or None
        Takes a group, and lists the integrals over time that its forces follow, such as that of a controller.
    lengths : callable or None
        Takes a group, and lists the full places of its vectors of which only the direction counts, such as quaternions:
        their lengths are no motion, and no part of a linear model.
    sticks : callable or None
        Takes a group and a time, s, and lists what sticks then: a linear model has it as if it stuck for ever.
    edges : callable or None
        Takes a group and full positions and velocities, and lists how far what it holds one-sidedly is from where that
        begins or ends: a linear model has the side where it is.
    onward : callable or None
        Takes a group and full positions and velocities, and lists the full places of what stands at the farthest that
        it has come and moves on: a law that jumps right behind it is differentiated ahead.
    **hooks
        A compiled kernel for each hook that the kind offers.

    Raises
    ------
    ValueError
        For a name that is no hook, and for a kernel that takes other arguments than its hook has.
    ArgumentTypeError
        For a function that is no kernel.
    """
    for name, hook in hooks.items():
        if name not in HOOKS:
            raise ValueError(f"{kind.__name__}: no hook is called {name!r}: one of {', '.join(HOOKS)}")
        _check_arguments(kind, name, hook)
        _check_kernel(kind, name, hook)
    KINDS[kind] = Kind(
        hooks,
        constant_mass=constant_mass or "mass" not in hooks,
        friction=friction,
        memory=memory,
        feels=feels,
        hold=hold,
        integrals=integrals,
        lengths=lengths,
        sticks=sticks,
        edges=edges,
        onward=onward,
    )
    _forget(kind)


def known_of(group: Any) -> Kind:
    """What is registered of a group's kind; of one that is not, nothing."""
    return KINDS.get(type(group), UNKNOWN)


def _check_kernel(kind: type, name: str, hook: Any) -> None:
    """Refuse a function that was not decorated, or by numba's own decorator: compiled code would not know it."""
    if UNCOMPILED or isinstance(hook, CompiledKernel):
        return
    function: Any = getattr(hook, "py_func", hook)
    code = function.__code__
    raise ArgumentTypeError(
        f"hook {name!r} of kind {kind.__name__} ({function.__module__}.{function.__qualname__}, "
        f"{code.co_filename}:{code.co_firstlineno}) is no kernel; write @kernel of tautline.kernels.jit above it"
    )


def _check_arguments(kind: type, name: str, hook: Kernel) -> None:
    """Refuse a kernel that cannot be called with its hook's arguments: the compiler would say so of itself alone."""
    function: Any = getattr(hook, "py_func", hook)
    code, wanted = function.__code__, ("g", *HOOKS[name])
    most = code.co_argcount
    least = most - len(function.__defaults__ or ())
    if least <= len(wanted) <= (math.inf if code.co_flags & inspect.CO_VARARGS else most):
        return
    given = ", ".join(code.co_varnames[:most])
    raise ValueError(
        f"hook {name!r} of kind {kind.__name__} ({function.__module__}.{function.__qualname__}, "
        f"{code.co_filename}:{code.co_firstlineno}) takes ({given}), and is called with ({', '.join(wanted)}): "
        "give it these arguments"
    )


_addresses: dict[Any, dict[str, int]] = {}
"""Where the code is that a kind of group runs for a sum, by the sum and the form of the group."""


def _forget(kind: type) -> None:
    """Forget what is compiled with the kernels that a kind had before: it may be registered anew, as in a notebook."""
    _addresses.clear()
    _drafts.clear()
    if not UNCOMPILED:
        run_hook.forget(lambda forms: forms[1][1][0] is kind)


def _kernels_of(kind: type) -> Any:
    """The kernels of a kind, which its hooks take in."""
    return KINDS.get(kind, UNKNOWN).hooks.values()


KERNELS_OF.append(_kernels_of)


Join = Callable[..., Any]
JOINTS: dict[tuple[type, ...], Join] = {}
"""What makes one group of several that are gone through together, by their kinds."""


def register_joint(kinds: tuple[type, ...], join: Join) -> None:
    """Register what goes through groups of several kinds together, in place of each of them by itself.

    Parameters
    ----------
    kinds : tuple of type
        Kinds of groups.
    join : callable
        Takes a group of each of them, and returns one of a kind that is registered too, or None where they do not
        belong together. It does what these would do one after the other: for the hooks that its kind offers it runs in
        their place. Only sums see it: who asks for the groups of a scene finds the others.
    """
    JOINTS[kinds] = join
    for kind in kinds:
        _forget(kind)


class Members(NamedTuple):
    """The groups of a scene and, behind them, those that join some; ``parts`` are the places of what each joins."""

    groups: tuple[Any, ...]
    parts: tuple[tuple[int, ...], ...]

    def that_run(self, name: str) -> list[tuple[int, str]]:
        """Places of the groups that run for a sum, with the sum whose code they run."""
        codes = {i: code for i, g in enumerate(self.groups) if (code := _code_for(name, type(g))) is not None}
        for place, parts in enumerate(self.parts, len(self.groups) - len(self.parts)):
            # For a sum to which one of its parts adds nothing a joint does not run: the other parts run alone.
            replaced = parts if place in codes and all(i in codes for i in parts) else (place,)
            for i in replaced:
                codes.pop(i, None)
        return list(codes.items())


def members_of(groups: tuple[Any, ...]) -> Members:
    """Groups, and what joins some of them; each is joined once at most."""
    made: list[Any] = []
    parts: list[tuple[int, ...]] = []
    for kinds, join in JOINTS.items():
        places = [[i for i, g in enumerate(groups) if type(g) is kind] for kind in kinds]
        for chosen in product(*places):
            if any(i in taken for taken in parts for i in chosen):
                continue
            joint = join(*(groups[i] for i in chosen))
            if joint is not None:
                made.append(joint)
                parts.append(chosen)
    return Members((*groups, *made), tuple(parts))


def without_friction(groups: tuple[Any, ...]) -> tuple[Any, ...]:
    """The groups whose damping is no friction."""
    return tuple(g for g in groups if not known_of(g).friction)


def hold_laws(groups: tuple[Any, ...]) -> None:
    """Have the laws of groups stay as the last accepted step left them; no step may be made with them after that."""
    for g in groups:
        if (hold := known_of(g).hold) is not None:
            hold(g)


def offers(groups: tuple[Any, ...], hook: str) -> bool:
    """Whether any of the groups has a kernel for this hook."""
    return any(hook in KINDS[type(g)].hooks for g in (groups.groups if isinstance(groups, Members) else groups))


def feel_acceleration(groups: tuple[Any, ...]) -> bool:
    """Whether forces of any of the groups depend on accelerations otherwise than by their mass."""
    return any(feels(g) for g in groups if (feels := known_of(g).feels) is not None)


def has_constant_mass(groups: tuple[Any, ...]) -> bool:
    """Whether the mass matrix of the groups stays what it is."""
    return all(known_of(g).constant_mass for g in groups)


def _code_for(name: str, kind: type) -> str | None:
    """The sum whose code a kind runs for a sum: its own, the one instead of it, or none."""
    if kind not in KINDS:
        raise TypeError(f"{kind.__name__} is no registered kind of group")
    hooks = KINDS[kind].hooks
    candidates = (s for s in (name, INSTEAD.get(name)) if s is not None)
    return next((s for s in candidates if SUMS[s].hook in hooks and SUMS[s].among(hooks)), None)


def hook_jobs(groups: tuple[Any, ...], *sums: str) -> list[Job]:
    """The kernels that :func:`link` needs for some sums, for `parallel_compile`; heavy sums belong at the end."""
    members = members_of(groups)
    forms = [form_of(g) for g in members.groups]
    used = [(code, forms[i]) for name in sums for i, code in members.that_run(name)]
    return list(dict.fromkeys((run_hook, _signature(ROWS[code], form)) for code, form in used))


def _signature(row: int, form: Form) -> tuple[Form, ...]:
    return ("literal", row), ("type", form), int, int


Laid = tuple[Members, list[list[int]], list[Any]]
"""Groups and those that join them, their words and forms."""


def laid_out(groups: tuple[Any, ...]) -> Laid:
    """What :func:`link` lays out of the groups, whichever sums it is asked for."""
    known: dict[int, tuple[list[int], Any]] = {}
    members = members_of(groups)
    both = [laid(g, known) for g in members.groups]
    return members, [words for words, _ in both], [form for _, form in both]


def link(groups: tuple[Any, ...], *sums: str, as_laid: Laid | None = None) -> Any:
    """Compile the groups' kernels for the sums that are named, or load them, and list where they are.

    The list is one array of integers: for each sum the place of its own part, which is a count and, for every group
    that it sums over, the address of the code and that of the group; then the groups themselves. The groups' arrays are
    referred to and must live on; ``as_laid`` is what they were laid out as before. Without a compiler
    (``NUMBA_DISABLE_JIT=1``) the groups and those that join them are the list.

    Raises
    ------
    TypeError
        For a group that holds what compiled code cannot, and for one whose kind is not registered.
    """
    if UNCOMPILED:
        return members_of(groups)
    members, words, forms = as_laid or laid_out(groups)
    same = sums, members.parts
    known = next((one for one in tuple(_drafts) if (one.sums, one.parts) == same and one.forms == forms), None)
    if known is None:
        known = _draft(members, sums, words, forms)
        _drafts.appendleft(known)
    table = known.table.copy()
    table[known.begin :] = list(chain.from_iterable(words))
    table[known.members] += table.ctypes.data
    return table


class _Draft(NamedTuple):
    """A list as all groups of some forms have it: ``table`` with the addresses of code, places of groups counted in
    bytes from its own start at ``members``, and zeros for the groups themselves from ``begin`` on."""

    sums: tuple[str, ...]
    parts: tuple[tuple[int, ...], ...]
    forms: list[Any]
    table: np.ndarray
    members: np.ndarray
    begin: int


_drafts: deque[_Draft] = deque(maxlen=16)
"""The last ones: variants of a scene have the same."""


def _draft(members: Members, sums: tuple[str, ...], words: list[list[int]], forms: list[Any]) -> _Draft:
    calls: list[list[tuple[int, int]]] = [[] for _ in SUMS]
    # A form is hashed part by part each time: once is enough.
    known = [_addresses.setdefault(form, {}) for form in forms]
    for name in sums:
        calls[ROWS[name]] += [(_address_for(code, forms[i], known[i]), i) for i, code in members.that_run(name)]
    table = np.zeros(len(SUMS) + sum(1 + 2 * len(c) for c in calls) + sum(map(len, words)), dtype=np.int64)
    places = table.size - np.cumsum([len(w) for w in reversed(words)], dtype=np.int64)[::-1]
    at, referring = len(SUMS), []
    for row, one in enumerate(calls):
        table[row], table[at] = at, len(one)
        for k, (address, i) in enumerate(one):
            table[at + 1 + 2 * k : at + 3 + 2 * k] = address, 8 * places[i]
            referring.append(at + 2 + 2 * k)
        at += 1 + 2 * len(one)
    return _Draft(sums, members.parts, forms, table, np.array(referring, np.int64), at)


def _address_for(code: str, form: Form, of_form: dict[str, int]) -> int:
    """Where the code of a sum is for groups of a form, compiled or loaded now if it was not yet."""
    if code not in of_form:
        of_form[code] = run_hook.at(_signature(ROWS[code], form)).address
    return of_form[code]


def apply(row, kind, group, arguments):
    """Call the kernel of a kind of group for the sum in a row; group and arguments are taken from their addresses."""


@addressed
def run_hook(row, kind, group, arguments):
    """The function whose address stands in the list: the same signature for every hook and every kind of group."""
    apply(row, kind, group, arguments)


CALLS: dict[str, Callable[..., None]] = {}
"""What compiled code calls, with an address, a group and the arguments of a sum, for the code at that address."""


def call_of(name: str) -> Callable[..., None]:
    """Make what stands in :data:`CALLS` for a sum."""

    def call(address, group, arguments):
        """Call the code at an address."""

    CALLS[name] = call
    return call


def _over_groups(name: str) -> Kernel:
    """Make a sum over linked groups, callable from compiled code and, uncompiled, from Python."""
    arguments = SUMS[name].arguments
    names = ", ".join(arguments)

    def total(groups, *args):
        members = groups if isinstance(groups, Members) else members_of(groups)
        for i, code in members.that_run(name):
            g = members.groups[i]
            KINDS[type(g)].hooks[SUMS[code].hook](g, *args)

    loop = (
        f"def {name}(groups, {names}):\n"
        f"    first = groups[{ROWS[name]}]\n"
        f"    for k in range(groups[first]):\n"
        f"        call(groups[first + 1 + 2 * k], groups[first + 2 + 2 * k], ({names},))"
    )
    compiled = _define(loop, {"call": call_of(name)}, name)
    stub = _define(f"def {name}(groups, {names}):\n    total(groups, {names})", {"total": total}, name)
    chosen = _define(f"def choose(groups, {names}):\n    return compiled", {"compiled": compiled}, "choose")
    stands_for(stub)(chosen)
    return stub


def may_switch(groups):
    """Whether any of the linked groups has a law that switches, or a kink."""
    return offers(groups, "switch") or offers(groups, "kink")


@stands_for(may_switch)
def _may_switch(groups):
    switch, kink = ROWS["switch"], ROWS["kink"]
    return lambda groups: groups[groups[switch]] > 0 or groups[groups[kink]] > 0


def _define(source: str, names: dict[str, Any], name: str) -> Callable[..., Any]:
    """Define a function from source text that this module wrote: numba needs fixed argument names."""
    space = {"__name__": __name__, **names}
    exec(source, space)
    return space[name]


begin = _over_groups("begin")
instant = _over_groups("instant")
jump = _over_groups("jump")
switch = _over_groups("switch")
residual = _over_groups("residual")
kink = _over_groups("kink")
force = _over_groups("force")
mass = _over_groups("mass")
constraint_mass = _over_groups("constraint_mass")
diagonal_mass = _over_groups("diagonal_mass")
smooth_tangent = _over_groups("smooth_tangent")
switching_tangent = _over_groups("switching_tangent")
energy = _over_groups("energy")
dissipation = _over_groups("dissipation")
supply = _over_groups("supply")
commit = _over_groups("commit")
record = _over_groups("record")
alarm = _over_groups("alarm")
violation = _over_groups("violation")

taught("hooks")
