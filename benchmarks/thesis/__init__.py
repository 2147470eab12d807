"""The tables and figures of G. Fotland's thesis (2022) made again."""
