"""Lanes from memory and to it: members side by side, rows of four numbers, fields of records, and members anywhere.

This is what NumPy does where nothing is compiled; see :mod:`tautline.kernels.compiling.types.lanes_in_memory`.
"""

from __future__ import annotations

import numpy as np

from tautline.kernels.lanes.arithmetic import LANES
from tautline.kernels.numba_registration import taught


def laid_flat(array):
    """The numbers of an array without gaps, one after the other: a view."""
    return array.reshape(-1)


def load(array, i):
    """Entries i to i + 3 of an array without gaps, of single precision too."""
    return array[i : i + LANES].astype(float)


def store(array, i, x):
    """Write lanes over entries i to i + 3 of an array without gaps; into one of single precision they are rounded."""
    array[i : i + LANES] = x


def gather(array, i, last):
    """Entries i to i + 3 of an array (n,), or a field of records, as numbers; those from ``last`` on repeat it."""
    return array[np.minimum(np.arange(i, i + LANES), last - 1)].astype(float)


def equals(array, i, last, value):
    """Which of entries i to i + 3 of an array of whole numbers, or a field of records, are ``value``."""
    return array[np.minimum(np.arange(i, i + LANES), last - 1)] == value


def scatter(array, i, last, x):
    """Write lanes over entries i to i + 3, those before ``last``."""
    n = min(LANES, last - i)
    array[i : i + n] = np.broadcast_to(x, LANES)[:n]


def load_rows(array, i, last):
    """Columns of rows i to i + 3 of an array of four numbers a row, laid flat: four lanes.

    Rows from ``last`` on repeat the one before. So the four coordinates of four bodies are read by four loads.
    """
    rows = array.reshape(-1, LANES)[np.minimum(np.arange(i, i + LANES), last - 1)]
    return tuple(rows[:, k].copy() for k in range(LANES))


def load_fields(array, i, last):
    """Four successive fields of records i to i + 3, numbers all, of which ``array`` is the first: four lanes.

    Records from ``last`` on repeat the one before it.
    """
    fields = np.lib.stride_tricks.as_strided(array, (array.size, LANES), (*array.strides, 8))
    rows = fields[np.minimum(np.arange(i, i + LANES), last - 1)]
    return tuple(rows[:, k].copy() for k in range(LANES))


def store_fields(array, i, last, a, b, c, d):
    """Write lanes over four successive fields of records i to i + 3, those before ``last``; see `load_fields`.

    A processor waits long where it reads four numbers at once that it has just written one by one.
    """
    n = min(LANES, last - i)
    fields = np.lib.stride_tricks.as_strided(array, (array.size, LANES), (*array.strides, 8))
    fields[i : i + n] = np.column_stack([np.broadcast_to(x, LANES) for x in (a, b, c, d)])[:n]


def add_rows(array, i, last, a, b, c, d):
    """Add four lanes to the columns of rows i to i + 3, before ``last``, of four numbers each, laid flat."""
    n = min(LANES, last - i)
    rows = np.column_stack([np.broadcast_to(x, LANES) for x in (a, b, c, d)])
    array.reshape(-1, LANES)[i : i + n] += rows[:n]


def same_rows(array, i, last, kept, at):
    """Whether rows i to i + 3, of four numbers each, are those that stand in ``kept`` from place ``at`` on."""
    rows = array.reshape(-1, LANES)[np.minimum(np.arange(i, i + LANES), last - 1)]
    return bool(np.all(rows.ravel() == kept[at : at + LANES * LANES]))


def keep_rows(array, i, last, kept, at):
    """Write rows i to i + 3, of four numbers each, into ``kept`` from place ``at`` on; see `same_rows`."""
    rows = array.reshape(-1, LANES)[np.minimum(np.arange(i, i + LANES), last - 1)]
    kept[at : at + LANES * LANES] = rows.ravel()


def collect(array, places, offset):
    """Entries of an array at four places, each moved by ``offset``."""
    return np.array([array[place + offset] for place in places])


def collect_fours(array, places, offset):
    """Four numbers each from four places on, moved by ``offset``, as columns: the k-th lanes are the k-th numbers."""
    rows = np.array([array[place + offset : place + offset + LANES] for place in places])
    return tuple(rows[:, k].copy() for k in range(LANES))


def collect_pairs(array, places, offset):
    """The same with two numbers each: two lanes."""
    rows = np.array([array[place + offset : place + offset + 2] for place in places])
    return rows[:, 0].copy(), rows[:, 1].copy()


def add_to(array, places, offset, x):
    """Add lanes to an array at four places, each moved by ``offset``, one after the other: they may be the same."""
    for place, value in zip(places, x, strict=True):
        array[place + offset] += value


def transposed(a, b, c, d):
    """Four lanes as columns made rows: the k-th of what comes back holds the k-th numbers of all."""
    return tuple(np.column_stack([a, b, c, d]))


def add_at_places(array, places, offset, rows):
    """Add a row of four numbers each to successive entries of an array from four places on, moved by ``offset``.

    One after the other: they may overlap. A processor waits long where it reads four numbers that it has just written
    by other fours, so what overlaps is to overlap by the whole.
    """
    for place, row in zip(places, rows, strict=True):
        array[place + offset : place + offset + LANES] += row


def add_pairs_at_places(array, places, offset, a, b):
    """The same with two numbers each: entry k of two lanes."""
    for place, one, other in zip(places, a, b, strict=True):
        array[place + offset : place + offset + 2] += one, other


taught("types.lanes_in_memory")
