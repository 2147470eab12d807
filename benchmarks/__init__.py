"""Measurements, and the pages that they are written into: `python -m benchmarks.ROOM.NAME`, from the checkout."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
"""The checkout."""
