"""Tables with a header, line by line: cells, where columns are, headers that come again, rows in doubt."""
