"""What a twin of a rig needs besides the estimate: states of the rig, stands, stick-slip at the surface, records."""
