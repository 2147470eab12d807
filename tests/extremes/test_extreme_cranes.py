"""Cranes at the edge of what makes sense: right, or stopped by name; never NaN in what is stored, never silent.

Where nothing else is said it is the hoist of hoist.yaml without its vessel: 5 t at z = 5 m, hoisted by 1 m in the first
second and by 2 m/s after it, over a boom tip at 30 m. All that a run stores is finite and its energy balances.
"""

import numpy as np
import pytest
import yaml
from physics.lifting.crane_scenes import (
    GRAVITY,
    HOISTING,
    anchor,
    block_of_falls,
    body,
    crane,
    drum,
    end,
    fall,
    hoist,
    imbalance,
    model_of,
    parsed,
    ran,
    sheave,
    solved,
    stopped,
)
from references import cables

import tautline
from crane.application import Crane
from crane.warnings import warnings
from tautline.cli.run import ExitCode, run
from tautline.cli.verbs import make_app
from tautline.integrators.status import Status, StoppedEarly
from tautline.results.result import Result
from tautline.scene.errors import SceneError
from tautline.simulation import simulate

MASS, WEIGHT, HEIGHT, RISE = 5000.0, 5000.0 * GRAVITY, 5.0, 1.0
FIXED = {"control": "fixed"}
FRICTIONLESS = {"law": "frictionless"}
AT_REST = {"pay_out": 0.0}
WEIGHTLESS = {"mass_per_length": 0.01}


def height(result, row=-1):
    return result["body_position"][row, 0, 2]


def hook(result, row=0):
    return result["tension"][row, -1, 1]


def hangs(result, mass=MASS):
    """The payload begins at rest where it is drawn, and the hook holds what it weighs."""
    assert height(result, 0) == pytest.approx(HEIGHT, abs=1.0e-6)
    assert hook(result) == pytest.approx(mass * GRAVITY, rel=1.0e-6)


@pytest.fixture(scope="module")
def usual():
    """The hoist over two seconds in steps of 0.2 ms."""
    return ran(hoist(solver={"end": 2.0, "step": 2.0e-4}))


# the rope
@pytest.mark.parametrize("EA", [1.0e5, 1.0e6, 1.0e8, 1.0e10, 1.0e12])
def test_a_stiffness_of_1e5_to_1e12(EA):
    """A payload on a rope of 57 m follows its drum but for the bounce: at most twice what the start adds to stretch."""
    result = ran(hoist(rope={"axial_stiffness": EA}))
    hangs(result)
    started = MASS * 3.75 * 57.0 / EA
    assert height(result) == pytest.approx(HEIGHT + RISE, abs=2.0 * started + 1.0e-3)
    assert result["tension"].max() < WEIGHT + 2.0 * MASS * 3.75 + 3000.0
    assert imbalance(result) < 2.0e-3


@pytest.mark.parametrize("EA", [1.0e5, 1.0e6, 1.0e8, 1.0e10, 1.0e12])
def test_a_rope_as_drawn_catches_its_load_whatever_its_stiffness(EA):
    """It begins without strain: at most a snap without fall, twice the weight, and what the start adds."""
    result = ran(hoist(rope={"axial_stiffness": EA}, start="as drawn"))
    assert height(result, 0) == HEIGHT
    assert result["tension"].max() < 2.5 * (WEIGHT + MASS * 3.75)
    assert imbalance(result) < 2.0e-3


@pytest.mark.parametrize("rope", [1.0e-3, 0.1, 100.0])
def test_a_rope_from_a_gram_to_a_hundredweight_per_metre(rope):
    result = ran(hoist(rope={"mass_per_length": rope}))
    hangs(result)
    # more by its own weight at the drum, as high as the boom tip
    over = result["tension"][0, 0, 1] - result["tension"][0, 0, 0]
    assert over == pytest.approx(rope * GRAVITY * 30.0, rel=0.03)
    assert height(result) == pytest.approx(HEIGHT + RISE, abs=0.05)


