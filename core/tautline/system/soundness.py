"""Whether a scene has equations enough, and none twice: null motions of the mesh, redundant constraint rows.

Both questions are about linear equations of a few entries each, and are answered by elimination, one equation after
the other, without a matrix. Chains, rings and trees of ties and interpolation between masters stay sparse: 10 000 of
them in any order take a fraction of a second. Rows that fill in do not: 2 500 of five entries in a net take seconds.

A row is a sequence of (full degree of freedom, factor); it says that the sum of factor times change vanishes.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

import numpy as np

Row = Sequence[tuple[int, float]]

ALONG = 1e-6
"""A factor of a node's sliding, relative to the row, below which the row does not hinder it: a support across the rope
of which only rounding points along it must not pass for one that holds it."""

DEPENDENT = 1e-9
"""What is left of an entry that cancels, relative to what cancelled: well above rounding in a chain of ties, well below
any factor that a scene gives."""

_CONSTANT = -1


def null_motions(
    nodes: np.ndarray,
    tangents: np.ndarray,
    material: np.ndarray,
    fixed: Collection[int],
    couplings: Mapping[int, Row],
    rows: Iterable[Row] = (),
) -> list[int]:
    """Nodes that can slide along their rope without moving any material.

    Where p of a node is unknown, the node slides by dp = c, dr = c t with t = dr/dp and its slope changes with it: the
    mesh moves, the rope stays, and neither mass nor stiffness resists (the velocity of the material, (2.13) of the
    thesis, is zero). M is then singular, and so is the saddle-point matrix (2.119). The formulation notes show that no
    eigenvalue tells such a scene from a sound one, so the test is kinematic: c of every node that can slide is one
    unknown, and each fixed degree of freedom, coupling and multiplier row over r and p is one equation in them.

    Springs, anchors and penalty ties give no equation: with them alone M stays singular. Slopes give none, and neither
    do degrees of freedom that are no node's.

    Parameters
    ----------
    nodes : (n,) int array
        Full degree of freedom of x of each node; y and z are the two after it.
    tangents : (n, 3) array
        dr/dp of each node, about a unit vector; zero where the node has no rope.
    material : (n,) int array
        Full degree of freedom of p of each node, -1 where it has none.
    fixed : collection of int
        Full degrees of freedom that are fixed or prescribed (``Degrees.motion``).
    couplings : mapping of int to Row
        Slaves and their masters (``Degrees.masters``); a constant part does not matter.
    rows : iterable of Row
        Constraints with a multiplier; entries of slopes are passed over, the rest of the row counts.

    Returns
    -------
    list of int
        The node that slides farthest in each independent null motion, ascending; empty for a sound scene. Nodes come
        twice where two motions have the same one.
    """
    slide = _slides(nodes, tangents, material, fixed)
    elimination = _Elimination(ALONG)
    for row in _equations((), couplings, rows):
        largest = max((abs(factor) for _, factor in row), default=0.0)
        entries = [(slide[j][0], factor * slide[j][1]) for j, factor in row if j in slide]
        elimination.add([(i, x) for i, x in entries if abs(x) > ALONG * largest])

    return _farthest({i for i, _ in slide.values()}, elimination)


def _slides(
    nodes: np.ndarray, tangents: np.ndarray, material: np.ndarray, fixed: Collection[int]
) -> dict[int, tuple[int, float]]:
    """Degrees of freedom that move where a node slides: the number of the node, and how much by one of its p."""
    # A node that is held along the rope does not slide, whatever else is said of it: most nodes are.
    places = np.column_stack([material, np.asarray(nodes)[:, None] + np.arange(3)]).astype(np.int64)
    factors = np.column_stack([np.ones(len(places)), tangents])
    is_held = (np.isin(places, list(fixed)) & (np.abs(factors) > ALONG)).any(axis=1)
    slide: dict[int, tuple[int, float]] = {}
    for i in np.flatnonzero((places[:, 0] >= 0) & ~is_held).tolist():
        slide.update((j, (i, factor)) for j, factor in zip(places[i].tolist(), factors[i].tolist(), strict=True))
    return slide


def _farthest(sliding: set[int], elimination: _Elimination) -> list[int]:
    """The node that slides farthest in the motion of each that no equation determines, ascending."""
    farthest = {i: (1.0, i) for i in sliding if not elimination.knows(i)}
    for i in sorted(sliding - farthest.keys()):
        for j, x in elimination.express(i).items():
            # a node that is no slave is named rather than one that moves exactly as far
            if abs(x) > farthest[j][0] * (1.0 + ALONG):
                farthest[j] = (abs(x), i)
    return sorted(i for _, i in farthest.values())


def redundant(
    rows: Sequence[Row],
    fixed: Collection[int] = (),
    couplings: Mapping[int, Row] | None = None,
    residuals: Sequence[float] | np.ndarray | None = None,
) -> dict[int, float]:
    """Constraint rows that say nothing new, given what is held and coupled and the rows before them.

    One such row makes the saddle-point matrix (2.119) singular and leaves its multiplier undetermined. A row of which
    nothing is left once held degrees of freedom and slaves are put in is one of them.

    Parameters
    ----------
    rows : sequence of Row
        Constraint rows over full degrees of freedom.
    fixed : collection of int
        Full degrees of freedom that are fixed or prescribed (``Degrees.motion``).
    couplings : mapping of int to Row
        Slaves and their masters (``Degrees.masters``); masters may be held or slaves themselves.
    residuals : (m,) array
        Value of each constraint at the start, where held degrees of freedom and slaves have the values they must have;
        in the unit of the row. Zeros if left out.

    Returns
    -------
    dict of int to float
        Redundant rows in ascending order, with the mismatch of each: the value that remains of it, in its own unit,
        once the others are met. Zero is a repetition that can be left out, anything above rounding a contradiction.
        It speaks of the start only: rows over prescribed degrees of freedom may come to contradict each other later.
    """
    if not rows:
        return {}
    elimination = _Elimination(DEPENDENT)
    for row in _equations(fixed, couplings or {}, ()):
        elimination.add(row)
    found = {}
    for k, row in enumerate(rows):
        mismatch = elimination.add(row, 0.0 if residuals is None else float(residuals[k]))
        if mismatch is not None:
            found[k] = mismatch
    return found


def _equations(fixed: Collection[int], couplings: Mapping[int, Row], rows: Iterable[Row]) -> Iterable[Row]:
    """Every equation as a row: what is held first, since it shortens the rest; a slave before its masters."""
    for i in fixed:
        yield [(i, 1.0)]
    for slave, masters in couplings.items():
        yield [(slave, 1.0), *((master, -factor) for master, factor in masters)]
    yield from rows


class _Elimination:
    """Equations sum factor x_j + constant = 0, each solved as it comes for its largest entry, the first of equals.

    Parameters
    ----------
    tolerance : float
        An entry is dropped if it cancels to less than this part of what it is the sum of.
    """

    def __init__(self, tolerance: float) -> None:
        self._tolerance = tolerance
        self._forms: dict[int, dict[int, float]] = {}

    def knows(self, j: int) -> bool:
        """Whether x_j follows from others, or is a constant."""
        return j in self._forms

    def add(self, row: Row, constant: float = 0.0) -> float | None:
        """Take an equation in: None if it is independent of those before, otherwise the constant that remains."""
        for j, _ in row:
            self.express(j)
        left = self._substitute([*row, (_CONSTANT, constant)])
        remaining = left.pop(_CONSTANT, 0.0)
        if not left:
            return remaining
        solved = max(left, key=lambda j: abs(left[j]))
        pivot = left.pop(solved)
        left[_CONSTANT] = remaining
        self._forms[solved] = {j: -x / pivot for j, x in left.items() if x != 0.0}
        return None

    def express(self, j: int) -> dict[int, float]:
        """x_j as factors of those that follow from no others.

        What is found on the way is kept, as in union-find, so that long chains of ties are followed once; and without
        recursion, since they are longer than Python's stack.
        """
        forms = self._forms
        waiting = [j] if j in forms else []
        while waiting:
            known = [k for k in forms[waiting[-1]] if k in forms]
            deep = [k for k in known if any(m in forms for m in forms[k])]
            if deep:
                waiting += deep
                continue
            last = waiting.pop()
            if known:
                forms[last] = self._substitute(forms[last].items())
        return forms.get(j, {j: 1.0})

    def _substitute(self, entries: Iterable[tuple[int, float]]) -> dict[int, float]:
        total: dict[int, float] = {}
        size: dict[int, float] = {}
        for j, factor in entries:
            form = self._forms.get(j)
            for k, x in ((j, 1.0),) if form is None else form.items():
                total[k] = total.get(k, 0.0) + factor * x
                size[k] = size.get(k, 0.0) + abs(factor * x)
        return {k: x for k, x in total.items() if abs(x) > self._tolerance * size[k]}
