"""Statistics of stationary processes: what is accumulated of a run, and extremes by extreme value theory."""
