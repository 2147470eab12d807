"""What things stand on and in: seas, shadows, floors, scales; and that the first camera shows all of a scene."""

import math
import zlib
from base64 import b64decode

import numpy as np
import pytest
from drawn import appearance as by_hand
from figures.synthetic_crane import falls, fixed_rope, one_fall, result
from scipy.optimize import brentq

from crane.assembly.layout import Layout
from crane.results.course import laid_out
from crane.scene.scene import CraneScene
from crane.sea.waves import vessel_waves
from crane.view.appearance import appearance as of_crane
from crane.view.poses import poses_of
from tautline.system.waves import Waves, wave_number
from tautline.view.space.appearance import Appearance, Level, Line, Look, still
from tautline.view.space.scales import grid_pitch, scales
from tautline.view.space.stage import LEGEND, Stage
from tautline.view.space.surroundings import deep, shadow, sun, surfaces
from tautline.view.web.page import Pack, whole_turns

SEA = {"kind": "jonswap", "significant_height": 3.0, "peak_period": 8.0, "seed": 5, "ramp": 20.0}


def at_sea(**motion) -> CraneScene:
    vessel = {"reference": [4.0, -3.0, 0.0], "motion": motion}
    return one_fall(vessel=vessel, water={"surface": -2.0, "density": 1025.0}, solver={"end": "60 s"})


def test_wave_numbers_solve_the_dispersion_relation_in_any_depth():
    w = np.geomspace(0.1, 6.0, 25)
    assert wave_number(w, gravity=9.8) == pytest.approx(w**2 / 9.8)
    for depth in (2.0, 30.0, 400.0):
        # Bracketed and bisected: neither the start nor the slope of Newton's method.
        wanted = [brentq(lambda k, a=a, d=depth: 9.81 * k * math.tanh(k * d) - a * a, 1e-9, 20.0) for a in w]
        assert wave_number(w, depth) == pytest.approx(wanted, rel=1e-9)


def test_the_vessel_heaves_by_its_response_times_the_sea_that_is_drawn_at_its_reference():
    scene = at_sea(heave={"spectrum": SEA | {"rao": -0.4}})
    layout: Layout = laid_out(scene)
    time = np.linspace(0.0, 60.0, 241)
    # The vessel's pose is made of the functions that the run evaluates: other code than the waves that are drawn.
    heave = poses_of(layout, time)["vessel"][:, 2, 3]
    waves = vessel_waves(scene)
    sea = np.array([float(waves.elevation(4.0, -3.0, t)) for t in time])
    assert heave == pytest.approx(-0.4 * sea, abs=1e-9)
    assert np.abs(sea[-80:]).max() > 0.5
    # The significant height of a fully grown sea is four times its standard deviation.
    many = waves.elevation(np.linspace(0.0, 40_000.0, 4001), 0.0, 50.0)
    assert 4.0 * many.std() == pytest.approx(3.0, rel=0.05)


def test_waves_run_in_their_direction_at_the_speed_of_their_phase():
    w, depth = np.array([0.7]), 25.0
    k = wave_number(w, depth)
    way = np.array([math.cos(2.0), math.sin(2.0)])
    waves = Waves(np.array([1.5]), w, np.array([0.3]), k, way, np.array([1.0, 2.0]))
    there = np.array([7.0, -4.0])
    later = there + way * (w[0] / k[0]) * 3.7
    assert float(waves.elevation(*later, 13.7)) == pytest.approx(float(waves.elevation(*there, 10.0)), abs=1e-12)
    aside = there + 50.0 * np.array([-way[1], way[0]])
    assert float(waves.elevation(*aside, 10.0)) == pytest.approx(float(waves.elevation(*there, 10.0)), abs=1e-12)


@pytest.mark.parametrize("motion", [{"heave": {"harmonic": {"amplitude": 0.5, "period": 8}}}, {}])
def test_a_sea_that_nobody_gave_is_not_made_up(motion):
    assert vessel_waves(at_sea(**motion)) is None


def test_the_mesh_of_a_sea_has_its_height_where_things_are_and_is_level_at_its_edge():
    waves = vessel_waves(at_sea(heave={"spectrum": SEA}))
    seen = np.array([[-10.0, -5.0, -20.0], [25.0, 5.0, 30.0]])
    (surface,) = surfaces(Appearance("sea", np.zeros(1), levels=(Level("water", -2.0, waves=waves),)), seen)
    heights = surface.heights(40.0)
    middle = np.hypot(*(surface.points[:, :2] - [7.5, 0.0]).T) < 20.0
    assert middle.sum() > 50
    wanted = -2.0 + waves.elevation(*surface.points[middle, :2].T, 40.0)
    assert heights[middle] == pytest.approx(wanted)
    assert np.all(heights[surface.fade == 0.0] == -2.0)


