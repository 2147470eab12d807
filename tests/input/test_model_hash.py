"""What a scene is: everything that it says counts, but what is named as how it is solved, kept or shown."""

import re
from pathlib import Path

import h5py
import numpy as np
import pytest

from tautline.application.installed import Installed
from tautline.cable.input.parts import BESIDES_MODEL, CableScene
from tautline.cable.input.scene import with_values
from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.scene.errors import SceneError
from tautline.scene.identity.contents import model_hash
from tautline.scene.model import validate
from tautline.simulation import simulate
from tautline.version import __version__

DATA = Path(__file__).parents[2] / "data"
BESIDES = {"title", "units", "output", "Plots"}
SCENES = (
    "jwell", "drilling", "whirl", "iscwsa", "hoist", "slewing", "landing", "hose", "cantilever_bar", "reeled_span",
)  # fmt: skip


def leaves(value, path=()):
    if isinstance(value, dict):
        for key, each in value.items():
            yield from leaves(each, (*path, key))
    elif isinstance(value, list):
        for i, each in enumerate(value):
            yield from leaves(each, (*path, i))
    else:
        yield path, value


def other(value):
    """Another value of the kind; words of a scene are left to the reader."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return value + 1
    if isinstance(value, float):
        return value * 1.0009765625 if value else 0.0009765625
    number, _, unit = str(value).partition(" ")
    try:
        return f"{other(float(number))!r} {unit}"
    except ValueError:
        return None


def hash_of(scene):
    model = Installed().of(scene).build(scene)
    return model.attributes["model_hash"]


def quick_hash(scene):
    """Of the scene alone, as the builders take it."""
    return model_hash(scene, BESIDES_MODEL) if isinstance(scene, CableScene) else model_hash(scene, folder=scene.folder)


def said(scene):
    """What a scene holds, as text; a cable's without its solver, which is looked at by itself."""
    return repr(scene) if isinstance(scene, CableScene) else repr(scene.model_dump())


def changed(scene, path, value):
    values = {path: (value, "a test")}
    if isinstance(scene, CableScene):
        return with_values(scene, values)
    return validate(type(scene), scene.document.replaced(values))


@pytest.mark.parametrize("name", SCENES)
def test_every_number_of_a_scene_counts_but_how_it_is_solved_and_what_is_kept(name):
    scene = Installed().for_scene(DATA / f"{name}.yaml").read(DATA / f"{name}.yaml")
    own, looked = quick_hash(scene), 0
    assert own == hash_of(scene)
    for path, value in leaves(scene.document.root):
        new = other(value)
        if new is None or path[0] in BESIDES:
            continue
        try:
            found = changed(scene, path, new)
        except SceneError:
            continue
        looked += 1
        solved_by = path[0] in ("solver", "GeneralizedAlpha") and path[-1] not in ("massDamp", "start")
        # A direction of another length, or an id that nothing else names, may be the same scene.
        if not solved_by and said(found) != said(scene):
            assert quick_hash(found) != own, path
        if solved_by:
            assert quick_hash(found) == own, path
    assert looked > 10


def test_a_comment_that_moves_every_line_leaves_a_cable_what_it_is():
    path = DATA / "reeled_span.yaml"
    scene = Installed().for_scene(path).read(path)
    from tautline.cable.input.scene import parse

    assert quick_hash(parse("# a comment\n# another\n" + path.read_text(encoding="utf8"))) == quick_hash(scene)


def test_the_contents_of_a_file_count_and_not_its_name(tmp_path):
    text = (DATA / "iscwsa.yaml").read_text(encoding="utf8")
    survey = (DATA / "iscwsa_reference.csv").read_text(encoding="utf8")

    def scene(folder, name, rows):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / name).write_text(rows, encoding="utf8")
        path = tmp_path / folder / "well.yaml"
        path.write_text(text.replace("iscwsa_reference.csv", name), encoding="utf8")
        return Installed().for_scene(path).read(path)

    assert "iscwsa_reference.csv" in text
    one, same = scene("a", "one.csv", survey), scene("b", "other.csv", survey)
    lines = survey.splitlines()
    less = scene("c", "one.csv", "\n".join(lines[:-1]) + "\n")
    assert quick_hash(one) == quick_hash(same) != quick_hash(less)


def test_what_cannot_be_told_is_refused_and_not_passed_over():
    with pytest.raises(TypeError, match=r"a\.b: what a object holds cannot be told"):
        model_hash({"a": {"b": object()}})
    assert model_hash({"a": np.zeros(2)}) != model_hash({"a": np.zeros(3)})


def test_a_run_is_not_gone_on_with_in_a_scene_of_a_hundred_times_the_drag():
    scene = Installed().for_scene(DATA / "whirl.yaml").read(DATA / "whirl.yaml")
    assert scene.mud is not None
    short = changed(scene, ("solver", "end"), 0.02)
    short = changed(short, ("output", "interval"), 0.01)
    result = simulate(Installed().of(short).build(short))
    longer = changed(short, ("solver", "end"), 0.04)
    assert simulate(Installed().of(longer).build(longer), resume=result).time[-1] == pytest.approx(0.04)
    thick = changed(longer, ("mud", "drag"), 100.0 * longer.mud.drag)
    with pytest.raises(ResultError, match="belongs to another scene"):
        simulate(Installed().of(thick).build(thick), resume=result)


@pytest.mark.parametrize("version", [None, "0.0.7"])
def test_a_state_of_another_build_is_refused_in_plain_words_also_where_its_version_is_the_same(tmp_path, version):
    scene = Installed().for_scene(DATA / "hoist.yaml").read(DATA / "hoist.yaml")
    short = changed(changed(scene, ("solver", "end"), 0.1), ("output", "interval"), 0.05)
    path = tmp_path / "hoist.nc"
    simulate(Installed().of(short).build(short), path)
    with h5py.File(path, "a") as file:
        del file["restart/method.last_step"]
        if version:
            file.attrs["version"] = version
    longer = changed(short, ("solver", "end"), 0.2)
    by = f"Tautline {version} wrote" if version else f"another build of Tautline {__version__} wrote"
    with pytest.raises(ResultError, match=f"cannot be gone on with: {re.escape(by)} it") as refused:
        simulate(Installed().of(longer).build(longer), resume=Result(path))
    text = f"{refused.value}"
    assert "last_step" not in text and text.count("Tautline") == 1
    assert "run the scene from its start" in refused.value.cure


def test_frames_of_another_build_that_lack_a_variable_are_refused_with_cause_and_cure(tmp_path):
    scene = Installed().for_scene(DATA / "cantilever_bar.yaml").read(DATA / "cantilever_bar.yaml")
    short, longer = (changed(scene, ("GeneralizedAlpha", "time_end"), end) for end in (0.1, 0.2))
    path = tmp_path / "bar.nc"
    simulate(Installed().of(short).build(short), path)
    with h5py.File(path, "a") as file:
        del file["end_force"]
    with pytest.raises(ResultError, match=r"another build of Tautline .* wrote it, and stored no end_force") as refused:
        simulate(Installed().of(longer).build(longer), resume=Result(path))
    assert "run the scene from its start" in refused.value.cure
