"""What an earlier version wrote is read: a scene runs or is refused with what to write now; a result is read and drawn.

The files in folders named after versions are never edited. Docs/versions.md is the policy.
"""

import gzip
from pathlib import Path

import pytest

import tautline
from tautline.application.installed import Installed

HERE = Path(__file__).parent
SCENES = sorted(HERE.glob("*/*.yaml"))
RESULTS = sorted(HERE.glob("*/*.nc.gz"))
RENAMED: dict[str, str] = {}
"""Keys of earlier versions that are no more, and what is written instead: a refusal has to say so."""


@pytest.mark.parametrize("path", SCENES, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_a_scene_of_an_earlier_version_can_be_run_or_is_refused_with_what_to_write_now(path):
    try:
        application, scene = Installed().read(path)
    except tautline.SceneError as error:
        for problem in error.problems:
            assert problem.key and problem.cause and problem.cure, str(problem)
            last = problem.key.rsplit(".", 1)[-1]
            assert RENAMED[last] in problem.cure, f"{last}: the cure must name {RENAMED[last]}"
        return
    model = application.build(scene)
    assert model.solver.end > 0.0


@pytest.mark.parametrize("name", ["0.1/crane_lift", "0.1/cable_bar", "0.2/crane_lift"])
def test_a_scene_of_an_earlier_version_runs(name):
    result = tautline.simulate(HERE / f"{name}.yaml", end="0.1 s")
    assert result.attributes["status"] == "done" and result["time"][-1] == pytest.approx(0.1)


@pytest.mark.parametrize("path", RESULTS, ids=lambda path: f"{path.parent.name}/{path.name.removesuffix('.nc.gz')}")
def test_a_result_of_an_earlier_version_is_read_and_drawn(path, tmp_path):
    from tautline.results.result import Result

    unpacked = tmp_path / "result.nc"
    unpacked.write_bytes(gzip.decompress(path.read_bytes()))
    result = Result.read(unpacked)
    assert result.attributes["version"].startswith(path.parent.name)
    assert result["tension"].shape == (len(result["time"]), 2, 2)
    # 2 t hang on the hook, from the start that is at rest.
    assert result["tension"][0, 1, 1] == pytest.approx(2000.0 * 9.81, rel=1e-3)
    assert tautline.read(result.attributes["scene"]).bodies[0].mass == 2000.0
    assert len(result.plot("tension").axes) >= 1


def test_there_are_scenes_of_every_application_and_a_result_of_each_version():
    begins = {path.stem.split("_")[0] for path in SCENES if path.parent.name == "0.1"}
    assert {"cable", "crane", "drillstring", "gardenhose"} <= begins
    assert {path.parent.name for path in RESULTS} == {path.parent.name for path in SCENES} == {"0.1", "0.2"}
