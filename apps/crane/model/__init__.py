"""A crane scene compiled into a model, and how it is varied in a study."""
