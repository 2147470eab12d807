"""From a scene to a model that runs, as lumps or as a beam, and how it is varied in a study."""
