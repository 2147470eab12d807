"""Strings for the tests: scenes made from the shipped ones or from a few numbers, and how to run and to balance them.

Compiling takes seconds for every set of group types, so the tests share a few sets: the J-well's, and that of a string
without mud and bending in a straight hole (`straight_hole`).
"""

from functools import cache
from pathlib import Path

import numpy as np
import yaml
from references import soft_string as soft

from drillstring.model.build import build
from drillstring.scene.scene import DrillstringScene
from tautline.integrators.state import new_state
from tautline.integrators.statics.equilibrium import find_equilibrium
from tautline.integrators.time_loop import new_frames
from tautline.scene.model import validate
from tautline.simulation import simulate

DATA = Path(__file__).parents[3] / "data"
JWELL, JSTRING = soft.jwell()
GRAVITY, DENSITY, E, G = 9.81, 7850.0, 200e9, 79e9
COLLAR = (0.165, 0.0572)


def shipped(name, **changes):
    """A scene of data/ with some keys changed: `shipped("jwell", solver__step=0.01)`."""
    scene = DrillstringScene.read(DATA / f"{name}.yaml")
    values = {tuple(key.split("__")): (value, key) for key, value in changes.items()}
    return validate(DrillstringScene, scene.document.replaced(values))


def straight_hole(inclination, length=100.0, elements=1, diameter=0.3, friction=0.0, **changes):
    """A collar without mud in a straight hole, azimuth 0 (radians, metres); other keys as in `shipped`."""
    scene = {
        "gravity": GRAVITY,
        "well": {
            "inclination": float(inclination),
            "sections": [{"hold": length}],
            "diameter": diameter,
            "wall": {"stiffness": 1e9, "damping": 2e6, "lumps": elements, "friction": friction},
        },
        "string": [{"name": "collar", "length": length, "od": COLLAR[0], "id": COLLAR[1]}],
        "material": {"youngs_modulus": E, "shear_modulus": G, "density": DENSITY},
        "model": {"kind": "lumped", "elements": elements, "bending": "none"},
        "solver": {"method": "generalized-alpha", "rho_inf": 0.8, "step": 1e-3, "end": 1.0},
        "output": {"interval": 0.01},
    }
    for key, value in changes.items():
        *path, last = key.split("__")
        place = scene
        for name in path:
            place = place.setdefault(name, {}) if isinstance(place, dict) else place[int(name)]
        place[last] = value
    return DrillstringScene.parse(yaml.safe_dump(scene))


# The soft string of the J-well is integrated in some tenths of a second, and many tests hold their own against it.
@cache
def soft_load(friction, direction):
    """Hook load of the J-well's soft string, N."""
    return soft.hook_load(JWELL, JSTRING, friction, direction)


@cache
def soft_torque(friction, climbing=True):
    """Torque of the J-well's soft string rotating off bottom, N m."""
    return soft.rotating_torque(JWELL, JSTRING, friction, climbing)


@cache
def soft_strokes(friction, hole=None):
    """Strokes of the block that move the J-well's soft string, up and down, m; with a hole's diameter its clearance."""
    return soft.strokes(JWELL, JSTRING, friction, hole=hole)


def area(od, bore):
    return np.pi / 4 * (od**2 - bore**2)


def mass_per_length(od=COLLAR[0], bore=COLLAR[1]):
    """Of steel, kg/m."""
    return DENSITY * area(od, bore)


def run(scene, energy=1e-3):
    """Run a scene in memory; nothing in the result may be other than finite, and its energy must balance to 0.1 %."""
    result = simulate(build(scene))
    for name in result.variables:
        values = result[name]
        assert values.dtype.kind not in "f" or np.isfinite(values).all(), name
    assert result.attributes["status"] == "done"
    assert result.attributes["energy_error"] < energy
    return result


class Balance:
    """A scene in static equilibrium at t = 0: `balance["tension"]` is the variable of the results without time."""

    def __init__(self, scene):
        self.model = build(scene)
        self.state = new_state(self.model.system)
        self.equilibrium = find_equilibrium(self.model.system, self.state, self.model.step_limit)
        frames = new_frames(1, self.model.system.q.size, self.model.own)
        frames.q[0], frames.residual[0] = self.state.full_q, self.state.residual
        self.values = {name: values[0] for name, values in self.model.observe(frames).items()}
        self.unstretched_depth = np.asarray(self.model.coordinates["unstretched_depth"][1])

    def __getitem__(self, name):
        return self.values[name]

    def rows(self, direction):
        """Numbers of the unknowns of one kind: along the hole, north side, east side, rotation."""
        return np.array([i for i, name in enumerate(self.model.system.names) if name.endswith(direction)])
