"""What a command says of compiling: that it does, why, what of, and how long it took."""

from __future__ import annotations

import time
from collections.abc import Callable

from tautline.cli.output.console import say

FIRST_RUN = "first run of this kind of scene: compiling {kernels} of the solver.{once} Takes 5 s to 1 min"
"""Of a scene whose kernels are neither installed nor kept."""


def compiling(kernels: int) -> Callable[[], None]:
    """Say that kernels are compiled now, and why where an installation brought them; returns what says that it is done.

    Parameters
    ----------
    kernels : int
        How many there are to compile.
    """
    from tautline.kernels.machine.storage import is_kept, shipped_for

    made_for = shipped_for()
    if made_for is not None:
        say(f"note: the compiled kernels of this installation are for {made_for}, or for its unchanged sources")
    once = " Once only." if is_kept() else ""
    say(FIRST_RUN.format(kernels="1 kernel" if kernels == 1 else f"{kernels} kernels", once=once), "cyan")
    begun = time.perf_counter()

    def done() -> None:
        kept = ", and kept for later runs" if is_kept() else ""
        say(f"compiled in {time.perf_counter() - begun:.1f} s{kept}", "cyan")

    return done
