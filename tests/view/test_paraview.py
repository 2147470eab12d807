"""Files for ParaView, read back by VTK's own readers: times, parts, points, arrays with units; and what is left."""

import hashlib
import os
import re
import resource
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from physics.cables.rope_text import PINNED, chain, scene
from view.made_up import moved

from tautline.cable.view.appearance import appearance
from tautline.results.errors import ResultError, WriteError
from tautline.results.result import Result
from tautline.view.space.appearance import (
    Appearance,
    Arrows,
    Level,
    Line,
    Look,
    Quantity,
    Ruler,
    Solid,
    placed,
    pose_of,
    ranged,
    still,
    stored,
)  # fmt: skip
from tautline.view.space.mesh import box

pv = pytest.importorskip("pyvista")

from tautline.view.files.paraview import write_paraview  # noqa: E402

TIME = np.array([0.0, 0.1, 1.0 / 3.0, 0.5])
QUANTITIES = (("axial_force", "N"), ("speed", "m/s"))


def rope(name, m, frames, only_force=False):
    rng = np.random.default_rng(m)
    points = rng.normal(size=(frames, m, 3))
    shown = QUANTITIES[:1] if only_force else QUANTITIES
    quantities = tuple(ranged(key, key, unit, rng.normal(size=(frames, m)) * 1e5) for key, unit in shown)
    return Line(name, stored(points), 0.01 * np.arange(1, m + 1), quantities, nodes=np.array([0, m - 1]))


def seen(frames=4):
    """Two ropes, one with a quantity less; a still line; a moving and two still solids; arrows; a level; a ruler."""
    rng = np.random.default_rng(3)
    turn = [pose_of(place, np.linalg.qr(rng.normal(size=(3, 3)))[0]) for place in rng.normal(size=(frames, 3))]
    force = rng.normal(size=(frames, 5, 3))
    return Appearance(
        title="All there is",
        time=TIME[:frames],
        lines=(
            rope("rope 1", 7, frames),
            rope("rope 2", 4, frames, only_force=True),
            Line("path & more", still(rng.normal(size=(9, 3))), 0.0),
        ),
        solids=(
            Solid("sheave 1", *box((1, 2, 3)), lambda k: turn[k], "#102030"),
            Solid("sheave 2", *box((1, 1, 1)), None, "#FF0000"),
            Solid("boom", *box((9, 1, 1))),
        ),
        arrows=(Arrows("wall", "force of the wall", "N", stored(force + 1.0), stored(force), 1.0),),
        levels=(Level("sea", -2.0),),
        rulers=(Ruler("depth", "m", np.array([[0, 0, 0], [0, 0, -9.0]]), np.array([0.0, 9.0])),),
        notes=("offsets are drawn larger",),
    )


@pytest.fixture(scope="module")
def cable(tmp_path_factory):
    """A stored result of two elements, with what it looks like."""
    path = tmp_path_factory.mktemp("cable") / "span.nc"
    p = np.linspace(0.0, 1.0, 3)
    items = chain(np.stack([p, 0 * p, 0 * p], axis=-1), p, {0: PINNED}, EA=1e3, EJ=0.1)
    moved(scene(items), path=path, frames=5)
    result = Result.read(path)
    return result, appearance(result, Look())


def blocks(path, time):
    """Parts by name at a time, read by PyVista; the names are those that ParaView gives its blocks."""
    reader = pv.get_reader(path)
    reader.set_active_time_value(time)
    names = [re.search(r'name="([^"]*)"', row).group(1) for row in path.read_text().splitlines() if "part=" in row]
    read = reader.read()
    return dict(zip(names, (read[i] for i in range(read.n_blocks)), strict=False))


def test_the_times_are_those_of_the_result_to_the_last_bit(tmp_path):
    write_paraview(seen(), result_of(seen()), tmp_path / "all.pvd")
    assert pv.get_reader(tmp_path / "all.pvd").time_values == TIME.tolist()


