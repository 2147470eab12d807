"""What a sweep's file may say, and what is refused with line, key, value, cause and cure before anything is written."""

import numpy as np
import pytest
from sweep.short_hoist import HOIST, MASS, PERIOD, hoist, write_sweep

import tautline
from tautline.sweeps.execution import Execution
from tautline.sweeps.file import plan_cases, read_sweep


def cases_of_text(tmp_path, text):
    read = read_sweep(write_sweep(tmp_path, text))
    scene = hoist()
    return plan_cases(read, tautline._installed().of(scene), scene)


def test_numbers_are_in_si_and_keep_the_unit_of_their_key(tmp_path):
    cases = cases_of_text(
        tmp_path, f"vary: {{'{MASS}': [2 t, 5000, 10000 kg], '{PERIOD}': {{linspace: [5 s, 15, 3]}}}}"
    )
    assert list(cases.parameters[0].numbers) == [2000.0, 5000.0, 10000.0] and cases.parameters[0].unit == "kg"
    assert cases.parameters[0].values == ("2 t", 5000, "10000 kg")
    assert list(cases.parameters[1].numbers) == [5.0, 10.0, 15.0] and cases.parameters[1].unit == "s"
    assert [one.base for one in cases.parameters] == [5000.0, 8.0]


def test_a_series_ends_at_its_ends_and_logspace_rises_by_equal_ratios(tmp_path):
    cases = cases_of_text(tmp_path, f"vary: {{'{MASS}': {{logspace: [100 kg, 10 t, 5]}}}}")
    numbers = np.array(cases.parameters[0].numbers)
    assert numbers[0] == 100.0 and numbers[-1] == 10000.0
    assert np.allclose(numbers[1:] / numbers[:-1], 10**0.5)


def test_whole_numbers_stay_whole_where_the_key_has_no_unit(tmp_path):
    cases = cases_of_text(tmp_path, "vary: {mesh.elements_per_span: {linspace: [2, 8, 4]}}")
    assert cases.parameters[0].values == (2, 4, 6, 8)


def test_a_series_with_a_value_that_is_not_whole_is_refused_for_that_value_alone(tmp_path):
    with pytest.raises(tautline.SceneError) as found:
        tautline.sweep(hoist(), {"mesh.elements_per_span": {"linspace": [2, 5, 3]}}, collect=["rise"], jobs=1)
    (line,) = str(found.value).splitlines()
    assert "mesh.elements_per_span = 3.5: must be a whole number" in line


def test_shapes_of_distributions_have_no_unit(tmp_path):
    text = f"vary: {{'{MASS}': {{weibull: [2 t, 1.5]}}}}\nplan: {{monte_carlo: {{samples: 3}}}}"
    assert cases_of_text(tmp_path, text).parameters[0].spread.numbers == (2000.0, 1.5)


