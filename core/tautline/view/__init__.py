"""Pictures: the only importers of matplotlib."""
