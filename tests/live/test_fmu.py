"""Scenes as FMUs, in FMPy as the host."""

import json
import multiprocessing
import os
import zipfile
from contextlib import suppress
from pathlib import Path
from queue import Empty

import numpy as np
import pytest

import tautline
from tautline.cli.run import run as run_command
from tautline.cli.verbs import make_app
from tautline.live.errors import UnknownName
from tautline.live.fmu.writing import write_fmu

fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed")
pytest.importorskip("pythonfmu", reason="PythonFMU is not installed")

DATA = Path(__file__).parents[2] / "data"

INPUTS, OUTPUTS = ["winch.pay_out_speed"], ["payload.position", "winch.tension"]
H = 0.05


@pytest.fixture(scope="module")
def hoist(tmp_path_factory):
    path = tmp_path_factory.mktemp("fmu") / "hoist.fmu"
    needs = write_fmu(DATA / "hoist.yaml", path, INPUTS, OUTPUTS)
    assert any("pip install" in line for line in needs)
    return path


def unit_of(path, name="one"):
    """An instance of an FMU that is ready to be initialised, and its value references by name."""
    folder = fmpy.extract(str(path))
    told = fmpy.read_model_description(folder)
    unit = fmpy.fmi2.FMU2Slave(
        guid=told.guid, unzipDirectory=folder, modelIdentifier=told.coSimulation.modelIdentifier, instanceName=name
    )
    unit.instantiate()
    unit.setupExperiment(startTime=0.0)
    unit.enterInitializationMode()
    return unit, {variable.name: variable.valueReference for variable in told.modelVariables}


def _child(queue, act, given):
    try:
        queue.put((act(*given), None))
    except Exception as error:
        queue.put((None, f"{type(error).__name__}: {error}"))
    queue.close()
    queue.join_thread()
    os._exit(0)  # the library of an FMU in Python does not survive the end of its host


FORKED = "fork" if hasattr(os, "fork") else "spawn"


def hosted(act, *given, way=FORKED):
    """What a function gives in a process of its own, which is the host of the FMUs that it loads.

    One that is forked has imported what this one has, which takes longer than most of what a host does.
    """
    context = multiprocessing.get_context(way)
    queue = context.Queue()
    process = context.Process(target=_child, args=(queue, act, given))
    process.start()
    for _ in range(300):
        with suppress(Empty):
            found, fault = queue.get(timeout=1)
            break
        assert process.exitcode in (None, 0), f"the host died: {process.exitcode}"
    else:
        raise AssertionError("the host says nothing")
    process.join()
    assert fault is None, fault
    return found


def speed(t):
    x = min(t, 1.0)
    return -2.0 * x**3 * (10.0 - 15.0 * x + 6.0 * x * x)


@pytest.mark.parametrize(
    ("name", "inputs", "outputs"),
    [
        ("hoist", ["winch.pay_out", "vessel.heave"], ["payload.position", "max_tension", "boom tip.force"]),
        ("jwell", ["top.block_speed"], ["hook_load", "bit.position"]),
        ("hose", ["water.speed"], ["tip.position"]),
        ("reeled_span", ["function 1.rate"], ["node 4.position"]),
    ],
)
def test_fmpy_finds_nothing_to_complain_of_in_any_application(name, inputs, outputs, tmp_path):
    path = tmp_path / f"{name}.fmu"
    write_fmu(DATA / f"{name}.yaml", path, inputs, outputs)
    from fmpy.validation import validate_fmu

    assert validate_fmu(str(path)) == []
    told = fmpy.read_model_description(str(path))
    names = {variable.name for variable in told.modelVariables}
    assert set(inputs) <= names and f"{outputs[0]}" in {n.split("[")[0] for n in names}
    with zipfile.ZipFile(path) as file:
        assert "resources/scene/scene.yaml" in file.namelist() and "documentation/index.txt" in file.namelist()


def test_no_value_of_a_model_description_is_minus_zero(hoist):
    starts = [str(one.start) for one in fmpy.read_model_description(str(hoist)).modelVariables if one.start]
    assert starts and not [start for start in starts if float(start) == 0.0 and start.startswith("-")]


@pytest.fixture(scope="module")
def fed(hoist):
    """Speeds by time, and what the unit of FMI 2 gives where it is fed with them."""
    table = [(float(t), speed(t)) for t in np.arange(0.0, 2.0 + 0.5 * H, H)]
    return table, hosted(_fed, str(hoist), table)


