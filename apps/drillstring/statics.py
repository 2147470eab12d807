"""A string that is picked up, slacked off or turned slowly: statics of the lumped model with friction in a direction.

The string is the dynamic model's, lump by lump, with its stretch, its clearance and its bending; only the law of
friction is another (sliding.py). The block is set so that the bit is at the depth asked for: a string that hangs in a
well is longer by its stretch. The bit carries its force along the hole and touches the wall as every lump does; the
lump in the drive does not.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from drillstring.build import build, tubes_of, well_of
from drillstring.contact import WallContact
from drillstring.ends import Bit, Top
from drillstring.factors import Factors, same
from drillstring.fluid import fluid_of, weight_in
from drillstring.helix import LOCKED_STRAIN, LockedUp, helix_force, limits_at
from drillstring.hole import Friction
from drillstring.motion import MOTIONS, Motion
from drillstring.scene import LUMPED, DrillstringScene
from drillstring.sliding import SLIDING, Sliding
from drillstring.string import Tube, cut
from tautline.elements.load import Loads
from tautline.integrators.equilibrium import find_equilibrium
from tautline.integrators.march import new_frames
from tautline.integrators.state import State, new_state
from tautline.integrators.status import Status, StoppedEarly
from tautline.lumped.curve import PER_BODY, records
from tautline.scene.errors import SceneError

AT_DEPTH = 1.0e-7
"""Distance of the bit from its depth, m, that is left."""
PLACINGS = 8
"""Times that the block is set anew."""
PASSES, SETTLED = 200, 1.0e-7
"""Passes in which the friction of helices is found, and its relative change that ends them."""
SMALLEST_PART = 1.0 / 256.0
"""Part of the way from one friction factor to the next below which the search for an equilibrium is given up."""


class Profile(NamedTuple):
    """The string at rest under friction in one direction.

    Hook load N; surface torque N m; position of the block that puts the bit at its depth, m; of the lumps measured
    depth (n + 1,) m and side force per length (n + 1,) N/m; of the links measured depth of the middle (n,) m, effective
    tension (n,) N and torque (n,) N m.
    """

    hook_load: float
    surface_torque: float
    block: float
    measured_depth: np.ndarray
    side_force: np.ndarray
    link_depth: np.ndarray
    tension: np.ndarray
    torque: np.ndarray


def shortened(
    scene: DrillstringScene, well_length: float, depth: float, elements: int, above: float = 0.0
) -> DrillstringScene:
    """The scene with its bit at a depth, hanging still: the ``rest`` of the string, or else its top section, is cut.

    What is left of the string is longer than the depth by what stands ``above`` the table, m.

    Raises
    ------
    SceneError
        Where the depth is outside the well, or above what the other sections take.
    """
    at = next((i for i, section in enumerate(scene.string) if section.length == "rest"), 0)
    total = depth + above
    others = sum(float(section.length) for i, section in enumerate(scene.string) if i != at)
    if depth > well_length * (1.0 + 1e-9):
        cause = f"the bit would be at {depth:g} m, below the end of the well, {well_length:g} m"
        raise SceneError([scene.problem("well", cause, "give depths within the well, or deepen it")])
    if total <= others * (1.0 + 1e-9):
        name = scene.string[at].name
        cause = f"with the bit at {depth:g} m nothing is left of {name}: the other sections are {others:g} m long"
        cure = f"give depths of more than {others - above:g} m"
        raise SceneError([scene.problem(("string", at, "length"), cause, cure)])
    assert scene.well.wall is not None
    free = scene.model.elements == elements
    string = tuple(
        section.model_copy(
            update={"length": total - others if i == at else section.length} | ({} if free else {"elements": None})
        )
        for i, section in enumerate(scene.string)
    )
    wall = scene.well.wall.model_copy(update={"friction": Friction(static=0.0, kinetic=0.0), "casing": None})
    return scene.model_copy(
        update={
            "string": string,
            "well": scene.well.model_copy(update={"wall": wall}),
            "model": scene.model.model_copy(update={"elements": elements, "kind": LUMPED}),
            "top": Top(),
            # A bit held on the axis would carry the side force of the last half link without friction.
            # A bit on bottom is its weight on bit: the string would otherwise be hung from where the rock is.
            "bit": Bit(force=scene.bit.load),
        }
    )


def weight_per_length(scene: DrillstringScene, tubes: list[Tube]) -> np.ndarray:
    """Buoyed weight of each section, N/m."""
    fluid = fluid_of(scene.mud)
    return np.array([weight_in(fluid, tube, scene.gravity) for tube in tubes])


class Statics:
    """A string with its bit at one depth, to be solved for friction factors and directions.

    Parameters
    ----------
    scene : DrillstringScene
        With a wall.
    depth : float
        Measured depth of the bit, m.
    elements : int
        Links of the string.
    above : float
        Length of the string that stands above the rotary table, m: of a stand that was pulled.

    Raises
    ------
    SceneError
        As :func:`shortened` and the builder do.
    """

    def __init__(self, scene: DrillstringScene, depth: float, elements: int, above: float = 0.0) -> None:
        self.well = well_of(scene)
        hung = shortened(scene, self.well.length, depth, elements, above)
        self.depth, self.above = depth, above
        self.tubes = tubes_of(hung, depth + above)
        self.lumps = cut(self.tubes, elements)
        self.weight = weight_per_length(hung, self.tubes)
        self.model = build(hung)
        (contact,) = (g for g in self.model.system.groups if isinstance(g, WallContact))
        self.rows = records(contact.springs.size, SLIDING)
        self.contact = contact._replace(law=Sliding(self.rows))
        own = [self.contact if isinstance(g, WallContact) else g for g in self.model.system.groups]
        given = next((g for g in own if isinstance(g, Loads)), Loads(np.zeros(0, np.int64), np.zeros(0)))
        helix = PER_BODY * self.contact.springs.body
        places = np.concatenate([given.place, helix, helix + 3])
        self.helix = Loads(places, np.append(given.value, np.zeros(2 * helix.size)))
        groups = (*(g for g in own if not isinstance(g, Loads)), self.helix)
        self.system = replace(self.model.system, groups=groups, linked={})
        self.block = next(k for k, i in enumerate(self.system.dofs.held) if i == 0)
        self.shoe = 0.0 if scene.well.wall is None or scene.well.wall.casing is None else scene.well.wall.casing.shoe
        self.free: tuple[np.ndarray, float] | None = None
        self.pipes = [self.tubes[k] for k in self.lumps.section]
        self.clearance = 0.5 * (scene.well.diameter - np.array([tube.contact_od for tube in self.pipes]))
        middle = self.lumps.measured_depth[:-1] + 0.5 * self.lumps.length - above
        self.limits = limits_at(self.well, middle, self.pipes, self.weight[self.lumps.section], self.clearance)

    def solve(self, friction: float | Factors, motion: str | Motion) -> Profile:
        """Equilibrium with all of Coulomb's friction against a motion.

        Parameters
        ----------
        friction : float or Factors
            Friction factor, or those of the cased and of the open hole.
        motion : str or Motion
            ``pick_up``, ``slack_off`` or ``rotating``, or speeds along the hole and about its axis.

        Returns
        -------
        Profile

        Raises
        ------
        StoppedEarly
            NO_EQUILIBRIUM, naming the unknown that is worst, and the friction factor.
        LockedUp
            Where the friction of a helix outgrows any force.
        """
        moved = MOTIONS[motion] if isinstance(motion, str) else motion
        self.rows.along, self.rows.around = moved.friction(self.contact.springs.radius)
        state = new_state(self.system)
        self._press(np.zeros(self.rows.size))
        self._without_friction(state)
        self._approach(state, same(friction, self.shoe))
        return self._buckled(state)

    def _without_friction(self, state: State) -> None:
        """Where every search starts."""
        if self.free is None:
            self.rows.factor = 0.0
            self._shift(state, self.above)
            self._place(state)
            self.free = state.q.copy(), float(self.system.dofs.offset[self.block])
        state.q[:], self.system.dofs.offset[self.block] = self.free

    def _approach(self, state: State, factors: Factors) -> None:
        """Go to friction factors at once, or where that fails by parts."""
        most = factors.over(*(end[1:] - self.above for end in self.lumps.reach))
        here, part = 0.0, 1.0
        while here < 1.0:
            goal = min(1.0, here + part * (1.0 - here))
            kept, block = state.q.copy(), float(self.system.dofs.offset[self.block])
            try:
                self.rows.factor = goal * most
                self._place(state)
            except StoppedEarly as stop:
                state.q[:], self.system.dofs.offset[self.block] = kept, block
                part *= 0.5
                if part < SMALLEST_PART or factors.largest == 0.0:
                    detail = f"bit at {self.depth:g} m, friction factor {factors.times(goal):g}"
                    raise StoppedEarly(Status.NO_EQUILIBRIUM, 0.0, stop.part, detail) from None
                continue
            here, part = goal, min(1.0, 2.0 * part)

    def _buckled(self, state: State) -> Profile:
        """With the friction of helices, by substitution: what a helix adds changes the compression above it alone."""
        stiffness = np.array([tube.youngs_modulus * tube.area for tube in self.pipes])
        rigidity = np.array([tube.youngs_modulus * tube.second_moment for tube in self.pipes])
        added = np.zeros(self.rows.size)
        for _ in range(PASSES):
            profile = self._profile(state)
            pushed = np.maximum(0.0, -profile.tension)
            gone = pushed > LOCKED_STRAIN * stiffness
            if gone.any():
                raise LockedUp(float(profile.link_depth[gone].max()))
            helix = helix_force(pushed, self.clearance, rigidity) * (pushed >= self.limits.helical)
            halves = 0.5 * helix * self.lumps.length
            wall = np.append(halves, 0.0) + np.append(0.0, halves)
            lying = profile.side_force * self.lumps.tributary
            wanted = np.maximum(0.0, wall - lying)[1:]
            if np.abs(wanted - added).max() <= SETTLED * max(1.0, float(np.abs(wanted).max())):
                side = np.maximum(profile.side_force, wall / self.lumps.tributary)
                return profile._replace(side_force=side)
            added = wanted
            self._press(added)
            self._place(state)
        raise StoppedEarly(Status.NO_EQUILIBRIUM, 0.0, "the helix", f"bit at {self.depth:g} m")

    def _press(self, wall: np.ndarray) -> None:
        """Friction of so much more wall force (n,) N at the lumps, along the hole and about its axis."""
        size = self.rows.factor * wall
        radius = self.contact.springs.radius
        self.helix.value[-2 * wall.size :] = np.append(size * self.rows.along, size * self.rows.around * radius)

    def _place(self, state: State) -> None:
        """Equilibrium with the bit at its depth: the block gives way by what the bit is off."""
        for _ in range(PLACINGS):
            find_equilibrium(self.system, state, self.model.step_limit)
            off = float(state.full_q[-PER_BODY]) + self.above
            if abs(off) < AT_DEPTH:
                return
            self._shift(state, off)

    def _shift(self, state: State, up: float) -> None:
        """Move block and string up the hole as a whole, so that the next search is a short one."""
        self.system.dofs.offset[self.block] -= up
        state.q[np.isin(self.system.free, PER_BODY * np.arange(self.lumps.length.size + 1))] -= up

    def _profile(self, state: State) -> Profile:
        frames = new_frames(1, self.system.q.size, self.model.own)
        frames.q[0], frames.residual[0] = state.full_q, state.residual
        seen = {name: values[0] for name, values in self.model.observe(frames).items()}
        q, springs = state.full_q.reshape(-1, PER_BODY), self.contact.springs
        depth = np.hypot(q[springs.body, 1], q[springs.body, 2]) - springs.clearance
        side = np.zeros(q.shape[0])
        side[springs.body] = np.maximum(0.0, springs.stiffness * depth) / self.lumps.tributary[springs.body]
        md = seen["measured_depth"]
        return Profile(
            float(seen["hook_load"]), float(seen["surface_torque"]), float(q[0, 0]), md, side,
            0.5 * (md[1:] + md[:-1]), seen["tension"], seen["torque"],
        )  # fmt: skip
