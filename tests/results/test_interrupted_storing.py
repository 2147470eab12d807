"""Ctrl-C while frames are being stored: each is stored once, and the run can be gone on with."""

import os
import signal
from pathlib import Path

import numpy as np
import pytest

import tautline
from tautline.application.installed import Installed
from tautline.integrators.status import Interrupted
from tautline.results import store
from tautline.simulation import simulate

HOIST = Path(__file__).parents[2] / "data" / "hoist.yaml"


@pytest.mark.parametrize("batch", [1, 2])
def test_frames_of_a_batch_in_which_ctrl_c_falls_are_stored_once(tmp_path, monkeypatch, batch):
    publish, count = store._Copies.publish, []

    def interrupted(self):
        publish(self)
        count.append(self)
        if len(count) == batch:
            os.kill(os.getpid(), signal.SIGINT)

    monkeypatch.setattr(store._Copies, "publish", interrupted)
    scene = tautline.read(HOIST)
    application = Installed().of(scene)
    scene = application.with_overrides(scene, end=10.0)
    monkeypatch.setattr("tautline.run.BATCH", 0.0)
    with pytest.raises(Interrupted):
        simulate(application.build(scene), tmp_path / "part.nc")
    part = tautline.Result.read(tmp_path / "part.nc")
    assert part.attributes["status"] == "interrupted"
    assert np.all(np.diff(part["time"]) > 0.0)
    monkeypatch.undo()
    whole = simulate(application.build(scene), tmp_path / "whole.nc", resume=part)
    alone = simulate(application.build(scene))
    assert np.array_equal(whole["time"], alone["time"])
    assert np.array_equal(whole["body_position"], alone["body_position"])
