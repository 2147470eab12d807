"""What a study looks at in a hose: what moves, by which its step and its mesh are told apart."""

from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest
from physics.pipes.hoses import scene

from gardenhose.application import Gardenhose
from gardenhose.scene import HoseScene
from tautline.scene.model import validate
from tautline.scene.reading.document import Document
from tautline.study.accuracy.precision import Grid, study
from tautline.study.robustness.stability import stability
from tautline.study.trials.errors import compare
from tautline.study.trials.history import watch
from tautline.study.trials.trial import Setting, Subject


def held(**more):
    """The template of a tube held at both ends, that sags and rings under its weight."""
    text = (files("gardenhose") / "templates" / "supported.yaml").read_text(encoding="utf8")
    return Subject(Gardenhose(), validate(HoseScene, Document.parse(text, "supported.yaml")), end=0.05, **more)


def test_a_tip_that_is_held_gives_way_to_the_node_that_moves_most():
    free, fixed = (
        watch(subject.run(Setting()).result) for subject in (Subject(Gardenhose(), scene(), end=0.02), held())
    )
    assert (str(free.point), free.moves) == ("tip", True)
    assert fixed.point.variable == "position" and 0 < fixed.point.number < fixed.point.count - 1 and fixed.moves


def test_a_tube_that_is_held_at_both_ends_is_judged_by_what_moves_and_a_long_step_is_wrong():
    found = study(held(), Grid(["generalized-alpha"], [4e-3, 5e-4]), repetitions=1)
    errors = {row.trial.setting.step: row.errors.position for row in found.rows}
    assert errors[4e-3] > 0.1 > errors[5e-4] > 1e-4


def test_where_nothing_moves_it_is_said_that_no_error_can_be_seen(monkeypatch):
    # It is of the run as it stands; that of each variant is another test's.
    monkeypatch.setattr("tautline.study.robustness.stability.variants", lambda *_: [])
    still = Subject(Gardenhose(), scene({"elements": 4}, gravity=[0, 0, 0], water=False), end=0.01)
    for told in (study(still, Grid(["generalized-alpha"], [1e-3]), repetitions=1), stability(still, quick=True)):
        assert any("tip does not move: no error can be seen" in warning for warning in told.warnings)


def test_the_error_of_a_mesh_is_that_of_the_mesh_and_not_of_the_steps_it_was_run_with():
    """Beside runs of one small step with four times and with sixteen times the elements of the scene."""
    subject = Subject(Gardenhose(), scene({"elements": 5}, solver={"tolerance": 1e-7}), end=0.1)
    found = study(subject, Grid(["generalized-alpha"], [2.5e-3, 1.25e-3], [1.0, 2.0]), repetitions=1)
    step = found.reference.step
    four, many = (subject.run(Setting("generalized-alpha", step, elements=n)) for n in (4.0, 16.0))
    true = compare(found.watched.of(four.result), found.watched.of(many.result), found.watched.extent).position
    assert found.reference.mesh_error == pytest.approx(true, rel=0.5)
    assert found.reference.mesh_error < 0.2 * min(row.errors.position for row in found.rows)


def test_a_force_that_differs_between_the_finest_runs_is_not_called_proved(monkeypatch):
    from tautline.study.accuracy import precision

    proved = study(Subject(Gardenhose(), scene(), end=0.05), Grid(["generalized-alpha"], [1e-3]), repetitions=1)
    assert proved.reference.force_error is not None and not any("only position" in w for w in proved.warnings)
    doubted = replace(proved.reference, force_error=0.5)
    told = precision._warnings(doubted, None, proved.rows, 0.01, proved.watched)
    assert any("only position is proved" in warning and "50 %" in warning for warning in told)


@pytest.mark.parametrize("order", [0.5, 1.0, 2.0, 4.0])
@pytest.mark.parametrize("ratio", [2.0, 1.5])
def test_the_order_of_a_mesh_is_that_by_which_differences_from_twice_the_finest_grow(order, ratio):
    """Errors n^-p of n, n/r and 2n elements: their differences tell p."""
    from tautline.study.accuracy.precision import MESH_ORDERS, _growth

    n = 8.0
    fine, coarse, reference = n**-order, (n / ratio) ** -order, (2.0 * n) ** -order
    found = (coarse - reference) / (fine - reference)
    assert _growth(ratio, order) == pytest.approx(found) and (np.diff(_growth(ratio, MESH_ORDERS)) > 0.0).all()
