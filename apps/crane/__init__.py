"""Cranes: ropes over sheaves, winches and ships; the application built on Tautline's solver."""
