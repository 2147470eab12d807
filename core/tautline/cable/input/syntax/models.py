"""The list under ``CableModel``, as it stands in a file: one model for each kind of item in the thesis' Appendix A.

Marked *ours* is what the appendix does not have. These models check each item by itself;
`tautline.cable.input.references` checks them against each other and makes the parts that the builder reads.
"""

from __future__ import annotations

import itertools
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from tautline.cable.input.syntax import nodal_items  # noqa: F401  (its items are registered as it is imported)
from tautline.cable.input.syntax.entries import (
    Acceleration,
    AxialStiffness,
    BendingStiffness,
    DampingTime,
    Dof,
    Flags4,
    Flags7,
    Functions4,
    Functions7,
    Id,
    Length,
    Load,
    MassPerLength,
    Pair,
    Position,
    Slope,
    Speed,
    Stiffness,
    Time,
    listed,
)
from tautline.cable.input.syntax.nodal import NODAL
from tautline.cable.input.syntax.plots import SubPlot
from tautline.cable.input.syntax.solver import CableSolver
from tautline.scene.choices.branches import Branch, OneOf
from tautline.scene.choices.words import word
from tautline.scene.extensions import load_extensions
from tautline.scene.functions import FunctionOfTime, time_function
from tautline.scene.limits import Limits
from tautline.scene.model import Model, Switch, Whole
from tautline.scene.refusal import fault
from tautline.scene.values.magnitude import SMALLEST
from tautline.scene.values.quantity import quantity


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

    Ours: `strain` (green, eq. 2.52, or engineering, eq. 2.154), `compression` (false: none) and `load`, a dead load
    in N per metre of unstretched cable.
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


MOST_OF_A_LINE = 100_000
"""Elements that one line may have."""


class Line(_Element):
    """Ours: a cable as one item. Its `elements` are numbered on from `id`, the nodes between its ends from `between`.

    Without `between` these follow all other nodes of the file. They hold their material. `length` is unstretched, m, by
    default the distance of the ends. A shorter line is drawn straight and stretched, a longer one hangs.
    """

    nodes7: Pair | None = Field(default=None, examples=["[0, 1]"])
    nodes4: Pair | None = None
    elements: Annotated[Whole, Field(ge=1, le=MOST_OF_A_LINE, examples=["100"])]
    between: Id | None = None
    length: Annotated[float, quantity("m", positive=True, of="length")] | None = None
    quadrature: Annotated[Literal["gauss", "lobatto"], word("gauss", "lobatto")] | None = None

    @model_validator(mode="after")
    def _ends(self) -> Line:
        if self.nodes7 is None and self.nodes4 is None:
            raise fault("nodes7", "is missing", "name both ends, such as [0, 1]; nodes4 for linear elements")
        if self.nodes7 is not None and self.nodes4 is not None:
            raise fault("nodes4", "is given together with nodes7", "keep one: cubic elements or linear ones")
        if self.nodes4 is not None and self.EJ != 0.0:
            raise fault("EJ", "linear elements have no bending", "set EJ to 0, or use nodes7 with Node7Dof")
        if self.nodes4 is not None and self.quadrature is not None:
            raise fault("quadrature", "linear elements have none to choose", "remove it, or use nodes7 with Node7Dof")
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


def _from_one(model: Any) -> Any:
    if model.id < 1:
        raise fault("id", "must be at least 1: 0 in BC_functions means none", "give 1")
    return model


class VelocityDefined(Model):
    """A motion by its rate: `velocityList` m/s at `timeList` s, linear between, held before and after; from `pos0`, m.

    After the last time the motion goes on at the last rate: end with 0 to stop it.
    """

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
            if later - earlier < SMALLEST:
                raise fault(("timeList", i), "is no time after the one before", "give times that are some steps apart")
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
    "CableLine": Line,
    "LagMultipl7": Multiplier7,
    "LagMultipl4": Multiplier4,
    "Penalty7": Penalty7,
    "Penalty4": Penalty4,
    "AugLagrange7": Penalty7,
    "AugLagrange4": Penalty4,
    "LinearCoupl": LinearCoupl,
    **{key: item.model for key, item in NODAL.items()},
    "Function_VelocityDefined": VelocityDefined,
    "Function": Function,
}
"""Model of each kind of item; the appendix spells the elements in one way and section 3.1 in another."""
OWN = frozenset(KINDS) - frozenset(NODAL)
"""Kinds that are no items on nodes."""


class Item:
    """An item of the list: the key that it stands under, and its model."""

    __slots__ = ("kind", "model")

    def __init__(self, kind: str, model: Any) -> None:
        self.kind, self.model = kind, model


def _keeping(kind: str) -> Branch:
    """How an item of a kind is read; the model is looked up when the schema is made."""
    return Branch(KINDS[kind], lambda model: Item(kind, model))


EXAMPLE = "{Node7Dof: {id: 0, xyz: [0, 0, 0], xyz_d: [1, 0, 0], BC: [1, 1, 1, 0, 0, 0, 1]}}"
ITEM = OneOf("a part of the cable", {kind: _keeping(kind) for kind in KINDS}, example=EXAMPLE)
Items = Annotated[tuple[Annotated[Any, ITEM], ...], listed(None, "nodes, elements and the rest", f"- {EXAMPLE[1:-1]}")]


class WrittenCable(Model):
    """The whole file; ours: `title` and `limits`."""

    title: str | None = None
    CableModelMaterial: Material = Field(examples=["{Gravity: [0, 0, -9.81]}"])
    CableModel: Items = Field(examples=[f"[{EXAMPLE}]"])
    Plots: tuple[SubPlot, ...] = Field((), examples=["[{SubPlot: [{Cable: 0, what: N}]}]"])
    GeneralizedAlpha: CableSolver = Field(examples=["{type: G-alpha, rho_inf: 0.8, time_step: 0.005, time_end: 10}"])
    limits: Limits = ()


def file_model() -> type[WrittenCable]:
    """The model of a file, with all kinds of item that are registered by now.

    Raises
    ------
    ValueError
        If an item has the name of something that is no item on nodes.
    """
    load_extensions()
    new = {key: item.model for key, item in NODAL.items() if KINDS.get(key) is not item.model}
    if new:
        if taken := sorted(OWN & new.keys()):
            raise ValueError(f"{taken[0]}: the cable's own syntax has this name; choose another for the item")
        KINDS.update(new)
        ITEM.keyed.update({key: _keeping(key) for key in new})
        WrittenCable.model_rebuild(force=True)
    return WrittenCable
