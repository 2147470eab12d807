"""Plans: which values each case has, beside grids made by hand and SciPy itself."""

import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy import stats
from scipy.stats import qmc
from sweep.short_hoist import hoist

import tautline
from tautline.sweeps.distributions import KINDS, made
from tautline.sweeps.plans import GRID, LATIN, ONE, RANDOM, SOBOL, ZIP, Parameter, Plan, balanced, cases_of


def listed(key, *values):
    return Parameter(key, "m", values, tuple(float(value) for value in values), None, 7.0)


def spread(key, name, *numbers):
    return Parameter(key, "m", (), (), made(name, numbers), 7.0)


def rows(cases):
    return [tuple(cases.numbers[one.key][case] for one in cases.parameters) for case in range(len(cases))]


def test_a_grid_has_every_combination_once_the_last_parameter_changing_fastest():
    cases = cases_of([listed("a", 1, 2), listed("b", 10, 20, 30)], Plan(GRID))
    assert rows(cases) == [(1, 10), (1, 20), (1, 30), (2, 10), (2, 20), (2, 30)]
    assert cases.dims == ("a", "b") and cases.shape == (2, 3)
    assert cases.changes(4) == {"a": 2, "b": 20}


def test_zip_takes_the_nth_value_of_each_and_refuses_unequal_numbers():
    assert rows(cases_of([listed("a", 1, 2), listed("b", 10, 20)], Plan(ZIP))) == [(1, 10), (2, 20)]
    with pytest.raises(ValueError, match="a has 2, b has 3"):
        cases_of([listed("a", 1, 2), listed("b", 1, 2, 3)], Plan(ZIP))


def test_one_at_a_time_begins_with_the_scene_and_leaves_the_others_as_they_are():
    cases = cases_of([listed("a", 1, 2), spread("b", "normal", 5.0, 1.0)], Plan(ONE))
    tails = stats.norm(5.0, 1.0).ppf([0.1, 0.9])
    assert rows(cases) == [(7, 7), (1, 7), (2, 7), (7, tails[0]), (7, tails[1])]
    assert cases.changes(0) == {} and cases.changes(2) == {"a": 2}


@pytest.mark.parametrize(("name", "engine"), [(LATIN, qmc.LatinHypercube), (SOBOL, qmc.Sobol)])
def test_samples_are_quantiles_at_the_points_of_scipy(name, engine):
    cases = cases_of([spread("a", "normal", 5.0, 2.0), spread("b", "uniform", -1.0, 3.0)], Plan(name, 16, 3))
    points = engine(2, seed=3).random(16)
    assert np.allclose(cases.numbers["a"], stats.norm(5.0, 2.0).ppf(points[:, 0]), rtol=1e-14)
    assert np.allclose(cases.numbers["b"], -1.0 + 4.0 * points[:, 1], rtol=1e-14)


def test_a_latin_hypercube_has_one_sample_in_each_slice_of_each_parameter():
    cases = cases_of([spread("a", "uniform", 0.0, 20.0), spread("b", "weibull", 2.0, 1.5)], Plan(LATIN, 20, 5))
    assert sorted(np.floor(cases.numbers["a"])) == list(range(20))
    probability = 1.0 - np.exp(-((cases.numbers["b"] / 2.0) ** 1.5))
    assert sorted(np.floor(20.0 * probability)) == list(range(20))


def test_the_same_seed_gives_the_same_cases_and_another_gives_others():
    def drawn(seed):
        return cases_of([spread("a", "uniform", 0.0, 1.0)], Plan(RANDOM, 50, seed)).numbers["a"]

    assert np.array_equal(drawn(1), drawn(1)) and not np.array_equal(drawn(1), drawn(2))


def test_values_of_a_list_are_equally_likely_in_a_plan_that_samples():
    cases = cases_of([listed("a", 1, 2, 3, 4)], Plan(LATIN, 40, 0))
    assert [list(cases.numbers["a"]).count(k) for k in (1, 2, 3, 4)] == [10, 10, 10, 10]


