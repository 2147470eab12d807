"""The list under ``CableModel``, as it stands in a file: one model for each kind of item in the thesis' Appendix A.

Marked *ours* is what the appendix does not have. These models check each item by itself;
`tautline.cable.input.references` checks them against each other and makes the parts that the builder reads.
"""

from __future__ import annotations

import itertools
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from tautline.cable.input.entries import (
    Acceleration,
    AxialStiffness,
    BendingStiffness,
    Damping,
    DampingTime,
    Dof,
    Flags4,
    Flags7,
    Functions4,
    Functions7,
    Id,
    Ids,
    Length,
    Load,
    MassPerLength,
    Pair,
    Position,
    Slope,
    Speed,
    Stiffness,
    Thrust,
    Time,
    listed,
)
from tautline.cable.input.plots import SubPlot
from tautline.cable.input.solver import CableSolver
from tautline.scene.functions import FunctionOfTime, time_function
from tautline.scene.model import Branch, Model, OneOf, Switch, word
from tautline.scene.quantity import quantity
from tautline.scene.refusal import fault


class Material(Model):
    """Gravity, m/s^2, and what elements that leave it out take as EA (N), rhoA (kg/m) and cDamp (s)."""

    Gravity: Acceleration = Field(examples=["[0, 0, -9.81]"])
    CableStiffness: AxialStiffness | None = None
    CableMass: MassPerLength | None = None
    CableDamping: DampingTime | None = None


class Node7Dof(Model):
    """A node of cubic elements; BC 1 holds, 0 frees; BC_functions names what a held one follows, 0 for nothing.

    Ours: `xyz_d` left out points along the node's elements; `p` is the material coordinate, m.
    """

    id: Id
    xyz: Position = Field(examples=["[0.5, 0, 0]"])
    xyz_d: Slope | None = None
    BC: Flags7 = (0,) * 7
    BC_functions: Functions7 = (0,) * 7
    p: Length | None = None


class Node4Dof(Model):
    """A node of linear elements; ours: `p`, its material coordinate, m."""

    id: Id
    xyz: Position = Field(examples=["[0.5, 0, 0]"])
    BC: Flags4 = (0,) * 4
    BC_functions: Functions4 = (0,) * 4
    p: Length | None = None


class _Element(Model):
    """What both kinds of element have.

    Ours: `strain` (green, eq. 2.52, or engineering, eq. 2.154), `compression` (false: tension only) and `load`, a dead
    load in N per metre of unstretched cable.
    """

    id: Id
    EA: AxialStiffness | None = None
    EJ: BendingStiffness = 0.0
    rhoA: MassPerLength | None = None
    cDamp: DampingTime | None = None
    strain: Annotated[Literal["green", "engineering"], word("green", "engineering")] = "green"
    compression: Switch = True
    load: Load = (0.0, 0.0, 0.0)


class CubicElement(_Element):
    """A cubic ALE-ANCF element; ours: `quadrature` of its axial term."""

    nodes7: Pair = Field(examples=["[0, 1]"])
    quadrature: Annotated[Literal["gauss", "lobatto"], word("gauss", "lobatto")] | None = None


class LinearElement(_Element):
    """A linear ALE-ANCF element: it cannot bend."""

    nodes4: Pair = Field(examples=["[0, 1]"])

    @model_validator(mode="after")
    def _straight(self) -> LinearElement:
        if self.EJ != 0.0:
            raise fault("EJ", "a linear element has no bending", "set EJ to 0, or use CableALEelement with Node7Dof")
        return self


class _Tie(Model):
    """Two nodes made equal: constr 0 r = r, 1 p = p, 2 r' = r'; ours: `offset`, m, of the second from the first."""

    id: Id
    constr: Annotated[Literal[0, 1, 2], Field(examples=["0 (r = r), 1 (p = p) or 2 (r' = r')"])]
    offset: Position | None = None

    @model_validator(mode="before")
    @classmethod
    def _known(cls, data: Any) -> Any:
        known = {0: "r = r", 1: "p = p", 2: "r' = r'"}
        value = data.get("constr", 0) if isinstance(data, dict) else 0
        if isinstance(value, bool) or not isinstance(value, (int, float)) or value not in known:
            listing = ", ".join(f"{number} ({text})" for number, text in known.items())
            raise fault("constr", "is no kind of constraint", f"known: {listing}")
        return data

    @model_validator(mode="after")
    def _offset(self) -> _Tie:
        if self.offset is not None and self.constr != 0:
            raise fault("offset", "holds for positions only", "remove it, or set constr to 0")
        return self


class Multiplier7(_Tie):
    """Lagrange multipliers between cubic nodes."""

    nodes7: Pair = Field(examples=["[2, 3]"])


class Multiplier4(_Tie):
    """Lagrange multipliers between linear nodes."""

    nodes4: Pair = Field(examples=["[2, 3]"])


class Penalty7(Multiplier7):
    """Penalty springs between cubic nodes; without `p_spring`, N/m (N m for slopes), the builder chooses it."""

    p_spring: Stiffness | None = None


class Penalty4(Multiplier4):
    """Penalty springs between linear nodes."""

    p_spring: Stiffness | None = None


class Master(Model):
    """A degree of freedom that a slave follows, and its factor."""

    mNode: Id
    mDof: Dof
    factor: Annotated[float, quantity("", of="factor")] = 1.0

    @model_validator(mode="after")
    def _counts(self) -> Master:
        if self.factor == 0.0:
            raise fault("factor", "is zero: the master has no influence", "remove the master, or give another factor")
        return self


class LinearCoupl(Model):
    """A slave degree of freedom, numbered from one: f0 + sum of factor times master."""

    id: Id
    sNode: Id
    sDof: Dof
    f0: Length = 0.0
    masters: Annotated[tuple[Master, ...], listed(None, "masters", "[{mNode: 2, mDof: 1, factor: 1}]")]


