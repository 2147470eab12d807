"""Form finding: a string's shape at rest, and beside it the exact extensible rod where there is one.

The lumps come to rest by the static solver, or by dynamic relaxation: motion with damping in proportion to mass
(thesis, eq. 2.168) that stops by itself once the forces balance. Friction does not act in the first; in the second it
does, and what the string rests in then depends on where it began.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from drillstring.model.build import build
from drillstring.model.prepared import prepared, tubes_of, well_of
from drillstring.scene.scene import DrillstringScene
from drillstring.statics.rod import NoRod, Piece, Rod, bend, hang
from drillstring.string.fluid import fluid_of, weight_in
from drillstring.string.strength import extreme_tension
from drillstring.well.wellbore import Wellbore
from tautline.integrators.explicit_step import SAFE
from tautline.integrators.method import method_for
from tautline.integrators.state import new_state
from tautline.integrators.statics.equilibrium import find_equilibrium
from tautline.integrators.statics.relaxation import MOST_STEPS, relax
from tautline.integrators.statics.stability import count_negative
from tautline.integrators.status import Status, StoppedEarly
from tautline.integrators.stepping import stepping_with
from tautline.integrators.time_loop import new_frames
from tautline.integrators.vibration.critical_step import CriticalStep
from tautline.scene.methods import method_of

WAYS = ("static", "relaxation")
"""How a string is brought to rest."""
BALANCE = 1.0e-14
"""Residual of the static solver over the scale of forces: rounding decides. A string may weigh next to nothing."""
REST = 1.0e-10
"""Largest inertia force over the scale of forces that counts as rest in the relaxation, for the same reason."""
MOVE_TO_REST = ". Take --by relaxation: the string then moves to its rest, however far that is"
"""Cure where the static solver has found none."""
STRAIGHT = 1.0e-9
"""Angle, rad, by which a hole that counts as straight may turn, or one that counts as vertical lean."""


class Form(NamedTuple):
    """A string at rest; n + 1 lumps, or nodes of the beam, from the block down.

    Attributes
    ----------
    kind : str
        Of the model: ``lumped`` or ``ale-ancf``.
    elements : int
        Links, n.
    unstretched, measured_depth : (n + 1,) array
        Distance from the block in the unstretched string, and place along the hole, m.
    position : (n + 1, 3) array
        North, east, down, m.
    moved : (n + 1, 3) array
        From where the unstretched string lies on the hole's axis, m.
    tension : (n,) array
        Of the links, in their middles, N.
    tension_max : float
        Largest in the string, at the end of a link, N.
    hook_load, stretch : float
        N; by how much the links are longer than unstretched, m.
    offset : (n + 1,) array
        Distance from the hole's axis, m: the sag of a level string.
    touching : int
        Lumps that press on the wall.
    iterations : int
        Of the static solver, or steps of the relaxation.
    negative : int
        Negative pivots of the tangent: 0 for a stable shape, -1 where they prove nothing.
    """

    kind: str
    elements: int
    unstretched: np.ndarray
    measured_depth: np.ndarray
    position: np.ndarray
    moved: np.ndarray
    tension: np.ndarray
    tension_max: float
    hook_load: float
    stretch: float
    offset: np.ndarray
    touching: int
    iterations: int
    negative: int


class Reference(NamedTuple):
    """The exact rod of a scene, or why there is none.

    Attributes
    ----------
    rod : Rod or None
    said : str
        Which rod it is and how its ends are held; or the reason why there is none.
    top, along, across : (3,) array
        Where the block is, m, and unit vectors of the rod's x and y, north, east, down.
    """

    rod: Rod | None
    said: str
    top: np.ndarray
    along: np.ndarray
    across: np.ndarray

    def position(self, unstretched: np.ndarray) -> np.ndarray:
        """Where the points at unstretched distances (n,) m from the block are, (n, 3) m north, east, down."""
        assert self.rod is not None
        x, y = self.rod.locate(unstretched)
        return self.top + x[:, None] * self.along + y[:, None] * self.across


class Finding(NamedTuple):
    """What form finding found of a scene: forms in the order of their meshes asked for, and the rod beside them."""

    title: str
    by: str
    forms: tuple[Form, ...]
    reference: Reference

    @property
    def finest(self) -> Form:
        """The form of most lumps."""
        return max(self.forms, key=lambda one: one.elements)

    def difference(self, form: Form) -> np.ndarray | None:
        """Distance of each lump from the rod's point of the same material, (n + 1,) m; None where there is no rod."""
        if self.reference.rod is None:
            return None
        return np.linalg.norm(form.position - self.reference.position(form.unstretched), axis=1)


