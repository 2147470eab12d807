"""Small vibrations about a state: modes, complex eigenvalues, the longest explicit step, checks of the tangent."""
