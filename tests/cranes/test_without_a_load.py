"""Ropes that hold no body: between anchors, from drum to drum, over a sheave. Verbs work, and the physics holds."""

import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from cli.in_process import leave_out_pixels
from of_the_suite import studies
from physics.lifting.crane_scenes import GRAVITY, anchor, crane, drum, hoist, ran, sheave
from references import cables

from crane.application import Crane
from crane.assembly.estimates import estimate
from crane.scene.scene import CraneScene
from tautline.cli.run import run
from tautline.cli.verbs import make_app

MASS, STIFFNESS = 5.0, 6.0e7
ROPE = {"mass_per_length": MASS, "axial_stiffness": STIFFNESS}
LEFT, RIGHT = drum((0.0, 0.0, 10.0), name="left"), drum((40.0, 0.0, 10.0), name="right")
TOP = sheave((20.0, 0.0, 20.0), name="top")
SPEED = 0.5
OUT = {"ramp": {"to": SPEED, "over": 1.0}}
BACK = {"ramp": {"to": -SPEED, "over": 1.0}}


def span(length, rise=0.0, elements=60, **more):
    """Rope of a length, m, between anchors that are 100 m apart."""
    path = [anchor((0.0, 0.0, 50.0), "one"), anchor((100.0, 0.0, 50.0 + rise), "two")]
    return crane(path, rope=ROPE | {"length": length}, mesh={"elements_per_span": elements}, **more)


SCENES = {
    "drum to drum": crane([LEFT, RIGHT], rope=ROPE),
    "drum, sheave, drum": crane([LEFT, TOP, RIGHT], rope=ROPE),
    "anchor to anchor": span(105.0, elements=12),
    "anchor, sheave, drum": crane([anchor((0.0, 0.0, 10.0), "one"), TOP, RIGHT], rope=ROPE),
}


@pytest.mark.parametrize(
    ("name", "pixels"),
    [
        ("drum, sheave, drum", False),
        ("anchor to anchor", False),
        *studies(("drum to drum", False), ("anchor, sheave, drum", False), ("anchor to anchor", True)),
    ],
)
def test_a_scene_without_a_body_runs_and_is_drawn(name, pixels, tmp_path, capsys, monkeypatch):
    # Figures are made in either case, but the files of those that are not drawn to their pixels are empty.
    if not pixels:
        leave_out_pixels(monkeypatch)
    file = tmp_path / "scene.yaml"
    file.write_text(yaml.safe_dump(json.loads(json.dumps(SCENES[name] | {"title": name}))))
    app = make_app(Crane())

    def told(*words):
        with pytest.raises(SystemExit) as ended:
            run(app, [str(word) for word in words])
        said = capsys.readouterr()
        assert ended.value.code == 0, said
        return said.out

    told("check", file, "--figure", tmp_path / "scene.png")
    found = told("simulate", file, "-o", tmp_path / "scene.nc", "--json")
    assert "NaN" not in found and "Infinity" not in found
    assert json.loads(found) and '"rise"' not in found and "max_displacement" not in found
    told("plot", tmp_path / "scene.nc", "-o", tmp_path / "figures")
    assert len(list((tmp_path / "figures").glob("*.png"))) >= 5
    told("export", tmp_path / "scene.nc", "--csv", "-o", tmp_path / "tables")
    for table in Path(tmp_path).rglob("*.csv"):
        assert "nan" not in table.read_text().lower()


