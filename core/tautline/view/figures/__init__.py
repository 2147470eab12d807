"""Figures by matplotlib: style, curves, histories, spectra, waterfalls, orbits."""
