"""Kinds of processor that compiled code is made for ahead of time, and which of them this one is.

A kernel that is compiled here is made for this very processor. What comes with an installation is made for a level of
its architecture that many have, and is used where all instructions of that level are there.
"""

from __future__ import annotations

import functools
import platform
from collections.abc import Mapping

import llvmlite.binding

from tautline.kernels.machine.settings import setting

LEVELS: dict[str, dict[str, tuple[str, ...]]] = {
    "x86_64": {
        "x86-64-v3": (
            "cx16", "sahf", "popcnt", "sse3", "ssse3", "sse4.1", "sse4.2", "crc32",
            "avx", "avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe", "xsave",
        ),
        "x86-64": (),
    },
    "aarch64": {"generic": ()},
}  # fmt: skip
"""By machine, names of LLVM's processors, best first, and the instructions beyond the architecture's first that each
takes for granted. x86-64-v3 is that of the psABI of x86-64, version 1.0, table 3.1: AVX2 with FMA, since 2013."""


def level_of(machine: str, features: Mapping[str, bool]) -> str | None:
    """The best level of a machine that has some instructions; None where none is known."""
    levels = LEVELS.get(machine, {})
    return next((level for level, asked in levels.items() if all(features.get(each) for each in asked)), None)


@functools.cache
def shipped_target() -> str | None:
    """The level that installed code is taken of; None where numba is told which processor to compile for."""
    if setting("CPU_NAME") is not None or setting("CPU_FEATURES") is not None or not setting("ENABLE_AVX", 1):
        return None
    return level_of(platform.machine(), _features())


@functools.cache
def target() -> tuple[str, str, str]:
    """What is compiled for: the system, the processor, and its instructions, as they are or as numba is told."""
    name, told = setting("CPU_NAME"), setting("CPU_FEATURES")
    without = "" if setting("ENABLE_AVX", 1) else " without AVX"
    features = instructions() if told is None else str(told)
    return llvmlite.binding.get_process_triple(), str(name or llvmlite.binding.get_host_cpu_name()), features + without


def instructions() -> str:
    """Instructions that this processor has and has not, as LLVM takes them."""
    features = _features()
    return str(features.flatten()) if hasattr(features, "flatten") else ""


def _features() -> Mapping[str, bool]:
    try:
        return llvmlite.binding.get_host_cpu_features()
    except RuntimeError:
        return {}