def _fed3(path, table):
    """The same in FMI 3.0, with a state that is taken and set on the way."""
    folder = fmpy.extract(path)
    told = fmpy.read_model_description(folder)
    from fmpy.fmi3 import FMU3Slave

    unit = FMU3Slave(
        guid=told.guid, unzipDirectory=folder, modelIdentifier=told.coSimulation.modelIdentifier, instanceName="three"
    )
    unit.instantiate()
    unit.enterInitializationMode(startTime=0.0)
    unit.exitInitializationMode()
    reference = {variable.name: variable.valueReference for variable in told.modelVariables}
    keys, found = [reference[f"payload.position[{c}]"] for c in range(3)] + [reference["winch.tension"]], []
    for t, value in table[1:]:
        state = unit.getFMUState()
        for _ in range(2):
            unit.setFMUState(state)
            unit.setFloat64([reference["winch.pay_out_speed"]], [value])
            unit.doStep(currentCommunicationPoint=t - H, communicationStepSize=H)
        found.append(list(unit.getFloat64(keys)))
    return found


def _both(path, path3, table):
    return _fed(path, table), _fed3(path3, table)


def test_fmi_3_validates_and_gives_what_fmi_2_gives_of_the_same_file_name_in_the_same_process(hoist, fed, tmp_path):
    pytest.importorskip("pythonfmu3", reason="PythonFMU3 is not installed")
    from fmpy.validation import validate_fmu

    path = tmp_path / hoist.name
    write_fmu(DATA / "hoist.yaml", path, INPUTS, OUTPUTS, fmi=3)
    assert validate_fmu(str(path)) == []
    assert fmpy.read_model_description(str(path)).coSimulation.canHandleVariableCommunicationStepSize
    table, found = fed[0][:21], fed[1][:20]
    assert hosted(_both, str(hoist), str(path), table) == (found, found)


def _started_late(path, start):
    found = fmpy.simulate_fmu(
        path, start_time=start, stop_time=start + 0.5, output_interval=H, output=["winch.tension"], validate=False
    )
    return found["winch.tension"].tolist()


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_host_may_begin_at_another_time_than_zero(fmi, tmp_path):
    path = tmp_path / "late.fmu"
    write_fmu(DATA / "hoist.yaml", path, INPUTS, OUTPUTS, fmi=fmi)
    whole = tautline.simulate(DATA / "hoist.yaml", end=0.5)["drum_tension"][:, 0]
    assert np.allclose(hosted(_started_late, str(path), 10.0), whole, rtol=1e-9)


def _fed(path, table):
    unit, reference = unit_of(path)
    unit.exitInitializationMode()
    keys, found = [reference[f"payload.position[{c}]"] for c in range(3)] + [reference["winch.tension"]], []
    for t, value in table[1:]:
        unit.setReal([reference["winch.pay_out_speed"]], [value])
        unit.doStep(currentCommunicationPoint=t - H, communicationStepSize=H)
        found.append(list(unit.getReal(keys)))
    return found


def test_a_winch_fed_from_a_table_gives_what_a_simulation_fed_so_gives_and_what_simulate_gives(fed):
    table, found = fed[0], np.array(fed[1])
    sim = tautline.Simulation(DATA / "hoist.yaml", keep=False)
    last, wanted = sim.inputs["winch.pay_out_speed"], []
    for t, value in table[1:]:
        if value != last:
            sim.inputs["winch.pay_out_speed"] = last = value
        sim.advance_to(t)
        wanted.append([*sim["payload.position"], sim["winch.tension"]])
    assert np.allclose(found, wanted, rtol=1e-9, atol=1e-12)
    # The values of the table are followed by cubics: not to the last digits of the ramp itself.
    whole = tautline.simulate(DATA / "hoist.yaml", end=table[-1][0])
    assert np.abs(whole["body_position"][-1, 0] - found[-1, :3]).max() < 2e-3


def _alone(path, steps):
    unit, reference = unit_of(path)
    unit.exitInitializationMode()
    found = [unit.getReal([reference["winch.tension"]])[0]]
    for k in range(steps):
        unit.doStep(currentCommunicationPoint=k * H, communicationStepSize=H)
        found.append(unit.getReal([reference["winch.tension"]])[0])
    return found


def test_left_alone_an_fmu_gives_what_simulate_gives(hoist):
    whole = tautline.simulate(DATA / "hoist.yaml", end=1.0)["drum_tension"][:, 0]
    assert np.allclose(hosted(_alone, str(hoist), len(whole) - 1, way="spawn"), whole, rtol=1e-9)


