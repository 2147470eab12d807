"""A cable scene in the syntax of the thesis' Appendix A is read as meant, or refused with line, key and cure."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tautline.application.installed import Installed
from tautline.cable.application import Cable
from tautline.cable.input.geometry import Drawn, arc_lengths, unstretched_lengths
from tautline.cable.input.material import material_coordinates
from tautline.cable.input.scene import json_schema, parse, read, with_values
from tautline.cli.run import run
from tautline.cli.verbs import make_app
from tautline.scene.errors import SceneError
from tautline.scene.reading.document import Document

DATA = Path(__file__).parents[2] / "data"
APPENDIX = Path(__file__).with_name("appendix_a.yaml").read_text()
BAR = (DATA / "cantilever_bar.yaml").read_text()
TEXT = (DATA / "reeled_span.yaml").read_text()

NODE1, NODE2 = "id: 1, xyz: [0.5, 0, 0], xyz_d: [1, 0, 0]", "id: 2, xyz: [1.0, 0, 0], xyz_d: [1, 0, 0]"
CABLE0 = "{id: 0, nodes7: [0, 1], EA: 1000.0, EJ: 0.0"
MASS = "  - PointMass: {id: 0, nodes7: [2], mass: 0.5}\n"
LINEAR = (
    "  - Node4Dof: {id: 8, xyz: [0, 0, 1], BC: [1, 1, 1, 1]}\n"
    "  - Node4Dof: {id: 9, xyz: [1, 0, 1], BC: [0, 0, 0, 1]}\n"
    "  - CableALEelementLin: {id: 9, nodes4: [8, 9], EA: 1000.0, rhoA: 1.0}\n"
)
COUPLED = "  - LinearCoupl: {id: 1, sNode: 3, sDof: 1, f0: 0, masters: [{mNode: 2, mDof: 1, factor: 1}]}\n"
END = "  skipVTK: True"


def added(*items):
    """An edit that adds items after the point mass; the first of them stands in line 22."""
    return MASS, MASS + "".join(item if item.startswith("  - ") else f"  - {item}\n" for item in items)


# what is replaced, by what, the line, the key, words of the message
EDITS = {
    # nodes
    "two nodes of one id": (NODE1, NODE1.replace("1,", "0,", 1), 8, "[1].Node7Dof.id = 0", "such as 5"),
    "a linear node of a cubic one's id": (*added("Node4Dof: {id: 1, xyz: [9, 9, 9]}"), 22, "Node4Dof.id", "line 8"),
    "a negative id": (NODE1, NODE1.replace("id: 1", "id: -1"), 8, "[1].Node7Dof.id = -1", "must not be negative"),
    "an id of one and a half": (NODE1, NODE1.replace("id: 1", "id: 1.5"), 8, "Node7Dof.id = 1.5", "a whole number"),
    "a node without a place": ("xyz: [0.5, 0, 0], ", "", 8, "[1].Node7Dof.xyz", "add `xyz:`, such as [0.5, 0, 0]"),
    "a place in a plane": ("[0.5, 0, 0]", "[0.5, 0]", 8, "Node7Dof.xyz", "three numbers: x, y and z"),
    "a place in kilogrammes": ("[0.5, 0, 0]", "[0.5 kg, 0, 0]", 8, "Node7Dof.xyz[0] = 0.5 kg", "a length"),
    "a place that is no number": ("[0.5, 0, 0]", "[.nan, 0, 0]", 8, "Node7Dof.xyz[0] = .nan", "finite"),
    "a place at infinity": ("[0.5, 0, 0]", "[1e999, 0, 0]", 8, "Node7Dof.xyz[0] = 1e999", "finite"),
    "a place beyond the moon": ("[1.5, 0, 0]", "[1.5e12, 0, 0]", 15, "CableALEelement.nodes7", "positions in m"),
    "a slope of nothing": (NODE1, NODE1.replace("[1, 0, 0]", "[0, 0, 0]"), 8, "Node7Dof.xyz_d", "has no direction"),
    "a slope of a thousand": (NODE1, NODE1.replace("[1, 0, 0]", "[2e3, 0, 0]"), 8, "xyz_d", "2e+03 long"),
    "slopes too long for any length": (
        f"{NODE1}, BC: [0, 0, 0, 0, 0, 0, 1]}}\n  - Node7Dof: {{{NODE2}",
        f"{NODE1.replace('[1, 0, 0]', '[0, 30, 0]')}, BC: [0, 0, 0, 0, 0, 0, 1]}}\n"
        f"  - Node7Dof: {{{NODE2.replace('[1, 0, 0]', '[0, 30, 0]')}",
        13,
        "[5].CableALEelement.nodes7",
        "give xyz_d as unit vectors",
    ),
    "a BC of six": ("BC: [0, 0, 0, 0, 0, 0, 1]}", "BC: [0, 0, 0, 0, 0, 1]}", 8, "Node7Dof.BC", "has 6 entries, not 7"),
    "a BC of two": ("BC: [1, 1, 1, 0, 0, 0, 1]}", "BC: [1, 1, 1, 0, 0, 0, 2]}", 7, "BC[6] = 2", "neither 0 nor 1"),
    "a BC of a half": ("BC: [1, 1, 1, 0, 0, 0, 1]}", "BC: [0.5, 1, 1, 0, 0, 0, 1]}", 7, "BC[0]", "neither 0 nor 1"),
    "a BC of a word": ("BC: [1, 1, 1, 0, 0, 0, 1]}", "BC: held}", 7, "[0].Node7Dof.BC = held", "is not a list"),
    "seven BC for four": (
        *added("Node4Dof: {id: 8, xyz: [0, 0, 1], BC: [1, 1, 1, 0, 0, 0, 1]}"),
        22,
        "Node4Dof.BC",
        "rx ry rz p",
    ),
    "a function that is not there": ("0, 0, 1]}\n  - CableALE", "0, 0, 7]}\n  - CableALE", 12, "[6] = 7", "known: 1"),
    "a function where BC leaves free": (
        "BC_functions: [0, 0, 0, 0, 0, 0, 1]",
        "BC_functions: [0, 0, 0, 1, 0, 0, 1]",
        12,
        "[4].Node7Dof.BC_functions[3] = 1",
        "set BC to 1 there (entry 4)",
    ),
    "six functions": ("BC_functions: [0, ", "BC_functions: [", 12, "Node7Dof.BC_functions", "has 6 entries, not 7"),
    "a p that its function contradicts": (
        "BC: [1, 1, 1, 0, 0, 0, 1],\n",
        "BC: [1, 1, 1, 0, 0, 0, 1], p: 2,\n",
        11,
        "[4].Node7Dof.p = 2",
        "begins at 1.5 m",
    ),
    "a node that nothing joins": (*added("Node7Dof: {id: 9, xyz: [0, 0, 0]}"), 22, "Node7Dof.BC", "hold them with 1"),
    "no nodes": (
        re.search(r"(?s)CableModel:\n.*?(?=\nGeneral)", TEXT)[0],
        "CableModel:\n  - PointMass: {id: 0, nodes7: [0], mass: 1}\n",
        6,
        "CableModel",
        "has no nodes; add `- Node7Dof",
    ),
    "an empty model": (
        re.search(r"(?s)CableModel:\n.*?(?=\nGeneral)", TEXT)[0],
        "CableModel: []\n",
        6,
        "CableModel",
        "is an empty list",
    ),
    "a model that is a mapping": ("CableModel:\n", "CableModel: {a: 1}\nCableModels:\n", 6, "CableModel", "not a list"),
    "no elements": (re.search(r"(?s)  - CableALE.*(?=  - Lag)", TEXT)[0], "", 6, "CableModel", "has no cable elements"),
    # elements
    "an element of a node that is not there": ("nodes7: [3, 4]", "nodes7: [3, 9]", 15, "nodes7[1] = 9", "0 to 4"),
    "an element from a node to itself": ("nodes7: [3, 4]", "nodes7: [4, 4]", 15, "nodes7", "joins node 4 to itself"),
    "an element of three nodes": ("nodes7: [0, 1]", "nodes7: [0, 1, 2]", 13, "nodes7", "has 3 entries, not 2"),
    "an element of one node": ("nodes7: [0, 1]", "nodes7: [0]", 13, "nodes7", "has 1 entry, not 2"),
    "an element without nodes": ("nodes7: [0, 1], EA", "EA", 13, "CableALEelement.nodes7", "such as [0, 1]"),
    "a cubic element of a linear node": (
        *added(*LINEAR.splitlines(True), "CableALEelement: {id: 7, nodes7: [4, 8], EA: 1, rhoA: 1}"),
        25,
        "CableALEelement.nodes7[1] = 8",
        "use a CableALEelementLin",
    ),
    "a linear element of cubic nodes": (
        *added("CableALEelementLin: {id: 7, nodes4: [0, 1], EA: 1, rhoA: 1}"),
        22,
        "CableALEelementLin.nodes4[0] = 0",
        "use a CableALEelement with nodes7",
    ),
    "an element of no length": ("xyz: [0.5, 0, 0]", "xyz: [0.0, 0, 0]", 13, "nodes7", "give both a `p:`"),
    "two elements of one id": ("{id: 1, nodes7: [1, 2]", "{id: 0, nodes7: [1, 2]", 14, "id = 0", "such as 3"),
    "a linear element of a cubic one's id": (*added(LINEAR.replace("{id: 9, n", "{id: 2, n")), 24, "id = 2", "line 15"),
    "a negative EA": ("EA: 1000.0, EJ: 0.0", "EA: -1, EJ: 0.0", 13, "CableALEelement.EA = -1", "must not be negative"),
    "a negative rhoA": ("rhoA: 1.0", "rhoA: -1.0", 13, "CableALEelement.rhoA = -1.0", "must not be negative"),
    "a negative EJ": ("EJ: 0.0", "EJ: -1.0", 13, "CableALEelement.EJ = -1.0", "must not be negative"),
    "a negative damping": ("cDamp: 0.001", "cDamp: -0.001", 13, "CableALEelement.cDamp", "must not be negative"),
    "an EA nowhere": ("EA: 1000.0, EJ", "EJ", 13, "CableALEelement.EA", "or CableStiffness to CableModelMaterial"),
    "a rhoA nowhere": (", rhoA: 1.0", "", 13, "CableALEelement.rhoA", "or CableMass to CableModelMaterial"),
    "bending of a linear element": (
        *added(LINEAR.replace("rhoA: 1.0", "rhoA: 1.0, EJ: 2")),
        24,
        "CableALEelementLin.EJ = 2",
        "set EJ to 0",
    ),
    "a quadrature of a linear element": (
        *added(LINEAR.replace("rhoA: 1.0", "rhoA: 1.0, quadrature: gauss")),
        24,
        "quadrature",
        "unknown key",
    ),
    "an unknown strain": (CABLE0, CABLE0 + ", strain: gren", 13, "strain = gren", "did you mean 'green'"),
    "a compression of no": (CABLE0, CABLE0 + ", compression: no", 13, "compression = no", "true or false"),
    "an unknown quadrature": (CABLE0, CABLE0 + ", quadrature: lobato", 13, "quadrature", "did you mean 'lobatto'"),
    "a load of one number": (CABLE0, CABLE0 + ", load: 3", 13, "CableALEelement.load = 3", "is not a list"),
    "a misspelt element": ("CableALEelement: {id: 0", "CableALEelemnt: {id: 0", 13, "[5]", "did you mean"),
    "an unknown key of an element": ("cDamp: 0.001", "damp: 0.001", 13, "CableALEelement.damp", "did you mean 'cDamp'"),
    "an item of two kinds": (
        "{id: 0, nodes7: [2], mass: 0.5}",
        "{id: 0}\n    PointForce: {}",
        21,
        "[11]",
        "gives both",
    ),
    "an item that is a word": ("  - PointMass: {id: 0, nodes7: [2], mass: 0.5}", "  - mass", 21, "[11]", "give a part"),
    # material coordinates
    "p alike at both ends": (
        (f"{NODE1}, BC: [0, 0, 0, 0, 0, 0, 1]}}\n  - Node7Dof: {{{NODE2}"),
        (f"{NODE1}, p: 2, BC: [0, 0, 0, 0, 0, 0, 1]}}\n  - Node7Dof: {{{NODE2}, p: 2"),
        14,
        "[6].CableALEelement.nodes7",
        "p goes from 2 m at node 1 to 2 m at node 2: it must grow; swap the element's nodes",
    ),
    # ties and couplings
    "a tie of a node to itself": ("[2, 3], constr: 0", "[3, 3], constr: 0", 16, "nodes7", "ties node 3 to itself"),
    "a tie to nothing": ("[2, 3], constr: 0", "[2, 8], constr: 0", 16, "LagMultipl7.nodes7[1] = 8", "known: 0 to 4"),
    "a constraint of no kind": ("constr: 2", "constr: 3", 17, "LagMultipl7.constr = 3", "2 (r' = r')"),
    "a tie without a constraint": (", constr: 2", "", 17, "LagMultipl7.constr", "add `constr:`"),
    "two ties of one id": ("{id: 2, nodes7: [2, 3]", "{id: 1, nodes7: [2, 3]", 17, "LagMultipl7.id = 1", "line 16"),
    "a linear tie of cubic nodes": (
        *added("Penalty4: {id: 2, nodes4: [2, 3], constr: 0}"),
        22,
        "Penalty4.nodes4[0] = 2",
        "use Penalty7 with nodes7",
    ),
    "a penalty of nothing": (
        *added("Penalty7: {id: 2, nodes7: [2, 3], constr: 0, p_spring: 0}"),
        22,
        "Penalty7.p_spring = 0",
        "greater than zero",
    ),
    "an offset between slopes": ("constr: 2", "constr: 2, offset: [0, 0, 1]", 17, "offset", "positions only"),
    "a slave that is held": (
        *added(COUPLED.replace("sNode: 3, sDof: 1", "sNode: 4, sDof: 3")),
        22,
        "LinearCoupl.sDof = 3",
        "set its BC to 0 there (entry 3)",
    ),
    "a coupling that does not hold": (
        *added(COUPLED.replace("f0: 0", "f0: 0.1")),
        22,
        "LinearCoupl",
        "the slave begins at 1, its masters put it at 1.1; let them begin alike, or give f0: 0",
    ),
    "a slave twice": (*added(COUPLED, COUPLED.replace("id: 1", "id: 2")), 23, "LinearCoupl.sDof", "in line 22 already"),
    "a degree of freedom of none": (*added(COUPLED.replace("sDof: 1", "sDof: 8")), 22, "sDof = 8", "at most 7"),
    "a degree of freedom zero": (
        *added(COUPLED.replace("mDof: 1", "mDof: 0")),
        22,
        "masters[0].mDof = 0",
        "at least 1",
    ),
    "a degree of freedom that a linear node lacks": (
        *added(LINEAR, COUPLED.replace("sNode: 3, sDof: 1", "sNode: 9, sDof: 5")),
        25,
        "LinearCoupl.sDof = 5",
        "give 1 to 4: rx ry rz p",
    ),
    "a master that is not there": (*added(COUPLED.replace("mNode: 2", "mNode: 6")), 22, "mNode = 6", "known: 0 to 4"),
    "a factor of zero": (*added(COUPLED.replace("factor: 1", "factor: 0")), 22, "factor = 0", "another factor"),
    "no masters": (*added("LinearCoupl: {id: 1, sNode: 3, sDof: 1, masters: []}"), 22, "masters", "an empty list"),
    "a slave of itself": (*added(COUPLED.replace("mNode: 2", "mNode: 3")), 22, "masters", "follows itself"),
    "a ring of slaves": (
        *added(COUPLED, "LinearCoupl: {id: 2, sNode: 2, sDof: 1, masters: [{mNode: 3, mDof: 1}]}"),
        22,
        "LinearCoupl.masters",
        "3:1 -> 2:1 -> 3:1",
    ),
    # forces, springs, masses
    "a force that ends before it begins": (
        *added("PointForce: {id: 0, nodes7: [2], force: [0, 0, 1], timeInterval: [1, 0]}"),
        22,
        "PointForce.timeInterval",
        "earlier time first",
    ),
    "a force that ends as it begins": (
        *added("PointForce: {id: 0, nodes7: [2], force: [0, 0, 1], timeInterval: [1, 1]}"),
        22,
        "PointForce.timeInterval",
        "ends as it begins; give a later time to end",
    ),
    "a force on a node that is not there": (
        *added("PointForce: {id: 0, nodes7: [7], force: [0, 0, 1]}"),
        22,
        "PointForce.nodes7[0] = 7",
        "known: 0 to 4",
    ),
    "a force on nothing": (*added("PointForce: {id: 0, force: [0, 0, 1]}"), 22, "nodes7", "is missing; add `nodes7:`"),
    "a force twice on a node": (
        *added("PointForce: {id: 0, nodes7: [2, 2], force: [0, 0, 1]}"),
        22,
        "nodes7",
        "names a node twice",
    ),
    "a force on cubic nodes called linear": (
        *added("PointForce: {id: 0, nodes4: [2], force: [0, 0, 1]}"),
        22,
        "PointForce.nodes4[0] = 2",
        "write nodes7",
    ),
    "a force of a single number": (*added("PointForce: {id: 0, nodes7: [2], force: 3}"), 22, "force = 3", "not a list"),
    "a spring without stiffness": ("stiffness: 100.0", "stiffness: 0", 20, "OneNodeSpring.stiffness = 0", "zero"),
    "a spring of negative stiffness": ("stiffness: 100.0", "stiffness: -1", 20, "stiffness = -1", "greater than zero"),
    "a damper that drives": ("damping: 0.02", "damping: -0.02", 20, "OneNodeSpring.damping", "must not be negative"),
    "a spring between three": (
        *added("TwoNodeSpring: {id: 1, nodes7: [0, 1, 2], stiffness: 1}"),
        22,
        "TwoNodeSpring.nodes7",
        "has 3 entries, not 2",
    ),
    "a spring of negative length": (
        *added("TwoNodeSpring: {id: 1, nodes7: [0, 1], stiffness: 1, length: -1}"),
        22,
        "TwoNodeSpring.length = -1",
        "must not be negative",
    ),
    "a mass of nothing": ("mass: 0.5", "mass: 0", 21, "PointMass.mass = 0", "greater than zero"),
    "a mass in metres": ("mass: 0.5", "mass: 5 m", 21, "PointMass.mass = 5 m", "a mass such as"),
    # motions
    "times that do not grow": ("[0, 0.5, 1.0, 3.0", "[0, 0.5, 0.5, 3.0", 25, "timeList[2] = 0.5", "increasing order"),
    "a velocity too few": ("velocityList: [0, ", "velocityList: [", 26, "velocityList", "a velocity for every time"),
    "a velocity that is no number": ("velocityList: [0, ", "velocityList: [.nan, ", 26, "velocityList[0]", "finite"),
    "function zero": (
        "      id: 1\n",
        "      id: 0\n",
        23,
        "Function_VelocityDefined.id = 0",
        "0 in BC_functions means",
    ),
    "two functions of one id": (*added("Function: {id: 1, value: 1.5}"), 24, "VelocityDefined.id = 1", "line 22"),
    "a function of no kind": (
        *added("Function: {id: 2, value: {rampe: {to: 1}}}"),
        22,
        "Function.value",
        "did you mean 'ramp'",
    ),
    "a function in radians": (
        *added("Function: {id: 2, value: {ramp: {to: 3 deg, over: 1}}}"),
        22,
        "Function.value.ramp.to = 3 deg",
        "a length such as",
    ),
    # material, plots, solver
    "gravity of one number": ("Gravity: [0.0, 0.0, -9.81]", "Gravity: 9.81", 4, "Gravity = 9.81", "[0, 0, -9.81]"),
    "no gravity": ("  Gravity: [0.0, 0.0, -9.81]", "  CableMass: 1", 3, "CableModelMaterial.Gravity", "[0, 0, -9.81]"),
    "an unknown material": ("  Gravity:", "  Cablemass: 1\n  Gravity:", 4, "Cablemass", "did you mean 'CableMass'"),
    "a plot of a cable that is not there": (
        END,
        f"{END}\nPlots: [{{SubPlot: [{{Cable: 5, what: N}}]}}]",
        38,
        "Plots[0].SubPlot[0].Cable = 5",
        "known: 0 to 2",
    ),
    "a plot of a node that is not there": (
        END,
        f"{END}\nPlots: [{{SubPlot: [{{Node: 5, DOF: 1, what: r}}]}}]",
        38,
        "Plots[0].SubPlot[0].Node = 5",
        "known: 0 to 4",
    ),
    "a plot of what a node lacks": (
        END,
        f"{END}\nPlots: [{{SubPlot: [{{Node: 1, DOF: 1, what: N}}]}}]",
        38,
        "Plots[0].SubPlot[0].what = N",
        "known: r, v, rp, p, pdot",
    ),
    "a plot without an axis": (END, f"{END}\nPlots: [{{SubPlot: [{{Node: 1, what: r}}]}}]", 38, "DOF", "1 for x"),
    "a plot along a fourth axis": (
        END,
        f"{END}\nPlots: [{{SubPlot: [{{Node: 1, DOF: 4, what: v}}]}}]",
        38,
        "Plots[0].SubPlot[0].DOF = 4",
        "give 1 for x",
    ),
    "a plot of nobody": (END, f"{END}\nPlots: [{{SubPlot: [{{DOF: 1, what: r}}]}}]", 38, "Cable", "`Node: 0`"),
    "an empty panel": (END, f"{END}\nPlots: [{{SubPlot: []}}]", 38, "Plots[0].SubPlot", "an empty list"),
    "an unknown integrator": ("type: G-alpha", "type: G-alfa", 29, "GeneralizedAlpha.type", "did you mean"),
    "a step of nothing": ("time_step: 0.005", "time_step: 0", 34, "GeneralizedAlpha.time_step = 0", "zero"),
    "no step": ("  time_step: 0.005\n", "", 28, "GeneralizedAlpha.time_step", "add `time_step:`, such as 0.001"),
    "an end of nothing": ("time_end: 10.0", "time_end: -1", 35, "GeneralizedAlpha.time_end = -1", "greater than zero"),
    "an end before the first step": ("time_end: 10.0", "time_end: 1 ms", 35, "time_end = 1 ms", "smaller time_step"),
    "more steps than anyone waits for": ("time_step: 0.005", "time_step: 1e-12", 34, "time_step", "a larger step"),
    "an error of nothing": ("eps_energy: 1.0e-8", "eps_energy: 0", 31, "eps_energy = 0", "greater than zero"),
    "no iterations": ("maxIter: 20", "maxIter: 0", 32, "GeneralizedAlpha.maxIter = 0", "at least 1"),
    "damping that drives": ("massDamp: 0.0", "massDamp: -0.1", 33, "massDamp = -0.1", "must not be negative"),
    "rho_inf beside alpha_f": (
        "rho_inf: 0.6 ",
        "rho_inf: 0.6\n  alpha_f: 0.1\n  alpha_m: 0 ",
        30,
        "rho_inf = 0.6",
        "keep rho_inf",
    ),
    "alpha_f alone": ("rho_inf: 0.6 ", "alpha_f: 0.1 ", 28, "GeneralizedAlpha.alpha_m", "add `alpha_m:`"),
    "rho_inf over one": ("rho_inf: 0.6 ", "rho_inf: 1.6 ", 30, "rho_inf = 1.6", "not be more than 1"),
    "an unknown start": (
        END,
        END + "\n  start: statical",
        38,
        "start = statical",
        "must be static, relaxed or as given",
    ),
    "error control without a tolerance": (END, END + "\n  control: error", 28, "tolerance", "such as 1.0e-5"),
    "three projections": (END, END + "\n  stabilise: 3", 38, "GeneralizedAlpha.stabilise = 3", "at most 2"),
    "an unknown projection": (END, END + "\n  projection: mas", 38, "projection = mas", "did you mean 'mass'"),
    "an unknown key of the solver": ("maxIter: 20", "maxIters: 20", 32, "maxIters", "did you mean 'maxIter'"),
    "a duplicate key": ("  maxIter: 20", "  maxIter: 20\n  maxIter: 30", 33, "GeneralizedAlpha.maxIter", "duplicate"),
    "an unknown part": ("GeneralizedAlpha:", "GeneralisedAlpha:", 28, "GeneralisedAlpha", "did you mean 'General"),
}
EDITS["p that falls along an element"] = (
    TEXT[TEXT.index(NODE1) : TEXT.index("  - CableALE")],
    TEXT[TEXT.index(NODE1) : TEXT.index("  - CableALE")]
    .replace(NODE1, NODE1 + ", p: 1")
    .replace(NODE2, NODE2 + ", p: -3"),
    14,
    "[6].CableALEelement.nodes7",
    "p goes from 1 m at node 1 to -3 m at node 2: it must grow",
)
EDITS["more frames than fit"] = (
    "time_step: 0.005\n  time_end: 10.0\n  plotpoints: 50",
    "time_step: 1e-6\n  time_end: 10.0\n  plotpoints: 0",
    36,
    "GeneralizedAlpha.plotpoints = 0",
    "fewer frames a second",
)


def refusal(text, path="span.yaml"):
    with pytest.raises(SceneError) as caught:
        parse(text, path)
    return str(caught.value)


def test_the_table_holds_more_than_fifty_broken_scenes():
    assert len(EDITS) >= 50


@pytest.mark.parametrize("name", EDITS)
def test_a_broken_scene_is_refused_with_line_key_and_cure(name):
    old, new, line, key, cure = EDITS[name]
    assert old in TEXT
    message = refusal(TEXT.replace(old, new, 1))
    found = [m for m in message.splitlines() if m.startswith(f"span.yaml:{line}: ") and key in m.split("; ")[0]]
    assert found, message
    assert any(cure in m for m in found), message
    assert all("; " in m for m in message.splitlines()), f"a cure is missing: {message}"


@pytest.mark.parametrize("key", ["CableModelMaterial", "CableModel", "GeneralizedAlpha"])
def test_a_missing_part_is_named_with_what_to_add(key):
    text = re.sub(rf"(?m)^{key}:.*\n(^  .*\n|^\n)*", "", TEXT)
    assert f"span.yaml:1: {key}: is missing; add `{key}:`, such as" in refusal(text)


def test_several_faults_are_told_at_once_in_the_order_of_the_file():
    text = TEXT.replace("nodes7: [3, 4]", "nodes7: [3, 9]").replace("nodes7: [0, 1]", "nodes7: [0, 0]")
    lines = refusal(text.replace("nodes7: [2], mass", "nodes7: [6], mass")).splitlines()
    assert [line.split(":")[1] for line in lines] == ["13", "15", "21"]


@pytest.mark.parametrize(
    "name", ["two nodes of one id", "a function where BC leaves free", "a ring of slaves", "a step of nothing"]
)
def test_check_exits_2_with_the_line_and_no_traceback(name, tmp_path, capsys):
    old, new, line, key, cure = EDITS[name]
    path = tmp_path / "scene.yaml"
    path.write_text(TEXT.replace(old, new, 1))
    with pytest.raises(SystemExit) as left:
        run(make_app(Installed(), ["check"]), ["check", str(path)])
    printed = re.sub(r"\s+", " ", "".join(capsys.readouterr()))
    assert left.value.code == 2
    assert f"scene.yaml:{line}: " in printed and key in printed and cure in printed and "Traceback" not in printed


@pytest.mark.parametrize("name", ["cantilever_bar", "reeled_span"])
def test_the_shipped_scenes_are_good_and_without_a_warning(name, capsys):
    with pytest.raises(SystemExit) as left:
        run(make_app(Installed(), ["check"]), ["check", str(DATA / f"{name}.yaml"), "--json"])
    assert left.value.code == 0
    assert '"warnings": []' in capsys.readouterr().out


def test_the_reeled_span_is_read_as_it_stands():
    scene = read(DATA / "reeled_span.yaml")
    assert scene.gravity == (0.0, 0.0, -9.81)
    assert [(node.id, node.kind, node.line) for node in scene.nodes] == [(i, 7, 7 + i) for i in range(5)]
    assert scene.nodes[4].held == (True, True, True, False, False, False, True)
    assert scene.nodes[4].functions == (0, 0, 0, 0, 0, 0, 1)
    first = scene.elements[0]
    assert (first.kind, first.nodes, first.EA, first.EJ, first.rhoA) == ("cubic", (0, 1), 1000.0, 0.0, 1.0)
    assert (first.damping, first.strain, first.compression, first.load) == (0.001, "green", True, (0.0, 0.0, 0.0))
    assert [(tie.method, tie.nodes, tie.what, tie.stiffness) for tie in scene.ties] == [
        ("multiplier", (2, 3), 0, None),
        ("multiplier", (2, 3), 2, None),
    ]
    assert (scene.anchors[0].nodes, scene.anchors[0].model.stiffness, scene.anchors[0].model.damping) == (
        (1,),
        100.0,
        0.02,
    )
    assert (scene.masses[0].nodes, scene.masses[0].model.mass) == ((2,), 0.5)
    motion = scene.motions[0]
    assert (motion.id, motion.pos0, motion.times[-1], motion.velocities[2]) == (1, 1.5, 100.0, -0.05)
    solver = scene.solver
    assert (solver.method, solver.rho_inf, solver.tolerance, solver.max_iterations) == (
        "generalized-alpha",
        0.6,
        1e-8,
        20,
    )
    assert (solver.step, solver.end, solver.interval, solver.skip_vtk) == (0.005, 10.0, 0.02, True)
    assert scene.text == TEXT and scene.path == DATA / "reeled_span.yaml"


def test_additions_of_ours_are_read():
    text = TEXT.replace(
        CABLE0,
        CABLE0 + ", strain: engineering, compression: false, quadrature: lobatto, load: [0, 0, -2]",
    ).replace(
        MASS,
        MASS
        + "  - AugLagrange7: {id: 1, nodes7: [2, 3], constr: 0, p_spring: 10 kN/m, offset: [0, 0, 5 mm]}\n"
        + "  - Penalty7: {id: 1, nodes7: [2, 3], constr: 1}\n"
        + "  - TwoNodeSpring: {id: 1, nodes7: [0, 2], stiffness: 5, length: 0.3}\n"
        + "  - Function: {id: 2, value: {ramp: {from: 20 cm, to: 1, over: 2}}}\n",
    )
    extra = "\n  start: static\n  projection: mass\n  stabilise: 1\n  control: error\n  tolerance: 1 mm"
    scene = parse(text.replace(END, END + extra))
    first = scene.elements[0]
    assert (first.strain, first.compression, first.quadrature, first.load) == (
        "engineering",
        False,
        "lobatto",
        (0.0, 0.0, -2.0),
    )
    assert [(tie.method, tie.what, tie.stiffness) for tie in scene.ties[2:]] == [
        ("augmented", 0, 10000.0),
        ("penalty", 1, None),
    ]
    assert scene.ties[2].offset == (0.0, 0.0, 0.005)
    assert (scene.springs[0].nodes, scene.springs[0].model.stiffness, scene.springs[0].model.length) == (
        (0, 2),
        5.0,
        0.3,
    )
    assert scene.motions[0].pos0 == pytest.approx(0.2) and scene.motions[0].function.to == 1.0
    solver = scene.solver
    assert (solver.start, solver.projection, solver.stabilise, solver.control, solver.step_error) == (
        "static",
        "mass",
        1,
        "error",
        0.001,
    )
    assert solver.tolerance == 1e-8


@pytest.mark.parametrize("written", ["RK4", "rk4", "G-alpha", "g-ALPHA", "Newmark", "NEWMARK"])
def test_integrators_go_by_their_names_in_any_letters(written):
    method = parse(TEXT.replace("type: G-alpha", f"type: {written}")).solver.method
    assert method == {"r": "rk4", "g": "generalized-alpha", "n": "newmark"}[written[0].lower()]


def test_elements_take_what_they_leave_out_from_the_material():
    text = TEXT.replace(", EA: 1000.0, EJ: 0.0, rhoA: 1.0, cDamp: 0.001", "")
    text = text.replace("  Gravity:", "  CableStiffness: 2 kN\n  CableMass: 3\n  CableDamping: 0.5\n  Gravity:")
    assert {(e.EA, e.EJ, e.rhoA, e.damping) for e in parse(text).elements} == {(2000.0, 0.0, 3.0, 0.5)}
    assert parse(TEXT.replace(", cDamp: 0.001", "")).elements[0].damping == 0.0


# quirks


def without_the_linear_copy(text):
    start, end = text.index("    ##### ALTERNATIV"), text.index("LINEAR ELEMENTS END #####")
    return text[:start] + text[end + len("LINEAR ELEMENTS END #####") :]


@pytest.mark.parametrize("whole", [True, False])
def test_the_appendix_itself_is_read_with_warnings(whole):
    scene = parse(APPENDIX if whole else without_the_linear_copy(APPENDIX), "appendix.yaml")
    counts = [len(part) for part in (scene.nodes, scene.elements, scene.ties, scene.couplings)]
    assert counts == [5, 3, 4, 7]
    assert {node.kind for node in scene.nodes} == {7} and {element.kind for element in scene.elements} == {"cubic"}
    assert scene.solver.method == "rk4" and scene.solver.plotpoints == 10.0
    assert scene.forces[0].model.interval == (0.0, 1.0) and scene.forces[0].model.force == (0.0, 8.5, 0.0)
    assert [(c.cable, c.node, c.dof, c.what) for panel in scene.plots for c in panel] == [
        (0, None, None, "N"),
        (1, None, None, "N"),
        (None, 1, 1, "r"),
        (None, 2, 1, "r"),
    ]
    told = [str(warning) for warning in scene.warnings]
    assert any("plotpoints" in text and "the last one counts" in text for text in told)
    assert any("put a blank after the colon" in text for text in told)
    assert any("copy of the model for linear elements" in text for text in told) == whole
    more = [str(warning) for warning in Cable().warnings(scene)]
    assert any("tied by r = r more than once (multiplier, penalty, coupling)" in text for text in more)


def test_the_appendix_is_read_and_refused_for_saying_each_tie_three_times(tmp_path, capsys):
    """It lists the syntax and is no model: multiplier and coupling tie the same nodes, and a node slides freely."""
    path = tmp_path / "appendix.yaml"
    path.write_text(APPENDIX)
    with pytest.raises(SystemExit) as left:
        run(make_app(Installed(), ["check"]), ["check", str(path)])
    told = "".join(capsys.readouterr())
    assert left.value.code == 2 and "Traceback" not in told
    assert "appendix.yaml:45: CableModel[8].LagMultipl7: r = r of nodes 2 and 3, x: follows from" in told
    assert "appendix.yaml:27: CableModel[2].Node7Dof.BC: node 2 may slide along the rope" in told


def test_check_refuses_what_only_the_builder_can_tell(tmp_path, capsys):
    path = tmp_path / "sliding.yaml"
    text = (DATA / "cantilever_bar.yaml").read_text(encoding="utf8")
    path.write_text(text.replace("BC: [0, 1, 1, 0, 1, 1, 1]", "BC: [0, 1, 1, 0, 1, 1, 0]"), encoding="utf8")
    with pytest.raises(SystemExit) as left:
        run(make_app(Installed(), ["check"]), ["check", str(path)])
    assert left.value.code == 2 and "node 1 may slide along the rope" in "".join(capsys.readouterr())


def test_check_refuses_an_element_that_its_functions_leave_no_length(tmp_path, capsys):
    """A function puts one node of a linear element where the other stands."""
    moved = LINEAR.replace("BC: [0, 0, 0, 1]", "BC: [1, 1, 1, 1], BC_functions: [2, 0, 0, 0]")
    old, new = added("Function: {id: 2, value: 0}", moved)
    path = tmp_path / "lost.yaml"
    path.write_text(TEXT.replace(old, new, 1), encoding="utf8")
    with pytest.raises(SystemExit) as left:
        run(make_app(Installed(), ["check"]), ["check", str(path)])
    assert left.value.code == 2
    assert "both of its nodes at one point once functions and couplings hold" in "".join(capsys.readouterr())


def test_the_linear_alternative_by_itself_is_read_and_its_slope_constraints_are_ignored():
    start, middle = APPENDIX.index("    - Node7Dof: { id: 0"), APPENDIX.index("    - Node4Dof: { id: 0")
    text = (APPENDIX[:start] + APPENDIX[middle:]).replace("nodes7", "nodes4")
    scene = parse(text)
    assert {node.kind for node in scene.nodes} == {4} and {element.kind for element in scene.elements} == {"linear"}
    assert [(tie.method, tie.what) for tie in scene.ties] == [("multiplier", 0), ("penalty", 0)]
    assert sum("no slope that could be tied" in str(warning) for warning in scene.warnings) == 2
    assert material_coordinates(scene) == {0: -1.5, 1: -1.0, 2: -0.5, 3: -0.5, 4: 0.0}


@pytest.mark.parametrize("spelling", ["CableALEelement", "CableALElement"])
def test_both_spellings_of_an_element_are_one(spelling):
    scene = parse(TEXT.replace("CableALEelement", spelling))
    assert [element.kind for element in scene.elements] == ["cubic"] * 3
    scene = parse(TEXT.replace(*added(LINEAR.replace("CableALEelement", spelling))))
    assert scene.elements[-1].kind == "linear"


def test_a_glued_key_is_not_taken_apart_where_the_key_stands_already():
    text = BAR.replace("{Node: 2, DOF: 1", "{Node: 2, Node:1, DOF: 1")
    assert "Plots[0].SubPlot[0].Node:1 = : unknown key" in refusal(text)


def test_only_plotpoints_may_stand_twice():
    assert "duplicate key" in refusal(TEXT.replace("  skipVTK: True", "  skipVTK: True\n  skipVTK: False"))
    scene = parse(TEXT.replace("  skipVTK: True", "  skipVTK: True\n  plotpoints: 20"))
    assert scene.solver.plotpoints == 20.0
    assert [warning.where for warning in scene.warnings] == ["GeneralizedAlpha.plotpoints (line 38)"]


def test_linear_nodes_beside_cubic_ones_are_kept_when_they_are_no_copy():
    scene = parse(TEXT.replace(*added(LINEAR)))
    assert [node.kind for node in scene.nodes] == [7] * 5 + [4] * 2 and scene.warnings == ()


# material coordinates


def coordinates(text):
    return material_coordinates(parse(text))


def test_p_follows_the_elements_from_the_reeled_end_and_across_the_joint():
    assert coordinates(TEXT) == {0: 0.0, 1: 0.5, 2: 1.0, 3: 1.0, 4: 1.5}
    assert coordinates(TEXT.replace("pos0: 1.5", "pos0: 4.5")) == {0: 3.0, 1: 3.5, 2: 4.0, 3: 4.0, 4: 4.5}


def test_p_begins_at_zero_where_nothing_says_otherwise():
    assert coordinates(BAR) == {0: 0.0, 1: 0.5, 2: 1.0}
    shuffled = BAR.replace("id: 2, xyz: [1.0", "id: 0, xyz: [0.0", 1).replace("id: 0, xyz: [0.0", "id: 2, xyz: [1.0", 1)
    assert coordinates(shuffled) == {0: 0.0, 1: 0.5, 2: 1.0}


def test_p_crosses_a_joint_by_coupling_too_and_by_p_with_its_offset():
    text = re.sub(r"  - LagMultipl7.*\n", "", TEXT)
    assert coordinates(text) == {0: 0.0, 1: 0.5, 2: 1.0, 3: 1.0, 4: 1.5}
    apart = text.replace("pos0: 1.5", "pos0: 7.5")
    assert coordinates(apart) == {0: 0.0, 1: 0.5, 2: 1.0, 3: 7.0, 4: 7.5}
    assert coordinates(apart.replace(*added(COUPLED)))[2] == 7.0
    free = apart.replace(
        "id: 3, xyz: [1.0, 0, 0], xyz_d: [1, 0, 0], BC: [0, 0, 0, 0, 0, 0, 1]", "id: 3, xyz: [1, 0, 0]"
    )
    by_p = "  - LinearCoupl: {id: 1, sNode: 3, sDof: 7, f0: 2, masters: [{mNode: 2, mDof: 7, factor: 1}]}\n"
    assert coordinates(free.replace(*added(COUPLED.replace("id: 1", "id: 2"), by_p)))[2] == 5.0


def test_between_two_known_coordinates_every_element_is_strained_alike():
    # 0 to 1 m of chord in pieces of 0.25 and 0.75 hold 1.2 m of cable
    text = BAR.replace("id: 0, xyz: [0.0, 0, 0]", "id: 0, p: 5, xyz: [0.0, 0, 0]")
    text = text.replace("id: 2, xyz: [1.0, 0, 0]", "id: 2, p: 6.2, xyz: [1.0, 0, 0]").replace(
        "[0.5, 0, 0]", "[0.25, 0, 0]"
    )
    assert coordinates(text) == pytest.approx({0: 5.0, 1: 5.3, 2: 6.2}, abs=1e-14)


def test_coincident_nodes_are_allowed_where_both_give_p():
    text = BAR.replace("id: 1, xyz: [0.5, 0, 0]", "id: 1, p: 0.4, xyz: [0.0, 0, 0]")
    assert coordinates(text.replace("id: 0, xyz", "id: 0, p: 0, xyz")) == pytest.approx({0: 0.0, 1: 0.4, 2: 1.4})


def test_the_first_value_of_a_function_of_time_is_where_p_begins():
    for value, first in {
        "{ramp: {from: 2.5, to: 3, over: 1}}": 2.5,
        "{table: {time: [-1, 1], value: [2, 4]}}": 3.0,
        "{harmonic: {amplitude: 0.5, period: 4, phase: 90 deg, mean: 2}}": 2.5,
        "{sum: [2, {chirp: {amplitude: 1, period: 2, rate: 0.1}}]}": 2.0,
        "3 m": 3.0,
    }.items():
        text = TEXT[: TEXT.index("  - Function_Vel")] + f"  - Function: {{id: 1, value: {value}}}\n\n"
        text += TEXT[TEXT.index("GeneralizedAlpha") :]
        assert coordinates(text)[4] == pytest.approx(first, abs=1e-12), value


def arch(radius, angle):
    """Two nodes on a circle, with the slopes that it has there."""
    ends = [(radius * math.sin(a), 0.0, radius * (1 - math.cos(a))) for a in (0.0, angle)]
    slopes = [(math.cos(a), 0.0, math.sin(a)) for a in (0.0, angle)]
    nodes = "\n".join(
        f"  - Node7Dof: {{id: {i}, xyz: {list(end)}, xyz_d: {list(slope)}, BC: [1, 1, 1, 0, 0, 0, 1]}}"
        for i, (end, slope) in enumerate(zip(ends, slopes, strict=True))
    )
    start, stop = BAR.index("  - Node7Dof"), BAR.index("Plots:")
    cable = "\n  - CableALEelement: {id: 0, nodes7: [0, 1], EA: 1, rhoA: 1}\n"
    return BAR[:start] + nodes + cable + BAR[BAR.index("GeneralizedAlpha") :] if stop > start else ""


@pytest.mark.parametrize("angle", [0.2, 0.8, 1.5])
def test_a_curved_element_is_as_long_as_its_own_arc(angle):
    scene = parse(arch(2.0, angle))
    first, second = scene.nodes
    drawn = Drawn.of(scene.elements, {0: first, 1: second})
    (length,) = unstretched_lengths(drawn)
    # the arc by chords of the cubic, evaluated here by itself
    x = np.linspace(0.0, 1.0, 20001)[:, None]
    r = (1 - 3 * x**2 + 2 * x**3) * np.array(first.position) + (3 * x**2 - 2 * x**3) * np.array(second.position)
    r = r + length * ((x - 2 * x**2 + x**3) * np.array(first.slope) + (x**3 - x**2) * np.array(second.slope))
    assert np.linalg.norm(np.diff(r, axis=0), axis=1).sum() == pytest.approx(length, rel=1e-8)
    assert arc_lengths(drawn, np.array([length])) == pytest.approx(length, rel=1e-14)
    # and near the circle's: short of it by angle^4/720, and a little more for large angles
    assert 1.0 - length / (2.0 * angle) == pytest.approx(angle**4 / 720.0, rel=0.06)
    assert material_coordinates(scene) == {0: 0.0, 1: length}


def test_a_slope_left_out_points_along_the_elements():
    text = re.sub(r" xyz_d: \[1, 0, 0\],", "", BAR).replace("id: 2, xyz: [1.0, 0, 0]", "id: 2, xyz: [0.5, 0, 2.0]")
    slopes = [node.slope for node in parse(text).nodes]
    assert slopes[0] == (1.0, 0.0, 0.0) and slopes[2] == (0.0, 0.0, 1.0)
    assert slopes[1] == pytest.approx((math.sqrt(0.5), 0.0, math.sqrt(0.5)), abs=1e-15)
    back = re.sub(r" xyz_d: \[1, 0, 0\],", "", BAR).replace("xyz: [1.0, 0, 0]", "xyz: [0.0, 0, 0]")
    assert "CableModel[1].Node7Dof.xyz_d: is missing, and the elements at the node point to no common" in refusal(back)


# warnings, options, figures for check

MOVED = LINEAR.replace("BC: [0, 0, 0, 1]", "BC: [1, 0, 0, 1], BC_functions: [2, 0, 0, 0]")

WARNINGS = {
    "a step too long for RK4": (
        BAR,
        "time_step: 0.01",
        "time_step: 0.2",
        "time_step",
        "critical step, which is at least",
    ),
    "more frames than steps": (BAR, "plotpoints: 100", "plotpoints: 1000", "plotpoints", "every step is kept"),
    "frames between steps": (BAR, "plotpoints: 100", "plotpoints: 80", "plotpoints", "not a whole number of steps"),
    "a function that nobody names": (TEXT, *added("Function: {id: 2, value: 1}"), "Function.id", "moves nothing"),
    "a function that begins elsewhere": (
        TEXT,
        *added(
            "Function: {id: 2, value: 3}",
            MOVED,
        ),
        "BC_functions[0]",
        "begins at 3, and the node stands at 1",
    ),
    "a penalty that rounding spoils": (
        TEXT,
        *added("Penalty7: {id: 1, nodes7: [2, 3], constr: 0, p_spring: 1.0e16}"),
        "p_spring",
        "rounding eats",
    ),
    "a slope against its element": (BAR, "nodes7: [0, 1]", "nodes7: [1, 0]", "nodes7", "points back along"),
    "a slope of two": (BAR, "[0.5, 0, 0], xyz_d: [1, 0, 0]", "[0.5, 0, 0], xyz_d: [2, 0, 0]", "xyz_d", "unit vector"),
    "a node without mass": (BAR, "EJ: 0.0, rhoA: 1.0", "EJ: 0.0, rhoA: 0.0", "rhoA", "has no mass"),
    "a force after the end": (BAR, "timeInterval: [0, 1.0]", "timeInterval: [200, 201]", "timeInterval", "has ended"),
}
WARNINGS["a tie that gapes"] = (
    TEXT,
    "id: 3, xyz: [1.0, 0, 0]",
    "id: 3, xyz: [1.0, 0, 0.1]",
    "LagMultipl7.constr",
    "differ by 0.1; give `offset:`",
)
WARNINGS["an element that begins stretched"] = (
    BAR,
    "id: 0, xyz: [0.0, 0, 0], xyz_d: [1, 0, 0], BC: [1, 1, 1, 0, 1, 1, 1]}\n  - Node7Dof: {id: 1,",
    "id: 0, p: 0, xyz: [0.0, 0, 0], xyz_d: [1, 0, 0], BC: [1, 1, 1, 0, 1, 1, 1]}\n  - Node7Dof: {id: 1, p: 0.4,",
    "nodes7",
    "is stretched by 25 %",
)


@pytest.mark.parametrize("name", WARNINGS)
def test_an_odd_scene_is_warned_of_and_not_refused(name):
    text, old, new, where, words = WARNINGS[name]
    assert old in text
    if name == "a node without mass":
        text = text.replace(old, new)
    found = Cable().warnings(parse(text.replace(old, new, 1)))
    assert any(where in warning.where and words in warning.text for warning in found), found


@pytest.mark.parametrize(
    ("given", "cause"),
    [
        ({"step": 0.0}, "--step: GeneralizedAlpha.time_step = 0.0: must be greater than zero"),
        ({"method": "rk5"}, "--method: GeneralizedAlpha.type = rk5: is not known here; did you mean 'rk4'?"),
        ({"rho_inf": 2.0}, "--rho-inf: GeneralizedAlpha.rho_inf = 2.0: must not be more than 1"),
        ({"end": 1e-9}, "--end: GeneralizedAlpha.time_end = 1e-09: is before the first step ends"),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_a_bad_option_is_named(given, cause):
    with pytest.raises(SceneError, match=f"^{re.escape(cause)}"):
        Cable().with_overrides(parse(TEXT), **given)


def test_options_replace_what_the_scene_says():
    scene = Cable().with_overrides(parse(BAR), method="G-alpha", step=0.02, end=2.0, rho_inf=0.5)
    solver = scene.solver
    assert (solver.method, solver.step, solver.end, solver.rho_inf) == ("generalized-alpha", 0.02, 2.0, 0.5)
    assert solver.alphas == pytest.approx((0.0, 1.0 / 3.0))
    assert parse(BAR.replace("type: RK4", "type: G-alpha")).solver.alphas == (-0.05, 0.1)
    assert Cable().with_overrides(scene) is scene


def test_check_counts_length_and_mass():
    figures = Cable().check_figures(parse(TEXT))
    assert figures["cable"] == {
        "nodes": 5,
        "elements": 3,
        "ties": 2,
        "couplings": 0,
        "forces": 0,
        "anchors": 1,
        "springs": 0,
        "masses": 1,
        "motions": 1,
        "length": 1.5,
        "mass": 2.0,
    }
    assert figures["critical_step_rk4"] == pytest.approx(2.8 / math.sqrt(170.13 * 1000.0 / 0.25), rel=1e-3)


@pytest.mark.parametrize("name", ["bar", "span"])
def test_the_templates_are_good_scenes(name):
    text = Cable().templates[name]
    scene = parse(text)
    assert scene.plots and Cable().warnings(scene) == []
    assert Cable().recognises(Document.parse(text).root)


def test_the_schema_knows_every_key_of_the_shipped_scenes():
    schema = str(json_schema())
    for text in (TEXT, BAR, *Cable().templates.values()):
        for key in re.findall(r"(\w+):", re.sub(r"#.*|'[^']*'", "", text)):
            assert f"'{key}'" in schema, key


# nothing but a scene or a refusal

VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)
KEYS = [("CableModel",), ("Plots",), ("GeneralizedAlpha",), ("CableModel", 1), ("CableModel", 1, "Node7Dof")]
KEYS += [("CableModel", 1, "Node7Dof", key) for key in ("id", "xyz", "xyz_d", "BC", "p", "BC_functions")]
KEYS += [("CableModel", 5, "CableALEelement", key) for key in ("id", "nodes7", "EA", "rhoA", "load")]
KEYS += [("CableModel", 12, "Function_VelocityDefined", "pos0"), ("CableModel", 8, "LagMultipl7", "constr")]


@settings(max_examples=30, deadline=None)
@given(st.sampled_from(KEYS), VALUES)
def test_any_value_in_any_place_is_read_or_refused_and_nothing_else(key, value):
    scene = parse(TEXT)
    try:
        changed = with_values(scene, {key: (value, "vary")})
    except SceneError as error:
        assert error.problems and all(problem.cure for problem in error.problems)
    else:
        Cable().warnings(changed)
        Cable().check_figures(changed)


NUMBERS = st.sampled_from([0.0, -0.0, 1.0, -1.0, 5e-324, 1e-300, 1e-13, 1e8, 1e150, 1e308, -1e308])
PLACES = [("CableModel", i, "Node7Dof", key, axis) for i in range(5) for key in ("xyz", "xyz_d") for axis in range(3)]
PLACES += [("CableModel", 1, "Node7Dof", "p"), ("CableModel", 3, "Node7Dof", "p")]
PLACES += [("CableModel", 5, "CableALEelement", key) for key in ("EA", "EJ", "rhoA", "cDamp")]
PLACES += [("CableModel", 12, "Function_VelocityDefined", "pos0"), ("CableModel", 11, "PointMass", "mass")]
PLACES += [("GeneralizedAlpha", key) for key in ("time_step", "time_end", "plotpoints", "massDamp", "rho_inf")]


@settings(max_examples=40, deadline=None)
@given(st.dictionaries(st.sampled_from(PLACES), NUMBERS, min_size=1, max_size=4))
@pytest.mark.filterwarnings("error")
def test_any_numbers_are_read_or_refused_and_nothing_else(numbers):
    scene = parse(TEXT)
    try:
        changed = with_values(scene, {place: (value, "vary") for place, value in numbers.items()})
    except SceneError as error:
        assert all(problem.cure for problem in error.problems)
    else:
        assert all(math.isfinite(p) for p in material_coordinates(changed).values())
        Cable().warnings(changed)
        Cable().check_figures(changed)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, len(APPENDIX)), st.text(min_size=1, max_size=4), st.integers(0, 5))
def test_the_appendix_with_anything_in_it_is_read_or_refused_and_nothing_else(at, text, cut):
    try:
        parse(APPENDIX[:at] + text + APPENDIX[at + cut :])
    except SceneError as error:
        assert "; " in str(error)
