"""Compiled code: plain functions on floats and arrays."""