def find_form(
    scene: DrillstringScene,
    elements: Sequence[int] = (),
    by: str = "static",
    most: int = MOST_STEPS,
    kinds: Sequence[str] = (),
) -> Finding:
    """Bring a string to rest on several meshes, as one model or both.

    Parameters
    ----------
    scene : DrillstringScene
        With everything that drives it held as it is at t = 0.
    elements : sequence of int
        Numbers of links; that of the scene if empty.
    by : str
        ``static`` or ``relaxation``.
    most : int
        Steps of the relaxation after which a string that still moves is given up.
    kinds : sequence of str
        Kinds of model, ``lumped`` and ``ale-ancf``; that of the scene if empty.

    Returns
    -------
    Finding

    Raises
    ------
    SceneError
        For a number of elements that the string cannot have, and what the builder refuses.
    StoppedEarly
        Where the string does not come to rest; its sentence names the mesh.
    """
    forms = tuple(at_rest(one, by, most) for one in meshes(scene, elements, kinds))
    return Finding(scene.title or "", by, forms, reference_of(scene, forms[0]))


def at_rest(scene: DrillstringScene, by: str = "static", most: int = MOST_STEPS) -> Form:
    """Bring the string of a scene to rest; raises as `find_form` does."""
    model = build(scene)
    system, state = model.system, new_state(model.system)
    try:
        if by == "static":
            spent = find_equilibrium(system, state, model.step_limit, BALANCE).iterations
        else:
            method = method_for(system, model.solver)
            step = model.solver.step
            if model.solver.automatic and stepping_with(method).explicit:
                step = min(step, SAFE * CriticalStep(system, method_of(model.solver.method)).search(state, 0.0)[0])
            spent = relax(system, state, method, step, model.own, REST, most).steps
    except StoppedEarly as stop:
        way = (
            "Newton's method and the pseudo-transient steps after it failed"
            if by == "static"
            else "by dynamic relaxation"
        )
        raise NotAtRest(stop, scene.model.elements, way, MOVE_TO_REST if by == "static" else "") from None
    frames = new_frames(1, system.q.size, model.own)
    frames.q[0], frames.residual[0] = state.full_q, state.residual
    seen = {name: values[0] for name, values in model.observe(frames).items()}
    unstretched = np.asarray(model.coordinates["unstretched_depth"][1])
    ready = prepared(scene)
    well, lumps = ready.well, ready.lumps
    room = model.coordinates["clearance"][1] if "clearance" in model.coordinates else np.inf
    offset = np.hypot(*seen["lateral_displacement"].T)
    return Form(
        kind=scene.model.kind,
        elements=scene.model.elements,
        unstretched=unstretched,
        measured_depth=seen["measured_depth"],
        position=seen["position"],
        moved=seen["position"] - well.position(unstretched),
        tension=seen["tension"],
        tension_max=float(extreme_tension(scene, lumps, seen["hook_load"], seen["tension"]).max()),
        hook_load=float(seen["hook_load"]),
        stretch=lumps.stretch(seen["tension"]),
        offset=offset,
        touching=int((offset > room).sum()),
        iterations=int(spent),
        negative=count_negative(system, state).negative,
    )


