"""A bit that drills: weight on bit, depth of the hole and torque against closed forms and independent integrations."""

from math import exp, pi, sqrt, tan

import numpy as np
import pytest
from physics.wells.strings import COLLAR, DENSITY, GRAVITY, E, area, mass_per_length, run, straight_hole
from scipy.integrate import solve_ivp
from scipy.linalg import eigh
from scipy.optimize import brentq

from drillstring.model.build import build
from tautline.integrators.linearise import matrices
from tautline.results.result import Result
from tautline.run import Run
from tautline.simulation import simulate

WEIGHT, RPM = 5e4, 2.0 * pi / 60.0
SECTION = area(*COLLAR)


def drilled(length=400.0, elements=4, speed=120 * RPM, feed=0.0, weight=WEIGHT, **changes):
    """A collar that turns steadily from the start and is lowered at a constant speed, its bit on the bottom."""
    bit = {"on_bottom": True, "weight": weight} | changes.pop("bit", {})
    whole = {
        "length": length, "elements": elements, "bit": bit, "top__rotation": speed, "well__wall": "none",
        "top__block": {"velocity": feed}, "solver__end": 10.0, "solver__step": 5e-3, "output__interval": 0.05,
    }  # fmt: skip
    return straight_hole(0.0, **(whole | changes))


PENETRATION = {"rate": "20 m/h", "speed": "120 rpm"}
FEED = 20.0 / 3600.0
CUTTING = {
    "specific_energy": "150 MPa", "contact_strength": "100 MPa", "wear_flat": "1.2 mm", "friction": 0.7,
    "bit_constant": 0.9, "inclination": 0.6, "radius": 0.108,
}  # fmt: skip


@pytest.mark.parametrize("start", ["static", "relaxed", "straight"])
@pytest.mark.parametrize("weight", [0.0, WEIGHT, 2e5])
def test_weight_on_bit_at_the_start_is_what_the_scene_says_wherever_the_string_begins(start, weight):
    result = run(drilled(speed=0.0, weight=weight, start=start, solver__end=0.1))
    assert result["weight_on_bit"][0] == pytest.approx(weight, rel=1e-9, abs=1e-3)
    if start == "static":
        string = mass_per_length() * GRAVITY * 400.0
        assert result["hook_load"][0] == pytest.approx(string - weight, rel=1e-9)
        assert np.ptp(result["weight_on_bit"]) < 1e-3
        # EA u = G L / 2 - W L, and the rock gives W / k
        stretch = (string / 2.0 - weight) * 400.0 / (E * SECTION)
        assert result["bit_depth"][0] == pytest.approx(400.0 + stretch, abs=1e-9)
        assert result["hole_depth"][0] == pytest.approx(400.0 + stretch - weight / 2.5e7, abs=1e-9)


@pytest.mark.parametrize("stiffness", [1e7, 1e9])
def test_a_rod_on_a_spring_of_rock_swings_at_its_closed_form_frequencies(stiffness):
    """Held at its top: tan(b) / b = -E A / (k L), b = omega L / c. 80 elements, whose error is (b / n)^2 / 24."""
    length, n = 400.0, 80
    model = build(drilled(length, n, speed=0.0, bit={"rock": {"stiffness": stiffness}}))
    going = Run(model)
    going.start()
    from tautline.results.store import Store

    with Store(None, model.variables, model.coordinates, dict(model.attributes)) as store:
        going.store_first(store)
    mass, _, stiff = matrices(model.system, going.state)
    along = [i for i, name in enumerate(model.system.names) if name.endswith("along the hole")]
    found = np.sqrt(eigh(stiff[np.ix_(along, along)], mass[np.ix_(along, along)], eigvals_only=True))
    ratio = E * SECTION / (stiffness * length)
    c = sqrt(E / DENSITY)
    for mode in range(3):
        low, high = (mode + 0.5) * pi, (mode + 1.0) * pi
        b = brentq(lambda b: tan(b) + b * ratio, low + 1e-9, high - 1e-12)
        assert found[mode] == pytest.approx(b * c / length, rel=(b / n) ** 2 / 20.0 + 1e-6)


