"""A search or a study that takes long says so, without a terminal too, and one that is quick says nothing."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from time import sleep

import pytest

from tautline.cli.commands.study import working
from tautline.cli.output import preparing
from tautline.cli.run import searched


@pytest.fixture
def impatient(monkeypatch):
    monkeypatch.setattr(preparing, "PATIENCE", 0.05)


def test_a_search_that_takes_long_is_told_and_again_as_time_passes(impatient, capsys):
    assert searched(Path("hose.yaml"), False, lambda: sleep(0.5) or 7) == 7
    told = capsys.readouterr().err
    assert told.count("searching hose.yaml: Ctrl-C ends it") == 2, "at 0.05 and 0.2 s, and not yet at 0.8 s"


def test_a_study_without_a_terminal_tells_what_it_runs_by_then(impatient, capsys):
    with working() as progress:
        progress("rk4, step 1 ms")
        sleep(0.15)
    assert "running: rk4, step 1 ms. Ctrl-C ends it" in capsys.readouterr().err


def test_a_quick_search_says_nothing_and_leaves_no_thread_that_would(capsys):
    from threading import active_count

    before = active_count()
    assert searched(Path("hose.yaml"), False, lambda: 7) == 7
    with working() as progress:
        progress("rk4")
    assert capsys.readouterr().err == "" and active_count() == before


def test_bad_options_of_a_study_are_refused_before_the_scene_is_prepared(monkeypatch):
    from tautline.cli.commands import study
    from tautline.scene.errors import SceneError

    monkeypatch.setattr(study, "prepared", lambda *_: pytest.fail("the scene is prepared first"))
    given = dict.fromkeys(one.name for one in fields(study.StudyOptions)) | {
        "tolerance": "1 %",
        "reference_step": "inf",
    }
    with pytest.raises(SceneError, match="--reference-step inf: is not a finite number"):
        study.study(None, Path("some.yaml"), None, study.StudyOptions(**given), False)
