"""Tripping: the block moves metres, and the string changes its place in the well.

The scene is data/tripping.yaml: a stand of 28 m is pulled out of a well with a build and, at the bottom, a dogleg
through which the BHA passes. Hook loads are means over two periods of the string's first axial mode (2.36 s), in which
it bounces after the start. They are compared with the statics of the same lumps at the same place, part of the string
standing above the table, and with tests/references/soft_string.py, to which the stand's weight is added. Measured:
+1.5e-3 to +3.7e-3 out and -3.0e-3 to -3e-5 in, of which viscous damping is 1.3e-3, and up to 6e-3 against the soft
string, which has no bending.
"""

import numpy as np
import pytest
from of_the_suite import studies
from physics.wells.strings import DATA, run, shipped, straight_hole
from references import soft_string as reference

from drillstring.model.build import build
from drillstring.model.prepared import well_of
from drillstring.scene.scene import DrillstringScene
from drillstring.statics.statics import Statics
from drillstring.warnings import warnings
from tautline.scene.errors import SceneError
from tautline.simulation import simulate

SCENE = DrillstringScene.read(DATA / "tripping.yaml")
WELL = well_of(SCENE)
LENGTH, LINKS, FRICTION, PERIOD = WELL.length, 100, 0.25, 2.36
DEG = np.pi / 180.0
IN = {"sum": [{"constant": -28.9}, {"ramp": {"rate": 0.75, "at": 1.0, "over": 4.0}}]}
IN["sum"].append({"ramp": {"rate": -0.75, "at": 38.3333333, "over": 4.0}})
RUNS = {"pick_up": {}, "slack_off": {"top__block": IN}}


@pytest.fixture(scope="module")
def trips():
    """Runs by direction."""
    return {way: run(shipped("tripping", **changes), energy=1e-5) for way, changes in RUNS.items()}


def steady(result, begin):
    """Mean bit depth and hook load over two periods from a time on."""
    near = (result.time >= begin) & (result.time < begin + 2.0 * PERIOD - 1e-9)
    return float(result["bit_depth"][near].mean()), float(result["hook_load"][near].mean())


class Standard(reference.String):
    """Standard tubulars: weights in mud from their published masses, steel of 7850 kg/m^3."""

    masses: dict

    def weight(self, od, bore):
        return self.masses[od] * (1.0 - 1250.0 / 7850.0) * 9.81


def soft_hook_load(depth, way):
    """Of the part of the string in the hole, plus the pipe above the table; lb/ft of the published tables."""
    pound, foot, inch = 0.45359237, 0.3048, 0.0254
    collar = 7850.0 * np.pi / 4.0 * ((6.5 * inch) ** 2 - (2.8125 * inch) ** 2)
    string = Standard([(depth - 225.0, 6.625 * inch, 0.1), (150.0, 6.25 * inch, 0.08), (75.0, 6.5 * inch, 0.07)])
    string.masses = {6.625 * inch: 22.60 * pound / foot, 6.25 * inch: 49.3 * pound / foot, 6.5 * inch: collar}
    turn = 30.0 / (5.0 * DEG) * np.sin(50.0 * DEG) * 25.0 * DEG
    ends = np.cumsum([600.0, 500.0, 900.0, turn, 40.0])

    def inclination(s):
        return 50.0 * DEG * np.clip((s - 600.0) / 500.0, 0.0, 1.0)

    def azimuth(s):
        return (30.0 + 25.0 * np.clip((s - 2000.0) / turn, 0.0, 1.0)) * DEG

    assert ends[-1] == pytest.approx(LENGTH, abs=1e-6)
    well = reference.well_from_angles(inclination, azimuth, depth, tuple(b for b in ends[:-1] if b < depth))
    above = (LENGTH - depth) * string.weight(6.625 * inch, 0.1)
    return reference.hook_load(well, string, FRICTION, way) + above


@pytest.mark.parametrize("begin", [8.0, *studies(22.0), 33.0])
@pytest.mark.parametrize("way", RUNS)
def test_hook_load_of_a_steady_trip_is_that_of_the_statics_at_that_depth_within_half_a_percent(trips, way, begin):
    depth, load = steady(trips[way], begin)
    statics = Statics(SCENE, depth, LINKS, above=LENGTH - depth)
    profile = statics.solve(FRICTION, way)
    assert load == pytest.approx(profile.hook_load, rel=5e-3)
    assert profile.measured_depth[0] < -1.0 and profile.measured_depth[-1] == pytest.approx(depth, abs=1e-6)


@pytest.mark.parametrize("way", RUNS)
def test_hook_load_of_a_steady_trip_is_the_soft_strings_within_one_percent(trips, way):
    depth, load = steady(trips[way], 29.0)
    assert load == pytest.approx(soft_hook_load(depth, way), rel=1e-2)


@pytest.mark.parametrize("way", RUNS)
def test_string_at_rest_before_the_trip_hangs_in_its_frictionless_hook_load(trips, way):
    result = trips[way]
    depth = float(result["bit_depth"][0])
    # pulled up by its stretch, the bit hangs where its length says; at the start of the way out it is 0.88 m below
    statics = Statics(SCENE, min(depth, LENGTH), LINKS, above=LENGTH - min(depth, LENGTH))
    assert result["hook_load"][0] == pytest.approx(statics.solve(0.0, way).hook_load, rel=1e-3)


