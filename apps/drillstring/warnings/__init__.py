"""What is said of a well and its string before anything runs: what is large against what, the hole, the block."""

from drillstring.warnings.hole_warnings import sharpest
from drillstring.warnings.scene_warnings import critical_step, describe, figures, soft_wall, too_heavy, warnings

__all__ = ["critical_step", "describe", "figures", "sharpest", "soft_wall", "too_heavy", "warnings"]
