"""Ropes over sheaves: tangents, wraps and lengths against closed forms, and paths that no taut rope can take."""

import math

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from crane.geometry.reeving import ReevingError, Wheel, reeve, sigma_of, tangent
from crane.view.rope_outline import outline

Y, Z = (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def sheave(name, center, radius=0.4, wrap="over", axis=Y):
    return Wheel(name, center, axis, radius, wrap)


def point(name, center):
    return Wheel(name, center, Y, 0.0, point=True)


def laid(wheels):
    return reeve(wheels, sigma_of(wheels))


def crane():
    """Two falls: drum, boom tip, moving block, dead end."""
    return [
        sheave("winch", (0, 0, 0), 0.5),
        sheave("boom tip", (12, 0, 30), 0.4),
        sheave("hook", (12.75, 0, 5), 0.35, "under"),
        point("dead end", (13.1, 0, 30)),
    ]


def block(falls, radius=0.35, gap=0.1, height=25.0):
    """Two blocks of sheaves on one axis each, the rope up and down between them, and a dead end plumb above."""
    wheels = [sheave("winch", (-10, 0, 0), 0.5)]
    for k in range(falls):
        z, wrap = (30.0, "over") if k % 2 == 0 else (30.0 - height, "under")
        wheels.append(sheave(f"sheave {k}", (0, k * gap / 2, z), radius, wrap))
    return [
        *wheels,
        point("dead end", (-radius if falls % 2 == 0 else radius, falls * gap / 2, 30 - height * (falls % 2))),
    ]


def spatial(spread=0.3, seed=3):
    """A path whose axes are up to some 20 degrees from parallel, and no two of whose sheaves lie in one plane."""
    random = np.random.default_rng(seed)
    centers = [(0, 0, 0), (9, 0.5, 22), (15, -0.4, 3), (21, 0.3, 19), (27, 0, 2)]
    wraps, radii = ["over", "over", "under", "over", None], [0.6, 0.45, 0.5, 0.3, 0.0]
    wheels = []
    for k, center in enumerate(centers):
        axis = np.array(Y) + spread * random.uniform(-0.6, 0.6, 3)
        wheels.append(Wheel(f"w{k}", center, axis / np.linalg.norm(axis), radii[k], wraps[k], point=k == 4))
    return wheels


def belt(wheels, sigma):
    """Length of a closed belt, and the wraps."""
    path = reeve([*wheels, *wheels[:2]], [*sigma, *sigma[:2]])
    n = len(wheels)
    return sum(s.length for s in path.spans[:n]) + path.arcs[1 : n + 1].sum(), np.roll(path.wraps[1 : n + 1], 1)


def cross_section():
    return [sheave("a", (0, 0, 0), 0.7), sheave("b", (2.0, 0, 1.5), 0.3)]


def test_length_of_an_open_belt():
    length, wraps = belt(cross_section(), (1, 1))
    lean = math.asin(0.4 / 2.5)
    assert length == pytest.approx(2 * math.sqrt(2.5**2 - 0.4**2) + math.pi * 1.0 + 2 * 0.4 * lean, rel=1e-14)
    assert np.allclose(wraps, [math.pi + 2 * lean, math.pi - 2 * lean], atol=1e-14)


def test_length_of_a_crossed_belt():
    length, wraps = belt(cross_section(), (1, -1))
    lean = math.asin(1.0 / 2.5)
    assert length == pytest.approx(2 * math.sqrt(2.5**2 - 1.0) + 1.0 * (math.pi + 2 * lean), rel=1e-14)
    assert np.allclose(wraps, math.pi + 2 * lean, atol=1e-14)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_belt_around_a_square_turns_once(sign):
    corners = [(0, 0, 3), (3, 0, 3), (3, 0, 0), (0, 0, 0)][::sign]
    length, wraps = belt([sheave(f"{k}", c, 0.5) for k, c in enumerate(corners)], [sign] * 4)
    assert np.allclose(wraps, math.pi / 2, atol=1e-14)
    assert length == pytest.approx(12 + math.pi, rel=1e-15)


def test_a_rope_up_to_a_boom_tip_and_down_to_a_block():
    path = laid(crane())
    # The fall runs down on the right of the tip and on the left of the block, which so turns the other way.
    assert list(path.sigma) == [1, 1, -1, 1]
    first = math.sqrt(12**2 + 30**2 - 0.1**2)
    bend = math.pi / 2 + math.atan2(30, 12) - math.asin(0.1 / math.hypot(12, 30))
    assert path.wraps == pytest.approx([0, bend, math.pi, 0], abs=1e-14)
    assert [s.length for s in path.spans] == pytest.approx([first, 25, 25], rel=1e-15)
    assert path.length == pytest.approx(first + 50 + 0.4 * bend + 0.35 * math.pi, rel=1e-15)
    assert path.marks[2] == pytest.approx([0, 0, -1], abs=1e-15)
    assert not path.fleet.any() and not path.warnings


def test_chords_lead_from_mark_to_mark():
    path = laid(crane())
    assert path.chords.sum() == pytest.approx(path.length, rel=1e-15)
    halves = path.arcs / 2
    expected = [s.length + halves[k] + halves[k + 1] for k, s in enumerate(path.spans)]
    assert path.chords == pytest.approx(expected, rel=1e-15)
    assert np.allclose(path.after - path.before, path.sigma * path.wraps, atol=1e-15)


@pytest.mark.parametrize("make", [crane, spatial])
def test_a_span_satisfies_its_equation_to_rounding(make):
    wheels = make()
    path = laid(wheels)
    for k, span in enumerate(path.spans):
        one, two = wheels[k], wheels[k + 1]
        chord = two.center + span.x2 - one.center - span.x1
        assert np.linalg.norm(span.e - chord / np.linalg.norm(chord)) < 4e-16
        assert span.length == pytest.approx(np.linalg.norm(chord), rel=1e-15)
        for wheel, x, sign in ((one, span.x1, path.sigma[k]), (two, span.x2, path.sigma[k + 1])):
            assert np.linalg.norm(x) == pytest.approx(wheel.radius, rel=1e-15)
            assert abs(x @ wheel.axis) < 1e-15 and abs(x @ span.e) < 1e-15
            # The rope runs on as the sheave turns: sigma a x x is along it.
            assert wheel.radius == 0 or sign * np.cross(wheel.axis, x) @ span.e > 0
        assert span.iterations <= 15


def independent(one, two, rho1, rho2, seed):
    """Tangent points by least squares over both places on the rims, from any direction in space."""

    def frame(axis):
        u = np.cross(axis, [0.3, 0.2, 0.9])
        u /= np.linalg.norm(u)
        return u, np.cross(axis, u)

    frames = frame(one.axis), frame(two.axis)

    def ends(angles):
        (u1, v1), (u2, v2) = frames
        return (
            one.center + one.radius * (u1 * math.cos(angles[0]) + v1 * math.sin(angles[0])),
            two.center + two.radius * (u2 * math.cos(angles[1]) + v2 * math.sin(angles[1])),
        )

    def across(angles):
        p, q = ends(angles)
        e = (q - p) / np.linalg.norm(q - p)
        return [e @ (p - one.center), e @ (q - two.center)]

    random = np.random.default_rng(seed)
    while True:
        found = least_squares(across, random.uniform(0, 2 * math.pi, 2), xtol=1e-15, ftol=1e-15, gtol=1e-15)
        p, q = ends(found.x)
        senses = [(np.cross(w.axis, x - w.center) @ (q - p)) * r for w, x, r in ((one, p, rho1), (two, q, rho2))]
        if found.cost < 1e-24 and min(senses) > 0:
            return p, q


@pytest.mark.parametrize("signs", [(1, 1), (1, -1), (-1, 1), (-1, -1)])
def test_fleet_angles_agree_with_an_independent_search(signs):
    a1, a2 = np.array([0.2, 1.0, -0.1]), np.array([-0.6, 0.7, 0.3])
    one = sheave("one", (0, 0, 0), 0.8, axis=a1 / np.linalg.norm(a1))
    two = sheave("two", (3, 0.6, 2.5), 0.5, axis=a2 / np.linalg.norm(a2))
    rho1, rho2 = signs[0] * 0.8, signs[1] * 0.5
    span = tangent(one.center, one.axis, rho1, two.center, two.axis, rho2)
    p, q = independent(one, two, rho1, rho2, 5)
    assert span.x1 == pytest.approx(p - one.center, abs=1e-8)
    assert span.x2 == pytest.approx(q - two.center, abs=1e-8)
    fleet = reeve([one, two], signs).fleet[0]
    e = (q - p) / np.linalg.norm(q - p)
    assert fleet == pytest.approx([math.asin(e @ one.axis), math.asin(e @ two.axis)], abs=1e-8)
    assert np.abs(fleet).max() > 0.05


def test_fleet_angle_of_a_rope_to_a_point_off_the_sheave_s_plane():
    path = reeve([sheave("drum", (0, 0, 0), 0.5), point("hook", (1.3, 0.9, 0))], (1, 1))
    assert path.fleet[0, 0] == pytest.approx(math.atan2(0.9, 1.2), rel=1e-14)
    assert path.length == pytest.approx(1.5, rel=1e-15)


def moved(wheels, motion, shift):
    return [
        Wheel(w.name, motion.apply(w.center) + shift, motion.apply(w.axis), w.radius, w.wrap, w.point) for w in wheels
    ]


def in_one_plane():
    motion = Rotation.from_rotvec([0.4, -0.8, 0.3])
    centers = [(0, 0, 0), (9, 0, 22), (15, 0, 3), (21, 0, 19), (27, 0, 2)]
    kinds = [
        point("a", centers[0]),
        *(sheave(f"{k}", centers[k], 0.3 + 0.1 * k) for k in (1, 2, 3)),
        point("b", centers[4]),
    ]
    return moved(kinds, motion, np.array([3.0, -2.0, 5.0])), [1, 1, -1, 1, 1], motion


def test_length_changes_as_the_envelope_rule_says():
    """Tangent points move as centres do, but shift no length: d(length) = sum e.(dc2 - dc1)."""
    wheels, sigma, motion = in_one_plane()
    path = reeve(wheels, sigma)
    random = np.random.default_rng(1)
    for _ in range(10):
        way = [motion.apply(random.normal(size=3) * (1, 0, 1)) for _ in wheels]
        rule = sum(s.e @ (way[k + 1] - way[k]) for k, s in enumerate(path.spans))
        assert slope_of_length(wheels, sigma, way)[0] == pytest.approx(rule, abs=1e-8)


def slope_of_length(wheels, sigma, way, h=1e-5):
    """Derivatives of the length and of each span's angles about both axes, by central differences of fourth order."""
    paths = {}
    for k in (-2, -1, 1, 2):
        shifted = [
            Wheel(w.name, w.center + k * h * d, w.axis, w.radius, w.wrap, w.point)
            for w, d in zip(wheels, way, strict=True)
        ]
        paths[k] = reeve(shifted, sigma)

    def slope(value):
        return (8 * (value(paths[1]) - value(paths[-1])) - value(paths[2]) + value(paths[-2])) / (12 * h)

    turns = []
    for k in range(len(wheels) - 1):
        for wheel in (wheels[k], wheels[k + 1]):
            w = np.cross(slope(lambda p, k=k: p.spans[k].e), wheel.axis)
            e = np.cross(wheel.axis, np.cross(paths[1].spans[k].e, wheel.axis))
            turns.append(w @ e / (e @ e))
    return slope(lambda p: p.length), np.array(turns).reshape(-1, 2)


def test_in_space_the_envelope_rule_lacks_what_the_fleet_angle_takes():
    wheels = spatial()
    wheels[0] = point("anchor", wheels[0].center)
    sigma = sigma_of(wheels)
    path = reeve(wheels, sigma)
    way = np.random.default_rng(2).normal(size=(len(wheels), 3))
    length, turns = slope_of_length(wheels, sigma, way)
    rule = sum(s.e @ (way[k + 1] - way[k]) for k, s in enumerate(path.spans))
    rho = sigma * [w.radius for w in wheels]
    rest = ((1 - np.cos(path.fleet)) * turns * np.array([rho[:-1], -rho[1:]]).T).sum()
    assert abs(rest) > 1e-5
    assert length == pytest.approx(rule + rest, abs=1e-8)


@pytest.mark.parametrize("make", [crane, spatial, lambda: block(4)])
def test_a_path_reversed_with_all_senses_is_the_same_path(make):
    wheels = make()
    path, back = laid(wheels), laid(wheels[::-1])
    assert np.array_equal(back.sigma[::-1][1:-1], -path.sigma[1:-1])
    assert back.length == pytest.approx(path.length, rel=1e-15)
    assert np.allclose(back.wraps[::-1], path.wraps, atol=1e-14)
    assert np.allclose(back.tangents[::-1, ::-1], path.tangents, atol=1e-13)
    assert np.allclose(back.fleet[::-1, ::-1], -path.fleet, atol=1e-14)
    assert np.allclose(back.chords[::-1], path.chords, atol=1e-13)


@pytest.mark.parametrize("make", [crane, spatial, lambda: block(4)])
def test_a_path_moved_and_turned_is_the_same_path(make):
    motion, shift = Rotation.from_rotvec([1.1, 0.4, -2.0]), np.array([120.0, -30.0, 55.0])
    path, other = (
        laid(make()),
        reeve(moved(make(), motion, shift), sigma_of(moved(make(), motion, shift), motion.apply(Z))),
    )
    assert np.array_equal(other.sigma, path.sigma)
    assert np.allclose(other.wraps, path.wraps, atol=1e-13) and np.allclose(other.fleet, path.fleet, atol=1e-13)
    assert other.length == pytest.approx(path.length, rel=1e-14)
    assert np.allclose(
        other.tangents, motion.apply(path.tangents.reshape(-1, 3)).reshape(path.tangents.shape) + shift, atol=1e-12
    )
    assert np.allclose(other.marks[:-1], motion.apply(path.marks)[:-1], atol=1e-13)


@pytest.mark.parametrize("make", [crane, spatial])
def test_sheaves_of_vanishing_radius_are_points(make):
    wheels = make()

    def shrunk(radius):
        return [Wheel(w.name, w.center, w.axis, 0.0 if w.point else radius, w.wrap, w.point) for w in wheels]

    small, none = laid(shrunk(1e-9)), laid(shrunk(0.0))
    centers = np.array([w.center for w in wheels])
    assert none.length == pytest.approx(np.linalg.norm(np.diff(centers, axis=0), axis=1).sum(), rel=1e-15)
    assert small.length == pytest.approx(none.length, abs=1e-8)
    assert np.array_equal(small.sigma[1:], none.sigma[1:])
    assert np.allclose(small.wraps, none.wraps, atol=1e-8) and np.allclose(
        small.marks[1:-1], none.marks[1:-1], atol=1e-8
    )


def test_sixteen_falls_between_two_blocks():
    path = laid(block(16))
    fall = math.hypot(25, 0.05)
    assert list(path.sigma) == [1] * 18
    assert np.allclose(path.wraps[2:-1], math.pi, atol=1e-14)
    assert [s.length for s in path.spans[1:-1]] == pytest.approx([fall] * 15, rel=1e-15)
    assert path.length == pytest.approx(
        path.chords[0] + path.arcs[1] / 2 + 15 * (fall + 0.35 * math.pi) + path.spans[-1].length, rel=1e-14
    )
    assert np.allclose(np.abs(path.fleet[1:-1]), math.asin(0.05 / fall), atol=1e-15)
    assert not path.warnings


def test_closed_form_of_parallel_axes_needs_no_iterations():
    assert max(s.iterations for s in laid(block(16)).spans) <= 2


# Which way round: --------------------------------------------------------------------------------------------------


SIDES = {
    "hoist": ([("over", 0, 0, 0.5), ("over", 12, 30, 0.4)], (12.4, 5), [1, 1, 1]),
    "landing": ([("over", 0, 0, 1.2), ("over", 59.2, 25, 0.8)], (60, -1975), [1, 1, 1]),
    "slewing": ([("over", 0.5, 0, 0.3), ("over", 7.8, 6, 0.2)], (8, -9), [1, 1, 1]),
    "underwound": ([("under", 0, 0, 0.5), ("over", 12, 30, 0.4)], (12.4, 5), [-1, 1, 1]),
    "plumb under a drum": ([("over", 0, 0, 0.5)], (0.5, -20), [1, 1]),
    "plumb on the other side": ([("over", 0, 0, 0.5)], (-0.5, -20), [-1, 1]),
    "nearly plumb": ([("over", 0, 0, 0.5)], (0.45, -20), [1, 1]),
    "over a sheave in line": ([("over", 0, 0, 0.5), ("over", 10, 0, 0.5)], (20, 0.1), [1, 1, 1]),
    "under a sheave in line": ([("over", 0, 0, 0.5), ("under", 10, 0, 0.5)], (20, 0.1), [1, -1, 1]),
}


@pytest.mark.parametrize("case", SIDES)
def test_a_rope_runs_round_each_wheel_as_it_was_drawn_and_the_other_way_in_a_mirror(case):
    items, (x, z), expected = SIDES[case]
    wheels = [sheave(f"{k}", (cx, 0, cz), r, wrap) for k, (wrap, cx, cz, r) in enumerate(items)]
    wheels.append(point("hook", (x, 0, z)))
    assert list(sigma_of(wheels)) == expected
    mirrored = [Wheel(w.name, w.center, -w.axis, w.radius, w.wrap, w.point) for w in wheels]
    assert list(sigma_of(mirrored)) == [-s for s in expected[:-1]] + [1]


@pytest.mark.parametrize("wrap", ["over", "under"])
def test_a_bend_level_with_the_centre_has_one_sense_whatever_its_side_is_called(wrap):
    path = laid([point("a", (0, 0, 10)), sheave("tip", (5, 0, 0), wrap=wrap), point("b", (0, 0, -10))])
    assert path.sigma[1] == 1 and path.marks[1] == pytest.approx([1, 0, 0], abs=1e-14)


@pytest.mark.parametrize("axis", [Z, (0, 0, -1), (0.1, 0, math.sqrt(0.99))])
@pytest.mark.parametrize(("wrap", "y"), [("right", 9), ("left", -9)])
def test_left_and_right_of_the_travel_about_an_upright_axis(wrap, y, axis):
    """A rope that bends to the left, as seen from above, has the sheave on its left: it passes right of its centre."""
    wheels = [point("a", (0, 0, 0)), sheave("deflector", (12, 0, 0), 0.3, wrap, axis), point("b", (13, y, 0))]
    path = laid(wheels)
    about_up = path.sigma[1] * np.sign(axis[2])
    assert about_up == (1 if wrap == "right" else -1)
    assert path.wraps[1] < math.pi
    assert path.marks[1] @ (0, 1, 0) * (1 if wrap == "right" else -1) < 0


def test_left_and_right_are_swapped_for_the_rope_run_backwards():
    wheels = [point("a", (0, 0, 0)), sheave("deflector", (12, 0, 0), 0.3, "right", Z), point("b", (13, 9, 0))]
    back = [wheels[2], sheave("deflector", (12, 0, 0), 0.3, "left", Z), wheels[0]]
    assert sigma_of(wheels)[1] == -sigma_of(back)[1] == 1


@pytest.mark.parametrize("seed", range(20))
def test_sides_of_a_path_tell_its_senses(seed):
    """A rope of bends below half a turn, with the sides its contacts lie on, gives back the senses it was laid with."""
    random = np.random.default_rng(seed)
    while True:
        n = random.integers(3, 7)
        centers = [
            (4.0 * k + random.uniform(-1, 1), random.uniform(-0.2, 0.2), random.uniform(-6, 6)) for k in range(n)
        ]
        wheels = [sheave(f"{k}", c, random.uniform(0.1, 1.0)) for k, c in enumerate(centers)]
        wheels[0], wheels[-1] = point("a", centers[0]), point("b", centers[-1])
        sigma = random.choice([-1, 1], n)
        sigma[[0, -1]] = 1
        try:
            path = reeve(wheels, sigma)
        except ReevingError:
            continue
        if (path.wraps < 0.95 * math.pi).all() and (np.abs(path.marks[1:-1, 2]) > 0.05).all():
            break
    sides = ["over" if m[2] > 0 else "under" for m in path.marks]
    told = [Wheel(w.name, w.center, w.axis, w.radius, s, w.point) for w, s in zip(wheels, sides, strict=True)]
    assert np.array_equal(sigma_of(told), sigma)


# Refused: ----------------------------------------------------------------------------------------------------------


WINCH, HOOK = sheave("winch", (0, 0, 0), 0.5), point("hook", (12.4, 0, 5))
REFUSED = {
    "overlapping": ([WINCH, sheave("tip", (0.6, 0, 0.1), 0.3), HOOK], 0, ["'winch' and 'tip' overlap", "0.8 m"]),
    "one within the other": ([WINCH, sheave("tip", (0.1, 0, 0.1), 0.3), HOOK], 0, ["'winch'", "'tip'", "inside"]),
    "too close to cross": ([WINCH, sheave("tip", (0.6, 0, 0), 0.3, "under"), HOOK], 0, ["'winch'", "'tip'", "overlap"]),
    "side by side on one axis": ([WINCH, sheave("tip", (0, 1, 0), 0.5), HOOK], 0, ["'winch'", "'tip'"]),
    "hook within its sheave": ([WINCH, sheave("tip", (12.3, 0, 5.2), 0.4), HOOK], 1, ["'hook'", "inside 'tip'"]),
    "hook on the drum": ([WINCH, point("hook", (0.2, 0, -0.3))], 0, ["'hook'", "inside 'winch'"]),
    "two points at one place": ([point("a", (1, 2, 3)), point("b", (1, 2, 3))], 0, ["'a'", "'b'", "one place"]),
    "under where it bends over": ([WINCH, sheave("tip", (12, 0, 30), wrap="under"), HOOK], 1, ["'tip'", "write over"]),
    "past a sheave it does not reach": (
        [point("a", (0, 0, 0)), sheave("tip", (10, 0, 0.6), 0.5, "under"), point("b", (20, 0, 0))], 1,
        ["'tip'", "cannot pass under"],
    ),
    "left of a post that it bends left around": (
        [point("a", (0, 0, 0)), sheave("post", (12, 0, 0), 0.3, "left", Z), point("b", (13, 9, 0))], 1,
        ["'post'", "left of", "write right"],
    ),
    "over about an upright axis": ([WINCH, sheave("post", (12, 0, 0), 0.3, "over", Z), HOOK], 1, ["'post'", "upright"]),
    "left about a level axis": ([WINCH, sheave("tip", (12, 0, 30), 0.3, "left"), HOOK], 1, ["'tip'", "level"]),
    "no side": ([WINCH, sheave("tip", (12, 0, 30), 0.3, None), HOOK], 1, ["'tip'", "no side"]),
    "another side": ([WINCH, sheave("tip", (12, 0, 30), 0.3, "above"), HOOK], 1, ["'tip'", "'above'"]),
    "hook plumb below the drum's axis": ([WINCH, point("hook", (0, 0, -20))], 0, ["'winch'", "one height"]),
    "a plumb rope past a sheave": (
        [point("a", (0, 0, 10)), sheave("tip", (0, 0, 0)), point("b", (0, 0, -10))], 1, ["'tip'", "level"],
    ),
    "both senses equal": (
        [point("a", (0, 0, 10)), sheave("block", (0, 0, 0), wrap="under"), point("b", (0, 0.1, 10))], 1,
        ["'block'", "either sense"],
    ),
    "an end in the middle": ([WINCH, HOOK, point("far", (20, 0, 0))], 1, ["'hook'", "between"]),
    "one item": ([WINCH], None, ["two items"]),
    "no number": ([WINCH, point("hook", (math.nan, 0, 0))], 1, ["'hook'", "finite"]),
    "a long axis": ([WINCH, sheave("tip", (12, 0, 30), axis=(0, 2, 0)), HOOK], 1, ["'tip'", "unit vector"]),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_a_path_is_refused_for(case):
    wheels, index, words = REFUSED[case]
    with pytest.raises(ReevingError) as refused:
        laid(wheels)
    assert refused.value.index == index
    assert refused.value.cure and str(refused.value).endswith(refused.value.cure)
    for word in words:
        assert word in str(refused.value)


def test_sheaves_that_cut_into_each_other_askew_are_refused():
    askew = sheave("tip", (0.45, 0, 0.5), 0.5, axis=(0.28, 0.96, 0))
    assert tangent(WINCH.center, WINCH.axis, 0.5, askew.center, askew.axis, 0.5).length > 0.5
    with pytest.raises(ReevingError, match="'winch' and 'tip' overlap"):
        reeve([WINCH, askew, HOOK], (1, 1, 1))
    clear = sheave("tip", (0.45, 0.3, 0.5), 0.5, axis=(0.28, 0.96, 0))
    assert reeve([WINCH, clear, HOOK], (1, 1, 1)).length > 10


def test_a_rope_that_would_not_touch_is_refused_for_given_senses():
    wheels = [point("a", (0, 0, 0)), sheave("tip", (10, 0, 0.6), 0.5), point("b", (20, 0, 0))]
    with pytest.raises(ReevingError, match="'tip' without touching"):
        reeve(wheels, (1, -1, 1))


def test_a_wheel_beside_another_is_in_nobody_s_way():
    wheels = [WINCH, sheave("tip", (0.6, 0.3, 0.1), 0.3), point("hook", (0.9, 0.3, -8))]
    assert laid(wheels).length > 8


def test_a_span_through_a_sheave_is_told_of():
    wheels = [*crane()[:3], point("dead end", (11.7, 0, 35))]
    crossing = reeve(wheels, (1, 1, -1, 1))
    (text,) = crossing.warnings
    assert text.startswith("the rope from 'hook' to 'dead end' runs through 'boom tip', up to ")
    assert "aside along the axis of the sheave" in text
    beside = [*wheels[:2], sheave("hook", (12.75, 0.5, 5), 0.35, "under"), point("dead end", (11.7, 0.5, 35))]
    assert not reeve(beside, (1, 1, -1, 1)).warnings
    assert reeve(beside, (1, 1, -1, 1), thickness=1.2).warnings == crossing.warnings


def test_a_rope_that_crosses_itself_is_told_of():
    wheels = [point("a", (0, 0, 0)), sheave("post", (12, 0, 0), 0.3, "left", Z), point("b", (13, 9, 0))]
    assert "crosses itself" in reeve(wheels, (1, -1, 1)).warnings[0]


# Drawn: ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("make", [crane, spatial])
def test_the_outline_is_as_long_as_the_path(make):
    wheels = make()
    path = laid(wheels)
    line = outline(path, wheels, 400)
    assert line.shape == (2 + 400 * (len(wheels) - 2), 3)
    assert np.linalg.norm(np.diff(line, axis=0), axis=1).sum() == pytest.approx(path.length, rel=1e-6)
    assert np.array_equal(line[0], path.tangents[0, 0]) and np.array_equal(line[-1], path.tangents[-1, 1])
    arc = line[1:401] - wheels[1].center
    assert np.allclose(np.linalg.norm(arc, axis=1), wheels[1].radius, atol=1e-13)
    assert np.allclose(arc @ wheels[1].axis, 0, atol=1e-13)


def test_an_outline_takes_two_samples_at_least():
    path = laid(crane())
    assert len(outline(path, crane(), 2)) == 6
    with pytest.raises(ValueError, match="2 points"):
        outline(path, crane(), 1)


@pytest.mark.parametrize(("crooked", "angle"), [(0, 51.3), (1, 51.3)])
def test_an_axis_in_the_plane_of_the_rope_is_named_with_the_one_that_is_square_to_it(crooked, angle):
    """It was told that the rope has two ways of one length, or one height, and to move what stands right.

    The line from drum to tip, (12, 0, 15), is at acos(12/sqrt(369)) = 51.3 deg to x.
    """
    axes = [[1, 0, 0] if j == crooked else [0, 1, 0] for j in (0, 1)]
    wheels = [
        Wheel("drum", [0, 0, 0], axes[0], 0.4, "over"), Wheel("tip", [12, 0, 15], axes[1], 0.3, "over"),
        Wheel("hook", [12.3, 0, 4], [0, 1, 0], 0.0, point=True),
    ]  # fmt: skip
    with pytest.raises(ReevingError) as error:
        sigma_of(wheels)
    name, other = ("drum", "tip") if crooked == 0 else ("tip", "drum")
    assert error.value.index == crooked and error.value.cure == "write axis: [0, 1, 0]"
    assert f"the axis of '{name}' is at {angle:g} deg to the line to '{other}'" in error.value.message


def test_where_no_axis_makes_a_path_possible_the_first_cause_stands():
    """A drum right above what it leads to, whose axis is square to the rope."""
    wheels = [Wheel("drum", [0, 0, 10], [0, 1, 0], 0.4, "over"), Wheel("hook", [0, 0, 0], [0, 1, 0], 0.0, point=True)]
    with pytest.raises(ReevingError, match="at one height in both senses"):
        sigma_of(wheels)
