"""The lumped string by Kane's method: bodies, links and bending triples along a curve in space."""
