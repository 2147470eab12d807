"""Linear equations between degrees of freedom: Lagrange multipliers, penalty springs, and both at once."""
