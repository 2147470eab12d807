"""What tests of several commands begin with."""

import numpy as np
import pytest
from physics.cables.rope_text import PINNED, chain, scene
from view.made_up import moved


@pytest.fixture
def span(tmp_path, monkeypatch):
    """A result of two elements in the current folder."""
    p = np.linspace(0.0, 1.0, 3)
    items = chain(np.stack([p, 0 * p, 0 * p], axis=-1), p, {0: PINNED}, EA=1e3, EJ=0.1)
    moved(scene(items), path=tmp_path / "span.nc", frames=3)
    monkeypatch.chdir(tmp_path)
    return tmp_path
