"""What limits the step and what breaks a scene: critical steps, conditioning, drift, extreme variants."""
