"""Runs of a sweep: the numbers are those of single runs, a failed case is a row, and what is written is whole."""

import json
import re

import numpy as np
import pytest
import xarray
from sweep.short_hoist import HOIST, MASS, PERIOD, hoist, write_sweep

import tautline
from tautline.results.tables.finding import Finding
from tautline.scene.errors import SceneError
from tautline.sweeps.cases import Row, Runner, job_of
from tautline.sweeps.execution import Execution
from tautline.sweeps.file import Collected
from tautline.sweeps.sweep import Outcome
from tautline.sweeps.workers import Measured, how

VARY = {PERIOD: {"linspace": [5, 9, 3]}, MASS: ["2 t", "5 t"]}
COLLECT = ["max_tension", "dynamic_amplification", "slack_events", {"output": "winch.tension", "statistic": "max"}]


@pytest.mark.parametrize("jobs", [1, 2])
def test_six_cases_are_six_single_runs_to_the_bit(jobs):
    scene = hoist(2.0)
    data = tautline.sweep(scene, VARY, "grid", COLLECT, jobs=jobs)
    assert data["max_tension"].shape == (3, 2)
    for period in data[PERIOD].values:
        for mass, written in zip(data[MASS].values, VARY[MASS], strict=True):
            alone = tautline.simulate(scene.replace({PERIOD: float(period), MASS: written}))
            one = data.sel({PERIOD: period, MASS: mass})
            assert one["status"].item() == "done"
            for name in ("max_tension", "dynamic_amplification", "slack_events"):
                assert one[name].item() == alone.headline[name]["value"]
            assert one["winch.tension max"].item() == float(alone["drum_tension"].max())


def test_every_figure_is_collected_where_none_is_named_and_alike_where_one_is():
    scene = hoist(0.5)
    application = tautline._installed().of(scene)
    alone = tautline.simulate(scene).headline

    def row(*names):
        runner = Runner(job_of(application, scene, "simulate", {}, [Collected(name=n, figure=n) for n in names]))
        return runner.run(0, {})[0].values

    whole = row()
    assert {name: whole[name] for name in alone} == {name: one["value"] for name, one in alone.items()}
    for name in alone:
        assert row(name) == {name: alone[name]["value"]}


def test_a_case_that_fails_is_a_row_with_status_and_message_and_the_others_go_on():
    # 25 m of rope at 20 m/s: the hook comes to the sheave after 1.3 s.
    key = "path[0].drum.pay_out.ramp.to"
    data = tautline.sweep(hoist(2.0), {key: [-0.5, -20.0, -0.6]}, "grid", ["rise"], jobs=1)
    assert list(data["status"].values) == ["done", "two blocked", "done"]
    assert "t = 1." in data["message"].values[1] and data["message"].values[0] == ""
    assert np.isfinite(data["rise"].values).tolist() == [True, False, True]


def test_a_scene_in_the_syntax_of_cables_is_swept_as_any_other(tmp_path):
    """A bar that hangs at rest carries its own weight w L at the top; the element reads it at its ends."""
    bar = tmp_path / "bar.yaml"
    bar.write_text(
        "CableModelMaterial: {Gravity: [0, 0, -10]}\nCableModel:\n"
        "  - Node7Dof: {id: 0, xyz: [0, 0, 0], BC: [1, 1, 1, 0, 0, 0, 1]}\n"
        "  - Node7Dof: {id: 1, xyz: [0, 0, -8], BC: [0, 0, 0, 0, 0, 0, 1]}\n"
        "  - CableLine: {id: 0, nodes7: [0, 1], elements: 4, EA: 1.0e6, rhoA: 1, strain: engineering}\n"
        "GeneralizedAlpha: {type: G-alpha, rho_inf: 0.8, time_step: 0.005, time_end: 0.01, start: static}\n",
        encoding="utf8",
    )
    vary = {"CableModel[2].CableLine.rhoA": [1.0, 2.0]}
    data = tautline.sweep(tautline.read(bar), vary, "grid", ["axial_force_max"], folder=tmp_path / "swept", jobs=1)
    assert data["axial_force_max"].values == pytest.approx([10.0 * 8.0, 20.0 * 8.0], rel=1e-6)