def test_ten_metres_are_drilled_at_the_speed_of_the_block_with_the_weight_that_it_takes():
    """Block speed is the rate of penetration at that weight and speed: all stays as it is, and the hole deepens."""
    feed = 0.25
    law = {"rate": feed, "speed": "120 rpm"}
    # A torque that falls with the weight, and a weight that falls with the speed, would drive oscillations that grow.
    torque = {"static": 400.0, "kinetic": 300.0}
    result = run(drilled(feed=feed, bit={"penetration": law, "torque": torque}, solver__end=40.0))
    assert result["weight_on_bit"] == pytest.approx(WEIGHT, rel=1e-6)
    assert result["rate_of_penetration"] == pytest.approx(feed, rel=1e-6)
    assert np.ptp(result["hole_depth"]) == pytest.approx(10.0, rel=1e-7)
    assert result["bit_depth"] - result["hole_depth"] == pytest.approx(WEIGHT / 2.5e7, rel=1e-5)
    assert result["bit_depth"][-1] > 409.9, "ten metres past the end of the well"
    assert result["torque_on_bit"] == pytest.approx(300.0, rel=1e-5)
    # Work of the drive, of the block against the hook load, and of the weight: into the rock goes (T Omega + W v) t.
    assert result["dissipated_energy"][-1] == pytest.approx((300.0 * 120 * RPM + WEIGHT * feed) * 40.0, rel=1e-6)
    assert result.headline["drilled"]["value"] == pytest.approx(10.0, rel=1e-7)
    assert result.headline["rate_of_penetration_mean"]["value"] == pytest.approx(feed, rel=1e-6)


def test_a_string_that_is_held_drills_off_its_weight_as_an_exponential():
    """dW/dt = -k' dW, k' = c / (1 / k_string + 1 / k_rock): a massless string to the first order; torsion stays."""
    weight_rate = 2.0 / 3600.0 / WEIGHT  # m/s per newton
    law = {"rate": "2 m/h", "speed": "120 rpm"}
    result = run(drilled(elements=1, bit={"penetration": law, "rock": {"stiffness": 2e7}}, solver__end=40.0))
    spring = 1.0 / (1.0 / 2e7 + 400.0 / (E * SECTION))
    expected = WEIGHT * np.exp(-spring * weight_rate * result.time)
    # It begins with a bit at rest on a hole that deepens: that swings by k v / omega, 0.7 % of the weight.
    assert result["weight_on_bit"] == pytest.approx(expected, abs=1e-2 * WEIGHT)
    assert exp(-spring * weight_rate * 40.0) < 0.1


@pytest.mark.parametrize("exponents", [(1.0, 1.0), (1.4, 0.7), (0.6, 1.3)])
def test_a_faster_block_finds_the_weight_that_drills_as_fast(exponents):
    """rate ((W - T) / (W0 - T))^a (Omega / Omega0)^b = block speed."""
    a, b = exponents
    threshold, share = 5e3, 1.5
    law = PENETRATION | {"threshold": threshold, "weight_exponent": a, "speed_exponent": b, "rate": "200 m/h"}
    law["speed"] = "90 rpm"
    feed = share * 200.0 / 3600.0
    result = run(drilled(elements=1, feed=feed, bit={"penetration": law}, solver__end=60.0, solver__rho_inf=0.5))
    weight = threshold + (WEIGHT - threshold) * (share * (90.0 / 120.0) ** b) ** (1.0 / a)
    assert result["weight_on_bit"][-1] == pytest.approx(weight, rel=1e-4)


