"""The first speed at which a hose becomes unstable, where it is stable once more beyond it: against Galerkin's method.

Over the mass ratio the boundary folds back (Gregory and Paidoussis 1966), more often where the pipe hangs. The
reference has polynomials and no elements (`references.hose.Pipe`), and looks at 400 speeds and at each peak between.
"""

from functools import cache

import numpy as np
import pytest
from of_the_suite import studies
from physics.pipes.hoses import run, scene
from references import hose as reference
from scipy.optimize import brentq, minimize_scalar

from gardenhose.flutter import stability

GALERKIN = reference.Pipe(26)
ROUNDING = 1e-7


def cantilever(beta, n, gamma=0.0, mu=0.0, jet=1.0, alpha=0.0, along=1e6):
    """Pipe of length, EJ and m + M of one that hangs, gamma = (m + M) g L^3 / EJ, or stands where that is negative."""
    section = {"length": 1.0, "elements": n, "axial_stiffness": along, "bending_stiffness": 1.0, "damping": alpha}
    section |= {"mass_per_length": 1.0 - beta, "tip_mass": mu, "direction": [0, 0, -1]}
    return scene(section, {"mass_per_length": beta, "outlet": jet}, gravity=[0, 0, -gamma])


def growth(U, beta, **load):
    values = GALERKIN.eigenvalues(U * np.sqrt(beta), beta, **load)[: GALERKIN.modes]
    return float((values.real - ROUNDING * np.abs(values)).max())


@cache
def windows_up_to(top, beta, **load):
    """Speeds between which the reference grows, up to one; the last has no end if it does there."""
    speeds = np.linspace(top / 400, top, 400)
    grows = np.array([growth(U, beta, **load) for U in speeds])
    for i in np.flatnonzero((grows[1:-1] >= grows[:-2]) & (grows[1:-1] >= grows[2:]) & (grows[1:-1] <= 0.0)) + 1:
        best = minimize_scalar(
            lambda U: -growth(U, beta, **load), bounds=(speeds[i - 1], speeds[i + 1]), method="bounded"
        )
        if best.fun < 0.0:
            speeds, grows = np.append(speeds, best.x), np.append(grows, -best.fun)
    order = np.argsort(speeds)
    speeds, grows = speeds[order], grows[order]
    places = [
        brentq(lambda U: growth(U, beta, **load), speeds[i], speeds[i + 1])
        for i in np.flatnonzero((grows[1:] > 0.0) != (grows[:-1] > 0.0))
    ]
    return list(zip(places[::2], [*places[1::2], None], strict=False))


def test_a_hanging_pipe_has_windows_of_instability_below_the_speed_from_which_it_flutters_for_good():
    # Of fourth order in the mesh: at 20 elements 7.9e-3, at 40 5e-4. The narrowest window is 0.96 m/s wide.
    found = stability(cantilever(0.945, 27, 50.0))
    exact = windows_up_to(38.5, 0.945, gamma=50.0)
    assert len(exact) == 4
    assert [one.begin for one in found.windows[:4]] == pytest.approx([begin for begin, _ in exact], rel=3e-3)
    assert [one.end for one in found.windows[:3]] == pytest.approx([end for _, end in exact[:3]], rel=3e-3)
    assert found.critical[0].speed == found.windows[0].begin == pytest.approx(32.76, abs=0.08)


def test_the_plain_pipe_flutters_in_a_window_a_tenth_wide_before_it_does_for_good():
    found = stability(cantilever(0.2972, 20))
    exact = windows_up_to(15.3, 0.2972)
    assert len(exact) == 2
    assert [one.begin for one in found.windows] == pytest.approx([begin for begin, _ in exact], rel=1e-3)
    assert found.windows[0].end == pytest.approx(exact[0][1], rel=1e-3) and found.windows[-1].end is None
    assert found.critical[0].speed == found.windows[0].begin == pytest.approx(13.78, abs=0.01)
    # a speed of the window is among those that are drawn, and told to be unstable
    inside = (found.speed > found.windows[0].begin) & (found.speed < found.windows[0].end)
    assert found.grows[inside].any() and found.resolution < 0.1


