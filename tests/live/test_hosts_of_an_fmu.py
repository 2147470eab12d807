"""What hosts of FMUs do that Python programs do not: threads of their own, Pythons without Tautline, other versions."""

import os
import re
import subprocess
import sys
import zipfile
from importlib import import_module
from pathlib import Path

import pytest
from of_the_suite import studies
from young_processes import OF_COMMANDS, started, young_processes

import crane
import tautline
from tautline.errors import TautlineError
from tautline.live.fmu.needs import host_needs, python_library
from tautline.live.fmu.unit import Core
from tautline.live.fmu.writing import write_fmu

fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed")
Fmi2Slave = pytest.importorskip("pythonfmu", reason="PythonFMU is not installed").Fmi2Slave
pytest.importorskip("pythonfmu3", reason="PythonFMU3 is not installed")
fmi2, fmi3 = import_module("tautline.live.fmu.fmi2"), import_module("tautline.live.fmu.fmi3")

DATA = Path(__file__).parents[2] / "data"

OTHER_THREAD = """
import _thread, sys
assert "threading" not in sys.modules
sys.path[:] = {path!r}
told = []

def act():
    try:
        import threading
        # From Python 3.13 on it is the thread that started Python.
        assert sys.version_info >= (3, 13) or threading.current_thread() is threading.main_thread()
        import tautline
        from tautline.interruption import ended_by_signal
        with ended_by_signal():
            sim = tautline.Simulation({scene!r}, keep=False)
            for _ in range(2):
                sim.advance(0.05)
        told.append(repr(float(sim["winch.tension"])))
    except BaseException as error:
        told.append(repr(error))
    done.release()

done = _thread.allocate_lock()
done.acquire()
_thread.start_new_thread(act, ())
done.acquire()
print(told[0])
"""
"""A host that starts Python in one thread and steps in another, which `threading` takes for the main one."""


def test_a_simulation_steps_in_a_thread_that_may_handle_no_signals():
    """No signals can be heard there; the reference is the same simulation in the thread that started Python."""
    scene = str(DATA / "hoist.yaml")
    # Where it is installed for work on it, a finder of `site` knows the way.
    ways = [str(Path(of.__file__).parents[1]) for of in (tautline, crane)]
    script = OTHER_THREAD.format(path=[*ways, *sys.path], scene=scene)
    # Without `site`: it would import `threading`.
    ran = subprocess.run(
        [sys.executable, "-S", "-c", script], capture_output=True, text=True, timeout=300, env={**os.environ}
    )
    sim = tautline.Simulation(scene, keep=False)
    for _ in range(2):
        sim.advance(0.05)
    assert ran.stdout.strip() == repr(float(sim["winch.tension"])), ran.stdout + ran.stderr


HOST = """
import os, sys, fmpy
if "WITHOUT" in os.environ:
    sys.modules[os.environ["WITHOUT"]] = None
folder = fmpy.extract(sys.argv[1], os.path.dirname(sys.argv[1]) + "/unit")
told = fmpy.read_model_description(folder)
two = told.fmiVersion == "2.0"
unit = (fmpy.fmi2.FMU2Slave if two else fmpy.fmi3.FMU3Slave)(
    guid=told.guid, unzipDirectory=folder, modelIdentifier=told.coSimulation.modelIdentifier, instanceName="one"
)
number = {variable.name: variable.valueReference for variable in told.modelVariables}

def step(time):
    unit.doStep(currentCommunicationPoint=time, communicationStepSize=0.05)
    print("stepped", flush=True)

def begin(**values):
    unit.instantiate(loggingOn="LOGGING" in os.environ)
    if two:
        unit.setupExperiment(startTime=0.0)
    unit.enterInitializationMode()
    for name, value in values.items():
        put(name, value)
    unit.exitInitializationMode()

def put(name, value):
    (unit.setReal if two else unit.setFloat64)([number[name]], [value])

def refused(act, *given):
    try:
        return act(*given)
    except Exception as error:
        print("refused", error, flush=True)

ACTS
os._exit(0)  # the library of an FMU in Python does not survive the end of its host
"""
"""A host that does what stands for ACTS."""
ONE_STEP = "refused(lambda: (begin(), step(0.0)))"


