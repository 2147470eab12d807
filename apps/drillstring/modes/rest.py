"""A cut string at rest, of either model, as natural modes are asked of it."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from drillstring.modes.bha import Cut
from drillstring.modes.string_at_rest import StringAtRest, Vibrations
from drillstring.scene.scene import BEAM
from drillstring.string.lumps import Lumps
from drillstring.well.wellbore import Wellbore


class Rest(Protocol):
    """A string in static equilibrium: its mesh, the wall's forces at lumps or nodes (n + 1,) N, and its modes."""

    @property
    def well(self) -> Wellbore:
        """The hole."""
        ...

    @property
    def lumps(self) -> Lumps:
        """The mesh."""
        ...

    @property
    def normal(self) -> np.ndarray:
        """Forces of the wall."""
        ...

    @property
    def pinned(self) -> bool:
        """Whether the bit is held on the axis."""
        ...

    def lateral(self, at: int, fixed: np.ndarray, highest: float) -> Vibrations:
        """Modes below a lump or node, some held sideways."""
        ...

    def along(self, kind: str, highest: float) -> tuple[np.ndarray, np.ndarray]:
        """Torsional or axial modes: frequencies and shapes."""
        ...


def rest_of(mesh: Cut) -> Rest:
    """Find the rest of a cut string; raises SceneError, and StoppedEarly where it finds none."""
    if mesh.scene.model.kind == BEAM:
        # Only a scene of a beam needs a beam's code.
        from drillstring.modes.beam_at_rest import BeamAtRest

        return BeamAtRest.of(mesh)
    return StringAtRest.of(mesh)
