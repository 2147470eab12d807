"""Taut rope over wheels in space: tangent lines, wrap, fleet angles, and how they change."""
