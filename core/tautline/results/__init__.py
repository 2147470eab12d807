"""What a run leaves behind: a NetCDF file that is whole at every moment, and the object that reads it."""