@pytest.mark.parametrize("mass", [1.0e3, 1.0e6, 1.0e8])
def test_a_payload_of_one_to_a_hundred_thousand_tonnes(mass):
    """EA grows with it beyond 5 t, so that the rope does not only stretch: mass ratios of 10 to 1e6."""
    result = ran(hoist(mass=mass, rope={"axial_stiffness": 8.0e7 * max(1.0, mass / MASS)}))
    hangs(result, mass)
    assert height(result) == pytest.approx(HEIGHT + RISE, abs=0.02)


@pytest.mark.parametrize("mass", [1.0e-3, 1.0, 50.0])
def test_a_payload_too_light_to_keep_the_rope_from_running_back_is_refused_by_name(mass):
    """The hook's side weighs less than the catenary to the winch: there is no rest."""
    stop = stopped(hoist(mass=mass), Status.NO_EQUILIBRIUM)
    assert stop.time == 0.0 and "equilibrium" in stop.sentence


def test_a_rope_of_ten_tonnes_a_metre_is_refused_for_its_longer_side_outweighs_the_other_and_the_payload():
    """The side of the hook is 25 m high and that of the winch 30 m: at the drum the rope would have to push."""
    mass_per_length = 1.0e4
    assert MASS + mass_per_length * (25.0 - 30.0) < 0.0
    stop = stopped(hoist(rope={"mass_per_length": mass_per_length}), Status.NO_EQUILIBRIUM)
    assert stop.time == 0.0


# the mesh
def test_one_element_a_span_to_two_hundred():
    """From one on tensions at rest and at their largest are within 0.1 % of those of 200, the payload within 0.2 mm."""
    results = {n: ran(hoist(elements=n)) for n in (1, 2, 8, 50, 200)}
    for result in results.values():
        hangs(result)
        assert result["tension"][0, 0, 0] == pytest.approx(results[200]["tension"][0, 0, 0], rel=1.0e-3)
        assert height(result) == pytest.approx(height(results[200]), abs=2.0e-4)
        assert result["tension"].max() == pytest.approx(results[200]["tension"].max(), rel=1.0e-3)


@pytest.mark.parametrize(("elements", "close"), [(1, None), (4, 0.04), (30, 1.0e-3)])
def test_a_level_rope_between_anchors_hangs_as_a_catenary(elements, close):
    """20.2 m over 20 m. One element has no node to sag: it is slack and says so."""
    scene = crane(
        [anchor((0.0, 0.0, 0.0)), anchor((20.0, 0.0, 0.0), "other")],
        rope={"length": 20.2},
        mesh={"elements_per_span": elements},
    )
    result = ran(scene)
    if close is None:
        assert (result["tension"] == 0.0).all()
        return
    exact = cables.catenary(20.0, 0.0, 20.2, 8.0e7, 6.5 * GRAVITY, "green")
    assert result["tension"][0, 0] == pytest.approx(np.linalg.norm(exact.end_forces, axis=1), rel=close)
    assert np.ptp(result["position"], axis=0).max() < 1.0e-6


@pytest.mark.parametrize("elements", [1, 4, 30])
def test_a_level_rope_as_drawn_falls_into_its_catenary_and_bounces(elements):
    path = [anchor((0.0, 0.0, 0.0)), anchor((20.0, 0.0, 0.0), "other")]
    result = ran(crane(path, rope={"length": 20.2}, start="as drawn", mesh={"elements_per_span": elements}))
    sag = np.sqrt(3.0 / 8.0 * 0.2 * 20.0)
    lowest = -result["position"][:, :, 2].min()
    assert lowest == 0.0 if elements == 1 else 0.9 * sag < lowest < 1.3 * sag