def test_speeds_that_are_given_step_over_no_window():
    found = stability(cantilever(0.2972, 20), [0.0, 5.0, 10.0, 13.0, 14.0, 15.0])
    assert found.speed.tolist() == [0.0, 5.0, 10.0, 13.0, 14.0, 15.0] and not found.grows.any()
    (window,) = found.windows
    exact, beyond = windows_up_to(15.3, 0.2972)
    assert window == pytest.approx(exact, rel=1e-3) and beyond[0] > 15.0
    assert found.critical[0].speed == window.begin


@pytest.mark.parametrize("way", ["lagrange", *studies("penalty")])
def test_windows_are_found_whatever_ties_hose_and_water(way):
    made = cantilever(0.2972, 8, along=1e4)
    plain, tied = stability(made), stability(made.replace({"coupling": way}))
    for one, other in zip(plain.windows[:1], tied.windows[:1], strict=True):
        assert tuple(other) == pytest.approx(tuple(one), rel=1e-6)


CASES = [
    (0.695, {"alpha": 1e-3}),
]
MORE = [
    (0.297, {}),
    (0.2, {"mu": 0.1}),
    (0.5, {"jet": 2.0}),
    (0.05, {}),
    (0.298, {}),
    (0.3, {"gamma": 10.0}),
    (0.69, {"gamma": -5.0}),
    (0.001, {}),
    (0.31, {"gamma": 20.0}),
    (0.65, {"gamma": 50.0}),
    (0.68, {"gamma": 10.0}),
    (0.7, {"gamma": 50.0}),
    (0.8, {"mu": 0.3, "gamma": 5.0}),
    (0.9, {"jet": 1.5, "alpha": 1e-3, "gamma": 20.0}),
]


@pytest.mark.parametrize(("beta", "load"), [*CASES, *studies(*MORE)])
def test_the_first_speed_of_all_is_found_over_mass_ratio_weight_nozzle_tip_mass_and_damping(beta, load):
    found = stability(cantilever(beta, 20, **load)).critical[0].speed
    exact = windows_up_to(1.01 * found, beta, **load)
    assert found == pytest.approx(exact[0][0], rel=1e-3)


def test_an_undamped_pipe_held_at_both_ends_has_no_windows_by_rounding():
    section = {"length": 1.0, "elements": 8, "axial_stiffness": 1e6, "bending_stiffness": 1.0, "mass_per_length": 0.8}
    held = scene(section | {"damping": 0.0, "root_support": "clamped", "end": "clamped"}, {"mass_per_length": 0.2},
                 gravity=[0, 0, 0])  # fmt: skip
    found = stability(held)
    assert found.windows[0].begin == found.critical[0].speed
    assert found.windows[0].begin * np.sqrt(0.2) == pytest.approx(2.0 * np.pi, rel=6e-4)


def test_a_run_of_a_pipe_with_a_mass_at_its_tip_grows_at_the_rate_of_its_eigenvalue():
    # The other motions decay within 6 s, before that the tip's peaks fall. Measured 0.02013 for 0.02008, at 4.6 m/s.
    speed, mass = 4.6, 0.5
    made = cantilever(0.3, 12, mu=mass, along=1e5)
    solver = {"rho_inf": 1.0, "step": 5e-4, "end": 18.0, "tolerance": 1e-8}
    made = made.replace({"water.speed": speed, "disturbance": [1e-5, 0, 0], "output.interval": 4e-3})
    result = run(made.replace({f"solver.{key}": value for key, value in solver.items()}))
    values = GALERKIN.eigenvalues(speed * np.sqrt(0.3), 0.3, mu=mass)[: GALERKIN.modes]
    exact = values[values.real.argmax()]
    time, tip = np.asarray(result["time"]), np.asarray(result["tip"])[:, 0]
    times, sizes = [], []
    for part in np.array_split(np.flatnonzero(time > 6.0), 8):
        t = time[part] - time[part[0]]
        wave = np.exp(exact * t)
        share, *_ = np.linalg.lstsq(np.stack([wave.real, wave.imag, np.ones_like(t), t], 1), tip[part])
        times.append(time[part[0]])
        sizes.append(np.hypot(*share[:2]))
    assert np.polyfit(times, np.log(sizes), 1)[0] == pytest.approx(exact.real, rel=0.02)