def _of_one_file(path):
    """Tensions of three instances that share a folder, of which each has another load, stepped in turn."""
    folder = fmpy.extract(path)
    told = fmpy.read_model_description(folder)
    reference = {variable.name: variable.valueReference for variable in told.modelVariables}
    units = []
    for k in range(3):
        unit = fmpy.fmi2.FMU2Slave(
            guid=told.guid, unzipDirectory=folder, modelIdentifier=told.coSimulation.modelIdentifier,
            instanceName=f"unit {k}",
        )  # fmt: skip
        unit.instantiate()
        unit.setupExperiment(startTime=0.0)
        unit.enterInitializationMode()
        unit.setReal([reference["payload.mass"]], [4000.0 + 1000.0 * k])
        unit.exitInitializationMode()
        units.append(unit)
    found = [unit.getReal([reference["winch.tension"]])[0] for unit in units]
    for unit in units:
        unit.doStep(currentCommunicationPoint=0.0, communicationStepSize=H)
    return found


def test_one_process_holds_several_instances_of_one_file(hoist):
    tensions = hosted(_of_one_file, str(hoist))
    assert np.allclose(np.diff(tensions), 1000.0 * 9.81, rtol=0.01)


def _saved(path):
    unit, reference = unit_of(path)
    unit.exitInitializationMode()
    unit.doStep(currentCommunicationPoint=0.0, communicationStepSize=1.0)
    state = unit.getFMUState()
    data = bytes(unit.serializeFMUState(state))
    keys, found = [reference["winch.tension"], reference["payload.position[2]"]], []
    for _ in range(2):
        unit.doStep(currentCommunicationPoint=1.0, communicationStepSize=0.5)
        found.append(list(unit.getReal(keys)))
        unit.setFMUState(state)
    return data, found


def _go_on(path, data):
    unit, reference = unit_of(path, "two")
    unit.exitInitializationMode()
    unit.setFMUState(unit.deSerializeFMUstate(data))
    unit.doStep(currentCommunicationPoint=1.0, communicationStepSize=0.5)
    return list(unit.getReal([reference["winch.tension"], reference["payload.position[2]"]]))


def test_a_state_saved_in_one_process_is_set_in_another_to_the_bit(hoist):
    data, (first, again) = hosted(_saved, str(hoist))
    assert first == again
    # One in which everything is at another place in memory.
    assert hosted(_go_on, str(hoist), data, way="spawn") == first


CONTROLLER = '''
from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class Controller(Fmi2Slave):
    """Winch speed that brings the load to a height and keeps it there."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.height, self.speed, self.wanted, self.gain = 5.0, 0.0, 5.5, 0.5
        self.register_variable(Real("height", causality=Fmi2Causality.input))
        self.register_variable(Real("speed", causality=Fmi2Causality.output))
        self.register_variable(Real("wanted", causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable))

    def do_step(self, current_time, step_size):
        self.speed = -self.gain * (self.wanted - self.height)
        return True
'''


def _master(plant_path, law_path):
    plant, of_plant = unit_of(plant_path, "plant")
    law, of_law = unit_of(law_path, "law")
    plant.exitInitializationMode()
    law.exitInitializationMode()
    heights = []
    for k in range(160):
        law.setReal([of_law["height"]], plant.getReal([of_plant["payload.position[2]"]]))
        law.doStep(currentCommunicationPoint=k * H, communicationStepSize=H)
        plant.setReal([of_plant["winch.pay_out_speed"]], law.getReal([of_law["speed"]]))
        plant.doStep(currentCommunicationPoint=k * H, communicationStepSize=H)
        heights.append(plant.getReal([of_plant["payload.position[2]"]])[0])
    return heights


def _written(folder):
    from pythonfmu import FmuBuilder

    FmuBuilder.build_FMU(Path(folder) / "controller.py", Path(folder) / "controller.fmu")


def test_a_controller_of_somebody_else_and_ours_exchange_signals_in_a_master(tmp_path):
    """The load comes to the height asked for, as exp(-t/2), the ship at rest."""
    (tmp_path / "controller.py").write_text(CONTROLLER)
    hosted(_written, str(tmp_path))
    still = tautline.read(DATA / "hoist.yaml").replace({"vessel.motion": {}, "path[0].drum.pay_out": 0})
    write_fmu(still, tmp_path / "plant.fmu", INPUTS, OUTPUTS)
    heights = hosted(_master, str(tmp_path / "plant.fmu"), str(tmp_path / "controller.fmu"))
    wanted = 5.5 - 0.5 * np.exp(-0.5 * H * np.arange(1, 161))
    # It also bounces on its rope since the winch was started, by 0.25 m/s over 8.7 rad/s.
    assert np.abs(heights - wanted).max() < 0.06
    assert np.mean(heights[-29:]) == pytest.approx(np.mean(wanted[-29:]), abs=0.005)


