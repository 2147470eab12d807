"""Friction factors that are set one by one and both together, in a simulation and in an FMU."""

import zipfile
from pathlib import Path

import pytest

import tautline
from tautline.live.errors import SimulationError

DATA = Path(__file__).parents[2] / "data"
STATIC, KINETIC, BOTH = "wall.friction.static", "wall.friction.kinetic", "wall.friction"
IN_TURN = [(BOTH, 0.4), (KINETIC, 0.1), (BOTH, 0.4)]
H = 0.05


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    pytest.importorskip("pythonfmu", reason="PythonFMU is not installed")
    from tautline.live.fmu.writing import write_fmu

    made = tmp_path_factory.mktemp("fmu")
    write_fmu(DATA / "drilling.yaml", made / "drilling.fmu", [], ["top.hook_load"])
    zipfile.ZipFile(made / "drilling.fmu").extractall(made)
    return made / "resources"


def factors(read):
    return [read(name) for name in (STATIC, KINETIC, BOTH)]


@pytest.mark.parametrize("when", ["before the start", "after the start", "after a step"])
def test_an_fmu_takes_overlapping_parameters_in_their_order_and_tells_the_host_what_it_has(folder, when):
    """The scene has 0.25 and 0.2: both together at 0.4 are 0.5 and 0.4, whatever one of them was before."""
    from tautline.live.fmu.unit import Core

    core = Core(folder)
    if when != "before the start":
        core.initialise()
    if when == "after a step":
        core.step(0.0, H)
    for name, value in IN_TURN:
        core.set(name, value)
    assert factors(core.get) == pytest.approx([0.5, 0.4, 0.4], rel=1e-12)
    core.step(core.sim.time, H)
    assert factors(core.get) == pytest.approx([0.5, 0.4, 0.4], rel=1e-12)
    core.set(KINETIC, 0.1)
    assert factors(core.get) == pytest.approx([0.5, 0.1, 0.1], rel=1e-12)


def test_static_friction_below_the_kinetic_one_is_refused_once_a_simulation_goes_on_whichever_is_given_first():
    sim = tautline.Simulation(DATA / "drilling.yaml", keep=False)
    sim.parameters[KINETIC] = 0.4
    sim.parameters[STATIC] = 0.5
    sim.advance(H)
    sim.parameters[STATIC] = 0.05
    for go_on in (lambda: sim.advance(H), lambda: sim.advance_to(1.0)):
        with pytest.raises(
            SimulationError, match=r"wall.friction.static = 0.05 is less than wall.friction.kinetic = 0"
        ):
            go_on()
    assert sim.time == pytest.approx(H)
    sim.parameters[STATIC] = 0.4
    sim.advance(H)
    with pytest.raises(SimulationError, match=f"give a larger {STATIC}, or a smaller {KINETIC}"):
        tautline.Simulation(DATA / "drilling.yaml", keep=False, parameters={KINETIC: 0.3})


def test_an_fmu_makes_no_step_while_static_friction_is_below_the_kinetic_one(folder):
    from tautline.live.fmu.unit import Core

    core = Core(folder)
    core.set(KINETIC, 0.3)
    with pytest.raises(SimulationError, match="is less than"):
        core.initialise()
    core.set(STATIC, 0.3)
    core.step(0.0, H)
    core.set(STATIC, 0.1)
    with pytest.raises(SimulationError, match="is less than"):
        core.step(H, H)
    core.set(STATIC, 0.3)
    core.step(H, H)


def test_a_state_and_a_copy_bring_static_friction_below_the_kinetic_one_no_further_than_the_simulation_itself():
    sim = tautline.Simulation(DATA / "drilling.yaml", keep=False)
    good = sim.save()
    sim.parameters[KINETIC] = 0.5
    bad, other, copied = sim.save(), tautline.Simulation(DATA / "drilling.yaml", keep=False), sim.copy()
    sim.restore(good)
    sim.advance(H)
    for one in (sim, other):
        one.restore(bad)
    for one in (sim, other, copied):
        with pytest.raises(SimulationError, match=r"wall.friction.static = 0.25 is less than wall.friction.kinetic"):
            one.advance(H)
        one.parameters[STATIC] = 0.5
        one.advance(H)


def test_an_fmu_makes_no_step_from_a_state_with_static_friction_below_the_kinetic_one(folder):
    from tautline.live.fmu.unit import Core

    core = Core(folder)
    core.initialise()
    core.step(0.0, H)
    good = core.save()
    core.set(KINETIC, 0.5)
    bad = core.save()
    core.restore(good)
    core.step(H, H)
    core.restore(bad)
    with pytest.raises(SimulationError, match="is less than"):
        core.step(H, H)
