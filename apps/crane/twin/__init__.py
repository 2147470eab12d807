"""What a twin of a crane knows beside its simulation: free motions of the load, the life of the rope."""
