"""The friction of sheaves that helps a brake hold its load is no more than what a run of the scene shows.

References: Euler-Eytelwein exp(mu theta), the bearing's T_2 - T_1 = mu_b r_b / R |F|, and of n falls with eta at every
sheave m g eta^n (1 - eta) / (1 - eta^n) at the drum. The rope weighs next to nothing.
"""

import math
import re

import numpy as np
import pytest
from references import crane as reference

import tautline
from crane.application import Crane
from crane.assembly.estimates import estimate

MASS, GRAVITY, RADIUS = 6000.0, 9.81, 0.5
WEIGHT = MASS * GRAVITY
ROPE = "{mass_per_length: 0.001, axial_stiffness: 40 MN, damping: 20 ms}"
ENDS = "mesh: {elements_per_span: 1}\nsolver: {step: 10 ms, end: 4 s}\noutput: {interval: 50 ms}\n"
BESIDE, ABOVE = "[0, 0, 20]", "[5, 0, 60]"
"""A drum from which the rope goes round a third of its sheave, and one that it comes down from and hardly touches."""
FREE = "inertia: 5, law: capstan"


DRIVE = "inertia: 100, torque: 0, brake: {torque: 1.0}"


def one_fall(tip, brake, drum=BESIDE):
    return tautline.read(one_fall_text(tip, drum).replace(DRIVE, braked(brake)))


def one_fall_text(tip, drum=BESIDE):
    return f"""
rope: {ROPE}
bodies: [{{name: load, mass: {MASS}, position: [10.3, 0, 0], guide: [x, y]}}]
path:
  - drum: {{name: A, center: {drum}, radius: {RADIUS}, axis: [0, 1, 0], wrap: over, {DRIVE}}}
  - sheave: {{name: tip, center: [10, 0, 30], radius: 0.3, axis: [0, 1, 0], wrap: over, {tip}}}
  - end: {{name: hook, body: load}}
{ENDS}"""


def block(falls, law, ends, end=4.0):
    """A block of an even number of falls between a drum and an anchor, or between two drums, all falls plumb."""
    offset = 0.3 * (falls - 1)
    rows = [
        f"  - drum: {{name: A, center: [-{RADIUS}, 0, 0], radius: {RADIUS}, axis: [0, 1, 0], wrap: over, {ends[0]}}}"
    ]
    for k in range(falls):
        x = 0.6 * k - 0.3
        place = (
            f"body: block, offset: [{x - offset}, 0, 0], wrap: under" if k % 2 else f"center: [{x}, 0, 30], wrap: over"
        )
        rows.append(f"  - sheave: {{name: s{k}, radius: 0.3, axis: [0, 1, 0], {place}, {law}}}")
    x = 0.6 * falls - 0.6
    if ends[1] is None:
        rows.append(f"  - anchor: {{name: dead end, position: [{x}, 0, 30]}}")
    else:
        rows.append(
            f"  - sheave: {{name: last, radius: 0.3, axis: [0, 1, 0], center: [{x + 0.3}, 0, 30], wrap: over, {law}}}"
        )
        center = f"[{x + 0.6 + RADIUS}, 0, 0]"
        rows.append(
            f"  - drum: {{name: B, center: {center}, radius: {RADIUS}, axis: [0, 1, 0], wrap: over, {ends[1]}}}"
        )
    rows[0] = rows[0].replace(f"center: [-{RADIUS}, 0, 0]", f"center: [{-0.6 - RADIUS}, 0, 0]")
    body = f"bodies: [{{name: block, mass: {MASS}, position: [{offset}, 0, 10], guide: [x, y]}}]"
    return tautline.read("\n".join([f"rope: {ROPE}", body, "path:", *rows, ENDS.replace("end: 4 s", f"end: {end} s")]))


def braked(torque):
    return f"inertia: 100, torque: 0, brake: {{torque: {torque}}}"


def told(scene):
    """By drum the torque that it takes, N m, of all that are said not to hold the load."""
    found = [one for one in Crane().warnings(scene) if "does not hold the load" in one.text]
    return {one.where.split(".")[0]: _torque(one.text) for one in found}


