"""A page in a browser that shows a twin while it runs."""
