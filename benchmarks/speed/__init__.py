"""How fast the program is: of runs, steps, commands and sweeps."""
