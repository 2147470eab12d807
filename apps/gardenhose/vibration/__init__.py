"""Small motions of a hose about its shape at rest: those of a speed of flow, and at many speeds in few shapes."""
