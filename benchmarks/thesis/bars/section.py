"""Cases 1 and 2 of the thesis (sections 2.5 and 2.6): bars that only stretch, beside its tables and figures."""

from __future__ import annotations

from benchmarks.page import Section, show
from benchmarks.thesis.bars import hammer, modes, penalty, strain

PARTS = (modes, hammer, strain, penalty)


def measure(quick: bool) -> Section:
    """Table 2.1 and Figs 2.10, 2.12, 2.21, 2.22, 2.24, 2.25, 2.26."""
    text = (
        "What tests hold the program to here is in [claims.md](claims.md). S = √(EA/ρA) is the speed of sound along "
        "the bar, L_e the length of an element.\n\n"
    )
    return Section("Cases 1 and 2: bars", text + "".join(part.part(quick) for part in PARTS), [])


if __name__ == "__main__":
    show(measure, __doc__)
