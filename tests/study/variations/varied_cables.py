"""Cable scenes that are varied, and what is asked of what comes of them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import yaml
from physics.cables.axial_bars import element as bar_element
from physics.cables.axial_bars import node as bar_node
from physics.cables.rope_text import FREE, PINNED, chain, element, node, scene, straight
from scipy.interpolate import CubicHermiteSpline

from tautline.cable.application import Cable
from tautline.cable.input.scene import parse, read
from tautline.cable.model.build import build
from tautline.cable.study.refinement import Chart, runs_of
from tautline.integrators.state import new_state
from tautline.integrators.vibration.modes import modes
from tautline.scene.errors import SceneError

HERE = Path(__file__).parents[2]
DATA = HERE.parent / "data"
SHIPPED = sorted(
    path.stem for path in DATA.glob("*.yaml") if "CableModel" in yaml.safe_load(path.read_text(encoding="utf8"))
)
ARC = np.linspace(0.0, 1.2, 5)
CURVED = np.column_stack([np.sin(ARC), 0.1 * ARC**2, 1.0 - np.cos(ARC)])


# scenes
def bent(linear=False, more="", held=None, **material):
    """Four elements along an arc between two supports, stretched a little; the file leaves nothing to be found."""
    ends = {0: PINNED, 4: PINNED} if held is None else held
    items = chain(CURVED, ARC / 1.01, ends, linear=linear, **({"EA": 1e4} | material)) + more
    return parse(scene(items, start="static"))


def sliding(n=3, angle=0.5, stretch=1.0):
    """A rope that slides down between two supports: all p follow that of the first node."""
    along = np.array([np.cos(angle), 0.0, -np.sin(angle)])
    p = np.linspace(0, 1 / stretch, n + 1)
    held = {i: (0, 0, 0, 0, 0, 0, 0) for i in range(n + 1)} | {i: (1, 1, 1, 0, 0, 0, 0) for i in (0, n)}
    items = chain(straight(0 * along, along, n), p, held, slopes=np.tile(stretch * along, (n + 1, 1)), EA=1e5)
    for i in range(1, n + 1):
        masters = "masters: [{mNode: 0, mDof: 7, factor: 1}]"
        items += f"  - LinearCoupl: {{id: {i}, sNode: {i}, sDof: 7, f0: {float(p[i])!r}, {masters}}}\n"
    return parse(scene(items, type="Newmark"))


def interpolated():
    """A rope on an eyelet, where p is free: what is between it and the fixed end keeps its share."""
    held = {0: PINNED, 1: (0,) * 7, 2: (0,) * 7, 3: (1, 1, 1, 0, 0, 0, 0), 4: FREE}
    items = chain(straight([0, 0, 0], [2, 0, 0], 4), np.linspace(0, 2, 5), held, EA=1e4)
    for i in (1, 2):
        masters = f"[{{mNode: 3, mDof: 7, factor: {i / 3!r}}}]"
        items += f"  - LinearCoupl: {{id: {i}, sNode: {i}, sDof: 7, masters: {masters}}}\n"
    return parse(scene(items))


def passing(same=True):
    """A rope that is fed in at one end and taken off at the other: at one rate, or at two."""
    through = {0: (1, 1, 1, 0, 0, 0, 1), 1: (1, 1, 1, 0, 0, 0, 1)}
    items = chain(straight([0, 0, 0], [1, 0, 0], 1), np.array([0.0, 1.0]), through, EA=1e4,
                  functions={0: (0,) * 6 + (1,), 1: (0,) * 6 + (2,)})  # fmt: skip
    for number, begin, rate in ((1, 0.0, -0.3), (2, 1.0, -0.3 if same else -0.1)):
        listed = f"timeList: [0, 1], velocityList: [{rate}, {rate}]"
        items += f"  - Function_VelocityDefined: {{id: {number}, pos0: {begin}, {listed}}}\n"
    return parse(scene(items, time_step=0.01, time_end=0.2))


def carried():
    """A bar along x that two driven ends carry along y."""
    items = chain(straight([0, 0, 0], [1, 0, 0], 1), np.array([0.0, 1.0]), {}, EA=1e3)
    items = items.replace("BC: [0, 0, 0, 0, 0, 0, 1]", "BC: [0, 1, 1, 0, 1, 1, 1], BC_functions: [0, 1, 0, 0, 0, 0, 0]")
    items += "  - Function: {id: 1, value: {ramp: {to: 0.2, over: 0.1}}}\n"
    return parse(scene(items, (0, 0, 0), time_step=0.01, time_end=0.2))


def tied(way, whats=(0, 2), **keys):
    """A bar of two halves, each of two elements, tied in the middle; EA = rhoA = 1 and a metre long."""
    p = (0.0, 0.25, 0.5, 0.5, 0.75, 1.0)
    items = [bar_node(i, x, "free" if i else "pinned", p=x) for i, x in enumerate(p)]
    items += [bar_element(i, ends, EA=1.0) for i, ends in enumerate([(0, 1), (1, 2), (3, 4), (4, 5)])]
    more = "".join(f", {key}: {value}" for key, value in keys.items())
    items += [f"{way}7: {{id: {what}, nodes7: [2, 3], constr: {what}{more}}}" for what in whats]
    listed = "".join(f"  - {item}\n" for item in items)
    return parse(scene(listed, (0, 0, 0)))


def mixed():
    """Ties of several methods, springs, masses, forces and plots, each on a node of one chain."""
    more = "  - Penalty7: {id: 1, nodes7: [4, 5], constr: 0, p_spring: 3.0e5}\n"
    more += "  - Penalty7: {id: 2, nodes7: [4, 5], constr: 2}\n"
    more += "  - LagMultipl7: {id: 3, nodes7: [5, 4], constr: 1}\n"
    more += "  - OneNodeSpring: {id: 1, nodes7: [1], stiffness: 250.0, damping: 1.0}\n"
    more += "  - OneNodeSpring: {id: 2, nodes7: [5], stiffness: 70.0}\n  - PointMass: {id: 1, nodes7: [2], mass: 2}\n"
    more += "  - TwoNodeSpring: {id: 1, nodes7: [1, 3], stiffness: 9.0}\n"
    more += "  - PointForce: {id: 1, nodes7: [3], force: [0, 1, 0]}\n"
    end = CURVED[-1]
    more += node(5, end, [0, 0, 1], FREE, ARC[-1] / 1.01) + node(6, end + [0, 0, 1], [0, 0, 1], FREE)
    more += element(7, 5, 6, EA=1e4, extra=", compression: false, load: [0, 1, 0]")
    text = scene(chain(CURVED, ARC / 1.01, {0: PINNED}, EA=1e4, EJ=2.0, damping=0.01) + more)
    return parse(text + "Plots:\n  - SubPlot: [{Cable: 7, what: N}, {Cable: 0, what: kappa}, {Node: 6, what: p}]\n")


def hung():
    """An arc, and a rope that hangs on its middle by couplings."""
    items = chain(CURVED, ARC / 1.01, {0: PINNED, 4: PINNED}, EA=1e4)
    items += node(5, CURVED[2], [0, 0, -1], FREE, 0.0) + node(6, CURVED[2] - [0, 0, 1], [0, 0, -1], FREE, 1.0)
    items += element(5, 5, 6, EA=1e4)
    for dof in (1, 2, 3):
        items += f"  - LinearCoupl: {{id: {dof}, sNode: 5, sDof: {dof}, masters: [{{mNode: 2, mDof: {dof}}}]}}\n"
    return parse(scene(items, start="static"))


MORE = {
    "a stretched arc": bent,
    "a rope that hangs on another": hung,
    "a bent arc": lambda: bent(EJ=3.0, extra=", quadrature: gauss"),
    "an arc from its far end": lambda: parse(
        scene(chain(CURVED, ARC / 1.01, {0: PINNED, 4: PINNED}, reverse=True, EA=1e4))
    ),
    "an arc of linear elements": lambda: bent(linear=True),
    "a rope that slides": sliding,
    "a rope on an eyelet": interpolated,
    "a rope that passes through": passing,
    "a rope that is stretched as it passes": lambda: passing(False),
    "a bar that is carried": carried,
    "multipliers": lambda: tied("LagMultipl"),
    "penalty springs": lambda: tied("Penalty", p_spring=2.0e4),
    "springs of the builder's choice": lambda: tied("AugLagrange"),
    "everything": mixed,
    "the appendix": lambda: read(HERE / "input" / "appendix_a.yaml"),
    "coordinates that the file leaves out": lambda: parse(Cable().templates["span"]),
    "one bar": lambda: parse(Cable().templates["bar"].replace("Node: 2", "Node: 0")),
}
SCENES = {name: lambda name=name: read(DATA / f"{name}.yaml") for name in SHIPPED} | MORE


def is_sound(made):
    try:
        build(made)
    except SceneError:
        return False
    return True


# what is asked of them
def by_id(parts):
    return {part.id: part for part in parts}


def curve(made, element, p):
    """Position and slope (n, 6) of an element at material coordinates, by scipy's Hermite spline or along the chord."""
    chart = Chart(made)
    ends = [chart.nodes[i] for i in element.nodes]
    x = [chart.p[i] for i in element.nodes]
    if element.kind == "linear":
        share = (p[:, None] - x[0]) / (x[1] - x[0])
        r = (1.0 - share) * ends[0].position + share * np.array(ends[1].position)
        return np.hstack([r, np.tile(np.subtract(ends[1].position, ends[0].position) / (x[1] - x[0]), (len(p), 1))])
    spline = CubicHermiteSpline(x, [end.position for end in ends], [end.slope for end in ends])
    return np.hstack([spline(p), spline(p, 1)])


