"""A simulation that is stepped, driven, saved and linearised: what `tautline.Simulation` is made of."""
