"""Where hoses become unstable, against exact characteristic equations and spectral methods (tests/references/hose.py).

Figures in comments are relative errors that were measured; tolerances leave a factor of about two to four above them.
"""

from functools import cache

import numpy as np
import pytest
from of_the_suite import studies
from physics.pipes import hoses
from physics.pipes.hoses import COUPLINGS, WATER, at_rest, orders, pipe, scene
from references import hose as reference
from scipy.optimize import brentq

from gardenhose.flutter import crossings, stability
from gardenhose.static import form
from gardenhose.vibration.linear_hose import LinearHose
from tautline.integrators.status import Status, StoppedEarly
from tautline.integrators.vibration import vibrations as found_by

CLAIMED = 5e-3
"""Error of the critical speed that the issue allows."""
BOUNDARY = {  # first crossings by `reference.critical_speeds`, which takes seconds for each: beta, (u, omega)
    0.1: (4.749896773113373, 14.179),
    0.2: (5.59140437782707, 13.706),
    0.3: (8.2699550015397, 28.6),
    0.4: (8.778159181579364, 27.2),
    0.5: (9.322418432780397, 26.5),
    0.6: (9.991351642523012, 26.4),
    0.7: (12.769088289146055, 43.0),
    0.8: (13.493130500959683, 42.6),
}


def crossing(beta, u, omega, *more):
    """The exact crossing near (u, omega): Newton's method on the characteristic determinant."""
    return reference._polish(u, omega, beta, *more)


def onset(made, beta, u, width=0.2, plane="any"):
    """The only critical speed near u, as u, its dimensionless angular frequency, and what happens there."""
    root = np.sqrt(beta)
    (found,) = crossings(made, np.array([u - width, u + width]) / root, plane)
    return found.speed * root, 2 * np.pi * found.frequency, found.kind


# Gregory and Paidoussis' cantilever
@pytest.mark.parametrize(
    ("beta", "n", "limit"),
    [
        *((beta, 10, CLAIMED) for beta in (0.1, 0.3, 0.5, 0.7)),
        (0.8, 20, 4e-4),
        *studies(*((beta, 10, CLAIMED) for beta in (0.2, 0.4, 0.6, 0.8)), (0.1, 20, 4e-4), (0.5, 20, 4e-4)),
    ],
)
def test_cantilever_flutters_on_the_boundary_of_gregory_and_paidoussis(beta, n, limit):
    # measured at 20 elements from 3.3e-6 (beta 0.1) to 1.4e-4 (0.8), frequencies twice that; at 10 at most 2.2e-3
    u, omega = crossing(beta, *BOUNDARY[beta])
    assert u == pytest.approx(BOUNDARY[beta][0], rel=1e-9)
    speed, frequency, kind = onset(pipe(beta, n), beta, u)
    assert kind == "flutter"
    assert speed == pytest.approx(u, rel=limit)
    assert frequency == pytest.approx(omega, rel=2.5 * limit)


@pytest.mark.parametrize("beta", [0.2, *studies(0.5), 0.8])
def test_cantilever_is_stable_below_the_boundary_and_not_beyond(beta):
    u = BOUNDARY[beta][0]
    speeds = np.append(np.linspace(0.5, 0.99, 6), 1.01) * u / np.sqrt(beta)
    found = stability(pipe(beta, 10), speeds)
    assert found.eigenvalues[:-1].real.max() < 0
    assert found.eigenvalues[-1].real.max() > 0


def test_critical_speed_converges_with_order_four():
    # measured 3.9, 4.0 at 5, 10, 20 elements
    u, _ = crossing(0.2, *BOUNDARY[0.2])
    errors = [onset(pipe(0.2, n), 0.2, u)[0] / u - 1 for n in (4, 8, 16)]
    assert orders(errors) == pytest.approx([4, 4], abs=0.3)


@pytest.mark.parametrize(
    ("damping", "u", "omega"), [(1e-3, 5.64160, 13.600), (1e-2, 5.96769, 12.776), (0.1, 7.24585, 8.040)]
)
@pytest.mark.parametrize("n", [10, *studies(20)])
def test_damping_raises_the_critical_speed_as_the_exact_equation_has_it_on_any_mesh(damping, u, omega, n):
    # Kelvin and Voigt's; its largest rate grows with the fourth power of the mesh, and may hide nothing.
    # Measured at 10 elements 8e-6 to 5.5e-5, at 20 at most 4e-6.
    # The table has what `reference.critical_speeds` finds in a quarter of a second.
    exact, turning = crossing(0.2, u, omega, damping)
    assert exact == pytest.approx(u, abs=1e-4)
    found, frequency, kind = onset(pipe(0.2, n, {"damping": damping}), 0.2, u)
    assert (found, kind) == (pytest.approx(exact, rel=2e-4 if n == 10 else 1e-5), "flutter")
    assert frequency == pytest.approx(turning, rel=4e-4 if n == 10 else 3e-5)


