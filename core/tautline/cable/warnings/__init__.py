"""What is said of a cable scene before it runs: what is large against what, coarse lines, material that is driven."""

from tautline.cable.warnings.scene_warnings import figures, warnings

__all__ = ["figures", "warnings"]
