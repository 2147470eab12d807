"""Files of others are never lost, and standard output that cannot be written is told in one sentence."""

import gzip
import subprocess
import sys
import zipfile
from pathlib import Path

import h5py
import pytest
from cli.in_process import commands_of
from matplotlib.figure import Figure
from of_the_suite import studies

import tautline
from crane.application import Crane
from tautline.results.errors import ResultError
from tautline.results.output_path import check_drawn
from tautline.simulation import simulate

SCENE = "data/hoist.yaml"


@pytest.fixture
def here(capsys):
    """The command in this process: exit code, standard output, standard error."""
    return commands_of(Crane(), capsys)


def said(err):
    """What was printed for people, in one line."""
    return " ".join(err.split())


def test_a_netcdf_file_of_another_program_is_not_replaced_by_a_result(here, tmp_path):
    waves = tmp_path / "hoist.nc"
    with h5py.File(waves, "w") as file:
        file["Hs"] = [1.0, 2.0]
    before = waves.read_bytes()
    code, _, err = here("simulate", SCENE, "-q", "--no-verify", "--end", "0.1", "-o", str(waves))
    assert code == 2 and "not a Tautline result: it would be lost" in said(err)
    assert waves.read_bytes() == before


def test_an_earlier_result_is_replaced(here, tmp_path):
    for _ in range(2):
        code = here("simulate", SCENE, "-q", "--no-verify", "--end", "0.1", "-o", str(tmp_path / "hoist.nc"))[0]
        assert code == 0


@pytest.mark.parametrize("content", [b"PK of another program", b"text", None])
def test_an_fmu_replaces_an_fmu_of_tautline_and_no_other_file(here, tmp_path, content):
    pytest.importorskip("pythonfmu", reason="PythonFMU is not installed")
    mine, made = tmp_path / "mine.fmu", tmp_path / "made.fmu"
    if content is None:
        with zipfile.ZipFile(mine, "w") as archive:
            archive.writestr("modelDescription.xml", "<fmiModelDescription/>")
    else:
        mine.write_bytes(content)
    before = mine.read_bytes()
    words = ["--inputs", "winch.pay_out_speed", "--outputs", "winch.tension"]
    code, _, err = here("fmu", SCENE, "-o", str(mine), *words)
    assert code == 2 and "exists and is no FMU of Tautline: it would be lost" in said(err)
    assert mine.read_bytes() == before
    assert [here("fmu", SCENE, "-o", str(made), *words)[0] for _ in range(2)] == [0, 0]
    assert sorted(tmp_path.iterdir()) == [made, mine]


def test_a_schema_replaces_a_schema_and_no_other_json(here, tmp_path):
    mine, made = tmp_path / "mine.json", tmp_path / "schema.json"
    mine.write_text('{"important": 1}')
    code, _, err = here("schema", "-o", str(mine))
    assert code == 2 and "exists and is no schema: it would be lost" in said(err)
    assert mine.read_text() == '{"important": 1}'
    assert [here("schema", "-o", str(made))[0] for _ in range(2)] == [0, 0]


def test_a_table_of_others_in_the_folder_of_a_sweep_is_not_replaced(here, tmp_path):
    folder = tmp_path / "folder"
    folder.mkdir()
    (folder / "sweep.csv").write_text("mine")
    sweep = tmp_path / "s.yaml"
    scene = Path(SCENE).absolute()
    sweep.write_text(f"scene: {scene}\nvary:\n  bodies[0].mass: [4000, 6000]\n  solver.end: [0.1]\n")
    code, _, err = here("sweep", str(sweep), "-q", "-o", str(folder))
    assert code == 2 and "exists and holds other files" in said(err)
    assert (folder / "sweep.csv").read_text() == "mine"


FULL, CLOSED = ("> /dev/full", "No space left"), (">&-", "it is closed")


