"""The parts of a cable scene as the builder meets them: plain numbers in SI, references checked, defaults filled in.

Every part carries `place`, its key path in the file (``("CableModel", 3, "Node7Dof")``), and `line`, for messages.
Degrees of freedom are numbered from one, as in the file: of a cubic node r (1-3), r' (4-6), p (7), of a linear node
r (1-3), p (4).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, NamedTuple

from tautline.arguments import MAPPING, check_given
from tautline.cable.input.syntax.nodal import NodalPart, item_of
from tautline.cable.input.syntax.solver import CableSolver
from tautline.scene.errors import Problem, SceneError, SceneWarning
from tautline.scene.identity.frozen import says_what_to_do
from tautline.scene.limits import Limit
from tautline.scene.model import WITHOUT_TEXT
from tautline.scene.reading.document import Document

Vector = tuple[float, float, float]
Place = tuple[str | int, ...]
Dof = tuple[int, int]
"""A degree of freedom: id of the node, number from one."""


class Node(NamedTuple):
    """A node: position m; slope dr/dp (of a cubic node); p its material coordinate, m, where the scene gives one.

    `held` and `functions` have an entry for each degree of freedom; functions are ids, 0 for none. A degree of freedom
    that is held and has a function follows it.
    """

    id: int
    kind: Literal[7, 4]
    position: Vector
    slope: Vector | None
    p: float | None
    held: tuple[bool, ...]
    functions: tuple[int, ...]
    line: int
    place: Place

    holds_no_function = True


class Element(NamedTuple):
    """A cable element: EA N, EJ N m^2, rhoA kg/m, damping c s (eq. 2.49), load N/m of unstretched length.

    ``compression`` false is a rope that carries no compression. ``quadrature`` of the axial term: None leaves
    the choice to the builder. ``spinless``: bending is damped as that of a rope that does not spin about its own line
    (`tautline.elements.beam.bending_damping`), else as that of one that spins as damps least. ``conveyed`` is a fluid
    that flows along the element's own curve: mass per length kg/m, and id of the motion of its p. ``length`` is
    unstretched, m, where the scene gives it; else the element is as long as it lies.
    """

    id: int
    kind: Literal["cubic", "linear"]
    nodes: tuple[int, int]
    EA: float
    EJ: float
    rhoA: float
    damping: float
    strain: Literal["green", "engineering"]
    compression: bool
    quadrature: Literal["gauss", "lobatto"] | None
    load: Vector
    line: int
    place: Place
    spinless: bool = False
    conveyed: tuple[float, int] | None = None
    length: float | None = None

    holds_no_function = True

    @property
    def axial_points(self) -> Literal["gauss", "lobatto"]:
        """Three Gauss points along a rope; with bending three Lobatto points, which do not lock."""
        if self.kind == "linear":
            return "gauss"
        return self.quadrature or ("lobatto" if self.EJ > 0.0 else "gauss")


@says_what_to_do
@dataclass(frozen=True, slots=True)
class Tie:
    """Two nodes made equal: what 0 r = r, 1 p = p, 2 r' = r'.

    ``offset``, m, is kept between the second position and the first: r_2 - r_1 = offset. ``stiffness`` of a penalty or
    an augmented multiplier is N/m (N m for slopes); None leaves it to the builder.
    """

    id: int
    method: Literal["multiplier", "penalty", "augmented"]
    nodes: tuple[int, int]
    what: Literal[0, 1, 2]
    stiffness: float | None
    offset: Vector
    line: int
    place: Place


@says_what_to_do
@dataclass(frozen=True, slots=True)
class Coupling:
    """A slave degree of freedom: slave = f0 + sum of factor times master; masters are (node, dof, factor)."""

    id: int
    slave: Dof
    f0: float
    masters: tuple[tuple[int, int, float], ...]
    line: int
    place: Place


@says_what_to_do
@dataclass(frozen=True, slots=True)
class Motion:
    """What a held degree of freedom follows.

    Either the integral from `pos0` (m, at t = 0) of a rate that is piecewise linear in time (`times` s, `velocities`
    m/s, held before the first and after the last), or of `rate`, a model of `tautline.scene.functions`, times
    `factor`; or `function`, a model whose value is the degree of freedom itself: `pos0` is then its value at t = 0.
    """

    id: int
    pos0: float
    times: tuple[float, ...]
    velocities: tuple[float, ...]
    function: Any | None
    line: int
    place: Place
    rate: Any | None = None
    factor: float = 1.0


@says_what_to_do
@dataclass(frozen=True, slots=True)
class Curve:
    """A line in a plot, of a cable element or of a node.

    ``what`` is ``N`` (axial force) or ``kappa`` (curvature) of a cable; ``r``, ``v``, ``rp`` (slope) of a node, with
    `dof` 1, 2 or 3 for x, y, z; ``p`` or ``pdot`` of a node, whose `dof` is None.
    """

    cable: int | None
    node: int | None
    dof: int | None
    what: Literal["N", "kappa", "r", "v", "rp", "p", "pdot"]
    label: str
    line: int
    place: Place


@says_what_to_do
@dataclass(frozen=True)
class CableScene:
    """All that a run needs to know; parts in the order of the file, references checked.

    Attributes
    ----------
    gravity : (3,) m/s^2
    nodal : tuple
        Items on nodes, kind by kind in the order of their registration.
    plots : tuple of panels, each a tuple of Curve
    text, path : str, Path
        The file.
    warnings : tuple of SceneWarning
        Liberties that the reader took; `tautline.cable.warnings` has more to say.
    document : Document
        For messages, and for a scene with other values.
    made_by : callable or None
        What made the scene of its document; None for one that was put together in Python.
    limits : tuple of Limit
        By which a run is judged.
    """

    title: str | None
    gravity: Vector
    nodes: tuple[Node, ...]
    elements: tuple[Element, ...]
    ties: tuple[Tie, ...]
    couplings: tuple[Coupling, ...]
    nodal: tuple[NodalPart, ...]
    motions: tuple[Motion, ...]
    plots: tuple[tuple[Curve, ...], ...]
    solver: CableSolver
    warnings: tuple[SceneWarning, ...]
    document: Document = field(repr=False, compare=False)
    made_by: Callable[[Document], CableScene] | None = field(default=None, repr=False, compare=False)
    limits: tuple[Limit, ...] = ()

    @property
    def text(self) -> str:
        """The text of the file."""
        return self.document.text

    @property
    def path(self) -> Path:
        """The file, as it was named."""
        return self.document.path

    @property
    def forces(self) -> tuple[NodalPart, ...]:
        """The point forces."""
        return self.items_of("PointForce")

    @property
    def anchors(self) -> tuple[NodalPart, ...]:
        """The springs to where a node began."""
        return self.items_of("OneNodeSpring")

    @property
    def springs(self) -> tuple[NodalPart, ...]:
        """The springs between two nodes."""
        return self.items_of("TwoNodeSpring")

    @property
    def masses(self) -> tuple[NodalPart, ...]:
        """The point masses."""
        return self.items_of("PointMass")

    def items_of(self, key: str) -> tuple[NodalPart, ...]:
        """Items on nodes of one kind."""
        return tuple(part for part in self.nodal if part.key == key)

    @property
    def heavy_nodes(self) -> tuple[int, ...]:
        """Ids of the nodes that an item gives a mass, once for each such item."""
        return tuple(node for part in self.nodal if item_of(part).mass(part) > 0.0 for node in part.nodes)

    def replace(self, changes: Mapping[str, Any], origin: str = "replace") -> CableScene:
        """The scene as it would be read with other values in its file: see `tautline.scene.model.Scene.replace`.

        Raises
        ------
        SceneError
            For an unknown key, with the nearest, and for a scene that is not sound with the new values.
        """
        check_given(changes=(changes, MAPPING))
        if self.made_by is None:
            raise SceneError([self.problem((), *WITHOUT_TEXT)])
        return self.made_by(self.document.changed(changes, origin))

    def problem(self, place: Place, cause: str, cure: str = "") -> Problem:
        """Build a problem at a key path, such as ``(*node.place, "BC")``, for a check that the builder makes."""
        return self.document.problem(place, cause, cure)


HOW_SOLVED = (
    "method", "rho_inf", "alpha_m", "alpha_f", "tolerance", "max_iterations", "step", "end", "plotpoints", "skip_vtk",
    "projection", "stabilise", "control", "step_error", "newton", "frequency", "accuracy",
)  # fmt: skip
"""Fields of ``GeneralizedAlpha`` that say how a scene is solved, and what is kept."""
PARTS = ("nodes", "elements", "ties", "couplings", "nodal", "motions")
BESIDES_MODEL = frozenset(
    {"title", "plots", "warnings", "document", "made_by", "limits", *(f"solver.{name}" for name in HOW_SOLVED)}
    | {f"{part}.{where}" for part in PARTS for where in ("line", "place")}
)
"""What does not count in a cable's model (`tautline.scene.identity`): where things stand in the file, too."""
