"""How kernels are compiled, as the environment says it; read without numba, which most runs do not load.

The names are numba's own. Where numba is loaded, what it goes by counts, for a program may have set it.
"""

from __future__ import annotations

import importlib
import os
import sys
from typing import Any

CONFIGURED = ".numba_config.yaml"
"""A file in the current folder in which numba looks for settings as well."""
SETTINGS: dict[str, Any] = {
    "OPT": 3, "LOOP_VECTORIZE": 1, "SLP_VECTORIZE": 0, "BOUNDSCHECK": None, "DEBUGINFO_DEFAULT": 0,
    "DISABLE_INTEL_SVML": 0,
}  # fmt: skip
"""Numba's settings that compiled code depends on, and what they are where nobody sets them."""


def _flag(name: str) -> bool:
    return os.environ.get(name, "") not in ("", "0")


PLAIN = _flag("TAUTLINE_PLAIN_NUMBA")
"""Whether kernels are compiled by numba's own steps, with nothing of ours; results are the same to rounding.

The operations are. Which products and sums become one instruction is LLVM's choice, and it may choose otherwise in code
that it has optimised twice.
"""
UNFUSED = _flag("TAUTLINE_UNFUSED")
"""Whether no product and sum become one instruction: then both ways give the same to the bit."""


def setting(name: str, usual: Any = None) -> Any:
    """One of numba's settings: a whole number, a text, or what is usual."""
    if "numba" in sys.modules or os.path.isfile(CONFIGURED):
        found = getattr(importlib.import_module("numba").config, name, usual)
    else:
        found = os.environ.get(f"NUMBA_{name}", usual)
    if found is None or found == "":
        return usual if found is None else found
    try:
        return int(found)
    except ValueError:
        return str(found)


UNCOMPILED = bool(setting("DISABLE_JIT", 0))
"""Whether kernels run as the Python functions that they are (``NUMBA_DISABLE_JIT=1``)."""


def settings() -> list[str]:
    """All that compiled code depends on, in words."""
    return [f"{name}={setting(name, usual)}" for name, usual in SETTINGS.items()]
