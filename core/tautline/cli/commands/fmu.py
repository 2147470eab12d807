"""The verb ``fmu``."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from tautline.application.installed import Catalogue, Installed
from tautline.cli.options.changes import change_of
from tautline.cli.output.console import print_json, say
from tautline.cli.output.preparing import preparing
from tautline.cli.output.scene_warnings import print_warnings, warning_records
from tautline.scene.errors import option_error


def fmu(
    catalogue: Catalogue, path: Path, output: Path | None, changes: Sequence[str] | None, inputs: Sequence[str],
    outputs: Sequence[str], fmi: int, as_json: bool,
) -> None:  # fmt: skip
    """Write a scene as an FMU for co-simulation, and say what its host needs.

    Parameters
    ----------
    inputs, outputs : sequence of str
        Values of the options: a name each, or several between commas.

    Raises
    ------
    SceneError, ResultError
        For bad input, and names that there are not; nothing is written then.
    """
    from tautline.live.errors import SimulationError
    from tautline.live.fmu.unit import actual_of
    from tautline.live.fmu.writing import write_fmu

    application, scene = catalogue.read(path, change_of(changes))
    target = output or Path(f"{path.stem}.fmu")
    named = {
        "--inputs": _names(inputs, lambda name: _has(scene, "inputs", name)),
        "--outputs": _names(outputs, lambda name: _has(scene, "outputs", name)),
    }
    with preparing(path, scene):
        warnings = application.warnings(scene)
    try:
        needs = write_fmu(scene, target, named["--inputs"], named["--outputs"], fmi)
    except SimulationError as error:
        kinds = {"output": "--outputs", "FMI": "--fmi"}
        option = next((one for word, one in kinds.items() if word in error.cause), "--inputs")
        raise option_error(option, "", error.cause, error.cure) from None
    print_warnings(warnings)
    say(f"wrote {target}")
    for name in named["--outputs"]:
        if (own := actual_of(name, named["--inputs"])) != name:
            say(f"{name} is an input too: the output has the name {own}")
    say(f"the host needs, beside a master of FMI {fmi}.0:")
    for line in needs:
        say(f"  {line}")
    if as_json:
        print_json(
            {"status": "done", "fmu": str(target), **{key[2:]: names for key, names in named.items()}, "needs": needs}
            | {"scene_warnings": warning_records(warnings)}
        )


def _names(values: Sequence[str], known: Callable[[str], bool]) -> list[str]:
    """Names of values: one that is a name as it stands, commas and all, is that name; others are split at commas."""
    names: list[str] = []
    for value in values:
        whole = "," in value and known(value.strip())
        names += [value.strip()] if whole else [name.strip() for name in value.split(",") if name.strip()]
    return names


def _has(scene: Any, kind: str, name: str) -> bool:
    """Whether a scene has an input, or an output, of that name."""
    from tautline.errors import TautlineError
    from tautline.live.readings import handles_of
    from tautline.system.handles import output_named

    application = Installed().of(scene)
    try:
        handles = handles_of(application.build(application.driven(scene, (name,) * (kind == "inputs"))))
        if kind == "outputs":
            return output_named(handles.outputs, name) is not None
    except (TautlineError, IndexError):
        return False
    return name in handles.inputs or f"{name}[0]" in handles.inputs
