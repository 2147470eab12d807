"""What turns about a drum lays rope on it or takes it off: what counts rope follows, and what does not is told."""

import re

import numpy as np
import pytest
from physics.lifting.crane_scenes import anchor, body, crane, drum, end, parsed, ran, sheave, stopped

from crane.results.course import contacts_of, course_of, laid_out, scene_of
from crane.results.laid_by_turning import laid_by_turning
from crane.view.rope_line import rope_line
from crane.warnings import describe, figures, warnings
from tautline.integrators.status import Status

RADIUS, OVER, TURN = 0.4, 120.0, 2.0 * np.pi
ROPE = {"mass_per_length": 2.0, "axial_stiffness": 1.0e7, "damping": 1.0e-3, "strain": "engineering", "diameter": 0.02}


def slewing(*turned, elements=1, **of_drum):
    """A load hangs from a boom that slews about the drum by one angle after the other, rad, each within 120 s."""
    path = [
        drum((0.0, 0.0, 20.4), RADIUS, wrap="left", axis=(0, 0, 1), **of_drum),
        sheave((12.0, 0.0, 20.0), RADIUS, frame="boom", name="tip"),
        end("load"),
    ]
    moves = [{"ramp": {"to": angle, "over": OVER, "at": OVER * k}} for k, angle in enumerate(turned)]
    return crane(
        path, [body("load", 2000.0, (12.4, 0.0, 5.0))], rope=ROPE,
        frames=[{"name": "boom", "pivot": [0, 0, 10], "slew": {"sum": moves}}],
        solver={"end": OVER * len(turned), "step": 0.05}, interval=0.25, mesh={"elements_per_span": elements},
    )  # fmt: skip


def slewed(time, *turned):
    """Angle of the ramps' quintics, rad."""
    x = [np.clip(np.asarray(time) / OVER - k, 0.0, 1.0) for k in range(len(turned))]
    return sum(angle * y**3 * (10.0 - 15.0 * y + 6.0 * y * y) for angle, y in zip(turned, x, strict=True))


def course(result):
    return course_of(result, laid_out(scene_of(result)))


def told(scene):
    """Warnings of a scene as text."""
    return [f"{one}" for one in warnings(parsed(scene))]


@pytest.fixture(scope="module")
def unwound():
    return ran(slewing(14.0))


def test_the_lead_angle_is_that_by_which_the_boom_slews(unwound):
    """Beside the radius of the drum 12 m are long: the line turns with the boom."""
    lead = np.asarray(unwound["lead_angle"])[:, 0]
    assert lead == pytest.approx(slewed(unwound["time"], 14.0), abs=0.05)


def test_rope_that_winds_off_a_drum_once_is_bent_once(unwound):
    """A half at the drum, that it leaves, and two at the tip, that it comes to and leaves."""
    assert unwound.headline["max_bending_cycles"]["value"] <= 1.0
    winch, tip = contacts_of(unwound, course(unwound))
    assert winch.off == pytest.approx(-RADIUS * slewed(unwound["time"], 14.0), abs=0.05)
    assert np.abs(np.diff(tip.off)).max() < 0.05


def test_rope_that_winds_off_and_on_again_is_bent_twice_at_most():
    result = ran(slewing(14.0, -14.0))
    assert result.headline["max_bending_cycles"]["value"] <= 2.0


def test_the_drawn_rope_runs_as_fast_as_it_is_wound(unwound):
    """R dphi/dt at most, 15/8 of its mean, with what the slewing tip drags along."""
    line = rope_line(unwound, course(unwound))
    assert np.abs(line.speed).max() < 1.2 * RADIUS * 14.0 / OVER * 15.0 / 8.0
    assert np.all(np.diff(line.material, axis=1) >= -1.0e-9)


