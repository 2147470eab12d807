"""How an application's scenes are varied: the functions of a module of its own, where it has one."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import Any


def varied(module: str, scene: Any, what: str, *value: Any) -> Any:
    """Call the function ``what`` of a module with a scene; None if there is no such module or function."""
    if find_spec(module) is None:
        return None
    function = getattr(import_module(module), what, None)
    return None if function is None else function(scene, *value)
