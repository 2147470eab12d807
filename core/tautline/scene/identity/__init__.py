"""What a scene is: the hash of what it says, when two say the same, and that it stays as it is."""