@pytest.mark.parametrize(
    ("name", "numbers", "mean", "sd"),
    [
        ("normal", (5.0, 2.0), 5.0, 2.0),
        ("lognormal", (5.0, 2.0), 5.0, 2.0),
        ("uniform", (2.0, 8.0), 5.0, 6.0 / math.sqrt(12.0)),
        ("triangular", (0.0, 2.0, 4.0), 2.0, 4.0 / math.sqrt(24.0)),
        ("rayleigh", (2.0,), 2.0 * math.sqrt(math.pi / 2.0), 2.0 * math.sqrt(2.0 - math.pi / 2.0)),
        ("exponential", (3.0,), 3.0, 3.0),
        ("gumbel", (1.0, 2.0), 1.0 + 2.0 * 0.5772156649, 2.0 * math.pi / math.sqrt(6.0)),
        ("weibull", (2.0, 1.5), 2.0 * math.gamma(5 / 3), 2.0 * math.sqrt(math.gamma(7 / 3) - math.gamma(5 / 3) ** 2)),
        ("truncated_normal", (5.0, 2.0, 3.0, 7.0), 5.0, 2.0 * math.sqrt(1.0 - 2.0 * 0.24197072 / 0.68268949)),
    ],
)
def test_quantiles_have_the_mean_and_the_deviation_of_the_textbook(name, numbers, mean, sd):
    # Midpoints of equal probabilities; tails beyond the last make the error.
    values = made(name, numbers).quantiles((np.arange(200_000) + 0.5) / 200_000)
    assert values.mean() == pytest.approx(mean, rel=1e-4)
    assert values.std() == pytest.approx(sd, rel=2e-3)
    assert name in KINDS


def test_no_probability_gives_an_infinite_value():
    assert np.isfinite(made("normal", (0.0, 1.0)).quantiles(np.array([0.0, 1.0]))).all()


def test_the_cases_of_sobol_indices_are_in_the_order_that_salib_reads():
    parameters = [spread("a", "uniform", 0.0, 1.0), spread("b", "uniform", 0.0, 1.0)]
    table = np.array(rows(cases_of(parameters, Plan(SOBOL, 8, 2), True))).reshape(8, 4, 2)
    both = qmc.Sobol(4, seed=2).random(8)
    first, second = both[:, :2], both[:, 2:]
    assert np.allclose(table[:, 0], first) and np.allclose(table[:, 3], second)
    assert np.allclose(table[:, 1], np.column_stack([second[:, 0], first[:, 1]]))
    assert np.allclose(table[:, 2], np.column_stack([first[:, 0], second[:, 1]]))


def test_sobol_points_are_balanced_at_powers_of_two_only():
    assert [n for n in range(1, 20) if balanced(n)] == [1, 2, 4, 8, 16]


def of_function(cases, values):
    """The result of a sweep whose cases came to these values of `y`."""
    from tautline.results.tables.finding import Finding
    from tautline.sweeps.cases import Row
    from tautline.sweeps.table import dataset

    rows = [Row(case, "done", values={"y": float(value)}) for case, value in enumerate(values)]
    return dataset(cases, {"y": Finding(None, "", "y")}, rows, {})


@pytest.mark.parametrize(("failed", "left"), [([], 8), ([0, 1, 9], 6), (list(range(0, 28, 4)), 1)])
def test_sobol_indices_tell_how_many_samples_are_left_where_cases_failed(failed, left):
    """Four cases make a sample of two parameters: one that failed takes the three others with it."""
    from types import SimpleNamespace

    from tautline.cli.commands.sweep import _left_of_samples, _samples
    from tautline.sweeps.figures import _indices_figure
    from tautline.sweeps.indices import sobol_indices

    cases = cases_of([spread(key, "uniform", 0.0, 1.0) for key in "ab"], Plan("sobol", 8, 3), True)
    values = cases.numbers["a"] + 2.0 * cases.numbers["b"]
    values[failed] = np.nan
    data = of_function(cases, values)
    data = data.with_variables(sobol_indices(data, cases))
    assert int(data["y_indices_of"].values) == left
    outcome = SimpleNamespace(data=data, cases=cases)
    assert _samples(outcome) == {"y": (left, 8)}
    text = "".join(_left_of_samples(outcome))
    assert (f"{left} of 8 samples" in text) == bool(failed) and ("no Sobol' indices" in text) == (left == 1)
    if left > 1:
        heading = _indices_figure(data, "y").axes[0].get_figure().get_suptitle()
        shown = heading + "".join(one.get_text() for one in _indices_figure(data, "y").texts)
        shown += "".join(
            one.get_title(loc=side) for one in _indices_figure(data, "y").axes for side in ("left", "center")
        )
        assert ("of 6 of 8 samples" in shown) == bool(failed)


