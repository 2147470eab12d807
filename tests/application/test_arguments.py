"""Wrong arguments from Python are refused in plain words by an error of this package, and name no option."""

import re
from fractions import Fraction
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

import tautline
from tautline import ArgumentError, ArgumentTypeError, Grid, SimulationError
from tautline.study.accuracy.arguments import check_stability, check_study

HOIST = Path(__file__).parents[2] / "data" / "hoist.yaml"
SCENE = tautline.read(HOIST)
VARY = {"bodies[0].mass": [4000.0]}
WRONG = {
    "grid": (ArgumentTypeError, lambda: tautline.study_errors(SCENE, grid=3)),
    "steps below zero": (ArgumentError, lambda: tautline.study_errors(SCENE, grid=Grid(steps=[-1]))),
    "steps": (ArgumentTypeError, lambda: tautline.study_errors(SCENE, grid=Grid(steps="x"))),
    "elements": (ArgumentError, lambda: tautline.study_errors(SCENE, grid=Grid(elements=[0]))),
    "methods": (ArgumentError, lambda: tautline.study_errors(SCENE, grid=Grid(methods=["x"]))),
    "newton": (ArgumentError, lambda: tautline.study_errors(SCENE, grid=Grid(newton=["x"]))),
    "repetitions": (ArgumentError, lambda: tautline.study_errors(SCENE, repetitions=0)),
    "repetitions of a text": (ArgumentTypeError, lambda: tautline.study_errors(SCENE, repetitions="x")),
    "grid.steps[1]": (ArgumentTypeError, lambda: tautline.study_errors(SCENE, grid=Grid(steps=[1e-3, "1 m"]))),
    "grid.methods[0]": (ArgumentTypeError, lambda: tautline.study_errors(SCENE, grid=Grid(methods=[3]))),
    "repeat": (ArgumentError, lambda: tautline.study_errors(SCENE, repeat=0)),
    "repeat and repetitions": (ArgumentError, lambda: tautline.study_errors(SCENE, repeat=1, repetitions=1)),
    "quick of study": (ArgumentTypeError, lambda: tautline.study_errors(SCENE, quick="x")),
    "tolerance": (ArgumentTypeError, lambda: tautline.study_errors(SCENE, tolerance="1 m")),
    "tolerance of stability": (ArgumentTypeError, lambda: tautline.study_stability(SCENE, tolerance="x")),
    "budget": (ArgumentError, lambda: tautline.study_errors(SCENE, budget=-1)),
    "reference": (ArgumentTypeError, lambda: tautline.study_errors(SCENE, reference="x")),
    "'foo'": (ArgumentTypeError, lambda: tautline.study_errors(SCENE, foo=1)),
    "budget of stability": (ArgumentTypeError, lambda: tautline.study_stability(SCENE, budget="x")),
    "quick": (ArgumentTypeError, lambda: tautline.study_stability(SCENE, quick="x")),
    "vary": (ArgumentTypeError, lambda: tautline.sweep(SCENE, None)),
    "vary of a number": (ArgumentTypeError, lambda: tautline.sweep(SCENE, 3)),
    "collect": (ArgumentTypeError, lambda: tautline.sweep(SCENE, VARY, collect=3)),
    "jobs": (ArgumentTypeError, lambda: tautline.sweep(SCENE, VARY, jobs=2.5)),
    "jobs of a text": (ArgumentTypeError, lambda: tautline.sweep(SCENE, VARY, jobs="x")),
    "options": (ArgumentTypeError, lambda: tautline.sweep(SCENE, VARY, options=3)),
    "folder": (ArgumentTypeError, lambda: tautline.sweep(SCENE, VARY, folder=3)),
    "progress": (ArgumentTypeError, lambda: tautline.sweep(SCENE, VARY, progress=3)),
    "resume": (ArgumentError, lambda: tautline.sweep(SCENE, VARY, resume=True)),
    "changes": (ArgumentTypeError, lambda: SCENE.replace(None)),
    "changes of a list": (ArgumentTypeError, lambda: SCENE.replace([])),
    "folder of a text": (ArgumentTypeError, lambda: tautline.read("a: 1\nb: 2", folder=3)),
    "path": (ArgumentTypeError, lambda: tautline.simulate(SCENE, path=3)),
    "progress of a run": (ArgumentTypeError, lambda: tautline.simulate(SCENE, progress=3)),
    "verify": (ArgumentTypeError, lambda: tautline.simulate(SCENE, verify="x")),
    "verify beside accuracy": (ArgumentError, lambda: tautline.simulate(SCENE, verify=True, accuracy="1 %")),
    "resume of a run": (ArgumentTypeError, lambda: tautline.simulate(SCENE, resume="x")),
    "simulations": (ArgumentTypeError, lambda: tautline.rollout([3], until=1.0)),
}


