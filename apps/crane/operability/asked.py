"""What an operability study asks of a scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from crane.operability.conditions import Condition
from crane.operability.scatter import Scatter


@dataclass(frozen=True)
class Asked:
    """What is asked of a scene.

    Attributes
    ----------
    conditions : sequence of Condition
    seeds : sequence of int
    duration, simulated, lead : float
        That is asked about, of each run, and before it, in which the sea grows and nothing counts, s.
    limits : sequence of str
        As they are written.
    share, confidence : float
        Percentile and confidence, 0 to 1.
    compared : str
        ``most_probable`` or ``percentile``.
    scatter : Scatter or None
    constant : float or None
        Of the S-N curve.
    bare : bool
        Whether the duration was written without a unit.
    not_reached : sequence of str
        Notes on ranges whose step does not meet their end.
    """

    conditions: Sequence[Condition]
    seeds: Sequence[int]
    duration: float
    simulated: float
    limits: Sequence[str]
    share: float = 0.9
    confidence: float = 0.9
    compared: str = "percentile"
    scatter: Scatter | None = None
    constant: float | None = None
    lead: float = 100.0
    bare: bool = True
    not_reached: Sequence[str] = ()
