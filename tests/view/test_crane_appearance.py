"""A crane's appearance is what was stored: rope in its grooves, rims that move with it, decks that heave.

References: the material coordinates and velocities that the kernels stored, prescribed speeds, and geometry. Runs are
short and their frames 10 ms apart, so that central differences of poses are good to 1e-3.
"""

from pathlib import Path

import numpy as np
import pytest
from figures.synthetic_crane import fixed_rope, one_fall, result
from physics.lifting.crane_scenes import anchor, body, crane, drum, end, model_of, sheave
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from crane.application import Crane
from crane.scene.scene import CraneScene
from crane.view.appearance import VIEWS, appearance
from tautline.results.errors import ResultError
from tautline.simulation import simulate
from tautline.view.space.appearance import Look, placed
from tautline.view.space.colours import shading

ROOT = Path(__file__).parents[2]
SHIPPED = [ROOT / "data" / f"{name}.yaml" for name in ("hoist", "hookblock", "landing", "slewing", "sixteen_falls")]
TEMPLATES = sorted((ROOT / "apps" / "crane" / "templates").glob("*.yaml"))
UPRIGHT = (0.0, 0.0, 1.0)
WINDING = {"pay_out": {"ramp": {"to": -0.5, "over": 0.2}}}
SPEED = 0.5
SHORT = {"end": 0.4}
STIFF = {"axial_stiffness": 8.0e9}
"""So stiff that loads follow the winch without bouncing."""
PAYLOAD = body("payload", 5000.0, (12.4, 0.0, 5.0))
TIP = sheave((12.0, 0.0, 30.0), inertia=20.0)
FALL = [drum(**WINDING), TIP, end("payload")]
HEAVING = {
    "reference": (0.0, 0.0, -10.0),
    "motion": {
        "heave": {"harmonic": {"amplitude": 0.5, "period": 2.0, "ramp": 0.2}},
        "roll": {"harmonic": {"amplitude": 0.05, "period": 1.5, "ramp": 0.2}},
    },
}


def run(scene):
    return simulate(model_of(scene))


@pytest.fixture(scope="module")
def hoist():
    return run(crane(FALL, [PAYLOAD], rope=STIFF, solver=SHORT))


def test_the_legend_is_in_the_units_that_are_asked_for(hoist):
    titles = [shading(appearance(hoist, Look(units=units)), "tension").title for units in ("si", "metric", "field")]
    assert titles == ["tension [kN]", "tension [kN]", "tension [kip]"]


@pytest.fixture(scope="module")
def block():
    path = [
        drum(**WINDING), TIP,
        sheave(name="low", body="block", radius=0.35, wrap="under", inertia=12.0), anchor((13.1, 0.0, 30.0)),
    ]  # fmt: skip
    return run(crane(path, [body("block", 5000.0, (12.75, 0.0, 5.0))], rope=STIFF, solver=SHORT))


@pytest.fixture(scope="module")
def vessel():
    return run(crane(FALL, [PAYLOAD], solver=SHORT, vessel=HEAVING))