class _OnNodes(Model):
    """Something at nodes of either kind."""

    id: Id
    nodes7: Ids | None = None
    nodes4: Ids | None = None

    @model_validator(mode="after")
    def _somewhere(self) -> _OnNodes:
        if self.nodes7 is None and self.nodes4 is None:
            raise fault("nodes7", "is missing", "add `nodes7:`, such as [2], or nodes4 for nodes of linear elements")
        if self.nodes7 is not None and self.nodes4 is not None:
            raise fault("nodes4", "is given together with nodes7", "keep one; write a second item for the other")
        return self


class PointForce(_OnNodes):
    """A force, N, while `timeInterval` (s) lasts; ours: without it, always."""

    force: Thrust = Field(examples=["[0, 8.5, 0]"])
    timeInterval: Annotated[tuple[Time, ...], listed(2, "a first and a last time", "[0, 1.0]")] | None = None

    @model_validator(mode="after")
    def _forwards(self) -> PointForce:
        if self.timeInterval is not None and not self.timeInterval[1] > self.timeInterval[0]:
            raise fault("timeInterval", "ends before it has begun", "give the earlier time first, such as [0, 1.0]")
        return self


class OneNodeSpring(_OnNodes):
    """A spring and damper from a node to where it began."""

    stiffness: Stiffness
    damping: Damping = 0.0


class TwoNodeSpring(_OnNodes):
    """Ours: a spring and damper between two nodes; `length` at rest, m, by default their first distance."""

    nodes7: Pair | None = None
    nodes4: Pair | None = None
    stiffness: Stiffness
    damping: Damping = 0.0
    length: Annotated[float, quantity("m", nonnegative=True, of="distance")] | None = None


class PointMass(_OnNodes):
    """A mass at nodes, kg; gravity acts on it."""

    mass: Annotated[float, quantity("kg", positive=True, of="mass")]


def _from_one(model: Any) -> Any:
    if model.id < 1:
        raise fault("id", "must be at least 1: 0 in BC_functions means none", "give 1")
    return model


class VelocityDefined(Model):
    """A motion by its rate: `velocityList` m/s at `timeList` s, linear between, held outside; from `pos0`, m."""

    id: Id
    pos0: Length = 0.0
    timeList: Annotated[tuple[Time, ...], listed(None, "times", "[0, 0.5, 1]")]
    velocityList: Annotated[tuple[Speed, ...], listed(None, "velocities", "[0, 0.5, 0]")]

    @model_validator(mode="after")
    def _rows(self) -> VelocityDefined:
        _from_one(self)
        if len(self.timeList) != len(self.velocityList):
            cause = f"has {len(self.velocityList)} entries, and timeList has {len(self.timeList)}"
            raise fault("velocityList", cause, "give a velocity for every time")
        for i, (earlier, later) in enumerate(itertools.pairwise(self.timeList), 1):
            if not later > earlier:
                cause = f"must be later than the one before ({earlier:g} s)"
                raise fault(("timeList", i), cause, "put the times in increasing order, each once")
        return self


class Function(Model):
    """Ours: a motion by any function of time; its value, m, is the degree of freedom itself."""

    id: Id
    value: Annotated[FunctionOfTime, time_function("m", of="position")] = Field(
        examples=["{ramp: {to: 2.0, over: 1.0}}"]
    )

    @model_validator(mode="after")
    def _names(self) -> Function:
        return _from_one(self)


KINDS: dict[str, type[Model]] = {
    "Node7Dof": Node7Dof,
    "Node4Dof": Node4Dof,
    "CableALEelement": CubicElement,
    "CableALElement": CubicElement,
    "CableALEelementLin": LinearElement,
    "CableALElementLin": LinearElement,
    "LagMultipl7": Multiplier7,
    "LagMultipl4": Multiplier4,
    "Penalty7": Penalty7,
    "Penalty4": Penalty4,
    "AugLagrange7": Penalty7,
    "AugLagrange4": Penalty4,
    "LinearCoupl": LinearCoupl,
    "PointForce": PointForce,
    "OneNodeSpring": OneNodeSpring,
    "TwoNodeSpring": TwoNodeSpring,
    "PointMass": PointMass,
    "Function_VelocityDefined": VelocityDefined,
    "Function": Function,
}
"""Model of each kind of item; the appendix spells the elements in one way and section 3.1 in another."""


class Item:
    """An item of the list: the key that it stands under, and its model."""

    __slots__ = ("kind", "model")

    def __init__(self, kind: str, model: Any) -> None:
        self.kind, self.model = kind, model


def _keeping(kind: str) -> Branch:
    return Branch(KINDS[kind], lambda model: Item(kind, model))


EXAMPLE = "{Node7Dof: {id: 0, xyz: [0, 0, 0], xyz_d: [1, 0, 0], BC: [1, 1, 1, 0, 0, 0, 1]}}"
ITEM = OneOf("a part of the cable", {kind: _keeping(kind) for kind in KINDS}, example=EXAMPLE)
Items = Annotated[tuple[Annotated[Any, ITEM], ...], listed(None, "nodes, elements and the rest", f"- {EXAMPLE[1:-1]}")]


class WrittenCable(Model):
    """The whole file."""

    title: str | None = None
    CableModelMaterial: Material = Field(examples=["{Gravity: [0, 0, -9.81]}"])
    CableModel: Items = Field(examples=[f"[{EXAMPLE}]"])
    Plots: Annotated[tuple[SubPlot, ...], Field()] = ()
    GeneralizedAlpha: CableSolver = Field(examples=["{type: G-alpha, rho_inf: 0.8, time_step: 0.005, time_end: 10}"])
