"""What is said of a string that is pushed beyond its buckling limit where nothing shows that it buckles.

The limit of a vertical hole is 2.55 (EI w^2)^(1/3) (J. Wu, H. C. Juvkam-Wold and R. Lu, 1993). A block that is lowered
on a bottom that is not drilled presses string and rock together, as two springs: the weight grows by way/(L/EA + 1/k).
"""

import numpy as np
import pytest
from physics.wells.strings import GRAVITY

import tautline
from drillstring.drilling.end_groups import turns
from drillstring.model.build import build
from drillstring.model.prepared import prepared
from drillstring.results.unseen_buckling import told_of_a_run
from drillstring.scene.scene import DrillstringScene
from drillstring.warnings import warnings

DEPTH, COLLARS, E, ROCK, WAY, WEIGHT = 1000.0, 160.0, 206e9, 2.5e7, 0.15, 20e3
PIPE, COLLAR = (0.127, 0.1086), (0.1651, 0.0714)
SCENE = """
title: pushed by the block
well: {{sections: [{{hold: 1000 m}}], diameter: 8.5 in, inclination: {lean}, wall: {{stiffness: 1.0e9, friction: 0.2}}}}
string:
  - {{name: pipe, length: rest, od: 127 mm, id: 108.6 mm}}
  - {{name: collar, length: 160 m, od: 165.1 mm, id: 71.4 mm{collar}}}
material: {{youngs_modulus: 206 GPa, shear_modulus: 79 GPa, density: 7850}}
mud: {{density: 1200}}
damping: {{translation: 100, structural: 2 ms}}
bit: {{on_bottom: true, weight: 20 kN, torque: {{static: 2 kN m, kinetic: 2 kN m}}, rock: {{stiffness: 2.5e7}}{bit}}}
top: {{rotation: 60 rpm, block: {block}}}
model: {{kind: {kind}, elements: {elements}}}
solver: {{method: generalized-alpha, rho_inf: 0.5, step: 5 ms, end: 8 s}}
output: {{interval: 50 ms{output}}}
"""
LOWERED = "{ramp: {to: 0.15 m, over: 5 s}}"


def scene(**changed):
    usual = {"collar": "", "bit": "", "kind": "lumped", "elements": 10, "output": "", "block": LOWERED, "lean": "0 deg"}
    return DrillstringScene.parse(SCENE.format(**usual | changed))


def area(tube):
    return np.pi / 4.0 * (tube[0] ** 2 - tube[1] ** 2)


def pushed():
    """Weight on bit behind the block's way, N."""
    give = (DEPTH - COLLARS) / (E * area(PIPE)) + COLLARS / (E * area(COLLAR)) + 1.0 / ROCK
    return WEIGHT + WAY / give


def limit():
    rigidity = E * np.pi / 64.0 * (COLLAR[0] ** 4 - COLLAR[1] ** 4)
    return 2.55 * np.cbrt(rigidity * ((7850.0 - 1200.0) * GRAVITY * area(COLLAR)) ** 2)


def kilonewtons(text, before):
    return 1e3 * float(text.split(before)[1].split(" kN")[0])


def said_of(result):
    return [one for one in result.attributes["warnings"] if "The run does not show" in one]


def checked(given):
    return [one for one in warnings(given) if "buckle" in one.text]


@pytest.mark.parametrize("kind", ["lumped", "ale-ancf"])
def test_a_run_that_pushes_its_string_beyond_the_limit_says_section_time_place_tension_and_limit(kind):
    (said,) = said_of(tautline.simulate(scene(kind=kind)))
    assert said.startswith("collar is compressed by up to")
    assert -kilonewtons(said, "its tension is ") == pytest.approx(pushed(), rel=2e-3)
    assert kilonewtons(said, "Beyond ") == pytest.approx(limit(), rel=1e-3)
    assert "kN at 1000 m and t = 5" in said


def test_results_that_keep_statistics_and_steps_from_python_say_it_too():
    kept = scene(output=", keep: statistics")
    assert len(said_of(tautline.simulate(kept))) == 1
    simulation = tautline.Simulation(scene())
    simulation.advance(6.0)
    assert len(said_of(simulation.result)) == 1


