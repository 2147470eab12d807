"""Results of motions that are made up, of real scenes: observed as a run's frames are, without solving anything."""

import numpy as np

from tautline.cable.input.scene import parse
from tautline.cable.model.build import build
from tautline.integrators.time_loop import new_frames
from tautline.results.store import Store


def moved(text, size=0.03, frames=21, interval=0.01, still=(), rates=None, path=None):
    """A result of a cable scene whose nodes' positions and slopes swing by `size`; nodes named in `still` rest.

    Frames are `interval` apart, s. `rates` is the rate of p, m/s, of nodes, by their place in the scene.
    """
    scene = parse(text)
    model = build(scene)
    start = np.cumsum([0, *(node.kind for node in scene.nodes)])
    frames_ = new_frames(frames, len(model.system.q), 0)
    time = interval * np.arange(frames)
    frames_.time[:] = time
    rng = np.random.default_rng(1)
    for i, node in enumerate(scene.nodes):
        home = np.array([*node.position, *(node.slope or ())])
        swing = 0.0 if node.id in still else size * rng.uniform(-1, 1, len(home))
        turn = 2.0 * np.pi * rng.uniform(1.0, 3.0, len(home))
        at = start[i] + np.arange(len(home))
        frames_.q[:, at] = home + swing * np.sin(turn * time[:, None])
        frames_.v[:, at] = swing * turn * np.cos(turn * time[:, None])
        rate = (rates or {}).get(node.id, 0.0)
        p = start[i] + node.kind - 1
        frames_.q[:, p], frames_.v[:, p] = model.system.q[p] + rate * time, rate
    values = {"time": time} | model.observe(frames_)
    with Store(path, model.variables, model.coordinates, model.attributes) as store:
        store.append(values)
        return store.finish()
