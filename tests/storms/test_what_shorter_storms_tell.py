"""Of a longer time shorter storms tell extremes alone; quotients are judged as the extreme that they are of."""

from __future__ import annotations

import math

import numpy as np
import pytest
from storms.test_operability import ALONE, PERIOD, SCENE, asked

import tautline
from crane.application import Crane
from crane.operability.allowable import fitted
from crane.operability.criteria import Criterion, check_scaled
from crane.operability.scatter import Scatter
from crane.operability.storms import operability
from tautline.results.assessment.limits import AT_LEAST, AT_MOST
from tautline.scene.errors import SceneError
from tautline.statistics.gumbel import fit_gumbel

DIAGRAM = Scatter(np.array([1.5]), np.array([PERIOD]), np.array([[1.0]]))


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    place = tmp_path_factory.mktemp("alone") / "alone.yaml"
    place.write_text(SCENE)
    return tautline.read(place)


def limit(name, sense=AT_MOST, value=1.0, unit="", output=False):
    return Criterion(f"{name} {'<' if sense == AT_MOST else '>'} {value}", name, sense, value, unit, output)


@pytest.mark.parametrize(
    "name",
    [
        "energy_hoisted", "energy_regenerated_winch", "tension_cycles", "slack_events", "snap_frames",
        "max_bending_cycles", "equivalent_tension_range", "mean_winch_power", "slipping_share", "rise",
    ],
)  # fmt: skip
def test_sums_means_and_ends_are_not_known_from_shorter_storms(name):
    one = limit(name)
    with pytest.raises(SceneError, match="give --simulate 600s, as long as --duration") as told:
        check_scaled([one], [one], "600s")
    assert told.value.problems[0].value == one.text


def test_extremes_are_known_from_shorter_storms_on_their_bad_side_alone():
    bad = [limit(name) for name in ("max_tension", "max_snap", "longest_slack", "max_rise", "dynamic_amplification")]
    bad += [limit(name, AT_LEAST) for name in ("min_tension", "safety_factor")] + [limit("load.speed", output=True)]
    check_scaled(bad, bad, "600s")
    for one in (limit("max_tension", AT_LEAST), limit("min_tension")):
        with pytest.raises(SceneError, match="other side"):
            check_scaled([one], [], "600s")


def test_a_limit_on_a_sum_is_refused_before_any_storm_and_judged_in_storms_of_full_length(scene):
    with pytest.raises(SceneError, match="tension_cycles is a sum"):
        operability(Crane(), scene, asked((0.3,), 3, 40.0, 20.0, limits=["tension_cycles < 50"]), ALONE)
    found = operability(Crane(), scene, asked((0.3,), 3, 20.0, limits=["tension_cycles < 50"]), ALONE)
    assert found.table is not None and found.table.allowable[0, 0, 0].height == 0.3


def test_a_safety_factor_allows_what_the_tension_of_it_does():
    strength, most = 400e3, 50e3 + 3e3 * np.random.default_rng(3).gumbel(size=8)
    tension = fitted(most, limit("max_tension", AT_MOST, 62e3, "N"), 5.0, 0.9, 0.9)
    factor = fitted(strength / most, limit("safety_factor", AT_LEAST, strength / 62e3), 5.0, 0.9, 0.9)
    assert factor["exceedance"] == pytest.approx(tension["exceedance"], rel=1e-9)
    assert factor["percentile"] == pytest.approx(strength / tension["percentile"], rel=1e-9)
    assert factor["percentile_low"] == pytest.approx(strength / tension["percentile_high"], rel=1e-9)
    assert factor["location"] == pytest.approx(tension["location"] / strength, rel=1e-9)


def test_allowable_heights_of_a_safety_factor_and_of_its_tension_are_one(scene):
    strength = scene.rope.breaking_load
    heights, limits = (0.3, 0.9, 1.5), ["max_tension < 60 kN", f"safety_factor > {strength / 60e3!r}"]
    runs = operability(Crane(), scene, asked(heights, 4, 40.0, limits=limits), ALONE)
    tension, factor = runs.table.allowable[:, 0, 0]
    assert factor.height == pytest.approx(tension.height, rel=1e-6) and factor.bound == tension.bound
    assert factor.low == pytest.approx(tension.low, rel=1e-6) and factor.high == pytest.approx(tension.high, rel=1e-6)


def test_a_limit_that_needs_every_frame_does_not_change_the_fatigue_life(scene):
    plain, limited = (
        operability(
            Crane(), scene, asked((1.5,), 3, 40.0, limits=some, scatter=DIAGRAM, constant=1e3), ALONE
        ).fatigue
        for some in ([], ["slack_events < 1000"])
    )  # fmt: skip
    assert plain.life > 0.0 and limited.life == pytest.approx(plain.life, rel=1e-9)
    assert limited.cycles == plain.cycles


def test_figures_of_frames_count_from_the_end_of_the_lead_in(scene):
    """The same storm as a run of its own: what lies before 20 s is cut off by hand."""
    found = operability(
        Crane(), scene, asked((1.5,), 3, 40.0, limits=["slack_events < 9", "max_tension < 1 MN"]), ALONE
    )
    key = "vessel.motion.heave.spectrum"
    sea = {f"{key}.{name}": value for name, value in (("significant_height", 1.5), ("seed", 1), ("ramp", 10.0))}
    sea[f"{key}.peak_period"] = PERIOD
    run = tautline.simulate(scene.replace({**sea, "solver.end": 60.0}))
    late = run.time >= 20.0 - 1e-9
    assert found.outcome.data["max_tension"].values[0] == pytest.approx(run["tension"][late].max(), rel=1e-9)


@pytest.mark.filterwarnings("error")
def test_maxima_at_the_ends_of_the_range_of_floats_are_fitted():
    tiny = np.array([1e-320, 2e-320, 3e-320])
    assert fit_gumbel(tiny, bound=1.0).location == pytest.approx(
        fit_gumbel(tiny * 2.0**60).location / 2.0**60, rel=1e-3
    )
    assert fit_gumbel(np.array([1.7e308, -1.7e308, 1.2e308])).exceedance(1.7e308).value < 0.5
    assert math.isclose(fit_gumbel(tiny).exceedance(1.0).value, 0.0, abs_tol=1e-12)
