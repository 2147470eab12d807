"""Tables: what a run or a search found, as rows with units, in CSV and NetCDF."""
