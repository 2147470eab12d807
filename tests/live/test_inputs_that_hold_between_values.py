"""Inputs that are given on change only: a staircase, held on each stair."""

from pathlib import Path

import numpy as np
import pytest

import tautline
from tautline.kernels.time_function import value_at

DATA = Path(__file__).parents[2] / "data"
PLACE, SPEED = "winch.pay_out", "winch.pay_out_speed"
H, HELD = 0.1, 3
STAIRS = [level for level in (0.0, -0.1, -0.2, -0.3, -0.2) for _ in range(HELD)]


def still():
    """The hoist with a winch and a ship at rest."""
    changes = {"vessel.motion": {"heave": {"constant": 0.0}}, "path[0].drum.pay_out": 0}
    return tautline.read(DATA / "hoist.yaml").replace(changes)


def fed(sim, name, values, *, on_change, every=0.01):
    """Values of an input's function at all times, where the input alone goes on and the scene does not."""
    steering, function = sim.inputs.handle(name).members[0]
    last, found = values[0], []
    for value in values:
        if not on_change or value != last:
            sim.inputs[name] = last = value
        begin = sim.time
        sim.inputs.write(begin, begin + H)
        for t in np.arange(0.0, H - 1e-9, every):
            found.append(value_at(sim.model.system.functions, function, begin + t)[steering.order] / steering.factor)
        sim._time = begin + H
    return np.array(found)


def step_by_step(values, every=0.01):
    """The same by hand: from rest to rest on the quintic, and on the cubic for a speed."""
    x = np.arange(0.0, 1.0 - 1e-9, every / H)
    before = [values[0], *values[:-1]]
    return x, np.array(before)[:, None], np.diff([values[0], *values])[:, None]


def test_a_place_that_holds_and_moves_on_comes_to_rest_on_each_stair_however_often_it_is_given():
    x, before, change = step_by_step(STAIRS)
    wanted = (before + change * x**3 * (10.0 - 15.0 * x + 6.0 * x * x)).ravel()
    for on_change in (False, True):
        sim = tautline.Simulation(still(), inputs=[PLACE], keep=False)
        assert fed(sim, PLACE, STAIRS, on_change=on_change) == pytest.approx(wanted, abs=1e-12)


def test_a_speed_that_holds_and_moves_on_comes_to_rest_on_each_stair_however_often_it_is_given():
    x, before, change = step_by_step(STAIRS)
    wanted = (before + change * x**2 * (3.0 - 2.0 * x)).ravel()
    for on_change in (False, True):
        sim = tautline.Simulation(still(), inputs=[SPEED], keep=False)
        assert fed(sim, SPEED, STAIRS, on_change=on_change) == pytest.approx(wanted, abs=1e-12)


def test_a_state_saved_at_rest_knows_that_the_input_has_not_held_yet():
    """Given one advance after it was reached it is a stair, and given in the next it goes on: also after going back."""
    held, at_once = [0.0, -0.1, -0.1, -0.2], [0.0, -0.1, -0.2, -0.2]
    for values in (held, at_once):
        ways = []
        for back in (False, True):
            sim = tautline.Simulation(still(), inputs=[PLACE], keep=False)
            first = fed(sim, PLACE, values[:2], on_change=True)
            if back:
                sim._time = 0.2
                saved = sim.save()
                fed(sim, PLACE, [-0.1, -0.1], on_change=True)
                sim.restore(saved)
            sim.inputs[PLACE] = values[2]
            ways.append([first, fed(sim, PLACE, values[2:], on_change=True)])
        assert np.array_equal(ways[0][1], ways[1][1])


def test_an_input_left_in_the_middle_of_its_way_goes_on_and_is_held_after_its_end():
    """Ctrl-C at the half of an advance: what follows from rest is a stair again."""
    sim = tautline.Simulation(still(), inputs=[PLACE], keep=False)
    sim.inputs[PLACE] = -0.1
    sim.inputs.write(0.0, H)
    sim._time = 0.5 * H
    fed(sim, PLACE, [-0.1, -0.1], on_change=True)
    assert float(sim.inputs[PLACE]) == pytest.approx(-0.1, abs=1e-12)
    x, before, change = step_by_step([-0.1, -0.2])
    wanted = (before + change * x**3 * (10.0 - 15.0 * x + 6.0 * x * x)).ravel()
    assert fed(sim, PLACE, [-0.1, -0.2], on_change=True) == pytest.approx(wanted, abs=1e-12)


def test_an_fmu_which_hears_of_changes_only_gives_what_a_simulation_fed_in_each_advance_gives(tmp_path):
    pytest.importorskip("pythonfmu", reason="PythonFMU is not installed")
    import zipfile

    from tautline.live.fmu.unit import Core
    from tautline.live.fmu.writing import write_fmu

    scene = still()
    write_fmu(scene, tmp_path / "still.fmu", [PLACE], ["winch.tension"])
    zipfile.ZipFile(tmp_path / "still.fmu").extractall(tmp_path)
    core, sim = Core(tmp_path / "resources"), tautline.Simulation(scene, inputs=[PLACE], keep=False)
    for k, level in enumerate(STAIRS):
        value = 0.02 * level  # with more the rope goes slack, and rounding grows
        core.set(PLACE, value)
        core.step(k * H, H)
        sim.inputs[PLACE] = value
        sim.advance(H)
        assert core.get("winch.tension") == pytest.approx(sim["winch.tension"], rel=1e-9)