@pytest.fixture(scope="module")
def odd():
    """Cranes of every other kind, by what is odd about them."""
    quick = {"solver": {"end": 0.05}}
    other = drum((25.0, 0.0, 0.0), name="other", torque=12e3, inertia=500.0)
    low = sheave(name="low", body="block", radius=0.35, wrap="under", inertia=12.0)
    two = [drum(), TIP, low, sheave((13.5, 0.0, 30.0), name="second", inertia=20.0), other]
    upright = [
        drum(axis=UPRIGHT, wrap="right"),
        sheave((12.0, 0.2, 0.0), name="post", axis=UPRIGHT, wrap="right", inertia=9.0),
        sheave((12.0, 9.0, 0.0), axis=(1.0, 0.0, 0.0), inertia=9.0), end("payload"),
    ]  # fmt: skip
    locked = sheave((12.0, 0.0, 30.0), law="capstan", friction=0.1, locked=True)
    luffing = {"name": "boom", "pivot": (0.0, 0.0, 0.0), "slew": {"ramp": {"rate": 1.0, "over": 0.1}}}
    turning = [drum(frame="boom"), sheave((12.0, 0.0, 30.0), frame="boom", inertia=20.0), end("payload")]
    rigid = PAYLOAD | {"inertia": (4000.0, 5000.0, 6000.0)}
    return {
        "two drums": run(crane(two, [body("block", 5000.0, (12.75, 0.0, 5.0))], **quick)),
        "upright": run(crane(upright, [body("payload", 5000.0, (12.0, 9.4, -8.0))], **quick)),
        "locked": run(crane([drum(), locked, end("payload")], [PAYLOAD], **quick)),
        "slewing": run(crane(turning, [PAYLOAD], frames=[luffing], **quick)),
        "rigid": run(crane([drum(), TIP, end("payload", offset=(0.0, 0.0, 1.5))], [rigid], **quick)),
        "anchors": run(crane([anchor((0.0, 0.0, 0.0)), anchor((10.0, 0.0, 0.0), "b")], rope={"length": 10.2}, **quick)),
    }


def seen(of, **look):
    return appearance(of, Look(**look))


def solid(shown, name):
    return next(one for one in shown.solids if one.name == name)


def quantity(shown, name, frame):
    return next(one for one in shown.lines[0].quantities if one.name == name).values(frame)


def arcs(shown, wheel, radius, frame):
    """Numbers of the rope's points that lie on a wheel."""
    pose = solid(shown, wheel).pose(frame)
    local = (shown.lines[0].points(frame) - pose[:3, 3]) @ pose[:3, :3]
    return np.flatnonzero(np.abs(np.hypot(local[:, 0], local[:, 1]) - radius) < 1e-9), local


def rim_velocity(one, place, frame, step):
    """Velocity of what is at a place of a solid, from differences of its poses."""
    pose = one.pose(frame)
    local = (place - pose[:3, 3]) @ pose[:3, :3]
    return (placed(local, one.pose(frame + 1)) - placed(local, one.pose(frame - 1))) / (2.0 * step)


def stretched(of, frame, stiffness):
    """Length of the rope from its first to its last node, m: material times the stretch of Green's strain."""
    force = of["axial_force"][frame]
    stretch = np.ones_like(force)
    for _ in range(20):
        stretch = np.sqrt(1.0 + 2.0 * force / (stiffness * stretch))
    return float(np.sum(stretch * np.diff(of["material_coordinate"][frame])))


@pytest.mark.parametrize(("kind", "stiffness"), [("hoist", 8.0e9), ("block", 8.0e9), ("vessel", 8.0e7)])
def test_drawn_rope_is_as_long_as_the_stretched_rope(kind, stiffness, request):
    of = request.getfixturevalue(kind)
    shown = seen(of)
    line = shown.lines[0]
    assert len(line.nodes) == of["position"].shape[1]
    for frame in (0, 20, 40):
        drawn = line.points(frame)[line.nodes[0] : line.nodes[-1] + 1]
        length = np.linalg.norm(np.diff(drawn, axis=0), axis=1).sum()
        assert length == pytest.approx(stretched(of, frame, stiffness), rel=1e-3)


def test_nodes_inside_spans_are_where_they_were_stored(hoist):
    line = seen(hoist).lines[0]
    # Of four elements to a span: the drum, three nodes, the sheave, three nodes, the hook.
    for node in (1, 2, 3, 5, 6, 7, 8):
        assert np.allclose(line.points(40)[line.nodes[node]], hoist["position"][40, node], atol=1e-12)


