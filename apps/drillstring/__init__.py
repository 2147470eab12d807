"""Drill strings in deviated wells: the application built on Tautline's solver."""
