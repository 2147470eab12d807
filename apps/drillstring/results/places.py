"""What the places of a string are called at which a result tells motion and force: lumps, or the nodes of a beam."""

from __future__ import annotations

from typing import Any

from drillstring.string.lumps import Lumps

LUMP, NODE = "lump", "node"


def part_of(result: Any) -> str:
    """`LUMP` or `NODE`, as the result's own description of its dimension ``body`` says."""
    body = result.variables.get("body")
    return NODE if body is not None and body.long_name.startswith(NODE) else LUMP


def names_of_bodies(lumps: Lumps) -> list[str]:
    """What each lump or node is called for an engineer: ``drill pipe at 320 m``, ``the bit``."""
    sections = [lumps.tubes[k].name for k in lumps.section.tolist()]
    depths = lumps.measured_depth[1:-1].tolist()
    names = [f"{name} at {depth_said(x)}" for name, x in zip(sections, depths, strict=False)]
    return ["the top of the string", *names, "the bit"]


def names_of_links(lumps: Lumps) -> list[str]:
    """What each element is called: its section, and the depth of its middle."""
    middle = (0.5 * (lumps.measured_depth[1:] + lumps.measured_depth[:-1])).tolist()
    return [f"{lumps.tubes[k].name} at {depth_said(x)}" for k, x in zip(lumps.section.tolist(), middle, strict=True)]


def reaches_of_links(lumps: Lumps) -> list[str]:
    """Where each element begins and ends, for what is looked at all along it: ``drill pipe, 0 to 250 m``."""
    ends = zip(lumps.section.tolist(), lumps.measured_depth[:-1], lumps.measured_depth[1:], strict=True)
    return [f"{lumps.tubes[k].name}, {a:.4g} to {b:.4g} m" for k, a, b in ends]


def depth_said(depth: float) -> str:
    """A depth, m, for a heading: to the metre, and of a short string to a tenth."""
    return f"{depth:.0f} m" if depth >= 100.0 else f"{depth:.1f} m"
