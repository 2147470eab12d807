"""The corrector of the implicit methods: Newton's method over all rows, or over those that are not in balance."""
