"""What a drill string looks like is what its result says: places, offsets, lengths, forces, in both views."""

from functools import cache

import numpy as np
import pytest
from figures.synthetic_string import result as synthetic
from physics.wells.strings import DATA, shipped

from drillstring.model.build import build
from drillstring.model.prepared import well_of
from drillstring.view.appearance import VIEWS, appearance
from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.results.store import Store
from tautline.results.variable import Variable
from tautline.simulation import simulate
from tautline.view.space.appearance import Look, placed
from tautline.view.space.colours import shading

TRUE, HOLE = Look("true", 1.0), 0.2032
SHORT = {"jwell": 0.2, "iscwsa": 0.1, "hanging": 0.1, **{f"configuration_{k}": 0.002 for k in "abc"}}
"""Scenes of data/ and how long they are run here, s."""
PIPES = {"drill pipe": (0.127, 0.1086), "BHA": (0.165, 0.0572), "collar": (0.165, 0.0572)}
NEW = ("section", "outer_diameter", "hole_diameter", "well_direction", "well_side", "well_curvature")
"""Coordinates that results had not at first."""


@cache
def ran(name):
    """A scene of data/ and its short result."""
    scene = shipped(name, solver__end=SHORT[name])
    return scene, simulate(build(scene))


def without(result, names, **attributes):
    """The same result without some coordinates, and with other attributes."""
    variables, arrays, coordinates, old, restart = result._contents
    left = {key: value for key, value in coordinates.items() if key not in names}
    return Result(None, (variables, arrays, left, {**old, **attributes}, restart))


def turned(north_east_down):
    """East, north, up."""
    x = np.asarray(north_east_down)
    return np.stack([x[..., 1], x[..., 0], -x[..., 2]], axis=-1)


def parts(picture):
    return {part.name: part for part in (*picture.lines, *picture.solids, *picture.arrows)}


def straight(lateral, depth, unstretched=None, **others):
    """A made-up string of equal links along a straight vertical axis in free space."""
    frames, count = depth.shape
    stations = np.array([0.0, 0.5, 1.0]) * 1.1 * depth.max()
    path = np.outer(stations, [0.0, 0.0, 1.0])
    values = {"time": np.arange(frames, dtype=float), "measured_depth": depth, "lateral_displacement": lateral}
    values["position"] = np.concatenate([lateral, depth[..., None]], axis=-1)
    values |= {"tension": np.ones((frames, count - 1)), **others}
    axes = {"lateral_displacement": ("body", "side"), "position": ("body", "axis"), "tension": ("link",)}
    variables = [Variable(k, ("time", *axes.get(k, ("body",) if v.ndim > 1 else ())), "", k) for k, v in values.items()]
    ones = np.ones((3, 1))
    coordinates = {
        "unstretched_depth": ("body", depth[0] if unstretched is None else unstretched, "m", ""),
        "section": ("link", np.full(count - 1, "pipe"), "", ""),
        "outer_diameter": ("link", np.full(count - 1, 0.1), "m", ""),
        "well_depth": ("station", stations, "m", ""),
        "well_position": (("station", "axis"), path, "m", ""),
        "well_direction": (("station", "axis"), ones * [0.0, 0.0, 1.0], "", ""),
        "well_side": (("station", "axis"), ones * [1.0, 0.0, 0.0], "", ""),
        "well_curvature": (("station", "side"), np.zeros((3, 2)), "1/m", ""),
    }
    with Store(None, variables, coordinates, {"title": "made up"}) as store:
        store.append(values)
        return store.finish()


@pytest.mark.parametrize("name", SHORT)
@pytest.mark.parametrize("view", VIEWS)
def test_every_shipped_scene_is_drawn_of_finite_points_whose_number_never_changes(name, view):
    _, result = ran(name)
    picture = appearance(result, Look(view))
    assert len(picture.time) == len(result.time) and picture.eye != (0.0, 0.0, 0.0)
    lines, arrows = picture.lines, picture.arrows
    sizes = []
    for frame in range(len(picture.time)):
        for line in lines:
            points = line.points(frame)
            assert np.isfinite(points).all() and np.all(np.asarray(line.radius) > 0.0)
            assert all(q.values(frame).shape == (len(points),) for q in line.quantities)
            assert all(np.isfinite(q.values(frame)).all() for q in line.quantities)
        assert all(np.isfinite(solid.pose(frame)).all() for solid in picture.solids if solid.pose is not None)
        assert all(np.isfinite(one.vectors(frame)).all() and np.isfinite(one.points(frame)).all() for one in arrows)
        assert all(np.isfinite(label.place(frame)).all() for label in picture.labels)
        sizes.append([len(part.points(frame)) for part in (*lines, *arrows)])
    assert all(size == sizes[0] for size in sizes)
    assert np.isfinite(picture.extent([0])).all()
    assert next(iter(picture.quantities)) == "tension"


