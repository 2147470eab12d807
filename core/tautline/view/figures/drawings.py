"""The figures that an application has, drawn by their names; variables are drawn by theirs.

An application lists its figures as `Drawing`, and makes its ``draw`` of `drawn`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tautline.results.errors import ResultError
from tautline.results.naming import stem
from tautline.results.result import Result
from tautline.scene.values.printed import printed_in
from tautline.view.figures.choice import split
from tautline.view.figures.comparison import listed, names, nearest, one_kind, title
from tautline.view.figures.curves import variable_figure
from tautline.view.figures.figure import Figure, save_all
from tautline.view.figures.unit_axes import use_units


@dataclass(frozen=True)
class Drawing:
    """A figure that an application has.

    Attributes
    ----------
    text : str
        What it shows.
    make : callable
        Results, or what the application makes of them -> Figure; raises `NothingToShow`.
    together : bool
        Whether several results go into one figure; else each has its own.
    alone, compared : bool
        Whether it is drawn of one result, of several, where nothing is asked for.
    takes : bool
        Whether a name may follow, as in ``waterfall:torque``: it is given to `make` as a second argument.
    """

    text: str
    make: Callable[..., Figure]
    together: bool = True
    alone: bool = True
    compared: bool = False
    takes: bool = False


def drawn(
    results: Sequence[Result],
    drawings: Mapping[str, Drawing],
    what: Sequence[str] = (),
    vs: str | None = None,
    prepare: Callable[[Sequence[Result]], Sequence[Any]] = list,
    groups: Mapping[str, Sequence[str]] | None = None,
) -> dict[str, Figure]:
    """Draw figures of an application, or any variables.

    Parameters
    ----------
    results : sequence of Result
        At least one, all of one application.
    drawings : mapping of str to Drawing
        The application's.
    what : sequence of str
        Names of figures or of variables, as ``tension:winch to boom tip:first``. If empty, the default figures that
        the results have something for.
    vs : str, optional
        Variable to draw variables against, in place of time; ``what`` then names variables only.
    prepare : callable
        What the application's figures take, of results.
    groups : mapping of str to names, optional
        Names that stand for several figures.

    Returns
    -------
    dict of str to Figure
        By name, in the units of the first result's scene; figures of one result alone are named ``path_<result>`` where
        there are several.

    Raises
    ------
    ResultError
        If a name is unknown, results are of several applications, or a result lacks what a figure shows.
    """
    one_kind(results)
    if vs is not None and not what:
        raise ResultError("--vs", f"'{vs}' is to be drawn against, but nothing is named", "name a variable with --what")
    groups = groups or {}
    what = list(dict.fromkeys(one for name in what for one in groups.get(name, (name,))))
    runs = prepare(results)
    found: dict[str, Figure] = {}
    for name in what or [key for key, one in drawings.items() if (one.alone if len(results) == 1 else one.compared)]:
        first, _, rest = name.partition(":")
        drawing = drawings.get(first)
        if vs is not None or drawing is None or (rest and not drawing.takes):
            _check_known(results[0], drawings, groups, name, vs)
            found[slug(name if vs is None else f"{name} vs {vs}")] = variable_figure(
                results, names(results), name, vs, title(results)
            )
            continue
        try:
            _draw(found, results, runs, first, drawing, (rest,) if rest else ())
        except ResultError:
            if what:
                raise
    system = printed_in(results[0].attributes)
    for figure in found.values():
        use_units(figure, system)
    return found


def _draw(
    found: dict[str, Figure],
    results: Sequence[Result],
    runs: Sequence[Any],
    name: str,
    drawing: Drawing,
    more: tuple[str, ...],
) -> None:
    """Draw one figure of all results, or one of each, into those found."""
    key = slug(":".join((name, *more)))
    if drawing.together or len(runs) == 1:
        found[key] = drawing.make(runs, *more)
        return
    for number, run in enumerate(runs):
        # Two results may have one name in two folders: none may overwrite the other's picture.
        own = f"{key}_{stem(results[number])}"
        found[own if own not in found else f"{own}_{number + 1}"] = drawing.make([run], *more)


def writing(draw: Callable[..., dict[str, Figure]]) -> Callable[..., list[Path]]:
    """Make of an application's ``draw`` what writes its figures into files.

    The result takes results, a folder, names, formats, the beginning of file names and what to draw against; see
    `tautline.application.protocol.Application.figures`.
    """

    def figures(
        results: Sequence[Result],
        folder: Path,
        what: Sequence[str] = (),
        formats: Sequence[str] = ("png",),
        beginning: str | None = None,
        vs: str | None = None,
    ) -> list[Path]:
        base = beginning or (stem(results[0]) if len(results) == 1 else "comparison")
        return save_all(draw(results, what, vs), Path(folder), base, formats, whole=beginning is not None)

    return figures


def _check_known(
    result: Result, drawings: Mapping[str, Drawing], groups: Mapping[str, Sequence[str]], name: str, vs: str | None
) -> None:
    """Raise ResultError if a name is neither a figure's nor a variable's."""
    first = split(name)[0]
    if first in result.variables:
        return
    variable, at, times = first.partition("@")
    if at and variable in result.variables:
        cure = f"name what to draw in --what, and the profile in --vs: --what NAME --vs {variable}@{times or '0,12.5'}"
        raise ResultError("--what", f"times after @ belong to --vs, not to '{variable}' here", cure)
    if first in drawings and vs is not None:
        cause = f"'{first}' is a figure, and --vs draws variables"
        raise ResultError("--vs", cause, f"name a variable: {listed(result.variables)}")
    if first in drawings:
        raise ResultError("--what", f"the figure '{first}' has no parts to choose from", f"write --what {first}")
    texts = {key: ", ".join(of) for key, of in groups.items()} | {key: one.text for key, one in drawings.items()}
    known = "; ".join(f"{key} ({text})" for key, text in texts.items())
    raise ResultError(
        "--what",
        f"there is no figure or variable '{first}'",
        f"{nearest(first, [*texts, *result.variables])}known: {known}; or a variable: {', '.join(result.variables)}",
    )


def slug(name: str) -> str:
    """A name as a part of a file's name: ``tension:winch to tip`` -> ``tension_winch_to_tip``."""
    return "_".join("".join(letter if letter.isalnum() else " " for letter in name.replace("-", "minus ")).split())
