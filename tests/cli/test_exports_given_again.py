"""An export given again replaces its files; what is refused has written nothing, what fails names what is there."""

import json
import os
from pathlib import Path

import h5py
import pytest
from cli.in_process import commands_of, leave_out_pixels, only_object

from crane.application import Crane
from drillstring.application import Drillstring
from tautline.application.installed import Installed
from tautline.cable.application import Cable
from tautline.results.errors import WriteError

TENSION = ("--csv", "--what", "axial_force")


@pytest.fixture
def export(span, capsys):
    """Runs `export` and gives its exit code and the names of files that it lists."""

    def command(*words):
        code, out, said = commands_of(Cable(), capsys)("export", "span.nc", "--json", *words)
        return code, only_object(out), said

    return command


def of_crane(path):
    """Mark a result as one of a crane."""
    with h5py.File(path, "r+") as file:
        file.attrs["application"] = "crane"


def named(told, ending):
    return [file for file in told["files"] if file.endswith(ending)]


def test_the_same_export_given_twice_writes_the_same_files(export):
    first, again = (export("--vtk", "--csv", "-o", "run") for _ in range(2))
    assert first[0] == again[0] == 0 and first[1]["files"] == again[1]["files"]
    assert named(again[1], ".pvd") == ["run.pvd"] and not list(Path("run").glob("*.pvd"))


def test_tables_of_a_name_stand_beside_the_pvd_of_that_name_and_not_among_its_frames(export):
    export("--vtk", "-o", "run")
    assert export(*TENSION, "-o", "run")[1]["files"] == ["run_axial_force.csv"]


def test_a_slash_at_the_end_still_says_that_the_folder_is_meant(export):
    export("--vtk", "-o", "run")
    assert export(*TENSION, "-o", "run/")[1]["files"] == ["run/span_axial_force.csv"]


def test_a_folder_beside_a_pvd_of_other_frames_is_a_folder(export):
    Path("run").mkdir()
    export("--vtk", "-o", "other")
    Path("run.pvd").write_text(Path("other.pvd").read_text())
    assert export(*TENSION, "-o", "run")[1]["files"] == ["run/span_axial_force.csv"]


@pytest.mark.parametrize(
    "words", [("export", "--csv"), ("export", "--csv", "--vtk"), ("plot",), ("render", "--image", "last")]
)
def test_a_command_of_one_application_refuses_results_of_another_whatever_is_asked_and_writes_nothing(
    span, capsys, words
):
    of_crane("span.nc")
    verb, *more = words
    code, _, said = commands_of(Drillstring(), capsys)(verb, "span.nc", *more)
    assert code == 2 and "is the result of a scene of crane, and not of drillstring; take `tautline`" in said
    assert os.listdir() == ["span.nc"]


def test_tables_are_made_of_a_result_whose_application_nobody_knows(span, capsys):
    with h5py.File("span.nc", "r+") as file:
        file.attrs["application"], file.attrs["scene"] = "gone", "gone: true"
    code, _, _ = commands_of(Installed(), capsys)("export", "span.nc", *TENSION)
    assert code == 0 and Path("span_axial_force.csv").exists()


@pytest.mark.parametrize("reason", ["no appearance", "a file in the way"])
def test_what_paraview_cannot_have_is_refused_before_the_first_table_is_written(span, capsys, monkeypatch, reason):
    if reason == "no appearance":
        monkeypatch.setattr(Cable, "appearance", None)
    else:
        Path("span.pvd").write_text("mine")
    before = set(os.listdir())
    code, _, said = commands_of(Cable(), capsys)("export", "span.nc", "--csv", "--vtk")
    assert code == 2 and ("no appearance" in said or "would be lost" in said)
    assert set(os.listdir()) == before


def test_a_disk_that_is_full_after_the_tables_leaves_them_and_both_ways_of_telling_name_them(export, monkeypatch):
    def full(seen, result, path, progress):
        raise WriteError(path, "cannot be written: No space left on device", "make room")

    monkeypatch.setattr("tautline.view.files.paraview.write_paraview", full)
    code, told, said = export(*TENSION, "--vtk")
    assert code == 3 and told["status"].startswith("stopped")
    assert told["files"] == ["span_axial_force.csv"] and "wrote span_axial_force.csv" in said
    assert Path("span_axial_force.csv").exists()


