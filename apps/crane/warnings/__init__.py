"""What is large compared with what, before a run: scene, rope, winches."""
