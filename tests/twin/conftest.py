"""Trials that take minutes run where they are asked for."""

import pytest


@pytest.fixture(autouse=True)
def long_trials_are_asked_for(request):
    """Skip a long trial unless ``-m long`` names it; short ones hold the same claims with fewer seeds."""
    if request.node.get_closest_marker("long") and "long" not in request.config.option.markexpr:
        pytest.skip("takes minutes: pytest -m long tests/twin")
