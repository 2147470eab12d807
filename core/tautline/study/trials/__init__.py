"""Runs of a scene for a study: settings, histories, and how far two runs are apart."""