@pytest.mark.parametrize("blades", [None, 5])
def test_a_drag_bit_that_drills_steadily_has_the_weight_and_torque_of_detournay_and_defourny(blades):
    """W = a zeta eps d + W_f, T = a^2 eps d / 2 + mu gamma a W_f / 2, d = 2 pi rate / Omega, W_f = a l sigma.

    The specific energy E = 2 T / (a^2 d) and the drilling strength S = W / (a d) lie on their friction line
    E = (1 - mu gamma zeta) eps + mu gamma S (Detournay and Defourny, Int. J. Rock Mech. Min. Sci. 29, 1992).
    """
    a, zeta, eps, mu, gamma, flat, sigma = 0.108, 0.6, 150e6, 0.7, 0.9, 1.2e-3, 100e6
    spin, worn = 120 * RPM, 0.108 * 1.2e-3 * 100e6
    depth = (WEIGHT - worn) / (a * zeta * eps)
    feed = depth * spin / (2.0 * pi)
    cutting = CUTTING | ({} if blades is None else {"blades": blades})
    # One element: a longer chain of lumps begins to swing by itself where blades cut what the last one left.
    result = run(drilled(elements=1, feed=feed, bit={"cutting": cutting}, solver__end=3.0))
    torque = 0.5 * a**2 * eps * depth + 0.5 * mu * gamma * a * sigma * a * flat
    assert result["weight_on_bit"] == pytest.approx(WEIGHT, rel=1e-4)
    assert result["torque_on_bit"] == pytest.approx(torque, rel=1e-4)
    assert result["rate_of_penetration"] == pytest.approx(feed, rel=1e-4)
    assert np.ptp(result["hole_depth"]) == pytest.approx(3.0 * feed, rel=1e-4)
    specific, strength = 2.0 * result["torque_on_bit"] / (a**2 * depth), result["weight_on_bit"] / (a * depth)
    assert specific == pytest.approx((1.0 - mu * gamma * zeta) * eps + mu * gamma * strength, rel=1e-4)


def test_below_the_weight_of_its_worn_flats_a_drag_bit_rubs_and_does_not_drill():
    result = run(drilled(weight=1e4, bit={"cutting": CUTTING}, solver__end=2.0))
    assert np.ptp(result["hole_depth"]) == 0.0
    assert result["torque_on_bit"] == pytest.approx(0.5 * 0.7 * 0.9 * 0.108 * 1e4, rel=1e-6)


def test_blades_that_cut_what_the_last_one_left_swing_as_the_delay_equation_says():
    """One axial lump M on a spring K_s at constant speed: M x'' = -K_s x - n a zeta eps (x(t) - x(t - 2 pi / n Omega)).

    The independent solution is DOP853 from delay to delay, about steady drilling; the block's speed is raised a little
    at the start, which sets it swinging.
    """
    blades, spin, length = 4, 100 * RPM, 200.0
    a_zeta_eps = 0.108 * 0.6 * 40e6
    depth = WEIGHT / a_zeta_eps
    feed = depth * spin / (2.0 * pi)
    # Nearly all of the cutting force is along the hole: torque would twist the string, and change the speed.
    cutting = {"specific_energy": "0.4 MPa", "inclination": 60.0, "radius": 0.108, "blades": blades}
    push, rise, end = 0.02, 0.025, 1.2
    bump = {"table": {"time": [0.0, rise, 2.0 * rise], "value": [0.0, push, 0.0]}}
    block = {"velocity": {"sum": [feed, bump]}}
    scene = drilled(
        length, 1, spin, bit={"cutting": cutting}, top__block=block, solver__end=end, solver__step=5e-4,
        output__interval=1e-2, solver__rho_inf=1.0,
    )  # fmt: skip
    # The blades cut upwards more than around: where the bit moves up the rock gives back what nobody put into it.
    result = run(scene, energy=0.02)
    mass, spring = mass_per_length() * length / 2.0, E * SECTION / length
    delay, stiff = 2.0 * pi / (blades * spin), blades * a_zeta_eps
    pieces = []

    def pushed(t):
        x = min(t / rise, 2.0)
        return push * rise * (0.5 * x**2 if x < 1.0 else 1.0 - 0.5 * (2.0 - x) ** 2)

    def before(t):
        if t <= 0.0:
            return 0.0
        return pieces[min(int(t / delay), len(pieces) - 1)](t)[0]

    state, t = [0.0, 0.0], 0.0
    while t < end:

        def slope(t, y):
            return [y[1], (spring * (pushed(t) - y[0]) - stiff * (y[0] - before(t - delay))) / mass]

        piece = solve_ivp(slope, (t, t + delay), state, "DOP853", rtol=1e-9, dense_output=True, max_step=5e-3)
        pieces.append(piece.sol)
        state, t = piece.y[:, -1], t + delay
    found = result["bit_depth"] - result["bit_depth"][0] - feed * result.time
    exact = np.array([pieces[min(int(t / delay), len(pieces) - 1)](t)[0] for t in result.time])
    assert np.abs(exact).max() > 1e-3, "it grows"
    assert found == pytest.approx(exact, abs=0.01 * np.abs(exact).max())


