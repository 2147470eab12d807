"""The motion that a hose ends in: paths of its tip, swings, limit cycles, and a stored run as figures want it."""