@pytest.mark.parametrize(
    "words, told",
    [
        *[(("check", SCENE, "--json"), told) for told in (FULL, CLOSED)],
        *studies(*[(("schema",), told) for told in (FULL, CLOSED)]),
        (("--help",), FULL),
        (("--version",), FULL),
    ],
)
def test_standard_output_that_cannot_be_written_is_told_in_one_sentence(words, told):
    way, cause = told
    command = " ".join([sys.executable, "-m", "crane.main", *words, way])
    found = subprocess.run(["bash", "-c", command], capture_output=True, text=True, timeout=120)
    assert found.returncode == 3
    assert f"standard output: cannot be written: {cause}" in found.stderr
    assert "Traceback" not in found.stderr and "fault of the program" not in found.stderr


@pytest.mark.parametrize("way", ["2>&1 | head -c 1", "2> /dev/full"])
def test_a_run_goes_on_where_the_reader_of_its_words_goes_away_or_has_no_room_for_them(tmp_path, way):
    target = tmp_path / "hoist.nc"
    run = f"{sys.executable} -m crane.main simulate {SCENE} --no-verify --end 0.5 -o {target}"
    subprocess.run(["bash", "-c", f"({run}; echo $? > {tmp_path}/code) {way}"], capture_output=True, timeout=120)
    assert (tmp_path / "code").read_text().strip() == "0" and target.exists()


@pytest.mark.parametrize("words, code", [(("check", SCENE), 0), (("check", "none.yaml"), 2)])
def test_the_exit_code_is_that_of_the_command_where_its_words_cannot_be_written(words, code):
    command = " ".join([sys.executable, "-m", "crane.main", *words, "2> /dev/full"])
    assert subprocess.run(["bash", "-c", command], capture_output=True, timeout=120).returncode == code


@pytest.mark.parametrize("option", ["--exaggerate=1e300", "--radius=1e300"])
def test_a_factor_that_nobody_can_mean_is_refused(here, tmp_path, option):
    result = tmp_path / "hoist.nc"
    assert here("simulate", SCENE, "-q", "--no-verify", "--end", "0.1", "-o", str(result))[0] == 0
    code, _, err = here("render", str(result), "--image", "last", "-o", str(tmp_path / "picture.png"), option)
    assert code == 2 and "is no factor" in said(err) and "below 1,000,000" in said(err)
    assert [one.name for one in tmp_path.iterdir()] == ["hoist.nc"]


def test_a_study_of_which_no_setting_can_be_run_writes_nothing(here, tmp_path):
    code, _, err = here("study", SCENE, "--steps", "1e-12", "--quick", "-o", str(tmp_path / "s"))
    assert code == 2 and "no setting can be run" in said(err)
    assert not list(tmp_path.iterdir())


def test_water_under_gravity_that_leans_is_refused(here, tmp_path):
    scene = tmp_path / "leaning.yaml"
    text = """
rope: {mass_per_length: 2, axial_stiffness: 1.0e7, diameter: 50 mm}
bodies: [{name: p, mass: 20, position: [10, 0, -30]}]
path: [{anchor: {name: a, position: [0, 0, 0]}}, {end: {name: h, body: p}}]
gravity: [3, 0, -9]
water: {surface: 50, density: 1025}
mesh: {elements_per_span: 4}
solver: {step: 10 ms, end: 0.1 s}
output: {interval: 50 ms}
"""
    scene.write_text(text)
    code, _, err = here("check", str(scene))
    assert code == 2 and "does not point down along z" in said(err)
    scene.write_text(text.replace("[3, 0, -9]", "[0, 0, -9]"))
    assert here("check", str(scene))[0] == 0


def test_a_result_of_another_kind_of_scene_is_named_as_that(here, tmp_path):
    made = tmp_path / "well.nc"
    tautline.simulate("data/jwell.yaml", path=made, end=0.1)
    for verb in (("plot", "-o", str(tmp_path / "figures")), ("render", "--image", "last")):
        code, _, err = here(verb[0], str(made), *verb[1:])
        assert code == 2 and "is the result of a scene of drillstring, and not of crane" in said(err)
    assert [one.name for one in tmp_path.iterdir()] == ["well.nc"]


