"""A twin of a load at the surface does not know the phases of the real sea: it says so, and its deviations have them.

References: the weight of the load that made the record, and how its tension went up and down there.
"""

from functools import cache

import numpy as np
import pytest
from physics.lifting.crane_scenes import body, crane, drum, end

import tautline
from tautline.twin.twin import Twin

MASS, NOISE = 5000.0, 0.5
MAP = """
sensors:
  - {column: winch_pos, unit: m, input: winch.pay_out}
  - {column: rope_tension, unit: kN, output: winch.tension, sd: 0.5 kN}
estimate:
  - {parameter: load.mass, start: 4.6 t, sd: 1 t, range: [0.5 t, 20 t], drift: 1 kg/s^0.5}
window: 3 s
watch:
  - {residual: winch.tension, above: 2 sd, for: 0.2 s, name: irregular}
"""
AT_SURFACE, DEEP = -0.3, -150.0
END = 60.0


def lift(z, seed=None):
    """A load of 2.5 m in height below a winch, in waves with phases by a seed, or in still water."""
    water = {"volume": 2.0, "height": 2.5, "bottom": 1.0, "added_mass": [800.0, 800.0, 1500.0]}
    load = body("load", MASS, (0.5, 0.0, z), drag={"quadratic": [3000.0, 3000.0, 4000.0]}, **water)
    rope = {"mass_per_length": 1.0e-3, "axial_stiffness": 4.0e7, "damping": 5.0e-3}
    sea = {"surface": 0.0, "density": 1025.0}
    if seed is not None:
        spectrum = {"significant_height": 1.0, "peak_period": 14.0, "ramp": 10.0, "seed": seed}
        sea["waves"] = {"elevation": {"spectrum": spectrum}}
    path = [drum((0.0, 0.0, 20.0), pay_out=0.0), end("load")]
    more = {"mesh": {"elements_per_span": 1}, "solver": {"step": 1e-2, "end": END, "rho_inf": 0.6}, "interval": 0.1}
    return crane(path, [load], rope, water=sea, **more)


@cache
def record(z=AT_SURFACE):
    """Stamps and tensions, kN, of the real sea."""
    found = tautline.simulate(lift(z, 21))
    tension = np.asarray(found["tension"])[:, 0, 0] / 1e3
    return np.asarray(found["time"]), tension + NOISE * np.random.default_rng(5).normal(size=len(tension))


@cache
def followed(z=AT_SURFACE, seed=None):
    """A twin whose waves have other phases or which has none, and its lines from 15 s on."""
    twin = Twin(tautline.read(lift(z, seed)), MAP)
    rows = zip(*record(z), strict=True)
    lines = [x for t, y in rows for x in twin.add(float(t), {"winch_pos": 0.0, "rope_tension": float(y)})]
    return twin, [one for one in lines if one["time"] > 15.0]


def test_the_weight_of_a_load_at_the_surface_is_within_its_deviation_though_the_waves_have_other_phases():
    _, lines = followed(seed=1)
    weight = [one["estimates"]["load.mass"] for one in lines]
    off = np.array([abs(one["value"] - MASS) / one["sd"] for one in weight])
    assert np.mean(off < 2.0) > 0.9 and off.max() < 4.0
    # By the noise of the sensor alone it would be 5 kg within seconds.
    assert min(one["sd"] for one in weight) > 30.0


def test_health_is_not_good_while_waves_move_a_load_at_the_surface_and_says_why():
    twin, lines = followed(seed=1)
    assert {one["health"] for one in lines} == {"degraded"}
    assert all(any("waves" in cause for cause in one["causes"]) for one in lines)
    assert any("not those of the real sea" in note for note in twin.notes)


def test_the_deviation_by_waves_is_that_by_which_the_tension_goes_up_and_down():
    twin, lines = followed(seed=1)
    time, tension = record()
    real = 1e3 * np.sqrt(np.var(tension[time > 15.0]) - NOISE**2)
    # The sea that is simulated has as much of it again.
    assert twin.blur.sds[0] == pytest.approx(np.sqrt(2.0) * real, rel=0.25)
    assert lines[-1]["deviations"]["winch.tension"] > 0.9 * twin.blur.sds[0]


def test_far_below_the_waves_the_weight_is_known_and_health_is_good():
    twin, lines = followed(DEEP, seed=1)
    assert lines[-1]["health"] == "good" and twin.blur.suspect == ""
    weight = lines[-1]["estimates"]["load.mass"]
    assert abs(weight["value"] - MASS) < 3.0 * weight["sd"] and weight["sd"] < 15.0


def test_a_twin_in_still_water_says_that_waves_pass_for_weight_and_names_them_where_tension_is_irregular():
    twin, lines = followed()
    assert any("no waves" in note and "passes for weight" in note for note in twin.notes)
    texts = [alarm["text"] for one in lines for alarm in one["alarms"] if alarm["name"] == "irregular"]
    assert texts and all("waves, friction, contact or rope path" in text for text in texts)
    assert not any("the real one did not" in note for note in twin.notes)
