"""Writing a scene as an FMU: the scene and the files that it names, what goes in and out, and a small script."""

from __future__ import annotations

import json
import re
import shutil
import sys
import tempfile
import zipfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from importlib.machinery import PathFinder
from itertools import count
from pathlib import Path
from typing import Any

from tautline.live.errors import SimulationError, UnknownName
from tautline.live.fmu.needs import host_needs, packages_of_others, page_of
from tautline.live.fmu.scripts import module_of, script_of
from tautline.live.fmu.unit import DESCRIPTION, RATES, SCENE, parts_of, rates_of
from tautline.live.simulation import Simulation
from tautline.results.errors import ResultError, unwritten
from tautline.results.output_path import check_unit
from tautline.scene.reading.files import files_of
from tautline.version import __version__
from tautline.whole_file import whole_file

PACKAGES = {2: "pythonfmu", 3: "pythonfmu3"}
"""What makes an FMU of each version of the standard."""
CACHE = "__pycache__"
"""A folder that PythonFMU leaves out."""
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
        Names, as `tautline.Simulation` has them. Beside that of an input those of its rates may stand, such as
        ``vessel.heave.rate`` and ``vessel.heave.second_rate``.
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
        For two inputs that drive the same, and a second rate without the rate.
    ResultError
        Where the file cannot be written or is there and no FMU of ours, or PythonFMU is missing.
    """
    path = Path(path)
    builder = _builder(path, fmi)
    check_unit(path)
    inputs, rates = rates_of(inputs)
    sim = _driven(scene, inputs)
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
    told = {
        "inputs": inputs, "rates": rates, "outputs": list(outputs), "name": name, "title": _title(path),
        "version": __version__, "packages": packages,
    }  # fmt: skip
    try:
        with tempfile.TemporaryDirectory() as work:
            made = _built(builder, sim.scene, told, page_of(fmi, needs), fmi, Path(work))
            _check_library(made, path, PACKAGES[fmi])
            with whole_file(path) as waiting:
                shutil.copyfile(made, waiting)
    except OSError as error:
        raise unwritten(path, error, "choose another place") from None
    return needs


def _driven(scene: Any, inputs: Sequence[str]) -> Simulation:
    """A simulation with inputs; raises as it does, and for a rate of what is not asked for itself."""
    try:
        return Simulation(scene, inputs=inputs, keep=False)
    except UnknownName:
        for name in inputs:
            for end in RATES:
                if name.endswith(end):
                    cause = f"{name} would be a rate of {name.removesuffix(end)}, which is not among the inputs"
                    raise SimulationError(cause, f"name {name.removesuffix(end)} too") from None
        raise


def _built(builder: Any, scene: Any, told: dict[str, Any], page: str, fmi: int, folder: Path) -> Path:
    """The FMU as PythonFMU makes it in an empty folder.

    Parameters
    ----------
    builder : class
        `FmuBuilder` of a PythonFMU.
    scene : scene
    told : dict
        What the unit is told beside the name of its scene's file.
    page : str
        Its documentation.
    fmi : int
        Version of the standard.
    folder : path
    """
    script = folder / f"{module_of(script_of(fmi))}.py"
    script.write_text(script_of(fmi), encoding="utf8")
    # In a folder of their own the scene's files meet nothing of the FMU's, whatever their names.
    told = {**told, "scene": _put_scene(scene, folder / SCENE)}
    (folder / DESCRIPTION).write_text(json.dumps(told, indent=1), encoding="utf8")
    notes, made = folder / "documentation", folder / "made"
    notes.mkdir()
    (notes / "index.txt").write_text(page, encoding="utf8")
    # PythonFMU3 names the file itself, and both leave one behind where they fail.
    made.mkdir()
    with _modules_as_before(script.stem), _libraries_at_hand(sys.modules[builder.__module__], PACKAGES[fmi]):
        builder.build_FMU(
            script, made, [folder / DESCRIPTION, folder / SCENE], notes, canBeInstantiatedOnlyOncePerProcess=False,
            needsExecutionTool=True, **STATES[fmi],
        )  # fmt: skip
    return made / f"{told['name']}.fmu"


def _check_library(made: Path, path: Path, package: str) -> None:
    """Refuse an FMU that PythonFMU made without a library, which no host can load; raises ResultError."""
    with zipfile.ZipFile(made) as file:
        if not any(name.startswith("binaries/") for name in file.namelist()):
            cause, cure = f"cannot be written: {package} gave it no library", f"install {package} anew"
            raise ResultError(path, cause, f"{cure}: pip install --force-reinstall {package}")


def _builder(path: Path, fmi: int) -> Any:
    """What makes an FMU of a version of the standard; raises SimulationError, or ResultError where it is missing."""
    if fmi not in PACKAGES:
        raise SimulationError(f"there is no FMI {fmi}.0", "take 2 or 3")
    package = PACKAGES[fmi]
    try:
        made_by: Any = import_module(f"{package}.builder")
    except ModuleNotFoundError:
        raise ResultError(path, f"needs {package}, which is not installed", "pip install 'tautline[fmi]'") from None
    return made_by.FmuBuilder


@contextmanager
def _libraries_at_hand(made_by: Any, package: str) -> Iterator[None]:
    """Let PythonFMU take what goes into an FMU from where it is installed, and put back where it looked before.

    In a process that has hosted an FMU it is the copy out of that, which has no libraries and may be deleted by now.
    """
    before = made_by.HERE
    made_by.HERE = next(filter(_has_libraries, (before, *_folders_of(package))), before)
    try:
        yield
    finally:
        made_by.HERE = before


def _has_libraries(folder: Path) -> bool:
    """Whether a folder is that of a PythonFMU itself, and no copy in an FMU."""
    return (folder / "resources" / "binaries").is_dir()


def _folders_of(package: str) -> Iterator[Path]:
    """All folders that Python could import a package from: it takes the first, which may be in an FMU."""
    for place in sys.path:
        spec = PathFinder.find_spec(package, [place])
        if spec is not None and spec.origin:
            yield Path(spec.origin).parent


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


def _put_scene(scene: Any, folder: Path) -> str:
    """Put a scene into a new folder, with copies of the files that it names; returns the name of its own file."""
    sources = [Path(name) for name in files_of(scene)]
    for source in sources:
        if source.is_absolute() or ".." in source.parts:
            cause = f"names the file {source}, which lies outside of its own folder"
            raise SimulationError(f"the scene {cause}", "copy the file beside the scene")
        if CACHE in source.parts:
            cause = f"names the file {source}, and PythonFMU leaves folders of the name {CACHE} out of an FMU"
            raise SimulationError(f"the scene {cause}", "give the folder another name")
    # Some hosts take capitals for small letters in the names of files.
    taken = {source.parts[0].casefold() for source in sources}
    name = next(name for k in count() if (name := f"scene{k or ''}.yaml") not in taken)
    folder.mkdir()
    (folder / name).write_text(scene.document.told, encoding="utf8")
    for source in sources:
        target = folder / source
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes((scene.folder / source).read_bytes())
    return name
