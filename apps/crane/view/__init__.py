"""Figures and the look of a crane in space."""
