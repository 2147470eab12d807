"""What a study and a look at stability leave behind: JSON, CSV, NetCDF and figures, read back."""

import csv
import json
import math
from dataclasses import replace

import numpy as np
import pytest
import xarray
from figures.pages import FEW_DOTS, lay_out
from matplotlib.figure import Figure
from study.oscillators import OMEGA, oscillator, rk4, subject

from tautline.cli.commands.study import _table as study_table
from tautline.cli.output.console import finite
from tautline.results.errors import ResultError
from tautline.scene.methods import RK4
from tautline.study import figures
from tautline.study.accuracy.precision import Grid, study
from tautline.study.record import run_record, stability_record, study_record, variant_record, write_csv, write_netcdf
from tautline.study.robustness.stability import Stability, stability
from tautline.study.robustness.variants import Variant

RK4_LIMIT = RK4.limit

RUN = {
    "method", "step", "elements", "position_error", "force_error", "phase_error", "rmse", "cpu_time", "wall_time",
    "real_time_factor", "steps", "newton_iterations", "status",
}  # fmt: skip
"""Keys of a run that the design promises; of the reference; of a critical step; of a variant."""
REFERENCE = {"method", "step", "converged", "observed_order"}
CRITICAL = {"effective_length", "eigenvalue", "bisection"}
VARIANT = {"name", "outcome", "error", "status"}


@pytest.fixture(scope="module")
def found():
    """A study of four runs, of which one stops and one is refused."""
    grid = Grid(("rk4", "newmark"), (0.5, 0.01))
    return study(subject(oscillator(time_end=1.0)), grid, 0.01, 2)


@pytest.fixture(scope="module")
def looked():
    anchored = oscillator(items=["OneNodeSpring: {id: 0, nodes4: [1], stiffness: 300.0}"], time_end=0.3)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("tautline.study.robustness.stability.variants", lambda *_: [
            Variant("as it stands", "right", 1e-3, "done", (), 0.1), Variant("stiff", "stopped", None, "UNSTABLE"),
            Variant("lost", "inaccurate", math.inf, "done", ("careful", "slow"), 0.2, 0.5, 0.0),
        ])  # fmt: skip
        return stability(subject(anchored))


def as_json(record):
    """As it is printed, and read as strictly as any other program would."""
    text = json.dumps(finite(record), allow_nan=False)
    return json.loads(text, parse_constant=lambda word: pytest.fail(f"{word} in JSON"))


# JSON
def test_a_studys_record_has_the_promised_keys_and_no_nan(found):
    record = as_json(study_record(found))
    assert record.keys() >= {"runs", "reference", "advice"}
    assert all(run.keys() >= RUN for run in record["runs"]) and len(record["runs"]) == 4
    assert record["reference"].keys() >= REFERENCE
    assert record["reference"]["converged"] is True
    assert record["reference"]["observed_order"] == pytest.approx(4.0, abs=0.3)
    assert isinstance(record["advice"], str) and record["advice"]


def test_a_run_that_stopped_has_null_for_what_it_does_not_have_and_its_status_by_name(found):
    by = {(run["method"], run["step"]): run for run in as_json(study_record(found))["runs"]}
    stopped = next(run for run in by.values() if run["status"] == "UNSTABLE")
    assert stopped["method"] == "rk4"
    assert [stopped[key] for key in ("position_error", "force_error", "phase_error", "rmse")] == [None] * 4
    done = by["newmark", 0.01]
    assert done["status"] == "done" and done["repetitions"] == 2
    assert 0.0 < done["position_error"] < 0.1 and done["steps"] == 100
    assert done["real_time_factor"] == pytest.approx(done["wall_time"] / 1.0)


def test_the_step_of_a_run_is_the_one_that_was_taken():
    """Frames of 0.02 s are divided into three steps of 6.7 ms, and not into 2.9 of 7."""
    one = study(subject(oscillator(time_end=0.5)), Grid(("newmark",), (0.007,)), 0.01, 1)
    assert run_record(one.rows[0])["step"] == pytest.approx(0.02 / 3.0)


