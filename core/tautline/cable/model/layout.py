"""Degrees of freedom of a cable scene: where each node's stand, what is held, prescribed, coupled."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

from tautline.cable.input.couplings import alike_within
from tautline.cable.input.parts import CableScene
from tautline.kernels.time_function import TimeFunctions, value_at
from tautline.scene.functions import Table
from tautline.scene.reading.document import join_key
from tautline.system.system import Degrees
from tautline.system.time_functions import FunctionRequest, Steering, compile_functions

DIRECTIONS = {7: ("rx", "ry", "rz", "r'x", "r'y", "r'z", "p"), 4: ("rx", "ry", "rz", "p")}


class Layout:
    """Where the degrees of freedom of a scene's nodes stand, and what they do.

    Attributes
    ----------
    scene : CableScene
    start : dict
        Node's id -> place of its first degree of freedom in the full vectors.
    kind : dict
        Node's id -> 7 or 4.
    last : dict
        Node's id -> place of its p, the last of its degrees of freedom.
    starts, lasts : (nodes,) int arrays
        The same, node by node as the scene has them.
    slopes : (m,) int array
        Where the slopes r' of those nodes begin that have one.
    flow : dict
        Id of the motion of a conveyed fluid -> place of its p.
    degrees : Degrees
    functions : TimeFunctions
    velocity : (n,) array
        At t = 0, m/s.
    """

    def __init__(
        self,
        scene: CableScene,
        material: dict[int, float],
        force: float,
        length: float,
        functions: TimeFunctions | None = None,
    ) -> None:
        """Lay out the nodes; ``force`` N and ``length`` m are large in the scene.

        ``functions`` are its functions of time where some are held at other values.
        """
        self.scene = scene
        ids, kinds = [node.id for node in scene.nodes], [int(node.kind) for node in scene.nodes]
        ends = np.cumsum([0, *kinds])
        self.kind = dict(zip(ids, kinds, strict=True))
        self.starts, self.lasts = ends[:-1], ends[1:] - 1
        self.start = dict(zip(ids, self.starts.tolist(), strict=True))
        self.last = dict(zip(ids, self.lasts.tolist(), strict=True))
        # Of a hundred thousand nodes the head of a name is made once.
        heads = [f"node {node}: " for node in ids]
        names = [head + name for head, kind in zip(heads, kinds, strict=True) for name in DIRECTIONS[kind]]
        value, scale = np.empty(ends[-1]), np.full(ends[-1], force)
        self.slopes = self.starts[np.array(kinds) == 7] + 3
        slopes = self.slopes[:, None] + np.arange(3)
        value[self.starts[:, None] + np.arange(3)] = [node.position for node in scene.nodes]
        value[slopes] = np.reshape([node.slope for node in scene.nodes if node.kind == 7], (-1, 3))
        value[self.lasts] = [material[node] for node in ids]
        scale[slopes] = force * length
        # What flows along an element's own curve has its p at no node.
        motions = {motion.id: motion for motion in scene.motions}
        streams = sorted({e.conveyed[1] for e in scene.elements if e.conveyed is not None})
        self.flow = {stream: len(names) + k for k, stream in enumerate(streams)}
        names += [f"p of {join_key(motions[stream].place)}" for stream in streams]
        value = np.append(value, [motions[stream].pos0 for stream in streams])
        scale = np.append(scale, np.full(len(streams), force))
        self.degrees = Degrees(names, value, scale)
        self.velocity = np.zeros(value.size)
        feeds = {node.functions[-1] for node in scene.nodes} | set(streams)
        as_given = scene.solver.start == "as given"
        self.requests = [request_of(m, scene.solver.end, as_given or m.id in feeds) for m in scene.motions]
        self.functions = compile_functions(self.requests) if functions is None else functions
        self._follow()
        for coupling in scene.couplings:
            masters = [(self.dof(node, dof), factor) for node, dof, factor in coupling.masters]
            self.degrees.tie(self.dof(*coupling.slave), masters, coupling.f0)
        self._settle()

    def dof(self, node: int, number: int) -> int:
        """Full place of a degree of freedom of a node, numbered from one as in the file."""
        return self.start[node] + number - 1

    def material(self, node: int) -> int:
        """Full place of a node's p."""
        return self.last[node]

    @functools.cached_property
    def ends(self) -> np.ndarray:
        """Both nodes of every element (elements, 2), numbered as the scene has them."""
        index = {node: i for i, node in enumerate(self.start)}
        nodes = [index[node] for element in self.scene.elements for node in element.nodes]
        return np.array(nodes, dtype=np.int64).reshape(-1, 2)

    def chords(self) -> np.ndarray:
        """From the first node of every element to the second at t = 0 (elements, 3), m."""
        first, second = (self.initial[self.starts[end][:, None] + np.arange(3)] for end in self.ends.T)
        return second - first

    @functools.cached_property
    def still_nodes(self) -> frozenset[int]:
        """Ids of the nodes whose material stays what it is at t = 0."""
        motion, masters = self.degrees.motion, self.degrees.masters
        return frozenset(
            node
            for node, place in self.last.items()
            if (self.is_still(place) if place in masters else motion.get(place) == -1)
        )

    def is_still(self, place: int) -> bool:
        """Whether a degree of freedom stays what it is at t = 0."""
        if place not in self.degrees.masters:
            return self.degrees.motion.get(place, 0) == -1
        return all(self.degrees.motion.get(i, 0) == -1 for i, _ in self.degrees.resolved(place))

    def rate_of(self, place: int) -> frozenset:
        """What the rate of a degree of freedom is made of: free masters and motions, each with its factor."""
        parts = []
        for i, factor in self.degrees.resolved(place):
            motion = self.degrees.motion.get(i)
            if motion is None:
                parts.append((i, factor))
            elif motion >= 0:
                given = self.scene.motions[motion]
                what = (given.times, given.velocities) if given.function is None and given.rate is None else motion
                parts.append((("motion", what), factor))
        return frozenset(parts)

    def run_alike(self, place: int, other: int) -> bool:
        """Whether two places are held and move when a run begins, at one rate or nearly, whatever drives each.

        A small difference adds a small force, the other end at 0 all of the momentum: what nearly agrees flows on.
        """
        rate, there = (abs(float(self.velocity[i])) for i in (place, other))
        apart = abs(float(self.velocity[place] - self.velocity[other]))
        most = alike_within(self.scene.solver.start) * max(rate, there)
        return 0.0 < rate and apart <= most and self.is_held(place) and self.is_held(other)

    def is_held(self, place: int) -> bool:
        """Whether a degree of freedom is fixed, prescribed, or follows only such ones."""
        return all(i in self.degrees.motion for i, _ in self.degrees.resolved(place))

    def _follow(self) -> None:
        """Hold and prescribe as the nodes say."""
        index, functions = {motion.id: k for k, motion in enumerate(self.scene.motions)}, self.functions
        held = {held: [k for k, flag in enumerate(held) if flag] for held in {node.held for node in self.scene.nodes}}
        for node, start in zip(self.scene.nodes, self.starts.tolist(), strict=True):
            for k in held[node.held]:
                if function := node.functions[k]:
                    motion = self.scene.motions[index[function]]
                    self.degrees.prescribe(start + k, index[function])
                    # A rate goes on from pos0, a function is the value itself.
                    self.degrees.value[start + k] = motion.pos0 if motion.function is None else 0.0
                    self.velocity[start + k] = value_at(functions, index[function], 0.0)[1]
                else:
                    self.degrees.fix(start + k)
        for stream, place in self.flow.items():
            self.degrees.prescribe(place, index[stream])
            self.velocity[place] = value_at(functions, index[stream], 0.0)[1]

    def _settle(self) -> None:
        """Give what is coupled, and what follows a function, its value and velocity at t = 0."""
        full = len(self.degrees.names)
        self.velocity = np.append(self.velocity, np.zeros(full - self.velocity.size))
        value = self.degrees.value.copy()
        for place, function in self.degrees.motion.items():
            if function >= 0:
                value[place] += value_at(self.functions, function, 0.0)[0]
        for place in self.degrees.masters:
            masters = self.degrees.resolved(place)
            self.degrees.value[place] = sum(f * value[i] for i, f in masters)
            self.velocity[place] = sum(f * self.velocity[i] for i, f in masters)
        self.initial = value
        for place in self.degrees.masters:
            self.initial[place] = self.degrees.value[place]


def request_of(motion: Any, end: float, from_zero: bool = False) -> FunctionRequest:
    """The function of time of a motion, good up to a time, s: its value, or what it has moved since the start.

    ``from_zero`` is whether the start can have moved by nothing: nothing brings to rest what does not follow it, or p
    follows it, and the p of other nodes stay as they are drawn.
    """
    name = f"function {motion.id}"
    its_rate = Steering(f"{name}.rate", "m/s", "its rate", 1)
    if motion.function is not None:
        value = Steering(name, "m", f"what follows {name}"), its_rate
        return FunctionRequest(motion.function, end=end, key=name, inputs=value)
    if motion.rate is not None:
        key = join_key(motion.place)
        speed = (Steering(key, "m/s", "its speed", 1, motion.factor),)
        return FunctionRequest(motion.rate, integrate=True, end=end, key=key, factor=motion.factor, inputs=speed)
    rate = Table(time=motion.times, value=motion.velocities, interpolation="linear")
    place = Steering(name, "m", f"what follows {name}, since the start", zero_at_start=from_zero), its_rate
    return FunctionRequest(rate, integrate=True, end=end, key=name, inputs=place)