class NotAtRest(StoppedEarly):
    """A string that did not come to rest; its sentence says on which mesh and how it was tried."""

    def __init__(self, stop: StoppedEarly, elements: int, way: str, cure: str = "") -> None:
        super().__init__(stop.status, stop.time, stop.part)
        cause = stop.sentence
        if stop.status == Status.NO_EQUILIBRIUM:
            cause = cause.replace("no static equilibrium was found to start from", "the string did not come to rest")
        self.sentence = f"{cause}; {elements} elements, {way}{cure}"
        self.args = (f"{stop.status.name}, {stop.part}: {self.sentence}",)


def reference_of(scene: DrillstringScene, form: Form) -> Reference:
    """The exact rod of a scene, where there is one; ``form`` says where the block is."""
    well = well_of(scene)
    _, _, along = (direction[0] for direction in well.frame(np.zeros(1)))
    inclination = float(well.inclination(np.zeros(1))[0])
    down = np.array([0.0, 0.0, 1.0])
    leaning = np.sin(inclination)
    across = (np.cos(inclination) * along - down) / leaning if leaning > STRAIGHT else np.zeros(3)
    rod, said = _rod_of(scene, well, inclination)
    return Reference(rod, said, form.position[0], along, across)


def pieces_of(scene: DrillstringScene, well_length: float) -> list[Piece]:
    """The string's sections as the rod takes them, with their weight in the mud."""
    fluid = fluid_of(scene.mud)
    return [
        Piece(
            tube.length,
            tube.youngs_modulus * tube.area,
            tube.youngs_modulus * tube.second_moment,
            weight_in(fluid, tube, scene.gravity),
        )
        for tube in tubes_of(scene, well_length)
    ]


def _rod_of(scene: DrillstringScene, well: Wellbore, inclination: float) -> tuple[Rod | None, str]:
    """The rod and what it is, or None and why there is none."""
    if float(np.hypot(well.k1, well.k2).max(initial=0.0)) * well.length > STRAIGHT:
        return None, "no exact rod: the hole is curved, and the rod is that of a straight one"
    force = scene.bit.load
    pieces = pieces_of(scene, well.length)
    if np.sin(inclination) <= STRAIGHT:
        if np.cos(inclination) < 0.0:
            return None, "no exact rod: the string stands upwards, and would fall over"
        rod = hang(pieces, force)
        doubt = ", though its lower part is in compression and may buckle" if force < 0.0 else ""
        return rod, f"exact: the string hangs straight down, in closed form{doubt}"
    if scene.well.wall is not None:
        return None, "no exact rod: the wall may carry the string, and the rod is that of free space (well.wall: none)"
    if scene.bit.lateral == "free":
        if force != 0.0:
            return (
                None,
                "no exact rod: with a free end the rod is known where it hangs, not where a force on the bit pulls",
            )
        return hang(pieces, inclination=inclination), "exact: the string hangs straight down from its pin, closed form"
    if scene.model.bending == "none":
        return None, "no exact rod: the string is without bending (model.bending: none), and the rod has it"
    try:
        rod = bend(pieces, inclination, force)
    except NoRod as reason:
        return None, f"no exact rod: {reason}"
    said = "exact extensible rod, pinned at the block, guided along the hole at its end"
    return rod, said + _doubt(rod, pieces)


def _doubt(rod: Rod, pieces: Sequence[Piece]) -> str:
    """Words where the rod is pressed beyond what a straight one bears: it then has more than one shape at rest."""
    pressed = -float(rod.tension(np.linspace(0.0, rod.length, 1001)).min())
    euler = np.pi**2 * min(piece.bending for piece in pieces) / rod.length**2
    if pressed <= euler:
        return ""
    return f"; pressed by {pressed:.3g} N, beyond Euler's {euler:.3g} N, it has other shapes too, which lumps may find"


def meshes(scene: DrillstringScene, elements: Sequence[int], kinds: Sequence[str]) -> list[DrillstringScene]:
    """The scene with each kind of model and number of elements; raises SceneError where it cannot have them."""
    if not elements and not kinds:
        return [scene]
    changes = [
        {("model", "kind"): (kind, "--model"), ("model", "elements"): (int(n), "--elements")}
        for kind in kinds or (scene.model.kind,)
        for n in elements or (scene.model.elements,)
    ]
    return [scene.with_values(change) for change in changes]
