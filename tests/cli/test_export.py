"""The verb ``export``: what it writes where, and what it refuses."""

import json
import re

import numpy as np
import pytest
from cli.in_process import commands_of
from physics.cables.rope_text import PINNED, chain, scene
from view.made_up import moved

from tautline.application.installed import Single
from tautline.cable.application import Cable
from tautline.cli.commands.export import export
from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.view.space.appearance import Look

CATALOGUE = Single(Cable())


@pytest.fixture
def span(tmp_path, monkeypatch):
    """A result of two elements in the current folder."""
    p = np.linspace(0.0, 1.0, 3)
    items = chain(np.stack([p, 0 * p, 0 * p], axis=-1), p, {0: PINNED}, EA=1e3, EJ=0.1)
    moved(scene(items), path=tmp_path / "span.1.nc", frames=3)
    monkeypatch.chdir(tmp_path)
    return tmp_path / "span.1.nc"


def files_of(folder):
    return {file.relative_to(folder).as_posix() for file in folder.rglob("*") if file.is_file()}


def test_both_are_written_beside_each_other_and_listed_in_json(span, capsys):
    export(CATALOGUE, span, None, True, True, (), Look(), True)
    told = json.loads(capsys.readouterr().out)
    assert told["status"] == "done"
    assert set(told["files"]) == files_of(span.parent) - {"span.1.nc"}
    assert {"span.1.pvd", "span.1.csv", "span.1_position.csv", "span.1/cable_0002.vtp"} <= set(told["files"])


def test_help_says_that_a_name_that_is_no_folder_begins_the_names_of_files(capsys):
    run = commands_of(Cable(), capsys)
    words = " ".join(re.sub("[│╭╰─]", " ", run("export", "--help")[1]).split())
    assert "FOLDER_OR_STEM" in words and "FILE_OR_FOLDER" not in words
    assert "FILE_OR_FOLDER" in run("plot", "--help")[1]


@pytest.mark.parametrize("name", ["out/mine", "out/mine.pvd", "out/mine.csv"])
def test_a_name_is_taken_with_or_without_its_ending(span, name):
    (span.parent / "out").mkdir()
    export(CATALOGUE, span, span.parent / name, True, True, ("axial_force",), Look(), False)
    assert {"mine.pvd", "mine_axial_force.csv", "mine/supports.vtp"} <= files_of(span.parent / "out")


def test_of_so_many_frames_one_is_written_and_the_last_with_the_numbers_of_their_time(span):
    import pyvista

    export(CATALOGUE, span, span.parent / "few", True, False, (), Look(), False, every=2)
    reader = pyvista.get_reader(span.parent / "few.pvd")
    whole = Result.read(span)
    assert reader.time_values == [whole.time[0], whole.time[2]]  # of three frames
    reader.set_active_time_value(whole.time[2])
    lines = next(block for block in reader.read() if "kinetic_energy [J]" in block.field_data)
    assert lines.field_data["kinetic_energy [J]"][0] == whole["kinetic_energy"][2]
    assert np.allclose(lines.points[-1], whole["position"][2, -1])


def test_a_folder_gets_files_of_the_results_name(span):
    (span.parent / "out").mkdir()
    export(CATALOGUE, span, span.parent / "out", False, True, ("axial_force",), Look(), False)
    assert files_of(span.parent / "out") == {"span.1_axial_force.csv"}


@pytest.mark.parametrize(
    "output, vtk, csv, what, look, words",
    [
        (None, False, False, (), Look(), r"--vtk .*--csv"),
        (None, True, False, ("tip",), Look(), r"--what: .*add --csv"),
        (None, False, True, (), Look(exaggerate=2.0), r"--exaggerate: .*add --vtk"),
        (None, False, True, (), Look(view="space"), r"--view: .*add --vtk"),
        ("x.csv", True, False, (), Look(), r"ends in \.csv"),
        ("x.pvd", False, True, (), Look(), r"ends in \.pvd"),
        ("x.yaml", False, True, (), Look(), r"ends in \.yaml.*name it x\.csv"),
        ("x.txt", True, False, (), Look(), r"ends in \.txt.*name it x\.pvd"),
        ("x.nc", True, True, (), Look(), r"ends in \.nc.*name it x\.csv"),
        (None, True, True, ("tip",), Look(), r"no variable 'tip'"),
        (None, True, False, (), Look(view="inside"), r"no view 'inside'"),
    ],
)
def test_what_contradicts_itself_is_refused_and_writes_nothing(span, output, vtk, csv, what, look, words):
    with pytest.raises(ResultError, match=words):
        export(CATALOGUE, span, output and span.parent / output, vtk, csv, what, look, False)
    assert files_of(span.parent) == {"span.1.nc"}


