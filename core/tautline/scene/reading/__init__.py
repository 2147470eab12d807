"""Files as they are read: text, YAML with the line of every key, columns of a CSV file, and which files a scene names.

Readers take a `document.Document` and `columns.Columns`.
"""