@pytest.mark.parametrize("failed", [[], [0, 1, 9]])
def test_a_result_that_no_parameter_changes_is_said_to_have_no_sobol_indices(failed):
    from types import SimpleNamespace

    from tautline.cli.commands.sweep import _left_of_samples
    from tautline.sweeps.indices import sobol_indices

    cases = cases_of([spread(key, "uniform", 0.0, 1.0) for key in "ab"], Plan("sobol", 8, 3), True)
    values = np.full(len(cases), 3.0)
    values[failed] = np.nan
    data = of_function(cases, values)
    data = data.with_variables(sobol_indices(data, cases))
    (text,) = _left_of_samples(SimpleNamespace(data=data, cases=cases))
    assert text == "there are no Sobol' indices of y: the same in all samples"


def test_sobol_indices_of_the_function_of_ishigami_are_those_of_its_closed_form():
    # Ishigami and Homma 1990, a = 7, b = 0.1: the third parameter acts by its interaction with the first alone.
    from tautline.sweeps.indices import sobol_indices

    cases = cases_of([spread(key, "uniform", -np.pi, np.pi) for key in "abc"], Plan("sobol", 1024, 3), True)
    x, y, z = (cases.numbers[key] for key in "abc")
    found = sobol_indices(of_function(cases, np.sin(x) + 7.0 * np.sin(y) ** 2 + 0.1 * z**4 * np.sin(x)), cases)
    assert np.allclose(found["y_first"].values, [0.3139, 0.4424, 0.0], atol=0.03)
    assert np.allclose(found["y_total"].values, [0.5576, 0.4424, 0.2437], atol=0.03)
    assert np.all(np.abs(found["y_first"].values - [0.3139, 0.4424, 0.0]) < found["y_first_interval"].values)


def test_percentiles_of_a_linear_function_of_a_normal_variable_are_its_quantiles():
    for name in (LATIN, SOBOL):
        cases = cases_of([spread("a", "normal", 5.0, 2.0)], Plan(name, 1024, 1))
        found = of_function(cases, 3.0 * cases.numbers["a"] + 1.0)["y_percentiles"].values
        assert np.allclose(found, 16.0 + 6.0 * np.array([-1.28155, 0.0, 1.28155]), atol=0.05), name


def test_percentiles_of_a_list_without_places_are_numbered_in_their_table(tmp_path):
    from tautline.results.tables.finding import Finding
    from tautline.sweeps.cases import Row
    from tautline.sweeps.table import dataset, write_percentiles

    cases = cases_of([spread("a", "normal", 5.0, 2.0)], Plan(LATIN, 4, 1))
    lists = [Row(case, "done", values={"y": [1.0, 2.0]}) for case in range(4)]
    path = write_percentiles(dataset(cases, {"y": Finding(None, "N", "y")}, lists, {}), tmp_path / "percentiles.csv")
    assert path.read_text().splitlines()[1:] == ["y,N,y number,0.0,1.0,1.0,1.0,4", "y,N,y number,1.0,2.0,2.0,2.0,4"]


@pytest.mark.parametrize("name", ["x_percentiles", "x_percentiles_of", "x_first", "x_indices_of"])
def test_a_name_that_ends_as_those_of_made_columns_is_an_ordinary_one(name, tmp_path):
    from tautline.results.tables.finding import Finding
    from tautline.sweeps.cases import Row
    from tautline.sweeps.indices import has_indices, samples_left
    from tautline.sweeps.table import dataset, percentiles_of, write_percentiles

    rows = [Row(case, "done", values={name: 2.0 + case}) for case in range(4)]
    grid = dataset(cases_of([listed("a", 1, 2, 3, 4)], Plan(GRID)), {name: Finding(None, "N", "x")}, rows, {})
    assert not percentiles_of(grid) and not has_indices(grid, "x") and samples_left(grid, "x") is None
    assert write_percentiles(grid, tmp_path / "none.csv") is None
    spread_over = cases_of([spread("a", "normal", 5.0, 2.0)], Plan(LATIN, 4, 1))
    sampled = dataset(spread_over, {name: Finding(None, "N", "x")}, rows, {})
    assert list(percentiles_of(sampled)) == [name]
    assert sampled[name].values.tolist() == [2.0, 3.0, 4.0, 5.0]
    (_, line) = write_percentiles(sampled, tmp_path / "some.csv").read_text().splitlines()
    assert line.startswith(f"{name},N,,,") and line.endswith(",3.5,4.7,4")


