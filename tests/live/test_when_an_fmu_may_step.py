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


def _with_a_state_of(path, other):
    """Whether a step succeeds after a state of another scene is set, and then after one of its own."""
    units = []
    for one in (path, other):
        unit = _made(one, 2)
        unit.setupExperiment(startTime=0.0)
        unit.enterInitializationMode()
        unit.exitInitializationMode()
        units.append(unit)
    unit, foreign = units
    own = unit.getFMUState()
    data = bytes(foreign.serializeFMUState(foreign.getFMUState()))
    unit.setFMUState(unit.deSerializeFMUstate(data))
    found = []
    for state in (None, own):
        if state is not None:
            unit.setFMUState(state)
        try:
            unit.doStep(currentCommunicationPoint=0.0, communicationStepSize=H)
            found.append(True)
        except Exception:
            found.append(False)
    return found


def test_after_a_state_of_another_scene_no_step_is_made_until_one_of_its_own_is_set(tmp_path):
    text = (DATA / "hoist.yaml").read_text(encoding="utf8")
    (tmp_path / "other.yaml").write_text(text.replace("elements_per_span: 4", "elements_per_span: 3"), encoding="utf8")
    for name, scene in (("one", DATA / "hoist.yaml"), ("other", tmp_path / "other.yaml")):
        write_fmu(scene, tmp_path / f"{name}.fmu", [], ["winch.tension"])
    found = hosted(_with_a_state_of, str(tmp_path / "one.fmu"), str(tmp_path / "other.fmu"))
    assert found == [False, True]
