"""A mooring buoy on three springs: an application of one file, with defaults for every verb."""

from typing import Annotated

import numpy as np
from pydantic import Field

from tautline.application.defaults import Defaults
from tautline.application.limits import with_limits
from tautline.application.modelling import attributes_of, energies_of, energy_variables, settings_of
from tautline.elements.nodal.node import Anchors, PointMasses
from tautline.results.variable import Variable
from tautline.scene.limits import Limits
from tautline.scene.model import Model as Part
from tautline.scene.model import Scene
from tautline.scene.solver import Output, Solver, check_output
from tautline.scene.values.quantity import quantity
from tautline.scene.vector import Gravity
from tautline.system.model import Model
from tautline.system.system import Degrees, assemble
from tautline.system.time_functions import compile_functions

TEMPLATE = """# A buoy on springs.
buoy: {mass: 2 t, stiffness: 8 kN/m, damping: 100, displaced: 0.5 m}
solver: {method: generalized-alpha, rho_inf: 0.9, step: 10 ms, end: 20 s}
output: {interval: 50 ms}
"""


class Buoy(Part):
    """Mass kg, stiffness N/m and damping N s/m along each axis, and displacement along x at the start, m."""

    mass: Annotated[float, quantity("kg", positive=True, of="mass")]
    stiffness: Annotated[float, quantity("N/m", positive=True, of="spring stiffness")]
    damping: Annotated[float, quantity("N s/m", nonnegative=True, of="damping coefficient")] = 0.0
    displaced: Annotated[float, quantity("m", of="length")] = 0.0


class BuoyScene(Scene):
    """The whole file."""

    title: str | None = None
    buoy: Buoy = Field(examples=["{mass: 2 t, stiffness: 8 kN/m}"])
    gravity: Gravity = (0.0, 0.0, -9.81)
    solver: Solver
    output: Output
    limits: Limits = ()


class Buoys(Defaults):
    """Buoys on springs."""

    name = "buoy"
    title = "A buoy on springs."
    scene_type = BuoyScene
    template = TEMPLATE

    def build(self, scene):
        check_output(scene.solver, scene.output)
        buoy, solver = scene.buoy, scene.solver
        force = buoy.mass * 9.81 + buoy.stiffness
        degrees = Degrees([f"buoy: {c}" for c in "xyz"], np.array([buoy.displaced, 0.0, 0.0]), np.full(3, force))
        place = np.array([0])
        groups = (
            PointMasses(place, np.array([buoy.mass]), 0.0, np.array(scene.gravity)),
            Anchors(place, np.array([buoy.stiffness]), np.array([buoy.damping]), np.zeros((1, 3))),
        )
        stencil = [np.arange(3)[None, :]]
        system = assemble(groups, degrees, compile_functions([]), np.zeros(3), stencil, stencil)

        def observe(frames):
            seen = {"time": frames.time, "position": frames.q[:, None, :], "velocity": frames.v[:, None, :]}
            return seen | energies_of(frames)

        model = Model(
            system=system,
            solver=settings_of(solver, scene.output.interval, tolerance=1e-9, criterion="force"),
            variables=[
                Variable("position", ("time", "node", "axis"), "m", "position"),
                Variable("velocity", ("time", "node", "axis"), "m/s", "velocity"),
                *energy_variables("", " of weight", "damping", "of forces"),
            ],
            coordinates={},
            attributes=attributes_of(scene, "buoy", "z up"),
            observe=observe,
            headline=lambda result: {},
            start="as given",
        )
        return with_limits(model, scene)
