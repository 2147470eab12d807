"""The commands ``record`` and ``twin``: what goes in, what comes out, and what they refuse."""

import io
import json
import shlex
import subprocess
import sys

import numpy as np
import pytest
import xarray
from cli.in_process import commands_of
from of_the_suite import studies

import tautline
from crane.application import Crane
from tautline.cli.run import run
from tautline.cli.verbs import make_app

MAP = """
sensors:
  - {column: winch_pos, unit: m, input: winch.pay_out}
  - {column: heave, unit: m, input: vessel.heave}
  - {column: rope_tension, unit: kN, output: winch.tension, sd: 0.5 kN}
estimate:
  - {parameter: payload.mass, start: 9 t, sd: 4 t, range: [0.5 t, 20 t]}
watch:
  - {output: winch.tension, above: 60 kN, name: overload}
keep: [payload.position]
ahead: 0 s
"""
SCENE = "data/hoist.yaml"


def crane(*arguments, stdin=None):
    """The command as a process, which reads what it is fed."""
    command = [sys.executable, "-m", "crane.main", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, input=stdin, timeout=300)


@pytest.fixture
def here(capsys):
    """The command in this process, where it reads and writes files: exit code, standard output, standard error."""
    return commands_of(Crane(), capsys)


@pytest.fixture(scope="module")
def rehearsal(tmp_path_factory):
    """A folder with a map and a record, which the command has written in this process."""
    folder = tmp_path_factory.mktemp("twin")
    (folder / "map.yaml").write_text(MAP)
    words = ["record", SCENE, "--map", folder / "map.yaml", "-o", folder / "r.csv", "--noise", "1 %", "--end", "4 s"]
    words = [str(word) for word in words]
    with pytest.raises(SystemExit) as left:
        run(make_app(Crane(), words), words)
    assert not left.value.code
    rows = (folder / "r.csv").read_text().splitlines(keepends=True)
    (folder / "short.csv").write_text("".join(rows[:13]))  # for what becomes of files, whatever rows they are of
    return folder


def test_a_record_has_the_columns_of_the_map_and_the_noise_that_was_asked_for(rehearsal):
    lines = (rehearsal / "r.csv").read_text().splitlines()
    assert lines[0] == "time [s],winch_pos [m],heave [m],rope_tension [kN]"
    rows = np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]])
    assert len(rows) == 41
    sim = tautline.Simulation(SCENE, keep=False)
    truth = [float(sim["winch.tension"])]
    for time in rows[1:, 0]:
        sim.advance_to(time)
        truth.append(float(sim["winch.tension"]))
    noise = 1e3 * rows[:, 3] / np.array(truth) - 1.0
    assert noise.std() == pytest.approx(0.01, rel=0.3)
    assert abs(noise.mean()) < 0.004


@pytest.mark.parametrize("way", ["file", "objects", *studies("table")])
def test_the_twin_answers_every_row_from_a_file_and_from_standard_input(rehearsal, here, way):
    text = (rehearsal / "r.csv").read_text()
    arguments = ["twin", SCENE, "--map", rehearsal / "map.yaml", "--json"]
    if way == "file":
        code, out, told = here(*arguments, "--source", rehearsal / "r.csv", "-o", rehearsal / "tw.nc")
    elif way == "table":
        done = crane(*arguments, stdin=text)
        code, out, told = done.returncode, done.stdout, done.stderr
    else:
        rows = [line.split(",") for line in text.splitlines()[1:]]
        names = ("time", "winch_pos", "heave", "rope_tension")
        objects = [json.dumps(dict(zip(names, map(float, row), strict=True))) for row in rows]
        done = crane(*arguments, stdin="\n".join(objects[:20] + ["{broken"] + objects[20:]) + "\n")
        code, out, told = done.returncode, done.stdout, done.stderr
    assert code == 0, told
    lines = [json.loads(line) for line in out.splitlines()]
    assert len(lines) == 41
    keys = {"time", "outputs", "estimates", "residuals", "alarms", "lag", "health"}
    assert keys <= set(lines[-1])
    assert lines[-1]["estimates"]["payload.mass"]["value"] == pytest.approx(5000.0, rel=0.01)
    assert "overload" in told  # the ramp of the winch: 67 kN
    if way == "file":
        with xarray.open_dataset(rehearsal / "tw.nc", engine="h5netcdf") as data:
            assert data.sizes["time"] == 41
            assert float(data["estimate payload.mass"][-1]) == lines[-1]["estimates"]["payload.mass"]["value"]