def test_the_file_of_a_sweep_is_the_one_that_xarray_writes_of_its_dataset(tmp_path):
    import xarray

    from tautline.sweeps.table import write_netcdf

    grid = cases_of([listed("a", 1, 2), listed("b", 10, 20, 30)], Plan(GRID))
    sampled = cases_of([spread("bodies[0].mass", "normal", 5.0, 2.0)], Plan(LATIN, 4, 1))
    for cases in (grid, sampled):
        made = of_function(cases, np.where(np.arange(len(cases)) == 1, np.nan, np.arange(len(cases))))
        made.to_xarray().to_netcdf(tmp_path / "theirs.nc", engine="h5netcdf")
        files = [tmp_path / "theirs.nc", write_netcdf(made, tmp_path / "ours.nc")]
        theirs, ours = (xarray.load_dataset(path, engine="h5netcdf") for path in files)
        xarray.testing.assert_identical(ours, theirs)
        assert {n: v.dtype for n, v in ours.variables.items()} == {n: v.dtype for n, v in theirs.variables.items()}
        filled = [{n for n, v in one.variables.items() if "_FillValue" in v.encoding} for one in (ours, theirs)]
        assert filled[0] == filled[1]


def test_a_sweep_that_writes_its_files_loads_neither_xarray_nor_dask(tmp_path):
    data = Path(__file__).parents[2] / "data"
    (tmp_path / "s.yaml").write_text(f"scene: {data / 'hoist.yaml'}\nvary:\n  bodies[0].mass: [3 t]\nplan: grid\n")
    code = (
        "import sys; sys.argv = ['crane', 'sweep', 's.yaml', '-q', '-j', '1', '--set', 'solver.end=0.2']\n"
        "from crane.main import main\n"
        "try:\n    main()\nexcept SystemExit:\n    pass\n"
        "import json; print(json.dumps(sorted({n.split('.')[0] for n in sys.modules})))"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    loaded = set(json.loads(done.stdout.splitlines()[-1]))
    assert (tmp_path / "s" / "sweep.nc").exists(), done.stderr
    assert not loaded & {"xarray", "pandas", "dask", "distributed"}


def test_null_in_a_list_is_a_value_and_takes_away_that_of_the_scene(tmp_path):
    key = "rope.breaking_load"
    assert hoist(0.05).rope.breaking_load is not None
    for plan in ("grid", "zip", "one_at_a_time"):
        folder = tmp_path / plan
        data = tautline.sweep(
            hoist(0.05), {key: [None, "1.1 MN", "2.2 MN"]}, plan, ["safety_factor"], jobs=1, folder=folder
        )  # fmt: skip
        first = 1 if plan == "one_at_a_time" else 0
        assert (data["status"].values == "done").all()
        words = ["as in the scene"] * first + ["null", "1.1 MN", "2.2 MN"]
        assert data[key].values.tolist() == words
        rows = (folder / "sweep.csv").read_text(encoding="utf8").splitlines()[1:]
        assert [row.split(",")[1] for row in rows] == words
        factors = data["safety_factor"].values
        assert np.isnan(factors[first]) and factors[first + 2] == pytest.approx(2.0 * factors[first + 1])
        assert first == 0 or factors[0] == factors[2]


def test_a_grid_refuses_null_twice_and_by_its_own_name():
    with pytest.raises(tautline.SceneError, match=r"has rope.breaking_load = null twice"):
        tautline.sweep(hoist(0.05), {"rope.breaking_load": [None, "2 MN", None]}, collect=["rise"], jobs=1)
