"""The map of a twin: what is written in it, the names of the scene that it may use, and the plan that it makes."""
