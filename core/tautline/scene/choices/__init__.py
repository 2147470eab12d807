"""Choices in a scene: a word that is one of several, and a value that may be written in several ways."""
