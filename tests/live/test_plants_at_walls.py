"""A plant of a string in a hole names what is about to leave or meet the wall, and nothing of what rests there."""

import warnings
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import tautline
from drillstring.groups.sticking import edge_of_the_wall
from tautline.live.plant.edges import what_is_near

DATA = Path(__file__).parents[2] / "data"
MASS, STIFFNESS, CLEARANCE, SMALL = 1000.0, 1.0e8, 0.05, 1.0e-5
WEIGHT = 9.81 * MASS


def named(force, rate=0.0, down=0.0, name=""):
    """How many lumps are named of one that is pressed in by a force, N, or clear by as much as a force would bring."""
    spring = SimpleNamespace(stiffness=STIFFNESS, damping=0.0, clearance=CLEARANCE)
    edge = edge_of_the_wall(0, spring, CLEARANCE + force / STIFFNESS, rate, down, name)
    told = what_is_near(_system(), _state(), lambda places: MASS, SMALL, [edge])
    return told


def slanted(inclination, elements):
    """A string at rest in a hole with a bend at its top, of few lumps."""
    scene = tautline.read(DATA / "tripping.yaml")
    hole = [{"hold": "100 m"}, {"build": {"radius": "1000 m", "to": f"{inclination} deg", "azimuth": "0 deg"}}]
    return scene.replace({"well.sections": [*hole, {"hold": "2800 m"}], "model.elements": elements})
