"""Mass and tangent of elements that write a dense block each, whose rows are the unknowns of their two nodes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from tautline.kernels.dispatch import by_type
from tautline.kernels.dofs import add_block
from tautline.kernels.jit import kernel

BLOCK_WRITERS: dict[type, Callable[..., Any]] = {}
"""What writes cm M + cc C + ck K into ``g.block``, of (g, element, q, v, a, cm, cc, ck); by kind of group."""

_write_block = by_type(BLOCK_WRITERS)


@kernel(forceinline=True)
def add_mass_blocks(g, width, q, matrix, dofs):
    """Add the mass of all elements of ``g``, whose nodes have ``width`` unknowns each.

    Velocities and accelerations have no part in it: positions stand in for them.
    """
    for n in range(g.rows.size):
        e = g.rows[n]
        _write_block(g, e, q, q, q, 1.0, 0.0, 0.0)
        add_block(matrix, dofs, e.a, e.b - e.a, width, g.block)


@kernel(forceinline=True)
def add_tangent_blocks(g, width, q, v, a, cm, cc, ck, matrix, dofs):
    """Add cm M + cc C + ck K of all elements of ``g``, whose nodes have ``width`` unknowns each."""
    for n in range(g.rows.size):
        e = g.rows[n]
        _write_block(g, e, q, v, a, cm, cc, ck)
        add_block(matrix, dofs, e.a, e.b - e.a, width, g.block)