def test_ended_and_resumed_from_its_state_it_answers_the_rows_that_are_left(rehearsal, here):
    rows = (rehearsal / "r.csv").read_text().splitlines(keepends=True)
    (rehearsal / "part.csv").write_text("".join(rows[:25]))
    state = rehearsal / "twin.state"
    arguments = ["twin", SCENE, "--map", rehearsal / "map.yaml", "--json", "--resume", state]
    code, _, told = here(*arguments, "--source", rehearsal / "part.csv")
    assert code == 0 and state.exists(), told
    _, out, _ = here(*arguments, "--source", rehearsal / "r.csv")
    lines = [json.loads(line) for line in out.splitlines()]
    # Those that waited for the rows behind them, at the end of the part, are answered anew with them.
    assert lines[0]["time"] == pytest.approx(2.1)
    assert lines[-1]["estimates"]["payload.mass"]["value"] == pytest.approx(5000.0, rel=0.01)


def test_a_unit_that_was_stated_before_the_twin_was_stopped_holds_when_a_pipe_is_gone_on_with(
    rehearsal, here, tmp_path, monkeypatch
):
    header, *rows = (rehearsal / "r.csv").read_text().splitlines()
    names = [one.split(" ")[0] for one in header.split(",")]
    objects = [dict(zip(names, (float(cell) for cell in row.split(",")), strict=True)) for row in rows]
    for one in objects:
        one["rope_tension"] *= 1e3
    objects[0]["units"] = {"rope_tension": "N"}
    lines = [json.dumps(one) + "\n" for one in objects]
    arguments = ["twin", SCENE, "--map", rehearsal / "map.yaml", "--json", "--resume", tmp_path / "twin.state"]
    told = ""
    (tmp_path / "between.csv").write_text("\n".join([header, *rows[12:20]]) + "\n")
    # What a table has read in between says nothing of the pipe.
    for source, part in (("-", lines[:12]), (tmp_path / "between.csv", []), ("-", lines[20:])):
        monkeypatch.setattr("sys.stdin", io.StringIO("".join(part)))
        code, out, told = here(*arguments, "--source", source)
        assert code == 0, told
    assert "the unit of rope_tension was N when the state was saved" in " ".join(told.split())
    last = json.loads(out.splitlines()[-1])
    assert last["estimates"]["payload.mass"]["value"] == pytest.approx(5000.0, rel=0.01)


def test_an_operation_that_is_gone_on_with_keeps_what_its_result_has(rehearsal, here, tmp_path):
    rows = (rehearsal / "r.csv").read_text().splitlines(keepends=True)
    (tmp_path / "part.csv").write_text("".join(rows[:25]))
    arguments = ["twin", SCENE, "--map", rehearsal / "map.yaml", "--resume", tmp_path / "twin.state"]
    for source in (tmp_path / "part.csv", rehearsal / "r.csv", rehearsal / "r.csv"):
        assert here(*arguments, "-o", tmp_path / "tw.nc", "--source", source)[0] == 0
    with xarray.open_dataset(tmp_path / "tw.nc", engine="h5netcdf") as data:
        assert data["time"].values == pytest.approx(np.linspace(0.0, 4.0, 41), abs=1e-6)
        assert np.isfinite(data["estimate payload.mass"]).all()


