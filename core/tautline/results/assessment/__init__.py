"""What a run is judged by: its energy balance, its limits, and which figures are no more than rounding."""