def test_the_rope_lies_in_the_grooves(block):
    shown = seen(block)
    for frame in (0, 40):
        for name, radius, wrap in (("boom tip", 0.4, 0), ("low", 0.35, 1)):
            on, local = arcs(shown, f"sheave {name}", radius, frame)
            angle = np.unwrap(np.arctan2(local[on, 1], local[on, 0]))
            assert len(on) > 20 and np.allclose(local[on, 2], 0.0, atol=1e-9)
            assert abs(angle[-1] - angle[0]) == pytest.approx(block["wrap_angle"][frame, wrap], abs=1e-9)
            groove = np.hypot(*solid(shown, f"sheave {name}").points[:, :2].T)
            assert np.isclose(groove, radius - 0.5 * 2.0 * shown.lines[0].radius, atol=1e-9).any()


def test_a_rim_that_does_not_slip_moves_with_the_rope(hoist):
    """At the top of the sheave the rope runs towards the winch, at the speed that this winds in."""
    shown, frame = seen(hoist), 30
    place = np.array([12.0, 0.0, 30.4])
    velocity = rim_velocity(solid(shown, "sheave boom tip"), place, frame, 0.01)
    assert np.allclose(velocity, [-SPEED, 0.0, 0.0], atol=0.02 * SPEED)
    at = int(np.argmin(np.linalg.norm(shown.lines[0].points(frame) - place, axis=1)))
    assert quantity(shown, "rope_speed", frame)[at] == pytest.approx(-np.linalg.norm(velocity), rel=5e-3)


def test_a_rim_on_a_heaving_vessel_moves_with_the_rope(vessel):
    """Rope and rim are compared where the rope is: both move with the tip besides."""
    shown, frame = seen(vessel), 30
    on, _ = arcs(shown, "sheave boom tip", 0.4, frame)
    points = shown.lines[0].points(frame)
    for at in on[2:-2:4]:
        along = points[at + 1] - points[at - 1]
        rim = rim_velocity(solid(shown, "sheave boom tip"), points[at], frame, 0.01)
        assert rim @ along / np.linalg.norm(along) == pytest.approx(quantity(shown, "rope_speed", frame)[at], abs=0.02)


def test_a_blocks_rim_stands_still_where_the_standing_part_leaves_it(block):
    shown, frame = seen(block), 30
    on, _ = arcs(shown, "sheave low", 0.35, frame)
    points, rim = shown.lines[0].points(frame), solid(shown, "sheave low")
    rising = block["body_velocity"][frame, 0, 2]
    assert rising == pytest.approx(0.5 * SPEED, rel=0.05)
    assert np.allclose(rim_velocity(rim, points[on[-1]], frame, 0.01), 0.0, atol=0.02)
    assert np.allclose(rim_velocity(rim, points[on[0]], frame, 0.01), [0.0, 0.0, 2.0 * rising], atol=0.02)


def test_the_rope_at_the_hook_has_the_loads_speed(hoist):
    shown = seen(hoist)
    for frame in (10, 20, 30):
        along = hoist["position"][frame, -1] - hoist["position"][frame, -2]
        speed = hoist["body_velocity"][frame, 0] @ along / np.linalg.norm(along)
        assert quantity(shown, "rope_speed", frame)[-1] == pytest.approx(speed, abs=5e-3)


def test_drums_at_either_end_turn_with_the_rope_that_leaves_them(odd, hoist):
    for of, name, node, frame in ((hoist, "winch", 0, 30), (odd["two drums"], "other", -1, 3)):
        shown = seen(of)
        line = shown.lines[0]
        at = line.nodes[node]
        rim = rim_velocity(solid(shown, f"drum {name}"), line.points(frame)[at], frame, 0.01)
        inward = line.points(frame)[at + (1 if node == 0 else -1)] - line.points(frame)[at]
        paid = of["pay_out_speed"][frame, node]
        assert rim @ inward / np.linalg.norm(inward) == pytest.approx(paid, rel=2e-2, abs=1e-4)
        assert abs(paid) > 1e-3


