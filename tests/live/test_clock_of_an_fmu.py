"""What an FMU says to a host whose time begins elsewhere than the scene's, and of steps that are none."""

import re
import zipfile
from pathlib import Path

import pytest

from tautline.errors import TautlineError
from tautline.live.fmu.unit import Core
from tautline.live.fmu.writing import write_fmu

pytest.importorskip("pythonfmu", reason="PythonFMU is not installed")

DATA = Path(__file__).parents[2] / "data"


@pytest.fixture(scope="module")
def resources(tmp_path_factory):
    """The resources of an FMU of a hoist on a vessel that heaves."""
    folder = tmp_path_factory.mktemp("unit")
    write_fmu(DATA / "hoist.yaml", folder / "hoist.fmu", ["vessel.heave"], ["winch.tension", "winch.pay_out"])
    zipfile.ZipFile(folder / "hoist.fmu").extractall(folder)
    return folder / "resources"


def started(resources, begin):
    core = Core(resources)
    core.start_at(begin)
    core.initialise()
    core.step(begin, 0.5)
    return core


@pytest.mark.parametrize("length", [0.0, -0.1, float("nan"), float("inf")])
def test_a_communication_step_that_is_none_is_refused_in_the_words_of_a_host(resources, length):
    core = started(resources, 100.0)
    with pytest.raises(TautlineError, match=r"a communication step of .* s; give one above zero") as told:
        core.step(100.5, length)
    assert "restore()" not in str(told.value) and "0.5 s" not in str(told.value)
    core.step(100.5, 0.1)  # and the unit goes on


@pytest.mark.parametrize(("begin", "clock"), [(100.0, "100 s less"), (-40.0, "40 s more"), (0.0, "")])
def test_a_failed_step_says_whose_time_it_tells(resources, begin, clock):
    core = started(resources, begin)
    core.set("vessel.heave", 1.0e6)
    for time in (begin + 0.5, begin + 1.0):  # the failure, and what a host that goes on is told
        with pytest.raises(TautlineError, match=re.escape(" 0.513")) as told:
            core.step(time, 0.5)
        assert ("the scene's time" in str(told.value)) == bool(clock) and clock in str(told.value)


def test_numbers_of_an_fmu_are_those_of_the_scene_as_it_writes_them(resources):
    core = Core(resources)
    assert core.get("boom tip.bearing_friction") == 0.005
    core.initialise()
    assert str(core.get("winch.pay_out")) == "0.0"
