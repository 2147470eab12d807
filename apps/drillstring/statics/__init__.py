"""A string at rest or moved slowly: torque and drag, buckling, the soft string, form finding and the exact rod."""