@pytest.mark.parametrize(
    ("length", "rise"),
    [
        (None, 0.0),
        (100.05, 30.0),
        (105.0, 0.0),
        (130.0, 30.0),
        *studies((None, 30.0), (100.05, 0.0), (105.0, 30.0), (130.0, 0.0)),
    ],
)
def test_a_rope_between_anchors_is_the_elastic_catenary(length, rise):
    """Tension at both ends within 1e-4 of the closed form, from taut to slack; the sag too.

    Straight pieces are of order two: what two meshes give, carried on to none, is compared.
    """
    straight = float(np.hypot(100.0, rise))
    length = straight * (1.0 if length is None else length / 100.0)
    exact = cables.catenary(100.0, rise, length, STIFFNESS, MASS * GRAVITY, "green")
    wanted = np.linalg.norm(exact.end_forces, axis=1)
    tension, sag = [], []
    for elements in (40, 80):
        result = ran(span(length, rise, elements, solver={"end": 0.02}))
        assert np.ptp(result["position"], axis=0).max() < 1.0e-6
        tension.append(result["tension"][0, 0])
        sag.append(result["position"][0, elements // 2, 2] - 50.0)
    carried_on = [(4.0 * fine - coarse) / 3.0 for coarse, fine in (tension, sag)]
    assert carried_on[0] == pytest.approx(wanted, rel=1.0e-4)
    assert carried_on[1] == pytest.approx(exact.shape(0.5 * length)[1], rel=1.0e-4, abs=1.0e-4 * 100.0)
    assert tension[1] == pytest.approx(wanted, rel=2.0e-3)


def test_what_is_told_of_a_rope_before_a_run_is_near_what_it_has_at_rest():
    for length in (100.0, 101.0, 105.0):
        scene = span(length)
        exact = cables.catenary(100.0, 0.0, length, STIFFNESS, MASS * GRAVITY)
        told = estimate(CraneScene.model_validate(scene)).tension[0]
        assert told == pytest.approx(np.linalg.norm(exact.end_forces, axis=1), rel=0.02)


@pytest.mark.parametrize("path", [["left", "right"], ["left", "top", "right"]], ids="-".join)
def test_a_rope_is_reeled_over_from_drum_to_drum_without_loss(path):
    """What leaves one drum comes to the other, at the tension that the length between them makes."""
    items = {
        "left": drum((0.0, 0.0, 10.0), name="left", pay_out=OUT), "top": TOP,
        "right": drum((40.0, 0.0, 10.0), name="right", pay_out=BACK),
    }  # fmt: skip
    made = crane([items[name] for name in path], rope=ROPE | {"damping": 1.0e-3}, solver={"end": 4.0})
    result = ran(made | {"mesh": {"elements_per_span": 8}})
    moved = SPEED * (4.0 - 0.5)
    assert result["paid_out"][-1] == pytest.approx([moved, -moved], rel=1.0e-9)
    between = result["material_coordinate"][:, -1] - result["material_coordinate"][:, 0]
    assert np.ptp(between) < 1.0e-9
    assert result["tension"].max(axis=(1, 2)) == pytest.approx(result["tension"][0].max(), rel=0.02)


def test_a_winch_that_holds_its_tension_holds_it_on_a_rope_without_a_load():
    """The other drum reels over; the tension at the winch stays what it is told, by its inertia to 1 %."""
    held = 2.0e4
    winch = drum((40.0, 0.0, 10.0), name="right", tension=held, inertia=50.0, gains={"proportional": 5.0})
    slow = drum((0.0, 0.0, 10.0), name="left", pay_out={"ramp": {"to": 0.3, "over": 2.0}})
    result = ran(crane([slow, winch], rope=ROPE | {"damping": 1.0e-3}, solver={"end": 4.0}))
    assert result["drum_tension"][-1, 1] == pytest.approx(held, rel=0.01)
    assert result["paid_out"][-1].sum() == pytest.approx(0.0, abs=0.01)


def test_a_hook_without_mass_rests_where_it_is_drawn_and_its_rope_carries_its_own_weight():
    """25 m of rope hang below the sheave, and its drum stands 10 m below it: 15 m more on the side of the hook."""
    drive = {"center": (0.0, 0.0, 20.0), "pay_out": 0.0}
    result = ran(hoist(mass=0.0, elements=16, drive=drive, solver={"end": 0.1}))
    assert result["body_position"][0, 0, 2] == pytest.approx(5.0, abs=1e-4)
    # Two points of a rope at rest differ in tension by its weight over their difference of height. The rope touches
    # the drum and the sheave within their radii of these heights.
    assert result["drum_tension"][0].item() == pytest.approx(6.5 * GRAVITY * 15.0, rel=0.03)