def test_check_judges_the_weight_to_which_the_block_leads_by_the_rule_for_the_weight_on_bit():
    told = [one for one in checked(scene()) if "It compresses" in one.text]
    as_written = scene(block="0 m").model_copy()
    bit = as_written.bit.model_copy(update={"weight": pushed()})
    same = [one for one in checked(as_written.model_copy(update={"bit": bit})) if "at rest" in one.text]
    assert [one.where for one in told] == ["top.block"] and [one.where for one in same] == ["bit.weight"]
    assert kilonewtons(told[0].text, "weight on bit of ") == pytest.approx(pushed(), rel=1e-3)
    assert told[0].text.split("It ")[1].startswith(same[0].text.split(". To see it")[0])


def test_check_judges_the_weight_that_a_block_faster_than_its_bit_makes_within_the_run():
    """Drilled in proportion to the weight: dW/dt = K (v - c W), so that W = W_0 (3 - 2 exp(-K c t)) at three times."""
    faster, own = "{velocity: 60 m/h}", ", penetration: {rate: 20 m/h, speed: 60 rpm}"
    spring, end = (pushed() - WEIGHT) / WAY, 20.0
    grown = WEIGHT * (3.0 - 2.0 * np.exp(-spring * 20.0 / 3600.0 / WEIGHT * end))
    long = scene(block=faster, bit=own).replace({"solver.end": end})
    told = [one for one in checked(long) if one.where == "top.block"]
    assert kilonewtons(told[0].text, "weight on bit of ") == pytest.approx(grown, rel=2e-3)
    assert not checked(scene(block=faster, bit=own).replace({"solver.end": 2.0})), "it has not come that far by then"
    assert not checked(scene(block="{velocity: 20 m/h}", bit=own))


@pytest.mark.parametrize(
    "block", ["0 m", "{ramp: {to: 30 mm, over: 5 s}}", "{velocity: {ramp: {to: -20 m/h, over: 5 s}}}"]
)
def test_no_buckling_is_told_of_a_threshold_that_a_block_held_raised_or_lowered_a_little_does_not_reach(block):
    dull = ", penetration: {rate: 20 m/h, speed: 60 rpm, threshold: 90 kN, weight: 200 kN}"
    assert checked(scene(block=block, bit=dull)) == []


def test_nothing_is_said_of_a_string_below_its_limit_or_of_one_that_the_run_lets_buckle():
    below = scene(block="{ramp: {to: 0.03 m, over: 5 s}}")
    assert not checked(below) and not said_of(tautline.simulate(below))
    shown = scene(collar=", eccentricity: [0, 2 mm], elements: 60", elements=75)
    told = [one for one in checked(shown) if "The run will not" in one.text]
    assert not told and not said_of(tautline.simulate(shown))


def test_a_string_that_is_out_of_the_plane_of_its_hole_may_buckle_and_nothing_is_said_of_the_plane():
    leaning = scene(lean="20 deg", elements=100)
    model, ready = build(leaning), prepared(leaning)
    assert model is not None
    n = ready.lumps.length.size
    for off, there in ((0.0, True), (1e-3, False)):
        across = np.zeros((1, n + 1, 2))
        across[0, 1:, 1] = off  # m2 is east, and the hole goes north
        seen = {"hook_load": np.zeros(1), "tension": np.full((1, n), -1e6), "lateral_displacement": across}
        (said,) = told_of_a_run(Seen(seen), leaning, ready.well, ready.lumps)
        assert ("perfectly straight" in said) == there


ECCENTRIC = dict(collar=", eccentricity: [0, 2 mm], elements: 60", elements=75)


def still(**changed):
    """The scene whose string does not turn."""
    return scene(**changed).replace({"top.rotation": 0.0})