def test_a_scene_that_cannot_be_built_is_a_row_too():
    data = tautline.sweep(hoist(0.1), {"path[1].sheave.center[2]": [30.0, 4.0]}, "grid", ["rise"], jobs=1)
    assert list(data["status"].values) == ["done", "bad input"]
    assert "hangs from" in data["message"].values[1]


def test_the_limits_of_the_scene_are_counted():
    data = tautline.sweep(hoist(0.1), {"rope.breaking_load": ["1.1 MN", "10 kN"]}, collect=["limits_failed"], jobs=1)
    ratio = data["limits_failed"].values
    assert ratio[1] == ratio[0] + 1


def test_limits_that_every_run_is_judged_by_are_columns_where_they_are_asked_for():
    words = ("failed", "value", "margin")
    collect = ["max_tension", *(f"run_limit.breaking_load.{word}" for word in words)]
    data = tautline.sweep(hoist(0.1), {"rope.breaking_load": ["1.1 MN", "10 kN"]}, collect=collect, jobs=1)
    failed, value, margin = (data[f"run_limit.breaking_load.{word}"].values for word in words)
    tension = data["max_tension"].values
    assert failed.tolist() == [0, 1] and value.tolist() == tension.tolist()
    assert margin == pytest.approx(np.array([1.1e6, 10e3]) - tension)
    every = tautline.sweep(hoist(0.1), {"rope.breaking_load": ["1.1 MN"]}, jobs=1)
    assert not [name for name in every.data_vars if name.startswith("run_limit")]
    with pytest.raises(SceneError, match=r"run_limit\.breaking\.failed"):
        tautline.sweep(hoist(0.1), {"rope.breaking_load": ["1.1 MN"]}, collect=["run_limit.breaking.failed"], jobs=1)


@pytest.mark.parametrize(
    ("statistic", "expected"),
    [
        ("min", np.min),
        ("range", np.ptp),
        ("p90", lambda x: np.percentile(x, 90)),
        ("last", lambda x: x[-1]),
        ("mean", lambda x: np.trapezoid(x, dx=1.0) / (len(x) - 1)),
        ("rms", lambda x: np.sqrt(np.trapezoid(x**2, dx=1.0) / (len(x) - 1))),
    ],
)
def test_a_statistic_is_that_of_the_frames(statistic, expected):
    scene = hoist(1.0)
    data = tautline.sweep(
        scene, {MASS: ["3 t"]}, collect=[{"output": "payload.position[2]", "statistic": statistic, "name": "z"}], jobs=1
    )
    frames = tautline.simulate(scene.replace({MASS: "3 t"}))["body_position"][:, 0, 2]
    assert data["z"].item() == pytest.approx(float(expected(frames)), rel=1e-12)


def test_a_statistic_leaves_out_what_is_before_the_begin_of_statistics():
    # The hook rises: its lowest place is that at 0.5 s, and not that at the start.
    output = {"keep": "statistics", "interval": "50 ms", "begin": 0.5, "of": ["tension"]}
    lowest = {"output": "payload.position[2]", "statistic": "min", "name": "z"}
    data = tautline.sweep(hoist(1.0, output=output), {MASS: ["3 t"]}, collect=[lowest], jobs=1)
    frames = tautline.simulate(hoist(1.0, **{MASS: "3 t"}))
    after = frames["body_position"][frames.time >= 0.5 - 1e-9, 0, 2]
    assert data["z"].item() == pytest.approx(after.min(), rel=1e-9) and after.min() > 5.001


def test_a_figure_that_statistics_do_not_tell_is_refused_before_the_first_run():
    output = {"keep": "statistics", "interval": "50 ms"}
    with pytest.raises(tautline.SceneError, match="statistics do not tell slack_events"):
        tautline.sweep(hoist(1.0, output=output), {MASS: ["3 t"]}, collect=["max_tension", "slack_events"], jobs=1)


