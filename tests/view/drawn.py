"""A small appearance made by hand, for tests of what draws it: a rope over a sheave with a load, a sea, a scale."""

import numpy as np

from tautline.view.space.appearance import (
    LOAD,
    Appearance,
    Arrows,
    Label,
    Level,
    Line,
    Look,
    Ruler,
    Solid,
    axes_of,
    pose_of,
    ranged,
)
from tautline.view.space.mesh import box, joined, turned_about

FRAMES = 41
TIME = np.linspace(0.0, 10.0, FRAMES)
TOP = np.array([12.0, 0.0, 30.0])
RADIUS = 2.0
NODES = np.array([0, 4, 16, 20])
SHEAVE = joined(
    turned_about([(0.3, -0.2), (2.0, -0.2), (1.9, 0.0), (2.0, 0.2), (0.3, 0.2), (0.3, -0.2)]), box((3, 0.3, 0.3))
)


def load(frame: int) -> np.ndarray:
    """Place of the load: it is hoisted by a metre a second."""
    return np.array([14.0, 0.0, 2.0 + TIME[frame]])


def rope(frame: int) -> np.ndarray:
    """From a winch up to the sheave, a quarter around it, and down to the load; 21 points."""
    angle = np.linspace(0.0, 0.5 * np.pi, 13)
    arc = TOP + RADIUS * np.stack([np.sin(angle), 0.0 * angle, np.cos(angle)], axis=-1)
    before = np.linspace([0.0, 0.0, 30.0 + RADIUS], arc[0], 5)[:-1]
    after = np.linspace(arc[-1], load(frame), 5)[1:]
    return np.concatenate([before, arc, after])


def tension() -> np.ndarray:
    """(frames, 21) N: grows along the rope and with time."""
    return 1.0e4 * (1.0 + np.arange(21) / 20.0)[None, :] * (1.0 + 0.1 * TIME[:, None])


def appearance(**changes) -> Appearance:
    """All of it; `changes` replace its parts."""
    values = tension()
    twist = np.linspace(-2.0, 6.0, 21)[None, :] * np.ones((FRAMES, 1))
    quantities = (ranged("tension", "tension", "N", values), ranged("twist", "twist", "rad/m", twist))
    parts = {
        "lines": (Line("rope", rope, 0.15, quantities, nodes=NODES),),
        "solids": (
            Solid("sheave", *SHEAVE, pose=lambda frame: pose_of(TOP, axes_of([0, 1, 0], 0.5 * TIME[frame]))),
            Solid("load", *box((2.0, 2.0, 2.0)), pose=lambda frame: pose_of(load(frame) - [0, 0, 1.0]), colour=LOAD),
        ),
        "arrows": (
            Arrows(
                "weight", "weight", "N", lambda frame: load(frame)[None], lambda frame: np.array([[0, 0, -5e4]]), 5e4
            ),
        ),
        "levels": (Level("sea", -3.0),),
        "labels": (Label("load", lambda frame: load(frame) + [1.2, 0, 0]),),
        "rulers": (Ruler("height", "m", np.array([[-4.0, 0, z] for z in (0, 10, 20, 30)]), np.arange(0, 31, 10)),),
        "eye": (0.0, -1.0, 0.15),
    }
    return Appearance("Hoist by hand", TIME, **(parts | changes))


def volume(points: np.ndarray, triangles: np.ndarray) -> float:
    """Signed volume of a closed surface, by the divergence theorem: positive where triangles look outwards."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) / 6.0


USUAL = Look()