# gravity
def test_without_gravity_a_static_start_is_refused_and_hoisting_goes_on():
    with pytest.raises(SceneError, match="without gravity"):
        parsed(hoist(gravity=[0.0, 0.0, 0.0]))
    result = ran(hoist(gravity=[0.0, 0.0, 0.0], start="as drawn"))
    assert height(result) == pytest.approx(HEIGHT + RISE, abs=0.01)


@pytest.mark.parametrize("elements", [1, 4])
def test_nothing_happens_without_gravity(elements):
    """One element is exactly still; more may stir in their rounding, and the imbalance of that is told, not hidden."""
    scene = hoist(gravity=[0.0, 0.0, 0.0], start="as drawn", drive=AT_REST, elements=elements)
    try:
        result = ran(scene)
    except StoppedEarly as stop:
        assert stop.status is Status.IMBALANCE and elements > 1
        result = stop.result
    assert result["body_position"][-1, 0] == pytest.approx([12.4, 0.0, HEIGHT], abs=1.0e-4 if elements > 1 else 1e-12)


def test_a_payload_above_its_anchor_falls_as_free_or_is_refused_at_rest():
    """The rope hangs slack between, and pulls by what turns it over at the anchor: 7 mm in a second for 5 t."""
    scene = crane([anchor((0.0, 0.0, 0.0)), end("payload")], [body("payload", MASS, (0.0, 0.0, 25.0))])
    with pytest.raises(SceneError, match="no taut rope holds it up"):
        model_of(scene)
    result = ran(scene | {"start": "as drawn"})
    assert height(result) == pytest.approx(25.0 - 0.5 * GRAVITY, abs=0.01)


# the step
@pytest.mark.parametrize(
    ("step", "close"), [(1e-4, 1e-5), (1e-3, 1e-5), (1e-2, 3e-4), (0.05, 3e-3), (0.1, 5e-3), (0.5, 0.05)]
)
def test_fixed_steps_of_a_tenth_of_a_millisecond_to_half_a_second(step, close, usual):
    """Height after two seconds, m: the bounce of 60 ms is lost from 50 ms on, and the mean is kept."""
    # The worst frame counts: in steps of half a second the ledger is 4.5 % off between the first and the last.
    energy = 0.02 if step < 0.5 else 0.05
    result = ran(hoist(solver={"end": 2.0, "step": step} | FIXED, interval=max(step, 0.01)), energy=energy)
    hangs(result)
    assert height(result) == pytest.approx(height(usual), abs=close)


@pytest.mark.parametrize("step", [1.0e-4, 5.0e-3, 0.05, 0.5, "auto"])
def test_a_step_that_follows_its_error_may_be_as_long_as_it_likes(step, usual):
    """0.5 mm after two seconds; frames of half a second where steps are."""
    result = ran(hoist(solver={"end": 2.0, "step": step}, interval=0.5 if step == 0.5 else 0.05))
    assert height(result) == pytest.approx(height(usual), abs=6.0e-4)
    assert imbalance(result) < 2.0e-3


@pytest.mark.parametrize("rho", [0.0, 0.3, 1.0])
def test_spectral_radii_from_none_to_one(rho, usual):
    result = ran(hoist(solver={"end": 2.0, "rho_inf": rho}))
    assert height(result) == pytest.approx(height(usual), abs=3.0e-4)
    assert result["tension"].max() == pytest.approx(usual["tension"].max(), rel=2.0e-3)


def test_newmark_lifts_as_high_as_generalized_alpha_with_as_much_tension(usual):
    result = ran(hoist(solver={"end": 2.0, "method": "newmark", "rho_inf": None}))
    assert height(result) == pytest.approx(height(usual), abs=1.0e-4)


