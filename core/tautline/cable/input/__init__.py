"""Cable scenes as they are read: from the items of a file to the parts that the builder takes."""
