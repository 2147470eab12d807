"""What a scene needs before it runs is made once, and again only where what it depends on has changed."""

import os
from pathlib import Path

import numba
import numpy as np
import pytest
from numba_types import in_numba

import tautline
from crane.application import Crane
from crane.assembly import prepared as prepared_crane
from crane.assembly.prepared import motion_of
from crane.scene.scene import CraneScene
from drillstring.application import Drillstring
from drillstring.model import prepared as prepared_string
from drillstring.model.prepared import prepared, well_of
from drillstring.scene.scene import DrillstringScene
from tautline import entry_points
from tautline.application.installed import Installed
from tautline.cli.run import run
from tautline.cli.verbs import make_app
from tautline.kernels import memory
from tautline.kernels.compiling.types.kinds import kind_of
from tautline.kernels.jit import Kernel
from tautline.scene.identity.contents import model_hash

DATA = Path(__file__).parents[3] / "data"
WELL = """
well:
  survey: survey.csv
  diameter: 0.2 m
  wall: {stiffness: 1.0e9, friction: 0.2}
string: [{name: pipe, length: 100, od: 0.127, id: 0.1086}]
material: {youngs_modulus: 200 GPa, shear_modulus: 79 GPa, density: 7850}
model: {elements: 6, bending: none}
solver: {step: 1 ms, end: 20 ms}
output: {interval: 10 ms}
"""
STATIONS = "md [m],inc [deg],azi [deg]\n0,0,0\n60,0,0\n90,6,0\n150,20,0\n"
SEA = """
rope: {mass_per_length: 6.5, axial_stiffness: 8.0e7, diameter: 36 mm}
bodies: [{name: load, mass: 5000, position: [12, 0, 0]}]
path:
  - drum: {name: winch, center: [0, 0, 5], radius: 0.5, axis: [0, 1, 0], wrap: over, pay_out: 0}
  - sheave: {name: tip, center: [11.6, 0, 30], radius: 0.4, axis: [0, 1, 0], wrap: over}
  - end: {name: hook, body: load}
vessel:
  reference: [0, 0, 0]
  motion: {sea: {significant_height: 1, peak_period: 9, seed: 3}, rao: rao.csv}
heave_compensation: {gain: 0.9, delay: 0.1}
solver: {method: generalized-alpha, rho_inf: 0.6, step: 5 ms, end: 0.1 s}
output: {interval: 50 ms}
"""
RESPONSE = "frequency [rad/s],heave [m/m],heave_phase [deg]\n0.2,1,0\n0.6,0.9,0\n1,0.4,10\n3,0,20\n"


@pytest.fixture
def counted(monkeypatch):
    """Counts calls of a function of a module."""

    def count(module, name):
        calls, function = [], getattr(module, name)
        monkeypatch.setattr(module, name, lambda *given, **keys: calls.append(name) or function(*given, **keys))
        return calls

    return count


def simulate(application, folder):
    with pytest.raises(SystemExit) as left:
        files = [str(folder / "scene.yaml"), "-o", str(folder / "scene.nc")]
        run(make_app(application, ["simulate"]), ["simulate", *files, "--quiet"])
    assert left.value.code == 0


def test_simulate_makes_the_hole_once_for_its_warnings_its_run_and_the_run_that_measures_its_error(tmp_path, counted):
    (tmp_path / "scene.yaml").write_text(WELL)
    (tmp_path / "survey.csv").write_text(STATIONS)
    calls = counted(prepared_string, "read_survey")
    simulate(Drillstring(), tmp_path)
    assert calls == ["read_survey"]


def test_simulate_follows_the_frames_of_a_crane_once_and_its_heave_compensation_once(tmp_path, counted):
    (tmp_path / "scene.yaml").write_text(SEA)
    (tmp_path / "rao.csv").write_text(RESPONSE)
    frames, compensation = counted(prepared_crane, "requests_of"), counted(prepared_crane, "compensate")
    simulate(Crane(), tmp_path)
    assert frames == ["requests_of"] and compensation == ["compensate"]


def test_a_copy_with_another_hole_gets_its_own_and_one_with_another_step_does_not(tmp_path):
    scene = DrillstringScene.read(DATA / "jwell.yaml")
    well = well_of(scene)
    stepped = Drillstring().with_overrides(scene, step=1e-4)
    assert well_of(stepped) is well and prepared(stepped) is prepared(scene)
    other = scene.model_copy(update={"well": scene.well.model_copy(update={"sections": scene.well.sections[:1]})})
    assert well_of(other).length < well.length
    assert well_of(scene).length == well.length
    finer = scene.model_copy(update={"model": scene.model.model_copy(update={"elements": 50})})
    assert prepared(finer).lumps.length.size == 50 and prepared(scene).lumps.length.size == scene.model.elements