def test_rk4_is_right_below_its_critical_step_and_stops_by_name_above():
    scene = hoist(elements=2, solver={"end": 0.5, "step": 2.0e-4})
    exact = ran(scene)
    explicit = {"method": "rk4", "rho_inf": None}
    for step in (1.0e-4, 1.0e-3, "auto"):
        result = ran(solved(scene, step=step, **explicit))
        assert height(result) == pytest.approx(height(exact), abs=1.0e-5)
        assert result["tension"].max() == pytest.approx(exact["tension"].max(), rel=1.0e-4)
    stop = stopped(solved(scene, step=0.01, **explicit), Status.UNSTABLE)
    assert "critical step" in stop.sentence


# sheaves
@pytest.mark.parametrize("radius", [1.0e-4, 1.0e-3, 0.01])
def test_sheaves_and_drums_of_a_millimetre(radius):
    """As good as a point: one and the same, whether the rope is held on the sheave or not."""
    load = {"load": {}}
    tips = [{"radius": radius} | FRICTIONLESS, {"radius": radius, "inertia": 1.0e-3 * radius**2}]
    free, held = (ran(hoist(tip=tip, drive={"pay_out": HOISTING, "radius": radius}, **load)) for tip in tips)
    point = ran(hoist(tip={"radius": 1.0e-5} | FRICTIONLESS, drive={"pay_out": HOISTING, "radius": 1.0e-5}))
    for result in (free, held):
        hangs(result)
        assert result["tension"] == pytest.approx(point["tension"], rel=max(1.0e-4, 0.05 * radius))


@pytest.mark.parametrize("friction", [0.0, 1.0e-6])
def test_a_capstan_with_next_to_no_friction_is_frictionless(friction):
    capstan = ran(hoist(tip={"law": "capstan", "friction": friction, "inertia": 20.0}))
    free = ran(hoist(tip=FRICTIONLESS))
    assert capstan["tension"] == pytest.approx(free["tension"], rel=1.0e-5)


@pytest.mark.parametrize("friction", [0.1, 1.0, 2.0])
def test_a_capstan_that_does_not_slip_turns_its_sheave(friction):
    capstan = ran(hoist(tip={"law": "capstan", "friction": friction, "inertia": 20.0}))
    held = ran(hoist())
    assert not capstan["slipping"].any()
    assert capstan["tension"] == pytest.approx(held["tension"], rel=2.0e-3)


def test_friction_of_five_is_refused():
    with pytest.raises(SceneError, match="must not be more than 2"):
        parsed(hoist(tip={"law": "capstan", "friction": 5.0, "inertia": 20.0}))


@pytest.mark.parametrize("friction", [0.1, 1.0])
def test_a_locked_sheave_holds_back_by_its_capstan_ratio(friction):
    """Sticks and slips: its tensions settle with the step, and never differ by more than exp(mu theta) allows."""
    coarse, fine = (
        ran(hoist(tip={"law": "capstan", "friction": friction, "locked": True}, solver={"step": step, "end": 1.0}))
        for step in (5.0e-3, 1.0e-3)
    )
    for result in (coarse, fine):
        before, after = result["axial_force"][:, 3], result["axial_force"][:, 4]
        slipping = result["slipping"][:, 0] != 0.0
        ratio = np.exp(friction * result["wrap_angle"][slipping, 0])
        assert slipping.any()
        assert before[slipping] / after[slipping] == pytest.approx(ratio, rel=0.1)
    assert coarse["tension"].max() == pytest.approx(fine["tension"].max(), rel=2.0e-3)
    assert height(coarse) == pytest.approx(height(fine), abs=5.0e-3)


# winches
TURNING = {"inertia": 500.0}
REDUCED = 500.0 / 0.5**2
"""Inertia of the drum at its rim, kg."""