def test_a_figure_that_only_a_limit_asks_for_is_made_of_statistics_in_a_sweep():
    output = {"keep": "statistics", "interval": "50 ms", "windows": "0.1 s"}
    limits = [{"name": "high", "output": "max_rise", "at_most": "1 m"}]
    scene = hoist(1.0, output=output, limits=limits)
    data = tautline.sweep(scene, {MASS: ["3 t"]}, collect=["max_tension", "limit.high.value"], jobs=1)
    height = tautline.simulate(hoist(1.0, **{MASS: "3 t"}))["body_position"][:, 0, 2]
    assert data["limit.high.value"].item() == pytest.approx(height.max() - height[0], rel=1e-9)


def test_result_and_table_hold_the_same_and_the_json_says_what_it_took(tmp_path, capsys, monkeypatch):
    from crane.application import Crane
    from tautline.cli.run import run
    from tautline.cli.verbs import make_app

    path = write_sweep(
        tmp_path, f"vary: {{'{MASS}': [2 t, 5 t], '{PERIOD}': [6, 7, 8]}}\ncollect: [max_tension]", "0.2 s"
    )
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as end:
        run(make_app(Crane(), ["sweep"]), ["sweep", path.name, "--json", "-j", "1", "-o", "out"])
    assert end.value.code == 0
    told = json.loads(capsys.readouterr().out)
    keys = {"cases", "done", "failed", "result", "table", "wall_time", "cpu_time", "overhead", "figures", "status"}
    assert keys <= set(told) and (told["cases"], told["done"], told["failed"]) == (6, 6, 0)
    with xarray.open_dataset(told["result"], engine="h5netcdf") as data:
        assert data["max_tension"].dims == (MASS, PERIOD)
        values = data["max_tension"].values.ravel()
    lines = (tmp_path / told["table"]).read_text(encoding="utf8").splitlines()
    assert lines[0].startswith(f"case,{MASS} [kg],{PERIOD} [s],status,max_tension [N]")
    assert [float(line.split(",")[4]) for line in lines[1:]] == values.tolist()
    assert [(tmp_path / one).exists() for one in told["figures"]] == [True]


def test_work_goes_where_it_pays():
    assert how(1, 1000, Measured(0.06, 0.1)) == "here"
    assert how(2, 1000, Measured(0.06, 0.1)) == "threads"
    assert how(2, 1000, Measured(0.5, 1.0)) == "processes"
    assert how(2, 10, Measured(0.5, 1.0)) == "threads"
    assert how(64, 100_000, Measured(0.06, 0.1)) == "processes"


def test_the_overhead_is_processor_time_beside_the_loops():
    assert Outcome(None, None, cpu_time=1.15, loop_time=1.0).overhead == pytest.approx(0.15)
    assert Outcome(None, None, cpu_time=1.0).overhead is None


def test_torque_and_drag_of_a_sweep_are_those_of_the_verb_along_depth():
    from drillstring.statics.torque_drag import torque_drag

    scene = tautline.read("data/jwell.yaml")
    depths = [1500.0, 2500.0]
    data = tautline.sweep(
        scene, {"well.wall.friction": [0.15, 0.3]}, collect=["pick_up", "torque"], verb="torque-drag",
        options={"depth": "1500,2500", "elements": 40}, jobs=1,
    )  # fmt: skip
    assert data["pick_up"].dims == ("well.wall.friction", "depth") and list(data["depth"].values) == depths
    for k, friction in enumerate((0.15, 0.3)):
        (case,) = torque_drag(scene.replace({"well.wall.friction": friction}), None, depths, 40)
        assert data["pick_up"].values[k].tolist() == case.hook_loads("pick_up").tolist()
        assert data["torque"].values[k].tolist() == case.torques.tolist()