def test_a_record_that_is_replayed_in_real_time_is_gone_on_with_where_it_was_left(rehearsal, here, tmp_path):
    rows = (rehearsal / "r.csv").read_text().splitlines(keepends=True)
    (tmp_path / "part.csv").write_text("".join(rows[:12]))
    (tmp_path / "more.csv").write_text("".join(rows[:16]))
    arguments = ["twin", SCENE, "--map", rehearsal / "map.yaml", "--resume", tmp_path / "twin.state", "--speed", "1"]
    for source in ("part.csv", "more.csv"):
        code, _, told = here(*arguments, "-o", tmp_path / "tw.nc", "--source", tmp_path / source)
        assert code == 0 and "set back" not in told
    with xarray.open_dataset(tmp_path / "tw.nc", engine="h5netcdf") as data:
        assert data["time"].values == pytest.approx(np.linspace(0.0, 1.4, 15), abs=1e-6)


def test_an_operation_does_not_replace_the_result_of_another_one(rehearsal, here, tmp_path):
    (tmp_path / "less.yaml").write_text(MAP.replace("keep: [payload.position]\n", ""))
    arguments = ["twin", SCENE, "--source", rehearsal / "short.csv"]
    assert here(*arguments, "--map", tmp_path / "less.yaml", "-o", tmp_path / "tw.nc")[0] == 0
    before = (tmp_path / "tw.nc").read_bytes()
    state = tmp_path / "twin.state"
    assert here(*arguments, "--map", rehearsal / "map.yaml", "--state", state)[0] == 0
    code, _, told = here(*arguments, "--map", rehearsal / "map.yaml", "--resume", state, "-o", tmp_path / "tw.nc")
    assert code == 2 and "would replace it" in told
    assert (tmp_path / "tw.nc").read_bytes() == before


def test_the_result_of_a_twin_is_plotted_and_one_that_shows_nothing_is_refused(rehearsal, here, tmp_path, monkeypatch):
    arguments = ["twin", SCENE, "--map", rehearsal / "map.yaml", "--source", rehearsal / "r.csv"]
    assert here(*arguments, "-o", tmp_path / "tw.nc")[0] == 0
    (tmp_path / "figures").mkdir()
    code, out, _ = here("plot", tmp_path / "tw.nc", "-o", tmp_path / "figures", "--json")
    names = [f"tw_{name}.png" for name in ("estimates", "residuals", "alarms")]
    assert code == 0 and json.loads(out)["figures"] == [str(tmp_path / "figures" / name) for name in names]
    assert all((tmp_path / "figures" / name).stat().st_size > 0 for name in names)
    monkeypatch.setattr("tautline.view.figures.estimates.DRAWINGS", {})
    (tmp_path / "none").mkdir()
    code, _, told = here("plot", tmp_path / "tw.nc", "-o", tmp_path / "none")
    said = " ".join(told.split())
    assert code == 2 and "holds nothing that the usual figures show" in said and "estimate payload.mass" in said
    assert not list((tmp_path / "none").iterdir())


@pytest.mark.parametrize("option, name", [("--state", "one"), ("--account", "one"), ("--state", "link to it")])
def test_two_twins_do_not_keep_their_state_or_account_in_one_file(rehearsal, here, tmp_path, option, name):
    from tautline.results.disk import Lock

    (tmp_path / "link to it").symlink_to(tmp_path / "one")
    other = Lock(tmp_path / "one")
    assert other.take() is None
    arguments = ["twin", SCENE, "--map", rehearsal / "map.yaml", "--source", rehearsal / "r.csv"]
    try:
        code, _, told = here(*arguments, option, tmp_path / name)
    finally:
        other.give_back()
    assert code == 2 and "is writing there" in told and option in told
    assert here(*arguments, "--state", tmp_path / "none" / "one")[0] == 2
    assert [one.name for one in tmp_path.iterdir()] == ["link to it"]


def test_a_state_that_is_cut_off_is_refused_in_words_of_the_option_that_was_given(rehearsal, here, tmp_path):
    arguments = ["twin", SCENE, "--map", rehearsal / "map.yaml", "--source", rehearsal / "r.csv"]
    assert here(*arguments, "--state", tmp_path / "whole")[0] == 0
    cut = tmp_path / "cut"
    cut.write_bytes((tmp_path / "whole").read_bytes()[:2000])
    code, _, told = here(*arguments, "--resume", cut)
    assert code == 2 and "is no state of a twin" in told and "--state" not in told
    assert cut.stat().st_size == 2000
    code, _, told = here(*arguments, "--resume", tmp_path / "whole", "--state", cut)
    assert code == 2 and "name another file with --state" in told and cut.stat().st_size == 2000


