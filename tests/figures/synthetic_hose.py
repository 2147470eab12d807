"""A made-up hose with a wave running to its tip, for trying figures: keeps its length, obeys no other equation."""

import numpy as np

from tautline.results.store import Store
from tautline.results.variable import Variable

LENGTH = 0.5
UNITS = {
    "position": "m", "slope": "", "velocity": "m/s", "tip": "m", "tip_velocity": "m/s", "axial_force": "N",
    "curvature": "1/m", "flow_speed": "m/s",
}  # fmt: skip
ENERGIES = ("kinetic_energy", "strain_energy", "potential_energy", "dissipated_energy", "external_work")


def bent(time, elements, swing, frequency, sag, rate=None):
    """Position, slope and velocity at the nodes: the angle is sag and a travelling wave of a given swing (frames,)."""
    points = 20 * elements + 1
    s = np.linspace(0.0, 1.0, points)
    phase = 2 * np.pi * frequency * time[:, None] - 2.0 * s
    angle = -sag * s * (2 - s) + swing[:, None] * s * np.sin(phase)
    turning = swing[:, None] * s * 2 * np.pi * frequency * np.cos(phase)
    if rate is not None:
        turning += rate[:, None] * s * np.sin(phase)
    zero = 0 * angle
    slope = np.stack([np.cos(angle), zero, np.sin(angle)], axis=-1)
    speed = turning[..., None] * np.stack([-np.sin(angle), zero, np.cos(angle)], axis=-1)
    step = LENGTH / (points - 1)

    def along(values):
        return np.concatenate([0 * values[:, :1], np.cumsum(0.5 * step * (values[:, 1:] + values[:, :-1]), axis=1)], 1)

    return along(slope)[:, ::20], slope[:, ::20], along(speed)[:, ::20]


def result(
    path=None,
    frames=601,
    elements=10,
    speed=35.0,
    swing=1.0,
    frequency=6.3,
    growth=3.0,
    tilt=0.0,
    ramp=0.1,
    sag=0.15,
    start=0.0,
    energies=True,
):
    """A result of a hose whose swing, rad, grows as 1 - exp(-growth t); with `start`, it starts with that much more.

    `ramp` is the time that the flow takes to its speed; if it is the whole run, the swing begins at 12 m/s as a root.
    `tilt`, rad, turns all about the x axis.
    """
    time = 0.005 * np.arange(frames)
    flow = speed * np.clip(time / ramp, 0.0, 1.0) if ramp else np.full(frames, speed)
    size = swing * (1.0 - np.exp(-growth * time)) + start * np.exp(-growth * time)
    rate = (swing - start) * growth * np.exp(-growth * time)
    if frames > 1 and ramp >= time[-1]:
        size = swing * np.sqrt(np.clip(flow / 12.0 - 1.0, 0.0, None) + 1e-6)
        rate = np.gradient(size, time)
    position, slope, velocity = bent(time, elements, size, frequency, sag, rate)
    turn = np.array([[1, 0, 0], [0, np.cos(tilt), np.sin(tilt)], [0, -np.sin(tilt), np.cos(tilt)]])
    position, slope, velocity = (array @ turn for array in (position, slope, velocity))
    wave = np.sin(4 * np.pi * frequency * time)[:, None] * np.linspace(1.0, 0.0, elements)
    values = {
        "time": time,
        "position": position,
        "slope": slope,
        "velocity": velocity,
        "tip": position[:, -1],
        "tip_velocity": velocity[:, -1],
        "axial_force": 0.9 + 0.2 * size[:, None] * wave,
        "curvature": 2.0 * np.abs(wave),
        "flow_speed": flow,
    }
    if energies:
        values |= {name: (i + 1.0) * size**2 for i, name in enumerate(ENERGIES)}
    dims = {"position": ("node", "axis"), "slope": ("node", "axis"), "velocity": ("node", "axis")}
    dims |= {"tip": ("axis",), "tip_velocity": ("axis",), "axial_force": ("element",), "curvature": ("element",)}
    variables = [Variable(name, ("time", *dims.get(name, ())), UNITS.get(name, "J"), name) for name in values]
    coordinates = {
        "node": ("node", np.arange(1, elements + 2), "", "node, from the root on"),
        "element": ("element", np.arange(1, elements + 1), "", "element, from the root on"),
        "axis": ("axis", np.array(["x", "y", "z"]), "", "x, y, z"),
        "arc_length": ("node", np.linspace(0.0, LENGTH, elements + 1), "m", "unstretched length from the root"),
    }
    title = f"Garden hose, {speed:g} m/s"
    with Store(path, variables, coordinates, {"scene": "", "title": title, "application": "gardenhose"}) as store:
        store.append(values)
        return store.finish()
