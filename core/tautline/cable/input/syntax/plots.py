"""``Plots``: panels of curves, as a scene lists them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from tautline.cable.input.syntax.entries import Dof, Id, listed
from tautline.scene.choices.words import word
from tautline.scene.model import Model
from tautline.scene.refusal import fault

OF_CABLES = ("N", "kappa")
OF_NODES = ("r", "v", "rp", "p", "pdot")
WHAT = word(*OF_CABLES, *OF_NODES, aliases={"r'": "rp", "slope": "rp", "p'": "pdot", "curvature": "kappa"})
TEXTS = {
    "N": "axial force",
    "kappa": "curvature",
    "r": "position",
    "v": "velocity",
    "rp": "slope",
    "p": "material coordinate",
    "pdot": "material velocity",
}
AXES = "xyz"


class WrittenCurve(Model):
    """A curve of a cable element (N, kappa) or of a node (r, v, rp, p, pdot), whose DOF 1, 2, 3 are x, y, z.

    The slope's may also be numbered 4, 5, 6, as degrees of freedom are.
    """

    Cable: Id | None = None
    Node: Id | None = None
    DOF: Dof | None = None
    what: Annotated[Literal["N", "kappa", "r", "v", "rp", "p", "pdot"], WHAT] = Field(examples=["N"])
    label: str | None = None

    @model_validator(mode="after")
    def _subject(self) -> WrittenCurve:
        if self.Cable is not None and self.Node is not None:
            raise fault("Node", "is given together with Cable", "keep one of the two")
        if self.Cable is None and self.Node is None:
            raise fault("Cable", "is missing", "say whose curve it is: `Cable: 0` (an element's id) or `Node: 0`")
        known, subject = (OF_CABLES, "cable") if self.Cable is not None else (OF_NODES, "node")
        if self.what not in known:
            raise fault("what", f"is nothing that a {subject} has", f"known: {', '.join(known)}")
        if self.Cable is not None and self.DOF is not None:
            raise fault("DOF", "a cable has none: its axial force and curvature are single numbers", "remove it")
        if self.what in ("r", "v", "rp"):
            allowed = (1, 2, 3, 4, 5, 6) if self.what == "rp" else (1, 2, 3)
            if self.DOF is None:
                raise fault("DOF", "is missing", "add `DOF:`, 1 for x, 2 for y, 3 for z")
            if self.DOF not in allowed:
                raise fault("DOF", f"is no axis of {self.what}", "give 1 for x, 2 for y, 3 for z")
        return self

    @property
    def axis(self) -> int | None:
        """1, 2 or 3; None of what has no direction."""
        return None if self.DOF is None or self.what in ("p", "pdot") else (self.DOF - 1) % 3 + 1

    @property
    def text(self) -> str:
        """The label, or what it would be."""
        if self.label is not None:
            return self.label
        subject = f"cable {self.Cable}" if self.Cable is not None else f"node {self.Node}"
        axis = "" if self.axis is None else f" {AXES[self.axis - 1]}"
        return f"{subject}: {TEXTS[self.what]}{axis}"


class SubPlot(Model):
    """A panel."""

    SubPlot: Annotated[tuple[WrittenCurve, ...], listed(None, "curves", "[{Cable: 0, what: N, label: 'axial force'}]")]