@pytest.mark.parametrize("what", WRONG)
def test_an_argument_that_cannot_be_is_refused_by_its_name(what):
    error, call = WRONG[what]
    with pytest.raises(error, match=re.escape(what.split(" ")[0])) as refused:
        call()
    assert "--" not in str(refused.value)


@pytest.mark.parametrize("budget", [0.0, float("nan"), -float("inf")])
def test_a_budget_may_be_infinite_and_is_refused_by_that_sentence(budget):
    check_stability({"budget": float("inf"), "quick": 1, "tolerance": np.array(0.01)})
    with pytest.raises(ArgumentError, match="a number above zero, or infinity for no limit, is wanted"):
        check_stability({"budget": budget})
    with pytest.raises(ArgumentError, match=r"grid.elements\[0\] = inf: a finite number above zero is wanted"):
        check_study(Grid(elements=[float("inf")]), {})


def test_a_study_calls_its_arguments_as_the_command_does_and_takes_a_tolerance_in_percent(monkeypatch):
    given = {}
    monkeypatch.setattr(
        "tautline.study.accuracy.precision.study", lambda subject, grid, **options: given.update(options)
    )
    tautline.study_errors(SCENE, quick=True, repeat=2, tolerance="1 %")
    assert given == {"reduced": True, "repetitions": 2, "tolerance": pytest.approx(0.01)}
    tautline.study_errors(SCENE, reduced=False, repetitions=1)
    assert (given["reduced"], given["repetitions"]) == (False, 1)


def test_a_grid_takes_whatever_can_be_gone_through_and_times_with_units():
    steps = [1e-3, 5e-4]
    for given in ((one for one in steps), np.array(steps), dict.fromkeys(steps), ["1 ms", "0.5 ms"]):
        found = check_study(Grid(steps=given, methods=dict.fromkeys(["rk4"])), {"budget": np.inf, "reduced": np.True_})
        assert (found.steps, found.methods) == (pytest.approx(steps), ("rk4",))
    with pytest.raises(
        ArgumentTypeError, match=r'grid.steps\[0\] = .1 m.: a finite time .* "1 ms", is wanted, not str'
    ):
        check_study(Grid(steps=["1 m"]), {})


@pytest.mark.parametrize("switch", [2, -1, 0.0, "x", np.array([True])], ids=str)
def test_a_switch_is_true_false_one_or_zero(switch):
    for good in (1, 0, True, np.False_, np.array(1)):
        check_stability({"quick": good})
    with pytest.raises(ArgumentTypeError, match=r"quick = .* True or False is wanted"):
        check_stability({"quick": switch})


def test_what_varies_may_be_a_table_or_a_list_of_pairs():
    key, masses = "bodies[0].mass", [4000.0, 4100.0]
    short = SCENE.replace({"solver.end": "20 ms", "output.interval": "10 ms"})
    forms = [[(key, masses)], {key: masses}]
    if find_spec("pandas"):
        forms.append(import_module("pandas").DataFrame({key: masses}))
    for vary in forms:
        assert tautline.sweep(short, vary, collect=["max_tension"], jobs=1)[key].values.tolist() == masses
    with pytest.raises(ArgumentTypeError, match=r'\{"bodies\[0\].mass": \["5 t", "6 t"\]\} is wanted, not list'):
        tautline.sweep(short, [(3, masses)])


def test_a_point_that_there_is_not_is_refused_by_the_name_of_the_argument():
    with pytest.raises(tautline.ResultError, match="argument point: nothing is called 'nosuch'"):
        tautline.study_errors(SCENE, end=0.1, point="nosuch")


@pytest.fixture(scope="module")
def sim():
    return tautline.Simulation(SCENE)


@pytest.mark.parametrize("on", [[0.5], [True], [0, 0], ["a"], [10**30], 3, [-1], []], ids=str)
def test_what_names_no_degrees_of_freedom_is_refused(sim, on):
    with pytest.raises(SimulationError):
        sim.add_force(lambda t, q, v: np.zeros(len(q)), on=on)


