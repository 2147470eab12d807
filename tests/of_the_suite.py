"""Which parameters of a test stay in the suite; the others claim more of the same, and are studies."""

import pytest


def kept(values, keep):
    """All values, in their order; those that ``keep`` does not hold are studies."""
    return [value if value in keep else studies(value)[0] for value in values]


def studies(*values):
    """Values as parameters of a study; those of several arguments are tuples."""
    several = [value if isinstance(value, tuple) else (value,) for value in values]
    return [pytest.param(*each, marks=pytest.mark.study) for each in several]