def test_a_survey_that_is_written_again_is_read_again(tmp_path):
    (tmp_path / "scene.yaml").write_text(WELL)
    (tmp_path / "survey.csv").write_text(STATIONS)
    scene = DrillstringScene.read(tmp_path / "scene.yaml")
    assert well_of(scene).length == 150.0
    (tmp_path / "survey.csv").write_text(STATIONS + "180,20,0\n")
    assert well_of(scene).length == 180.0


def test_another_end_of_the_run_makes_the_motion_of_frames_anew(tmp_path):
    (tmp_path / "scene.yaml").write_text(SEA)
    (tmp_path / "rao.csv").write_text(RESPONSE)
    scene = CraneScene.read(tmp_path / "scene.yaml")
    longer = Crane().with_overrides(scene, end=2.0)
    assert motion_of(longer) is not motion_of(scene)
    assert motion_of(longer).requests[2].end == 2.0 > motion_of(scene).requests[2].end


def test_responses_that_are_written_again_make_another_model(tmp_path):
    (tmp_path / "scene.yaml").write_text(SEA)
    (tmp_path / "rao.csv").write_text(RESPONSE)
    scene = CraneScene.read(tmp_path / "scene.yaml")
    before, moved = model_hash(scene, folder=scene.folder), motion_of(scene)
    (tmp_path / "rao.csv").write_text(RESPONSE.replace("0.6,0.9", "0.6,0.7"))
    os.utime(tmp_path / "rao.csv", ns=(1, 1))
    assert model_hash(scene, folder=scene.folder) != before
    assert motion_of(scene) is not moved


def test_what_was_prepared_does_not_make_scenes_differ():
    scene, same = DrillstringScene.read(DATA / "jwell.yaml"), DrillstringScene.read(DATA / "jwell.yaml")
    before = scene.model_dump(), repr(scene), model_hash(scene)
    prepared(scene)
    assert scene == same
    assert (scene.model_dump(), repr(scene), model_hash(scene)) == before


def test_variants_of_a_string_in_a_loop_make_the_hole_and_the_lumps_once_and_look_for_applications_once(
    counted, monkeypatch
):
    scene = tautline.read(DATA / "jwell.yaml")
    tautline.simulate(scene, end="50 ms")
    well, lumps = counted(prepared_string, "_drilled"), counted(prepared_string, "cut")
    points = counted(entry_points, "in_group")
    for factor in (0.10, 0.15, 0.20):
        variant = scene.replace({"well.wall.friction.kinetic": factor})
        result = tautline.simulate(variant, end="50 ms")
        assert tautline.read(result.attributes["scene"]).well.wall.friction.kinetic == factor
    assert (well, lumps, points) == ([], [], [])


def test_variants_of_a_string_in_a_loop_ask_numba_for_no_type_and_compile_and_load_nothing(counted):
    scene = tautline.read(DATA / "jwell.yaml")
    tautline.simulate(scene.replace({"well.wall.friction.kinetic": 0.1}), end="50 ms")
    types, loaded, made = counted(numba, "typeof"), counted(Kernel, "_loaded"), counted(Kernel, "_made")
    for factor in (0.12, 0.15, 0.20):
        tautline.simulate(scene.replace({"well.wall.friction.kinetic": factor}), end="50 ms")
    assert (types, loaded, made) == ([], [], [])


@pytest.mark.parametrize("name", ["jwell", "whirl", "hoist", "hose", "reeled_span"])
def test_the_types_that_follow_from_forms_are_those_that_numba_finds(name):
    scene = tautline.read(DATA / f"{name}.yaml")
    system = Installed().of(scene).build(scene).system
    things = [*system.groups, system.dofs, system.functions, 3, 2**62, True, 1.5, np.float64(1), np.int64(2), None]
    things += [np.zeros((2, 3))[:, ::2], np.zeros((2, 3), order="F"), np.zeros(3, np.int32), np.zeros(0)]
    still = np.zeros(3)
    still.flags.writeable = False
    for thing in [*things, still, 2**63, (1, 2.0), (), np.zeros(3)]:
        assert in_numba(kind_of(memory.form_of(thing))) == numba.typeof(thing)


def test_groups_are_laid_out_with_the_words_and_the_form_that_each_has_alone_and_where_numpy_says_they_are():
    scene = tautline.read(DATA / "hoist.yaml")
    system = Installed().of(scene).build(scene).system
    still = np.arange(3.0)
    still.flags.writeable = False
    things = [*system.groups, (still, np.zeros((0, 4)), np.zeros(2, np.int32), 3, 1.5, np.float64(2.5), np.int64(4))]
    known = {}
    for thing in things:
        assert memory.laid(thing, known) == (memory.words_of(thing), memory.form_of(thing))
    for array in (still, np.zeros((2, 3)), np.zeros(0), system.groups[0].rows):
        assert memory.words_of(array)[4] == array.ctypes.data
