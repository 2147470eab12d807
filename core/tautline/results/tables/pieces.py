"""Pieces of time without a gap in a result that keeps windows round the extremes in place of every frame."""

from __future__ import annotations

from typing import Any

import numpy as np

SEEN = "frames_seen"
"""Attribute of such a result: how many frames its statistics are of."""
WINDOWS = "windows"
"""Attribute of such a result: spans of time in which every frame is kept."""
CLOSE = 1.0e-9
"""Of a time, by which a frame may lie outside of its window: times are rounded."""


def pieces_of(result: Any) -> np.ndarray | None:
    """Number of the piece of time, from 1, that each frame (m,) stands in; None where every frame is kept."""
    seen = int(result.attributes.get(SEEN, 0))
    time = np.asarray(result["time"], float)
    if seen <= time.size or time.size < 2:
        return None
    together = np.zeros(time.size - 1, bool)
    for window in result.attributes.get(WINDOWS, ()):
        begin, end = window["begin"] - CLOSE * time[-1], window["end"] + CLOSE * time[-1]
        together |= (time[:-1] >= begin) & (time[1:] <= end)
    return 1 + np.concatenate(([0], np.cumsum(~together)))


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