def accuracy(p):
    """What rounding leaves of position and slope (6,) on an element; slopes are differences over its length."""
    return np.repeat([1e-14, max(1e-14, 2e-15 / np.ptp(p))], 3)


def is_same_curve(fine, coarse):
    """Whether every element of one scene lies on one of the other, with its section; lengths and mass are as before."""
    p_of = {id(made): Chart(made).p for made in (fine, coarse)}
    left = {element.id: 0.0 for element in coarse.elements}
    for piece in fine.elements:
        p = np.linspace(*(p_of[id(fine)][i] for i in piece.nodes), 7)
        middle = p.mean()
        owners = [
            one for one in coarse.elements
            if p_of[id(coarse)][one.nodes[0]] < middle < p_of[id(coarse)][one.nodes[1]]
            and np.all(np.abs(curve(coarse, one, p) - curve(fine, piece, p)) < accuracy(p))
            and one._replace(id=0, nodes=(0, 0), line=0, place=())
            == piece._replace(id=0, nodes=(0, 0), line=0, place=())
        ]  # fmt: skip
        if len(owners) != 1:
            return False
        left[owners[0].id] += p[-1] - p[0]
    lengths = {one.id: Chart(coarse).length(one) for one in coarse.elements}
    return all(abs(left[i] - lengths[i]) < 1e-14 for i in left)


def count(made):
    return [len(run.elements) for run in runs_of(Chart(made))]


def without_mesh(made):
    """All of a scene that a mesh does not change: what stands on nodes, and how it is solved."""
    names = ("title", "gravity", "ties", "forces", "anchors", "springs", "masses", "motions", "solver", "warnings")
    return [getattr(made, name) for name in names]


def with_coordinates(made):
    """A scene whose nodes all say their p, as those of a divided one do."""
    p = Chart(made).p
    return replace(made, nodes=tuple(n if n.functions[-1] else n._replace(p=p[n.id]) for n in made.nodes))


def frequencies(made):
    """Angular frequencies of a scene as it begins, ascending, rad/s."""
    model = build(made)
    return modes(model.system, new_state(model.system)).omega
