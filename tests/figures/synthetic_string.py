"""A made-up drill string in a J-shaped well, for trying figures: looks right, obeys no equation."""

import numpy as np

from tautline.results.store import Store
from tautline.results.variable import Variable


def course(depth):
    """North, east, down at measured depths: vertical to 2200 m, then a quarter circle of 1000 m radius."""
    angle = np.clip(depth - 2200.0, 0.0, None) / 1000.0
    down = np.minimum(depth, 2200.0) + 1000.0 * np.sin(angle)
    north = 1000.0 * (1.0 - np.cos(angle))
    return np.stack([north, np.zeros_like(north), down], axis=-1)


def result(path=None, frames=800, bodies=13, turning=False, vertical=False, lag=1.0, energies=True, drilling=False):
    time = 0.05 * np.arange(frames)
    block = np.sin(2 * np.pi * (time - 5) / 20 + (time - 5) ** 2 / 400)
    block -= block[0]
    bit, bits = 0.0, []
    for position in block:
        bit = np.clip(bit, position - 0.5 * lag, position + 0.5 * lag) if bits else 0.0
        bits.append(bit)
    bits = np.array(bits)
    rest = np.linspace(3770.0 / bodies, 3770.0, bodies) if bodies > 1 else np.array([3770.0])
    share = rest / 3770.0
    depth = rest + np.outer(block, 1 - share) + np.outer(bits, share)
    speed = np.gradient(bits, time) if frames > 1 else np.zeros(1)
    pull = np.clip(bits - block, -0.5, 0.5)
    tension = 9e5 * (1 - share) - 5e4 + np.outer(pull, 2e5 * share[::-1])
    contact = np.where(rest > 2200, 4e4, 0.0) * (1 + 0.2 * np.outer(pull, np.ones(bodies)))
    torque = np.outer(np.minimum(time, 8.0), 1.5e3 * (1.05 - share)) if turning else np.zeros_like(tension)
    straight = np.stack([0 * depth, 0 * depth, depth], axis=-1)
    values = {"time": time, "measured_depth": depth, "position": straight if vertical else course(depth)}
    values |= {"tension": tension, "torque": torque, "contact_force": contact, "hook_load": tension[:, 0] + 1e5}
    values |= {"block_position": block, "bit_speed": speed, "surface_torque": torque[:, 0]}
    if energies:
        kinetic, strain = 3e4 * np.gradient(block, 0.05) ** 2 if frames > 1 else np.zeros(1), 4e5 * pull**2
        potential, dissipated = -4e5 * block, 6e4 * time
        work = kinetic + strain + potential + dissipated + 300 * np.sin(time)
        names = ("kinetic_energy", "strain_energy", "potential_energy", "dissipated_energy", "external_work")
        values |= dict(zip(names, (kinetic, strain, potential, dissipated, work), strict=True))
    if drilling:
        # The bit stands for a third of every five seconds, and else turns at up to 24 rad/s; the drive at 12.
        spin = np.clip(24.0 * np.sin(2 * np.pi * time / 5.0) + 8.0, 0.0, None)
        values["rotation_rate"] = np.outer(np.full(frames, 12.0), 1 - share) + np.outer(spin, share)
        values["rotation"] = np.cumsum(values["rotation_rate"], axis=0) * 0.05 + 20.0 * (1 - share)
        values |= {"weight_on_bit": 1e5 + 2e3 * np.sin(time), "torque_on_bit": 4e3 + 2e3 * np.exp(-spin / 6.0)}
        values |= {"rate_of_penetration": 5e-4 * spin, "hole_depth": 3770.0 + 5e-3 * time}
    # Lumps go around in the hole, the deeper the wider; the pipe is 0.1 m thick, its lower half 0.15 m, in 0.2 m.
    wide, turn = 0.02 * share, 2 * np.pi * time / 8.0
    values["lateral_displacement"] = np.stack([np.outer(np.cos(turn), wide), np.outer(np.sin(turn), wide)], axis=-1)
    if turning:
        # Half as fast again as the lumps go around: a forward whirl of two thirds.
        values["rotation_rate"] = np.full_like(depth, 2 * np.pi / 8.0 * 1.5)
        side, along = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
        swing = (
            2
            * np.pi
            / 8.0
            * np.stack([-values["lateral_displacement"][..., 1], values["lateral_displacement"][..., 0]], axis=-1)
        )
        values["velocity"] = swing[..., :1] * side + swing[..., 1:] * np.cross(along, side)
    axes = {
        "lateral_displacement": ("body", "side"),
        "position": ("body", "axis"),
        "tension": ("link",),
        "torque": ("link",),
    }
    axes |= {name: ("body",) for name in ("measured_depth", "contact_force", "rotation", "rotation_rate")}
    axes |= {"velocity": ("body", "axis")}
    units = {"hook_load": "N", "tension": "N", "contact_force": "N", "torque": "N m"}
    variables = [
        Variable(name, ("time", *axes.get(name, ())), units.get(name, "m"), name.replace("_", " ")) for name in values
    ]
    depths = np.linspace(0.0, 3780.0, 200)
    well = np.stack([0 * depths, 0 * depths, depths], axis=-1) if vertical else course(depths)
    coordinates = {"well_position": (("station", "axis"), well, "m", "course of the well")}
    if bodies > 1:
        outer = np.where(rest[1:] < 1900.0, 0.1, 0.15)
        coordinates["outer_diameter"] = ("joint", outer, "m", "outer diameter of the string")
        # A lump is half of the pipe above it and half of that below: the thicker one meets the wall.
        thicker = np.maximum(np.r_[outer[:1], outer], np.r_[outer, outer[-1:]])
        coordinates["clearance"] = ("body", 0.5 * (0.2 - thicker), "m", "room of the lump's axis")
        coordinates["hole_diameter"] = ("station", np.full(200, 0.2), "m", "diameter of the hole")
        coordinates["well_depth"] = ("station", depths, "m", "measured depth of the well path")
        if turning:
            # The frame of a straight hole, whatever the course: what goes around in it is what is looked at.
            along = np.tile([0.0, 0.0, 1.0], (200, 1))
            coordinates["well_direction"] = (("station", "axis"), along, "", "unit vector down the hole")
            coordinates["well_side"] = (("station", "axis"), along[:, [2, 0, 1]], "", "unit vector m1")
    described = {"scene": "title: J-well", "title": "J-well under heave", "application": "drillstring"}
    with Store(path, variables, coordinates, described) as store:
        store.append(values)
        return store.finish()
