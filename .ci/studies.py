"""Studies, which the tests leave out: all of them, or some from another place of their list each day.

python .ci/studies.py              all: `pytest -m study` on two processes
python .ci/studies.py --quick      those that begin within some seconds; over the days each comes to be the first
"""

from __future__ import annotations

import sys
import time
from datetime import date

import pytest

SECONDS = 40.0
"""Time after which none begins."""
STEP = 37
"""Places from one day to the next: a prime, so that neighbours, which are alike, are not taken one after another."""


class SomeOfThem:
    """Begins at the place of the day, and passes over what is left when the time is up."""

    def __init__(self, seconds: float) -> None:
        self.last = time.monotonic() + seconds

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Turn the list to the place of the day."""
        first = date.today().toordinal() * STEP % max(1, len(items))
        items[:] = items[first:] + items[:first]

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> bool | None:
        """Say what is run; once the time is up pass over what is left."""
        if time.monotonic() > self.last:
            return True
        print(item.nodeid, flush=True)
        return None


if __name__ == "__main__":
    if "--quick" in sys.argv[1:]:
        sys.exit(pytest.main(["-m", "study", "-x", "-s"], plugins=[SomeOfThem(SECONDS)]))
    sys.exit(pytest.main(["-m", "study", "-n", "2", "--dist", "worksteal"]))
