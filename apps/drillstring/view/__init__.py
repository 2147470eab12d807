"""Figures and the look of a string in space; only these files import what draws."""
