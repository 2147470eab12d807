"""What an earlier version of the program wrote is not taken for what this one means by the same numbers."""

import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest

import tautline
from tautline.live.errors import SimulationError
from tautline.results.errors import ResultError
from tautline.results.resumption import FRAMES_TOLD

HOIST = Path(__file__).parents[2] / "data" / "hoist.yaml"


@pytest.fixture(scope="module")
def scene():
    """A ship that heaves: its frame was told at the origin of the scene once, and is told at its pivot now."""
    return tautline.read(HOIST).replace({"solver.end": "0.5 s"})


@pytest.fixture(scope="module")
def kept(scene, tmp_path_factory):
    path = tmp_path_factory.mktemp("kept") / "hoist.nc"
    tautline.simulate(scene, path)
    return path


def test_a_result_says_how_frames_are_told_and_is_gone_on_with(scene, kept):
    assert tautline.Result.read(kept).attributes[FRAMES_TOLD] == "at their pivots"
    longer = scene.replace({"solver.end": "0.6 s"})
    assert tautline.simulate(longer, resume=tautline.Result.read(kept))["time"][-1] == pytest.approx(0.6)


def test_a_result_whose_frames_are_told_otherwise_is_refused(scene, kept, tmp_path):
    # the frames jumped by their pivots in one step: 856 N of 33 kN were off
    old = tmp_path / "old.nc"
    shutil.copyfile(kept, old)
    with h5py.File(old, "r+") as file:
        del file.attrs[FRAMES_TOLD]
    with pytest.raises(ResultError, match="tells the places of moving frames otherwise"):
        tautline.simulate(scene.replace({"solver.end": "0.6 s"}), resume=tautline.Result.read(old))


def test_a_state_whose_frames_are_told_otherwise_is_refused(scene, monkeypatch):
    with monkeypatch.context() as earlier:
        earlier.setattr("crane.model.build.FrameEntry", ())
        old = tautline.Simulation(scene).save()
    sim = tautline.Simulation(scene)
    with pytest.raises(SimulationError, match="another"):
        sim.restore(old)
    sim.restore(tautline.Simulation(scene).save())


def test_a_crane_without_moving_frames_has_nothing_to_say_of_them():
    still = tautline.read(HOIST).replace({"vessel.motion": {"heave": {"constant": 0.0}}, "solver.end": "0.05 s"})
    assert FRAMES_TOLD not in tautline.simulate(still).attributes


def test_a_result_of_a_simulation_that_only_named_a_still_frame_is_gone_on_with(scene):
    still = scene.replace({"vessel.motion": {"heave": {"constant": 0.0}}})
    sim = tautline.Simulation(still, inputs=["vessel.heave"])
    sim.advance(0.1)
    assert tautline.simulate(still, resume=sim.result)["time"][-1] == pytest.approx(0.5)


@pytest.mark.parametrize("frames", [[3], range(11)], ids=["one", "all"])
def test_a_result_with_times_that_are_no_numbers_is_refused_and_nothing_goes_on_from_it(scene, kept, frames, tmp_path):
    damaged = tmp_path / "damaged.nc"
    shutil.copyfile(kept, damaged)
    with h5py.File(damaged, "r+") as file:
        for frame in frames:
            file["time"][frame] = np.nan
    with pytest.raises(ResultError, match="is damaged"):
        tautline.simulate(scene.replace({"solver.end": "0.6 s"}), resume=tautline.Result.read(damaged))
