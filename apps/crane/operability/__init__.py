"""What a crane can do in which sea: storms, limits, allowable significant wave heights, fatigue."""
