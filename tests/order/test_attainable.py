"""A tolerance below what rounding leaves is not sought: it costs halvings and iterations in vain, and is said."""

import re
from dataclasses import replace
from pathlib import Path

import pytest
from of_the_suite import studies

from drillstring.application import Drillstring
from gardenhose.application import Gardenhose
from tautline.cable.application import Cable
from tautline.cable.input.scene import parse
from tautline.simulation import simulate

DATA = Path(__file__).parents[2] / "data"
SCENES = {
    "hose": (Gardenhose, "hose.yaml", "solver: {", "solver: {tolerance: %s, ", "solver.tolerance"),
    "cable": (Cable, "reeled_span.yaml", r"eps_energy: 1.0e-8", "eps_energy: %s", "eps_energy"),
}


def built(name, folder, tolerance=None):
    application, file, old, new, _ = SCENES[name]
    text = (DATA / file).read_text(encoding="utf-8")
    if tolerance is not None:
        assert old in text
        text = text.replace(old, new % tolerance)
    path = folder / file
    path.write_text(text, encoding="utf-8")
    made = application()
    model = made.build(made.read(path))
    return replace(model, solver=replace(model.solver, end=60 * model.solver.step, interval=10 * model.solver.step))


@pytest.mark.parametrize("tolerance", ["1.0e-16", "1.0e-30"])
@pytest.mark.parametrize("name", SCENES)
def test_a_tolerance_below_rounding_is_said_and_costs_no_halvings(name, tolerance, tmp_path):
    # the hose halved its steps 148 times in 0.3 s and took ten times the iterations
    usual, asked = built(name, tmp_path), built(name, tmp_path, tolerance)
    (note,) = [one for one in asked.notes if "rounding" in one]
    assert note.startswith(f"{SCENES[name][4]} = {float(tolerance):g} ")
    assert float(re.search(r"uses (\S+)$", note)[1]) == pytest.approx(asked.solver.tolerance, rel=0.06)
    assert 1e-16 < asked.solver.tolerance < 1e-10
    one, other = simulate(usual).attributes, simulate(asked)
    assert other.attributes["tolerance"] == asked.solver.tolerance
    assert other.attributes["steps"] == one["steps"]
    assert other.attributes["halvings"] == 0
    assert other.attributes["newton_iterations"] < 4 * one["newton_iterations"]


@pytest.mark.parametrize("file", ["tripping.yaml", "field_well.yaml", *studies("jwell.yaml", "hanging.yaml")])
def test_a_tolerance_below_rounding_is_said_of_lumps_too_whose_unknowns_are_zero_as_drawn(file):
    # tripping stopped at 0 s with 1e-17, and the cure was a smaller step; the field well halved its steps 377 times
    application = Drillstring()
    scene = application.read(DATA / file)
    model = application.build(scene.replace({"solver.tolerance": 1e-17}))
    (note,) = [one for one in model.notes if "rounding" in one]
    assert note.startswith("solver.tolerance = 1e-17 is below")
    assert 1e-15 < model.solver.tolerance == model.attributes["tolerance"] < 1e-10
    asked, given = (
        simulate(replace(one, solver=replace(one.solver, end=2.0, tolerance=model.solver.tolerance)))
        for one in (model, application.build(scene))
    )
    assert asked.attributes["halvings"] == 0
    assert (asked["tension"] == given["tension"]).all()  # the look at rest leaves no trace
    assert not any("rounding" in one for one in application.build(scene).notes)


@pytest.mark.parametrize("name", SCENES)
def test_a_tolerance_that_can_be_reached_is_kept_as_it_is(name, tmp_path):
    assert built(name, tmp_path, "1.0e-12").solver.tolerance == 1e-12
    assert not any("rounding" in note for note in built(name, tmp_path).notes)


LINE = """
CableModelMaterial: {Gravity: [0, 0, -9.81]}
CableModel:
  - Node7Dof: {id: 0, xyz: [0, 0, 0], BC: [1, 1, 1, 0, 0, 0, 1]}
  - Node7Dof: {id: 1, xyz: [100, 0, 10], BC: [1, 1, 1, 0, 0, 0, 1]}
  - CableLine: {id: 0, nodes7: [0, 1], elements: 10000, length: 110, EA: 1.0e7, EJ: 10, rhoA: 5}
GeneralizedAlpha: {type: G-alpha, rho_inf: 0.8, time_step: 0.005, time_end: 0.025, plotpoints: 40, start: static}
"""


def test_elements_of_a_centimetre_ask_for_no_more_than_rounding_leaves_with_the_tolerance_that_is_usual():
    # 20.2 iterations a step and 325 halvings in ten steps, when the 1e-8 that is usual was sought
    model = Cable().build(parse(LINE))
    assert len([one for one in model.notes if "rounding" in one]) == 1
    assert 1e-8 < model.solver.tolerance == model.attributes["tolerance"] < 1e-3
    run = simulate(model).attributes
    assert run["newton_iterations"] <= 3 * run["steps"] and run["halvings"] == 0
