"""Hoses, risers and pipes that convey fluid: the application built on Tautline's solver."""
