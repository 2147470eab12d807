"""What is said of a crane before it runs: what is large against what, starts, loops of tension, loads drawn askew."""

from crane.warnings.scene_warnings import (
    describe,
    doubts_of_motion,
    driven_functions,
    figures,
    fleet_angle,
    rope_warnings,
    shortest,
    warnings,
)

__all__ = [
    "describe",
    "doubts_of_motion",
    "driven_functions",
    "figures",
    "fleet_angle",
    "rope_warnings",
    "shortest",
    "warnings",
]
