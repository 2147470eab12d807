"""The dispatch: a scene is a tuple of groups, and the types in the tuple choose the code.

A *group* is a ``NamedTuple`` of contiguous arrays: all bodies of a string, all links, all wall contacts. A kind of
group registers compiled kernels for some of the hooks below. The sum of a hook over a tuple of groups is one
recursion over the tuple's types, resolved when the integrator is compiled: a hook that a kind does not offer, and a
kind that the scene does not have, leave nothing behind in the machine code.

Hooks (``g`` the group; ``q, v, a`` full vectors of position, velocity and acceleration; forces are residuals,
``r = M a - F``, so a group that pushes along +q subtracts from ``r``):

=============  ===============================================  =====================================================
hook           arguments after ``g``                            what it does
=============  ===============================================  =====================================================
begin          t, h, beta, gamma, q, v, a                       at the start of every attempt of a step from t; beta and
                                                                gamma are beta', gamma' of eqs 2.88-2.89 (0 if explicit)
switch         t, q, v, converged, changed                      lets a law change its status (stick, slip); counts the
                                                                changes into ``changed[0]``
residual       t, q, v, a, r                                    r += M a - F
mass           q, matrix, dofs                                  matrix += M
tangent        t, q, v, a, cm, cc, ck, matrix, dofs             matrix += cm dr/da + cc dr/dv + ck dr/dq
energy         t, q, v, e                                       e += (kinetic, strain, potential) in J
dissipation    t, q, v, p                                       p[0] += power lost, p[1] += power put in by a drive, W
commit         t, h, q, v, a                                    the step to t is accepted
record         out, at                                          writes its own numbers from ``out[at[0]]``, moves at[0]
=============  ===============================================  =====================================================
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba.core import types
from numba.extending import overload

HOOKS = ("begin", "switch", "residual", "mass", "tangent", "energy", "dissipation", "commit", "record")

KINDS: dict[type, dict[str, Callable[..., None]]] = {}
"""The kernels of each kind of group, by hook."""


def register(kind: type, **hooks: Callable[..., None]) -> None:
    """Register the kernels of a kind of group.

    Parameters
    ----------
    kind : type
        A ``NamedTuple`` class of contiguous arrays, scalars and other such tuples.
    **hooks
        A compiled kernel for each hook that the kind offers.

    Raises
    ------
    ValueError
        For a name that is no hook.
    """
    for name in hooks:
        if name not in HOOKS:
            raise ValueError(f"{kind.__name__}: no hook is called {name!r}: one of {', '.join(HOOKS)}")
    KINDS[kind] = hooks


def offers(groups: tuple[Any, ...], hook: str) -> bool:
    """Whether any of the groups has a kernel for this hook."""
    return any(hook in KINDS[type(g)] for g in groups)


def _any_kind(hooks: dict[str, Callable[..., None]]) -> bool:
    return True


def _switches(hooks: dict[str, Callable[..., None]]) -> bool:
    return "switch" in hooks


def _is_smooth(hooks: dict[str, Callable[..., None]]) -> bool:
    return "switch" not in hooks


def _over_groups(
    hook: str, arguments: str, among: Callable[[dict[str, Callable[..., None]]], bool] = _any_kind
) -> Callable[..., None]:
    """Make the sum of a hook over a tuple of groups, callable from compiled code and (slowly) from Python.

    ``among`` picks the kinds that are summed over, by the hooks that they offer.

    The calls are written out one after another for the tuple's types: a chain of calls through the tuple would compile
    the rest of the chain again at every link.
    """

    def total(groups, *args):
        for g in groups:
            hooks = KINDS[type(g)]
            if hook in hooks and among(hooks):
                hooks[hook](g, *args)

    def resolve(groups, *args):
        members = groups.types if isinstance(groups, types.BaseTuple) else ()
        offered = {f"kernel_{i}": KINDS[g.instance_class] for i, g in enumerate(members)}
        kernels = {name: hooks[hook] for name, hooks in offered.items() if hook in hooks and among(hooks)}
        calls = [f"{name}(groups[{name[7:]}], {arguments})" for name in kernels]
        return _define(f"def total(groups, {arguments}):\n    " + "\n    ".join(calls or ["pass"]), kernels, "total")

    typed = _define(f"def resolve(groups, {arguments}):\n    return choose(groups)", {"choose": resolve}, "resolve")
    stub = _define(f"def {hook}(groups, {arguments}):\n    total(groups, {arguments})", {"total": total}, hook)
    overload(stub)(typed)
    return stub


def _define(source: str, names: dict[str, Any], name: str) -> Callable[..., Any]:
    """Define a function from source text that this module wrote: numba needs fixed argument names."""
    space = dict(names)
    exec(source, space)
    return space[name]


begin = _over_groups("begin", "t, h, beta, gamma, q, v, a")
switch = _over_groups("switch", "t, q, v, converged, changed")
residual = _over_groups("residual", "t, q, v, a, r")
mass = _over_groups("mass", "q, matrix, dofs")
tangent = _over_groups("tangent", "t, q, v, a, cm, cc, ck, matrix, dofs")
smooth_tangent = _over_groups("tangent", "t, q, v, a, cm, cc, ck, matrix, dofs", _is_smooth)
switching_tangent = _over_groups("tangent", "t, q, v, a, cm, cc, ck, matrix, dofs", _switches)
energy = _over_groups("energy", "t, q, v, e")
dissipation = _over_groups("dissipation", "t, q, v, p")
commit = _over_groups("commit", "t, h, q, v, a")
record = _over_groups("record", "out, at")
