"""What a run does to its rope: bending cycles metre by metre, rainflow, passages over sheaves, slack and snap."""
