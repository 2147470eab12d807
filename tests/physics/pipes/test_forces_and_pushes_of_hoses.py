"""What the ends of a hose bear, and what squashes it, against statics that know of no elements."""

import numpy as np
import pytest

import tautline
from gardenhose.cables import arc_lengths
from gardenhose.estimates import largest_change
from gardenhose.static import forms, stretched_at_rest
from gardenhose.warnings import warnings

G = 9.81


def hanging(elements, coupling="linear", limits=None, **water):
    """A hose of 1 m that hangs, with a valve of 0.2 kg: 5 N of wall, water and valve beyond its root."""
    return tautline.read(
        {
            "hose": {
                "length": 1.0, "elements": elements, "axial_stiffness": 1e4, "bending_stiffness": 0.1,
                "mass_per_length": 0.2, "direction": [0, 0, -1], "tip_mass": 0.2,
            },
            "water": {"mass_per_length": 0.1, "speed": 0.0} | water,
            "coupling": coupling, "start": "static",
            "solver": {"method": "generalized-alpha", "rho_inf": 0.9, "step": 1e-3, "end": 0.01},
            "output": {"interval": 1e-3},
            "limits": limits or [{"output": "axial_force", "above": 0.49 * G, "name": "root"}],
        }
    )  # fmt: skip


@pytest.mark.parametrize("coupling", ["linear", "lagrange"])
@pytest.mark.parametrize("elements", [1, 4])
def test_the_root_of_a_hanging_hose_bears_all_of_its_weight_and_its_tip_what_hangs_there(elements, coupling):
    run = tautline.simulate(hanging(elements, coupling))
    assert run.headline["axial_force_max"]["value"] == pytest.approx(0.5 * G, rel=1e-5)
    assert run.headline["axial_force_min"]["value"] == pytest.approx(0.2 * G, rel=1e-5)
    (judged,) = (one for one in run.limits if one["name"] == "root")
    assert not judged["passed"] and judged["place"].startswith("element 1, 0 to ")


def held(outlet=1.0, strain="green", speed=35.0, elements=10, **solver):
    """Case 3 of the thesis."""
    return tautline.read(
        {
            "hose": {
                "length": 0.5, "elements": elements, "axial_stiffness": 10.0, "bending_stiffness": 0.00108,
                "mass_per_length": 0.0031316, "damping": 0.0031316, "direction": [1, 0, 0], "strain": strain,
            },
            "water": {"mass_per_length": 0.0007854, "speed": speed, "outlet": outlet},
            "solver": {"method": "generalized-alpha", "rho_inf": 0.9, "step": 1e-3, "end": 0.1} | solver,
            "output": {"interval": 5e-3},
        }
    )  # fmt: skip


def test_a_fluttering_hose_has_no_force_at_its_free_end_and_that_at_its_root_does_not_hang_on_the_mesh():
    roots = []
    for elements in (10, 20):
        run = tautline.simulate(held(speed=15.0, elements=elements, end=0.4, step=5e-4))
        force = run["end_force"]
        roots.append(force[:, 0, 0])
        assert np.abs(force[1:, -1, 1]).max() < 1e-4 * np.ptp(force)
        # What an iteration leaves out, by the default tolerance.
        assert np.abs(force[1:, 1:, 0] - force[1:, :-1, 1]).max() < 3e-3 * np.ptp(force)
    assert np.ptp(roots[1]) > 0.005, "it moves"
    assert np.abs(roots[0] - roots[1])[1:].max() < 0.02 * np.ptp(roots[1])


def pushed(scene):
    return [one.text for one in warnings(scene) if one.where == "water.outlet"]


@pytest.mark.parametrize("strain", ["green", "engineering"])
def test_a_nozzle_that_squashes_the_hose_is_warned_of_with_the_length_that_is_left(strain):
    push = 0.0007854 * 35.0**2 * (5.0 - 1.0) / 10.0
    left = np.sqrt(1.0 - 2.0 * push) if strain == "green" else 1.0 / (1.0 + push)
    scene = held(5.0, strain)
    (text,) = pushed(scene)
    assert f"is {100 * push:.0f} % of EA at 35 m/s" in text and f"to {100 * left:.0f} % of its length" in text
    assert forms(scene, list(np.linspace(0.0, 35.0, 8)))[-1].tip[0] == pytest.approx(0.5 * left, rel=1e-3)
    assert pushed(held(2.0, strain)) == []


def test_a_push_that_no_straight_hose_bears_is_told_with_the_speed_from_which_on():
    (text,) = pushed(held(20.0))
    assert f"{np.sqrt(0.5 * 10.0 / (0.0007854 * 19.0)):.4g} m/s, no straight hose bears it" in text


