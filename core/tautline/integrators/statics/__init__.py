"""Equilibrium at rest: where it is sought, dynamic relaxation, stability, and what tolerance can be reached.

The compiled iteration itself is `tautline.integrators.newton_at_rest`: the compiled loop is made with it.
"""
