"""What is installed does not change while a process goes on, and is not read again for every scene."""

import importlib.metadata

from tautline import entry_points
from tautline.application.installed import Installed


def test_whose_an_application_is_and_which_there_are_is_read_once_in_a_process(monkeypatch):
    names = [application.name for application in Installed().all()]
    asked = []
    monkeypatch.setattr(importlib.metadata.Distribution, "metadata", property(lambda dist: asked.append(dist)))
    monkeypatch.setattr(importlib.metadata.EntryPoint, "matches", lambda point, **_: asked.append(point))
    assert [application.name for application in Installed().all()] == names
    assert {"drillstring", "crane", "gardenhose", "cable"} <= set(names) and asked == []


def test_an_application_in_a_folder_that_is_looked_in_later_is_found(tmp_path, monkeypatch):
    assert "tripod" not in {point.name for point in entry_points.in_group("tautline.applications")}
    about = tmp_path / "tripod-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: tripod\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text("[tautline.applications]\ntripod = tripod:Tripod\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    (found,) = (point for point in entry_points.in_group("tautline.applications") if point.name == "tripod")
    assert not entry_points.is_of_ours(found)
