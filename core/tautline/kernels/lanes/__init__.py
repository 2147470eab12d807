"""Four members of a group at a time: numbers side by side in one register of the processor.

Compiled code works on `LANES` numbers in one instruction where they lie in one vector of LLVM. Its own vectoriser finds
nothing in the loops over lumps: their degrees of freedom lie four apart, their parameters are records, and two members
add to the same place. So lanes are a type of their own here. An expression of plain numbers, such as those that
``tautline.lumped.derive`` writes, stands for four members as soon as its arguments are lanes: ``+ - * /``, comparisons,
``abs``, and the functions below, which take plain numbers as well.

    for i in range(first, last, LANES):
        x, u, v, theta = load_rows(q, i, last)
        ...
        add_rows(r, i, last, along, north, east, about)

Lanes beyond the last member repeat it when they are read, and are left out when they are written; so every number of
members is gone through by the same code. Vectors are of four doubles, what AVX2 holds; LLVM makes two instructions of
them where registers are narrower. Without a compiler (``NUMBA_DISABLE_JIT=1``) lanes are arrays (4,), masks too.
"""

from tautline.kernels.lanes.arithmetic import (
    LANES,
    any_of,
    cos,
    exp,
    lane,
    larger,
    largest,
    negated,
    pack,
    sin,
    spread,
    sqrt,
    total,
    where,
    within,
)
from tautline.kernels.lanes.memory import (
    add_at_places,
    add_pairs_at_places,
    add_rows,
    add_to,
    collect,
    collect_fours,
    collect_pairs,
    equals,
    gather,
    keep_rows,
    laid_flat,
    load,
    load_fields,
    load_rows,
    same_rows,
    scatter,
    store,
    store_fields,
    transposed,
)

__all__ = [
    "LANES",
    "add_at_places",
    "add_pairs_at_places",
    "add_rows",
    "add_to",
    "any_of",
    "collect",
    "collect_fours",
    "collect_pairs",
    "cos",
    "equals",
    "exp",
    "gather",
    "keep_rows",
    "laid_flat",
    "lane",
    "larger",
    "largest",
    "load",
    "load_fields",
    "load_rows",
    "negated",
    "pack",
    "same_rows",
    "scatter",
    "sin",
    "spread",
    "sqrt",
    "store",
    "store_fields",
    "total",
    "transposed",
    "where",
    "within",
]
