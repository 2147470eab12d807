"""Where the vessel and the frames of a crane are at any time, as rotations and shifts of what is drawn."""

from __future__ import annotations

import numpy as np

from crane.assembly.layout import Layout, entries_of
from tautline.kernels.moving_frame import ENTRIES
from tautline.system.time_functions import compile_functions


def poses_of(layout: Layout, time: np.ndarray) -> dict[str | None, np.ndarray]:
    """Poses at some times.

    Parameters
    ----------
    layout : Layout
    time : (m,) array
        s.

    Returns
    -------
    dict of str or None to (m, 4, 4) array
        Of None for the ground, ``vessel``, and each frame by its name: what takes a place as drawn to where it is, m.
    """
    degrees = layout.degrees
    functions = compile_functions(layout.requests.of)
    poses: dict[str | None, np.ndarray] = {None: np.tile(np.eye(4), (time.size, 1, 1))}
    for k, frame in enumerate(layout.frames):
        entries = entries_of(degrees, functions, range(layout.frame[k], layout.frame[k] + ENTRIES), time)
        pose = np.tile(np.eye(4), (time.size, 1, 1))
        pose[:, :3, :3] = entries[:, 3:].reshape(-1, 3, 3).transpose(0, 2, 1)
        pose[:, :3, 3] = entries[:, :3] - pose[:, :3, :3] @ np.array(frame.pivot)
        poses[frame.name] = pose
    return poses