@pytest.mark.parametrize("folder", ["", "new"])
def test_a_disk_that_is_full_after_the_first_figure_names_it_where_it_stays(span, capsys, monkeypatch, folder):
    leave_out_pixels(monkeypatch)
    from tautline.view.figures import figure

    save = figure.save

    def fills(drawn, path):
        if any(Path(path).parent.glob("*.png")):
            raise WriteError(path, "cannot be written: No space left on device", "make room")
        return save(drawn, path)

    monkeypatch.setattr(figure, "save", fills)
    place = ("-o", f"{folder}/") if folder else ()
    what = ("--what", "axial_force", "--what", "kinetic_energy")
    code, out, _ = commands_of(Cable(), capsys)("plot", "span.nc", "--json", *what, *place)
    told, kept = only_object(out), [] if folder else ["span_axial_force.png"]
    assert code == 3 and told.get("figures", []) == kept == [file.name for file in span.rglob("*.png")]


def test_a_disk_that_is_full_after_the_first_picture_names_it(span, capsys, monkeypatch):
    from tautline.view.space import still as pictures

    def still(stage, frame, file):
        if frame:
            raise WriteError(file, "cannot be written: No space left on device", "make room")
        return file

    monkeypatch.setattr(pictures, "still", still)
    words = ("render", "span.nc", "--json", "--image", "first", "--image", "last", "--size", "160x120")
    code, out, _ = commands_of(Cable(), capsys)(*words)
    assert code == 3 and json.loads(out)["files"] == ["span_0s.png"]


@pytest.mark.parametrize("name", ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1", "pipe"])
def test_several_files_do_not_go_into_a_pipe_or_a_device(export, name):
    os.mkfifo("pipe")
    code, _, said = export("--csv", "-o", name)
    assert code == 2 and f"{name}: is no name of files, and several are written" in said


@pytest.mark.parametrize(("what", "file"), [("time", "A.CSV"), ("axial_force", "A_axial_force.csv")])
def test_a_table_has_the_name_that_was_asked_for_letter_by_letter(export, what, file):
    assert export("--csv", "--what", what, "-o", "A.CSV")[1]["files"] == [file]
    assert file in os.listdir()


@pytest.mark.parametrize("name", ["A.PNG", "a.Svg"])
def test_a_figure_has_the_name_that_was_asked_for_letter_by_letter(span, capsys, name):
    code, out, _ = commands_of(Cable(), capsys)("plot", "span.nc", "--json", "--what", "axial_force", "-o", name)
    assert code == 0 and only_object(out)["figures"] == [name] and name in os.listdir()
    start = Path(name).read_bytes()[:8]
    assert start.startswith(b"\x89PNG" if name == "A.PNG" else b"<?xml")


@pytest.mark.parametrize("words", [("export", "--csv"), ("plot",), ("render", "--image", "last")])
@pytest.mark.parametrize("name", ["pipe.nc", "/dev/zero"])
def test_a_pipe_or_a_device_in_place_of_a_result_is_refused_at_once(span, capsys, words, name):
    os.mkfifo("pipe.nc")
    verb, *more = words
    code, _, said = commands_of(Crane(), capsys)(verb, name, *more)
    assert code == 2 and f"{name}: is not a regular file" in said


def test_tables_of_a_run_that_stopped_early_are_written_and_the_command_says_where_it_stopped(export):
    with h5py.File("span.nc", "r+") as file:
        file.attrs["status"] = "unstable"
    code, told, said = export(*TENSION)
    (warning,) = told["warnings"]
    assert code == 0 and warning["text"].startswith("stopped early: unstable, last frame at 0.02 s")
    assert warning["text"] in said


def test_an_ending_in_capitals_is_told_with_its_frames_and_its_folder_is_known_as_that_of_frames(export):
    code, told, said = export("--vtk", "-o", "run.PVD")
    assert code == 0 and told["files"][0] == "run.PVD" and "files in run; open it in ParaView" in " ".join(said.split())
    assert export(*TENSION, "-o", "run")[1]["files"] == ["run_axial_force.csv"]


def test_frames_that_would_take_the_place_of_others_are_refused_before_the_first_table_is_written(export, span):
    Path("run").mkdir()
    (Path("run") / "cable_0000.vtp").write_text("mine")
    code, _, said = export("--csv", "--vtk", "-o", "run.pvd")
    assert code == 2 and "run/cable_0000.vtp: exists and is no frame of run.pvd" in " ".join(said.split())
    assert sorted(str(file.relative_to(span)) for file in span.rglob("*")) == ["run", "run/cable_0000.vtp", "span.nc"]
