"""What makes a cable a beam: bending, its damping, curvature, twist, and welds where the section changes."""