@pytest.fixture(scope="module")
def young():
    """Starts hosts that need not load FMPy and what an FMU asks for anew; those that do are started by others here."""
    with young_processes(*OF_COMMANDS, "fmpy", "tautline.live.fmu.unit", "crane.application") as run:
        yield run


def host(path, acts=ONE_STEP, run=started, **environment):
    """What a host says that makes one instance of an FMU and does what is asked."""
    ran = run(["-c", HOST.replace("ACTS", acts), path], cwd=None, env={**os.environ, **environment})
    assert ran.returncode == 0, f"the host died: {ran.returncode}; {ran.stdout}{ran.stderr}"
    return ran.stdout + ran.stderr


NAMES = ("unit", "staticmethod", "class", "None", "fmi2", "super", "Fmi3Slave", "Unit", "a²", "1 кран", "x\x01")
BY_FMI_2 = ("class", "super", "Unit", "a²", "1 кран", "x\x01")
BY_FMI_3 = ("class", "Fmi3Slave", "a²")
"""Names that say as much as all do: of Python, of the script, and with letters that C does not know."""


@pytest.mark.parametrize(
    ("name", "fmi"),
    [
        *((name, 2) for name in BY_FMI_2),
        *((name, 3) for name in BY_FMI_3),
        *studies(*((name, 2) for name in NAMES if name not in BY_FMI_2)),
        *studies(*((name, 3) for name in NAMES if name not in BY_FMI_3)),
    ],
)
def test_an_fmu_has_any_name_that_a_file_can_have(name, fmi, tmp_path, young):
    """Also one of Python, of the script itself, or with letters that C does not know in names."""
    path = tmp_path / f"{name}.fmu"
    write_fmu(DATA / "hoist.yaml", path, ["winch.pay_out_speed"], ["winch.tension"], fmi=fmi)
    told = fmpy.read_model_description(str(path))
    assert re.fullmatch("[A-Za-z][A-Za-z0-9_]*", told.coSimulation.modelIdentifier)
    assert told.modelName == name.replace("\x01", "_")
    assert "stepped" in host(path, run=young)


def test_the_usual_name_of_an_fmu_is_that_of_its_library(tmp_path):
    write_fmu(DATA / "hoist.yaml", tmp_path / "hoist_2.fmu", [], ["winch.tension"])
    assert fmpy.read_model_description(str(tmp_path / "hoist_2.fmu")).coSimulation.modelIdentifier == "hoist_2"


PERCENT = "payload 50% sea %s %n"
"""The name of a load, of which an unwary printf makes garbage or the end of its process."""


@pytest.fixture(scope="module")
def of_percents(tmp_path_factory):
    """Resources of an FMU whose messages have per cent signs."""
    folder = tmp_path_factory.mktemp("percent")
    text = (DATA / "hoist.yaml").read_text().replace("payload", PERCENT)
    write_fmu(text, folder / "percent.fmu", [f"{PERCENT}.force"], ["winch.tension"])
    with zipfile.ZipFile(folder / "percent.fmu") as file:
        file.extractall(folder)
    return folder / "resources"


class Listener(Fmi2Slave):
    """A slave of FMI 2 that keeps what it is told to log."""

    def __init__(self, resources):
        super().__init__(instance_name="one", resources=str(resources))
        self.unit = fmi2.Unit(self)

    def do_step(self, current_time, step_size):
        return self.unit.step(current_time, step_size)

    @property
    def texts(self):
        return [message.msg for message in self.log_queue]


def test_a_log_message_of_fmi_2_is_a_format_of_which_printf_makes_the_message(of_percents):
    slave, core = Listener(of_percents), Core(of_percents)
    name = f"{PERCENT}.mass"
    with pytest.raises(tautline.SimulationError) as told:
        core.set(name, -1.0)
    number = next(key for key, one in slave.vars.items() if one.name == name)
    slave.set_real([number], [-1.0])
    assert not slave.do_step(0.0, 0.05)
    assert [text % () for text in slave.texts] == [str(told.value)] * 2 and PERCENT in str(told.value)


def test_a_log_message_of_fmi_3_is_the_message(of_percents):
    slave = fmi3.Unit(instance_name="one", resources=str(of_percents))
    slave._set(f"{PERCENT}.mass", -1.0)
    assert PERCENT in slave.log_queue[0].msg