def _torque(text):
    number, kilo = re.search(r"it takes ([0-9.]+) (k?)N m", text).groups()
    return float(number) * (1e3 if kilo else 1.0)


def needed(scene):
    (torque,) = told(scene).values()
    return torque


def fallen(scene):
    """How far the load goes down in the second half of the run, m: at first friction comes to bear."""
    height = np.asarray(tautline.simulate(scene)["body_position"])[:, 0, 2]
    return float(height[len(height) // 2] - height[-1])


def wrap(scene, i=1):
    return float(estimate(scene).path.wraps[i])


def sheaves_share(name, angle):
    """Share of the tension that a sheave of `SHEAVES` leaves at the drum, at most."""
    capstan, bearing = reference.capstan_ratio, reference.bearing_efficiency
    return {
        "locked": lambda: 1.0 / capstan(0.12, angle),
        "V groove, locked": lambda: 1.0 / capstan(0.12, angle, math.radians(40.0)),
        "free": lambda: 1.0,
        "free, small bearing": lambda: bearing(0.05, 0.05, 0.3, angle),
        "free, slippery groove": lambda: 1.0 / capstan(0.01, angle),
        "light, small bearing": lambda: bearing(0.2, 0.1, 0.3, angle),
        "light, slippery groove": lambda: 1.0 / capstan(0.01, angle),
        "bearing": lambda: bearing(0.15, 0.25, 0.3, angle),
        "efficiency": lambda: 0.9,
    }[name]()


SHEAVES = {
    "locked": "law: capstan, friction: 0.12, locked: true",
    "V groove, locked": "law: capstan, friction: 0.12, groove: 40 deg, locked: true",
    "free": f"{FREE}, friction: 0.12",
    "free, small bearing": f"{FREE}, friction: 0.12, bearing: {{friction: 0.05, radius: 0.05}}",
    "free, slippery groove": f"{FREE}, friction: 0.01, bearing: {{friction: 0.2, radius: 0.1}}",
    "light, small bearing": "law: capstan, friction: 0.12, bearing: {friction: 0.2, radius: 0.1}",
    "light, slippery groove": "law: capstan, friction: 0.01, bearing: {friction: 0.2, radius: 0.1}",
    "bearing": "law: no_slip, bearing: {friction: 0.15, radius: 0.25}",
    "efficiency": "law: {efficiency: 0.9}",
}


@pytest.mark.parametrize("drum", [BESIDE, ABOVE])
@pytest.mark.parametrize("name", SHEAVES)
def test_the_brake_takes_what_its_sheave_leaves_of_the_weight_by_the_closed_form_of_its_law(name, drum):
    scene = one_fall(SHEAVES[name], 1.0, drum)
    share = sheaves_share(name, wrap(scene))
    assert needed(scene) == pytest.approx(share * WEIGHT * RADIUS, rel=2e-3)


@pytest.mark.parametrize("drum", [BESIDE, ABOVE])
@pytest.mark.parametrize("name", SHEAVES)
def test_a_brake_just_above_that_holds_the_load_in_a_run_and_one_just_below_lets_it_fall(name, drum):
    torque = sheaves_share(name, wrap(one_fall(SHEAVES[name], 1.0, drum))) * WEIGHT * RADIUS
    weak, strong = one_fall(SHEAVES[name], 0.97 * torque, drum), one_fall(SHEAVES[name], 1.01 * torque, drum)
    assert told(weak) and not told(strong)
    assert fallen(weak) > 0.2 and abs(fallen(strong)) < 1e-3


@pytest.mark.parametrize("falls", [2, 4, 16])
def test_a_block_of_n_falls_pulls_at_its_drum_with_less_than_an_nth_but_not_by_the_loss_of_all_its_sheaves(falls):
    eta = 0.9
    exact = WEIGHT * RADIUS * eta**falls * (1.0 - eta) / (1.0 - eta**falls)
    law = f"law: {{efficiency: {eta}}}"
    assert needed(block(falls, law, (braked(1.0), None))) == pytest.approx(exact, rel=2e-3)
    # Of 16 falls with 1 % to spare friction takes 6 s to stop what moved until it came to bear.
    weak, strong = (block(falls, law, (braked(share * exact), None), end=14.0) for share in (0.95, 1.01))
    assert told(weak) and not told(strong)
    assert fallen(weak) > 0.05 / falls and abs(fallen(strong)) < 1e-3


def test_sixteen_falls_over_capstans_that_turn_freely_are_held_by_their_brake_alone():
    scene = block(16, f"{FREE}, friction: 0.1", (braked(0.5 * WEIGHT * RADIUS / 16.0), None))
    assert needed(scene) == pytest.approx(WEIGHT * RADIUS / 16.0, rel=2e-3)
    assert fallen(scene) > 0.2


@pytest.mark.parametrize("other", ["pay_out: 0", braked("100 kN m")])
def test_of_two_drums_only_the_sheaves_up_to_the_block_help_to_hold(other):
    """The way from the drum leads over its tip and the block: T_1 + T_2 = m g, T_2 = T_1 / eta, eta T_1 at the drum."""
    eta = 0.8
    exact = WEIGHT * RADIUS * eta**2 / (1.0 + eta)
    for ends in ((braked(1.0), other), (other, braked(1.0))):
        law = f"law: {{efficiency: {eta}}}"
        assert needed(block(2, law, ends)) == pytest.approx(exact, rel=2e-3)
        weak, strong = (
            block(2, law, [text.replace("torque: 1.0}", f"torque: {share * exact}}}") for text in ends])
            for share in (0.96, 1.01)
        )
        assert told(weak) and not told(strong)
        assert fallen(weak) > 0.1 and abs(fallen(strong)) < 1e-3


def test_two_drums_that_would_each_hold_with_a_strong_one_beside_it_are_told_what_both_lack():
    """The other drum lets its fall have no more than M / (R eta), and the rest of the weight is this one's."""
    eta = 0.8
    alone = WEIGHT * RADIUS * eta**2 / (1.0 + eta)
    each = 1.04 * alone
    law = f"law: {{efficiency: {eta}}}"
    found = told(block(2, law, (braked(each), braked(each))))
    assert sorted(found) == ["path[0]", "path[4]"]
    rest = eta * (WEIGHT * RADIUS - each / 0.98 / eta)
    assert list(found.values()) == pytest.approx([rest, rest], rel=2e-3)
    assert fallen(block(2, law, (braked(each), braked(each)))) > 0.1
    # Half of the weight each, less eta at their tips, holds it; so does one that has the rest.
    both = block(2, law, (braked(0.505 * eta * WEIGHT * RADIUS), braked(0.505 * eta * WEIGHT * RADIUS)))
    one = block(2, law, (braked(1.04 * rest), braked(each)))
    for scene in (both, one):
        assert not told(scene) and abs(fallen(scene)) < 1e-3


@pytest.mark.parametrize("share", [1.01, 1.0, 0.99, 0.981, 0.9804, 0.9803, 0.9801])
def test_what_a_drum_is_to_hold_grows_evenly_as_the_other_comes_to_lack_the_two_percent_that_it_may(share):
    """As the other may hold M / (R eta 0.98) of the weight at most, down to all that it needs beside a strong one."""
    eta = 0.8
    alone = WEIGHT * RADIUS * eta**2 / (1.0 + eta)
    law, weak, other = f"law: {{efficiency: {eta}}}", braked(0.5 * alone), braked(share * alone)
    rest = eta * (WEIGHT * RADIUS - share * alone / 0.98 / eta)
    assert told(block(2, law, (weak, other))) == {"path[0]": pytest.approx(rest, rel=1e-3)}
    assert told(block(2, law, (other, weak))) == {"path[4]": pytest.approx(rest, rel=1e-3)}


def heavy(tip, mass):
    """A load on one fall of rope with kg/m over a sheave of 4 m, which bears a good part of it."""
    text = one_fall_text(tip).replace("mass_per_length: 0.001", f"mass_per_length: {mass}")
    return text.replace("radius: 0.3", "radius: 2").replace("[10.3, 0, 0]", "[12, 0, 0]")


@pytest.mark.parametrize("mass", [5.0, 30.0])
@pytest.mark.parametrize("law", ["law: frictionless", "inertia: 5, law: capstan, friction: 0.1"])
def test_where_no_friction_helps_a_brake_holds_a_heavy_rope_as_it_would_hang_plumb_from_the_drum_down(law, mass):
    """What hangs below the tangent point of the drum: rope on the way up and as much on the way down weigh nothing."""
    text = heavy(law, mass)
    below = float(estimate(tautline.read(text)).path.tangents[0, 0, 2])
    hangs = WEIGHT + mass * GRAVITY * below
    scene = tautline.read(text)
    assert needed(scene) == pytest.approx(hangs * RADIUS, rel=2e-4)
    (one,) = [one for one in Crane().warnings(scene) if "does not hold the load" in one.text]
    assert "with the friction of the sheaves" not in one.text
    # A winch that stands still has that tension in a run, of a rope with elements enough to sag.
    text = text.replace("elements_per_span: 1}", "elements_per_span: 10}")
    winch = tautline.read(text.replace(DRIVE, "pay_out: 0") + "start: static\n")
    assert float(np.asarray(tautline.simulate(winch)["tension"])[-1, 0, 0]) == pytest.approx(hangs, rel=1e-3)


def written_from_its_end(text):
    """The same rope with its path written from the load to the drum."""
    head, rest = text.split("path:\n")
    lines = rest.split("\n")
    return "\n".join([f"{head}path:", *lines[2::-1], *lines[3:]])


def test_a_heavy_rope_on_a_sheave_with_friction_takes_the_same_brake_from_whichever_end_the_path_is_written():
    """dT / dtheta = T ln q / Theta + w: what hangs on the sheave itself grows by (q - 1) / ln q, whichever way."""
    eta, mass = 0.8, 60.0
    text = heavy(f"law: {{efficiency: {eta}}}", mass)
    (a, b), (c, d) = estimate(tautline.read(text)).path.tangents[:, :, 2]
    q = 1.0 / eta
    top = WEIGHT + mass * GRAVITY * (c - d)
    at_drum = (top - mass * GRAVITY * (c - b) * (q - 1.0) / math.log(q)) / q - mass * GRAVITY * (b - a)
    for one in (text, written_from_its_end(text)):
        assert needed(tautline.read(one)) == pytest.approx(at_drum * RADIUS, rel=5e-4)


def two_blocks(near, far, eta):
    """Two blocks of two falls each on one rope from a drum to an anchor, of masses near and far from the drum."""
    wheel = f"radius: 0.3, axis: [0, 1, 0], law: {{efficiency: {eta}}}"
    return tautline.read(f"""
rope: {ROPE}
bodies:
  - {{name: a, mass: {near}, position: [0.3, 0, 5], guide: [x, y]}}
  - {{name: b, mass: {far}, position: [1.5, 0, 5], guide: [x, y]}}
path:
  - drum: {{name: A, center: [-1.1, 0, 0], radius: {RADIUS}, axis: [0, 1, 0], wrap: over, {braked(1.0)}}}
  - sheave: {{name: t, center: [-0.3, 0, 30], wrap: over, {wheel}}}
  - sheave: {{name: ba, body: a, wrap: under, {wheel}}}
  - sheave: {{name: c, center: [0.9, 0, 30], wrap: over, {wheel}}}
  - sheave: {{name: bb, body: b, wrap: under, {wheel}}}
  - anchor: {{name: d, position: [1.8, 0, 30]}}
{ENDS}""")


@pytest.mark.parametrize(("near", "far"), [(5000, 5000), (5000, 4500), (4500, 5000), (5000, 7500), (6000, 5000)])
def test_of_two_blocks_on_one_rope_a_drum_holds_the_one_that_needs_more_of_it(near, far):
    """A block rests where T (1 + q) is its weight; q = 1 / eta a sheave, one before the first block and three before b.

    Both rest there with a up to q times as heavy as b, and b up to q^2 times as heavy as a.
    """
    eta = 0.8
    q = 1.0 / eta
    levels = near * GRAVITY / (q * (1.0 + q)), far * GRAVITY / (q**3 * (1.0 + q))
    assert near < q * far and far < q**2 * near
    assert needed(two_blocks(near, far, eta)) == pytest.approx(RADIUS * max(levels), rel=2e-3)


LIGHT = {
    "a bearing that gives way first": ("friction: 0.1", False),
    "a groove that is slippery": ("friction: 0.01", True),
    "a groove without friction": ("friction: 0", True),
}


def drawn(of, pay_out, inertia=""):
    """A load that a drum draws slowly over a capstan with a bearing."""
    drive = f"pay_out: {{ramp: {{to: {pay_out}, over: 1 s}}}}"
    tip = f"law: capstan, {LIGHT[of][0]}, bearing: {{friction: 0.2, radius: 0.1}}{inertia}"
    return tautline.read(one_fall_text(tip).replace(DRIVE, drive))


@pytest.mark.parametrize("pay_out", [-0.5, 0.5])
@pytest.mark.parametrize("of", LIGHT)
def test_of_a_capstan_without_inertia_groove_or_bearing_gives_way_whichever_is_weaker(of, pay_out):
    stands = LIGHT[of][1]
    light, heavy = (tautline.simulate(drawn(of, pay_out, inertia)) for inertia in ("", ", inertia: 0.001"))
    angle = float(np.asarray(light["wrap_angle"])[-1, 0])
    groove = reference.capstan_ratio(float(LIGHT[of][0].split()[1]), angle)
    ratio = groove if stands else 1.0 / reference.bearing_efficiency(0.2, 0.1, 0.3, angle)
    for result in (light, heavy):
        near, far = np.asarray(result["tension"])[-1, [0, 1], [1, 0]]
        assert (near / far if pay_out < 0.0 else far / near) == pytest.approx(ratio, rel=1e-4)
        turned = abs(float(np.asarray(result["sheave_rotation"])[-1, 0]))
        assert turned < 1e-3 if stands else turned > 1.0
    if of != "a groove without friction":
        assert bool(np.asarray(light["slipping"])[-1, 0]) is stands


@pytest.mark.parametrize("inertia", ["", ", inertia: 5"])
@pytest.mark.parametrize("of", LIGHT)
def test_a_bearing_that_holds_more_than_its_groove_is_said_never_to_act_and_one_that_gives_way_is_not(of, inertia):
    found = [one for one in Crane().warnings(drawn(of, -0.5, inertia)) if one.where.startswith("path[1].sheave")]
    if not LIGHT[of][1]:
        assert found == []
        return
    (one,) = found
    angle = wrap(drawn(of, -0.5))
    groove = reference.capstan_ratio(float(LIGHT[of][0].split()[1]), angle) - 1.0
    bearing = 1.0 / reference.bearing_efficiency(0.2, 0.1, 0.3, angle) - 1.0
    shares = [float(share) for share in re.findall(r"([0-9.]+) %", one.text)]
    assert one.where == "path[1].sheave.bearing" and "never acts" in one.text
    assert shares == pytest.approx([100.0 * groove, 100.0 * bearing], rel=5e-3)


@pytest.mark.parametrize("more", ["", ", bearing: {friction: 0, radius: 0.1}"])
def test_a_capstan_that_neither_inertia_nor_bearing_resists_is_said_to_turn_with_the_rope(more):
    scene = tautline.read(one_fall_text(f"law: capstan, friction: 0.1{more}"))
    (one,) = [one for one in Crane().warnings(scene) if one.where.startswith("path[1].sheave")]
    assert one.where == "path[1].sheave.law" and "nothing resists tip" in one.text
