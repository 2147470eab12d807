"""Writing a scene as an FMU: the scene and the files that it names, what goes in and out, and a small script."""

from __future__ import annotations

import json
import re
import shutil
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

from tautline.live.errors import SimulationError
from tautline.live.fmu.needs import host_needs, packages_of_others, page_of
from tautline.live.fmu.scripts import module_of, script_of
from tautline.live.fmu.unit import DESCRIPTION, SCENE, parts_of
from tautline.live.simulation import Simulation
from tautline.results.errors import ResultError, unwritten
from tautline.results.output_path import check_unit
from tautline.scene.reading.files import files_of
from tautline.version import __version__
from tautline.whole_file import whole_file

PACKAGES = {2: "pythonfmu", 3: "pythonfmu3"}
"""What makes an FMU of each version of the standard."""
STATES = {
    2: {"canGetAndSetFMUstate": True, "canSerializeFMUstate": True, "canHandleVariableCommunicationStepSize": True},
    3: {"canGetAndSetFMUState": True, "canSerializeFMUState": True, "canHandleVariableCommunicationStepSize": True},
}


def write_fmu(scene: Any, path: str | Path, inputs: Sequence[str], outputs: Sequence[str], fmi: int = 2) -> list[str]:
    """Write a scene as an FMU.

    Parameters
    ----------
    scene : path, YAML text, dict or scene
    path : path
        The ``.fmu``.
    inputs, outputs : sequence of str
        Names, as `tautline.Simulation` has them.
    fmi : int
        Version of the standard: 2 or 3.

    Returns
    -------
    list of str
        What the host needs, a line each.

    Raises
    ------
    SceneError, StoppedEarly
        As `tautline.Simulation` does.
    UnknownName
        For a name that there is not.
    SimulationError
        For two inputs that drive the same.
    ResultError
        Where the file cannot be written or is there and no FMU of ours, or PythonFMU is missing.
    """
    path = Path(path)
    builder = _builder(path, fmi)
    check_unit(path)
    sim = Simulation(scene, inputs=inputs, keep=False)
    if not outputs:
        single = [name for name, one in sim.outputs.describe().items() if "." in name and " " not in name]
        example = ",".join(single[:2] or list(sim.outputs)[:2])
        cure = f"give names, such as --outputs {example}; known: {', '.join(sim.outputs)}"
        raise SimulationError("an FMU without an output says nothing", cure)
    for name in outputs:
        if not parts_of(sim.outputs.handle(name)):
            raise SimulationError(f"the output {name} has no numbers in this scene", "name another")
    _refuse_rivals(sim, inputs)
    name, packages = _model_name(path), packages_of_others(sim)
    needs = host_needs(packages)
    with tempfile.TemporaryDirectory() as work:
        folder = Path(work)
        files = _files(sim.scene, folder)
        script = folder / f"{module_of(script_of(fmi))}.py"
        script.write_text(script_of(fmi), encoding="utf8")
        told = {
            "inputs": list(inputs), "outputs": list(outputs), "name": name, "title": _title(path),
            "version": __version__, "packages": packages,
        }  # fmt: skip
        (folder / DESCRIPTION).write_text(json.dumps(told, indent=1), encoding="utf8")
        notes = folder / "documentation"
        notes.mkdir()
        (notes / "index.txt").write_text(page_of(fmi, needs), encoding="utf8")
        try:
            # PythonFMU3 names the file itself, and both leave one behind where they fail.
            made = folder / "made"
            made.mkdir()
            with _modules_as_before(script.stem):
                builder.build_FMU(
                    script, made, [folder / DESCRIPTION, *files], notes, canBeInstantiatedOnlyOncePerProcess=False,
                    needsExecutionTool=True, **STATES[fmi],
                )  # fmt: skip
            with whole_file(path) as waiting:
                shutil.copyfile(made / f"{name}.fmu", waiting)
        except OSError as error:
            raise unwritten(path, error, "choose another place") from None
    return needs


def _builder(path: Path, fmi: int) -> Any:
    """What makes an FMU of a version of the standard; raises SimulationError, or ResultError where it is missing."""
    if fmi not in PACKAGES:
        raise SimulationError(f"there is no FMI {fmi}.0", "take 2 or 3")
    package = PACKAGES[fmi]
    try:
        return import_module(package).FmuBuilder
    except ModuleNotFoundError:
        raise ResultError(path, f"needs {package}, which is not installed", "pip install 'tautline[fmi]'") from None


def _model_name(path: Path) -> str:
    """The name of a file as one that C allows: that of the library."""
    named = re.sub(r"\W", "_", path.stem, flags=re.ASCII)
    return named if named[:1].isalpha() else f"fmu_{named}"


def _title(path: Path) -> str:
    """The name of a file as it is, but for what no XML has."""
    return "".join(letter if letter.isprintable() else "_" for letter in path.stem)


@contextmanager
def _modules_as_before(script: str) -> Iterator[None]:
    """Undo what PythonFMU leaves: the folder of the script among those of modules, the script among the modules."""
    known, loaded = sys.path.copy(), sys.modules.get(script)
    try:
        yield
    finally:
        sys.path[:] = known
        sys.modules.pop(script, None)
        if loaded is not None:  # this process is the host of an FMU too
            sys.modules[script] = loaded


def _refuse_rivals(sim: Simulation, inputs: Sequence[str]) -> None:
    """Refuse two inputs that drive the same: a host sets all of them, and one would be lost."""
    taken = {part for name in inputs for part in sim.inputs.parts_of(name)}
    for name in inputs:
        for other in sim.inputs.rivals(name):
            if other in taken:
                raise SimulationError(f"{name} and {other} drive the same", "leave one of them out of --inputs")


def _files(scene: Any, folder: Path) -> list[Path]:
    """The scene as a file, and copies of those that it names beside it."""
    (folder / SCENE).write_text(scene.document.told, encoding="utf8")
    made = [folder / SCENE]
    for name in files_of(scene):
        source = Path(name)
        if source.is_absolute() or ".." in source.parts:
            cause = f"names the file {source}, which lies outside of its own folder"
            raise SimulationError(f"the scene {cause}", "copy the file beside the scene")
        target = folder / source
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes((scene.folder / source).read_bytes())
        made.append(folder / source.parts[0])
    return list(dict.fromkeys(made))
