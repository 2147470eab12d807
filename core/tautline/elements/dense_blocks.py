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


@kernel
def mass_of_blocks(g, q, matrix, dofs):
    """Add the mass of all elements of ``g``, in which velocities and accelerations have no part: positions stand in."""
    width = g.block.shape[0] // 2
    for n in range(g.rows.size):
        e = g.rows[n]
        _write_block(g, e, q, q, q, 1.0, 0.0, 0.0)
        add_block(matrix, dofs, e.a, e.b - e.a, width, g.block)


@kernel
def tangent_of_blocks(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    """Add cm M + cc C + ck K of all elements of ``g``."""
    width = g.block.shape[0] // 2
    for n in range(g.rows.size):
        e = g.rows[n]
        _write_block(g, e, q, v, a, cm, cc, ck)
        add_block(matrix, dofs, e.a, e.b - e.a, width, g.block)