def test_turns_on_the_drum_lie_on_its_pitch_circle_and_grow_by_what_is_wound_in(hoist):
    line = seen(hoist).lines[0]
    lengths = []
    for frame in (0, 40):
        coil = line.points(frame)[: line.nodes[0] + 1]
        assert np.allclose(np.hypot(coil[:, 0], coil[:, 2]), 0.5, atol=1e-9)
        assert np.ptp(coil[:, 1]) > 2.0 * line.radius
        lengths.append(np.linalg.norm(np.diff(coil, axis=0), axis=1).sum())
    assert lengths[0] > 2.0 * np.pi * 0.5
    assert lengths[1] - lengths[0] == pytest.approx(-hoist["paid_out"][40, 0], rel=0.01)


def test_tension_is_what_was_stored_and_exponential_over_an_arc(odd):
    of = odd["locked"]
    shown = seen(of)
    line, frame = shown.lines[0], 5
    tension = quantity(shown, "tension", frame)
    stored = of["tension"][frame]
    assert tension[line.nodes[0]] == stored[0, 0] and tension[-1] == stored[-1, 1]
    on, off = stored[0, 1], stored[1, 0]
    assert abs(on / off - 1.0) > 5e-5
    assert tension[line.nodes[4]] == pytest.approx(np.sqrt(on * off), rel=1e-12)
    assert [one.name for one in line.quantities] == ["tension", "rope_speed"]
    assert line.quantities[0].high >= of["axial_force"].max()


def test_slack_rope_has_no_tension_and_taut_rope_has():
    of = result(one_fall(), slack=True)
    shown = seen(of)
    slack = of["axial_force"][:, 0] == 0.0
    assert slack.any() and not slack.all()
    for frame in range(0, 201, 10):
        assert np.all(quantity(shown, "tension", frame) == 0.0) == slack[frame]


def test_sag_is_exaggerated_by_the_factor_and_said_so(odd):
    true, large = seen(odd["anchors"]), seen(odd["anchors"], exaggerate=3.0)
    assert not any("times" in one for one in true.remarks)
    assert "3 times" in large.remarks[0]
    assert np.allclose(large.lines[0].points(0)[:, 2], 3.0 * true.lines[0].points(0)[:, 2], atol=1e-12)
    assert np.allclose(large.lines[0].points(0)[:, 0], true.lines[0].points(0)[:, 0], atol=1e-12)


def test_the_deck_moves_as_what_stands_on_it(vessel):
    shown = seen(vessel)
    deck, drawn = solid(shown, "deck"), np.array([[0.0, 0.0, 0.0], [12.0, 0.0, 30.0]])
    wheels = vessel["position"][:, [0, 4]]
    assert np.ptp(wheels[:, 1], axis=0).max() > 0.1
    for frame in range(0, 41, 8):
        assert np.allclose(placed(drawn, deck.pose(frame)), wheels[frame], atol=1e-9)


def test_without_the_file_of_its_motion_the_vessel_still_heaves(tmp_path):
    time = np.linspace(0.0, 2.0, 41)
    rows = "\n".join(f"{t:.3f},0,0,{0.3 * np.sin(3.0 * t) ** 2:.9f},0,0,0" for t in time)
    (tmp_path / "motion.csv").write_text(f"t,surge,sway,heave,roll [rad],pitch [rad],yaw [rad]\n{rows}\n")
    (tmp_path / "scene.yaml").write_text(
        (ROOT / "data" / "hoist.yaml").read_text().replace(
            "motion: {heave: {harmonic: {amplitude: 0.5, period: 8, ramp: 8}}, roll: {constant: 0 deg}}",
            "motion: {file: motion.csv}",
        ).replace("end: 12 s", "end: 0.4 s")
    )  # fmt: skip
    of = simulate(Crane().build(CraneScene.read(tmp_path / "scene.yaml")))
    (tmp_path / "motion.csv").unlink()
    of.path = tmp_path / "scene.nc"
    shown = seen(of)
    assert any("not at hand" in note for note in shown.notes)
    for frame in (0, 4, 8):
        assert np.allclose(solid(shown, "deck").pose(frame)[:3, 3], of["position"][frame, 0], atol=1e-9)
    assert of["position"][8, 0, 2] > 0.1