@pytest.mark.parametrize("step", [5.0e-3, 1.0e-3])
def test_a_load_falls_freely_with_its_drum_as_the_brake_lets_go(step):
    """a = g M / (M + I / R^2), of the momentum of both: as if released at 2.0006 s, on the way of the brake's opening.

    Held for two seconds before, nothing creeps by a nanometre.
    """
    brake = {"torque": 60.0e3, "until": 2.0}
    scene = hoist(rope=WEIGHTLESS, tip=FRICTIONLESS, drive={"torque": 0.0, "brake": brake} | TURNING)
    result = ran(solved(scene, end=3.0, step=step))
    time, out = result["time"], result["paid_out"][:, 0]
    drop = HEIGHT - result["body_position"][:, 0, 2]
    held = time < 1.999
    assert np.abs(drop[held]).max() < 1.0e-9 and np.abs(out[held]).max() < 1.0e-9
    assert result["drum_tension"][held] == pytest.approx(WEIGHT, rel=1.0e-3)
    fallen = (MASS * drop + REDUCED * out) / (MASS + REDUCED)
    acceleration = MASS * GRAVITY / (MASS + REDUCED)
    # a quintic opens the brake in 1 ms; the load lets go on the way
    late = time > 2.05
    assert time[late] - np.sqrt(2.0 * fallen[late] / acceleration) == pytest.approx(2.0006, abs=4.0e-4)
    assert imbalance(result) < 1.0e-3


@pytest.mark.parametrize("tension", [40.0e3, WEIGHT, 60.0e3])
@pytest.mark.parametrize("gain", [0.0, 2.0])
def test_a_winch_of_constant_tension_lifts_and_lowers_by_what_it_lacks(tension, gain):
    """T less the weight accelerates payload and drum, which a gain makes lighter by 1 + gain."""
    gains = {"gains": {"proportional": gain}} if gain else {}
    scene = hoist(rope=WEIGHTLESS, tip=FRICTIONLESS, drive={"tension": tension} | TURNING | gains, solver={"end": 2.0})
    result = ran(scene)
    acceleration = (tension - WEIGHT) / (MASS + REDUCED / (1.0 + gain))
    assert height(result) == pytest.approx(HEIGHT + 2.0 * acceleration, abs=0.01)


def test_a_winch_whose_controller_integrates_holds_its_tension():
    """What it lacks fades as exp(-k_i t / (1 + k_p + m / M)); the rope is damped, for an integral drives its bounce."""
    gains = {"proportional": 2.0, "integral": 5.0}
    drive = {"tension": 60.0e3, "gains": gains} | TURNING
    rope = WEIGHTLESS | {"damping": 0.01}
    result = ran(hoist(rope=rope, tip=FRICTIONLESS, drive=drive, solver={"end": 3.0}))
    share = 1.0 + 2.0 + REDUCED / MASS
    time = result["time"]
    lack = REDUCED / MASS * (60.0e3 - WEIGHT) / share * np.exp(-5.0 * time / share)
    late = time > 0.8
    assert result["drum_tension"][late, 0] == pytest.approx(60.0e3 - lack[late], rel=5.0e-3)


def two_drums(**drive):
    """A block between two drums, of which the first hauls in 1 m/s of rope."""
    path = [
        drum((-12.0, 0.0, 0.0), pay_out={"ramp": {"to": -1.0, "over": 1.0}}),
        sheave((0.0, 0.0, 30.0), name="tip 1", inertia=20.0),
        sheave(None, 0.4, "under", name="hook", body="block", inertia=12.0),
        sheave((1.6, 0.0, 30.0), name="tip 2", inertia=20.0),
        drum((14.0, 0.0, 0.0), name="second", **drive),
    ]
    return crane(path, [body("block", MASS, (0.8, 0.0, HEIGHT))], solver={"end": 2.0})


BOTH = {"speed": {"ramp": {"to": -2.0, "over": 1.0}}}


def test_two_drums_lift_a_block_by_half_of_what_both_take_in():
    result = ran(two_drums(**BOTH))
    assert result["paid_out"][-1] == pytest.approx([-1.5, -1.5], abs=5.0e-3)
    assert height(result) == pytest.approx(HEIGHT + 1.5, abs=5.0e-3)
    assert result["tension"][0].mean() == pytest.approx(0.5 * WEIGHT, rel=0.05)


