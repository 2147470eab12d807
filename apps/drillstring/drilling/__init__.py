"""What acts at the ends of a string: the top drive, and the bit with weight, torque and rock."""