def test_a_state_does_not_replace_a_file_that_is_none(rehearsal, here, tmp_path):
    arguments = ["twin", SCENE, "--map", rehearsal / "map.yaml", "--source", rehearsal / "r.csv"]
    mine = tmp_path / "mine.yaml"
    mine.write_text("mine")
    code, _, told = here(*arguments, "--state", mine)
    assert code == 2 and "is no state of a twin" in told and mine.read_text() == "mine"
    one = tmp_path / "one"
    for pair in (("--state", "--account"), ("--state", "-o")):
        code, _, told = here(*arguments, pair[0], one, pair[1], one)
        assert code == 2 and f"is named by {pair[0]} and by {pair[1]}" in told
    assert [file.name for file in tmp_path.iterdir()] == ["mine.yaml"]


def test_an_interruption_within_a_step_ends_a_twin_as_one_between_rows(rehearsal, here, tmp_path, monkeypatch):
    from tautline.integrators.status import Interrupted
    from tautline.twin.twin import Twin

    add, count = Twin.add, iter(range(100))

    def interrupted(self, *row):
        if next(count) == 20:
            raise Interrupted(2.0)
        return add(self, *row)

    monkeypatch.setattr(Twin, "add", interrupted)
    arguments = ["twin", SCENE, "--map", rehearsal / "map.yaml", "--source", rehearsal / "r.csv"]
    code, _, told = here(*arguments, "--state", tmp_path / "twin.state", "-o", tmp_path / "tw.nc")
    assert code == 130 and "fault" not in told
    assert (tmp_path / "twin.state").exists()
    with xarray.open_dataset(tmp_path / "tw.nc", engine="h5netcdf") as data:
        assert data.attrs["status"] == "interrupted" and data.sizes["time"] > 10


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"input: winch.pay_out": "input: winch.payout"}, "there is no input 'winch.payout'; did you mean"),
        (
            {"unit: kN": "unit: kg"},
            "sensors[2].unit = kg: 'kg' is a unit of mass, and this is a force; write unit: kgf",
        ),
        ({"start: 9 t": "start: 90 t"}, "is 90 t, and range is 0.5 t to 20 t; start within the range"),
        ({"keep:": "kept:"}, "unknown key; did you mean 'keep'?"),
        ({"above: 60 kN": "above: 60 m"}, "'m' is not the unit of a force"),
        ({"column: heave": "column: heav"}, "map.yaml:4: sensors[1].column = heav: "),
    ],
)
def test_a_map_that_does_not_fit_is_refused_by_line_and_key(rehearsal, here, tmp_path, changes, said):
    text = MAP
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new)
    (tmp_path / "map.yaml").write_text(text)
    code, _, told = here(
        "twin", SCENE, "--map", tmp_path / "map.yaml", "--source", rehearsal / "r.csv", "-o", tmp_path / "x.nc"
    )
    assert code == 2
    assert said in told
    assert "Traceback" not in told
    assert not (tmp_path / "x.nc").exists()


def test_a_map_that_drives_a_winch_by_its_place_and_by_its_speed_is_refused_at_the_second_of_them(
    rehearsal, here, tmp_path
):
    first = "  - {column: heave,"
    assert first in MAP
    speed = "  - {column: winch_speed, unit: m/s, input: winch.pay_out_speed}\n"
    (tmp_path / "map.yaml").write_text(MAP.replace(first, speed + first, 1))
    head, *rows = (rehearsal / "r.csv").read_text().splitlines()
    (tmp_path / "r.csv").write_text("\n".join([f"{head},winch_speed [m/s]", *(f"{row},0" for row in rows)]))
    arguments = [SCENE, "--map", str(tmp_path / "map.yaml")]
    for words in (
        ["record", *arguments, "-o", str(tmp_path / "x.csv")],
        ["twin", *arguments, "--source", str(tmp_path / "r.csv"), "-o", str(tmp_path / "x.nc")],
    ):
        code, _, told = here(*words)
        said = " ".join(told.split())
        assert code == 2 and "Traceback" not in told
        assert "map.yaml:4" in said and "winch.pay_out_speed and winch.pay_out drive the same" in said
        assert "leave one of them out, or measure one of them: write output: winch.pay_out_speed" in said
    assert sorted(one.name for one in tmp_path.iterdir()) == ["map.yaml", "r.csv"]


