"""Simulations as units of co-simulation by the FMI standard: what is written, and what runs in the host."""