@pytest.mark.parametrize("name", ["jwell", "iscwsa"])
def test_the_hole_is_the_stored_well_path(name):
    _, result = ran(name)
    hole = parts(appearance(result, TRUE))["hole"]
    stored = turned(result["well_position"])
    assert np.abs(hole.points(0)[: len(stored)] - stored).max() < 1e-9
    assert hole.radius == pytest.approx(0.5 * HOLE, rel=1e-14) and hole.hollow and not hole.thick
    # What is more is where the bit hangs below the end of the hole.
    assert len(hole.points(0)) == len(stored) + 1
    assert hole.points(0)[-1] == pytest.approx(turned(result["position"])[:, -1].mean(axis=0), abs=0.1)


@pytest.mark.parametrize("name", SHORT)
def test_nodes_at_true_scale_are_the_stored_positions(name):
    _, result = ran(name)
    string = parts(appearance(result, TRUE))["string"]
    for frame in (0, -1):
        assert np.abs(string.points(frame)[string.nodes] - turned(result["position"][frame])).max() < 1e-9


@pytest.mark.parametrize("name", SHORT)
def test_the_drawn_line_is_as_long_as_the_stretched_string(name):
    # Young's modulus of all scenes; the tables' diameters
    _, result = ran(name)
    area = np.array([np.pi / 4.0 * (d**2 - b**2) for d, b in (PIPES[str(one)] for one in result["section"])])
    stretched = np.sum(result["link_length"] + result["link_length"] * result["tension"][-1] / (200e9 * area))
    points = parts(appearance(result, TRUE))["string"].points(-1)
    assert np.linalg.norm(np.diff(points, axis=0), axis=1).sum() == pytest.approx(stretched, rel=1e-4)


def test_the_string_is_as_thick_as_its_sections():
    _, result = ran("jwell")
    string = parts(appearance(result, TRUE))["string"]
    assert set(2.0 * string.radius) == {0.127, 0.165}
    end = string.nodes[-2]
    assert 2.0 * string.radius[end] == 0.127 and np.all(2.0 * string.radius[end + 1 :] == 0.165)


@pytest.mark.parametrize("name", ["jwell", "iscwsa"])
def test_forces_push_inwards_from_the_wall_and_only_where_there_are_any(name):
    scene, result = ran(name)
    (push,) = appearance(result, TRUE).arrows
    well, force, depth = well_of(scene), result["contact_force"][-1], result["measured_depth"][-1]
    axis = turned(well.position(depth))
    off = turned(result["position"][-1]) - axis
    vectors, points = push.vectors(-1), push.points(-1)
    assert np.abs(np.linalg.norm(vectors, axis=1) - force).max() < 1e-9 * push.longest
    there = force > 0.0
    assert 0 < there.sum() < there.size and not vectors[~there].any()
    out = off[there] / np.linalg.norm(off[there], axis=1)[:, None]
    # Against the offset, and on the line from the axis through the lump, on the wall.
    assert vectors[there] == pytest.approx(-force[there, None] * out, rel=1e-6, abs=1e-6 * push.longest)
    away = points[there] - axis[there]
    assert np.abs(away - np.sum(away * out, axis=1)[:, None] * out).max() < 1e-6
    assert np.linalg.norm(away, axis=1) == pytest.approx(0.5 * HOLE, abs=1e-6)
    assert push.pushes and push.longest == result["contact_force"].max() and push.unit == "N"


@pytest.mark.parametrize("name", ["jwell", "iscwsa"])
@pytest.mark.parametrize("factor", [None, 700.0])
def test_unrolled_offsets_over_the_holes_radius_are_the_stored_ones(name, factor):
    _, result = ran(name)
    picture = parts(appearance(result, Look("unrolled", factor)))
    string, hole = picture["string"], picture["hole"]
    points = string.points(-1)[string.nodes] / hole.radius
    assert points[:, :2] == pytest.approx(result["lateral_displacement"][-1][:, ::-1] / (0.5 * HOLE), abs=1e-12)
    assert -string.points(-1)[string.nodes, 2] == pytest.approx(result["measured_depth"][-1], rel=1e-14)
    assert not hole.points(0)[:, :2].any()