def test_shapes_at_rest_that_are_squashed_to_nothing_are_warned_of_with_speed_and_place():
    scene = held(20.0)
    found = forms(scene, [0.0, 10.0, 20.0, 30.0])
    s = arc_lengths(scene)
    assert stretched_at_rest(s, found[:2], "si") == []
    (warning,) = stretched_at_rest(s, found, "si")
    assert "the shape at 20 m/s" in warning.text and "at 0.5 m from the root, less than 0.5" in warning.text
    assert "1 more of the shapes" in warning.text


def tube(speed, end="clamped"):
    return tautline.read(
        {
            "hose": {
                "length": 1.0, "elements": 8, "axial_stiffness": 1e6, "bending_stiffness": 1.0,
                "mass_per_length": 0.5, "direction": [1, 0, 0], "end": end, "damping": 1e-3,
            },
            "water": {"mass_per_length": 0.5, "speed": speed},
            "gravity": [0, 0, -1e-3], "start": "static",
            "solver": {"method": "generalized-alpha", "rho_inf": 0.9, "step": 1e-3, "end": 0.5},
            "output": {"interval": 1e-2},
        }
    )  # fmt: skip


def test_held_ends_share_what_makes_the_water_faster_and_a_free_end_leaves_it_to_the_root():
    pulsating = {"harmonic": {"amplitude": 2.0, "frequency": 2.0, "mean": 2.0}}
    for end, share in (("clamped", 0.5), ("free", 1.0)):
        run = tautline.simulate(tube(pulsating, end))
        faster = 8.0 * np.pi * np.cos(4.0 * np.pi * run["time"])
        ends = run["end_force"][:, [0, -1], [0, 1]]
        pull = 0.5 * faster * 1.0
        expected = np.stack([-share * pull, (1.0 - share) * pull], axis=1)
        assert np.abs(ends - expected)[5:].max() < 0.01 * pull.max()


@pytest.mark.parametrize(
    ("end", "amplitude", "told"), [("clamped", 2.0, True), ("clamped", 0.1, False), ("free", 2.0, False)]
)
def test_a_changing_flow_between_held_ends_is_warned_of_where_the_pressure_would_matter(end, amplitude, told):
    speed = {"harmonic": {"amplitude": amplitude, "frequency": 2.0, "mean": 2.0}}
    texts = [one.text for one in warnings(tube(speed, end)) if one.where == "water.speed" and "N = M dU/dt" in one.text]
    assert len(texts) == told
    if told:
        push = 0.5 * 0.5 * 2.0 * 4.0 * np.pi
        assert f"smaller by {push:.3g} N" in texts[0] and f"{100 * push / (4 * np.pi**2):.2g} %" in texts[0]


def hammered(speed, end="free"):
    return [one.text for one in warnings(tube(speed, end)) if "water hammer" in one.text]


def long_run(speed):
    """A tube that runs for 1000 s, of which 4001 samples stand 0.25 s apart."""
    return tube(speed, "free").replace({"solver.end": 1000.0})


@pytest.mark.parametrize("late", [0.1, 0.10037])
@pytest.mark.parametrize(("times", "told"), [(0.01, True), (3.8, True), (4.2, False), (50.0, False)])
def test_a_flow_that_stops_within_four_times_of_a_wave_along_the_hose_is_warned_of_water_hammer(times, told, late):
    """L sqrt((m + M) / EA) is 1 ms; a valve that shuts within a hundredth of that is between two samples of the run."""
    shut = times * 1.0 * np.sqrt((0.5 + 0.5) / 1e6)
    texts = hammered({"table": {"time": [0.0, late, late + shut, 1.0], "value": [3.0, 3.0, 0.0, 0.0]}})
    assert len(texts) == told
    if told:
        assert "changes by 3 m/s within 0.004 s or less" in texts[0] and "takes 0.001 s along" in texts[0]


def changed(time, value, within, end):
    """Largest change of straight lines within a time, one by one where it begins or ends at a knot."""
    corners = [t + shift for t in time for shift in (-within, 0.0, within)]
    corners = np.array([t for t in corners if 0.0 <= t <= end] + [end])
    speed, apart = np.interp(corners, time, value), np.subtract.outer(corners, corners)
    return float(np.abs(np.subtract.outer(speed, speed))[np.abs(apart) <= within + 1e-9].max())


