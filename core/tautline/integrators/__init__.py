"""Integrators over an abstract system of groups, and the compiled loop that runs them."""
