"""What the frames of a run mean: variables, headline figures, drilling, whirl, break-away, limits."""
