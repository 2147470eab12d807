"""Verbs that other applications do not have."""
