"""What writes pages of the docs that hold no measured time, and what runs all that writes pages."""
