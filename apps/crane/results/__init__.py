"""What the frames of a run mean: variables, the path of the rope, headline figures, power, limits."""
