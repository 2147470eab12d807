"""What sensors say: rows in their order, health, motions smoothed from noise, waves, and values in SI."""
