"""From a scene to groups: where everything stands in the vectors, the static start, estimates, damping of the mesh."""
