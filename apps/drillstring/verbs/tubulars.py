"""The verb ``tubulars``: the catalogue on the screen. What it prints with ``--json`` is a contract."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from tautline.cli.verbs import Json
from tautline.scene.errors import option_error

if TYPE_CHECKING:
    from drillstring.scene.tubulars import Tubular

WORDS_HELP = "Words such as [cyan]5 in[/], [cyan]HWDP[/], [cyan]S135[/]. [dim]\\[default: all][/]"

Words = Annotated[list[str] | None, typer.Argument(metavar="[WORDS]", help=WORDS_HELP, show_default=False)]


def tubulars(words: Words = None, as_json: Json = False) -> None:
    """List the standard tubulars that a section of a string can name, or those that some words fit."""
    from drillstring.scene.tubulars import NoSuchTubular, catalogue, matching
    from tautline.cli.output.console import console, print_json, say

    text = " ".join(words or ())
    try:
        found = matching(text) if text.strip() else catalogue()
    except NoSuchTubular as none:
        raise option_error("WORDS", text, none.cause, none.cure) from None
    if not found:
        cause, cure = "fits no tubular of the catalogue", "leave words out, or give none to see all"
        raise option_error("WORDS", text, cause, cure)
    console().print(_table(found))
    say("in a scene: `tubular:` and the name; weight is with tool joints, yield that of the new tube", "green")
    if as_json:
        print_json({"tubulars": [_report(one) for one in found]})


def _table(found: tuple[Tubular, ...]) -> Any:
    from rich.table import Table
    from rich.text import Text

    from drillstring.scene.tubulars import INCH, POUND_PER_FOOT
    from tautline.scene.values.systems import in_system

    table = Table(box=None, padding=(0, 1, 0, 0))
    table.add_column("tubular", style="cyan", no_wrap=True)
    for name in ("id\n[in]", "weight\n[lb/ft]", "joint\n[in]", "yield\n[kip]"):
        table.add_column(Text(name), justify="right", no_wrap=True)
    table.add_column("thread", no_wrap=True)
    for one in found:
        joint = "" if one.tool_joint_od is None else f"{one.tool_joint_od / INCH:.3f}"
        weight = f"{_weight(one) / POUND_PER_FOOT:.2f}"
        load = f"{in_system(one.yield_load, 'N', 'field')[0]:.1f}"
        table.add_row(one.label, f"{one.id / INCH:.3f}", weight, joint, load, one.connection)
    return table


def _weight(one: Tubular) -> float:
    """Mass per length, kg/m; a collar's is that of its steel."""
    from drillstring.scene.tubulars import STEEL

    return one.mass_per_length if one.mass_per_length is not None else STEEL * one.area


def _report(one: Tubular) -> dict[str, Any]:
    return {
        "tubular": one.label,
        "kind": one.kind,
        "grade": one.grade or None,
        "connection": one.connection or None,
        "od": one.od,
        "id": one.id,
        "tool_joint_od": one.tool_joint_od,
        "tool_joint_id": one.tool_joint_id,
        "mass_per_length": _weight(one),
        "yield_strength": one.yield_strength,
        "yield_load": one.yield_load,
    }