def test_a_drum_that_is_braked_and_one_that_hauls():
    brake = {"torque": 30.0e3, "until": 0.5}
    result = ran(two_drums(torque=14.0e3, inertia=300.0, brake=brake))
    braked, out = result["time"] < 0.499, result["paid_out"] - result["paid_out"][0]
    assert np.abs(out[braked, 1]).max() < 1.0e-4
    assert out[-1, 1] < -0.5
    assert height(result) - HEIGHT == pytest.approx(-0.5 * out[-1].sum(), abs=5.0e-3)


# events
LAYERS = {"turns": 10, "core_radius": 0.48, "count": 1}
DIAMETER = 0.04
CAPACITY = 10 * 2.0 * np.pi * 0.5
FILLS = {
    "by torque": {"torque": 40.0e3} | TURNING,
    "by tension": {"tension": 60.0e3} | TURNING,
}


@pytest.mark.parametrize("drive", FILLS)
@pytest.mark.parametrize("held", [25.0, None])
def test_a_drum_that_is_full_ends_the_run_by_name(drive, held):
    """Ten turns of 40 mm rope on a core of 0.48 m are 31.4 m; with 25 m on it there is room for the rest."""
    room = CAPACITY - (held or 0.0)
    more = {} if held is None else {"rope_on_drum": held}
    asked = hoist(drive=FILLS[drive] | {"layers": LAYERS} | more, rope={"diameter": DIAMETER}, solver={"end": 20.0})
    asked["bodies"][0]["position"] = (12.4, 0.0, -20.0)
    stop = stopped(asked, Status.DRUM_FULL)
    wound = -stop.result["paid_out"][-1, 0]
    # the last frame is at most 10 ms before, at a speed of 17 m/s at most
    assert room - 0.17 < wound <= room and "winch" in stop.part
    assert stop.result.attributes["status"] == "drum full"


def test_a_drum_that_heave_compensation_fills_ends_the_run_by_name_as_it_was_warned_of():
    """The tip heaves by 1 m sin wt, and the drum has room for half of it: w t = 30 degrees after a full turn."""
    vessel = {"reference": [0, 0, 0], "motion": {"heave": {"harmonic": {"amplitude": 1.0, "period": 6.0, "ramp": 6.0}}}}
    asked = hoist(
        drive={"pay_out": 0.0, "layers": LAYERS, "rope_on_drum": CAPACITY - 0.5}, rope={"diameter": DIAMETER},
        vessel=vessel, heave_compensation={"gain": 1.0}, solver={"end": 12.0},
    )  # fmt: skip
    (told,) = [warning.text for warning in warnings(parsed(asked)) if "when the drum is full" in warning.text]
    stop = stopped(asked, Status.DRUM_FULL)
    assert f"t = {stop.time:.2g}" in told
    assert -stop.result["paid_out"][-1, 0] == pytest.approx(0.5, abs=0.02)


ENDS = {
    "by pay-out": {"pay_out": {"ramp": {"to": 2.0, "over": 0.5}}},
    "by speed": {"speed": {"ramp": {"to": 4.0, "over": 0.5}}},
    "by torque": {"torque": 0.0} | TURNING,
    "by tension": {"tension": 20.0e3} | TURNING,
}


@pytest.mark.parametrize("drive", ENDS)
def test_a_rope_that_runs_out_ends_the_run_by_name_and_its_result_is_kept(drive):
    stop = stopped(hoist(drive=ENDS[drive] | {"rope_on_drum": 3.0}, solver={"end": 4.0}), Status.RUN_OUT)
    assert 0.9 < stop.time < 1.8 and "winch" in stop.part
    out = stop.result["paid_out"][-1, 0]
    # the last frame is at most 10 ms before, at a speed of 8 m/s at most
    assert 2.9 < out <= 3.0 + 1.0e-9
    assert stop.result.attributes["status"] == "run out"


