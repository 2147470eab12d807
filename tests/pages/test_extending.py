"""The page on how to add something: its code is run as it stands."""

import json
import os
import re
import zipfile
from pathlib import Path
from types import SimpleNamespace

import pytest
from of_the_suite import studies
from young_processes import OF_COMMANDS, young_processes

from tautline import entry_points
from tautline.scene import extensions

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "extending.md").read_text(encoding="utf8")
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```$", PAGE, flags=re.MULTILINE | re.DOTALL)
FILES = {text.split("\n")[0].removeprefix("# "): text for kind, text in BLOCKS if kind != "console"}
COMMANDS = [text for kind, text in BLOCKS if kind == "console"]


@pytest.fixture
def folder(tmp_path):
    """A folder with all files of the page."""
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf8")
    return tmp_path


@pytest.fixture(scope="module")
def young():
    with young_processes(*OF_COMMANDS, "matplotlib.pyplot") as run:
        yield run


@pytest.fixture
def ran(young):
    def ran(folder, *words, code=0):
        paths = [str(folder), str(ROOT / "core"), str(ROOT / "apps")]
        done = young(words, cwd=folder, env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)})
        assert done.returncode == code, done.stdout + done.stderr
        return done

    return ran


def installed(folder, name="wind"):
    """Make a folder look like a package whose entry point the page shows."""
    about = folder / f"{name}-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n", encoding="utf8")
    points = re.search(r'^\[project\.entry-points\."(.*)"\]\n(.*)', FILES["pyproject.toml"], flags=re.MULTILINE)
    (about / "entry_points.txt").write_text(f"[{points[1]}]\n{points[2].replace(chr(34), '')}\n", encoding="utf8")


def test_every_block_of_the_page_has_the_name_of_a_file_or_is_a_command():
    assert all(re.fullmatch(r"\w+\.(py|yaml|toml)", name) for name in FILES)
    assert len(FILES) == sum(kind != "console" for kind, _ in BLOCKS)
    assert {kind for kind, _ in BLOCKS} == {"python", "yaml", "toml", "console"}
    assert len(COMMANDS) == 7


@pytest.mark.parametrize("commands", COMMANDS)
def test_the_commands_of_a_block_do_what_their_files_assert(commands, folder, ran):
    for command in commands.splitlines():
        name, *words = command.split()
        assert name == "python"
        ran(folder, *words)


def test_a_command_that_is_a_script_names_itself_as_it_was_called_and_the_next_command_runs(folder, ran):
    told = " ".join(ran(folder, "buoys.py", "check", "raft.yaml").stderr.split())
    following = told.split("Next: ")[1].split()
    assert following == ["python", "buoys.py", "simulate", "raft.yaml"]
    told = " ".join(ran(folder, *following[1:], "--quiet").stderr.split())
    told = " ".join(ran(folder, "buoys.py", "chek", code=2).stderr.split())
    assert "see `python buoys.py --help`" in told
    assert "Usage: python buoys.py" in ran(folder, "buoys.py", "--help").stdout


def test_the_figure_of_the_page_is_offered_and_drawn(folder, ran):
    ran(folder, "drawn.py", "simulate", "raft.yaml")
    refused = ran(folder, "drawn.py", "plot", "raft.nc", "--what", "portrayt", code=2)
    assert "portrait (velocity along x over position)" in " ".join(refused.stderr.split())
    ran(folder, "drawn.py", "plot", "raft.nc", "raft.nc", "--what", "portrait")
    assert {path.suffix for path in folder.glob("*portrait*.*")} == {".png", ".py"}


def test_the_verb_of_the_page_prints_the_weight(folder, ran):
    command = next(line for line in COMMANDS if "weight" in line)
    printed = json.loads(ran(folder, *command.split()[1:]).stdout)
    assert printed["mass"] == pytest.approx(5.0) and printed["weight"] == pytest.approx(49.05)


def test_an_installed_item_is_known_to_check_and_to_the_schema(folder, ran):
    installed(folder)
    shown = json.loads(ran(folder, "-m", "tautline.cli.main", "check", "lamp.yaml", "--json").stdout)
    assert shown["status"] == "good" and shown["cable"]["Wind"] == 1
    code = "from tautline.cable.application import Cable; import json; print(json.dumps(Cable().schema()))"
    assert '"Wind"' in ran(folder, "-c", code).stdout


@pytest.mark.parametrize(
    ("written", "expected"),
    [
        ("speed: -3", r"lamp.yaml:9: CableModel\[4\].Wind.speed = -3: must not be negative"),
        *studies(("speed: 3, direction: [0, 0, 0]", r"Wind.direction: has no direction.*give where it blows to")),
        *studies(("speed: 3 kg", r"lamp.yaml:9: CableModel\[4\].Wind.speed = 3 kg: 'kg' is not the unit of a speed")),
        *studies(("sped: 3", r"lamp.yaml:9: CableModel\[4\].Wind.sped.*unknown key; did you mean 'speed'")),
    ],
)
def test_a_fault_in_an_item_of_the_user_names_line_key_value_and_cure(written, expected, folder, ran):
    installed(folder)
    text = FILES["lamp.yaml"].replace("speed: 36 km/h", written)
    (folder / "lamp.yaml").write_text(text, encoding="utf8")
    told = ran(folder, "-m", "tautline.cli.main", "check", "lamp.yaml", code=2)
    assert re.search(expected, " ".join(told.stderr.split())), told.stderr


def test_an_item_on_a_node_that_does_not_exist_is_refused_with_its_line(folder, ran):
    installed(folder)
    text = FILES["lamp.yaml"].replace("Wind: {nodes4: [1]", "Wind: {nodes4: [7]")
    (folder / "lamp.yaml").write_text(text, encoding="utf8")
    told = ran(folder, "-m", "tautline.cli.main", "check", "lamp.yaml", code=2)
    assert re.search(r"lamp.yaml:9: CableModel\[4\].Wind.nodes4\[0\] = 7: there is no node 7", told.stderr), told.stderr


def test_an_extension_that_cannot_be_loaded_is_named_beside_the_key_that_is_unknown_without_it(folder, ran):
    installed(folder)
    (folder / "wind.py").write_text("import nothing_of_this_name\n", encoding="utf8")
    told = " ".join(ran(folder, "-m", "tautline.cli.main", "check", "lamp.yaml", code=2).stderr.split())
    assert "unknown key 'Wind'" in told
    assert "the extension wind could not be loaded (ModuleNotFoundError" in told
    assert told.index("could not be loaded") < told.index("unknown key")


def test_a_mistake_in_the_syntax_of_an_extension_is_told_with_the_whole_path_of_its_file_and_line(
    monkeypatch, tmp_path
):
    def load():
        exec(compile("x = 1\ny = = 2\n", str(tmp_path / "wind.py"), "exec"))

    point = SimpleNamespace(name="wind", load=load)
    monkeypatch.setattr(entry_points, "in_group", lambda group: [point])
    told = extensions.load_extensions.__wrapped__()
    assert told["wind"].startswith("SyntaxError: ") and told["wind"].endswith(f"({tmp_path / 'wind.py'}, line 2)")


def test_an_extension_that_calls_exit_keeps_neither_the_command_nor_the_other_extensions_from_their_work(folder, ran):
    installed(folder)
    installed(folder, "leaving")
    (folder / "leaving-1.0.dist-info" / "entry_points.txt").write_text(
        "[tautline.extensions]\nleaving = leaving\n[tautline.applications]\nleaving = leaving:Gone\n", encoding="utf8"
    )
    (folder / "leaving.py").write_text("import sys\n\nsys.exit('bye')\n", encoding="utf8")
    shown = json.loads(ran(folder, "-m", "tautline.cli.main", "check", "lamp.yaml", "--json").stdout)
    assert shown["status"] == "good" and shown["cable"]["Wind"] == 1
    text = FILES["lamp.yaml"].replace("Wind:", "Winds:")
    (folder / "lamp.yaml").write_text(text, encoding="utf8")
    told = " ".join(ran(folder, "-m", "tautline.cli.main", "check", "lamp.yaml", code=2).stderr.split())
    assert "the extension leaving could not be loaded (SystemExit: bye); repair or uninstall it" in told


def test_a_mistake_in_a_hook_of_an_extension_is_bad_input_and_no_fault_of_the_program(folder, ran):
    installed(folder)
    text = FILES["wind.py"].replace("r[g.place[i] + c] -= g.drag[i]", "r[g.place[i] + c] -= g.nosuch[i]")
    (folder / "wind.py").write_text(text, encoding="utf8")
    told = " ".join(ran(folder, "-m", "tautline.cli.main", "simulate", "lamp.yaml", code=2).stderr.split())
    assert re.search(r"wind\.py:\d+: hook 'residual' of kind WindForces \(wind\.residual\) cannot be compiled", told)
    assert "'nosuch'" in told and "fault of the program" not in told


def test_a_force_that_is_no_number_as_the_scene_is_drawn_is_told_by_its_part_and_not_blamed_on_the_supports(
    folder, ran
):
    installed(folder)
    text = FILES["wind.py"].replace("-= g.drag[i] * size", "-= g.drag[i] / (size - size) * (size - size)")
    (folder / "wind.py").write_text(text, encoding="utf8")
    told = " ".join(ran(folder, "-m", "tautline.cli.main", "simulate", "lamp.yaml", code=3).stderr.split())
    assert "hook 'residual' of kind WindForces (wind.residual) gives what is no finite number at 0 s" in told
    assert "nothing holds" not in told


def test_the_application_of_the_page_is_the_one_whose_verbs_are_tested():
    assert FILES["buoy.py"].split("\n", 1)[1] == (ROOT / "tests" / "application" / "buoy.py").read_text("utf8")


def test_the_method_of_the_page_is_the_one_that_the_order_tests_measure():
    assert FILES["midpoint.py"].split("\n", 1)[1] == (ROOT / "tests" / "order" / "midpoint.py").read_text("utf8")


@pytest.mark.study
def test_an_fmu_of_an_item_of_others_names_the_package_that_its_host_needs(folder, ran):
    """Where it is written, in its documentation, and by a host that has it not."""
    pytest.importorskip("pythonfmu", reason="PythonFMU is not installed")
    host = "import sys; from tautline.live.fmu.unit import Core; Core(sys.argv[1]); print('the host has made it')"
    unpacked = folder / "lamp"
    installed(folder)
    told = ran(folder, "-m", "tautline.cli.main", "fmu", "lamp.yaml", "--outputs", "node 1.position").stderr
    assert "the package wind 1.0" in " ".join(told.split())
    zipfile.ZipFile(folder / "lamp.fmu").extractall(unpacked)
    assert "the package wind 1.0" in (unpacked / "documentation" / "index.txt").read_text(encoding="utf8")
    assert "has made it" in ran(folder, "-c", host, str(unpacked / "resources")).stdout
    elsewhere = folder / "elsewhere"
    elsewhere.mkdir()
    refused = ran(elsewhere, "-c", host, str(unpacked / "resources"), code=1).stderr
    assert "this FMU needs wind 1.0, not installed in the Python" in refused
