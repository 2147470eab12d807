"""`rao` of a spectrum: a displacement or a rotation per metre of wave, in its own unit, and never too large."""

import math
import pickle

import numpy as np
import pytest
from figures.synthetic_crane import one_fall

from crane.assembly.prepared import motion_of
from crane.warnings import doubts_of_motion
from tautline.kernels.time_function import sample
from tautline.scene.errors import SceneError
from tautline.system.time_functions import FunctionRequest, compile_functions


def afloat(name, sum_of=False, **more):
    sea = {"spectrum": {"significant_height": 2.0, "peak_period": 9.0, "ramp": 2.0} | more}
    return one_fall(vessel={"reference": [0, 0, 0], "motion": {name: {"sum": [sea]} if sum_of else sea}})


def rao(name, written):
    return getattr(afloat(name, rao=written).vessel.motion, name).rao


def told(scene):
    return [(key, text) for key, text in doubts_of_motion(scene) if key.endswith("rao")]


def test_a_response_has_the_unit_of_its_motion_over_a_metre_and_a_plain_number_is_in_si():
    assert rao("pitch", "1 deg/m") == pytest.approx(math.pi / 180.0, rel=1e-15)
    assert (rao("roll", 0.02), rao("roll", "0.02 rad/m")) == (0.02, 0.02)
    assert (rao("heave", 0.6), rao("heave", "0.6 m/m"), rao("heave", "60 %")) == (0.6, 0.6, pytest.approx(0.6))


@pytest.mark.parametrize(
    ("name", "written", "cause"),
    [
        ("heave", "1 deg", "not the unit of a displacement per metre of wave"),
        ("heave", "1 deg/m", "not the unit of a displacement per metre of wave"),
        ("pitch", "1 deg", "not the unit of a rotation per metre of wave; expected a rotation .* such as 2 deg/m"),
        ("pitch", "1 m/m", "not the unit of a rotation per metre of wave"),
    ],
)
def test_a_response_in_the_unit_of_something_else_is_refused(name, written, cause):
    """A heave of 1 deg was read as 17 mm per metre of wave."""
    with pytest.raises(SceneError, match=cause):
        afloat(name, rao=written)


def test_no_angle_is_taken_for_a_plain_number():
    with pytest.raises(SceneError, match="'deg' is not the unit of a plain number"):
        afloat("heave", gamma="3 deg")


@pytest.mark.parametrize("sum_of", [False, True])
def test_a_response_larger_than_any_vessels_is_refused_as_in_a_file(sum_of):
    place = r"\.sum\[0\]" if sum_of else ""
    with pytest.raises(SceneError, match=rf"vessel.motion.pitch{place}.spectrum.rao.* = -1.5: is more .*, 1 rad/m"):
        motion_of(afloat("pitch", sum_of, rao=-1.5))
    with pytest.raises(SceneError, match=rf"vessel.motion.heave{place}.spectrum.rao.* = 40: is more .*, 30 m/m"):
        motion_of(afloat("heave", sum_of, rao=40))
    motion_of(afloat("heave", sum_of, rao=1.5))


def test_half_a_radian_per_metre_is_told_in_degrees_where_the_sea_is_of_metres():
    """Half a degree was meant; the rms of the pitch is Hs/4 times the response, 14 deg."""
    scene = afloat("pitch", rao=0.5, ramp=0.0, components=400)
    ((key, text),) = told(scene)
    assert key == "vessel.motion.pitch.spectrum.rao" and "28.6 deg per metre of wave" in text
    functions = compile_functions([FunctionRequest(scene.vessel.motion.pitch, end=3600.0)])
    pitch = np.degrees(sample(functions, 0, np.arange(0.0, 3600.0, 0.5))[:, 0])
    assert np.std(pitch) == pytest.approx(math.degrees(0.5) * 2.0 / 4.0, rel=0.05)
    assert "28.6 deg to either side in the significant wave" in text and 2.0 * np.std(pitch) == pytest.approx(
        28.6, 0.05
    )


@pytest.mark.parametrize(
    ("name", "sea"),
    [
        ("pitch", {"rao": "3 deg/m"}),
        ("heave", {"rao": 1.2}),
        ("roll", {"rao": 0.9, "significant_height": 0.05, "peak_period": 1.2}),
    ],
)
def test_responses_of_ships_and_of_models_in_a_tank_are_not_told(name, sea):
    assert told(afloat(name, **sea)) == []


def test_a_spectrum_of_a_unit_goes_to_another_process_as_it_is():
    motion = afloat("roll", rao="2 deg/m").vessel.motion
    assert pickle.loads(pickle.dumps(motion)) == motion