def test_at_a_jump_of_the_boundary_the_cantilever_flutters_ceases_to_and_flutters_again():
    # both onsets at beta = 0.67; measured 1.1e-4 and 3.2e-4 at 14 elements. The pipe is stable from 11.8 to 12.5. That
    # there are these three crossings and no other up to 13 is a test of the references.
    beta, root = 0.67, np.sqrt(0.67)
    made = pipe(beta, 14)
    first, ceases, again = (crossing(beta, *near) for near in ((10.6158, 26.67), (11.7641, 33.10), (12.5185, 42.18)))
    assert (first[0], ceases[0], again[0]) == pytest.approx((10.6158, 11.7641, 12.5185), abs=1e-4)
    between = (ceases[0] + again[0]) / 2
    speeds = np.array([10.0, (first[0] + ceases[0]) / 2, between, 13.0]) / root
    onsets, ends = crossings(made, speeds), crossings(made, speeds, ceasing=True)
    assert (len(onsets), len(ends)) == (2, 1)
    for one, (u, omega) in zip(onsets, (first, again), strict=True):
        assert one.speed * root == pytest.approx(u, rel=8e-4)
        assert 2 * np.pi * one.frequency == pytest.approx(omega, rel=1.6e-3)
    # Where it ceases the boundary is nearly level in beta: measured 6.8e-4 and 1.8e-3, at 28
    # elements 4.4e-5 and 1.2e-4.
    assert ends[0].speed * root == pytest.approx(ceases[0], rel=1.4e-3)
    assert 2 * np.pi * ends[0].frequency == pytest.approx(ceases[1], rel=3.6e-3)


@pytest.mark.parametrize(
    ("beta", "mu", "jet", "u", "omega"),
    [
        (0.2, 0.3, 1.0, 2.9057805558, 14.7181322290),
        (0.5, 0.0, 2.0, 4.3942037465, 13.6138045707),
        *studies(
            (0.2, 0.3, 1.5, 2.2843498307, 14.8348498445),
            (0.2, 0.1, 1.0, 4.2216893472, 14.0846383388),
            (0.2, 0.0, 1.5, 4.0739480886, 14.0509762114),
            (0.5, 0.0, 1.5, 6.9183089564, 24.4641291863),
        ),
    ],
)
def test_mass_and_nozzle_at_the_end_lower_the_critical_speed_as_they_should(beta, mu, jet, u, omega):
    # figures of the references' tests; measured at 10 elements at most 1.5e-4, frequencies 1.0e-4
    speed, frequency, kind = onset(pipe(beta, 10, {"tip_mass": mu}, jet), beta, u)
    assert (speed, kind) == (pytest.approx(u, rel=4e-4), "flutter")
    assert frequency == pytest.approx(omega, rel=3e-4)


@pytest.mark.parametrize(
    ("water", "U", "omega"), [(0.5, 6.8684356467, 27.5895324124), *studies((1.0, 12.3865733974, 26.9213491493))]
)
def test_two_pieces_and_two_bores_flutter_where_spectral_elements_have_them(water, U, omega):
    # EJ and mass differ, then the bore, too; measured at 10 elements a piece 5.8e-6 and 1.7e-5, of fourth order
    first = {"length": 0.25, "elements": 6, "axial_stiffness": 1e4} | {"bending_stiffness": 0.00108}
    first |= {"mass_per_length": 0.0031316}
    second = first | {"bending_stiffness": 0.00054, "mass_per_length": 0.0025, "water_mass_per_length": water * WATER}
    made = scene({"segments": [first, second]}, gravity=[0, 0, 0])
    (found,) = crossings(made, [U - 0.3, U + 0.3])
    assert found.speed == pytest.approx(U, rel=1.5e-4)
    assert 2 * np.pi * found.frequency == pytest.approx(omega, rel=3.9e-4)