VARY, MASSES = "vary:\n", "vary:\n  'bodies[0].mass': [2 t]\n"
UNIFORM = "vary:\n  'bodies[0].mass': {uniform: [2 t, 3 t]}\n"
REFUSED = {
    VARY + "  bodies[0].mas: [2 t]": ("limits.yaml:3", "vary.bodies[0].mas", "unknown key", "did you mean 'mass'"),
    VARY + "  'bodies[3].mass': [2 t]": ("limits.yaml:3", "bodies[3]", "there is no such entry"),
    VARY + "  'bodies[0].mass': [2 t, 5 m]": ("limits.yaml:3", "5 m", "not the unit of a mass"),
    VARY + "  'bodies[0].mass': [2 t, -1 t]": ("limits.yaml:3", "-1 t", "must not be negative"),
    VARY + "  'bodies[0].mass': []": ("limits.yaml:3", "empty list"),
    "vary: {}": ("limits.yaml:2", "varies nothing"),
    VARY + "  'bodies[0].mass': {linspac: [1, 2, 3]}": ("limits.yaml:3", "did you mean 'linspace'"),
    VARY + "  'bodies[0].mass': {linspace: [1 t, 2 t]}": ("limits.yaml:3", "needs three numbers"),
    VARY + "  'bodies[0].mass': {linspace: [1, 5, 1000000000]}": (
        "limits.yaml:3",
        "makes 1000000000 values, more than 1000000",
        "take fewer",
    ),
    VARY + "  'bodies[0].mass': {linspace: [1, 5, 2.5]}": ("limits.yaml:3", "must end with a whole number of values"),
    VARY + "  'bodies[0].mass': {normal: [5 t]}\nplan: {sobol: {samples: 4}}": ("limits.yaml:3", "takes 2 numbers"),
    VARY + "  'bodies[0].mass': {uniform: [5 t, 4 t]}\nplan: {sobol: {samples: 4}}": (
        "limits.yaml:3",
        "below its upper",
    ),
    VARY + "  'bodies[0].mass': {uniform: [4 t, 5 t]}": ("limits.yaml", "no place for a distribution", "take a plan"),
    MASSES + "plan: gird": ("limits.yaml:4", "plan = gird", "did you mean 'grid'"),
    MASSES + "plan: sobol": ("limits.yaml:4", "number of samples", "samples: 100"),
    MASSES + "plan: {sobol: {samples: 0}}": ("limits.yaml:4", "whole number above zero"),
    MASSES + "verb: torque-drag": ("limits.yaml:4", "no verb with a table of crane"),
    MASSES + "colect: [rise]": ("limits.yaml:4", "did you mean 'collect'"),
    MASSES + "collect: [{output: winch.tensio}]": (
        "limits.yaml:4",
        "did you mean 'winch.tension'",
    ),
    MASSES + "collect: [{output: winch.tension, statistic: maks}]": ("known: max, min",),
    MASSES + "collect: [{output: payload.position}]": (
        "no single number",
        "payload.position[0]",
    ),
    MASSES + "collect: [max_tensoin]": ("limits.yaml:4", "did you mean 'max_tension'"),
    VARY + "  'bodies[0].mass': {normal: [1 t, 5 t]}\nplan: {sobol: {samples: 8, seed: 1}}": (
        "limits.yaml:3",
        "must not be negative",
        "the normal distribution reaches there: take truncated_normal",
    ),
    MASSES + "collect: [{output: winch.tension, name: status}]": ("limits.yaml:4", "every result has", "another name"),
    MASSES + "collect: [{output: winch.tension, name: percentile}]": ("limits.yaml:4", "every result has"),
    MASSES + "collect: [{output: winch.tension, name: 'bodies[0].mass'}]": ("limits.yaml:4", "every result has"),
    UNIFORM + "plan: {monte_carlo: {samples: 4}}\ncollect: [rise, {output: winch.tension, name: rise_percentiles}]": (
        "limits.yaml:5",
        "makes of 'rise'",
    ),
    UNIFORM + "plan: {monte_carlo: {samples: 4}}\n"
    "collect: [{output: winch.tension, name: a_percentiles_of}, {output: rise, name: a}]": (
        "makes of 'a'",
        "another name",
    ),
    UNIFORM + "plan: {sobol: {samples: 4}}\nindices: sobol\n"
    "collect: [rise, {output: winch.tension, name: rise_total_interval}]": ("limits.yaml:6", "makes of 'rise'"),
    MASSES + "collect: [rise, rise]": ("limits.yaml:4", "stands twice"),
    MASSES + "indices: sobol": ("no Sobol' indices", "sobol: {samples"),
    VARY + "  'bodies[0].mass': [2 t, 2000]": ("limits.yaml", "bodies[0].mass = 2000 twice", "each value once"),
    VARY + "  'bodies[0].mass': [2 t]\n  bodies[0]: [{name: payload, mass: 5 t, position: [12.4, 0, 5]}]": (
        "limits.yaml:4",
        "bodies[0].mass is a part of bodies[0]",
        "keep one",
    ),
    VARY + "  'solver.step': [1 ms, 20 ms]\n  'solver.end': [10 ms]": (
        "limits.yaml:4",
        "before the first step ends (0.02 s)",
    ),
}