def test_a_list_that_the_scene_does_not_have_is_not_called_a_mapping(here, tmp_path):
    code, _, err = here("check", SCENE, "--set", "Bodies[0].mass=1")
    assert code == 2 and "there is no list of this name" in said(err)


def test_a_record_may_go_into_a_pipe(tmp_path):
    """It is not read before it is written, which would wait for ever."""
    (tmp_path / "map.yaml").write_text("sensors:\n  - {column: pull, unit: kN, output: winch.tension, sd: 0.5 kN}\n")
    verb = (
        f"{sys.executable} -m crane.main record {SCENE} --map {tmp_path}/map.yaml --end 0.2 -o /dev/stdout | head -n 1"
    )
    found = subprocess.run(["bash", "-c", verb], capture_output=True, text=True, timeout=120)
    assert found.stdout == "time [s],pull [kN]\n", found.stderr


def test_a_dash_is_no_name_of_a_result(here, tmp_path, monkeypatch):
    scene = str(Path(SCENE).absolute())
    monkeypatch.chdir(tmp_path)
    code, _, err = here("simulate", scene, "-q", "--no-verify", "--end", "0.1", "-o", "-")
    assert code == 2 and "name it, such as result.nc" in said(err)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("option", "value", "example"),
    [("--step", "5kg", "a time such as 1 ms"), ("--accuracy", "0", "a share such as 1 %")],
)
def test_an_option_says_by_an_example_what_it_takes(here, option, value, example):
    code, _, err = here("simulate", SCENE, option, value)
    assert code == 2 and f"{option} {value}: " in said(err) and example in said(err)


@pytest.fixture(scope="module")
def lifted(tmp_path_factory):
    path = tmp_path_factory.mktemp("lifted") / "hoist.nc"
    simulate(Crane().build(tautline.read(SCENE).replace({"solver.end": 0.5})), path)
    return path


def with_hole(lifted, folder, array):
    """A copy of a result in which an array holds no number in its third frame."""
    path = folder / "hoist.nc"
    path.write_bytes(lifted.read_bytes())
    with h5py.File(path, "r+") as file:
        file[array][2, ...] = float("nan")
    return path


WORDS = {"plot": (), "render": ("--image", "last"), "export": ("--csv", "--vtk")}


@pytest.mark.parametrize("array", ["time", "position", "tension"])
@pytest.mark.parametrize("verb", WORDS)
def test_a_result_that_holds_no_number_somewhere_is_shown_without_it_or_refused_with_array_and_time(
    here, lifted, tmp_path, verb, array
):
    path, out = with_hole(lifted, tmp_path, array), tmp_path / ("out.png" if verb == "render" else "out")
    code, _, err = here(verb, path, *WORDS[verb], "-o", out)
    assert code in (0, 2) and "fault of the program" not in err
    where = "frame 3" if array == "time" else "t = 0.1 s"
    assert f"hoist.nc: '{array}' holds no number (NaN) at {where} first, in 1 of 11 frames" in said(err)
    if code == 2:
        assert [one.name for one in tmp_path.iterdir()] == ["hoist.nc"]


def test_a_result_that_holds_all_its_numbers_is_shown_without_a_word_of_that(here, lifted, tmp_path):
    code, _, err = here("plot", lifted, "--what", "tension", "-o", tmp_path / "out.png")
    assert code == 0 and "holds no number" not in err


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    path = tmp_path_factory.mktemp("result") / "hoist.nc"
    tautline.simulate(SCENE, path=path, end=0.1)
    return path


@pytest.mark.parametrize("kind", ["link", "hard link", "text"])
@pytest.mark.parametrize(
    "words",
    [
        ("plot", "RESULT", "-o"),
        ("plot", "RESULT", "--what", "tip", "-o"),
        ("render", "RESULT", "--image", "last", "-o"),
    ],
    ids=["plot", "plot one figure", "render"],
)
def test_a_figure_takes_the_place_of_no_file_that_is_none_and_of_no_result_behind_a_link(
    here, result, tmp_path, kind, words
):
    own, picture = tmp_path / "own.nc", tmp_path / "picture.png"
    own.write_bytes(result.read_bytes())
    if kind == "text":
        picture.write_text("my notes", encoding="utf8")
    else:
        (picture.symlink_to if kind == "link" else picture.hardlink_to)(own)
    before, kept = picture.read_bytes(), sorted(tmp_path.iterdir())
    code, _, err = here(*(str(own) if word == "RESULT" else word for word in words), str(picture))
    assert code == 2 and "is no figure: it would be lost" in said(err)
    assert picture.read_bytes() == before and own.read_bytes() == result.read_bytes()
    assert sorted(tmp_path.iterdir()) == kept


