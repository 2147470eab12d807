"""Records of a hoist in waves, made by the simulation, a load that hangs still, and twins that are fed with rows."""

import functools

import numpy as np
import yaml

import tautline
from tautline.twin.map.file import read_map
from tautline.twin.record import Sensing, record
from tautline.twin.twin import Twin

HOIST = "data/hoist.yaml"
RATE = 5.0
"""Rows a second: a row costs a twin much more than the steps to it, and a window of 3 s has 16 of them."""
SENSORS = """
sensors:
  - {column: winch_pos, unit: m, input: winch.pay_out}
  - {column: heave, unit: cm, input: vessel.heave}
  - {column: rope_tension, unit: kN, output: winch.tension, sd: 1 %}
"""
WEIGHT = (
    SENSORS
    + """
estimate:
  - {parameter: payload.mass, start: START, sd: 4 t, range: [0.5 t, 20 t], drift: 1 kg/s^0.5}
watch:
  - {output: winch.tension, above: 80 kN, ahead: 2 s, name: overload}
  - {output: min_tension, below: 1 kN, ahead: 2 s, name: slack rope ahead}
  - {residual: winch.tension, above: 4 sd, for: 1 s, name: irregular}
keep: [payload.position]
"""
)

STILL = """
rope: {mass_per_length: 6.5, axial_stiffness: 8.0e7, bending_stiffness: 0, damping: 1.0e-4, diameter: 36 mm}
bodies: [{name: payload, mass: 5 t, position: [0.5, 0, -20]}]
path:
  - drum: {name: winch, center: [0, 0, 0], radius: 0.5, axis: [0, 1, 0], wrap: over, pay_out: {constant: 0}}
  - end: {name: hook, body: payload}
mesh: {elements_per_span: 2}
gravity: [0, 0, -9.81]
start: static
solver: {method: generalized-alpha, rho_inf: 0.6, step: 5 ms, end: 60 s}
output: {interval: 50 ms}
"""
"""A load that hangs still from a winch, which rows are to move."""


def hoist(pay_out, *, law=None, start_height=None, ground=None, heave=0.5, mass=5000.0, end=60.0):
    """The shipped hoist with another motion of the winch, as a dict."""
    root = yaml.safe_load(open(HOIST))
    root["rope"]["axial_stiffness"], root["rope"]["damping"] = 8e7, 1e-4
    root["bodies"][0]["mass"] = mass
    root["path"][0]["drum"]["pay_out"] = {"table": pay_out}
    root["vessel"]["motion"]["heave"]["harmonic"]["amplitude"] = heave
    # Frames come as often as rows at the most: between two of them a simulation has nothing to do but its steps.
    root["solver"] |= {"step": 10e-3, "end": end}
    root["output"]["interval"] = 0.1
    if law is not None:
        sheave = root["path"][1]["sheave"]
        sheave["law"] = law
        for key in ("bearing", "inertia"):
            sheave.pop(key, None)
    if start_height is not None:
        root["bodies"][0]["position"] = [12.4, 0, start_height]
    if ground is not None:
        root["ground"] = {"level": ground, "stiffness": 2e6, "damping": 2e5}
        root["bodies"][0]["bottom"] = 0.5
    return root


@functools.cache
def calm_rows(end=22.0, seed=0):
    """Rows of a load that hangs in waves after a short hoist: (stamp, readings)."""
    scene = tautline.read(hoist({"time": [0, 1, 2, 3, 100], "value": [0, -0.5, -0.5, 0, 0]}))
    return tuple(record(scene, read_map(SENSORS), Sensing(noise=0.01, seed=seed, rate=RATE), end))


NOT_AHEAD = WEIGHT.replace("ahead: 2 s,", "") + "ahead: 0 s\n"
CALM = {"time": [0, 1, 2, 3, 100], "value": [0, -0.5, -0.5, 0, 0]}


def rows_of(scene, seed=0, end=None, map=SENSORS, **sensing):
    """Rows of a scene with 1 % noise, `RATE` of them a second if nothing else is said."""
    scene = scene if hasattr(scene, "document") else tautline.read(scene)
    return list(record(scene, read_map(map), Sensing(**{"noise": 0.01, "seed": seed, "rate": RATE} | sensing), end))


def lines_of(twin, rows, ahead_from=-np.inf):
    """All lines that a twin has to say of rows; what is ahead it looks at from a time on, as one that is busy does."""
    lines = []
    for stamp, readings in rows:
        lines += twin.add(stamp, readings)
        if stamp >= ahead_from:
            twin.work()
    return lines + twin.finish()


def lines_until(name, twin, rows):
    """Lines up to the first with an alarm of that name: those after it say no more about when it was raised."""
    lines = []
    for stamp, readings in rows:
        lines += twin.add(stamp, readings)
        twin.work()
        if name in alarms(lines[-1:]):
            return lines
    return lines + twin.finish()


def weight_twin(scene=None, start="10 t", map=NOT_AHEAD):
    """A twin that looks for the weight of the load."""
    return Twin(hoist(CALM) if scene is None else scene, map.replace("START", start))


def at(lines, time):
    """The line of a time."""
    return min(lines, key=lambda line: abs(line["time"] - time))


def alarms(lines):
    """Name of an alarm -> the time at which it was raised first."""
    found = {}
    for line in lines:
        for one in line["alarms"]:
            found.setdefault(one["name"], line["time"])
    return found


def changed(rows, change):
    """Rows with other readings: ``change(stamp, readings)`` gives the new ones, or None to leave the row out."""
    return [(stamp, new) for stamp, old in rows if (new := change(stamp, dict(old))) is not None]


def finite(lines):
    """Whether there is no NaN anywhere: JSON has none."""
    return np.isfinite([line["estimates"]["payload.mass"]["sd"] for line in lines]).all()
