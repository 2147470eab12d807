"""Equilibrium at rest: search, dynamic relaxation, stability, and what tolerance can be reached."""