def test_sobol_indices_of_a_weight_are_those_of_a_product(tmp_path):
    # A load at rest pulls with m g. For independent factors the variance of their product is known in closed form.
    scene = hoist(
        0.05, **{"path[0].drum.pay_out": {"constant": 0.0}, "vessel.motion": {}, "rope.mass_per_length": 1e-3}
    )
    masses, gravity = (4000.0, 6000.0), (-12.0, -8.0)
    data = tautline.sweep(
        scene, {MASS: {"uniform": list(masses)}, "gravity[2]": {"uniform": list(gravity)}},
        {"sobol": {"samples": 64, "seed": 4}}, ["max_tension_hook"], indices="sobol", jobs=1,
        folder=tmp_path / "out",
    )  # fmt: skip
    assert set(data["status"].values) == {"done"}
    weight = data[MASS].values * -data["gravity[2]"].values
    assert np.allclose(data["max_tension_hook"].values, weight, rtol=1e-5)
    means = np.array([5000.0, 10.0])
    variances = np.array([(masses[1] - masses[0]) ** 2, (gravity[1] - gravity[0]) ** 2]) / 12.0
    whole = np.prod(variances + means**2) - np.prod(means**2)
    first = variances * means[::-1] ** 2 / whole
    assert np.allclose(data["max_tension_hook_first"].values, first, atol=0.02)
    assert np.allclose(data["max_tension_hook_total"].values, 1.0 - first[::-1], atol=0.02)
    assert list(data["parameter"].values) == [MASS, "gravity[2]"]
    with xarray.open_dataset(tmp_path / "out" / "sweep.nc", engine="h5netcdf") as stored:
        assert stored["max_tension_hook_first"].equals(data["max_tension_hook_first"])
    assert len((tmp_path / "out" / "sweep.csv").read_text(encoding="utf8").splitlines()) == 1 + 64 * 4


@pytest.mark.parametrize(
    ("vary", "plan", "expected"),
    [
        ({MASS: [4000, 5000, 6000]}, "grid", ["max_tension"]),
        ({MASS: [4000, 6000], "solver.newton": ["modified", "full"]}, "grid", ["max_tension"]),
        ({MASS: [4000, 6000], "mesh.elements_per_span": [2, 4]}, "grid", ["max_tension"]),
        ({MASS: [4000, 6000], PERIOD: [7, 8]}, "one_at_a_time", ["max_tension_tornado"]),
        ({MASS: [4000, 6000], PERIOD: [7, 8]}, "zip", ["max_tension"]),
        ({MASS: [4000, 6000], PERIOD: [7, 8], "rope.diameter": ["30 mm", "40 mm"]}, "grid", []),
    ],
)
def test_each_plan_has_its_figure(tmp_path, vary, plan, expected):
    from tautline.sweeps.figures import draw
    from tautline.sweeps.file import read_sweep
    from tautline.sweeps.sweep import run_sweep

    scene = hoist(0.05)
    read = read_sweep({"scene": "scene", "vary": vary, "plan": plan, "collect": ["max_tension"]})
    outcome = run_sweep(read, tautline._installed().of(scene), scene, Execution(jobs=1))
    assert set(outcome.data["status"].values.ravel()) == {"done"}, outcome.data["message"].values
    made = draw(outcome.data, outcome.cases, tmp_path)
    assert [path.name for path in made] == [f"{name}.png" for name in expected]
    assert all(path.stat().st_size > 5000 for path in made)


def limited(end=0.6):
    """The hoist with a limit that some loads pass, and one of a figure, which is not collected by its own name."""
    text = HOIST.read_text(encoding="utf8").replace("end: 12 s", f"end: {end}")
    limits = (
        "{output: winch.tension, above: 52 kN, name: overload}, {output: dynamic_amplification, above: 3, name: jerk}"
    )
    return tautline.read(f"{text}limits: [{limits}]\n")


def test_what_limits_of_a_scene_come_to_is_that_of_single_runs():
    scene, masses = limited(), ["2 t", "5 t"]
    collect = ["limits_failed", "limit.overload.margin", "limit.overload.failed", "limit.jerk.value"]
    data = tautline.sweep(scene, {MASS: masses}, collect=collect, jobs=2)
    failed = []
    for k, mass in enumerate(masses):
        alone = tautline.simulate(scene.replace({MASS: mass}))
        overload = 52e3 - alone["drum_tension"].max()
        assert data["limit.overload.margin"].values[k] == overload
        assert data["limit.overload.failed"].values[k] == (overload < 0.0)
        assert data["limit.jerk.value"].values[k] == alone.headline["dynamic_amplification"]["value"]
        failed.append(sum(record["passed"] is False for record in alone.limits))
    assert data["limit.overload.failed"].values.tolist() == [0.0, 1.0]
    assert data["limits_failed"].values.tolist() == failed
    assert data["limit.overload.margin"].attrs["units"] == "N"