@pytest.mark.parametrize("text", REFUSED)
def test_a_fault_is_refused_with_its_place_and_cure_and_nothing_is_written(tmp_path, text, in_folder):
    path = write_sweep(tmp_path, text)
    before = sorted(one.name for one in tmp_path.iterdir())
    code, said = in_folder(tmp_path, path.name)
    assert code == 2, said
    for part in REFUSED[text]:
        assert part in said
    assert sorted(one.name for one in tmp_path.iterdir()) == before


@pytest.fixture
def in_folder(monkeypatch, capsys):
    """Run `crane sweep` in this process: exit code, and what was said."""

    def run(folder, *words):
        from crane.application import Crane
        from tautline.cli.run import run as run_command
        from tautline.cli.verbs import make_app

        monkeypatch.chdir(folder)
        monkeypatch.setenv("COLUMNS", "400")
        with pytest.raises(SystemExit) as end:
            run_command(make_app(Crane(), ["sweep"]), ["sweep", *words])
        return end.value.code, capsys.readouterr().err

    return run


def test_the_scene_of_a_sweep_is_looked_for_beside_its_file(tmp_path, in_folder):
    folder = tmp_path / "inner"
    folder.mkdir()
    write_sweep(folder, f"vary: {{'{MASS}': [2 t]}}\ncollect: [rise]", "50 ms")
    code, told = in_folder(tmp_path, "inner/limits.yaml", "-q", "--json")
    assert code == 0, told
    assert (tmp_path / "limits" / "sweep.nc").exists()


def test_python_takes_numpy_arrays_and_a_scene_of_any_form(tmp_path):
    data = tautline.sweep(hoist(0.05), {MASS: np.array([2000.0, 5000.0])}, collect=["max_tension"], jobs=1)
    assert data["max_tension"].dims == (MASS,) and data["max_tension"].attrs["units"] == "N"
    assert list(data[MASS].values) == [2000.0, 5000.0] and data[MASS].attrs["units"] == "kg"
    assert HOIST.exists()


def test_a_number_of_workers_below_zero_is_refused():
    with pytest.raises(tautline.SceneError, match=r"jobs -1: is less than zero"):
        tautline.sweep(hoist(0.05), {MASS: [2000.0]}, collect=["rise"], jobs=-1)


def test_a_name_that_no_run_finds_is_refused_before_the_first_run_though_no_case_would_end(monkeypatch):
    from tautline.sweeps.cases import Runner

    monkeypatch.setattr(Runner, "run", lambda *given: pytest.fail("a case was run"))
    with pytest.raises(tautline.SceneError, match="did you mean 'max_tension'"):
        tautline.sweep(hoist(0.05), {MASS: [2000.0]}, collect=["max_tensoin"], jobs=1)


@pytest.mark.parametrize(
    ("folder", "message"),
    [("/proc/none", "/proc/none: cannot be made"), ("mine/x", "mine is a file, not a folder"), ("no/x", "mkdir -p no")],
)
def test_a_folder_that_cannot_be_made_is_bad_input_that_names_it(folder, message, tmp_path, monkeypatch):
    from tautline.results.errors import ResultError, WriteError

    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine").write_text("kept")
    with pytest.raises(ResultError, match=message) as refused:
        tautline.sweep(hoist(0.05), {MASS: [2000.0]}, collect=["rise"], jobs=1, folder=folder)
    assert not isinstance(refused.value, WriteError)
    assert [file.name for file in tmp_path.iterdir()] == ["mine"]


def test_how_long_the_values_of_a_large_grid_are_tried_is_said(monkeypatch):
    from tautline.sweeps import sweep as module

    monkeypatch.setattr(module, "PATIENCE", 0.0)
    monkeypatch.setattr(module, "TRIED", 5)
    said = []
    read = read_sweep({"scene": "s", "vary": {MASS: list(range(1000, 1020))}, "collect": ["rise"]})
    scene = hoist(0.05)
    module.run_sweep(read, tautline._installed().of(scene), scene, Execution(jobs=1, say=said.append))
    assert said[0].startswith("the values of 20 cases are tried first")