def test_an_array_without_a_dimension_and_whole_floats_are_no_degrees_of_freedom_and_integers_are_asked_for(sim):
    with pytest.raises(SimulationError, match="does not say what a force acts on"):
        sim.add_force(lambda t, q, v: np.zeros(1), on=np.array(3))
    for on in ([0.0, 1.0], np.array([0.0, 1.0])):
        with pytest.raises(SimulationError, match="its numbers are floats, and integers are wanted"):
            sim.add_force(lambda t, q, v: np.zeros(2), on=on)


def test_forces_and_vectors_of_real_numbers_as_objects_are_taken_and_texts_and_complex_ones_are_not(sim):
    plain, other, wrong = (sim.copy() for _ in range(3))
    plain.add_force(lambda t, q, v: [500.0, 250.0, 0.0], on="payload.position")
    other.add_force(lambda t, q, v: [Fraction(1000, 2), 250, 0.0], on="payload.position")
    for one in (plain, other):
        one.advance(0.01)
    assert np.array_equal(plain["payload.position"], other["payload.position"])
    assert not np.array_equal(plain["payload.position"], sim["payload.position"])
    wrong.add_force(lambda t, q, v: np.array(["500", 250, 0.0], object), on="payload.position")
    with pytest.raises(tautline.TautlineError, match="no numbers"):
        wrong.advance(0.01)
    equations = sim.equations
    q = np.linspace(1.0, 2.0, equations.size)
    assert np.array_equal(equations.mass(q.astype(object)).toarray(), equations.mass(q).toarray())
    with pytest.raises(SimulationError, match="no numbers"):
        equations.mass(np.array([1j] * q.size, object))


def test_what_is_no_name_is_none_of_the_names(sim):
    result = sim.result
    for name in ([1], np.array([1]), None, 3):
        for names in (result, sim, sim.outputs, sim.inputs, sim.parameters):
            assert name not in names
        with pytest.raises(tautline.ResultError, match="has no variable"):
            result[name]
        with pytest.raises(tautline.UnknownName, match="there is no input"):
            sim.inputs[name] = 0.0
    assert list(sim) == list(sim.outputs) and "payload.position" in sim


def test_simulations_may_come_one_after_the_other(sim):
    copies = [sim.copy() for _ in range(2)]
    tautline.rollout((one for one in copies), until=0.1)
    assert [one.time for one in copies] == [0.1, 0.1]
    with pytest.raises(ArgumentTypeError, match="list of simulations"):
        tautline.rollout(sim, until=0.2)


@pytest.fixture(scope="module")
def brief():
    return tautline.simulate(SCENE.replace({"output.interval": "10 ms"}), end="20 ms")


WORDS_OF_COMMANDS = [
    (lambda result, here: tautline.simulate(HOIST, path=here), "such as", "is a folder"),
    (lambda result, here: tautline.simulate(HOIST, path=HOIST), "with the argument `path`", "is not a result"),
    (lambda result, here: result.plot("nosuch"), "argument what: ", "no figure or variable 'nosuch'"),
    (lambda result, here: result.plot("tension", vs="nosuch"), "argument vs: ", "no variable 'nosuch'"),
    (lambda result, here: result.render(time=99), "argument time: ", "outside of the run"),
    (lambda result, here: result.render(camera="nosuch"), "argument camera: ", "is no view"),
    (lambda result, here: tautline.sweep(HOIST, VARY, folder=HOIST), "with the argument `folder`", "is a file"),
]


@pytest.mark.parametrize(("refused", "named", "cause"), WORDS_OF_COMMANDS)
def test_what_python_is_refused_names_arguments_and_no_option_of_a_command(brief, tmp_path, refused, named, cause):
    with pytest.raises(tautline.ResultError) as told:
        refused(brief, tmp_path)
    assert named in str(told.value) and cause in str(told.value)
    assert not re.search(r"(^| )--?[a-z]", str(told.value))


@pytest.mark.parametrize("given", [{"what": 3}, {"what": "tension", "vs": 3}, {"what": "tension", "beside": 3}])
def test_a_figure_refuses_what_is_no_name_and_no_list_of_results(brief, given):
    with pytest.raises(tautline.ArgumentTypeError, match=rf"{list(given)[-1]} = 3: "):
        brief.plot(**given)
