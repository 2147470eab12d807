"""Forces on the nodes of each element by itself: what a section at its end carries, by the balance of the element.

The equations of a system add up, at each node, what its elements put there. Here the same groups run over nodes that no
two elements share: what stands at the ends of an element is then what holds it, its own inertia and weight with its
stresses. That is exact where stresses inside an element are not, which follow from the derivatives of its shape: in a
linear element at rest it differs from the force in the middle by the weight of half the element.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from tautline.kernels import groups as over
from tautline.kernels.groups import link
from tautline.kernels.jit import entry

NODE = 7
"""Places of a node of an element by itself; those of a linear one leave the last three empty."""


@entry
def _sum_apart(groups, places, time, full, own, force):
    """Residual of groups (frames, n) where position, velocity and acceleration of each frame are spread over places.

    ``full`` (3, frames, N) are these, ``own`` (4, n) is scratch.
    """
    q, v, a, r = own[0], own[1], own[2], own[3]
    for m in range(time.size):
        for k in range(places.size):
            i = places[k]
            r[k] = q[k] = v[k] = a[k] = 0.0
            if i >= 0:
                q[k], v[k], a[k] = full[0, m, i], full[1, m, i], full[2, m, i]
        over.residual(groups, time[m], q, v, a, r)
        for k in range(places.size):
            force[m, k] = r[k]


class Apart:
    """Elements whose nodes are their own.

    Parameters
    ----------
    members : list of (group, places)
        Groups whose rows have their nodes in ``a`` and ``b``, and which element each row is of. Their rows may change:
        they are read anew each time.
    starts : (elements, 2) int array
        Where the nodes of each element begin in the full vectors.
    sizes : (elements,) int array
        Degrees of freedom of each of its nodes.
    streams : Sequence of int
        Full places that rows name in ``flow``.
    """

    def __init__(
        self, members: Sequence[tuple[Any, np.ndarray]], starts: np.ndarray, sizes: np.ndarray, streams: Sequence[int]
    ) -> None:
        count = len(starts)
        of_nodes = starts[:, :, None] + np.arange(NODE)
        of_nodes[np.arange(NODE) >= np.broadcast_to(sizes[:, None, None], of_nodes.shape)] = -1
        self._places = np.append(of_nodes.ravel(), np.array(streams, dtype=np.int64)).astype(np.int64)
        self._stream = {place: 2 * NODE * count + k for k, place in enumerate(streams)}
        self._members = list(members)
        self._groups = tuple(_copied(group) for group, _ in members)
        self._count = count
        self._linked: Any = None

    def _refresh(self) -> None:
        """Take over the numbers of the rows as they are, but for the nodes."""
        for (group, elements), own in zip(self._members, self._groups, strict=True):
            rows, theirs = own.rows, group.rows
            rows[:] = theirs
            rows["a"] = 2 * NODE * elements
            rows["b"] = 2 * NODE * elements + NODE
            names = rows.dtype.names or ()
            if "flow" in names:
                rows["flow"] = [self._stream[int(place)] for place in theirs["flow"]]
            if "kinks" in names:
                # Momentum that is turned at a node is no force of a section.
                rows["kinks"] = 0.0

    def forces(self, frames: Any) -> np.ndarray:
        """Force on either end of each element from what is beyond it (frames, elements, 2, 3), N, global axes."""
        self._refresh()
        if self._linked is None:
            self._linked = link(self._groups, "residual")
        size = self._places.size
        time, full = np.array(frames.time, float), np.array([frames.q, frames.v, frames.a])
        force = np.zeros((time.size, size))
        _sum_apart(self._linked, self._places, time, full, np.zeros((4, size)), force)
        return force[:, : 2 * NODE * self._count].reshape(-1, self._count, 2, NODE)[..., :3]


def _copied(value: Any) -> Any:
    """A group with arrays of its own: scratch that two share is written by both."""
    if isinstance(value, np.ndarray):
        return value.copy()
    if isinstance(value, tuple):
        return type(value)(*map(_copied, value)) if hasattr(value, "_fields") else tuple(map(_copied, value))
    return value