def test_no_pipe_between_lumps_leaves_the_hole():
    # A lump sinks into the elastic wall by a fraction of a millimetre.
    _, result = ran("jwell")
    picture = parts(appearance(result, Look("unrolled", 1.0)))
    string = picture["string"]
    reach = np.hypot(*string.points(-1)[:, :2].T)[:-1] + string.radius[:-1]
    assert reach.max() < 0.5 * HOLE + 1e-3


def test_the_factor_magnifies_offsets_and_thickness_exactly():
    scene, result = ran("iscwsa")
    one, many = (parts(appearance(result, Look("true", factor))) for factor in (1.0, 50.0))
    axis = turned(well_of(scene).position(result["measured_depth"][-1]))
    nodes = one["string"].nodes
    small = one["string"].points(-1)[nodes] - axis
    assert np.abs(small).max() > 0.01
    assert many["string"].points(-1)[nodes] - axis == pytest.approx(50.0 * small, abs=1e-9)
    assert np.all(many["string"].radius == 50.0 * one["string"].radius)
    assert many["hole"].radius == 50.0 * one["hole"].radius
    assert np.all(many["hole"].points(0) == one["hole"].points(0))
    assert appearance(result, Look("true", 50.0)).enlarged == (("across the hole", 50.0),)
    assert one and not appearance(result, Look("true", 1.0)).enlarged


def test_a_hole_is_drawn_about_a_hundredth_of_the_picture_wide_and_says_so():
    _, result = ran("jwell")
    picture = appearance(result, Look())
    radius = parts(picture)["hole"].radius
    assert 0.008 < 2.0 * radius / np.ptp(result["well_position"], axis=0).max() < 0.016
    assert picture.enlarged == (("across the hole", pytest.approx(2.0 * radius / HOLE)),)


@pytest.mark.parametrize(("name", "sag"), [("a", 3.278958), ("b", 233.5539), ("c", 24.735459)])
def test_a_string_in_free_space_has_no_hole_and_its_ruler_measures_the_sag(name, sag):
    # sag of the exact extensible rods, docs/lumped_string.md
    _, result = ran(f"configuration_{name}")
    picture = appearance(result, Look())
    assert not picture.arrows and {part.name for part in picture.lines} == {"string"}
    string, (ruler,) = parts(picture)["string"], picture.rulers
    heights, numbers = ruler.points[:, 2], ruler.numbers
    assert np.interp(string.points(0)[:, 2].min(), heights[::-1], numbers[::-1]) <= sag
    rate = (numbers[-1] - numbers[0]) / (heights[0] - heights[-1])
    assert rate * -string.points(0)[:, 2].min() == pytest.approx(sag, rel=2e-3)
    assert len(numbers) >= 2 and picture.eye[2] == 0.0


@pytest.mark.parametrize("view", VIEWS)
def test_in_oilfield_units_scales_and_legends_are_in_feet_and_kip_and_what_is_drawn_is_the_same(view):
    _, result = ran("jwell")
    si, field = (appearance(result, Look(view, units=units)) for units in ("si", "field"))
    (ruler,) = field.rulers
    assert ruler.unit == "ft" and np.all(ruler.numbers % 500.0 == 0.0) and len(ruler.numbers) >= 4
    assert ruler.points[:, 2] == pytest.approx(-0.3048 * ruler.numbers)
    metric, shade = shading(si, None), shading(field, None)
    assert (metric.unit, shade.title) == ("kN", "tension [kip]")
    assert shade.factor == pytest.approx(4448.2216152605) and shade.high * shade.factor == metric.high * metric.factor
    np.testing.assert_array_equal(parts(field)["string"].points(0), parts(si)["string"].points(0))


def test_rulers_show_true_vertical_depth_and_measured_depth():
    _, result = ran("iscwsa")
    (vertical,), (along,) = (appearance(result, Look(view)).rulers for view in VIEWS)
    assert vertical.text == "true vertical depth" and along.text == "measured depth"
    for ruler, deepest in ((vertical, result["well_position"][:, 2].max()), (along, result["bit_depth"].max())):
        assert np.all(ruler.points[:, 2] == -ruler.numbers) and ruler.numbers[0] == 0.0
        assert 0.8 * deepest < ruler.numbers[-1] <= deepest


def test_sections_are_named_beside_the_unrolled_hole_and_no_two_words_overlap():
    _, result = ran("jwell")
    labels = {label.text: label.place(0) for label in appearance(result, Look("unrolled")).labels}
    assert set(labels) == {"bit", "drill pipe", "BHA", "low side"}
    heights = np.sort([place[2] for place in labels.values()])
    assert np.diff(heights).min() > 0.03 * 3770.0
    assert labels["drill pipe"][2] == pytest.approx(-0.5 * 3530.0, rel=0.01)


