"""Twins that many tests begin with are made once."""

import pytest
from twin.rehearsal import calm_rows, weight_twin

from tautline.twin.storage import load, save

SETTLED = 8.0
"""When the twin of a load that hangs in waves has long settled, s."""


@pytest.fixture(scope="session")
def settled(tmp_path_factory):
    """A function that gives a twin of the load in calm running which goes on at 8 s, and the rows that are left for it.

    Its first eight seconds are the same for everything that happens later: they are gone through once.
    """
    path = tmp_path_factory.mktemp("settled") / "twin.state"
    first = weight_twin(start="5 t")
    for stamp, readings in calm_rows():
        if stamp <= SETTLED:
            first.add(stamp, readings)
            first.work()
    save(first, path)

    def again(end=30.0):
        twin = weight_twin(start="5 t")
        begin = load(twin, path)
        return twin, [row for row in calm_rows() if begin < row[0] <= end]

    return again
