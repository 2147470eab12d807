"""Whether three runs of one scene come nearer to one motion, and by which order, as their whole histories show it.

A run with steps h is off by c(t) h^p where it converges. Differences of successive runs are then multiples of one
function of time: c(t) (h1^p - h2^p) and c(t) (h2^p - h3^p). Two functions of one shape have a cosine of 1, and what is
not resolved, or is another event in each run, one about zero. Where the shape is one, the sizes of both tell p, of what
changes its sign too. A single value, such as the highest of a force, tells it only by chance.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tautline.study.trials.step_error import LOWEST, ORDER, order_of

ONE_SHAPE = 0.5
"""Cosine of two differences from which they count as of one shape."""


def order_of_one_shape(histories: Sequence[np.ndarray], ratios: Sequence[float]) -> float | None:
    """The order by which three runs converge; None where their differences have no shape in common.

    Parameters
    ----------
    histories : sequence of ndarray, each of shape (m,) or (m, 3)
        The same quantity at the same times, of the runs in the order of their steps, the longest first.
    ratios : sequence of float
        h2/h3 and h1/h2: the longer step over the shorter, of the last two runs and of those before.

    Returns
    -------
    float or None
        Between a half and two. Runs that do not differ show none.
    """
    first, second, third = histories
    if not first.shape == second.shape == third.shape:
        return None
    before, last = (second - first).ravel(), (third - second).ravel()
    sizes = float(np.linalg.norm(last)), float(np.linalg.norm(before))
    if not min(sizes) > 0.0 or not np.isfinite(max(sizes)):
        return None
    cosine = float(before / sizes[1] @ (last / sizes[0]))
    return order_of(sizes, ratios, ORDER, LOWEST) if cosine >= ONE_SHAPE else None
