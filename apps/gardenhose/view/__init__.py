"""Figures and the look of a hose in space, and the curves that they are drawn from."""
