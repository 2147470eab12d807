"""The scenes of `race.py` in Exudyn (J. Gerstmayr and others, PyPI `exudyn`), set as its own documentation advises.

Its page "Performance and ways to speed up computations" asks for: the module without range checks, modified Newton,
sparse matrices above some fifty unknowns and Eigen's dense ones below, no output, no measurement of computation time,
no Python function in the loop. So it is here. The linear solver is the one that a short run finds to be the quickest.
"""

from __future__ import annotations

import contextlib
import io
import sys
import time
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from benchmarks.race import scenes
from benchmarks.race.scenes import BAR, CATENARY, GRAVITY, SHEAVE, Case

SPARSE, DENSE = ("EigenSparse",), ("EXUdense", "EigenDense")
DENSE_UP_TO = 64
"""Elements up to which dense matrices are tried: with 64 they take three times as long already."""
TRIED = 200
"""Steps of the short run that chooses the linear solver."""


@dataclass(frozen=True)
class Rival:
    """How Exudyn runs a case: element, whether in three dimensions, integration of the element, linear solver."""

    element: str
    space: bool = False
    reduced: int = 2
    solver: str = "EigenSparse"


class Outcome(NamedTuple):
    """What a run took: CPU s of SolveDynamic and with building the model; iterations, Jacobians, places, failure."""

    solve: float
    whole: float
    iterations: int
    jacobians: int
    points: np.ndarray | None
    failure: str | None


def version() -> str | None:
    """Version of Exudyn; None where it is not installed."""
    try:
        return str(_exudyn().__version__)
    except ImportError:
        return None


@cache
def _exudyn() -> Any:
    # Exudyn reads this when it is first imported: the module without range checks.
    sys.exudynFast = True  # type: ignore[attr-defined]
    with contextlib.redirect_stdout(io.StringIO()):
        import exudyn
        import exudyn.advancedUtilities
        import exudyn.itemInterface
    exudyn.config.printToConsole = False
    return exudyn


def rivals(case: Case) -> list[Rival]:
    """Elements that Exudyn has for a scene.

    Its option 2 integrates the axial strain by three Lobatto points and bending by two Gauss points: the least work,
    and no locking. The bar takes option 1, which is exact there.
    """
    kinds = {
        "bar": [Rival("Cable2D", reduced=1)],
        "catenary": [Rival("Cable2D"), Rival("ANCFCable", True)],
        "flowing": [Rival("ALECable2D")],
        "hose": [Rival("ALECable2D")],
        "sheave": [Rival("ReevingSystemSprings")],
    }
    return kinds[case.scene]


def quickest(case: Case, rival: Rival) -> Rival:
    """The rival with the linear solver that takes least CPU time in a short run."""
    if case.elements > DENSE_UP_TO:
        return replace(rival, solver=SPARSE[0])
    short = replace(case, end=min(case.end, TRIED * case.step))
    tried = [replace(rival, solver=solver) for solver in (*DENSE, *SPARSE)]
    return min(tried, key=lambda one: min(run(short, one).solve for _ in range(3)))


def run(case: Case, rival: Rival, judged: bool = False, tighter: float = 1.0) -> Outcome:
    """Build a case and run it; judged: to the end of that run, and with the places that are compared."""
    exu = _exudyn()
    began = time.process_time()
    container = exu.SystemContainer()
    system = container.AddSystem()
    with contextlib.redirect_stdout(io.StringIO()):
        nodes = BUILDERS[case.scene](exu, system, case, rival)
        sensors = [_sensor(exu, system, node) for node in nodes] if judged else []
        system.Assemble()
        settings = _settings(exu, case, rival, judged, tighter)
        before, failure = time.process_time(), None
        try:
            done = system.SolveDynamic(settings, showHints=False, showCausingItems=False)
        except Exception as stop:  # whatever it raises is how its run ended
            done, failure = False, f"{type(stop).__name__}: {stop}".splitlines()[0][:100]
        after = time.process_time()
    counted = system.sys["dynamicSolver"].it
    places = None
    if judged and done:
        stored = np.array([system.GetSensorStoredData(sensor)[1:, 1:] for sensor in sensors])
        # In the plane its y is our z; the bar and the rope in three dimensions lie in its plane x, y as well.
        places = stored.transpose(1, 0, 2)[..., :2]
    return Outcome(after - before, after - began, counted.newtonStepsCount, counted.newtonJacobiCount, places,
                   failure if done or failure else "did not converge")  # fmt: skip