@pytest.mark.parametrize("kind, wrong", [("input", "winch.payout"), ("output", "winch.tensoin")])
def test_a_record_with_a_map_that_does_not_fit_is_refused_by_line_and_key_as_a_twin_is(
    rehearsal, here, tmp_path, kind, wrong
):
    right = {"input": "winch.pay_out", "output": "winch.tension"}[kind]
    (tmp_path / "map.yaml").write_text(MAP.replace(f"{kind}: {right}", f"{kind}: {wrong}", 1))
    arguments = [SCENE, "--map", str(tmp_path / "map.yaml")]
    for words in (
        ["record", *arguments, "-o", str(tmp_path / "x.csv")],
        ["twin", *arguments, "--source", str(rehearsal / "r.csv")],
    ):
        code, _, told = here(*words)
        said, line = " ".join(told.split()), 3 if kind == "input" else 5
        assert code == 2 and f"there is no {kind} '{wrong}'; did you mean" in said, said
        assert f"map.yaml:{line}: sensors[{line - 3}].{kind}" in said.replace(" ", "").replace(":sensors", ": sensors")
    assert [one.name for one in tmp_path.iterdir()] == ["map.yaml"]


def test_a_unit_of_the_map_that_does_not_fit_the_scene_is_refused_where_the_record_gives_none(
    rehearsal, here, tmp_path
):
    (tmp_path / "map.yaml").write_text(MAP.replace("unit: kN", "unit: kg"))
    (tmp_path / "r.csv").write_text((rehearsal / "r.csv").read_text().replace(" [kN]", ""))
    code, _, told = here("twin", SCENE, "--map", tmp_path / "map.yaml", "--source", tmp_path / "r.csv")
    assert code == 2 and "'kg' is a unit of mass" in told


def test_a_record_in_another_unit_than_the_map_says_is_answered_as_if_it_were_in_that_of_the_map(
    rehearsal, here, tmp_path
):
    rows = [line.split(",") for line in (rehearsal / "r.csv").read_text().splitlines()[1:12]]
    text = [",".join([*row[:3], repr(1e3 * float(row[3]))]) for row in rows]
    (tmp_path / "r.csv").write_text("\n".join(["time [s],winch_pos [m],heave [m],rope_tension [N]", *text]) + "\n")
    code, out, told = here("twin", SCENE, "--map", rehearsal / "map.yaml", "--source", tmp_path / "r.csv", "--json")
    assert code == 0, told
    measured = [json.loads(line)["measured"]["winch.tension"] for line in out.splitlines()]
    assert measured == pytest.approx([1e3 * float(row[3]) for row in rows], rel=1e-12)


@pytest.mark.parametrize(
    ("option", "value", "said"),
    [
        ("--source", "nowhere.csv", "there is no such file"),
        ("--source", "ftp://host/x", "is of no known kind"),
        ("--map", "nowhere.yaml", "there is no such file"),
    ],
)
def test_what_is_not_there_is_refused(rehearsal, here, option, value, said):
    arguments = {"--map": str(rehearsal / "map.yaml"), "--source": str(rehearsal / "r.csv"), option: value}
    code, _, told = here("twin", SCENE, *(part for pair in arguments.items() for part in pair))
    assert code == 2
    assert said in told


def test_a_quiet_record_says_nothing_where_all_is_well(rehearsal, here, tmp_path):
    words = ["record", SCENE, "--map", rehearsal / "map.yaml", "--end", "0.2 s", "-o", tmp_path / "r.csv"]
    code, out, err = here(*map(str, words), "-q")
    assert code == 0 and (out + err).strip() == "" and (tmp_path / "r.csv").is_file()


