"""The commands ``record`` and ``twin``: what goes in, what comes out, and what they refuse."""

import json
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
    assert lines[0]["time"] == pytest.approx(2.4)
    assert lines[-1]["estimates"]["payload.mass"]["value"] == pytest.approx(5000.0, rel=0.01)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"input: winch.pay_out": "input: winch.payout"}, "there is no input 'winch.payout'; did you mean"),
        ({"unit: kN": "unit: kg"}, "'kg' is not a unit of this quantity"),
        ({"start: 9 t": "start: 90 t"}, "is outside its range"),
        ({"keep:": "kept:"}, "unknown key; did you mean 'keep'?"),
        ({"above: 60 kN": "above: 60 m"}, "'m' is not the unit of a force"),
        ({"column: heave": "column: heav"}, "there is no column 'heav'"),
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