def test_a_string_with_its_mass_off_its_axis_that_does_not_turn_is_pushed_by_nothing_and_is_warned_of():
    """Mass off the axis pushes by its inertia: m e Omega^2, which is nothing at rest."""
    bent = still(**ECCENTRIC)
    result = tautline.simulate(bent)
    across = result["lateral_displacement"][..., 1]
    assert np.abs(across).max() < 1e-9
    (said,) = said_of(result)
    told = [one.text for one in checked(bent) if "The run will not" in one.text]
    for text in (said, *told):
        assert "nothing pushes the string out of it" in text and "let the string turn (`top.rotation`)" in text
        assert "or give the hole its survey" in text and "give string[1] an `eccentricity`" not in text
    assert told


def test_the_cure_of_a_string_in_its_plane_is_what_it_lacks_of_eccentricity_and_a_turn():
    bare = scene(collar=", elements: 60", elements=75)
    turning, resting = (next(one.text for one in checked(at) if "It compresses" in one.text or "buckles" in one.text)
                        for at in (bare, bare.replace({"top.rotation": 0.0})))  # fmt: skip
    assert "give string[1] an `eccentricity`" in turning and "let the string turn" not in turning
    assert "give string[1] an `eccentricity`" in resting and "let the string turn" in resting


def frames_of(given, off):
    """What is said of a run whose string is pushed less from frame to frame, and is ``off`` its plane, m, in each."""
    ready = prepared(given)
    n, off = ready.lumps.length.size, np.asarray(off)
    across = np.zeros((off.size, n + 1, 2))
    across[:, 1:, 1] = off[:, None]  # m2 is east, and the hole goes north
    tension = -1e6 * np.linspace(1.0, 0.9, off.size)[:, None] * np.ones(n)
    run = Seen({"hook_load": np.zeros(off.size), "tension": tension, "lateral_displacement": across})
    run.time = np.arange(float(off.size))
    return told_of_a_run(run, given, ready.well, ready.lumps)


def test_a_string_that_leaves_its_plane_after_the_largest_push_buckles_and_one_that_left_it_before_is_warned_of():
    leaning = scene(lean="20 deg", elements=100)
    assert "nothing pushes" not in "".join(frames_of(leaning, [0.0, 0.0, 1e-3]))
    assert "nothing pushes" in frames_of(leaning, [0.0, 0.0, 0.0])[0]
    kept = leaning.replace({"top.block": 0.0})
    ready = prepared(kept)
    n = ready.lumps.length.size
    across = np.zeros((2, n + 1, 2))
    across[0, 1:, 1] = 1e-3
    run = Seen({"hook_load": np.zeros(2), "tension": -1e6 * np.array([[0.5], [1.0]]) * np.ones(n),
                "lateral_displacement": across})  # fmt: skip
    run.time = np.arange(2.0)
    assert "nothing pushes" in told_of_a_run(run, kept, ready.well, ready.lumps)[0]


def test_a_run_that_ends_before_a_string_that_is_pushed_leaves_its_plane_is_to_last_longer():
    (said,) = frames_of(scene(lean="20 deg", elements=100, collar=", eccentricity: [0, 2 mm]"), [0.0, 0.0])
    assert "has not left its plane before the run ends" in said and "let the run last longer (`solver.end`)" in said
    assert "nothing pushes" not in said and "survey" not in said


def test_elements_go_with_either_way_of_pushing_the_string_out_of_its_plane():
    (text,) = [one.text for one in checked(still()) if "It compresses" in one.text]
    cures = text.split("To see it, ")[1].split(". ")
    assert "such as [0, 2 mm], and let the string turn" in cures[0] and cures[0].endswith("or give the hole its survey")
    assert cures[1].startswith("In any case give string[1] `elements: ") and cures[2] == "Or take less force"


def test_what_moves_the_block_from_outside_turns_no_string():
    """Nor is anything told then of the weight that the scene's own way of the block would make."""
    bent = still(**ECCENTRIC)
    assert not turns(bent) and not turns(bent.driven_by(("top.block_speed",)))
    assert turns(bent.driven_by(("top.rotary_speed",)))
    for outside, there in (((), True), (("top.block_speed",), False), (("top.rotary_speed",), False)):
        assert any("nothing pushes" in one.text for one in checked(bent.driven_by(outside))) == there


class Seen(dict):
    """Frames of a run."""

    time = np.zeros(1)