@pytest.mark.parametrize(
    ("time", "value"),
    [
        ([0.0, 50.0, 50.2, 500.1, 500.101, 2000.0], [0.0, 0.0, 5.0, 5.0, 1.0, 1.0]),
        ([0.0, 5.0, 5.5, 700.1, 700.101, 2000.0], [0.0, 0.0, 5.0, 5.0, 3.0, 3.0]),
        ([0.0, 500.11, 500.111, 500.112, 2000.0], [5.0, 5.0, 0.0, 5.0, 5.0]),
        ([0.0, 500.11, 500.111, 500.16, 500.161, 2000.0], [5.0, 5.0, 0.0, 0.0, 5.0, 5.0]),
        ([0.0, 500.11, 501.11, 2000.0], [5.0, 5.0, 0.0, 0.0]),
    ],
    ids=["slam after a larger slow opening", "smaller slam", "shut and open again", "a little later", "slow"],
)
def test_a_quick_change_in_a_long_run_is_found_beside_slower_ones_and_between_its_samples(time, value):
    """A wave takes 1 ms along the hose; a tenth of 5 m/s is told."""
    within, scene = 0.4e-3, long_run({"table": {"time": time, "value": value}})
    found = changed(time, value, within, 1000.0)
    assert largest_change(scene, within) == pytest.approx(found, rel=1e-6)
    assert any("water hammer" in one.text for one in warnings(scene)) == (found >= 0.5)


@pytest.mark.parametrize("frequency", [40.0, 40.37])
def test_a_flow_that_pulsates_faster_than_its_samples_is_followed(frequency):
    """At every sample a sine of 40 Hz is alike. 2 A sin(pi f w) is the most that a sine changes within w."""
    scene, within = long_run({"harmonic": {"amplitude": 0.6, "frequency": frequency, "mean": 5.0}}), 4e-3
    assert largest_change(scene, within) == pytest.approx(1.2 * np.sin(np.pi * frequency * within), rel=2e-3)


def test_a_short_ramp_of_a_long_run_is_followed_between_its_corners():
    """A ramp of 20 ms, 10 u^3 - 15 u^4 + 6 u^5: within 4 ms it changes the most about its middle, from 0.4 to 0.6."""
    scene = long_run({"ramp": {"to": 5.0, "over": 0.02, "at": 333.1}})
    at = [10.0 * u**3 - 15.0 * u**4 + 6.0 * u**5 for u in (0.4, 0.6)]
    assert largest_change(scene, 4e-3) == pytest.approx(5.0 * (at[1] - at[0]), rel=2e-3)


def test_a_flow_that_hardly_changes_or_pulsates_slowly_is_not_warned_of_water_hammer():
    assert not hammered(3.0)
    assert not hammered({"table": {"time": [0.0, 0.1, 0.1001, 1.0], "value": [3.0, 3.0, 2.8, 2.8]}})
    assert not hammered({"harmonic": {"amplitude": 2.0, "frequency": 2.0, "mean": 2.0}})


@pytest.mark.parametrize(("share", "told"), [(9.0, False), (11.0, True)])
def test_a_flow_that_stops_by_a_push_of_ten_times_what_buckles_a_held_pipe_is_warned_of(share, told):
    """Clamped at both ends a pipe of EJ = 1, L = 1 buckles at 4 pi^2 N (Euler); M dU/dt L/2 with M = 0.5 pushes."""
    rate = share * 4.0 * np.pi**2 / (0.5 * 0.5)
    flow = {"table": {"time": [0.0, 0.1, 0.15, 1.0], "value": [0.05 * rate, 0.05 * rate, 0.0, 0.0]}}
    texts = hammered(flow, "clamped")
    assert len(texts) == told and all(f"{share:.0f} times the force that buckles" in text for text in texts)
    assert not hammered(flow, "free")


def test_a_limit_on_the_force_at_an_end_is_told_where_that_end_is():
    """The root of a hanging hose bears the most, its tip's end the least: 0 m and 1 m, of elements of 0.25 m."""
    bounds = [{"output": "end_force", "above": 1e-3}, {"output": "end_force", "below": 1e3}]
    run = tautline.simulate(hanging(4, limits=bounds))
    most, least = (one["place"] for one in run.limits if one.get("output") == "end_force")
    assert most.endswith(" at 0 m, first end") and least.endswith(" at 1 m, last end")


def test_a_hose_at_rest_whose_water_begins_to_move_has_its_weight_at_its_root_in_the_first_frame():
    moving = {"speed": {"harmonic": {"amplitude": 0.5, "frequency": 2.0}}}
    run = tautline.simulate(hanging(4, **moving))
    # Less or more by what makes the water faster, rho A L dU/dt: the valve of 0.2 kg hangs there as well.
    pull = 0.1 * 0.5 * 4.0 * np.pi
    assert abs(run["end_force"][0, 0, 0] - 0.5 * G) < 1.01 * pull
    assert run["end_force"][0, 0, 0] > run["axial_force"][0, 0]