def test_a_study_without_a_reference_is_recorded_as_such(found):
    record = as_json(study_record(replace(found, reference=None)))
    assert record["reference"] is None and record["advice"].startswith("no advice")


def test_a_stabilitys_record_has_the_promised_keys_and_no_nan(looked):
    record = as_json(stability_record(looked))
    assert record.keys() >= {"critical_step", "omega_max", "set_by", "variants"}
    assert record["critical_step"].keys() >= CRITICAL
    assert record["critical_step"]["eigenvalue"] == pytest.approx(RK4_LIMIT / 20.0, rel=1e-3)
    assert record["omega_max"] == pytest.approx(20.0, rel=1e-3) and "anchors" in record["set_by"]
    assert record["critical_step"]["bisection"] < record["critical_step"]["unstable_from"]
    assert all(variant.keys() >= VARIANT for variant in record["variants"])
    assert {entry["kind"] for entry in record["stiffnesses"]} == {"contact"}
    assert record["constraint_drift"] is None and record["energy_drift"] >= 0.0


def test_a_variant_that_is_wrong_without_measure_has_no_number_in_json(looked):
    by = {variant["name"]: variant for variant in as_json(stability_record(looked))["variants"]}
    assert by["lost"]["error"] is None and by["lost"]["outcome"] == "inaccurate"
    assert by["lost"]["warned"] == "careful; slow" and by["stiff"]["status"] == "UNSTABLE"


def test_a_scene_in_which_nothing_vibrates_is_recorded_with_nulls(looked):
    nothing = replace(looked.critical, eigenvalue=None, omega_max=None, bisection=None, at_start=None, set_by="")
    record = as_json(stability_record(replace(looked, critical=nothing, tangent=None)))
    assert record["critical_step"]["eigenvalue"] is record["critical_step"]["bisection"] is record["omega_max"] is None


# files
def test_a_csv_is_read_back_with_units_in_its_head(found, tmp_path):
    records = [run_record(row) for row in found.rows]
    with write_csv(records, tmp_path / "runs.csv").open(newline="", encoding="utf8") as file:
        head, *rows = csv.reader(file)
    names = [name.split(" [")[0] for name in head]
    assert set(names) >= RUN and "wall_time [s]" in head and "rmse [m]" in head and "phase_error [rad]" in head
    assert len(rows) == len(records)
    for row, record in zip(rows, records, strict=True):
        for name, text in zip(names, row, strict=True):
            value = record[name]
            assert text == "" if value is None else text == value if isinstance(value, str) else float(text) == value


def test_a_netcdf_is_read_back_with_units_and_attributes(found, tmp_path):
    records = [run_record(row) for row in found.rows]
    path = write_netcdf(records, {"scene": "a.yaml", "advice": found.advice, "lacking": None}, tmp_path / "runs.nc")
    with xarray.open_dataset(path, engine="h5netcdf") as data:
        assert dict(data.sizes) == {"run": len(records)} and set(data) >= RUN
        assert data["wall_time"].attrs["units"] == "s" and data.attrs["advice"] == found.advice
        assert [str(x) for x in data["status"].values] == [record["status"] for record in records]
        for name in ("position_error", "steps"):
            expected = [np.nan if record[name] is None else record[name] for record in records]
            assert data[name].values == pytest.approx(expected, nan_ok=True)


@pytest.mark.parametrize("writer", [write_csv, lambda rows, path: write_netcdf(rows, {}, path)])
def test_a_file_that_cannot_be_written_is_a_named_error(found, writer, tmp_path):
    (tmp_path / "taken").mkdir()
    with pytest.raises(ResultError, match="cannot be written"):
        writer([run_record(row) for row in found.rows], tmp_path / "taken")