def result_of(look, path=None):
    """A result of a look's times, with one number at each."""
    from tautline.results.store import Store
    from tautline.results.variable import Variable

    variables = [Variable("time", ("time",), "s", "time"), Variable("hook_load", ("time",), "N", "hook load")]
    with Store(path, variables, {}, {"scene": ""}) as store:
        store.append({"time": look.time, "hook_load": 1e5 * look.time})
        return store.finish()


def test_lines_are_polylines_with_all_that_is_known_at_their_points(tmp_path):
    look = seen()
    write_paraview(look, result_of(look), tmp_path / "all.pvd")
    for frame, time in enumerate(TIME):
        ropes = blocks(tmp_path / "all.pvd", time)["rope"]
        assert ropes.n_points == 11 and ropes.n_cells == 2
        np.testing.assert_array_equal(ropes.points, np.concatenate([line.points(frame) for line in look.lines[:2]]))
        np.testing.assert_array_equal(ropes.lines, [7, *range(7), 4, *range(7, 11)])
        first, second = (line.quantities for line in look.lines[:2])
        force = np.concatenate([first[0].values(frame), second[0].values(frame)])
        np.testing.assert_array_equal(ropes.point_data["axial_force [N]"], force)
        speed = ropes.point_data["speed [m/s]"]
        np.testing.assert_array_equal(speed[:7], first[1].values(frame))
        assert np.isnan(speed[7:]).all()
        np.testing.assert_array_equal(ropes.point_data["node"], [1, -1, -1, -1, -1, -1, 2, 1, -1, -1, 2])
        np.testing.assert_array_equal(ropes.point_data["line"], [1] * 7 + [2] * 4)
        np.testing.assert_array_equal(ropes.cell_data["line"], [1, 2])
        np.testing.assert_allclose(ropes.point_data["radius [m]"][:7], 0.01 * np.arange(1, 8))
        assert ropes.active_scalars_name == "axial_force [N]"
        assert ropes.field_data["hook_load [N]"] == 1e5 * time and list(ropes.field_data["names"]) == [
            "rope 1",
            "rope 2",
        ]
        assert list(ropes.field_data["notes"]) == ["offsets are drawn larger"]


def test_solids_are_where_they_are_at_each_frame_and_in_their_colour(tmp_path):
    look = seen()
    write_paraview(look, result_of(look), tmp_path / "all.pvd")
    for frame, time in enumerate(TIME):
        sheaves = blocks(tmp_path / "all.pvd", time)["sheave"]
        turned = placed(look.solids[0].points, look.solids[0].pose(frame))
        np.testing.assert_allclose(sheaves.points[:8], turned, atol=1e-6)
        np.testing.assert_allclose(sheaves.points[8:], look.solids[1].points)
        # The volume is positive only if the triangles are seen from outside.
        assert np.isclose(sheaves.volume, 6.0 + 1.0, rtol=1e-5)
        np.testing.assert_array_equal(sheaves.cell_data["solid"], [1] * 12 + [2] * 12)
        np.testing.assert_array_equal(sheaves.cell_data["colour"][[0, -1]], [[16, 32, 48], [255, 0, 0]])


def test_arrows_are_vectors_at_points(tmp_path):
    look = seen()
    write_paraview(look, result_of(look), tmp_path / "all.pvd")
    wall = blocks(tmp_path / "all.pvd", TIME[2])["wall"]
    np.testing.assert_array_equal(wall.points, look.arrows[0].points(2))
    np.testing.assert_array_equal(wall.point_data["wall [N]"], look.arrows[0].vectors(2))
    assert wall.n_cells == 5 and wall.active_vectors_name == "wall [N]"