def set_up(case: Case, rival: Rival) -> float:
    """CPU time of SolveDynamic for one step, s: what it takes to begin, with the first Jacobian."""
    return min(run(replace(case, end=case.step), rival).solve for _ in range(3))


def _settings(exu: Any, case: Case, rival: Rival, judged: bool, tighter: float) -> Any:
    settings = exu.SimulationSettings()
    loop = settings.timeIntegration
    loop.endTime = case.judged if judged else case.end
    loop.numberOfSteps = round(loop.endTime / case.step)
    loop.generalizedAlpha.spectralRadius = case.rho_inf
    loop.newton.useModifiedNewton = True
    loop.newton.relativeTolerance = tighter * case.relative
    loop.newton.absoluteTolerance = tighter * case.absolute
    loop.verboseMode = 0
    settings.solution.file.write = False
    settings.solution.sensors.active = judged
    settings.solution.sensors.writePeriod = case.every
    settings.show.computationTime = False
    settings.linearSolver.solverType = getattr(exu.LinearSolverType, rival.solver)
    settings.parallel.numberOfThreads = 1
    return settings


def _sensor(exu: Any, system: Any, node: Any) -> Any:
    kind = exu.OutputVariableType.Position
    return system.AddSensor(exu.itemInterface.SensorNode(nodeNumber=node, storeInternal=True, outputVariableType=kind))


class _Holder:
    """Holds coordinates of nodes to the ground: the one kind of constraint that the scenes need."""

    def __init__(self, exu: Any, system: Any) -> None:
        self.items, self.system = exu.itemInterface, system
        self.ground = self._marker(system.AddNode(self.items.NodePointGround()), 0)

    def hold(self, node: Any, coordinate: int, **keys: Any) -> None:
        """Hold a coordinate of a node, at what ``keys`` say."""
        markers = [self.ground, self._marker(node, coordinate)]
        self.system.AddObject(self.items.ObjectConnectorCoordinate(markerNumbers=markers, **keys))

    def flow(self, speed: float) -> Any:
        """A node for the axial motion of all elements, at a given speed."""
        keys = {"referenceCoordinates": [0.0], "initialCoordinates": [0.0], "initialCoordinates_t": [speed]}
        node = self.system.AddNode(self.items.NodeGenericODE2(numberOfODE2Coordinates=1, **keys))
        self.hold(node, 0, offset=speed, velocityLevel=True)
        return node

    def _marker(self, node: Any, coordinate: int) -> Any:
        return self.system.AddMarker(self.items.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))


def _bar(exu: Any, system: Any, case: Case, rival: Rival) -> list[Any]:
    """What is across the bar is left free: nothing moves it, and to hold it would cost constraints."""
    items, n = exu.itemInterface, case.elements
    at = np.linspace(0.0, BAR["length"], n + 1)
    nodes = [system.AddNode(items.NodePoint2DSlope1(referenceCoordinates=[x, 0.0, 1.0, 0.0])) for x in at]
    keys = {"length": BAR["length"] / n, "massPerLength": BAR["rhoA"], "axialStiffness": BAR["EA"]}
    for pair in pairwise(nodes):
        system.AddObject(
            items.ObjectANCFCable2D(nodeNumbers=list(pair), useReducedOrderIntegration=rival.reduced, **keys)
        )
    _Holder(exu, system).hold(nodes[0], 0)
    end = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=nodes[-1], coordinate=0))
    system.AddLoad(items.LoadCoordinate(markerNumber=end, load=BAR["force"]))
    return nodes[-1:]


def _rope(exu: Any, system: Any, case: Case, rival: Rival) -> list[Any]:
    items, n = exu.itemInterface, case.elements
    holder, flat = _Holder(exu, system), [] if not rival.space else [0.0]
    kind = items.NodePointSlope1 if rival.space else items.NodePoint2DSlope1
    places, slopes, _ = scenes.rope_start(n, case.speed)
    nodes = [
        system.AddNode(kind(referenceCoordinates=[*place, *flat, *slope, *flat]))
        for place, slope in zip(places, slopes, strict=True)
    ]
    element = {
        "Cable2D": items.ObjectANCFCable2D,
        "ANCFCable": items.ObjectANCFCable,
        "ALECable2D": items.ObjectALEANCFCable2D,
    }[rival.element]
    more = [holder.flow(case.speed)] if case.scene == "flowing" else []
    keys = {"length": CATENARY["length"] / n, "massPerLength": CATENARY["rhoA"], "axialStiffness": CATENARY["EA"],
            "bendingStiffness": CATENARY["EJ"], "useReducedOrderIntegration": rival.reduced}  # fmt: skip
    for i in range(n):
        body = system.AddObject(element(nodeNumbers=[nodes[i], nodes[i + 1], *more], **keys))
        _weigh(items, system, body)
    for node in (nodes[0], nodes[-1]):
        for coordinate in range(3 if rival.space else 2):
            moved = {"offsetUserFunction": _swing(exu, system)} if (node, coordinate) == (nodes[-1], 0) else {}
            holder.hold(node, coordinate, **moved)
    return [nodes[i] for i in scenes.watched(case)]