def test_a_released_load_falls_freely():
    load = PAYLOAD | {"release": {"at": 0.05, "remaining": 500.0}}
    of = run(crane([drum(), TIP, end("payload")], [load], solver={"end": 0.3}))
    shown = seen(of)
    height = np.array([solid(shown, "payload").pose(frame)[2, 3] for frame in range(31)])
    assert np.allclose(np.diff(height[6:], 2) / 0.01**2, -9.81, atol=1e-6)
    assert solid(shown, "rigging of payload").pose(30)[2, 3] > height[30] + 0.2


def check(shown):
    """Finite, constant in number, rigid, closed and seen from outside."""
    frames = range(len(shown.time))
    for line in shown.lines:
        counts = {line.points(frame).shape for frame in frames}
        assert len(counts) == 1 and all(np.isfinite(line.points(frame)).all() for frame in frames)
        assert np.all(np.diff(line.nodes) > 0)
        for one in line.quantities:
            assert all(one.values(frame).shape == (len(line.points(0)),) for frame in frames)
            assert np.isfinite([one.low, one.high]).all() and all(np.isfinite(one.values(f)).all() for f in frames)
    names = [one.name for one in shown.solids]
    assert len(set(names)) == len(names)
    for one in shown.solids:
        for frame in frames if one.pose is not None else ():
            pose = one.pose(frame)
            assert np.allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-9)
            assert np.linalg.det(pose[:3, :3]) == pytest.approx(1.0, abs=1e-9)
            assert np.isfinite(pose).all() and np.array_equal(pose[3], [0.0, 0.0, 0.0, 1.0])
        check_mesh(one)
    assert all(np.isfinite(label.place(0)).all() for label in shown.labels)
    assert np.isfinite(shown.eye).all() and np.isfinite(shown.extent(list(frames))).all()


def check_mesh(one):
    """Each part is closed, so that its faces' areas add up to nothing, and its faces look outward."""
    points, faces = np.asarray(one.points), np.asarray(one.triangles)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
    graph = coo_array((np.ones(len(edges)), edges.T), shape=(len(points),) * 2)
    label = connected_components(graph)[1][faces[:, 0]]
    a, b, c = (points[faces[:, k]] for k in range(3))
    for part in np.unique(label):
        here = label == part
        area = 0.5 * np.cross(b[here] - a[here], c[here] - a[here])
        assert np.allclose(area.sum(axis=0), 0.0, atol=1e-9 * np.abs(area).sum()), one.name
        volume = np.einsum("ij,ij->", a[here] - a[here].mean(axis=0), area) / 3.0
        assert volume > 0.0, one.name


def test_every_kind_of_crane_has_an_appearance(hoist, block, vessel, odd):
    for of in (hoist, block, vessel, *odd.values()):
        check(seen(of))


@pytest.mark.parametrize("path", [*SHIPPED, *TEMPLATES], ids=lambda path: f"{path.parent.name}/{path.name}")
def test_every_shipped_scene_has_an_appearance(path):
    application = Crane()
    of = simulate(application.build(application.with_overrides(CraneScene.read(path), end=0.05, interval=0.025)))
    shown = seen(of)
    check(shown)
    assert shown.title == of.attributes["title"] and len(shown.time) == 3
    assert {f"sheave {name}" for name in of["sheave"]} <= {one.name for one in shown.solids}


def test_a_run_of_one_frame_has_an_appearance_without_speeds():
    shown = seen(result(one_fall(), frames=1))
    check(shown)
    assert [one.name for one in shown.lines[0].quantities] == ["tension"]


def test_a_rope_without_bodies_or_wheels_has_an_appearance():
    check(seen(result(fixed_rope())))


def test_water_and_ground_are_levels_where_the_scene_has_them():
    sea = {"water": {"surface": 1.5, "density": 1025}, "ground": {"level": -30, "stiffness": 1.0e7}}
    levels = seen(result(one_fall(**sea))).levels
    assert [(one.name, one.height) for one in levels] == [("water", 1.5), ("ground", -30.0)]


