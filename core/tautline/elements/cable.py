"""The terms of a cubic element that are of the same elements, gone through together.

Tension and bending are functions of r2 - r1, r1' and r2' (eqs 2.48 and 2.49), and inertia works on the same nodes
(eq. 2.44). Each by itself reads what it needs of all elements, and adds its forces to the nodes' and its derivatives to
the matrix; together they do so once. A matrix of a long rope is larger than what a processor has at hand, and adding to
it is most of the work of a tangent.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tautline.elements.beam.bending import Bending, bending_of_four, write_bending_tangent
from tautline.elements.cubic import (
    BLOCK_OF_FOUR,
    add_blocks,
    add_blocks_with_mass,
    add_forces,
    add_to_vectors,
    members,
    nodes_of,
    nothing,
    shape_of,
)
from tautline.elements.inertia import Inertia, add_mass_one_by_one, inertia_of_four, mass_of_four
from tautline.elements.tension import Tension, tension_of_four, write_tension_tangent
from tautline.kernels.dispatch import by_type
from tautline.kernels.groups import register, register_joint
from tautline.kernels.jit import kernel
from tautline.kernels.lanes import LANES, load, store
from tautline.kernels.vector import scaled_sum


class Elastic(NamedTuple):
    """Tension and bending whose elements, in their order, are the same."""

    tension: Tension
    bending: Bending


class Cable(NamedTuple):
    """Inertia, and tension alone or with bending, whose elements, in their order, are the same."""

    inertia: Inertia
    elastic: Tension | Elastic


def _are_the_same(*groups: Any) -> bool:
    """Whether the elements of groups are between the same nodes, in the same order."""
    first, *others = groups
    return all(
        other.rows.size == first.rows.size and all(np.array_equal(other.rows[end], first.rows[end]) for end in "ab")
        for other in others
    )


def elastic(tension: Tension, bending: Bending) -> Elastic | None:
    """Both together; None where they are not of the same elements."""
    return Elastic(tension, bending) if _are_the_same(tension, bending) else None


def rope(inertia: Inertia, tension: Tension) -> Cable | None:
    """Both together; None where they are not of the same elements."""
    return Cable(inertia, tension) if _are_the_same(inertia, tension) else None


def cable(inertia: Inertia, tension: Tension, bending: Bending) -> Cable | None:
    """All three together; None where they are not of the same elements."""
    return Cable(inertia, Elastic(tension, bending)) if _are_the_same(inertia, tension, bending) else None


@kernel(forceinline=True)
def _pull(g, each, counts, i, j, q, v):
    return tension_of_four(g, each, counts, i, j, shape_of(q, i, j), q, v, nothing())


@kernel(forceinline=True)
def _pull_and_bend(g, each, counts, i, j, q, v):
    shape = shape_of(q, i, j)
    sums = tension_of_four(g.tension, each, counts, i, j, shape, q, v, nothing())
    return bending_of_four(g.bending, each, counts, i, j, shape, q, v, sums)


@kernel(forceinline=True)
def _write_pull(g, each, i, j, q, v, cc, ck):
    write_tension_tangent(g, each, i, j, shape_of(q, i, j), q, v, cc, ck)
    return g.four, g.block


@kernel(forceinline=True)
def _write_both(g, each, i, j, q, v, cc, ck):
    shape, four, other = shape_of(q, i, j), g.bending.four, g.tension.four
    write_tension_tangent(g.tension, each, i, j, shape, q, v, cc, ck)
    write_bending_tangent(g.bending, each, i, j, shape, q, v, cc, ck)
    for k in range(0, BLOCK_OF_FOUR, LANES):
        store(four, k, load(four, k) + load(other, k))
    return four, g.bending.block


_forces_of_four = by_type({Tension: _pull, Elastic: _pull_and_bend})
"""What works on r2 - r1, r1' and r2' of four elements, three lanes each."""
_write_tangent = by_type({Tension: _write_pull, Elastic: _write_both})
"""Write how these forces change with r2 - r1, r1' and r2'; returns where, and scratch (12, 12)."""


@kernel
def _elastic_residual(g, t, q, v, a, r):
    rows = g.tension.rows
    for n in range(0, rows.size, LANES):
        each, counts = members(n, rows.size)
        i, j = nodes_of(rows, each)
        add_forces(r, i, j, *_forces_of_four(g, each, counts, i, j, q, v))


@kernel
def _elastic_tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    rows = g.tension.rows
    for n in range(0, rows.size, LANES):
        each, counts = members(n, rows.size)
        i, j = nodes_of(rows, each)
        four, block = _write_tangent(g, each, i, j, q, v, cc, ck)
        add_blocks(matrix, dofs, four, 0, each, counts, i, j, block)


@kernel(forceinline=True)
def _add_forces(g, q, v, a, r, moving):
    """Add all forces, those of inertia where ``moving``."""
    rows = g.inertia.rows
    for n in range(0, rows.size, LANES):
        each, counts = members(n, rows.size)
        i, j = nodes_of(rows, each)
        chord, first, second = _forces_of_four(g.elastic, each, counts, i, j, q, v)
        on_r1, on_s1, on_r2, on_s2 = inertia_of_four(g.inertia, each, counts, i, j, q, v, a, moving)
        add_to_vectors(r, i, scaled_sum(on_r1, -1.0, chord), scaled_sum(on_s1, 1.0, first))
        add_to_vectors(r, j, scaled_sum(on_r2, 1.0, chord), scaled_sum(on_s2, 1.0, second))


@kernel
def _residual(g, t, q, v, a, r):
    _add_forces(g, q, v, a, r, True)


@kernel
def _force(g, t, q, v, a, r):
    _add_forces(g, q, v, a, r, False)


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    rows = g.inertia.rows
    for n in range(0, rows.size, LANES):
        each, counts = members(n, rows.size)
        i, j = nodes_of(rows, each)
        four, block = _write_tangent(g.elastic, each, i, j, q, v, cc, ck)
        mass = mass_of_four(g.inertia, each, counts, i, j, q, cm, cc)
        if not add_blocks_with_mass(matrix, dofs, four, counts, mass, i, j):
            add_blocks(matrix, dofs, four, 0, each, counts, i, j, block)
            add_mass_one_by_one(g.inertia, n, q, cm, cc, matrix, dofs)


register(Elastic, residual=_elastic_residual, tangent=_elastic_tangent)
register(Cable, residual=_residual, force=_force, tangent=_tangent)
register_joint((Inertia, Tension, Bending), cable)
register_joint((Tension, Bending), elastic)
register_joint((Inertia, Tension), rope)