def test_a_record_replaces_a_record_by_force_and_nothing_else(rehearsal, here, tmp_path):
    words = ["record", SCENE, "--map", rehearsal / "map.yaml", "--end", "0.2 s", "-o"]
    scene = tmp_path / "mine.yaml"
    scene.write_text("mine")
    for target, cause in (
        (scene, "exists and is not a record: it would be lost"), (tmp_path, "is a folder"),
        (tmp_path / "nowhere" / "r.csv", "there is no folder"), (tmp_path / "q.txt", "name it q.csv"),
        (tmp_path / "q.nc", "name it q.csv"),
    ):  # fmt: skip
        code, _, err = here(*map(str, words), str(target))
        assert code == 2 and cause in " ".join(err.split())
    assert scene.read_text() == "mine" and [one.name for one in tmp_path.iterdir()] == ["mine.yaml"]
    assert here(*map(str, words), str(scene), "--force")[0] == 2 and scene.read_text() == "mine"
    record = tmp_path / "r.csv"
    assert here(*map(str, words), str(record))[0] == 0
    record.write_text("time [s],hook load [kN]\n0,mine\n")
    code, _, err = here(*map(str, words), str(record))
    assert code == 2 and "exists: a record would be lost" in " ".join(err.split()) and "mine" in record.read_text()
    assert here(*map(str, words), str(record), "--force")[0] == 0 and "mine" not in record.read_text()


def test_a_twin_that_begins_anew_replaces_the_result_of_another_by_force_only(rehearsal, here, tmp_path):
    given = ["--map", rehearsal / "map.yaml", "--source", rehearsal / "short.csv"]
    words = ["twin", SCENE, *given, "-o", tmp_path / "tw.nc"]
    assert here(*words)[0] == 0
    before = (tmp_path / "tw.nc").read_bytes()
    code, _, told = here(*words)
    said = " ".join(told.split())
    assert code == 2 and "holds what a twin has found: it would be lost" in said and "--resume" in said
    assert (tmp_path / "tw.nc").read_bytes() == before
    assert here(*words, "--force")[0] == 0


def test_a_twin_and_a_simulation_do_not_replace_the_results_of_each_other(rehearsal, here, tmp_path):
    twin = ["twin", SCENE, "--map", rehearsal / "map.yaml", "--source", rehearsal / "short.csv", "-o"]
    simulate = ["simulate", SCENE, "--set", "solver.end=0.2", "--no-verify", "-o"]
    assert here(*twin, tmp_path / "tw.nc")[0] == 0 and here(*simulate, tmp_path / "run.nc")[0] == 0
    before = [one.read_bytes() for one in sorted(tmp_path.glob("*.nc"))]
    for words, cause in (
        ([*simulate, tmp_path / "tw.nc"], "holds what a twin has found: it would be lost"),
        ([*twin, tmp_path / "run.nc"], "is the result of a simulation: it would be lost"),
    ):
        code, _, told = here(*words)
        assert code == 2 and cause in " ".join(told.split()) and "name another file with -o" in " ".join(told.split())
    assert [one.read_bytes() for one in sorted(tmp_path.glob("*.nc"))] == before
    assert here(*simulate, tmp_path / "run.nc")[0] == 0, "a run replaces an earlier one"
    code, _, told = here(*simulate, tmp_path / "more.nc", "--resume", tmp_path / "tw.nc")
    assert code == 2 and "is what a twin has found, and no simulation" in " ".join(told.split())
    assert not (tmp_path / "more.nc").exists()