def test_a_time_that_a_host_sets_in_fmi_3_is_refused_with_its_cause_and_steps_go_on(of_percents):
    slave = fmi3.Unit(instance_name="one", resources=str(of_percents))
    number = next(key for key, one in slave.vars.items() if one.name == "time")
    slave.set_float64([number], [7.0])
    assert slave.log_queue[0].msg.startswith("time is what steps have come to: it cannot be set")
    slave.exit_initialization_mode()
    slave.do_step(0.0, 0.05)
    assert slave.get_float64([number]) == pytest.approx([0.05])


def module_in(path):
    """The name of the module that the host imports."""
    with zipfile.ZipFile(path) as file:
        return file.read("resources/slavemodule.txt").decode()


def rewritten(source, target, change):
    """A copy of an FMU whose script is changed."""
    script = f"resources/{module_in(source)}.py"
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for name in old.namelist():
            data = old.read(name)
            new.writestr(name, change(data.decode()).encode() if name == script else data)
    return target


@pytest.mark.parametrize("of", ["standard", "Tautline"])
def test_fmus_of_one_file_name_and_of_different_versions_have_modules_of_different_names(of, tmp_path, monkeypatch):
    """Python imports a name once, and would run the script of the first for both."""
    written = []
    for k, fmi in enumerate((2, 3 if of == "standard" else 2)):
        if k and of == "Tautline":
            monkeypatch.setattr("tautline.live.fmu.scripts.__version__", "0.0.7")
            monkeypatch.setattr("tautline.version.__version__", "0.0.7")
        path = tmp_path / str(k) / "same.fmu"
        path.parent.mkdir()
        write_fmu(DATA / "hoist.yaml", path, [], ["winch.tension"], fmi=fmi)
        written.append(module_in(path))
    assert written[0] != written[1]


@pytest.mark.parametrize("fmi", [2, 3])
def test_an_fmu_of_another_version_is_refused_with_both_versions_and_the_line_for_pip(fmi, tmp_path):
    """The host lives on: only the instance is refused."""
    new, old, version = tmp_path / "new.fmu", tmp_path / "old.fmu", tautline.__version__
    write_fmu(DATA / "hoist.yaml", new, [], ["winch.tension"], fmi=fmi)
    said = host(rewritten(new, old, lambda text: text.replace(version, "0.0.7")))
    assert "refused" in said and "stepped" not in said
    assert f"Tautline {version} is installed" in said and "written by Tautline 0.0.7" in said
    assert 'pip install "tautline[fmi]==0.0.7"' in said and sys.executable in said


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_host_whose_python_has_no_tautline_is_told_what_to_install_and_where(fmi, tmp_path):
    path = tmp_path / "lone.fmu"
    write_fmu(DATA / "hoist.yaml", path, [], ["winch.tension"], fmi=fmi)
    for logging in ({"LOGGING": "1"}, {}):
        said = host(path, WITHOUT="tautline", **logging)
        assert "refused" in said and "tautline" in said
        assert f'pip install "tautline[fmi]=={tautline.__version__}"' in said and sys.executable in said


def test_what_an_fmu_of_fmi_2_refuses_at_its_start_is_a_format_too(of_percents, monkeypatch):
    """PythonFMU hands the error of a constructor to the host's logger."""

    def refuse(*_, **__):
        raise tautline.SimulationError("100% of memory")

    monkeypatch.setattr("tautline.live.fmu.unit.Simulation", refuse)
    with pytest.raises(tautline.SimulationError) as told:
        Listener(of_percents)
    assert str(told.value) % () == "100% of memory"


WRITE = """
begin()
from tautline.live.fmu.writing import write_fmu
write_fmu({scene!r}, {path!r}, [], ["winch.tension"], fmi={fmi})
"""


@pytest.mark.parametrize("fmi", [2, *studies(3)])
def test_the_host_of_an_fmu_may_write_one_that_another_host_loads(fmi, tmp_path):
    """It imports PythonFMU out of the FMU that it hosts, where there are no libraries."""
    first, second = tmp_path / "first.fmu", tmp_path / "second.fmu"
    write_fmu(DATA / "hoist.yaml", first, [], ["winch.tension"], fmi=fmi)
    said = host(first, WRITE.format(scene=str(DATA / "hoist.yaml"), path=str(second), fmi=fmi))
    assert second.exists(), said
    with zipfile.ZipFile(first) as one, zipfile.ZipFile(second) as other:
        names = [{name.replace(path.stem, "") for name in file.namelist()} for file, path in
                 ((one, first), (other, second))]  # fmt: skip
    assert names[0] == names[1]
    assert "stepped" in host(second)