def test_variants_are_written_with_theirs(looked, tmp_path):
    with write_csv([variant_record(v) for v in looked.variants], tmp_path / "v.csv").open(encoding="utf8") as file:
        rows = list(csv.DictReader(file))
    assert [row["outcome"] for row in rows] == ["right", "stopped", "inaccurate"] and rows[0].keys() >= VARIANT


# figures
@pytest.fixture
def drawn(monkeypatch, tmp_path):
    """Draw, and keep the figure that was to be saved; a file is written only if it is asked for."""
    kept = []
    save = figures.save

    def draw(function, found, saved=False):
        monkeypatch.setattr(figures, "save", lambda figure, path: kept.append(figure) or (saved and save(figure, path)))
        with FEW_DOTS:
            function(found, "a title", tmp_path / "figure.png")
        assert not saved or (tmp_path / "figure.png").read_bytes().startswith(b"\x89PNG")
        return kept[-1]

    return draw


def texts(figure: Figure):
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


def test_a_studys_figure_has_its_labels_a_line_at_real_time_and_a_curve_for_a_method(found, drawn):
    figure = drawn(figures.work_precision, found, saved=True)
    labels = [plot.get_ylabel() for plot in figure.axes]
    assert labels == ["position error", "force amplitude error"]
    for plot in figure.axes:
        assert plot.get_xlabel() == "real-time factor"
        assert plot.get_xscale() == plot.get_yscale() == "log"
        lines = {line.get_label(): line.get_xydata() for line in plot.lines}
        assert np.all(lines["real time"][:, 0] == 1.0)
    named = texts(figure)
    assert "real time" in named and "error asked for" in named and any(name.startswith("newmark") for name in named)
    assert any("a title" in text.get_text() for text in [figure._suptitle, *(p.title for p in figure.axes)] if text)


def test_a_curve_shows_the_errors_of_its_runs_against_their_times(found, drawn):
    figure = drawn(figures.work_precision, found)
    rows = [row for row in found.rows if row.errors is not None and row.trial.setting.method == "newmark"]
    curve = next(line for line in figure.axes[0].lines if line.get_label().startswith("newmark"))
    # Which of two short runs took longer is chance, and with it which point is the left one.
    expected = sorted((row.factor, row.errors.position) for row in rows)
    assert np.array(sorted(curve.get_xydata().tolist())) == pytest.approx(np.array(expected))


def test_a_study_of_runs_that_all_failed_is_drawn_and_says_so(drawn, recwarn):
    failed = study(subject(oscillator(time_end=5.0, plotpoints=2)), Grid(("rk4",), (1.0, 0.6)), 0.01, 1)
    assert any("none came to its end" in name for name in texts(drawn(figures.work_precision, failed, saved=True)))
    bare = drawn(figures.work_precision, replace(failed, reference=None))
    lay_out(bare)
    assert "real time" in texts(bare)
    assert [str(warning.message) for warning in recwarn] == []


def test_runs_that_came_to_their_end_without_a_reference_are_not_said_to_have_failed(found, drawn):
    rows = tuple(replace(row, errors=None) for row in found.rows)
    figure = drawn(figures.work_precision, replace(found, rows=rows, reference=None, interrupted=True), saved=True)
    (plot,) = figure.axes
    said = " ".join(text.get_text() for text in plot.texts)
    done = sum(row.trial.done for row in rows)
    assert done and f"came to their end: {done} of {len(rows)}" in said and "no reference to judge them by" in said
    assert not figure.legends


@pytest.mark.parametrize("letters", [10, 60, 120])
def test_the_legend_of_a_studys_figure_is_not_cut(found, drawn, letters):
    rows = tuple(
        replace(row, trial=replace(row.trial, setting=replace(row.trial.setting, constraint=str(k % 5) * letters)))
        for k, row in enumerate(found.rows)
    )
    figure = drawn(figures.work_precision, replace(found, rows=rows))
    lay_out(figure)
    (legend,) = figure.legends
    box = legend.get_window_extent()
    assert letters > 60 or (box.x0 >= 0.0 and box.x1 <= figure.bbox.width)
    assert letters < 60 or legend._ncols < 4


