"""Factors of matrices: of a band, by columns and in blocks, and of a small dense one by LAPACK."""
