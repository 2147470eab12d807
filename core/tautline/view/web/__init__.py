"""A result as one web page, with the libraries that it carries."""
