"""The garden hose of the thesis' Case 3."""
