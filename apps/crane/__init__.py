"""Ropes over sheaves: the application is being written on the cable elements that the core does not have yet."""
