"""Sources that many tests ask are hurried."""

import pytest

from tautline.twin.sources.opc_ua import holding


@pytest.fixture
def hurried(monkeypatch):
    """What stands still is repeated four times a second, and waited for a quarter as long: as true, and sooner told."""
    for name in ("RESTING", "UNTOLD", "WAIT"):
        monkeypatch.setattr(holding, name, 0.25 * getattr(holding, name))