# Table 2.2's hose
@pytest.mark.parametrize(
    ("plane", "key", "U"),
    [("in", "in_plane", 13.9148976569), ("out", "out_of_plane_damped", 13.8405929422), ("any", "weightless", None)],
)
@pytest.mark.parametrize(("n", "limit"), [(10, 1e-4), *studies((20, 7e-6))])
def test_hose_flutters_about_its_static_shape_where_polynomials_have_it(plane, key, U, n, limit):
    # measured at 10 elements 4.6e-5, frequency 1.5e-4; at 20 2.9e-6 and 9.7e-6
    speed, omega = hoses.reference_file("cycles")["critical"][key]
    assert U is None or speed == pytest.approx(U, abs=1e-9)
    gravity = [0, 0, 0] if key == "weightless" else [0, 0, -9.81]
    (found,) = crossings(scene({"elements": n}, gravity=gravity), [13.5, 14.2], plane)
    assert (found.kind, found.plane) == ("flutter", plane)
    assert found.speed == pytest.approx(speed, rel=limit)
    assert 2 * np.pi * found.frequency == pytest.approx(omega, rel=3.5 * limit)


def test_search_that_is_not_told_where_to_look_finds_both_planes_of_the_hose_the_lower_first():
    # Six elements: the error is of fourth order, and 1e-4 is kept to with ten. The planes are 5e-3 apart.
    found = stability(scene({"elements": 6}))
    assert [one.plane for one in found.critical] == ["out", "in"]
    assert [one.speed for one in found.critical] == pytest.approx([13.8405929422, 13.9148976569], rel=8e-4)
    assert found.speed[0] == 0 and found.speed[-1] > 14
    assert np.all((found.out_of_plane < 1e-6) | (found.out_of_plane > 1 - 1e-6)), "planes do not mix"


def test_a_straight_hose_lists_the_frequencies_of_a_cantilever_once_and_not_for_each_plane():
    # roots of cosh x cos x = -1, omega = x^2 for EJ = m + M = L = 1; measured 4e-6 to 1.3e-3 with ten elements
    found = stability(pipe(0.3, 10), [0.0, 0.1], modes=5)
    exact = [brentq(lambda x: np.cos(x) + 1 / np.cosh(x), low, low + np.pi) ** 2 for low in np.pi * np.arange(5)]
    assert found.eigenvalues[0].imag == pytest.approx(exact, rel=3e-3)
    assert np.abs(found.eigenvalues[0].real).max() < 1e-9 * exact[0]


def test_eigenvalues_of_the_hose_are_the_references_in_and_out_of_the_plane():
    # the three least of either plane; measured 7e-6, 9e-6, 3e-5 at 20 elements in both
    U = 12.0
    model = reference.Hose(reference.Parameters(), 16)
    found = stability(scene({"elements": 20}), [U, U + 0.1], modes=12)
    for values, plane in ((model.eigenvalues(U), 0), (model.lateral_eigenvalues(U), 1)):
        mine = found.eigenvalues[0][(found.out_of_plane[0] > 0.5) == plane]
        values = values[values.imag > 1e-6]
        for value in sorted(values, key=abs)[:3]:
            assert np.abs(mine - value).min() < 1e-4 * abs(value)


@cache
def flutter_of_six(coupling):
    return crossings(scene({"elements": 6}, coupling=coupling), [13.5, 14.2], "in")


@pytest.mark.parametrize("coupling", COUPLINGS)
def test_critical_speed_is_that_of_linear_coupling_whatever_ties_hose_and_water(coupling):
    # multipliers measured 1e-11; augmented 1.3e-6, as the static shape is (test_hose_statics)
    plain, tied = (flutter_of_six(way) for way in ("linear", coupling))
    assert len(tied) == 1
    assert tied[0].speed == pytest.approx(plain[0].speed, rel=1e-9 if coupling in ("linear", "lagrange") else 1e-5)
    assert tied[0].frequency == pytest.approx(plain[0].frequency, rel=1e-9 if coupling != "augmented" else 1e-5)


@pytest.mark.parametrize("U", [0.0, 10.0, 14.2])
def test_hose_with_springs_to_its_water_has_the_slow_eigenvalues_of_linear_coupling(U):
    # of stiffness 1e5 N/m, which give 2e-7 m at rest; measured 8e-7, 5e-6, 5e-5 at 0, 10, 14.2 m/s
    plain, tied = (
        found_by.vibrations(rest.system, rest.state, 6).value
        for rest in (
            at_rest(scene({"elements": 6}, **ties), U) for ties in ({}, {"coupling": "penalty", "stiffness": 1e5})
        )
    )
    for value in plain[:4]:
        assert np.abs(tied - value).min() < 1.5e-4 * abs(value)


