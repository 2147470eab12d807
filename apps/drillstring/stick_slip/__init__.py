"""The map of stick-slip over rotary speed and weight on bit."""