@pytest.mark.parametrize("turned", [-3.0, -4.4])
def test_the_middle_of_a_wrap_goes_round_by_half_of_what_one_side_does(turned):
    """The end of the rope is carried about a sheave; on the other side the rope comes from where it came."""
    path = [
        drum((5.0, 0.0, 10.0), RADIUS),
        sheave((0.0, 0.0, 10.0), RADIUS, name="s"),
        anchor((0.2, 0.0, 6.0), name="hook", frame="boom"),
    ]
    scene = crane(
        path, rope=ROPE | {"axial_stiffness": 1.0e5}, gravity=[0, 0, -0.01], mesh={"elements_per_span": 1},
        solver={"end": 10.0}, interval=0.05,
        frames=[{"name": "boom", "pivot": [0, 0, 10], "luff": {"ramp": {"to": turned, "over": 10.0}}}],
    )  # fmt: skip
    result = ran(scene)
    middle = np.asarray(result["wrap_middle"])[:, 0]
    assert abs(middle[-1] - middle[0]) == pytest.approx(0.5 * abs(turned), abs=0.01)
    contact = contacts_of(result, course(result))[1]
    assert np.abs(np.diff(contact.on)).max() < 0.1 and np.abs(np.diff(contact.off)).max() < 0.2


def test_a_drum_that_slewing_empties_runs_out_when_it_does():
    """2 m on it are gone at phi = 2 m / R."""
    scene = slewing(14.0, rope_on_drum=2.0)
    foreseen = [text for text in told(scene) if "rope_on_drum" in text]
    stop = stopped(scene, Status.RUN_OUT)
    assert RADIUS * slewed(stop.time, 14.0) == pytest.approx(2.0, abs=0.03)
    assert len(foreseen) == 1 and "by turning too" in foreseen[0]
    assert float(re.search(r"at about t = ([0-9.]+) s", foreseen[0])[1]) == pytest.approx(stop.time, abs=0.2)


def test_a_drum_that_slewing_fills_is_full_when_it_is():
    """One layer holds 10 turns; 23 m are on it, and what is free of it is wound on."""
    layers = {"turns": 10, "count": 1, "core_radius": 0.39}
    scene = slewing(-14.0, rope_on_drum=23.0, layers=layers)
    read = parsed(scene)
    room = read.path[0].layers.capacity(ROPE["diameter"]) - 23.0
    assert 0.0 < room < 5.0
    stop = stopped(scene, Status.DRUM_FULL)
    assert -RADIUS * slewed(stop.time, -14.0) == pytest.approx(room, abs=0.03)
    assert any("with what turning lays on" in text for text in told(scene))


def test_nothing_counts_turning_where_a_boom_carries_drum_and_tip():
    scene = slewing(14.0, rope_on_drum=2.0, frame="boom")
    result = ran(scene)
    assert "lead_angle" not in result
    assert not any("what turns about the drum" in text for text in told(scene))


@pytest.mark.parametrize(("turned", "sense"), [(14.0, "too stiff and too light"), (-14.0, "too soft and too heavy")])
def test_check_says_how_much_of_the_rope_stands_for_that_of_the_start(turned, sense):
    """12 m lie between drum and tip; 5.6 m less, or more, are computed: 47 % of 12 m."""
    found = [text for text in told(slewing(turned)) if "what turns about the drum" in text]
    assert len(found) == 1
    assert "5.6 m" in found[0] and "47 % off" in found[0] and sense in found[0]


def test_turning_that_changes_little_is_no_matter():
    """0.5 rad are 0.2 m of 12 m."""
    assert not any("what turns about the drum" in text for text in told(slewing(0.5)))


@pytest.mark.parametrize("scene", [14.0, 0.1])
def test_a_run_tells_what_turning_has_done_whether_check_could_foresee_it_or_not(unwound, scene):
    """Of a scene that slews by less, as of one that is steered, check sees nothing of 14 rad."""
    (sentence,) = laid_by_turning(unwound, laid_out(parsed(slewing(scene))))
    assert "winch" in sentence and "5.6 m" in sentence and "too stiff" in sentence