def test_limits_may_be_varied_are_collected_where_nothing_is_named_and_a_slip_in_their_name_is_refused():
    data = tautline.sweep(limited(), {"limits[0].above": ["40 kN", "90 kN"]}, jobs=1)
    margins = data["limit.overload.margin"].values
    assert margins[1] - margins[0] == pytest.approx(50e3) and margins[0] < 0.0 < margins[1]
    assert {"limit.jerk.margin", "limit.overload.longest"} <= set(data.data_vars)
    with pytest.raises(tautline.SceneError, match=r"did you mean 'limit\.overload\.margin'"):
        tautline.sweep(limited(), {MASS: ["2 t"]}, collect=["limit.overlaod.margin"], jobs=1)


@pytest.mark.parametrize(
    ("figure", "told"),
    [
        ("limit.overload.longest", "how long a value is beyond its bound needs every frame"),
        ("limit.lift.failed", "energy_hoisted needs every frame"),
        ("limit.lift.value", "energy_hoisted needs every frame"),
    ],
)
def test_what_a_limit_comes_to_is_refused_before_the_first_run_where_statistics_cannot_tell_it(figure, told):
    scene = limited().replace({"output": {"interval": 0.05, "keep": "statistics"}})
    lift = {"output": "energy_hoisted", "above": 1.0, "name": "lift"}
    limits = [{"output": "winch.tension", "above": 52e3, "name": "overload"}, lift]
    with pytest.raises(tautline.SceneError, match=f"statistics do not tell {re.escape(figure)}: {told}"):
        tautline.sweep(scene.replace({"limits": limits}), {MASS: ["2 t"]}, collect=[figure], jobs=1)
    data = tautline.sweep(scene, {MASS: ["2 t"]}, collect=["limit.overload.margin"], jobs=1)
    assert np.isfinite(data["limit.overload.margin"]).all()


def test_the_summary_of_a_plan_that_samples_tells_its_percentiles_and_their_table(tmp_path, capsys, monkeypatch):
    from crane.application import Crane
    from tautline.cli.run import run
    from tautline.cli.verbs import make_app

    path = write_sweep(
        tmp_path,
        f"vary: {{'{MASS}': {{uniform: [2 t, 5 t]}}}}\nplan: {{monte_carlo: {{samples: 4}}}}\ncollect: [max_tension]",
        "0.05 s",
    )
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")
    with pytest.raises(SystemExit):
        run(make_app(Crane(), ["sweep"]), ["sweep", path.name, "--json", "-j", "1", "-o", "out"])
    found = capsys.readouterr()
    assert json.loads(found.out)["percentiles"] == "out/percentiles.csv"
    assert "max_tension: P10, P50, P90" in found.err and "wrote out/percentiles.csv" in found.err


def test_a_key_that_the_sweep_varies_cannot_be_set_as_well(tmp_path, capsys, monkeypatch):
    from crane.application import Crane
    from tautline.cli.run import run
    from tautline.cli.verbs import make_app

    path = write_sweep(tmp_path, f"vary: {{'{MASS}': [2 t, 5 t]}}\ncollect: [rise]", "0.05 s")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as ended:
        run(make_app(Crane(), ["sweep"]), ["sweep", path.name, "--set", f"{MASS}=9 t", "-o", "out"])
    assert ended.value.code == 2 and not (tmp_path / "out").exists()
    assert f"--set {MASS}=9 t: the sweep varies {MASS}" in " ".join(capsys.readouterr().err.split())


def test_a_single_name_is_collected_as_a_file_would():
    data = tautline.sweep(hoist(0.05), {MASS: ["2 t"]}, collect="rise", jobs=1)
    assert np.isfinite(data["rise"].values).all()


def test_a_case_that_met_a_fault_of_the_moment_runs_again_when_the_sweep_goes_on(tmp_path, monkeypatch):
    from crane.application import Crane

    build = Crane.build

    def full(crane, scene):
        if scene.bodies[0].mass == 4000.0:
            raise MemoryError("no room")
        return build(crane, scene)

    def go(**how):
        vary = {MASS: ["3 t", "4 t", "5 t"]}
        return tautline.sweep(hoist(0.2), vary, collect=["rise"], folder=tmp_path / "out", jobs=1, **how)

    with monkeypatch.context() as now:
        now.setattr(Crane, "build", full)
        assert go()["status"].values.tolist() == ["done", "internal error", "done"]
    data = go(resume=True)
    assert data["status"].values.tolist() == ["done", "done", "done"]
    assert np.isfinite(data["rise"].values).all()