WITHOUT_START = """
begin(**{"vessel.heave": 1e5})
state = unit.getFMUState()
print("state given", flush=True)
refused(step, 0.0)
put("vessel.heave", 0.0)
step(0.0)
unit.setFMUState(state)
refused(step, 0.05)
"""
"""A heave of 100 km, with which no start is found."""


@pytest.mark.parametrize("fmi", [2, 3])
def test_the_state_of_a_start_that_is_not_found_is_given_and_refused_where_it_is_set(fmi, tmp_path):
    """A host that takes a state before each step lives on, and steps once a start is found."""
    path = tmp_path / "deep.fmu"
    write_fmu(DATA / "hoist.yaml", path, ["vessel.heave"], ["winch.tension"], fmi=fmi)
    said = host(path, WITHOUT_START, LOGGING="1")
    assert "fatal" not in said.lower() and said.count("no start is found with what was set") >= 3
    assert said.count("no static equilibrium was found to start from") >= 3
    words = [line.split()[0] for line in said.splitlines() if line.startswith(("state", "refused", "stepped"))]
    assert words == ["state", "refused", "stepped", "refused"]


def test_a_unit_that_has_stopped_says_why_whatever_the_time_that_the_host_goes_on_from(tmp_path):
    """Some hosts look past the status of a step, and their time goes on: the hoist is two-blocked before 14 s."""
    write_fmu(DATA / "hoist.yaml", tmp_path / "fast.fmu", ["winch.pay_out_speed"], ["winch.tension"])
    with zipfile.ZipFile(tmp_path / "fast.fmu") as file:
        file.extractall(tmp_path)
    core = Core(tmp_path / "resources")
    core.initialise()
    saved = core.save()
    told = []
    for k in range(32):
        try:
            core.step(0.5 * k, 0.5)
        except TautlineError as error:
            told.append(str(error))
    assert len(told) > 3 and all("TWO_BLOCKED at" in text for text in told), told
    core.restore(saved)
    core.step(0.0, 0.5)


def test_the_needs_of_a_host_name_the_shared_library_of_python_that_linux_has_to_load(tmp_path):
    """No library of PythonFMU is linked to it: a host that is no Python program finds no symbol of Python."""
    path = tmp_path / "hoist.fmu"
    (line,) = [need for need in write_fmu(DATA / "hoist.yaml", path, [], ["winch.tension"]) if "LD_PRELOAD" in need]
    with zipfile.ZipFile(path) as file:
        assert line in file.read("documentation/index.txt").decode()
    named = Path(re.search("LD_PRELOAD=([^`]+)`", line)[1])
    assert named.is_file() or "The Python that wrote this FMU has none" in line


def test_a_python_without_a_shared_library_says_so(monkeypatch):
    monkeypatch.setattr("sysconfig.get_config_vars", lambda: {"LDLIBRARY": "libpython3.11.a"})
    told = "".join(host_needs())
    assert "LD_PRELOAD=/path/to/libpython" in told and "The Python that wrote this FMU has none" in told


def test_the_shared_library_of_python_is_found_where_python_was_built_with_one(tmp_path):
    kind = tmp_path / "x86_64-linux-gnu"
    kind.mkdir()
    static = {"LIBDIR": str(tmp_path), "LDLIBRARY": "libpython3.11.a", "INSTSONAME": "libpython3.11.a"}
    (tmp_path / "libpython3.11.a").touch()
    shared = {"LIBDIR": str(tmp_path), "LDLIBRARY": "libpython3.11.so", "INSTSONAME": "libpython3.11.so.1.0"}
    for config in ({}, {"LIBDIR": None, "LDLIBRARY": None}, static, shared):
        assert python_library(config) is None
    (kind / "libpython3.11.so.1.0").touch()
    assert python_library({**shared, "MULTIARCH": kind.name}) == kind / "libpython3.11.so.1.0"
    (tmp_path / "libpython3.11.so").touch()
    assert python_library(shared) == tmp_path / "libpython3.11.so"