def test_what_never_moves_is_one_file_that_every_time_refers_to(tmp_path):
    files = write_paraview(seen(), result_of(seen()), tmp_path / "all.pvd")
    names = [file.name for file in files[1:]]
    assert {"path_more.vtp", "boom.vtp", "sea.vtp", "depth.vtp"} <= set(names) and len(names) == 3 * 4 + 4
    assert sorted(names) == sorted(file.name for file in (tmp_path / "all").iterdir())
    there = blocks(tmp_path / "all.pvd", TIME[3])
    assert list(there) == ["rope", "path &amp; more", "sheave", "boom", "wall", "sea", "depth"]
    assert there["sea"].bounds[4:] == (-2.0, -2.0) and there["sea"].bounds[1] > there["boom"].bounds[1]
    np.testing.assert_array_equal(there["depth"].point_data["depth [m]"], [0.0, 9.0])


def test_what_stops_moving_is_not_written_again(tmp_path):
    look = seen()
    pose = [pose_of((0, 0, z)) for z in (0.0, 1.0, 1.0, 2.0)]
    moving = Solid("hook", *box((1, 1, 1)), lambda k: pose[k])
    acts = Arrows("pull", "pull", "N", still(np.zeros((1, 3))), lambda k: np.full((1, 3), float(k > 1)), 2.0)
    files = write_paraview(Appearance("", look.time, (), (moving,), (acts,)), result_of(look), tmp_path / "all.pvd")
    names = ["hook_0000.vtp", "hook_0001.vtp", "hook_0003.vtp", "pull_0000.vtp", "pull_0002.vtp"]
    assert sorted(file.name for file in files[1:]) == names
    for time, z, pull in zip(TIME, (0.0, 1.0, 1.0, 2.0), (0.0, 0.0, 1.0, 1.0), strict=True):
        there = blocks(tmp_path / "all.pvd", time)
        assert there["hook"].center[2] == z and there["pull"].point_data["pull [N]"][0, 0] == pull


def test_a_cables_force_bounds_and_nodes_read_back_as_the_result_has_them(tmp_path, cable):
    result, look = cable
    write_paraview(look, result, tmp_path / "span.pvd")
    read = blocks(tmp_path / "span.pvd", result.time[3])["cable"]
    node = read.point_data["node"]
    for number in (1, 2, 3):
        np.testing.assert_array_equal(read.points[node == number][0], result["position"][3, number - 1])
    middles = np.flatnonzero(node > 0)[:2] + (np.flatnonzero(node > 0)[1] // 2)
    np.testing.assert_array_equal(read.point_data["axial_force [N]"][middles], result["axial_force"][3])
    points = look.lines[0].points(3)
    np.testing.assert_allclose(read.bounds, np.stack([points.min(axis=0), points.max(axis=0)]).T.ravel())
    assert {"axial_force [N]", "curvature [1/m]", "speed [m/s]"} <= set(read.point_data.keys())
    assert read.field_data["kinetic_energy [J]"] == result["kinetic_energy"][3]


def test_a_result_of_one_frame_can_be_read(tmp_path):
    look = seen(1)
    write_paraview(look, result_of(look), tmp_path / "one.pvd")
    reader = pv.get_reader(tmp_path / "one.pvd")
    assert reader.time_values == [0.0] and reader.read()[0].n_points == 11


def test_the_result_stays_as_it_is(tmp_path, cable):
    result, look = cable
    before = hashlib.sha256(result.path.read_bytes()).hexdigest()
    write_paraview(look, result, tmp_path / "span.pvd")
    assert hashlib.sha256(result.path.read_bytes()).hexdigest() == before


def test_progress_is_told_for_every_frame(tmp_path):
    told = []
    write_paraview(seen(), result_of(seen()), tmp_path / "all.pvd", lambda done, total: told.append((done, total)))
    assert told == [(1, 4), (2, 4), (3, 4), (4, 4)]


def test_ctrl_c_leaves_nothing_and_an_earlier_export_whole(tmp_path):
    def stop(done, total):
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_paraview(seen(), result_of(seen()), tmp_path / "all.pvd", stop)
    assert not list(tmp_path.iterdir())
    write_paraview(seen(), result_of(seen()), tmp_path / "all.pvd")
    before = {file: file.read_bytes() for file in tmp_path.rglob("*") if file.is_file()}
    with pytest.raises(KeyboardInterrupt):
        write_paraview(seen(3), result_of(seen(3)), tmp_path / "all.pvd", stop)
    assert {file: file.read_bytes() for file in tmp_path.rglob("*") if file.is_file()} == before


def test_a_full_disk_is_told_and_leaves_nothing(tmp_path, capfd):
    """A limit on the size of files stands in for the disk."""
    look = seen()
    big = Line("long", still(np.random.default_rng(0).normal(size=(5000, 3))), 0.01)
    look = Appearance(look.title, look.time, (*look.lines, big))
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, limit[1]))
    try:
        with pytest.raises(WriteError, match=r"all\.pvd: cannot be written"):
            write_paraview(look, result_of(look), tmp_path / "all.pvd")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
    assert not list(tmp_path.iterdir())
    assert "ERR" not in capfd.readouterr().err


