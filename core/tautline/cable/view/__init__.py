"""Figures and the look of cables in space."""
