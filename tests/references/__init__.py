"""Independent reference solutions, written from the physics and the thesis' data and not from Tautline's code."""
