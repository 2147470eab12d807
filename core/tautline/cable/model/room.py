"""By how much what belongs to each element may change at once in a search for rest.

The limit of a step is that of the shortest element. Were it that of all, a fitting of 1 mm would let elements of metres
change by half a millimetre in an iteration, and no search would come to its end.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tautline.cable.model.layout import Layout


def rooms(layout: Layout, lengths: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """Room of each full degree of freedom (n_full,), and of the differences between neighbours (3 elements,).

    Both are multiples of what the shortest element allows. The ends of an element may come by so much of its own length
    closer or further apart. Material at a node is part of all elements there, of which the shortest counts, and so is
    a node's position where it has to be limited by itself. A slope is no length, and that of a short element may turn
    as far as any: the element of median length counts, by which moments are judged too.

    Parameters
    ----------
    layout : Layout
    lengths : sequence of float
        Of the elements, m.
    """
    length = np.array(lengths, dtype=float)
    median, shortest = float(np.median(length)), float(length.min())
    at_node = np.full(layout.starts.size, np.inf)
    for end in layout.ends.T:
        np.minimum.at(at_node, end, length)
    at_node[np.isinf(at_node)] = median
    room = np.full(len(layout.degrees.names), median)
    room[layout.starts[:, None] + np.arange(3)] = at_node[:, None]
    room[layout.lasts] = at_node
    for place in layout.degrees.masters:
        for master, _ in layout.degrees.resolved(place):
            room[master] = min(room[master], room[place])
    return room / shortest, np.repeat(length / shortest, 3)
