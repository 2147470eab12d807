"""A file of another kind than a command wants is refused in one line, which says of which kind it is."""

from pathlib import Path

import h5py
import pytest
from cli.in_process import commands_of

from crane.application import Crane
from drillstring.application import Drillstring
from tautline.application.installed import Installed
from tautline.integrators.status import Status, StoppedEarly

DATA = Path(__file__).parents[2] / "data"
HOIST, SWEEP = DATA / "hoist.yaml", DATA / "sweeps" / "friction.yaml"
MAP = """sensors:
  - {column: winch_pos, unit: m, input: winch.pay_out}
  - {column: rope_tension, unit: kN, output: winch.tension}
"""
KINDS = [
    (Drillstring, ["check", HOIST], f"{HOIST}: is a scene of crane; use `crane`, or `tautline`"),
    (Drillstring, ["simulate", HOIST], f"{HOIST}: is a scene of crane; use `crane`"),
    (Installed, ["sweep", HOIST], f"{HOIST}: is a scene of crane; name the file of a sweep"),
    (Drillstring, ["check", SWEEP], f"{SWEEP}: is the file of a sweep, and no scene; use `sweep {SWEEP}`"),
    (Installed, ["check", SWEEP], f"{SWEEP}: is the file of a sweep, and no scene; use `sweep {SWEEP}`"),
    (Installed, ["check", "map.yaml"], "map.yaml: is the map of a twin, and no scene; use `twin SCENE --map map.yaml`"),
    (Crane, ["check", "result.nc"], "result.nc: is a result, and no scene; name the scene it was made from"),
    (Crane, ["twin", HOIST, "--map", HOIST], f"{HOIST}: is a scene of crane; name the map of its sensors with --map"),
    (Crane, ["record", HOIST, "--map", HOIST, "-o", "x.csv"], f"{HOIST}: is a scene of crane; name the map"),
    (Crane, ["twin", HOIST, "--map", "map.yaml", "--source", "result.nc"], "result.nc: is not a table"),
]  # fmt: skip


@pytest.mark.parametrize(("application", "words", "said"), KINDS)
def test_a_file_of_another_kind_is_refused_in_one_line(tmp_path, monkeypatch, capsys, application, words, said):
    monkeypatch.chdir(tmp_path)
    h5py.File("result.nc", "w").close()
    Path("map.yaml").write_text(MAP)
    code, _, told = commands_of(application(), capsys)(*words)
    assert code == 2
    assert " ".join(told.split()).startswith(said) and len(told.splitlines()) == 1


def test_a_scene_of_an_application_with_faults_is_still_told_them(tmp_path, capsys):
    path = tmp_path / "scene.yaml"
    path.write_text(HOIST.read_text(encoding="utf8").replace("mass: 5 t", "mass: -5 t"))
    code, _, told = commands_of(Crane(), capsys)("check", path)
    assert code == 2 and "bodies[0].mass = -5 t: must not be negative" in " ".join(told.split())


@pytest.mark.parametrize(
    ("text", "quoted"),
    [("title: My well: A-12", "title: 'My well: A-12'"), ("title: Bob's well: A-12", "title: 'Bob''s well: A-12'")],
)
def test_a_colon_inside_a_text_is_told_with_the_text_in_quotes_which_is_then_read(tmp_path, capsys, text, quoted):
    path, rest = tmp_path / "scene.yaml", "\n".join(HOIST.read_text(encoding="utf8").splitlines()[2:])
    assert "title:" not in rest
    path.write_text(f"{text}\n{rest}")
    command = commands_of(Crane(), capsys)
    code, _, told = command("check", path)
    told = " ".join(told.split())
    assert code == 2 and f"{path}:1: a colon followed by a space" in told and told.endswith(f"in quotes: {quoted}")
    path.write_text(f"{quoted}\n{rest}")
    assert command("check", path)[0] == 0


@pytest.mark.parametrize("verb", ["simulate", "torque-drag"])
def test_an_option_without_its_argument_names_the_help_of_its_verb(capsys, verb):
    option = "--step" if verb == "simulate" else "--depth"
    code, _, told = commands_of(Drillstring(), capsys)(verb, DATA / "jwell.yaml", option)
    assert code == 2 and f"see `drillstring {verb} --help`" in " ".join(told.split())


def test_two_blocking_is_told_by_its_name_time_and_sheave():
    stop = StoppedEarly(Status.TWO_BLOCKED, 12.984, "boom tip: x")
    begin = "two-blocking at 12.98 s: a hook or block has reached `boom tip`. Stop hoisting earlier. "
    assert stop.line.startswith(begin) and stop.status.name == "TWO_BLOCKED"
    other = StoppedEarly(Status.RUN_OUT, 2.5, "winch: x")
    assert other.line == f"stopped at t = 2.5 s, winch: {other.sentence}"