# supported pipes
COARSE = {("pinned", "pinned"): 4e-5, ("clamped", "pinned"): 1.6e-4, ("clamped", "clamped"): 6e-4}
"""Relative error of the speed at which 8 elements buckle, of fourth order: measured 1.6e-5, 6.8e-5, 2.6e-4."""
SUPPORTED = {  # the first natural frequency at u = 0, 1, 2, 3 for beta = 0.2, and where the pipe buckles
    ("pinned", "pinned"): ((9.8696044011, 9.3375314424, 7.5469402519, 2.8682688628), reference.PINNED_PINNED),
    ("clamped", "pinned"): ((15.4182057170, 15.0153953558, 13.7447292963, 11.3532537684), reference.CLAMPED_PINNED),
    ("clamped", "clamped"): ((22.3732854481, 22.0660768204, 21.1216934120, 19.4626743942), reference.CLAMPED_CLAMPED),
}


def supported(supports, n, damping=0.0):
    return pipe(0.2, n, {"root_support": supports[0], "end": supports[1], "damping": damping})


@pytest.mark.parametrize("supports", SUPPORTED)
def test_first_frequency_of_a_supported_pipe_falls_with_speed_as_it_should(supports):
    # measured at 16 elements at most 1.3e-5 (pinned at u = 3, close to buckling); no growth but rounding
    for u, omega in enumerate(SUPPORTED[supports][0]):
        rest = at_rest(supported(supports, 16), u / np.sqrt(0.2))
        values = found_by.vibrations(rest.system, rest.state, 4).value
        assert values[:2].imag == pytest.approx([omega, omega], rel=4e-5), "alike in both planes"
        assert np.abs(values[:2].real).max() < 1e-9 * abs(values[-1]) + 1e-9


@pytest.mark.parametrize("supports", SUPPORTED)
@pytest.mark.parametrize("n", [8, *studies(16)])
def test_supported_pipe_diverges_at_pi_4_4934_and_2_pi(supports, n):
    # damping moves no buckling, and none at all is looked at below; measured 1.0e-6, 4.3e-6, 1.6e-5 at 16 elements
    u = SUPPORTED[supports][1]
    speed, frequency, kind = onset(supported(supports, n, 1e-4), 0.2, u)
    assert (kind, frequency) == ("divergence", 0)
    assert speed == pytest.approx(u, rel=COARSE[supports] if n == 8 else 4e-5)


@pytest.mark.parametrize("supports", [*list(SUPPORTED)[2:], *studies(*((pair,) for pair in list(SUPPORTED)[:2]))])
def test_undamped_supported_pipe_diverges_and_does_not_flutter(supports):
    # all that it does below is to ring for ever: what rounding adds to its thousands of radians a second is no growth
    u = SUPPORTED[supports][1]
    speed, _, kind = onset(supported(supports, 8), 0.2, u)
    assert kind == "divergence"
    assert speed == pytest.approx(u, rel=COARSE[supports])


@pytest.mark.parametrize("supports", [*list(SUPPORTED)[2:], *studies(*((pair,) for pair in list(SUPPORTED)[:2]))])
@pytest.mark.parametrize("to", ["1.5", "past"])
def test_the_mode_that_diverges_is_one_column_from_its_frequency_without_flow_to_its_growth(supports, to):
    # the speeds of a range that is not told, and three of which the last is past buckling
    (at_rest_, *_), buckles = SUPPORTED[supports]
    speeds = None if to == "1.5" else np.array([0.0, 0.7, 1.1]) * buckles / np.sqrt(0.2)
    found = stability(supported(supports, 8), speeds)
    first, u = found.eigenvalues[:, 0], found.speed * np.sqrt(0.2)
    assert first[0].imag == pytest.approx(at_rest_, rel=4e-4)
    before, after = u < buckles * 0.999, (u > buckles * 1.001) & (u < 1.2 * buckles)
    assert np.abs(first[before].real).max() < 1e-6 and (np.diff(first[before].imag) < 0.0).all()
    assert (np.abs(first[after].imag) < 1e-6).all() and (first[after].real > 0.0).all() and after.any()
    # one mode alone grows there, and what is left of the others ring for ever
    assert np.abs(found.eigenvalues[after][:, 1:].real).max() < 1e-6
    assert found.eigenvalues.shape[1] == 8
    assert found.curves is not None
    assert not [one for one in found.curves.doubtful() if one[1] * np.sqrt(0.2) < 1.2 * buckles]