def test_a_shorter_export_takes_the_place_of_a_longer_one_and_leaves_other_files_alone(tmp_path):
    write_paraview(seen(), result_of(seen()), tmp_path / "all.pvd")
    (tmp_path / "all" / "mine.txt").write_text("kept")
    write_paraview(seen(2), result_of(seen(2)), tmp_path / "all.pvd")
    assert pv.get_reader(tmp_path / "all.pvd").time_values == TIME[:2].tolist()
    assert not list((tmp_path / "all").glob("*_0002.vtp")) and (tmp_path / "all" / "mine.txt").read_text() == "kept"


@pytest.mark.parametrize(
    "make, words",
    [
        (lambda folder: (folder / "all.pvd").write_text("<notes/>"), "would be lost"),
        (lambda folder: (folder / "all").write_text("a file"), "is a file"),
        (lambda folder: (folder / "all.pvd").mkdir(), "is a folder"),
    ],
)
def test_what_else_stands_there_is_not_lost(tmp_path, make, words):
    make(tmp_path)
    with pytest.raises(ResultError, match=words):
        write_paraview(seen(), result_of(seen()), tmp_path / "all.pvd")


def test_a_missing_folder_is_told(tmp_path):
    with pytest.raises(ResultError, match="no folder"):
        write_paraview(seen(), result_of(seen()), tmp_path / "none" / "all.pvd")


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="there is no folder that nobody may write to")
def test_a_folder_that_cannot_be_written_to_is_bad_input():
    with pytest.raises(ResultError, match=r"/proc/all\.pvd: cannot be written") as refused:
        write_paraview(seen(), result_of(seen()), "/proc/all.pvd")
    assert not isinstance(refused.value, WriteError)


def test_files_are_compressed_and_binary(tmp_path):
    files = write_paraview(seen(), result_of(seen()), tmp_path / "all.pvd")
    head = files[1].read_bytes()
    assert b'compressor="vtkZLibDataCompressor"' in head and b'<AppendedData encoding="raw">' in head


def test_vtk_is_loaded_by_the_writing_only():
    names = "sys, tautline.view.files.paraview, tautline.cli.commands.export"
    ask = f"import {names}; print(any('vtk' in m for m in sys.modules))"
    done = subprocess.run([sys.executable, "-c", ask], capture_output=True, text=True)
    assert done.stdout.strip() == "False", done.stderr


def test_a_quantity_that_is_the_same_at_every_frame_is_written_for_a_line_that_moves(tmp_path):
    look = seen()
    steady = Quantity("depth", "depth", "m", still(np.arange(7.0)), 0.0, 6.0)
    line = Line("rope", look.lines[0].points, 0.0, (steady,))
    write_paraview(Appearance("", look.time, (line,)), result_of(look), tmp_path / "one.pvd")
    for time in TIME:
        reader = pv.get_reader(tmp_path / "one.pvd")
        reader.set_active_time_value(time)
        np.testing.assert_array_equal(reader.read()[0].point_data["depth [m]"], np.arange(7.0))


