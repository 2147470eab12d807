"""Controllers in the loop of a simulation: each file runs by itself and is run by the tests."""