def slowest_of_twelve_sines(beta, u):
    """The two slowest eigenvalues of a pinned pipe, by Galerkin's method."""
    n = np.arange(1, 13)
    wave = n * np.pi
    r, s = np.meshgrid(n, n, indexing="ij")
    odd = (r + s) % 2 == 1
    # of sqrt(2) sin(r pi x) and d/dx sqrt(2) sin(s pi x)
    gyro = np.where(odd, 4.0 * r * s / np.where(odd, r**2 - s**2, 1), 0.0)
    stiff = np.diag(wave**4 - u**2 * wave**2)
    flow = 2.0 * np.sqrt(beta) * u * gyro
    values = np.linalg.eigvals(np.block([[np.zeros((12, 12)), np.eye(12)], [-stiff, -flow]]))
    return values[np.argsort(np.abs(values))[:2]]


def test_growth_of_a_pinned_pipe_past_pi_is_as_galerkins_with_twelve_sines():
    found = stability(supported(("pinned", "pinned"), 16), np.linspace(0.0, 4.0, 9) / np.sqrt(0.2))
    for speed, value in zip(found.speed, found.eigenvalues[:, 0], strict=True):
        u = speed * np.sqrt(0.2)
        assert np.abs(slowest_of_twelve_sines(0.2, u) - value).min() < 2e-3 * abs(value)
        assert (value.real > 1e-6) == (u > np.pi)


@pytest.mark.parametrize("below", [7e-4, *studies(7e-5)])
def test_the_mode_that_diverges_is_one_column_though_the_first_speed_is_just_below_the_divergence(below):
    u = np.array([1.0 - below, 1.018, 1.061]) * np.pi
    found = stability(supported(("pinned", "pinned"), 16), u / np.sqrt(0.2))
    assert found.curves is not None and found.curves.doubtful() == []
    assert found.eigenvalues.shape[1] == 8 and not np.isnan(found.eigenvalues).any()
    for one, value in zip(u[1:], found.eigenvalues[1:, 0], strict=True):
        assert value == pytest.approx(slowest_of_twelve_sines(0.2, one).real.max(), rel=4e-3)


@pytest.mark.parametrize("u", [[8.6, 8.8, 9.0], *studies([8.6, 8.65, 8.7, 8.8, 9.0], [8.1, 9.0])])
def test_a_damped_pair_that_becomes_two_real_motions_goes_on_as_the_one_that_decays_slower(u):
    # Just before they part its frequency is less than a tenth of its decay. Galerkin's polynomials give both.
    values = reference.Pipe(24).eigenvalues(9.0, 0.9, 0.002)
    slower, faster = sorted(values[np.abs(values.imag) < 1e-6].real, reverse=True)[:2]
    assert -14.0 < slower < -12.0 and -27.0 < faster < -25.0
    found = stability(pipe(0.9, 16, {"damping": 0.002}), np.array(u) / np.sqrt(0.9))
    pair = np.abs(found.eigenvalues[0].real + 20.0) < 1.0
    assert found.eigenvalues[0, pair].imag > 1.0
    assert found.eigenvalues[-1, pair] == pytest.approx(slower, rel=5e-3)


def test_where_a_hose_has_no_shape_without_flow_its_modes_are_followed_by_those_of_the_slowest_speed(monkeypatch):
    def without(scene, speed, near=None):
        if speed == 0.0:
            raise StoppedEarly(Status.NO_EQUILIBRIUM, 0.0, None, "none")
        return form(scene, speed, near)

    hose, speeds = scene({"elements": 6}), [4.0, 6.0, 8.0]
    usual = stability(hose, speeds)
    monkeypatch.setattr("gardenhose.vibration.linear_hose.form", without)
    assert stability(hose, speeds).eigenvalues == pytest.approx(usual.eigenvalues)


def test_a_motion_is_never_less_than_not_at_all_unlike_itself():
    for hose in (supported(("clamped", "clamped"), 8), scene({"elements": 6})):
        linear = LinearHose(hose)
        motions, _ = linear.at(9.0)
        costs = linear.unlike(motions, motions)
        assert costs.min() >= 0.0 and np.diag(costs) == pytest.approx(0.0, abs=1e-12)


def test_modes_go_on_over_speeds_that_are_equal_but_for_rounding():
    twins = [20.05, 20.06, 20.060000000000002, 20.11]
    found = stability(supported(("clamped", "clamped"), 16), twins)
    assert found.speed.tolist() == twins and not np.isnan(found.eigenvalues).any()
    assert found.curves is not None and found.curves.doubtful() == []
    assert found.eigenvalues[2] == pytest.approx(found.eigenvalues[1], rel=1e-6)


