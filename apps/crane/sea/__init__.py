"""What moves a crane: frames with their derivatives, vessels by functions, records or waves, heave compensation."""
