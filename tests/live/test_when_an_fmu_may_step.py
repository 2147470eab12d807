"""Steps that a host of an FMU asks for where there are none: before the initialisation, and after the end."""

from pathlib import Path

import pytest
from of_the_suite import studies
from test_fmu import hosted

from tautline.live.fmu.writing import write_fmu

fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed")
pytest.importorskip("pythonfmu", reason="PythonFMU is not installed")

DATA = Path(__file__).parents[2] / "data"
H = 0.05


def _made(path, fmi):
    """An instance of an FMU that is as young as can be."""
    folder = fmpy.extract(path)
    told = fmpy.read_model_description(folder)
    from fmpy.fmi3 import FMU3Slave

    kind = fmpy.fmi2.FMU2Slave if fmi == 2 else FMU3Slave
    unit = kind(
        guid=told.guid, unzipDirectory=folder, modelIdentifier=told.coSimulation.modelIdentifier, instanceName="one"
    )
    unit.instantiate()
    return unit


def _steps(path, fmi):
    """Which of the steps of a host's life succeed: by when they are asked for."""
    unit, found = _made(path, fmi), {}

    def step(when, time):
        try:
            unit.doStep(currentCommunicationPoint=time, communicationStepSize=H)
            found[when] = True
        except Exception:
            found[when] = False

    step("made", 0.0)
    if fmi == 2:
        unit.setupExperiment(startTime=0.0)
    unit.enterInitializationMode()
    step("initialising", 0.0)
    unit.exitInitializationMode()
    step("initialised", 0.0)
    state = unit.getFMUState()
    unit.terminate()
    step("terminated", H)
    unit.setFMUState(state)
    step("back", H)
    unit.terminate()
    unit.reset()
    step("reset", 0.0)
    for when, time in (("anew", 0.0), ("twice", H)):
        unit.enterInitializationMode()
        unit.exitInitializationMode()
        step(when, time)
    return found


@pytest.mark.parametrize("fmi", [2, *studies(3)])
def test_a_step_succeeds_from_the_initialisation_to_the_end_and_nowhere_else(fmi, tmp_path):
    pytest.importorskip("pythonfmu3", reason="PythonFMU3 is not installed")
    write_fmu(DATA / "hoist.yaml", tmp_path / "hoist.fmu", [], ["winch.tension"], fmi=fmi)
    steps = hosted(_steps, str(tmp_path / "hoist.fmu"), fmi)
    assert {when for when, done in steps.items() if done} == {"initialised", "back", "anew"}