def test_a_round_speed_that_was_asked_for_but_for_rounding_is_looked_at_once():
    asked = [5.0, 5.6, 6.0]
    found = stability(scene({"elements": 6}), asked)
    assert (
        found.curves is not None and set(asked) <= set(found.curves.speed) and 5.6000000000000005 in found.curves.marks
    )
    assert np.diff(found.curves.speed).min() > 1e-9


@pytest.mark.parametrize("speeds", [[0.0], [0.0, 2.0, 4.0], [2.0, 4.0]])
def test_nothing_grows_in_a_stable_hose_by_rounding(speeds):
    assert not stability(pipe(0.2, 10), speeds).grows.any()


def test_speeds_may_fall_or_stand_in_any_order():
    rising, falling = (stability(scene({"elements": 6}), speeds) for speeds in ([13.0, 14.5], [14.5, 13.0, 14.5]))
    assert falling.speed.tolist() == [13.0, 14.5] and rising.grows.tolist() == [False, True]
    assert [one.speed for one in falling.critical] == pytest.approx([one.speed for one in rising.critical])


def test_hose_that_takes_in_water_flutters_as_that_speed_grows():
    (found,) = crossings(scene({"elements": 6}), [-5.0, -1.0, 0.0], "in")
    assert -1.0 < found.speed < 0.0 and found.kind == "flutter"


def test_more_modes_than_there_are_at_some_speed_are_as_many_as_there_are():
    found = stability(scene({"elements": 2}), [0.0, 8.0, 16.0], 100)
    assert found.eigenvalues.shape[0] == 3 and 4 <= found.eigenvalues.shape[1] < 100


def test_hose_of_many_elements_flutters_where_one_of_few_does(monkeypatch):
    plain = crossings(scene({"elements": 9}), [13.5, 14.2], "in")
    for coupling in ("linear", "lagrange"):
        monkeypatch.setattr("gardenhose.vibration.linear_hose.DENSE", 50)
        monkeypatch.setattr("gardenhose.vibration.linear_hose.SLOWEST", 30)
        monkeypatch.setattr(found_by, "DENSE", 50)
        (long,) = crossings(scene({"elements": 9}, coupling=coupling), [13.5, 14.2], "in")
        assert long.speed == pytest.approx(plain[0].speed, rel=1e-7)
        monkeypatch.undo()


@pytest.mark.parametrize("damping", [0.0, 1e-5, 0.0031])
@pytest.mark.parametrize("speed", [0.0, 30.0])
def test_sparse_algebra_finds_all_slow_and_all_growing_motions_to_the_rounding_that_it_states(
    monkeypatch, damping, speed
):
    # below 1/c and the 20 slowest; the rounding that was stated before, eps times the value, was 1e4 times too small
    rest = at_rest(scene({"elements": 24, "damping": damping}), speed)
    dense = found_by.vibrations(rest.system, rest.state)
    monkeypatch.setattr(found_by, "DENSE", 10)
    few = found_by.vibrations(rest.system, rest.state, 30)
    slow = dense.value[:20][np.abs(dense.value[:20]) < 0.6 / max(damping, 1e-9)]
    assert slow.size >= 6
    for value, rounding in zip(dense.value, dense.rounding, strict=True):
        if value in slow or value.real > 1e-6 * abs(value):
            nearest = np.argmin(np.abs(few.value - value))
            assert abs(few.value[nearest] - value) < 100.0 * (few.rounding[nearest] + rounding)


@pytest.mark.parametrize("damping", [0.03, 0.3])
def test_heavy_damping_that_makes_many_motions_slow_hides_none_that_grows(monkeypatch, damping):
    # 33.95 + 36.43j and 1.546 + 9.905j 1/s lie beyond more than thirty real values about -1/c
    rest = at_rest(scene({"elements": 24, "damping": damping}), 30.0)
    dense = found_by.vibrations(rest.system, rest.state)
    monkeypatch.setattr(found_by, "DENSE", 10)
    few = found_by.vibrations(rest.system, rest.state, 30)
    assert few.growth == pytest.approx(dense.growth, rel=1e-6) and few.growth > 1.0


@pytest.mark.parametrize("modes", [1, 8])
def test_a_mode_that_grows_at_some_speed_is_followed_from_the_slowest_to_the_fastest_though_it_is_none_of_the_slow(
    modes,
):
    # Two planes, and a second motion in each that begins to grow at 38.9 m/s
    found = stability(scene({"damping": 0.3}), np.linspace(10.0, 40.0, 13), modes)
    growing = found.eigenvalues.real > 1e-6
    assert (growing.any(axis=1) == found.grows).all() and growing[-1].sum() == 4
    fluttering = found.eigenvalues[:, growing[-1]]
    assert np.isfinite(fluttering).all() and (np.diff(fluttering.real, axis=0) > 0.0).all()


