"""What an FMU needs of its host, told where it is written and in its documentation."""

from __future__ import annotations

import sys
import sysconfig
from collections.abc import Iterable, Iterator, Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel

from tautline import entry_points
from tautline.application.installed import GROUP as APPLICATIONS
from tautline.application.installed import Installed
from tautline.live.errors import SimulationError
from tautline.scene.extensions import GROUP as EXTENSIONS
from tautline.version import __version__

if TYPE_CHECKING:
    from tautline.live.simulation import Simulation

PAGE = """Tautline {version} as an FMU for co-simulation, FMI {fmi}.0
======================================================

The scene, and the files that it names, lie in resources/. The host needs, on Linux or Windows, 64 bits:

{needs}

A communication step is one advance: it is divided into equal steps that are no longer than solver.step. An input is
reached at the end of the next communication step by a smooth curve, with the rates that are set beside it or are found
from the last values. Parameters may be set before the initialisation and at any communication point. Get, set and
serialise of the FMU state are there, also in another process.
"""


def packages_of_others(sim: Simulation) -> dict[str, str]:
    """Packages that are not ours and without which a scene is none: of its application, its items and its groups.

    Returns
    -------
    dict of str to str
        Name of the package that is imported -> what is installed: its name and version, empty where no entry point
        tells it.
    """
    used = [Installed().of(sim.scene), *_parts_of(sim.scene), *sim.model.system.groups]
    names = dict.fromkeys(type(one).__module__.partition(".")[0] for one in used)
    known = {
        entry_points.package_of(point): f"{point.dist.name} {point.dist.version}" if point.dist else ""
        for group in (APPLICATIONS, EXTENSIONS)
        for point in entry_points.in_group(group)
    }
    ours = {*entry_points.packages_of_ours(), *sys.stdlib_module_names} - {"__main__"}
    return {name: known.get(name, "") for name in names if name not in ours}


def _parts_of(thing: Any) -> Iterator[BaseModel]:
    """All models of a scene, itself first."""
    if isinstance(thing, BaseModel):
        yield thing
        # What was computed of it is kept beside its fields, and leads back to it.
        thing = [getattr(thing, name) for name in type(thing).model_fields] + list((thing.model_extra or {}).values())
    inner = thing.values() if isinstance(thing, dict) else thing if isinstance(thing, (list, tuple)) else ()
    for one in inner:
        yield from _parts_of(one)


def check_packages(packages: Mapping[str, str]) -> None:
    """Refuse a host without a package that the scene is made of; raises SimulationError."""
    missing = [told or name for name, told in packages.items() if name != "__main__" and find_spec(name) is None]
    if missing:
        named, python = " and ".join(missing), sys.executable or sys.prefix
        raise SimulationError(f"this FMU needs {named}, not installed in the Python {python}", "install it there")


def host_needs(packages: Mapping[str, str] | None = None) -> list[str]:
    """What the host needs beside a master of FMI, a line each.

    Parameters
    ----------
    packages : mapping of str to str, optional
        Those of others, as `packages_of_others` finds them.
    """
    version = ".".join(map(str, sys.version_info[:2]))
    found = python_library(sysconfig.get_config_vars())
    # PythonFMU's libraries are not linked to Python's: a program that is not Python has none of its symbols.
    loaded = f"`LD_PRELOAD={found or f'/path/to/libpython{version}.so.1.0'}`"
    whose = (
        "That is the shared library of the Python that wrote this FMU: on another machine, give that of its Python"
        if found
        else "That is the shared library of its Python. The Python that wrote this FMU has none: install one that has"
    )
    return [
        f"Python {version} or another version for which Tautline is installed, found by the host (the `python` of its "
        "path)",
        f'`pip install "tautline[fmi]=={__version__}"` in that Python. Another version of Tautline is refused',
        f"on Linux, for a host that is no Python program, {loaded} before the host's command. {whose}",
        *_others((packages or {}).items()),
    ]


def _others(packages: Iterable[tuple[str, str]]) -> Iterator[str]:
    for name, told in packages:
        if told:
            yield f"the package {told}, which brings a part of this scene, in that Python"
        else:
            cause = f"what `{name}` brings of this scene, as an installed package"
            yield f"{cause}: its entry point, of {EXTENSIONS} or {APPLICATIONS}, is what the host finds it by"


def page_of(fmi: int, needs: Iterable[str]) -> str:
    """The page of an FMU's documentation by version of the standard, with what the host needs."""
    return PAGE.format(version=__version__, fmi=fmi, needs="\n".join(f"- {need}." for need in needs))


def python_library(config: Mapping[str, Any]) -> Path | None:
    """Python's shared library, by how it was built (`sysconfig.get_config_vars`); None for one that is static."""
    folder = Path(config.get("LIBDIR") or "")
    # Debian has it in a folder of the machine's kind.
    for place in (folder, folder / (config.get("MULTIARCH") or "")):
        for key in ("INSTSONAME", "LDLIBRARY"):
            library = place / (config.get(key) or "")
            if ".so" in library.name and library.is_file():
                return library
    return None
