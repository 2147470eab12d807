"""What is not known, from what sensors say: simulations side by side, a window of rows, and the estimate."""