def test_at_the_command_line_it_exits_with_3_and_leaves_its_file(tmp_path, capsys):
    path, made = tmp_path / "scene.yaml", tmp_path / "result.nc"
    scene = hoist(drive=ENDS["by pay-out"] | {"rope_on_drum": 3.0}, solver={"end": 4.0})
    path.write_text(yaml.safe_dump(scene), encoding="utf8")
    with pytest.raises(SystemExit) as ended:
        run(make_app(Crane(), ["simulate"]), ["simulate", str(path), "-o", str(made)])
    assert ended.value.code == ExitCode.STOPPED_EARLY == 3
    written = capsys.readouterr()
    assert "run off its drum" in written.out + written.err and "Traceback" not in written.out + written.err
    result = Result.read(made)
    assert result.attributes["status"] == "run out" and result["time"][-1] > 1.7


@pytest.mark.parametrize(
    "load",
    [
        {"velocity": (-30.0, 0.0, 30.0)},
        {"force": [{"ramp": {"to": -2.0e5, "over": 1.0}}, 0.0, {"ramp": {"to": 2.0e5, "over": 1.0}}]},
    ],
    ids=["thrown", "pulled"],
)
def test_a_payload_that_goes_round_its_boom_tip_through_its_own_rope_ends_the_run(load):
    """A sheave has place for one turn of rope."""
    stop = stopped(hoist(drive=AT_REST, load=load, solver={"end": 6.0}), Status.OFF_WHEEL)
    assert "boom tip" in stop.part and "whole turn" in stop.sentence
    assert 0.9 * 2.0 * np.pi < stop.result["wrap_angle"][-1, 0] < 2.0 * np.pi


def test_a_payload_that_is_thrown_up_past_the_line_of_its_rope_takes_it_off_the_boom_tip():
    load = {"velocity": (30.0, 0.0, 30.0)}
    stop = stopped(hoist(drive=AT_REST, load=load, solver={"end": 6.0}), Status.OFF_WHEEL)
    assert "boom tip" in stop.part and "passes it by" in stop.sentence
    assert stop.result["wrap_angle"][-1, 0] < 0.3 and stop.result["body_position"][-1, 0, 2] > 30.0


def test_a_rope_that_leaves_the_sheave_of_a_block_is_told_by_the_sheave_and_not_by_an_unknown_of_the_block():
    """It was "block: x" for a block that is pulled along y; and of every sheave that a block has."""
    text = """
rope: {mass_per_length: 6.5, axial_stiffness: 80 MN, damping: 1 ms, diameter: 36 mm}
bodies: [{name: block, mass: 3000, position: [12.75, 0, 5], force: [0, {ramp: {to: 60 kN, over: 8}}, 0]}]
path:
  - drum: {name: winch, center: [0, 0, 0], radius: 0.5, axis: [0, 1, 0], wrap: over,
           pay_out: {ramp: {to: -2.5, over: 2}}}
  - sheave: {name: tip, center: [12, 0, 30], radius: 0.4, axis: [0, 1, 0], wrap: over}
  - sheave: {name: lower, body: block, radius: 0.35, axis: [0, 1, 0], wrap: under}
  - anchor: {name: dead, position: [13.1, 0, 30]}
mesh: {elements_per_span: 2}
solver: {step: 5 ms, end: 20}
output: {interval: 0.5 s}
"""
    with pytest.raises(StoppedEarly) as stop:
        tautline.simulate(text)
    assert (stop.value.status, stop.value.part) == (Status.OFF_WHEEL, "lower")


def into_the_sheave(speed, step):
    return hoist(
        drive={"pay_out": {"ramp": {"to": speed, "over": 1.0}}}, solver={"end": 60.0, "step": step}, interval=0.05
    )