@pytest.mark.parametrize(
    "option, given, cause",
    [
        ("--noise", "nan", "zero or more"), ("--noise", "-5 %", "zero or more"), ("--jitter", "inf", "zero or more"),
        ("--dropout", "1.5", "is 150 % of all rows; write `1.5 %` if that is meant"),
        ("--noise", "5", "is 500 % of what is measured; write `5 %` if that is meant"),
        ("--noise", "1", "is 100 % of what is measured; write `1 %` if that is meant"),
        ("--noise", "120 %", "is 120 % of what is measured; give 100 % or less"),
        ("--rate", "1e12", "a record has 1e+08 at most"),
    ],
)  # fmt: skip
def test_numbers_that_a_record_cannot_have_are_refused_and_nothing_is_written(
    rehearsal, here, tmp_path, option, given, cause
):
    words = ["record", SCENE, "--map", str(rehearsal / "map.yaml"), "-o", str(tmp_path / "r.csv"), f"{option}={given}"]
    code, _, err = here(*words)
    assert code == 2 and cause in " ".join(err.split()) and not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "options, cause",
    [
        (["--fault=rope_tension:bias:20:30:5"], "no row lies in these times"),
        (["--fault=rope_tension:stuck:1.01:1.09"], "no row lies in these times"),
        (["--fault=rope_tension:lost:-3:0"], "no row lies in these times"),
        (["--fault=heave:bias:0:1"], "has no size, which bias needs; write heave:bias:0:1:5"),
        (["--fault=heave:stuck:0:1:5"], "has a size, and stuck has none; write heave:stuck:0:1"),
        (["--gap", "nan:2"], "is no gap"),
        (["--gap=20:30"], "no row lies in these times"), (["--gap=8:4"], "ends before it begins"),
        (["--gap=0:100"], "no row is left"), (["--gap=0:0.5", "--gap=0.5:3"], "no row is left"),
        (["--dropout=100 %"], "no row is left"),
    ],
)  # fmt: skip
def test_a_fault_or_a_gap_that_changes_no_row_is_refused_and_so_is_a_record_without_rows(
    rehearsal, here, tmp_path, options, cause
):
    words = ["record", SCENE, "--map", str(rehearsal / "map.yaml"), "-o", str(tmp_path / "r.csv"), "--end", "2 s"]
    code, _, err = here(*words, *options)
    said = " ".join(err.split())
    assert code == 2 and cause in said and "fault of the program" not in said and not list(tmp_path.iterdir())
    if "lies" in cause:
        assert "rows are from 0 s to 2 s, 10 a second" in said


def test_faults_and_gaps_that_reach_beyond_the_rows_change_those_within(rehearsal, here, tmp_path):
    words = ["record", SCENE, "--map", str(rehearsal / "map.yaml"), "--end", "1 s", "-o"]
    whole, part = tmp_path / "whole.csv", tmp_path / "part.csv"
    assert here(*words, str(whole))[0] == 0
    assert here(*words, str(part), "--gap=-5:0.3", "--gap=1:9", "--fault=heave:bias:0.8:99:7")[0] == 0
    before, after = (np.genfromtxt(one, delimiter=",", skip_header=1) for one in (whole, part))
    assert after[:, 0] == pytest.approx(0.1 * np.arange(3, 10))
    assert after[:, 2] - before[3:10, 2] == pytest.approx([0, 0, 0, 0, 0, 7, 7], abs=1e-6)


def test_the_next_command_of_a_record_names_the_changes_of_its_scene_and_runs(rehearsal, here, tmp_path):
    changes = ["--set", "rope.damping=2 ms"]
    words = [SCENE, "--map", str(rehearsal / "map.yaml"), *changes]
    record = tmp_path / "a name with blanks.csv"
    code, _, err = here("record", *words, "-o", str(record), "--end", "0.5 s")
    assert code == 0
    following = shlex.split(" ".join(err.split()).split("Next: crane ")[1])
    assert following[-4:] == [*changes, "--source", str(record)]
    assert here(*following)[0] == 0


def test_a_column_of_a_record_that_is_always_empty_is_warned_of(rehearsal, here, tmp_path):
    words = ["record", SCENE, "--map", str(rehearsal / "map.yaml"), "--end", "0.5 s", "-o", str(tmp_path / "r.csv")]
    code, _, err = here(*words, "--fault=heave:lost:0:9")
    assert code == 0 and "warning: heave is empty in all rows" in " ".join(err.split())


