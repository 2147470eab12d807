"""The verb ``fmu``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from tautline.application.installed import Catalogue
from tautline.cli.options.changes import changed
from tautline.cli.output.console import print_json, say
from tautline.scene.errors import option_error


def fmu(
    catalogue: Catalogue, path: Path, output: Path | None, changes: Sequence[str] | None, inputs: str, outputs: str,
    fmi: int, as_json: bool,
) -> None:  # fmt: skip
    """Write a scene as an FMU for co-simulation, and say what its host needs.

    Raises
    ------
    SceneError, ResultError
        For bad input, and names that there are not; nothing is written then.
    """
    from tautline.live.errors import SimulationError
    from tautline.live.fmu.writing import write_fmu

    scene = changed(catalogue.read(path)[1], changes)
    target = output or Path(f"{path.stem}.fmu")
    named = {"--inputs": _names(inputs), "--outputs": _names(outputs)}
    try:
        needs = write_fmu(scene, target, named["--inputs"], named["--outputs"], fmi)
    except SimulationError as error:
        kinds = {"output": "--outputs", "FMI": "--fmi"}
        option = next((one for word, one in kinds.items() if word in error.cause), "--inputs")
        raise option_error(option, "", error.cause, error.cure) from None
    say(f"wrote {target}")
    say(f"the host needs, beside a master of FMI {fmi}.0:")
    for line in needs:
        say(f"  {line.removeprefix('- ').rstrip(';.')}")
    if as_json:
        print_json(
            {"status": "done", "fmu": str(target), **{key[2:]: names for key, names in named.items()}, "needs": needs}
        )


def _names(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]
