"""Pieces of time without a gap in a result that keeps windows round the extremes in place of every frame."""

from __future__ import annotations

from typing import Any

import numpy as np

SEEN = "frames_seen"
"""Attribute of such a result: how many frames its statistics are of."""
APART = 1.5
"""Time between two frames, over that between neighbours of the run, from which frames are missing between them."""


def pieces_of(result: Any) -> np.ndarray | None:
    """Number of the piece of time, from 1, that each frame (m,) stands in; None where every frame is kept."""
    seen = int(result.attributes.get(SEEN, 0))
    time = np.asarray(result["time"], float)
    if seen <= time.size or time.size < 2:
        return None
    interval = (time[-1] - time[0]) / (seen - 1)
    return 1 + np.concatenate(([0], np.cumsum(np.diff(time) > APART * interval)))


def pieces_said(result: Any) -> str:
    """A sentence on the pieces, and what tells them in tables; empty where every frame is kept."""
    pieces = pieces_of(result)
    if pieces is None:
        return ""
    time, edges = np.asarray(result["time"], float), np.flatnonzero(np.diff(pieces)) + 1
    begins, ends = time[[0, *edges]], time[[*(edges - 1), -1]]
    spans = [f"{one:.6g}" if one == two else f"{one:.6g} to {two:.6g}" for one, two in zip(begins, ends, strict=True)]
    return (
        f"keeps {time.size} of {int(result.attributes[SEEN])} frames: t = {', '.join(spans)} s. Tables over time have "
        "the column `piece`, which counts these spans. Frames between them are not kept"
    )