def test_a_bit_that_is_picked_up_drills_no_more_and_touches_again_where_it_left():
    block = {"table": {"time": [0.0, 2.0, 4.0, 6.0, 8.0], "value": [0.0, -0.2, -0.2, 0.0, 0.0]}}
    scene = drilled(
        bit={"penetration": PENETRATION, "torque": {"static": 4e3, "kinetic": 3e3}}, top__block=block, solver__end=8.0
    )
    result = run(scene)
    off = (result.time > 2.5) & (result.time < 4.0)
    assert np.all(result["weight_on_bit"][off] == 0.0) and np.all(result["torque_on_bit"][off] == 0.0)
    assert np.ptp(result["hole_depth"][off]) == 0.0
    assert np.all(np.diff(result["hole_depth"]) >= 0.0)
    assert result["weight_on_bit"][result.time > 5.0].max() > 0.3 * WEIGHT


@pytest.mark.parametrize("kind", ["lumped", "ale-ancf"])
def test_blades_with_worn_flats_hang_free_off_bottom_and_drill_on_from_the_bottom_that_they_left(kind):
    """Off bottom the hook bears m g L and nothing rubs. Set down by s more, drilling off leaves the weight a l sigma of
    the flats on the bit: the hole is deeper by s less what that presses the string, (a l sigma - W0) L / (E A).
    """
    first, worn, lower, length = 1e4, 0.108 * 1.2e-3 * 100e6, 0.01, 400.0
    block = {"table": {"time": [0.0, 0.5, 2.5, 4.0, 6.0], "value": [0.0, 0.0, -0.2, -0.2, lower]}}
    cutting = CUTTING | {"blades": 4}
    scene = drilled(
        length, 3, bit={"cutting": cutting}, weight=first, top__block=block, model__kind=kind, solver__end=17.0,
        solver__rho_inf=0.5, damping={"structural": 2e-2},
    )  # fmt: skip
    result = run(scene)
    deep, spent = result["hole_depth"], result["dissipated_energy"]
    weight, torque = result["weight_on_bit"], result["torque_on_bit"]
    turning = 0.5 * 0.7 * 0.9 * 0.108 * worn
    off, last = (result.time > 1.0) & (result.time < 4.5), result.time > 16.0
    assert np.all(weight[off] == 0.0) and np.all(torque[off] == 0.0)
    hang = (result.time > 3.5) & (result.time < 4.0)
    assert result["hook_load"][hang] == pytest.approx(mass_per_length() * GRAVITY * length, rel=1e-4)
    # All that is lost is what damps the swings after letting go: next to nothing beside flats that went on rubbing.
    rubbing = turning * 120 * RPM
    assert np.ptp(spent[hang]) < 1e-3 * rubbing * 0.5
    assert weight[last] == pytest.approx(worn, rel=1e-3) and torque[last] == pytest.approx(turning, rel=1e-3)
    assert np.ptp(spent[last]) == pytest.approx(rubbing * np.ptp(result.time[last]), rel=2e-3)
    drilled_by = lower - (worn - first) * length / (E * SECTION)
    assert deep[-1] - deep[0] == pytest.approx(drilled_by, abs=1e-2 * lower)
    assert np.ptp(deep[result.time < 5.0]) < 1e-9


