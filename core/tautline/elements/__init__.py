"""Elements and loads that any scene may have."""