@pytest.mark.parametrize("depth", [[0, 900, 910, 930, 960, 1000], [0, 10, 20, 50, 70, 1000]], ids=["below", "above"])
def test_names_of_short_sections_stand_apart_in_their_order_and_beside_the_string(depth):
    result = straight(np.zeros((1, 6, 2)), np.array([depth], dtype=float))
    names = ["pipe", "heavy", "jar", "collar", "motor"]
    result._contents[2]["section"] = ("link", np.array(names), "", "")
    labels = {label.text: label.place(0)[2] for label in appearance(result, Look("unrolled")).labels}
    heights = np.array([labels[name] for name in names])
    assert np.diff(-heights).min() > 0.03 * 1000.0 and -1100.0 <= heights.min() and heights.max() <= 0.0
    # The long one's name stays where it is.
    assert heights[np.argmax(np.diff(depth))] == pytest.approx(-0.5 * (depth[1] if depth[1] > 10 else 1070.0))


def test_the_low_side_is_where_the_well_turns_from():
    # The J-well builds to the north: below the kick-off its low side is the south of the Bishop frame, -y.
    _, result = ran("jwell")
    picture = parts(appearance(result, Look("unrolled")))
    low = picture["low side"].points(0)
    assert low[:, 1] == pytest.approx(np.full(len(low), -picture["hole"].radius), rel=1e-9)
    assert np.abs(low[:, 0]).max() < 1e-9 * picture["hole"].radius
    assert -low[0, 2] == pytest.approx(2200.0 + np.radians(2.0) * 1000.0, abs=20.0)


def test_the_block_moves_with_the_string_and_the_bit_turns_with_it():
    depth = np.array([[0.0, 100.0, 200.0], [-2.0, 99.0, 199.0]])
    turns = np.array([[0.0, 0.0, 0.0], [0.9, 0.8, 0.5 * np.pi]])
    result = straight(np.zeros((2, 3, 2)), depth, rotation=turns)
    picture = parts(appearance(result, TRUE))
    assert picture["block"].pose(0)[:3, 3] == pytest.approx([0.0, 0.0, 0.0])
    assert picture["block"].pose(1)[:3, 3] == pytest.approx([0.0, 0.0, 2.0])
    assert picture["bit"].pose(1)[:3, 3] == pytest.approx([0.0, 0.0, -199.0])
    # Clockwise looking down: what pointed north points east, and the bit's end down all the while.
    north, down = np.array([[1.0, 0.0, 0.0]]), np.array([[0.0, 0.0, 1.0]])
    at = [placed(north, picture["bit"].pose(k)) - picture["bit"].pose(k)[:3, 3] for k in (0, 1)]
    assert at[0] == pytest.approx(np.array([[0.0, 1.0, 0.0]])) and at[1] == pytest.approx(np.array([[1.0, 0.0, 0.0]]))
    assert placed(down, picture["bit"].pose(1))[0, 2] == pytest.approx(-200.0)


def test_curvature_of_lumps_on_a_circle_is_that_of_the_circle():
    # A circle of 500 m in free space, 20 m from lump to lump: turned by 0.04 rad, whose sine is 0.03 % less.
    angle = np.linspace(0.0, 1.0, 26)
    lateral = np.stack([500.0 * (1.0 - np.cos(angle)), 0.0 * angle], axis=-1)[None]
    result = straight(lateral, 500.0 * np.sin(angle)[None], unstretched=500.0 * angle)
    string = parts(appearance(result, TRUE))["string"]
    curvature = next(q for q in string.quantities if q.name == "curvature")
    assert curvature.values(0)[string.nodes[1:-1]] == pytest.approx(1.0 / 500.0, rel=1e-3)
    # The line between them stays on the circle but at its ends, where a natural spline does not bend.
    x = string.points(0)[string.nodes[4] : string.nodes[-5]]
    assert np.hypot(x[:, 1] - 500.0, x[:, 2]) == pytest.approx(500.0, abs=1e-3)


def test_curvature_of_a_string_in_a_bend_is_the_bends():
    # radius 1000 m; offsets of 40 mm in 314 m of link change it by less than 1 %
    _, result = ran("jwell")
    string = parts(appearance(result, TRUE))["string"]
    curvature = next(q for q in string.quantities if q.name == "curvature").values(0)[string.nodes]
    bent, level = result["measured_depth"][0] - 320.0 > 2200.0, result["measured_depth"][0] + 320.0 < 2200.0
    assert bent.sum() == 5 and curvature[bent] == pytest.approx(1e-3, rel=1e-2)
    assert level.sum() == 6 and curvature[level] == pytest.approx(0.0, abs=1e-5)


