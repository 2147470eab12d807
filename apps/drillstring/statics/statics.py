"""A string that is picked up, slacked off or turned slowly: statics of either model with friction in a direction.

The string is the dynamic model's, lump by lump or element by element, with its stretch, its clearance and its bending;
only the law of friction is another (sliding.py). The block is set so that the bit is at the depth asked for: a string
that hangs in a well is longer by its stretch. The bit carries its force along the hole and touches the wall as every
lump does; the lump in the drive does not.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from drillstring.drilling.end_groups import BLOCK
from drillstring.groups.sliding import SLIDING
from drillstring.model.build import build
from drillstring.model.prepared import tubes_of, well_of
from drillstring.scene.ends import Bit, Top
from drillstring.scene.hole import Friction
from drillstring.scene.scene import BEAM, DrillstringScene
from drillstring.statics.helix import LOCKED_STRAIN, LockedUp, helix_force
from drillstring.statics.motion import MOTIONS, Motion
from drillstring.statics.sliding_lumps import SlidingLumps
from drillstring.statics.soft_string import StringInHole
from drillstring.string.buckling import limits_at
from drillstring.string.factors import Factors, same
from drillstring.string.fluid import fluid_of, weight_in
from drillstring.string.lumps import Tube, cut
from tautline.elements.nodal.load import Loads
from tautline.integrators.state import State, new_state
from tautline.integrators.statics.equilibrium import TOO_FAR, UNSETTLED, find_equilibrium
from tautline.integrators.status import Status, StoppedEarly
from tautline.integrators.time_loop import new_frames
from tautline.scene.errors import SceneError
from tautline.scene.values.systems import usual_unit
from tautline.scene.values.units import converted, read_unit
from tautline.system.records import records

PAST_THE_END = 0.05
"""Distance, m, below the end of a well at which a bit is taken to be at its end: tallies are rounded to some
centimetres, and feet to a hundredth."""
AT_DEPTH = 1.0e-7
"""Distance of the bit from its depth, m, that is left."""
PLACINGS = 8
"""Times that the block is set anew."""
BALANCE = 1.0e-10
"""Residual over its scale that counts as balance where nothing is braced."""
PASSES, SETTLED = 200, 1.0e-7
"""Passes in which the friction of helices is found, and its relative change that ends them."""
IN_TURN = 40
"""Passes after which what is a helix stays one."""
BRACINGS, ENOUGH = 5, 1.1
"""Times that braces are sought that hold, and the compression over that which they are made for up to which they do."""
FOLDED = 0.02
"""Part of a link by which it may be shorter along the hole than it is: a string that lies in a hole lacks far less."""
SMALLEST_PART = 1.0 / 256.0
"""Part of the way from one friction factor to the next below which the search for an equilibrium is given up."""


NO_BALANCE = {
    True: "no shape of the string was found that balances; take fewer elements (--elements), or less force on the bit",
    False: "no shape of the string was found that balances; take less force on the bit",
}
"""Cause and cure where no equilibrium was found, by whether the string is one of lumps. Of a string that is pushed
beyond its limit of buckling, lumps of short links are the hardest to balance."""


class Profile(NamedTuple):
    """The string at rest under friction in one direction.

    Hook load N; surface torque N m; position of the block that puts the bit at its depth, m; of the lumps, or of the
    points where a beam touches, measured depth (k,) m and side force per length (k,) N/m; of the links or elements
    measured depth of the middle (n,) m, effective tension (n,) N and torque (n,) N m.
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
    scene: DrillstringScene,
    well_length: float,
    depth: float,
    elements: int,
    above: float = 0.0,
    unit: str | None = None,
) -> DrillstringScene:
    """The scene with its bit at a depth, hanging still: the ``rest`` of the string, or else its top section, is cut.

    What is left of the string is longer than the depth by what stands ``above`` the table, m. A bit up to
    `PAST_THE_END` below the end of the well is at its end. Errors tell depths in a ``unit``, the scene's if None.

    Raises
    ------
    SceneError
        Where the depth is outside the well, or above what the other sections take.
    """
    at = next((i for i, section in enumerate(scene.string) if section.length == "rest"), 0)
    others = sum(float(section.length) for i, section in enumerate(scene.string) if i != at)
    unit = unit or usual_unit("m", scene.units) or "m"
    size = converted(read_unit(unit), read_unit("m")).si(Fraction(1))

    def told(length: float) -> str:
        return f"{length / size:.7g} {unit}"

    if depth > well_length + PAST_THE_END:
        cause = f"the bit would be at {told(depth)}, below the end of the well, {told(well_length)}"
        raise SceneError([scene.problem("well", cause, "give depths within the well, or deepen it")])
    total = min(depth, well_length) + above
    if total <= others * (1.0 + 1e-9):
        name = scene.string[at].name
        cause = f"with the bit at {told(depth)} nothing is left of {name}: the other sections are {told(others)} long"
        cure = f"give depths of more than {told(others - above)}"
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
            "model": scene.model.model_copy(update={"elements": elements}),
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
    unit : str, optional
        In which errors tell depths; that of the scene if None.

    Raises
    ------
    SceneError
        As :func:`shortened` and the builder do.
    """

    def __init__(
        self, scene: DrillstringScene, depth: float, elements: int, above: float = 0.0, unit: str | None = None
    ) -> None:
        self.well = well_of(scene)
        hung = shortened(scene, self.well.length, depth, elements, above, unit)
        depth = min(depth, self.well.length)
        self.depth, self.above = depth, above
        self.tubes = tubes_of(hung, depth + above)
        self.lumps = cut(self.tubes, elements)
        self.weight = weight_per_length(hung, self.tubes)
        self.model = build(hung)
        self.system = system = self.model.system
        self.string = _kind_of(hung)(system, self.lumps, self.well, depth, above)
        contact = self.string.contact
        self.radius = contact.springs.radius
        self.rows = records(contact.springs.size, SLIDING)
        self._slide()
        self.bit_force, self.diameter = scene.bit.load, scene.well.diameter
        self.soft = StringInHole(self.well, self.tubes, self.weight, self.diameter)
        self.block = int(np.flatnonzero(self.system.dofs.motion == BLOCK)[0])
        self.shoe = 0.0 if scene.well.wall is None or scene.well.wall.casing is None else scene.well.wall.casing.shoe
        self.free: tuple[np.ndarray, float] | None = None
        self.begun: tuple[np.ndarray, float] | None = None
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
        self.rows.along, self.rows.around = moved.friction(self.radius)
        state = new_state(self.system)
        factors = same(friction, self.shoe)
        braced = np.maximum(self._pushed(factors, moved), self._pushed(same(0.0), moved))
        for _ in range(BRACINGS):
            if self.string.brace(braced, self.limits.sinusoidal):
                self.begun, self.free = self.free or self.begun, None
                self._slide()
            profile = self._found(state, factors)
            pushed = np.maximum(0.0, -profile.tension)
            if np.all(pushed <= np.maximum(ENOUGH * braced, self.limits.sinusoidal)):
                return profile
            # It has buckled between its braces, and what that adds in friction has pushed it beyond them.
            braced = np.maximum(braced, pushed)
        raise StoppedEarly(Status.NO_EQUILIBRIUM, 0.0, "the string that is pushed", f"bit at {self.depth:g} m")

    def _slide(self) -> None:
        """Have the system slide, with the braces that the string has by now."""
        contact, groups = self.string.contact, self.model.system.groups
        others = tuple(g for g in groups if g is not contact and not isinstance(g, Loads))
        sliding = self.string.slide(self.rows)
        if len(others) + len(sliding) != len(self.system.groups) or self.system is self.model.system:
            self.system = replace(self.model.system, groups=(*others, *sliding), linked={})

    def _found(self, state: State, factors: Factors) -> Profile:
        self.string.press(np.zeros(self.rows.size), np.zeros(self.rows.size), state.full_q)
        self._without_friction(state)
        self._approach(state, factors)
        return self._buckled(state)

    def _pushed(self, factors: Factors, motion: Motion) -> np.ndarray:
        """Largest compression of the soft string in each link (n,), N; raises LockedUp where it is endless."""
        soft = self.soft.solved(factors, motion, self.bit_force)
        if soft.locked is not None:
            raise LockedUp(soft.locked)
        pushed = np.maximum(0.0, -soft.tension)
        at_ends = np.interp(self.lumps.measured_depth, soft.measured_depth, pushed)
        return np.maximum(at_ends[:-1], at_ends[1:])

    def _without_friction(self, state: State) -> None:
        """Where every search starts."""
        if self.free is None:
            self.rows.factor = 0.0
            if self.begun is None:
                self._shift(state, self.above)
            else:
                # With other braces it lies nearly as it did.
                state.q[:], self.system.dofs.offset[self.block] = self.begun
            self.string.move_aside(state)
            self._place(state)
            self.free = state.q.copy(), float(self.system.dofs.offset[self.block])
        state.q[:], self.system.dofs.offset[self.block] = self.free

    def _approach(self, state: State, factors: Factors) -> None:
        """Go to friction factors at once, or where that fails by parts."""
        most = factors.over(*(end - self.above for end in self.string.reach))
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
                    detail = f"bit at {self.depth:g} m, friction factor {factors.times(goal):g}: {stop.detail}"
                    raise StoppedEarly(Status.NO_EQUILIBRIUM, 0.0, stop.part, detail) from None
                continue
            here, part = goal, min(1.0, 2.0 * part)

    def _buckled(self, state: State) -> Profile:
        """With the friction of helices, by substitution: what a helix adds changes the compression above it alone."""
        stiffness = np.array([tube.youngs_modulus * tube.area for tube in self.pipes])
        rigidity = np.array([tube.youngs_modulus * tube.second_moment for tube in self.pipes])
        added, helical = np.zeros(self.rows.size), np.zeros(rigidity.size, dtype=bool)
        for done in range(PASSES):
            profile = self._profile(state)
            pushed = np.maximum(0.0, -profile.tension)
            gone = pushed > LOCKED_STRAIN * stiffness
            if gone.any():
                raise LockedUp(float(profile.link_depth[gone].max()))
            # A link whose helix takes it below its limit, and so its helix away, would be in turn one and none.
            helical = (pushed >= self.limits.helical) | (helical & (done >= IN_TURN))
            helix = helix_force(pushed, self.clearance, rigidity) * helical
            wall, length = self.string.spread(helix), self.string.tributary
            wanted = np.maximum(0.0, wall - profile.side_force * length)[-added.size :]
            if np.abs(wanted - added).max() <= SETTLED * max(1.0, float(np.abs(wanted).max())):
                return profile._replace(side_force=np.maximum(profile.side_force, wall / length))
            added = wanted
            self._press(added, state)
            self._place(state)
        raise StoppedEarly(Status.NO_EQUILIBRIUM, 0.0, "the helix", f"bit at {self.depth:g} m")

    def _press(self, wall: np.ndarray, state: State) -> None:
        """Friction of so much more wall force (k,) N at the contacts, along the hole and about its axis."""
        size = self.rows.factor * wall
        self.string.press(size * self.rows.along, size * self.rows.around * self.radius, state.full_q)

    def _place(self, state: State) -> None:
        """Equilibrium with the bit at its depth: the block gives way by what the bit is off."""
        for _ in range(PLACINGS):
            try:
                find_equilibrium(self.system, state, self.model.step_limit, self._balance())
            except StoppedEarly as stop:
                # Whoever asks for statics gives no positions that could be nearer.
                cure, detail = NO_BALANCE[isinstance(self.string, SlidingLumps)], stop.detail
                detail = detail.replace(TOO_FAR, cure).replace(UNSETTLED, cure)
                raise StoppedEarly(stop.status, stop.time, stop.part, detail) from None
            off = self.string.bit_depth(state.full_q) - self.depth
            if abs(off) < AT_DEPTH:
                self._check(state)
                return
            self._shift(state, off)

    def _balance(self) -> float:
        """Residual over its scale that counts as balance: a force below what a brace jumps by is none."""
        return max(BALANCE, 2.0 * self.string.jump / float(self.system.scale.max()))

    def _shift(self, state: State, up: float) -> None:
        """Move block and string up the hole as a whole, so that the next search is a short one."""
        self.system.dofs.offset[self.block] -= up
        self.string.shift(state, up)

    def _check(self, state: State) -> None:
        """Refuse a string that is folded up: its links reach along the hole as far as they are long and stretched."""
        seen = self._seen(state)
        stiffness = np.array([tube.youngs_modulus * tube.area for tube in self.pipes])
        lacking = 1.0 + seen["tension"] / stiffness - np.diff(seen["measured_depth"]) / self.lumps.length
        if np.abs(lacking).max() > FOLDED:
            at = float(self.lumps.measured_depth[int(np.abs(lacking).argmax())])
            raise StoppedEarly(Status.NO_EQUILIBRIUM, 0.0, f"the string at {at:.0f} m")

    def _seen(self, state: State) -> dict[str, np.ndarray]:
        frames = new_frames(1, self.system.q.size, self.model.own)
        frames.q[0], frames.residual[0] = state.full_q, state.residual
        return {name: values[0] for name, values in self.model.observe(frames).items()}

    def _profile(self, state: State) -> Profile:
        seen = self._seen(state)
        q, md = state.full_q, seen["measured_depth"]
        return Profile(
            float(seen["hook_load"]), float(seen["surface_torque"]), float(seen["block_position"]),
            self.string.measured_depth(q), self.string.wall_force(q) / self.string.tributary,
            0.5 * (md[1:] + md[:-1]), seen["tension"], seen["torque"],
        )  # fmt: skip


def _kind_of(scene: DrillstringScene) -> Any:
    """What makes a string that slides, by the kind of its model."""
    if scene.model.kind == BEAM:
        # Only a scene of a beam needs a beam's code.
        from drillstring.statics.sliding_beam import SlidingBeam

        return SlidingBeam
    return SlidingLumps