def test_a_vessel_without_water_floats_in_a_calm_sea_that_is_said_to_be_drawn():
    vessel = {"reference": [0, 0, -10], "motion": {"heave": {"harmonic": {"amplitude": 0.5, "period": 8}}}}
    shown = seen(result(one_fall(vessel=vessel)))
    (sea,) = shown.levels
    deck = solid(shown, "deck")
    low, top = deck.points[:, 2].min(), deck.points[:, 2].max()
    assert low < sea.height < top and sea.clear and sea.waves is None
    assert any("not in the scene" in note for note in shown.notes)
    # Where a load goes below it, or on land, it would tell something that is not so.
    low_load = [body("payload", 5000.0, (12.4, 0.0, -8.0))]
    assert not seen(result(one_fall(vessel=vessel, bodies=low_load))).levels
    assert not seen(result(one_fall())).levels


def deep():
    """A load 2 km below its crane."""
    load = body("payload", 5000.0, (12.4, 0.0, -2000.0))
    return result(one_fall(bodies=[load], water={"surface": -5, "density": 1025}), frames=5)


def test_the_view_of_the_crane_cuts_off_a_rope_to_a_load_far_below():
    shown = seen(deep(), view="crane")
    check(shown)
    line, whole = shown.lines[0], seen(deep()).lines[0]
    assert line.points(0)[:, 2].min() > -20.0 > whole.points(0)[:, 2].min()
    # What is left of it is as it was.
    assert np.array_equal(line.points(3)[:40], whole.points(3)[:40])
    assert np.ptp(shown.extent([0])[:, 2]) < 100.0
    assert solid(shown, "drum winch") and not shown.labels and "payload" not in {one.name for one in shown.solids}


def test_the_view_of_the_load_has_it_alone_with_some_of_its_rope():
    shown = seen(deep(), view="load")
    check(shown)
    line, whole = shown.lines[0], seen(deep()).lines[0]
    assert np.array_equal(line.points(3)[-1], whole.points(3)[-1])
    assert np.all(np.diff(line.points(3)[:, 2]) < 0.0)
    assert {one.name for one in shown.solids} == {"payload", "rigging of payload"} and not shown.levels


@pytest.mark.parametrize("view", ["crane", "load"])
def test_where_the_load_is_near_every_view_is_of_the_whole(view, hoist):
    whole, shown = seen(hoist), seen(hoist, view=view)
    assert [one.name for one in shown.solids] == [one.name for one in whole.solids]
    assert np.array_equal(shown.lines[0].points(0), whole.lines[0].points(0))


def test_a_plane_crane_is_seen_nearly_square_on_and_from_above(hoist):
    eye = np.array(seen(hoist).eye) / np.linalg.norm(seen(hoist).eye)
    assert -eye[1] > 0.85 and eye[0] > 0.2 and eye[2] > 0.1


def test_frames_are_asked_for_without_work(hoist):
    """What a frame returns is a view of an array that was made once."""
    shown = seen(hoist)
    assert shown.lines[0].points(7).base is not None and solid(shown, "drum winch").pose(7).base is not None


def test_an_unknown_view_is_refused_with_those_there_are():
    with pytest.raises(ResultError, match=next(iter(VIEWS))):
        seen(result(one_fall(), frames=1), view="inside")


def test_the_tensions_of_a_sheave_are_told_by_what_their_sides_lead_to():
    """Which side runs on changes with the rope's direction, and what a side leads to does not."""
    of = one_fall()
    made = result(of)
    solid = next(one for one in appearance(made, Look()).solids if one.name.endswith(of.sheaves[0].name))
    told = {one.text: one.values for one in solid.histories if one.unit == "N"}
    i = next(k for k, item in enumerate(of.path) if item is of.sheaves[0])
    sides = {f"tension, side of {of.path[i - 1].name}": (i - 1, 1), f"tension, side of {of.path[i + 1].name}": (i, 0)}
    for text, (span, side) in sides.items():
        np.testing.assert_array_equal(told[text], made["tension"][:, span, side])
    assert not any("running" in text for text in told)