@pytest.mark.parametrize(("speed", "step"), [(-2.0, 5.0e-3), (-2.0, 1.0e-3), (-0.5, 5.0e-3)])
def test_a_hook_that_is_hoisted_into_its_sheave_stops_the_run(speed, step):
    """25 m at the speed, and half a second for its ramp: at most 0.2 m before."""
    stop = stopped(into_the_sheave(speed, step), Status.TWO_BLOCKED)
    assert stop.time == pytest.approx(25.0 / -speed + 0.5, abs=0.25 / -speed)
    assert height(stop.result) == pytest.approx(30.0, abs=0.2)
    assert "boom tip" in stop.part or "hook" in stop.part


def test_blocks_that_meet_and_a_hook_at_its_drum_stop_the_run():
    block = block_of_falls(
        4, drive={"pay_out": {"ramp": {"to": -8.0, "over": 1.0}}}, solver={"end": 20.0}, interval=0.05
    )
    stopped(block, Status.TWO_BLOCKED)
    path = [drum(pay_out=HOISTING), end("payload")]
    stopped(crane(path, [body("payload", MASS, (0.5, 0.0, -25.0))], solver={"end": 20.0}), Status.TWO_BLOCKED)
    pulled = hoist(drive={"torque": 30.0e3} | TURNING, solver={"end": 20.0})
    stopped(pulled, Status.TWO_BLOCKED)


# going on
BRAKED = {"torque": 0.0, "brake": {"torque": 60.0e3, "until": 0.7}, "rope_on_drum": 50.0} | TURNING
SLIPPING = {"law": "capstan", "friction": 0.01, "inertia": 12.0}
RESUMED = {
    "a hoist": hoist(),
    "steps chosen": hoist(solver={"step": "auto"}),
    "newmark": hoist(solver={"method": "newmark", "rho_inf": None}),
    "a brake that lets go later": hoist(drive=BRAKED),
    "a brake that has let go": hoist(drive=BRAKED | {"brake": {"torque": 60.0e3, "until": 0.3}}),
    "a controller": hoist(drive={"tension": 50e3, "gains": {"proportional": 2.0, "integral": 5.0}} | TURNING),
    "slipping falls": block_of_falls(4, 20.0e3, hooks=SLIPPING, drive={"pay_out": HOISTING}),
    "a load dropped before": fall(load={"release": {"at": 0.3, "remaining": 1000.0}}),
    "a load dropped after": fall(load={"release": {"at": 0.7, "remaining": 1000.0}}),
    "slack rope": fall(length=24.5, rope={"length": 25.0, "damping": 0.01}, start="as drawn"),
    "two drums": two_drums(**BOTH),
}
SHIP = {
    "reference": (0.0, 0.0, 0.0),
    "motion": {
        "heave": {"harmonic": {"amplitude": 0.5, "period": 2.0, "ramp": 1.0}},
        "roll": {"harmonic": {"amplitude": 0.1, "period": 3.0, "ramp": 1.0}},
    },
}


def resumed_apart(scene):
    """Largest difference of any variable from the uninterrupted run, over the largest of it."""
    whole = ran(solved(scene, end=1.0))
    half = ran(solved(scene, end=0.3))
    model = model_of(solved(scene, end=1.0))
    again = simulate(model, resume=half)
    return max(
        np.abs(again[variable.name] - whole[variable.name]).max() / max(np.abs(whole[variable.name]).max(), 1.0e-12)
        for variable in model.variables
    )


@pytest.mark.parametrize("name", RESUMED)
def test_a_run_that_is_gone_on_with_is_the_uninterrupted_one(name):
    assert resumed_apart(RESUMED[name]) < 1.0e-9


def test_on_a_moving_ship_it_is_so_but_for_the_knots_that_its_motion_is_followed_by():
    assert resumed_apart(hoist(vessel=SHIP, heave_compensation={"gain": 0.95, "delay": 0.1})) < 1.0e-7