def test_forces_and_speeds_at_lumps_are_the_stored_ones():
    _, result = ran("jwell")
    string = parts(appearance(result, Look()))["string"]
    found = {quantity.name: quantity.values(-1)[string.nodes] for quantity in string.quantities}
    length = result["link_length"]
    tributary = 0.5 * (np.append(length, 0.0) + np.append(0.0, length))
    assert found["contact_force_per_metre"] * tributary == pytest.approx(result["contact_force"][-1], rel=1e-12)
    assert found["friction_per_metre"] * tributary == pytest.approx(result["friction_force"][-1], rel=1e-12)
    assert found["axial_velocity"] == pytest.approx(result["axial_velocity"][-1], rel=1e-12)
    # Tension is a link's: between two of equal weight it is their mean.
    tension = result["tension"][-1]
    assert found["tension"][1:5] == pytest.approx(0.5 * (tension[:4] + tension[1:5]), rel=1e-9)


@pytest.mark.parametrize("name", ["jwell", "configuration_b"])
def test_a_result_without_diameters_is_read_with_its_scene_and_looks_the_same(name):
    _, result = ran(name)
    new, old = (appearance(one, Look()) for one in (result, without(result, NEW)))
    assert new.notes == old.notes and len(new.lines) == len(old.lines)
    for one, other in zip(new.lines, old.lines, strict=True):
        assert other.points(-1) == pytest.approx(one.points(-1), abs=1e-8)
        assert other.radius == pytest.approx(one.radius, rel=1e-12)


def test_a_result_whose_survey_is_not_at_hand_is_drawn_and_says_what_is_missing(tmp_path, monkeypatch):
    _, result = ran("iscwsa")
    monkeypatch.chdir(tmp_path)
    assert not any("not in the result" in note for note in appearance(result, TRUE).notes)
    scene = (DATA / "iscwsa.yaml").read_text(encoding="utf8")
    picture = appearance(without(result, NEW, scene=scene), TRUE)
    assert sum("not in the result" in note for note in picture.notes) == 2
    string = parts(picture)["string"]
    assert np.abs(string.points(-1)[string.nodes] - turned(result["position"][-1])).max() < 0.05
    assert "hole" not in parts(picture)
    string = parts(appearance(without(result, NEW, scene=scene), Look("unrolled", 1.0)))["string"]
    assert string.points(-1)[string.nodes, :2] == pytest.approx(result["lateral_displacement"][-1][:, ::-1], abs=1e-12)


def test_a_result_without_any_well_is_drawn_through_its_own_string_and_says_so():
    _, result = ran("jwell")
    picture = appearance(without(result, (*NEW, "well_position", "well_depth"), scene=""), TRUE)
    assert sum("not in the result" in note for note in picture.notes) == 2
    string = parts(picture)["string"]
    assert np.abs(string.points(-1)[string.nodes] - turned(result["position"][-1])).max() < 1.0


@pytest.mark.parametrize(
    "kind", [{"bodies": 1}, {"frames": 1}, {"vertical": True}, {"frames": 1, "bodies": 1}], ids=str
)
@pytest.mark.parametrize("view", VIEWS)
def test_one_lump_and_one_frame_are_drawn_of_positions_and_tensions_alone(kind, view):
    result = synthetic(None, **({"frames": 5} | kind))
    picture = appearance(result, Look(view, 1.0))
    string = parts(picture)["string"]
    assert len(string.nodes) == result["position"].shape[1] and np.isfinite(string.points(-1)).all()
    if view == "true":
        assert string.points(-1)[string.nodes] == pytest.approx(turned(result["position"][-1]), abs=2.0)
    assert np.isfinite(picture.extent([0])).all()


def test_a_string_shorter_than_the_hole_ends_above_its_end():
    result = straight(np.zeros((1, 3, 2)), np.array([[0.0, 100.0, 200.0]]))
    _, coordinates = result._contents[1:3]
    coordinates["hole_diameter"] = ("station", np.full(3, 0.3), "m", "")
    picture = parts(appearance(result, TRUE))
    assert picture["hole"].points(0)[-1, 2] == pytest.approx(-220.0)
    assert picture["string"].points(0)[-1, 2] == pytest.approx(-200.0)


@pytest.mark.parametrize(
    ("look", "message"),
    [(Look("above"), r"there is no view 'above'; known: true \("), (Look("true", 0.0), "0 is no factor")],
    ids=["view", "factor"],
)
def test_what_cannot_be_drawn_is_refused(look, message):
    with pytest.raises(ResultError, match=message):
        appearance(synthetic(None, frames=2), look)
