"""A scene that moves its winch by itself knows how up to its end only: this is told, and ends a record and a twin."""

import math

import pytest
import yaml
from cli.in_process import commands_of
from twin.rehearsal import SENSORS, hoist

import tautline
from crane.application import Crane
from tautline.results.result import Result
from tautline.twin.map.file import read_map
from tautline.twin.record import Sensing, record
from tautline.twin.twin import Twin

HEAVE_ALONE = """
sensors:
  - {column: heave, unit: cm, input: vessel.heave}
  - {column: rope_tension, unit: kN, output: winch.tension, sd: 0.5 kN}
"""
END = 1.0


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A scene whose winch is known up to 1 s, maps with the winch and without, and rows of 2 s."""
    folder = tmp_path_factory.mktemp("ends")
    scene = hoist({"time": [0], "value": [0]}, end=END)
    scene["path"][0]["drum"]["pay_out"] = {"harmonic": {"amplitude": 0.5, "period": 40, "ramp": 10}}
    (folder / "scene.yaml").write_text(yaml.safe_dump(scene))
    (folder / "heave.yaml").write_text(HEAVE_ALONE)
    (folder / "all.yaml").write_text(SENSORS)
    rows = "".join(f"{0.1 * k:.1f},0,49\n" for k in range(21))
    (folder / "rows.csv").write_text("time [s],heave [cm],rope_tension [kN]\n" + rows)
    return folder


def test_a_record_beyond_what_the_scene_moves_by_itself_is_refused_before_it_runs(files):
    scene = tautline.read(files / "scene.yaml")
    with pytest.raises(tautline.SceneError, match=r"pay_out is known up to 1 s only; .*solver\.end"):
        next(record(scene, read_map(SENSORS), Sensing(), 2.0))
    assert len(list(record(scene, read_map(SENSORS), Sensing(rate=5.0), END))) == 6


def test_a_twin_ends_where_the_scene_does_with_its_results_and_its_state(files, capsys):
    here = commands_of(Crane(), capsys)
    scene, out, state = files / "scene.yaml", files / "tw.nc", files / "st"
    words = ["--map", files / "heave.yaml", "--source", files / "rows.csv", "-o", out, "--state", state]
    code, _, told = here("twin", scene, *words)
    assert code == 3 and "Traceback" not in told and "fault of the program" not in told
    assert "has no sensor, and is known up to 1 s only" in told and "the twin ends" in told
    result = Result.read(out)
    assert result.attributes["status"] == "scene ended" and float(result["time"][-1]) == pytest.approx(END)
    assert state.exists() and not [one.name for one in files.iterdir() if "lock" in one.name or ".part" in one.name]


def test_a_winch_with_a_sensor_has_no_end(files):
    assert not [one for one in Twin(files / "scene.yaml", SENSORS).notes if "has no sensor" in one]
    assert Twin(files / "scene.yaml", SENSORS)._known_with_sensors()[0] == math.inf
