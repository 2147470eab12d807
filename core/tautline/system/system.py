"""A scene as the solver sees it: groups, degrees of freedom, functions of time."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from tautline.entry_points import module_of_caller
from tautline.kernels.bound import Lasting
from tautline.kernels.dofs import Dofs, runs_of
from tautline.kernels.groups import laid_out, link, without_friction
from tautline.kernels.machine.sources import comes_with_us, is_module_of_ours
from tautline.kernels.matrix import Factors, new_factors
from tautline.kernels.time_function import TimeFunctions
from tautline.system.masters import Masters
from tautline.system.memory import Beginning
from tautline.system.pattern import Pattern, narrow, pattern_of


@dataclass
class Degrees:
    """Degrees of freedom while a scene is built: each free, fixed, prescribed, or a slave of others.

    Attributes
    ----------
    names : list of str
        What each full degree of freedom is, for messages: ``body 7 (drill pipe, 1925 m): axial``.
    value : (n_full,) array
        Values at t = 0, m or rad.
    scale : (n_full,) array
        Force or moment that counts as large in that row, N or N m: the residual is judged against it.
    motion : dict of int to int
        Of each held degree of freedom the function of time that its value follows, by its index; -1 of a fixed one.
    masters : dict of int to list of (int, float)
        Of each tied one those whose sum it is, with their factors.
    """

    names: list[str]
    value: np.ndarray
    scale: np.ndarray
    motion: dict[int, int] = field(default_factory=dict)
    masters: dict[int, list[tuple[int, float]]] = field(default_factory=dict)

    def copy(self) -> Degrees:
        """The same degrees of freedom, to be changed."""
        parts = self.names, self.value, self.scale, self.motion, self.masters
        return Degrees(*(part.copy() for part in parts))

    def add(self, name: str, value: float) -> int:
        """A further degree of freedom, whose row is judged by 1; returns its number."""
        self.names.append(name)
        self.value, self.scale = _longer(self.value, value), _longer(self.scale, 1.0)
        return self.value.size - 1

    def fix(self, i: int) -> None:
        """Hold a degree of freedom at its value."""
        self.motion[i] = -1

    def prescribe(self, i: int, function: int) -> None:
        """Let a degree of freedom follow its value plus a function of time (its index in the scene)."""
        self.motion[i] = function

    def tie(self, i: int, masters: list[tuple[int, float]], offset: float = 0.0) -> None:
        """Make a degree of freedom an offset and the sum of factors times others, which may be held or tied in turn."""
        self.masters[i] = [*masters, (self._constant(offset), 1.0)] if offset != 0.0 else masters

    def _constant(self, value: float) -> int:
        """A further degree of freedom, held at a value that no group sees."""
        place = self.add("a constant", value)
        self.fix(place)
        return place

    def resolved(self, i: int) -> list[tuple[int, float]]:
        """Masters of a degree of freedom that are not tied themselves."""
        if i not in self.masters:
            return [(i, 1.0)]
        sums: dict[int, float] = {}
        for j, factor in self.masters[i]:
            for k, further in self.resolved(j):
                sums[k] = sums.get(k, 0.0) + factor * further
        return [(k, f) for k, f in sums.items() if f != 0.0]


def _longer(x: np.ndarray, value: float) -> np.ndarray:
    """An array (n,) with a further number."""
    longer = np.empty(x.size + 1)
    longer[:-1] = x
    longer[-1] = value
    return longer


LAID, WITHOUT_FRICTION = ("laid out",), "without friction"
"""Where a system keeps what its groups were laid out as, and the begin of other keys: no sum is called so."""


@dataclass
class System:
    """Groups over numbered unknowns, ready for an integrator.

    Attributes
    ----------
    groups : tuple
        Named tuples of arrays; their types choose the compiled code.
    dofs : Dofs
        Full degrees of freedom in terms of the reduced ones.
    functions : TimeFunctions
        Every function of time in the scene.
    q, v : (n_full,) arrays
        Position (m, rad) and velocity at t = 0.
    scale : (n,) array
        Force (N, N m) against which the residual of a reduced row is judged.
    names : list of str
        What each reduced unknown is.
    free : (n,) int array
        The full degree of freedom that each reduced unknown is.
    mass_couples_held : bool
        Whether the mass matrix couples held degrees of freedom to free ones.
    at_rest : (k,) int array
        Reduced unknowns that stay where they are while an equilibrium is sought.
    bandwidth, mass_bandwidth : int
        Sub- and superdiagonals of the tangent and of the mass matrix; 0 is diagonal.
    mass_pattern : Pattern
        Entries of the mass matrix that may differ from zero.
    border : int
        Unknowns, the last ones, that are kept out of the band because too many others depend on them.
    algebraic : (k,) int array
        Reduced unknowns that are multipliers.
    places : list of str
        What each full degree of freedom is.
    force : float
        Force that counts as large, N; 0 for the largest of ``scale``.
    given : float
        Force that a scene at rest has to balance, N: ``force`` and ``scale`` may count stiffness, and a search for rest
        holds what is left against this one too. 0 where it is not known, or nothing acts.
    hidden : bool
        Whether the scene is so stiff along itself that rounding may hide what acts: a search for rest then asks.
    softer : str
        Cause and cure of a search or a step without solution, where that may be the cause and less stiffness bends
        alike; empty where it is not so.
    neighbours : (m, 2) int array
        Full degrees of freedom at both ends of an element that must not move far apart at once, m, where a search for
        rest moves them: x and x, y and y, z and z, or the ways along a hole.
    reach : float
        How far such may move at once, their neighbours with them, m.
    room : (n_full,) or (0,) array
        By how many limits of a step each degree of freedom may change at once there: those of long elements by more
        than those of short ones. Empty where all may alike.
    room_between : (m,) or (0,) array
        The same of the neighbours, of their difference.
    slopes : (m,) int array
        Full degrees of freedom where the slope r' of a rope's node begins, behind its place r.
    turns : (m,) int array
        Reduced unknowns that are numbers of quaternions: half a turn changes one by as much as one.
    window : (2,) or (0,) int array
        First and past the last full degree of freedom that residuals, tangents and laws are asked for; groups that know
        it share it, and go over those of their members only that touch one of these. Empty where none does, or where
        the unknowns are not numbered as the degrees of freedom are.
    linked : dict
        What :meth:`link` made.
    lasting : Lasting
        What calls compiled code with the parts of the system.
    """

    groups: tuple[Any, ...]
    dofs: Dofs
    functions: TimeFunctions
    q: np.ndarray
    v: np.ndarray
    scale: np.ndarray
    names: list[str]
    free: np.ndarray
    mass_couples_held: bool
    at_rest: np.ndarray
    bandwidth: int
    mass_bandwidth: int
    mass_pattern: Pattern
    border: int = 0
    algebraic: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int64))
    places: list[str] = field(default_factory=list)
    force: float = 0.0
    given: float = 0.0
    hidden: bool = False
    softer: str = ""
    neighbours: np.ndarray = field(default_factory=lambda: np.zeros((0, 2), np.int64))
    reach: float = 0.0
    room: np.ndarray = field(default_factory=lambda: np.zeros(0))
    room_between: np.ndarray = field(default_factory=lambda: np.zeros(0))
    slopes: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int64))
    turns: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int64))
    window: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int64))
    linked: dict[tuple[str, ...], Any] = field(default_factory=dict, repr=False)
    lasting: Lasting = field(default_factory=Lasting, repr=False, compare=False)
    _spare: Factors | None = field(default=None, init=False, repr=False, compare=False)
    _beginning: Beginning | None = field(default=None, init=False, repr=False, compare=False)

    @contextmanager
    def beginning_anew(self) -> Iterator[None]:
        """Within it is a run: it begins with what the groups remembered before the first one."""
        if self._beginning is None:
            self._beginning = Beginning(self.groups)
        else:
            self._beginning.bring_back(self.groups)
        try:
            yield
        finally:
            self._beginning.has_ended(self.groups)

    def spare_factors(self) -> Factors:
        """Room for a tangent and its factors, for whoever needs some for a moment: the next may write over them."""
        if self._spare is None:
            self._spare = new_factors(self.size, self.bandwidth, self.border)
        return self._spare

    def name_of(self, row: int) -> str:
        """What a reduced row is; or, counted from -1 downwards, a full degree of freedom."""
        return self.names[row] if row >= 0 else self.places[-1 - row]

    def link(self, sums: tuple[str, ...]) -> Any:
        """The groups as compiled code calls them for some sums; kernels that were never compiled are compiled now."""
        if sums not in self.linked:
            for known, table in self.linked.items():
                # What serves more sums serves these: rows that are not asked for are not run.
                if known is not LAID and known[0] != WITHOUT_FRICTION and set(sums) <= set(known):
                    self.linked[sums] = table
                    return table
            if LAID not in self.linked:
                self.linked[LAID] = laid_out(self.groups)
            self.linked[sums] = link(self.groups, *sums, as_laid=self.linked[LAID])
        return self.linked[sums]

    def link_without_friction(self, sums: tuple[str, ...]) -> Any:
        """The same, of the groups whose damping is no friction."""
        key = (WITHOUT_FRICTION, *sums)
        if key not in self.linked:
            self.linked[key] = link(without_friction(self.groups), *sums)
        return self.linked[key]

    @property
    def has_friction(self) -> bool:
        """Whether anything may stick and slip."""
        return len(without_friction(self.groups)) < len(self.groups)

    @property
    def size(self) -> int:
        """Number of reduced unknowns."""
        return self.scale.size


def assemble(
    groups: tuple[Any, ...],
    degrees: Degrees,
    functions: TimeFunctions,
    velocity: np.ndarray,
    stencils: Sequence[np.ndarray],
    mass_stencils: Sequence[np.ndarray],
    at_rest: Sequence[int] = (),
    algebraic: Sequence[int] = (),
    flowing: Sequence[int] = (),
    window: np.ndarray | None = None,
    turns: Sequence[int] = (),
) -> System:
    """Number the unknowns and order them for a narrow band.

    Parameters
    ----------
    groups : tuple
        The scene's groups.
    degrees : Degrees
        What is free, held and tied.
    functions : TimeFunctions
        Functions of time that held degrees of freedom and groups refer to.
    velocity : (n_full,) array
        Velocity at t = 0, m/s or rad/s.
    stencils, mass_stencils : sequences of (m, k) int arrays
        Each row lists full degrees of freedom that a member of a group couples, in the tangent and in the mass.
    at_rest : sequence of int
        Free full degrees of freedom that stay where they are while an equilibrium is sought: driven ones.
    algebraic : sequence of int
        Full degrees of freedom that are multipliers: they have an acceleration and nothing else.
    flowing : sequence of int
        Held or tied full degrees of freedom whose rate counts while all else is at rest: material that flows steadily.
    window : (2,) int array, optional
        What the groups take from it which of their members are asked for; see `System.window`.
    turns : sequence of int
        Free full degrees of freedom that are numbers of quaternions.

    Returns
    -------
    System
    """
    numbering = _numbering(Structure.of(degrees, stencils, mass_stencils, algebraic, flowing))
    dofs, free, number, rank = numbering.dofs, numbering.free, numbering.number, numbering.rank
    border, mass_pattern = numbering.border, numbering.mass_pattern
    filled_by_others = not is_module_of_ours(module_of_caller())
    if filled_by_others or not all(comes_with_us(type(group)) for group in groups):
        from tautline.system.hook_bounds import check_places

        check_places(
            groups, dofs, degrees.value.astype(np.float64), _velocity(velocity, degrees), filled=filled_by_others
        )
    return System(
        groups=groups,
        dofs=dofs._replace(offset=degrees.value[dofs.held].astype(np.float64)),
        functions=functions,
        q=degrees.value.astype(np.float64),
        v=_velocity(velocity, degrees),
        scale=degrees.scale[free].astype(np.float64),
        names=np.array(degrees.names, dtype=object)[free].tolist(),
        free=free,
        mass_couples_held=numbering.mass_couples_held,
        at_rest=np.array([rank[number[i]] for i in at_rest if number[i] >= 0], dtype=np.int64),
        bandwidth=numbering.bandwidth,
        mass_bandwidth=numbering.mass_bandwidth,
        mass_pattern=mass_pattern,
        border=border,
        algebraic=np.array([rank[number[i]] for i in algebraic], dtype=np.int64),
        places=list(degrees.names),
        turns=np.array([rank[number[i]] for i in turns], dtype=np.int64),
        window=window if window is not None and numbering.in_one_piece else np.zeros(0, np.int64),
    )


class Structure(NamedTuple):
    """All that the numbering of unknowns depends on: many scenes differ in nothing but numbers.

    ``size`` full degrees of freedom, ``motion`` and ``masters`` of :class:`Degrees`, stencils as shape and bytes.
    """

    size: int
    motion: tuple[tuple[int, int], ...]
    masters: tuple[tuple[int, tuple[tuple[int, float], ...]], ...]
    stencils: tuple[tuple[tuple[int, ...], bytes], ...]
    mass_stencils: tuple[tuple[tuple[int, ...], bytes], ...]
    algebraic: tuple[int, ...]
    flowing: tuple[int, ...]

    @classmethod
    def of(
        cls,
        degrees: Degrees,
        stencils: Sequence[np.ndarray],
        mass_stencils: Sequence[np.ndarray],
        algebraic: Sequence[int],
        flowing: Sequence[int],
    ) -> Structure:
        """The structure of degrees of freedom and what couples them."""
        return cls(
            len(degrees.names),
            tuple(degrees.motion.items()),
            tuple((i, tuple(masters)) for i, masters in degrees.masters.items()),
            *(tuple((s.shape, s.astype(np.int64).tobytes()) for s in given) for given in (stencils, mass_stencils)),
            tuple(algebraic),
            tuple(flowing),
        )

    def stencil_arrays(self, mass: bool) -> list[np.ndarray]:
        """The stencils, or those of the mass."""
        given = self.mass_stencils if mass else self.stencils
        return [np.frombuffer(entries, np.int64).reshape(shape) for shape, entries in given]


class Numbering(NamedTuple):
    """How unknowns are numbered: ``free`` (n,) the full degree of freedom of each, ``number`` (n_full,) the place of
    each among the free ones or -1, ``rank`` (n,) the unknown that a free one is. The dofs are without their offsets,
    and shared by all systems of one structure."""

    dofs: Dofs
    free: np.ndarray
    number: np.ndarray
    rank: np.ndarray
    bandwidth: int
    mass_bandwidth: int
    mass_pattern: Pattern
    border: int
    mass_couples_held: bool
    in_one_piece: bool


@functools.lru_cache(maxsize=2)
def _numbering(structure: Structure) -> Numbering:
    """Number the unknowns and order them for a narrow band; found once for scenes of one structure."""
    degrees = Degrees([""] * structure.size, np.zeros(structure.size), np.ones(structure.size))
    degrees.motion.update(structure.motion)
    degrees.masters.update((i, list(masters)) for i, masters in structure.masters)
    stencils, mass_stencils = structure.stencil_arrays(mass=False), structure.stencil_arrays(mass=True)
    full = structure.size
    bound = np.zeros(full, dtype=bool)
    bound[[*degrees.motion, *degrees.masters]] = True
    free = np.flatnonzero(~bound)
    number = np.full(full, -1, dtype=np.int64)
    number[free] = np.arange(free.size)
    masters = Masters.of(number, degrees.motion, {i: _terms(i, number, degrees) for i in degrees.masters})
    bare = number[list(structure.algebraic)]
    pattern, mass_pattern = (pattern_of(masters, free.size, s, bare) for s in (stencils, mass_stencils))
    order, border = narrow(pattern)
    rank = np.argsort(order)
    pattern, mass_pattern = pattern.renumbered(rank), mass_pattern.renumbered(rank)
    dofs = _dofs(degrees, masters, free[order], rank, structure.flowing)
    in_order = bool(np.all(np.diff(dofs.free) > 0))
    return Numbering(
        dofs, free[order], number, rank, pattern.width(border),
        (mass_pattern if border == 0 else pattern).width(border), mass_pattern, border,
        any(_couples(masters, s) for s in mass_stencils),
        dofs.tied.size == border == 0 and in_order,
    )  # fmt: skip


def _dofs(degrees: Degrees, masters: Masters, free: np.ndarray, rank: np.ndarray, flowing: Sequence[int]) -> Dofs:
    """The map from unknowns to degrees of freedom; ``rank`` is the number of each master, ``free`` in that order."""
    held = np.array(sorted(degrees.motion), dtype=np.int64)
    motion = np.array([degrees.motion[i] for i in held], dtype=np.int64)
    return Dofs(
        start=masters.start,
        unknown=masters.ranked(rank),
        factor=masters.factor,
        number=masters.marks(rank),
        held=held,
        motion=motion,
        offset=degrees.value[held].astype(np.float64),
        driven=np.flatnonzero(motion >= 0),
        carried=np.flatnonzero(masters.is_carried),
        free=free,
        tied=np.array(sorted(degrees.masters), dtype=np.int64),
        flowing=np.array(sorted(flowing), dtype=np.int64),
        runs=runs_of(free),
    )


class MassNumbering(NamedTuple):
    """The unknowns in the order in which the mass matrix is narrowest.

    It often couples each direction only with itself, where the tangent couples all of them: their best orders differ.
    ``dofs`` are a system's with its unknowns numbered so, ``order`` (n,) is each one's number in the system itself, and
    ``bandwidth`` and ``border`` are those of the matrix.
    """

    dofs: Dofs
    order: np.ndarray
    bandwidth: int
    border: int


def number_by_mass(system: System) -> MassNumbering:
    """Number a system's unknowns for the narrowest mass matrix."""
    order, border = narrow(system.mass_pattern)
    rank = np.argsort(order)
    dofs = system.dofs
    renumbered = dofs._replace(
        unknown=_moved(dofs.unknown, rank), number=_moved(dofs.number, rank), free=dofs.free[order],
        runs=runs_of(dofs.free[order]),
    )  # fmt: skip
    return MassNumbering(renumbered, order, system.mass_pattern.renumbered(rank).width(border), border)


def _moved(numbers: np.ndarray, rank: np.ndarray) -> np.ndarray:
    """Unknowns under their new numbers; marks, which are negative, stay."""
    moved = numbers.copy()
    moved[numbers >= 0] = rank[numbers[numbers >= 0]]
    return moved


def _velocity(given: np.ndarray, degrees: Degrees) -> np.ndarray:
    """Velocity at t = 0 of every degree of freedom: what is fixed has none."""
    v = np.append(given, np.zeros(len(degrees.names) - len(given))).astype(np.float64)
    v[[i for i, function in degrees.motion.items() if function < 0]] = 0.0
    return v


def _terms(i: int, number: np.ndarray, degrees: Degrees) -> list[tuple[int, float]]:
    """Masters of a degree of freedom that is tied: unknowns, and held ones under their marks."""
    if i in degrees.motion:
        return []
    return [(int(number[j]) if number[j] >= 0 else -1 - j, f) for j, f in degrees.resolved(i)]


def _couples(masters: Masters, stencil: np.ndarray) -> bool:
    free = masters.is_free[stencil]
    return bool(np.any(free.any(axis=-1) & ~free.all(axis=-1))) if stencil.size else False
