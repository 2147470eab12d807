"""From a scene to flat arrays in typed groups: numbering, elimination, band ordering."""