@pytest.mark.parametrize(
    "column, absurd",
    [(1, "1e300"), *studies((2, "-1e160"), (2, "9.969209968386869e36")), (3, "3.4028235e38")],
)
def test_a_reading_that_no_sensor_shows_is_none_and_the_twin_goes_on(rehearsal, here, tmp_path, column, absurd):
    """As one that is missing: what other programs write for a missing value is such a number."""
    lines = (rehearsal / "r.csv").read_text().splitlines()[:31]
    told = {}
    for name, reading in (("absurd", absurd), ("missing", "")):
        cells = lines[20].split(",")
        cells[column] = reading
        source = tmp_path / f"{name}.csv"
        source.write_text("\n".join([*lines[:20], ",".join(cells), *lines[21:]]) + "\n")
        words = ["twin", SCENE, "--map", str(rehearsal / "map.yaml"), "--source", str(source), "-q"]
        code, _, err = here(*words, "-o", str(tmp_path / f"{name}.nc"))
        assert code == 0, err
        told[name] = tautline.Result.read(tmp_path / f"{name}.nc")
    for name in ("estimate payload.mass", "input winch.pay_out", "winch.tension", "payload.position"):
        assert np.array_equal(told["absurd"][name], told["missing"][name], equal_nan=True), name


def test_ctrl_c_within_a_step_of_a_record_keeps_its_whole_rows_and_ends_as_interrupted(rehearsal, here, monkeypatch):
    from tautline.integrators.status import Interrupted
    from tautline.twin import record as recording

    rows = recording.record

    def heard(*given):
        for k, row in enumerate(rows(*given)):
            if k == 10:
                raise Interrupted(1.0)
            yield row

    monkeypatch.setattr(recording, "record", heard)
    where = rehearsal / "stopped.csv"
    code, _, told = here("record", SCENE, "--map", rehearsal / "map.yaml", "-o", where, "--end", "4 s")
    assert code == 130 and "10 rows, what there was until then" in " ".join(told.split())
    assert len(where.read_text().splitlines()) == 11


def test_a_watched_residual_whose_sensor_is_misspelt_is_no_second_fault(rehearsal, here, tmp_path):
    text = MAP.replace("output: winch.tension", "output: winch.tensoin", 1)
    text = text.replace("watch:\n", "watch:\n  - {residual: winch.tension, above: 4 sd}\n")
    assert "residual: winch.tension" in text and "winch.tensoin" in text
    (tmp_path / "map.yaml").write_text(text)
    code, _, told = here("twin", SCENE, "--map", tmp_path / "map.yaml", "--source", rehearsal / "r.csv")
    (line,) = [one for one in told.splitlines() if "map.yaml" in one]
    assert code == 2 and "sensors[" in line and "did you mean 'winch.tension'?" in line


def test_a_twin_in_which_nothing_was_ever_simulated_ends_with_3_and_why_and_keeps_result_and_state(rehearsal, here):
    source, result, state = (rehearsal / name for name in ("at_block.csv", "at_block.nc", "at_block.state"))
    rows = [f"{0.1 * k:.1f},{-26.0 + 1e-3 * (k % 3)},{1e-4 * k},49\n" for k in range(12)]
    source.write_text("time [s],winch_pos [m],heave [m],rope_tension [kN]\n" + "".join(rows))
    words = ["--map", rehearsal / "map.yaml", "--source", source, "-o", result, "--state", state]
    code, out, told = here("twin", SCENE, *words)
    assert code == 3
    (why,) = [line for line in told.splitlines() if line.startswith("nothing was simulated: ")]
    assert "boom tip: two-blocking" in why and why.endswith("Check zero, sign and unit of winch_pos")
    assert "health is degraded at best" in told and "9000 kg" not in told + out
    with xarray.open_dataset(result, engine="h5netcdf") as data:
        assert data.sizes["time"] == len(rows) and data.attrs["status"] == "nothing simulated"
    source.write_text(source.read_text() + "1.3,-26,0.002,49\n")
    code, _, told = here("twin", SCENE, *words, "--resume", state)
    assert code == 3 and "nothing was simulated: the simulation stopped" in told
