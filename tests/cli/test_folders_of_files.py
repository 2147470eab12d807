"""What ends in a slash is a folder: commands of several files make it, and commands of one file refuse it."""

import json

import pytest
from cli.in_process import commands_of, leave_out_pixels

from crane.application import Crane
from tautline.cable.application import Cable


def held(folder):
    return {file.relative_to(folder).as_posix() for file in folder.rglob("*")} - {"span.nc"}


@pytest.mark.parametrize(
    ("words", "file"),
    [
        (("export", "span.nc", "--csv", "--what", "axial_force"), "span_axial_force.csv"),
        (("plot", "span.nc", "--what", "axial_force"), "span_axial_force.png"),
        (("render", "span.nc", "--image", "last", "--size", "160x120"), "span_2s.png"),
    ],
)
@pytest.mark.parametrize("folder", ["new", "new.png"])
def test_a_folder_by_its_slash_is_made_by_every_command_of_several_files(
    span, capsys, monkeypatch, words, file, folder
):
    leave_out_pixels(monkeypatch)
    code, out, err = commands_of(Cable(), capsys)(*words, "-o", f"{folder}/", "--json")
    told = json.loads(out)
    written = told.get("files", told.get("figures"))
    assert code == 0, err
    assert held(span) == {folder, *written} and all(name.startswith(f"{folder}/span_") for name in written)
    assert words[0] == "render" or written == [f"{folder}/{file}"]


def test_render_makes_the_folder_that_a_name_without_an_ending_is_as_plot_does(span, capsys):
    code, _, err = commands_of(Cable(), capsys)(
        "render", "span.nc", "--image", "first", "--image", "last", "-o", "new", "--size", "160x120"
    )
    assert code == 0, err
    assert len(held(span)) == 3 and all(name.startswith("new") for name in held(span))


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("export", "span.nc", "--csv", "-o", "new/", "--what", "none"), "no variable 'none'"),
        (("export", "span.nc", "--csv", "-o", "no/new/"), "there is no folder no"),
        (("export", "span.nc", "--csv", "-o", "span.nc/"), "is a file, not a folder"),
        (("render", "span.nc", "--image", "last", "-o", "span.nc/"), "is a file, not a folder"),
        (("render", "span.nc", "--image", "last", "-o", "no/new"), "there is no folder no"),
        (("render", "span.nc", "--image", "last", "-o", "new", "--camera", "@none"), "none"),
    ],
)
def test_what_is_refused_makes_no_folder(span, capsys, words, said):
    code, _, err = commands_of(Cable(), capsys)(*words)
    assert code == 2 and said in err and "Traceback" not in err
    assert held(span) == set()


@pytest.mark.parametrize(
    "words",
    [("simulate", "lift.yaml", "-o"), ("check", "lift.yaml", "--figure"), ("new", "lift", "-o"), ("schema", "-o")],
)
def test_a_command_of_one_file_refuses_a_folder_by_its_slash(tmp_path, monkeypatch, capsys, words):
    monkeypatch.chdir(tmp_path)
    code, _, err = commands_of(Crane(), capsys)(*words, "new/")
    assert code == 2 and "new: is a folder by the slash at its end" in err and "name a file in it" in err
    assert list(tmp_path.iterdir()) == []


def test_the_cure_of_a_wrong_size_of_a_picture_says_the_least_and_the_most(span, capsys):
    for size in ("10x10", "100000x100000", "wide"):
        code, _, err = commands_of(Cable(), capsys)("render", "span.nc", "--image", "last", "--size", size)
        assert code == 2 and f"'{size}'" in err and "from 100 to 8192 pixels" in err