@pytest.mark.parametrize("elements", [1, 4])
def test_a_drum_that_is_unwound_by_all_of_its_span_is_named(elements):
    """31 rad take 12.4 m off it, and 12 m lie between it and the tip."""
    stop = str(stopped(slewing(31.0, elements=elements), Status.NO_LENGTH))
    assert "off winch since the start" in stop and "Fewer elements do not help" in stop
    assert "beside" not in stop


def between_two_drums(**of_first):
    """A block hangs between the tips of two booms on a ship that pitches; a drum for either end of the rope."""
    on = {"frame": "vessel"}
    path = [
        drum((0.0, 0.0, 10.0), RADIUS, name="w1", **on, **of_first),
        sheave((12.0, 0.0, 25.0), RADIUS, name="tip", **on),
        sheave(None, RADIUS, body="load", name="h", wrap="under"),
        sheave((13.6, 0.0, 25.0), RADIUS, name="tip2", **on),
        drum((-8.0, 0.0, 10.0), RADIUS, name="w2", **on),
    ]
    return crane(
        path, [body("load", 5000.0, (12.8, 0.0, 5.0))], rope=ROPE,
        vessel={
            "reference": [0, 0, 0],
            "motion": {"pitch": {"harmonic": {"amplitude": 0.04, "period": 9.0, "ramp": 4.0}}},
        },
        heave_compensation={"gain": 1.0}, mesh={"elements_per_span": 1}, solver={"end": 12.0, "step": 0.02},
        interval=0.1,
    )  # fmt: skip


def test_between_two_drums_the_heave_of_the_tip_before_the_load_is_answered():
    """A pitch theta lifts a point at x, z by -x sin(theta) + z (cos(theta) - 1)."""
    scene = between_two_drums()
    result = ran(scene)
    time = np.asarray(result["time"])
    ramp = np.clip(time / 4.0, 0.0, 1.0)
    ramp = ramp**3 * (10.0 - 15.0 * ramp + 6.0 * ramp * ramp)
    theta = 0.04 * ramp * np.sin(TURN * time / 9.0)
    heave = -12.0 * np.sin(theta) + 25.0 * (np.cos(theta) - 1.0)
    assert np.abs(result["compensator"]).max() > 0.4
    assert np.asarray(result["compensator"]) == pytest.approx(heave, abs=1.0e-3)
    found = figures(parsed(scene))
    assert found["heave_of"] == "tip" and ("heave that is answered", "that of tip") in describe(found)


def test_between_two_drums_the_one_that_is_driven_counts():
    """The first holds a tension: the compensation drives the second alone, and tip2 is before the load from there."""
    scene = between_two_drums(tension=25000.0, inertia=100.0)
    assert figures(parsed(scene))["heave_of"] == "tip2"


def test_a_compensation_whose_tip_stands_on_the_ground_is_told():
    scene = slewing(0.1, frame="vessel")
    heave = {"harmonic": {"amplitude": 0.5, "period": 9.0, "ramp": 4.0}}
    scene |= {"vessel": {"reference": [0, 0, 0], "motion": {"heave": heave}}, "heave_compensation": {"gain": 1.0}}
    scene["frames"][0]["parent"] = "ground"
    assert any("answers the heave of tip" in text and "stays 0" in text for text in told(scene))
    scene["frames"][0]["parent"] = "vessel"
    assert not any("stays 0" in text for text in told(scene))


def test_the_picture_of_winches_shows_how_far_the_rope_has_gone_round_its_drum(unwound):
    """What is paid out is 0 there, while turning takes rope off."""
    figure = unwound.plot("winch")
    (panel,) = [plot for plot in figure.axes if plot.get_ylabel().startswith("rope gone round")]
    (drawn,) = panel.get_lines()[:1]
    np.testing.assert_allclose(drawn.get_ydata(), np.asarray(unwound["lead_angle"])[:, 0])
