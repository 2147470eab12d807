"""What a string is made of: pipe cut into lumps, mud in and around it, weight, strength, friction factors."""