@pytest.mark.parametrize("blades", [None, 3])
def test_a_run_that_is_gone_on_with_drills_the_same_hole(tmp_path, blades):
    """What the rock remembers, the bottom as blades left it too, is in the result."""
    cutting = CUTTING | ({} if blades is None else {"blades": blades})
    keys = {"feed": 0.004, "bit": {"cutting": cutting}, "elements": 2, "length": 200.0}
    simulate(build(drilled(**keys, solver__end=1.0)), tmp_path / "half.nc")
    whole = run(drilled(**keys, solver__end=2.0))
    half = Result.read(tmp_path / "half.nc")
    on = simulate(build(drilled(**keys, solver__end=2.0)), resume=half)
    for name in ("weight_on_bit", "torque_on_bit", "hole_depth", "rotation_rate"):
        assert np.allclose(on[name], whole[name], rtol=1e-9, atol=1e-9), name


@pytest.mark.parametrize("method", ["generalized-alpha", "rk4"])
def test_energy_balances_while_a_bit_drills_sticks_and_slips(method):
    """The drive's work goes into motion, strain of string and rock, and what rock and bit take."""
    bit = {
        "penetration": PENETRATION, "torque": {"static": 9e3, "kinetic": 6e3, "decay": "10 rpm"}, "weight": 1e5,
        "rock": {"damping": 1e4},
    }  # fmt: skip
    rotation = {"controller": {"speed": {"ramp": {"to": "80 rpm", "over": 2.0}}, "proportional": 1000.0}}
    rotation["controller"] |= {"integral": 500.0, "inertia": 2000.0}
    step = 2e-4 if method == "rk4" else 1e-3
    scene = drilled(
        1000.0, 5, bit=bit, feed=FEED, top__rotation=rotation, solver__method=method, solver__step=step,
        solver__end=8.0,
    )  # fmt: skip
    result = run(scene, energy=2e-3)
    kept = result["kinetic_energy"] + result["strain_energy"] + result["potential_energy"]
    gone = kept - kept[0] + result["dissipated_energy"] - result["external_work"]
    assert np.abs(gone).max() < 2e-3 * result["external_work"].max()
    assert result.headline["rotation_stuck"]["value"] > 0.05


def test_a_beam_drills_and_sticks_as_lumps_do():
    """The bit knows its string by its depth and rotation alone: in both torsion is the same chain."""
    bit = {"penetration": PENETRATION, "torque": {"static": 8e3, "kinetic": 5e3, "decay": "60 rpm"}}
    ramp = {"ramp": {"to": 5.0, "over": 1.0}}
    one, other = (
        run(
            drilled(
                1000.0, 6, ramp, FEED, bit=bit, model__kind=kind, model__bending="stiff", solver__end=6.0,
                damping={"structural": 2e-3},
            )
        )
        for kind in ("lumped", "ale-ancf")
    )  # fmt: skip
    assert other["weight_on_bit"][0] == pytest.approx(WEIGHT, rel=1e-9)
    spin, peak = one["rotation_rate"][:, -1], one["rotation_rate"][:, -1].max()
    assert peak > 7.0 and (np.abs(spin) < 1e-5).mean() > 0.1, "it sticks and slips"
    assert other["rotation_rate"][:, -1] == pytest.approx(spin, abs=0.03 * peak)
    for name in ("torque_on_bit", "weight_on_bit"):
        assert other[name] == pytest.approx(one[name], abs=0.05 * np.abs(one[name]).max()), name
    assert np.ptp(other["hole_depth"]) == pytest.approx(np.ptp(one["hole_depth"]), rel=0.02)