@cache
def fluttering_of_the_reference():
    """Of the reference the fluttering pair by speed, followed from 10 to 30 m/s by steps of 0.2 m/s."""
    model, flutters, followed = reference.Hose(reference.Parameters(), 16), -8.37 + 33.2j, {}
    for speed in np.arange(10.0, 30.01, 0.2):
        values = model.eigenvalues(speed)
        flutters = values[np.abs(values - flutters).argmin()]
        followed[round(float(speed), 2)] = flutters
    return followed


@pytest.mark.parametrize("speeds", [[30.0, 10.0, 20.0], *studies([0.0, 10.0, 20.0, 30.0, 40.0])])
def test_the_mode_that_flutters_is_one_column_however_coarse_the_speeds_as_galerkins_in_small_steps(speeds):
    followed = fluttering_of_the_reference()
    found = stability(scene({"elements": 12}), speeds)
    assert found.curves is not None and found.curves.doubtful() == []
    assert not np.isnan(found.eigenvalues).any() and found.eigenvalues.shape[1] == 8
    inside = found.out_of_plane[0] < 0.5
    first = int(np.flatnonzero(found.speed == 10.0)[0])
    (column,) = np.flatnonzero(inside & (np.abs(found.eigenvalues[first] - followed[10.0]) < 1e-2 * 34.0))
    for speed, value in zip(found.speed, found.eigenvalues[:, column], strict=True):
        if 10.0 <= speed <= 30.0:
            assert value == pytest.approx(followed[speed], abs=5e-3 * abs(value))
            assert (value.real > 0.0) == (speed > 14.0)


def test_a_straight_hose_is_followed_whichever_plane_its_shapes_lie_in():
    fine, coarse = (stability(pipe(0.3, 10), np.arange(0.0, 16.1, step)) for step in (0.25, 4.0))
    assert coarse.curves is not None and coarse.curves.doubtful() == []
    some = np.searchsorted(fine.speed, coarse.speed)
    np.testing.assert_allclose(coarse.eigenvalues, fine.eigenvalues[some], rtol=1e-6, atol=1e-6)


def test_a_hose_of_sixty_elements_tied_by_multipliers_flutters_where_one_of_ten_does():
    (few, many) = (
        crossings(scene({"elements": n}, coupling="lagrange"), [13.5, 14.2], "in")[0].speed for n in (10, 60)
    )
    assert many == pytest.approx(few, rel=1e-4)


def test_what_nothing_holds_is_no_growth_in_a_hose_of_many_elements():
    # a hose on a pin without gravity turns as it likes: that is an eigenvalue of zero twice, which rounding parts
    pinned = scene({"elements": 64, "root_support": "pinned"}, gravity=[0, 0, 0])
    assert not stability(pinned, [0.0, 12.0]).grows.any()


def test_hose_without_water_has_the_frequencies_of_a_cantilever():
    # the first three in both planes; measured 1e-7, 5e-6, 4e-5 at 16 elements
    hose = {"length": 1.0, "elements": 16, "axial_stiffness": 1e6, "bending_stiffness": 1.0, "mass_per_length": 1.0}
    rest = hoses.dry_at_rest(scene(hose | {"damping": 0.0}, False, gravity=[0, 0, 0]))
    found = found_by.vibrations(*rest).value
    roots = np.array([1.8751040687119611, 4.6940911329741745, 7.8547574382376125])
    assert found[:6].imag == pytest.approx(np.repeat(roots**2, 2), rel=1e-4)


def test_hose_pinned_at_its_root_swings_as_a_rod():
    # a stiff rod about its end: omega^2 = 3 g / 2 L, in both planes; measured -8e-7 and 2e-7
    hose = {"bending_stiffness": 10.0, "axial_stiffness": 1e6, "damping": 0.0, "direction": [0, 0, -1]}
    rest = hoses.dry_at_rest(scene(hose | {"root_support": "pinned"}, False))
    found = found_by.vibrations(*rest).value
    assert found[:2].imag == pytest.approx(np.sqrt(1.5 * 9.81 / 0.5), rel=3e-6)