def test_pulled_out_and_at_rest_the_string_keeps_its_drag_until_it_is_lowered(trips):
    result = trips["pick_up"]
    load = result["hook_load"]
    rest, end = load[(result.time > 46.0) & (result.time < 49.0)], load[-1]
    assert np.ptp(rest) < 1.0 and rest.mean() > 0.97 * load[(result.time > 25.0) & (result.time < 38.0)].mean()
    # 0.3 m down is less than the stroke after the other way: the hook loses load, and the bit does not move
    assert end < 0.75 * rest.mean()
    assert np.ptp(result["bit_depth"][result.time > 46.0]) < 1e-6
    assert result["block_position"][-1] == pytest.approx(-27.7, abs=1e-3)


def test_lumps_change_their_place_in_the_well_and_the_side_that_they_lie_on(trips):
    result = trips["pick_up"]
    before, after = 0, int(np.searchsorted(result.time, 40.0))
    md = result["measured_depth"][[before, after]]
    assert md[0] - md[1] == pytest.approx(np.full(md.shape[1], 27.5), abs=0.3)
    m1, m2, _ = WELL.frame(md)
    lateral = result["lateral_displacement"][[before, after]]
    low = lateral[..., 0] * m1[..., 2] + lateral[..., 1] * m2[..., 2]  # towards the low side
    # from the hold below 1100 m, on the low side, into the build, where tension lifts it to the high side
    risen = (md[0] > 1100.0) & (md[1] < 1090.0)
    assert risen.any() and (low[0, risen] > 0.015).all() and (low[1, risen] < -0.015).all()
    # from the build into the vertical: off the wall
    freed = (md[0] > 605.0) & (md[1] < 580.0) | (md[0] > 580.0) & (md[1] < 570.0)
    touching = result["contact_force"]
    assert freed.any() and (touching[before, freed] > 1e3).all() and (touching[after, freed] < 1.0).all()
    # in the straight hold the wall bears the weight's part across it, w l sin 50
    held = (md[1] > 1200.0) & (md[1] < 1850.0)
    weight = np.asarray(result["buoyed_weight"])[held] * np.sin(50.0 * DEG)
    assert touching[after, held] == pytest.approx(weight, rel=5e-3)
    # the collars' side force in the dogleg is not that in the hold below it: it moves up the hole with them
    assert np.abs(touching[after, -4:] / touching[before, -4:] - 1.0).max() > 5e-3


def test_work_of_the_block_goes_into_weight_and_friction(trips):
    result = trips["pick_up"]
    work, lost = (result[name][-1] for name in ("external_work", "dissipated_energy"))
    raised = result["potential_energy"][-1] - result["potential_energy"][0]
    strained = result["strain_energy"][-1] - result["strain_energy"][0]
    assert work == pytest.approx(lost + raised + strained, rel=1e-4)
    # drag of the statics over the bit displacement
    depth, _ = steady(result, 22.0)
    statics = Statics(SCENE, depth, LINKS, above=LENGTH - depth)
    drag = statics.solve(FRICTION, "pick_up").hook_load - statics.solve(0.0, "pick_up").hook_load
    assert lost == pytest.approx(drag * np.abs(np.ptp(result["bit_depth"])), rel=3e-2)


def test_bit_below_the_end_of_the_hole_goes_on_with_its_last_curvature_and_is_warned_of():
    deep = shipped("tripping", top__block={"ramp": {"to": 12.0, "over": 20.0}}, solver__end=22.0)
    (one,) = [warning for warning in warnings(deep) if warning.where == "top.block"]
    assert "12 m past the end of the hole" in one.text
    result = run(deep)
    assert result["bit_depth"][-1] > LENGTH + 11.0
    # straight on: the bit goes along the last tangent
    _, _, tangent = WELL.frame(np.array([LENGTH]))
    way = result["position"][-1, -1] - WELL.position(np.array([LENGTH]))[0]
    assert way @ tangent[0] == pytest.approx(result["bit_depth"][-1] - LENGTH, rel=1e-3)


@pytest.mark.parametrize(("up", "words"), [(-100.0, "few derricks"), (-2500.0, "leaves the hole")])
def test_block_that_lifts_the_string_too_high_is_warned_of(up, words):
    scene = shipped("tripping", top__block={"ramp": {"to": up, "over": 60.0}})
    assert any(words in warning.text for warning in warnings(scene) if warning.where == "top.block")


def test_shipped_trip_is_not_warned_of():
    assert warnings(SCENE) == []


def test_stand_above_the_table_hangs_with_its_weight():
    plain, stood = Statics(SCENE, 1800.0, LINKS), Statics(SCENE, 1800.0, LINKS, above=28.0)
    pipe = plain.weight[0]
    for way in ("pick_up", "slack_off", "rotating"):
        more = stood.solve(FRICTION, way).hook_load - plain.solve(FRICTION, way).hook_load
        assert more == pytest.approx(28.0 * pipe, rel=0.15), "lumps stand elsewhere in the build"
    with pytest.raises(SceneError, match="give depths of more than 197 m"):
        Statics(SCENE, 190.0, LINKS, above=28.0)


@pytest.mark.parametrize("step", [1e-3, 2e-4])
def test_the_hook_load_of_a_frame_at_a_corner_of_the_block_s_way_is_not_that_of_the_push(step):
    corners = {"time": [0.0, 0.1, 0.2, 0.6], "value": [0.0, 0.0, 0.01, 0.01], "interpolation": "linear"}
    scene = straight_hole(
        0.0, elements=4, top__block={"table": corners}, solver__step=step, solver__end=0.25, output__interval=0.02
    )
    result = simulate(build(scene))
    above = np.asarray(result["hook_load"]) - np.asarray(result["tension"])[:, 0]
    # Between the hook and the first link is a part of a lump, which rests or goes at a steady speed. In a frame at a
    # corner its push was told, spread over a step: -763 kN of a string of 20 t.
    assert np.ptp(above) < 0.02 * abs(np.mean(above))
