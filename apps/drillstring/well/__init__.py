"""The hole in space: planned sections, surveys by minimum curvature, the curve with its frame, and points beside it."""