@pytest.mark.parametrize("name", ["rope_0000.vtp", "rope_0003.vtp", "sea.vtp"])
def test_a_file_in_the_folder_that_no_earlier_export_wrote_is_not_lost(tmp_path, name):
    (tmp_path / "all").mkdir()
    (tmp_path / "all" / name).write_text("mine")
    with pytest.raises(ResultError, match=rf"{name}: exists and is no frame of all\.pvd: it would be lost"):
        write_paraview(seen(), result_of(seen()), tmp_path / "all.pvd")
    assert [file.name for file in tmp_path.rglob("*")] == ["all", name]
    assert (tmp_path / "all" / name).read_text() == "mine"


def test_two_exports_whose_names_differ_by_the_case_of_the_ending_do_not_share_a_folder(tmp_path):
    write_paraview(seen(2), result_of(seen(2)), tmp_path / "all.pvd")
    before = {file: file.read_bytes() for file in tmp_path.rglob("*") if file.is_file()}
    with pytest.raises(ResultError, match=r"exists and is a frame of all\.pvd: it would be lost"):
        write_paraview(seen(), result_of(seen()), tmp_path / "all.PVD")
    assert {file: file.read_bytes() for file in tmp_path.rglob("*") if file.is_file()} == before
    # Of two that an earlier version has left, neither takes what is the other's.
    (tmp_path / "all.PVD").write_bytes((tmp_path / "all.pvd").read_bytes())
    for name in ("all.pvd", "all.PVD"):
        with pytest.raises(ResultError, match="it would be lost"):
            write_paraview(seen(), result_of(seen()), tmp_path / name)


def test_a_radius_is_told_where_it_is_a_things_own_only(tmp_path):
    look, points = seen(), still(np.arange(6.0).reshape(2, 3))
    lines = (
        Line("hose", points, 0.0), Line("path", points, 0.4, measured=False),
        Line("rope 1", points, 0.01), Line("rope 2", points, 0.0),
    )  # fmt: skip
    write_paraview(Appearance("", look.time, lines), result_of(look), tmp_path / "all.pvd")
    there = blocks(tmp_path / "all.pvd", 0.0)
    for name in ("hose", "path"):
        assert "radius [m]" not in {*there[name].point_data, *there[name].cell_data}
    np.testing.assert_array_equal(there["rope"].point_data["radius [m]"], [0.01, 0.01, np.nan, np.nan])
    np.testing.assert_array_equal(there["rope"].cell_data["radius [m]"], [0.01, np.nan])


def test_what_the_axes_are_is_a_note_of_the_file(tmp_path):
    look = replace(seen(), axes="x is east")
    write_paraview(look, result_of(look), tmp_path / "all.pvd")
    notes = blocks(tmp_path / "all.pvd", 0.0)["rope"].field_data["notes"]
    assert list(notes) == ["offsets are drawn larger", "x is east"] and look.remarks == seen().remarks


def test_an_export_that_failed_while_files_took_their_names_can_be_given_again(tmp_path, monkeypatch):
    write_paraview(seen(), result_of(seen()), tmp_path / "all.pvd")
    replace, named = os.replace, []

    def fail(old, new):
        named.append(new)
        if len(named) == 4:
            raise OSError(5, "Input/output error")
        replace(old, new)

    with monkeypatch.context() as patch, pytest.raises(WriteError):
        patch.setattr("tautline.view.files.paraview.os.replace", fail)
        write_paraview(seen(3), result_of(seen(3)), tmp_path / "all.pvd")
    write_paraview(seen(3), result_of(seen(3)), tmp_path / "all.pvd")
    assert pv.get_reader(tmp_path / "all.pvd").time_values == TIME[:3].tolist()
    assert sorted(one.name for one in tmp_path.iterdir()) == ["all", "all.pvd"]