def test_a_run_that_took_shorter_steps_than_asked_for_is_marked_in_table_and_figure(found, drawn):
    row = next(row for row in found.rows if row.errors is not None and row.trial.setting.step_error is None)
    assert row.trial.setting.step and not row.shortened
    longer = replace(row, trial=replace(row.trial, setting=replace(row.trial.setting, step=2.0 * row.step_taken)))
    assert longer.shortened
    told = run_record(longer)
    assert told["step_taken"] == pytest.approx(told["steps"] and float(row.trial.result.time[-1]) / told["steps"])
    figure = drawn(figures.work_precision, replace(found, rows=(longer,)))
    assert "took shorter steps than asked for" in texts(figure)
    rings = [line for line in figure.axes[0].lines if line.get_markersize() == 10.0 and line.get_xdata().size]
    assert [line.get_xydata().tolist() for line in rings] == [[[row.factor, row.errors.position]]]
    cells = [cell for column in study_table((longer, row)).columns for cell in column.cells]
    assert f"{told['steps']}*" in cells and str(told["steps"]) in cells


def test_a_run_without_any_error_is_drawn_where_a_logarithm_can(drawn):
    rest = study(subject(oscillator(start=0.0, time_end=0.5)), Grid(("newmark",), (0.01,)), 0.01, 1)
    figure = drawn(figures.work_precision, rest)
    assert all(np.isfinite(line.get_xydata()).all() for line in figure.axes[0].lines)


def test_a_stabilitys_figure_shows_the_eigenvalues_in_the_region_and_what_springs_do(looked: Stability, drawn):
    figure = drawn(figures.stability_figure, looked, saved=True)
    region, springs = figure.axes
    assert (region.get_xlabel(), region.get_ylabel()) == ("Re h λ", "Im h λ")
    points = next(line for line in region.lines if line.get_label().startswith("eigenvalues")).get_xydata()
    assert np.sort(points[:, 1]) == pytest.approx([-RK4_LIMIT, RK4_LIMIT], rel=1e-6)
    assert springs.get_xlabel() == "stiffness of springs [N/m]"
    curve = springs.lines[0].get_xydata()
    assert curve[:, 1] == pytest.approx(RK4_LIMIT / np.sqrt(OMEGA**2 + curve[:, 0]), rel=1e-6)


def test_the_region_that_is_drawn_is_where_rk4_shrinks(looked, drawn):
    """Inside at -1 + 2i, outside at -1 + 2.9i and at 0.3: by the cut-off exponential."""
    region = drawn(figures.stability_figure, looked).axes[0]
    paths = [path for collection in region.collections for path in collection.get_paths()]

    def inside(z):
        return any(path.contains_point((z.real, z.imag)) for path in paths)

    assert inside(-1 + 2j) and inside(-2.7 + 0j) and inside(-0.05 + 2.7j)
    assert not inside(-1 + 2.9j) and not inside(0.3 + 0j) and not inside(-2.9 + 0j)


def test_a_scene_without_springs_and_without_eigenvalues_is_drawn_too(looked, drawn):
    nothing = replace(looked.critical, eigenvalue=None, points=np.zeros(0, complex))
    assert len(drawn(figures.stability_figure, replace(looked, penalties=[], critical=nothing)).axes) == 1


def test_figures_of_runs_of_the_methods_that_the_scene_has(drawn):
    only = study(subject(oscillator(time_end=0.3, **rk4(time_step=0.01))), Grid(None, (0.01,)), 0.01, 1)
    names = texts(drawn(figures.work_precision, only))
    assert [name for name in names if name in ("rk4", "generalized-alpha")] == ["rk4", "generalized-alpha"]