@pytest.mark.parametrize("x", [0.5, 60.0, 1000.0])
@pytest.mark.parametrize("period", [2.0, 7.0])
def test_water_is_drawn_where_it_is_at_a_load_far_from_where_the_phases_hold(x, period):
    w = np.array([2.0 * math.pi / period])
    waves = Waves(np.array([1.5]), w, np.array([0.3]), wave_number(w), np.array([0.6, 0.8]), np.zeros(2))
    for side in (-18.0, 0.0, 18.0):
        # A picture 36 m wide, with the load at either end of it, or in the middle.
        seen = np.array([[x - 18.0, -5.0, -4.0], [x + 18.0, 5.0, 20.0]])
        (surface,) = surfaces(Appearance("sea", np.zeros(1), levels=(Level("water", 0.0, waves=waves),)), seen)
        off = np.hypot(*(surface.points[:, :2] - [x + side, 2.0]).T)
        nearest = int(off.argmin())
        there = surface.points[nearest]
        assert off[nearest] < 1.0
        # Airy's surface, written out.
        k = (2.0 * math.pi / period) ** 2 / 9.81
        wanted = 1.5 * math.sin(w[0] * 14.0 + 0.3 - k * (0.6 * there[0] + 0.8 * there[1]))
        assert surface.heights(14.0)[nearest] == pytest.approx(wanted, abs=1e-9)


WAVY = {"elevation": {"harmonic": {"amplitude": 1.0, "period": 8.0}}}
FLOWS = {"current": {"speed": 0.5}}


@pytest.mark.parametrize(("water", "motion", "said"), [
    ({"waves": WAVY}, {}, "waves act on bodies with a height; forces on the rope are those of still water"),
    ({"waves": WAVY} | FLOWS, {}, "waves act on bodies with a height; forces on the rope are those of the current"),
    ({}, {"heave": {"spectrum": SEA}}, "of the vessel's motion; forces on rope and load are those of still water"),
    (FLOWS, {"heave": {"spectrum": SEA}}, "forces on rope and load are those of the current without waves"),
])  # fmt: skip
def test_a_picture_says_of_what_water_the_forces_are(water, motion, said, tmp_path):
    load = {"name": "payload", "mass": "20 t", "position": [12, 0, -10], "volume": 1.0, "height": 2.0, "bottom": 1.0}
    load |= {"drag": {"quadratic": [900, 900, 900]}}
    vessel = {"reference": [4.0, -3.0, 0.0], "motion": motion}
    water = {"surface": -2.0, "density": 1025.0, **water}
    scene = one_fall(bodies=[load], vessel=vessel, water=water, solver={"end": "60 s"})
    (note,) = [one for one in of_crane(result(scene, tmp_path / "run.nc", 5), Look()).notes if "waves" in one]
    assert said in note


def test_a_shadow_falls_along_the_sun_onto_its_level():
    light = sun((0.9, -1.0, 0.3))
    assert np.linalg.norm(light) == pytest.approx(1.0)
    # Behind the left shoulder of who looks along (-0.9, 1): towards the eye, and to its left.
    assert light[:2] @ [0.9, -1.0] > 0.0 and light[:2] @ [-1.0, -0.9] > 0.0 and light[2] > 0.6
    points = np.random.default_rng(1).uniform(-5.0, 5.0, (20, 3))
    flat = shadow(light, -7.0)
    fallen = points @ flat[:3, :3].T + flat[:3, 3]
    assert fallen[:, 2] == pytest.approx(-7.0)
    assert np.cross(points - fallen, light) == pytest.approx(0.0, abs=1e-12)


def test_a_floor_is_drawn_where_there_is_no_ground_and_nowhere_else():
    points = np.array([[0.0, 0.0, -3.0], [4.0, 0.0, 7.0]])
    bare = Appearance("bare", np.zeros(1))
    assert bare.base(points) == pytest.approx(-3.1)
    assert Appearance("well", np.zeros(1), floor=False).base(points) is None
    assert Appearance("sea", np.zeros(1), levels=(Level("water", 0.0),)).base(points) is None
    ground = Level("ground", -9.0, opacity=0.9)
    assert Appearance("both", np.zeros(1), levels=(Level("water", 0.0), ground)).base(points) == -9.0
    assert [one.level.name for one in surfaces(bare, points)] == ["floor"]


def test_of_deep_water_a_patch_is_drawn_and_of_shallow_water_all():
    points = np.array([[0.0, 0.0, -900.0], [60.0, 0.0, 40.0]])
    assert deep(Level("water", 0.0), points)
    assert not deep(Level("water", -500.0), points) and not deep(Level("ground", 0.0, opacity=1.0), points)


def test_a_scale_of_heights_stands_to_the_left_with_round_numbers():
    points = np.array([[-3.0, 0.0, -4.0], [5.0, 2.0, 31.0]])
    (ruler,) = scales(Appearance("bare", np.zeros(1), eye=(0.0, -1.0, 0.2)), points)
    assert ruler.unit == "m" and ruler.points[:, 2] == pytest.approx(ruler.numbers)
    assert ruler.points[0, 0] < -3.0 and np.all(ruler.numbers % 5.0 == 0.0) and len(ruler.numbers) >= 4
    own = by_hand()
    assert scales(own, points) == own.rulers
    assert scales(Appearance("level", np.zeros(1)), points * [1.0, 1.0, 1e-3]) == ()
    assert [grid_pitch(size) for size in (8.0, 39.0, 0.5, 2000.0)] == [1.0, 2.0, 0.05, 200.0]