def _swing(exu: Any, system: Any) -> Any:
    """The motion of the end, which Exudyn turns into an expression of its own: no Python runs in its loop."""

    def offset(mbs, t, itemNumber, lOffset):  # type: ignore[no-untyped-def]
        return 1.0 - exu.symbolic.cos(np.pi * t)

    make = exu.advancedUtilities.CreateSymbolicUserFunction
    return make(system, offset, "offsetUserFunction", itemTypeName="ObjectConnectorCoordinate")


def _weigh(items: Any, system: Any, body: Any) -> None:
    marker = system.AddMarker(items.MarkerBodyMass(bodyNumber=body))
    system.AddLoad(items.LoadMassProportional(markerNumber=marker, loadVector=[0.0, -GRAVITY, 0.0]))


def _hose(exu: Any, system: Any, case: Case, rival: Rival) -> list[Any]:
    """The clamp holds the direction of the hose and leaves its stretch free, as in `data/hose.yaml`."""
    items, n, holder = exu.itemInterface, case.elements, _Holder(exu, system)
    hose, water = scenes.hose_numbers()
    flow, both = holder.flow(case.speed), hose["mass_per_length"] + water["mass_per_length"]
    at, damping = np.linspace(0.0, hose["length"], n + 1), hose["damping"]
    nodes = [system.AddNode(items.NodePoint2DSlope1(referenceCoordinates=[x, 0.0, 1.0, 0.0])) for x in at]
    for i in range(n):
        body = system.AddObject(
            items.ObjectALEANCFCable2D(
                length=hose["length"] / n, massPerLength=both, movingMassFactor=water["mass_per_length"] / both,
                axialStiffness=hose["axial_stiffness"], axialDamping=hose["axial_stiffness"] * damping,
                bendingStiffness=hose["bending_stiffness"], bendingDamping=hose["bending_stiffness"] * damping,
                useReducedOrderIntegration=rival.reduced, nodeNumbers=[nodes[i], nodes[i + 1], flow],
            )
        )  # fmt: skip
        _weigh(items, system, body)
    for coordinate in (0, 1, 3):
        holder.hold(nodes[0], coordinate)
    return nodes[-1:]


def _sheave(exu: Any, system: Any, case: Case, rival: Rival) -> list[Any]:
    """The connector takes rigid bodies only: the load is one in the plane, which nothing turns."""
    items, (x, z) = exu.itemInterface, SHEAVE["load"]
    ground = system.AddObject(items.ObjectGround())
    node = system.AddNode(items.NodeRigidBody2D(referenceCoordinates=[x, z, 0.0]))
    load = system.AddObject(items.ObjectRigidBody2D(mass=SHEAVE["mass"], inertia=1.0, nodeNumber=node))
    markers = [
        system.AddMarker(items.MarkerBodyRigid(bodyNumber=ground, localPosition=[*SHEAVE["wall"], 0.0])),
        system.AddMarker(items.MarkerBodyRigid(bodyNumber=ground)),
        system.AddMarker(items.MarkerBodyRigid(bodyNumber=load)),
    ]
    # A negative force asks for its plain linear spring: this rope is never slack.
    system.AddObject(
        items.ObjectConnectorReevingSystemSprings(
            markerNumbers=markers, stiffnessPerLength=SHEAVE["EA"], referenceLength=scenes.rope_length(),
            regularizationForce=-1.0, sheavesAxes=exu.Vector3DList([[0.0, 0.0, -1.0]] * 3),
            sheavesRadii=[0.0, SHEAVE["radius"], 0.0],
        )
    )  # fmt: skip
    _weigh(items, system, load)
    return [node]


BUILDERS = {"bar": _bar, "catenary": _rope, "flowing": _rope, "hose": _hose, "sheave": _sheave}
