"""What the places of a string are called at which a result tells motion and force: lumps, or the nodes of a beam."""

from __future__ import annotations

from typing import Any

LUMP, NODE = "lump", "node"


def part_of(result: Any) -> str:
    """`LUMP` or `NODE`, as the result's own description of its dimension ``body`` says."""
    body = result.variables.get("body")
    return NODE if body is not None and body.long_name.startswith(NODE) else LUMP


def depth_said(depth: float) -> str:
    """A depth, m, for a heading: to the metre, and of a short string to a tenth."""
    return f"{depth:.0f} m" if depth >= 100.0 else f"{depth:.1f} m"