def _heavier(path):
    unit, reference = unit_of(path)
    unit.setReal([reference["payload.mass"]], [6000.0])
    unit.exitInitializationMode()
    tension = unit.getReal([reference["winch.tension"]])[0]
    unit.doStep(currentCommunicationPoint=0.0, communicationStepSize=H)
    unit.setReal([reference["payload.mass"]], [5000.0])
    unit.doStep(currentCommunicationPoint=H, communicationStepSize=H)
    return tension, unit.getReal([reference["payload.mass"]])[0]


def test_parameters_set_before_the_initialisation_are_those_of_the_start(hoist):
    tension, mass = hosted(_heavier, str(hoist))
    other = tautline.Simulation(tautline.read(DATA / "hoist.yaml").replace({"bodies[0].mass": "6 t"}))
    assert tension == pytest.approx(other["winch.tension"], rel=1e-6)
    assert mass == 5000.0


def _below_zero(path):
    unit, reference = unit_of(path)
    mass, told = [reference["payload.mass"]], []
    unit.setReal(mass, [-5.0])
    unit.exitInitializationMode()
    told += unit.getReal([*mass, reference["winch.tension"]])
    try:
        unit.doStep(currentCommunicationPoint=0.0, communicationStepSize=H)
    except Exception as error:
        told.append(str(error))
    unit.setReal(mass, [5000.0])
    unit.doStep(currentCommunicationPoint=0.0, communicationStepSize=H)
    return told


def test_a_mass_below_zero_fails_the_step_and_the_unit_lives(hoist):
    mass, tension, told = hosted(_below_zero, str(hoist))
    assert mass == 5000.0 and tension == pytest.approx(48740.9, rel=1e-3) and "fmi2DoStep failed" in told


def _two_blocked(path):
    unit, reference = unit_of(path)
    unit.exitInitializationMode()
    for k in range(200):
        unit.setReal([reference["winch.pay_out_speed"]], [-20.0 - 0.001 * k])
        try:
            unit.doStep(currentCommunicationPoint=k * H, communicationStepSize=H)
        except Exception as error:
            return str(error)
    return "nothing failed"


def test_a_step_that_fails_is_told_to_the_host(hoist):
    told = hosted(_two_blocked, str(hoist))
    assert "fmi2DoStep" in told, told


def test_names_that_there_are_not_are_refused_and_nothing_is_written(tmp_path):
    for inputs, outputs in ((["winch.payout"], OUTPUTS), (INPUTS, ["payload.pos"])):
        with pytest.raises(UnknownName, match="did you mean"):
            write_fmu(DATA / "hoist.yaml", tmp_path / "x.fmu", inputs, outputs)
    assert list(tmp_path.iterdir()) == []


def test_the_verb_writes_one_and_says_what_the_host_needs(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    from tautline.application.installed import Installed

    words = ["fmu", str(DATA / "slewing.yaml"), "--inputs", "boom.slew", "--outputs", "payload.position", "--json"]
    with pytest.raises(SystemExit) as left:
        run_command(make_app(Installed()), words)
    assert left.value.code == 0
    told = json.loads(capsys.readouterr().out)
    assert Path(told["fmu"]).is_file() and told["outputs"] == ["payload.position"] and told["needs"]
    with pytest.raises(SystemExit) as left:
        run_command(make_app(Installed()), [*words[:3], "boom.slow", *words[4:]])
    assert left.value.code == 2 and "boom.slew" in "".join(capsys.readouterr())


def test_names_with_commas_are_given_one_to_an_option_and_others_as_before(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    from tautline.application.installed import Installed

    text = (DATA / "slewing.yaml").read_text()
    assert "payload" in text
    (tmp_path / "odd.yaml").write_text(text.replace("payload", "'load, red'"))
    words = [
        "fmu",
        "odd.yaml",
        "--inputs",
        "load, red.force",
        "--inputs",
        "boom.slew",
        "--outputs",
        "load, red.position",
    ]
    with pytest.raises(SystemExit) as left:
        run_command(make_app(Installed()), [*words, "--outputs", "max_tension,min_tension", "--json"])
    assert left.value.code == 0
    told = json.loads(capsys.readouterr().out)
    assert told["inputs"] == ["load, red.force", "boom.slew"]
    assert told["outputs"] == ["load, red.position", "max_tension", "min_tension"]


def test_a_scene_of_which_much_has_been_computed_already_is_written_too(tmp_path):
    """What was computed of a scene is kept beside its fields, and leads back to it: a walk through that had no end."""
    from crane.application import Crane

    scene = tautline.read(DATA / "hoist.yaml")
    Crane().warnings(scene)
    assert write_fmu(scene, tmp_path / "hoist.fmu", ["vessel.heave"], ["winch.tension"])
    assert (tmp_path / "hoist.fmu").is_file()