@pytest.mark.parametrize("rate", [1.3, -7.9, 31.0])
def test_whole_turns_are_those_that_were_made_between_pictures(rate):
    time = np.linspace(0.0, 4.0, 401)
    c, s = np.cos(rate * time), np.sin(rate * time)
    zero, one = np.zeros_like(c), np.ones_like(c)
    spin = np.stack([c, -s, zero, s, c, zero, zero, zero, one], axis=-1).reshape(-1, 3, 3)
    frames = np.arange(0, 401, 50)
    turns = whole_turns(spin, frames)
    # The rest, by which a picture would turn without them, is within half a turn; both make up what was turned.
    angle = rate * 0.5
    least = (angle + np.pi) % (2.0 * np.pi) - np.pi
    assert np.sign(least) * (abs(least) + 2.0 * np.pi * turns) == pytest.approx(angle, abs=1e-9)


def read_back(pack: Pack, said: dict) -> np.ndarray:
    """Decimal numbers of a packed array of one column."""
    data = zlib.decompress(b64decode(pack.text()))
    middle = np.frombuffer(data, "<f8", 1, said["at"])[0]
    planes = np.frombuffer(data, np.uint8, 2 * said["rows"], said["at"] + 8).reshape(2, -1).astype(int)
    code = planes[0] + 256 * planes[1]
    change = np.where(code % 2, -(code + 1) // 2, code // 2)
    return (middle + np.cumsum(change) % 65536 - 32767.0) / 10.0 ** said["digits"]


@pytest.mark.parametrize(("spread", "about", "digits"), [(1.0, 0.0, 3), (4e3, 5e6, 0), (1e-4, 2.0, 7), (30.0, -7.0, 2)])
def test_numbers_read_back_are_those_that_python_writes_to_the_digit(spread, about, digits):
    values = np.random.default_rng(8).normal(size=400) * spread + about
    # Halves of a digit: as binary numbers they are a little more or less, which is what decides.
    values = np.concatenate([values, about + (np.arange(40) + 0.5) * 10.0**-digits])
    pack = Pack(np.arange(len(values)))
    said = pack.decimals(values[:, None], digits)
    assert said["digits"] == digits
    assert read_back(pack, said).tolist() == [float(f"{value:.{digits}f}") for value in values]


def test_of_numbers_that_span_too_much_fewer_digits_are_stored():
    values = np.linspace(-1.0, 1.0, 50)[:, None]
    pack = Pack(np.arange(50))
    said = pack.decimals(values, 6)
    assert said["digits"] == 4
    assert read_back(pack, said).tolist() == [float(f"{value:.4f}") for value in values[:, 0]]


def test_a_load_that_falls_tells_nothing_of_what_is_left_on_the_hook():
    body = {"name": "payload", "mass": "5 t", "position": [12.4, 0, 5], "release": {"at": 4.0, "remaining": "1 t"}}
    run = result(one_fall(bodies=(body,)), frames=201)
    solids = {one.name: one for one in of_crane(run, Look()).solids}
    box, hook = (solids[name].histories[0].values for name in ("payload", "rigging of payload"))
    gone = run.time >= 4.0
    assert np.isnan(box[gone]).all() and np.array_equal(box[~gone], hook[~gone]) and np.isfinite(hook).all()


def scene_of(name: str):
    """A crane of a kind, or the picture made by hand."""
    made = {"one fall": one_fall, "four falls": lambda: falls(4), "rope": fixed_rope}
    if name == "by hand":
        return by_hand()
    if name == "high rope":
        points = np.linspace([0.0, 0.0, 0.0], [3.0, 0.0, -1500.0], 30)
        return Appearance("deep", np.zeros(1), (Line("rope", still(points), 0.02),), levels=(Level("water", -10.0),))
    return of_crane(result(made[name](), frames=21), Look())


@pytest.mark.parametrize("name", ["one fall", "four falls", "rope", "by hand", "high rope"])
@pytest.mark.parametrize("size", [(640, 360), (360, 480)])
def test_the_first_camera_of_a_picture_shows_all_of_the_scene_clear_of_the_legend(name, size):
    drawn = scene_of(name)
    stage = Stage(drawn, size=size, smooth=False)
    try:
        stage.plotter.render()
        renderer = stage.plotter.renderer
        at = []
        for frame in {0, len(drawn.time) // 2, len(drawn.time) - 1}:
            for point in drawn.extent([frame]):
                renderer.SetWorldPoint(*point, 1.0)
                renderer.WorldToDisplay()
                at.append(renderer.GetDisplayPoint())
        x, y, depth = np.array(at).T
        side = LEGEND if stage.shading is not None else 0.0
        assert x.min() >= 0.0 and x.max() <= (1.0 - side) * size[0] + 1.0
        assert y.min() >= 0.0 and y.max() <= size[1] and depth.min() > 0.0 and depth.max() < 1.0
        # And no smaller than need be: either way it takes more than half of the room.
        assert max(np.ptp(x) / ((1.0 - side) * size[0]), np.ptp(y) / size[1]) > 0.5
    finally:
        stage.close()
