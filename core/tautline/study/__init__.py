"""Error against run time, and what breaks: how a scene is best solved, by evidence."""