def test_an_application_without_an_appearance_is_told_so(span):
    class Bare:
        name, title = "cable", "Nothing to see."

    with pytest.raises(ResultError, match=r"results of cable have no appearance.*--csv"):
        export(Single(Bare()), span, None, True, False, (), Look(), False)


@pytest.mark.parametrize(("asked", "factor"), [(None, 1.0), (50.0, 50.0)])
def test_paraview_gets_places_and_radii_that_are_true_unless_a_factor_is_asked_for(
    span, capsys, monkeypatch, asked, factor
):
    from dataclasses import replace

    from tautline.application import space

    seen, of = [], space.appearance_of

    def looked(application, result, look):
        seen.append(look.exaggerate)
        larger = (("across the hole", look.exaggerate or 190.0),) if look.exaggerate != 1.0 else ()
        return replace(of(application, result, Look()), enlarged=larger)

    monkeypatch.setattr(space, "appearance_of", looked)
    export(CATALOGUE, span, None, True, False, (), Look(exaggerate=asked), False)
    assert seen == [factor]
    written = "".join(file.read_bytes().decode("latin1") for file in span.parent.rglob("*.vtp"))
    told = capsys.readouterr()
    assert ("In it: across the hole 50 times as large" in " ".join((told.out + told.err).split())) == (factor != 1.0)
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    notes = []
    for file in sorted(span.parent.rglob("*_0000.vtp")):
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(str(file))
        reader.Update()
        array = reader.GetOutput().GetFieldData().GetAbstractArray("notes")
        notes += [array.GetValue(i) for i in range(array.GetNumberOfValues())] if array else []
    assert any("drawn 50 times as large" in note for note in notes) == (factor != 1.0) and written


def test_standard_output_is_no_name_of_files(span):
    from pathlib import Path

    with pytest.raises(ResultError, match="- is no name of files"):
        export(CATALOGUE, span, Path("-"), False, True, (), Look(), False)
    assert files_of(span.parent) == {"span.1.nc"}


def test_tables_take_their_names_when_all_of_them_are_whole(span, monkeypatch):
    from tautline.results.tables import table

    export(CATALOGUE, span, None, False, True, (), Look(), False)
    before = {file: (span.parent / file).read_bytes() for file in files_of(span.parent)}
    for file in before:
        if file.endswith(".csv"):
            (span.parent / file).write_bytes(before[file] + before[file].splitlines(keepends=True)[-1])
    earlier = {file: (span.parent / file).read_bytes() for file in before}
    opened, write = table._begun, []

    def full(file):
        write.append(file)
        if len(write) == 3:
            raise ResultError(file, "cannot be written: No space left on device")
        return opened(file)

    monkeypatch.setattr(table, "_begun", full)
    with pytest.raises(ResultError, match="No space"):
        export(CATALOGUE, span, None, False, True, (), Look(), False)
    assert {file: (span.parent / file).read_bytes() for file in files_of(span.parent)} == earlier


def test_many_files_are_told_before_they_are_written_and_the_option_told_makes_as_few_as_it_says(
    span, capsys, monkeypatch
):
    from tautline.cli.commands import export as verb

    # Of five frames every second one is three of them, and not a half of five.
    moved_on = span.parent / "five.nc"
    p = np.linspace(0.0, 1.0, 3)
    items = chain(np.stack([p, 0 * p, 0 * p], axis=-1), p, {0: PINNED}, EA=1e3, EJ=0.1)
    moved(scene(items), path=moved_on, frames=5)
    monkeypatch.setattr(verb, "MANY", 5)
    export(CATALOGUE, moved_on, None, True, False, (), Look(), False)
    told = " ".join("".join(capsys.readouterr()).split())
    said = re.search(r"up to (\d+) files will be written. --every (\d+) writes (\d+) at most", told)
    assert said is not None
    most, every, fewer = map(int, said.groups())
    assert len(files_of(span.parent / "five")) <= most
    export(CATALOGUE, moved_on, span.parent / "few", True, False, (), Look(), False, every=every)
    written = len(files_of(span.parent / "few"))
    assert (every, written) == (2, fewer)