def test_curves_go_along_their_axis_and_maps_hold_every_value_also_of_powers_of_ten(tmp_path):
    from tautline.sweeps.figures import _lines, _map
    from tautline.sweeps.file import plan_cases, read_sweep
    from tautline.sweeps.table import dataset

    def drawn(draw, vary, values):
        scene = hoist(0.2)
        read = read_sweep({"scene": "s", "vary": vary, "plan": "grid", "collect": ["rise"]})
        cases = plan_cases(read, tautline._installed().of(scene), scene)
        rows = [Row(k, "done", values={"rise": value}) for k, value in enumerate(values)]
        data = dataset(cases, {"rise": Finding(None, "m", "rise")}, rows, {"units": "si"})
        return draw(data, cases, "rise").axes[0]

    curve = drawn(_lines, {MASS: ["5 t", "2 t", "3 t"]}, [5.0, 2.0, 3.0]).get_lines()[0]
    assert curve.get_xdata().tolist() == [2000.0, 3000.0, 5000.0] and curve.get_ydata().tolist() == [2.0, 3.0, 5.0]
    plot = drawn(
        _map, {MASS: {"logspace": [1e2, 1e5, 4]}, PERIOD: {"linspace": [5, 9, 3]}}, [float(k) for k in range(12)]
    )
    mesh = plot.collections[0].get_coordinates()
    edges = max((mesh[0, :, 0], mesh[:, 0, 1]), key=len)
    assert np.allclose(edges[1:] / edges[:-1], 10.0)


def test_percentiles_of_a_sweep_with_failed_cases_are_said_to_lack_them(tmp_path):
    from tautline.cli.commands.sweep import _left_out
    from tautline.sweeps.file import read_sweep
    from tautline.sweeps.sweep import run_sweep

    # Beyond some 15 m/s the hook comes to the sheave within 2 s.
    spread = {"path[0].drum.pay_out.ramp.to": {"uniform": [-22.0, -1.0]}}
    read = read_sweep(
        {"scene": "s", "vary": spread, "plan": {"latin_hypercube": {"samples": 4, "seed": 1}}, "collect": ["rise"]}
    )
    scene = hoist(2.0)
    outcome = run_sweep(read, tautline._installed().of(scene), scene, Execution(jobs=1, folder=tmp_path / "out"))
    assert outcome.failed and outcome.done
    (text,) = _left_out(outcome)
    assert text.startswith(f"percentiles are those of the {outcome.done} cases")


def test_an_axis_of_a_figure_is_in_the_unit_that_keeps_its_numbers_short_and_breaks_at_dots():
    from tautline.sweeps.figures import NARROW, _places
    from tautline.sweeps.plans import Parameter
    from tautline.sweeps.table import Variables

    data = Variables({}, {}, {"units": "si"})
    places, text = _places(Parameter("bit.weight", "N", (4e4, 16e4), (4e4, 16e4)), data)
    assert places.tolist() == pytest.approx([40.0, 160.0]) and text == "bit.weight [kN]"
    text = _places(Parameter(PERIOD, "s", (5.0, 9.0), (5.0, 9.0)), data, NARROW)[1]
    assert text == "vessel.motion.heave.\nharmonic.period [s]"


def test_the_largest_of_an_output_with_places_is_that_of_all_of_them():
    collect = ["max_tension", "min_tension", *({"output": "tension", "statistic": one} for one in ("max", "min"))]
    data = tautline.sweep(hoist(0.3), {MASS: ["3 t"]}, collect=collect, jobs=1)
    assert data["tension max"].item() == data["max_tension"].item()
    assert data["tension min"].item() == data["min_tension"].item()
    with pytest.raises(tautline.SceneError, match="no single number"):
        tautline.sweep(hoist(0.3), {MASS: ["3 t"]}, collect=[{"output": "tension", "statistic": "mean"}], jobs=1)
