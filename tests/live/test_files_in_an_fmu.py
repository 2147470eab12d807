"""What is in an FMU: the scene and its records whatever their names, and a library, or no FMU is written."""

import zipfile
from pathlib import Path

import pytest
from of_the_suite import studies

import tautline
from tautline.live.errors import SimulationError
from tautline.live.fmu.unit import Core
from tautline.live.fmu.writing import write_fmu
from tautline.results.errors import ResultError

pytest.importorskip("pythonfmu", reason="PythonFMU is not installed")

DATA = Path(__file__).parents[2] / "data"
HEAVE = 0.25
"""Heave of the ship in the record, m."""


def with_record(name, folder):
    """The hoist, whose ship goes by a record of a name: it lies still, higher than drawn."""
    record = folder / name
    record.parent.mkdir(parents=True, exist_ok=True)
    rows = (f"{0.1 * k:.1f},0,0,{HEAVE},0,0,0" for k in range(200))
    record.write_text("\n".join(["t,surge,sway,heave,roll [deg],pitch [deg],yaw [deg]", *rows, ""]))
    changed = tautline.read(DATA / "hoist.yaml").replace({"vessel.motion": {"file": name}, "path[0].drum.pay_out": 0})
    return tautline.read(changed.document.told, folder=folder)


@pytest.mark.parametrize(
    ("name", "fmi"),
    [
        ("documentation/m.csv", 2), ("scene.yaml", 2), ("pythonfmu/a.csv", 2), ("Scene.yaml/unit.json", 3),
        *studies(("made/x.csv", 2), ("unit.json", 2), ("scene/scene.yaml", 2), ("resources/a.csv", 2),
                 ("binaries/a.csv", 2), ("json.py", 2), ("pythonfmu3/a.csv", 3), ("unit.json", 3)),
    ],
)  # fmt: skip
def test_a_record_may_have_any_name_that_the_fmu_uses_itself(name, fmi, tmp_path):
    pytest.importorskip(f"pythonfmu{'3' if fmi == 3 else ''}", reason="PythonFMU is not installed")
    scene = with_record(name, tmp_path)
    write_fmu(scene, tmp_path / "recorded.fmu", ["vessel.heave"], ["winch.tension"], fmi=fmi)
    with zipfile.ZipFile(tmp_path / "recorded.fmu") as file:
        file.extractall(tmp_path / "unpacked")
    core = Core(tmp_path / "unpacked" / "resources")
    assert core.get("vessel.heave") == pytest.approx(HEAVE)


def test_a_record_in_a_folder_that_pythonfmu_leaves_out_is_refused_by_name(tmp_path):
    scene = with_record("__pycache__/m.csv", tmp_path)
    with pytest.raises(SimulationError, match=r"__pycache__/m\.csv.*give the folder another name"):
        write_fmu(scene, tmp_path / "lost.fmu", [], ["winch.tension"])
    assert not (tmp_path / "lost.fmu").exists()


def test_an_fmu_without_a_library_is_refused_and_an_earlier_one_stays(tmp_path, monkeypatch):
    path = tmp_path / "hoist.fmu"
    write_fmu(DATA / "hoist.yaml", path, [], ["winch.tension"])
    before = path.read_bytes()
    monkeypatch.setattr("tautline.live.fmu.writing._has_libraries", lambda folder: False)
    monkeypatch.setattr("pythonfmu.builder.HERE", tmp_path)
    with pytest.raises(ResultError, match=r"pythonfmu gave it no library.*pip install"):
        write_fmu(DATA / "hoist.yaml", path, [], ["winch.tension"])
    assert path.read_bytes() == before