def test_eigenvalues_of_a_large_hose_by_sparse_algebra_are_those_by_dense(monkeypatch):
    # measured 9e-12
    rest = at_rest(scene(), 12.0)
    dense = found_by.vibrations(rest.system, rest.state, 6)
    monkeypatch.setattr(found_by, "DENSE", 10)
    sparse = found_by.vibrations(rest.system, rest.state, 6)
    assert sparse.value == pytest.approx(dense.value, rel=1e-9)
    for one, other in zip(sparse.shape.T, dense.shape.T, strict=True):
        like = abs(np.vdot(one, other)) / np.linalg.norm(one) / np.linalg.norm(other)
        assert like == pytest.approx(1, abs=1e-6)
    with pytest.raises(ValueError, match="too many for all"):
        found_by.vibrations(rest.system, rest.state)


# Standing pipes: Greenhill's column at 7.837, held up by the flow beyond it
def standing(gamma, n=8):
    """The same pipe with its free end up, of weight gamma = (m + M) g L^3 / EJ."""
    section = {"length": 1.0, "elements": n, "axial_stiffness": 1e6, "bending_stiffness": 1.0, "damping": 0.0}
    section |= {"mass_per_length": 0.8, "direction": [0, 0, 1]}
    return scene(section, {"mass_per_length": 0.2}, gravity=[0, 0, -gamma])


GALERKIN = reference.Pipe(20)
FALLS = {8.0: (5.0108, 12.66), 20.0: (4.1336, 10.92)}
"""Where it flutters at last, (u, omega) by weight: `reference.critical_speeds(0.2, gamma=-gamma, upto=6.0)`."""


def galerkin_growth(u, gamma):
    return GALERKIN.eigenvalues(u, 0.2, gamma=-gamma)[: GALERKIN.modes].real.max()


@pytest.mark.parametrize(("gamma", "between"), [(8.0, (0.3, 0.9)), *studies((20.0, (2.0, 3.8)))])
def test_a_standing_pipe_beyond_greenhills_weight_diverges_without_flow_and_stands_up_with_it(gamma, between):
    # measured at 8 elements: 6e-5 and 5e-5 where it stands up, 1.2e-4 and 4e-5 where it flutters
    found = stability(standing(gamma))
    assert found.grows[0] and found.speed[0] == 0.0
    # what falls is among the modes that are followed, and drawn
    assert found.eigenvalues[0].real.max() == pytest.approx(galerkin_growth(0.0, gamma), rel=1e-3)
    first, last = found.critical[0], found.critical[-1]
    assert (first.speed, first.kind) == (0.0, "divergence")
    stands = brentq(lambda u: galerkin_growth(u, gamma), *between, xtol=1e-12)
    assert found.stable_from * np.sqrt(0.2) == pytest.approx(stands, rel=1e-3)
    exact, _ = reference._polish_galerkin(GALERKIN, *FALLS[gamma], 0.2, 0.0, -gamma)
    assert exact == pytest.approx(FALLS[gamma][0], abs=1e-4)
    assert last.kind == "flutter"
    assert last.speed * np.sqrt(0.2) == pytest.approx(exact, rel=1e-3)


def test_a_standing_pipe_below_greenhills_weight_stands_without_flow():
    found = stability(standing(7.7), np.linspace(0.0, 4.0, 5))
    assert not found.grows.any() and not found.critical and found.stable_from is None


@pytest.mark.parametrize("stiffness", [*studies(1e5, 1e6), 1e7])
def test_springs_beside_multipliers_change_no_critical_speed_however_stiff_the_pipe(stiffness):
    # with the springs themselves, at 1e7, "flutter" began at a twentieth of the speed
    along = {"axial_stiffness": stiffness}
    speeds = [onset(pipe(0.2, 10, along, coupling=each), 0.2, 5.59)[0] for each in ("linear", "augmented")]
    assert speeds[1] == pytest.approx(speeds[0], rel=1e-9)


@pytest.mark.parametrize("jet", [1e4, *studies(1e3, 1e6)])
def test_flutter_by_the_jet_of_a_narrow_nozzle_is_found_though_the_water_in_the_hose_hardly_moves(jet):
    """A nozzle makes a pipe of the mass ratio beta/jet and the speed u sqrt(jet) (`reference.characteristic`)."""
    beta = 0.6
    exact, omega = crossing(beta / jet, 4.19, 14.6)
    found = stability(pipe(beta, 12, {"axial_stiffness": 1e6}, outlet=jet)).critical[0]
    # It was called stable up to 100 times this speed, at which the search began.
    assert found.speed * np.sqrt(beta * jet) == pytest.approx(exact, rel=CLAIMED)
    assert 2 * np.pi * found.frequency == pytest.approx(omega, rel=CLAIMED)
