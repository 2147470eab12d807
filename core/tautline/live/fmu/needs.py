"""What an FMU needs of its host, told where it is written and in its documentation."""

from __future__ import annotations

import sys
import sysconfig
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tautline.version import __version__

PAGE = """Tautline {version} as an FMU for co-simulation, FMI {fmi}.0
======================================================

The scene, and the files that it names, lie in resources/. The host needs, on Linux or Windows, 64 bits:

{needs}

A communication step is one advance: it is divided into equal steps that are no longer than solver.step. An input is
reached at the end of the next communication step by a smooth curve. Parameters may be set before the initialisation
and at any communication point. Get, set and serialise of the FMU state are there, also in another process.
"""


def host_needs() -> list[str]:
    """What the host needs beside a master of FMI, a line each."""
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
    ]


def page_of(fmi: int) -> str:
    """The page of an FMU's documentation by version of the standard."""
    return PAGE.format(version=__version__, fmi=fmi, needs="\n".join(f"- {need}." for need in host_needs()))


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
