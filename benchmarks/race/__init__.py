"""The same scenes by Tautline and by other programs."""