def test_no_figure_of_several_is_written_where_one_would_take_the_place_of_a_file_that_is_none(here, result, tmp_path):
    folder = tmp_path / "plots"
    folder.mkdir()
    assert here("plot", str(result), "-o", str(folder))[0] == 0
    drawn = sorted(folder.iterdir())
    drawn[-1].unlink()
    drawn[-1].symlink_to(result)
    before = {file: file.stat().st_mtime_ns for file in drawn}
    code, _, err = here("plot", str(result), "-o", str(folder))
    assert code == 2 and "is a link to" in said(err)
    assert {file: file.stat().st_mtime_ns for file in drawn} == before


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_a_figure_takes_the_place_of_an_earlier_one_of_any_format(here, result, tmp_path, ending):
    picture = tmp_path / f"picture.{ending}"
    assert [here("plot", str(result), "--what", "tension", "-o", str(picture))[0] for _ in range(2)] == [0, 0]


@pytest.mark.parametrize("ending", ["nc", "png"])
def test_a_study_replaces_no_result_with_its_tables_and_figure(here, result, tmp_path, ending):
    (tmp_path / f"mine.{ending}").symlink_to(result)
    before = result.read_bytes()
    code, _, err = here("study", SCENE, "--quick", "-o", str(tmp_path / "mine"))
    assert code == 2 and "would be lost" in said(err)
    assert result.read_bytes() == before


SVG = b"<svg xmlns='http://www.w3.org/2000/svg'></svg>"
PROLOGS = {
    "licence": b"<?xml version='1.0'?>\n<!-- " + 3000 * b"a licence " + b"-->\n",
    "entities": b"<!DOCTYPE svg [" + 200 * b"<!ENTITY ns 'http://www.w3.org/2000/svg'>" + b"]>",
}


@pytest.mark.parametrize("ending", ["eps", "ps", "svgz", "svg", "pdf", "png", "tif", "jpg"])
def test_an_earlier_figure_of_any_format_that_is_drawn_may_be_replaced(tmp_path, ending):
    path = tmp_path / f"figure.{ending}"
    Figure().savefig(path)
    assert check_drawn(path) == path


@pytest.mark.parametrize("prolog", PROLOGS)
def test_an_svg_with_much_before_its_first_element_may_be_replaced(tmp_path, prolog):
    for name, wrapped in (("figure.svg", bytes), ("figure.svgz", gzip.compress)):
        path = tmp_path / name
        path.write_bytes(wrapped(PROLOGS[prolog] + SVG))
        assert check_drawn(path) == path


@pytest.mark.parametrize(
    "content",
    [
        b"<!doctype html><html><body>" + SVG + b"</body></html>",
        b"<!-- <svg> --><html>" + SVG + b"</html>",
        gzip.compress(b"my notes"),
        b"\x1f\x8bno gzip",
        b"% my paper\n\\documentclass{article}",
    ],
    ids=["page", "page with a remark", "gzip of notes", "damaged gzip", "tex"],
)
def test_a_page_with_a_figure_in_it_an_archive_and_a_text_are_no_figures(tmp_path, content):
    path = tmp_path / "figure.svg"
    path.write_bytes(content)
    with pytest.raises(ResultError, match="is no figure: it would be lost"):
        check_drawn(path)


def test_a_figure_for_tex_may_be_replaced(tmp_path):
    path = tmp_path / "figure.pgf"
    path.write_bytes(b"%% Creator: Matplotlib, PGF backend\n%%\n")
    assert check_drawn(path) == path
