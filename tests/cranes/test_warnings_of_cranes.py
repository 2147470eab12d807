"""What `check` warns of in a crane scene: with cause and cure, and only where there is cause."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
import yaml
from figures.synthetic_crane import (
    HOOK,
    LOAD,
    ROPE,
    TIP,
    WINCH,
    elevator,
    falls,
    fixed_rope,
    forces_in,
    one_fall,
    scene,
)
from of_the_suite import studies
from references.cables import catenary

import tautline
from crane.application import Crane
from crane.assembly.drum_supply import check_drums, supply_of
from crane.assembly.estimates import estimate, held_limit, rk4_limit
from crane.scene.scene import CraneScene, Drum
from crane.scene.strength import strain_bound
from crane.view.figures import draw_scene
from crane.warnings import describe, figures, warnings
from tautline.integrators.status import StoppedEarly
from tautline.scene.errors import SceneError

GRAVITY = 9.81


def winch(**more):
    drum = {key: value for key, value in WINCH["drum"].items() if key != "pay_out" or "pay_out" not in more}
    return {"drum": drum | more}


def tip(**more):
    return {"sheave": TIP["sheave"] | more}


def told(of, where):
    """Texts of the warnings at a key path."""
    return [warning.text for warning in warnings(of) if warning.where == where]


def only(of, where):
    (text,) = told(of, where)
    return text


@pytest.mark.parametrize("of", [one_fall(), falls(2), falls(16), elevator(), fixed_rope()], ids=lambda of: of.title)
def test_sound_scenes_are_not_warned_of(of):
    assert warnings(of.model_copy(update={"output": of.output.model_copy(update={"interval": 0.005})})) == []


def test_rope_that_meets_a_sheave_askew_is_told_with_angle_and_limit():
    bent = one_fall(path=[WINCH, tip(center=[12, 4.0, 30]), HOOK], bodies=[LOAD | {"position": [12.4, 4.0, 5]}])
    text = only(bent, "path[1].sheave")
    assert "boom tip at 7" in text and "more than 4 deg" in text and "fleet_limit" in text
    assert "winch at 7" in only(bent, "path[0].drum") and "fleet_limit" not in only(bent, "path[0].drum")
    wide = tip(center=[12, 4.0, 30], fleet_limit="10 deg")
    assert (
        told(one_fall(path=[WINCH, wide, HOOK], bodies=[LOAD | {"position": [12.4, 4.0, 5]}]), "path[1].sheave") == []
    )


def test_sheaves_small_for_their_rope_are_told_the_smallest_by_name():
    text = only(one_fall(rope={"diameter": "60 mm"}), "path[1].sheave.radius")
    assert "on 60 mm rope: D/d 13.3, below 16." in text and "more below" not in text
    assert "1 more below 16" in only(one_fall(rope={"diameter": "70 mm"}), "path[1].sheave.radius")
    assert warnings(one_fall(rope={"diameter": None})) == []


def written(**rope):
    """One fall as a file has it, with other words for its rope."""
    document = yaml.safe_load(yaml.safe_dump({"rope": ROPE | rope, "bodies": [LOAD], "path": [WINCH, TIP, HOOK]}))
    document |= {"solver": {"step": "5 ms", "end": "10 s"}, "output": {"interval": 0.005}}
    return CraneScene.parse(yaml.safe_dump(document))


def test_one_slip_of_the_diameter_is_told_once_and_not_by_all_that_follows_from_it():
    """28 for 28 mm was told five times, with a D/d of 0."""
    told_of = Crane().warnings(written(diameter=28))
    assert [one.where for one in told_of] == ["rope.diameter"]


def test_a_ratio_of_diameters_is_told_to_two_digits_and_never_rounded_up():
    tiny = one_fall(path=[winch(), tip(radius="2.15 mm"), HOOK], bodies=[LOAD | {"position": [12.002, 0, 5]}])
    assert "on 36 mm rope: D/d 0.11, below 16" in only(tiny, "path[1].sheave.radius")
    assert "D/d 15.9, below 16" in only(one_fall(rope={"diameter": "50.1 mm"}), "path[1].sheave.radius")


def test_a_rope_weak_for_its_load_is_told_with_the_rule_it_is_held_against():
    text = only(one_fall(rope={"breaking_load": "120 kN"}), "rope.breaking_load")
    assert "2.4 times the tension at rest" in text and "rule of thumb" in text
    assert told(falls(4, rope={"breaking_load": "1 MN"}), "rope.breaking_load") == []


def test_tension_at_rest_is_the_load_on_its_falls_and_the_rope_below():
    found = estimate(one_fall())
    assert found.tension[1] == pytest.approx([5000 * GRAVITY + 25.0 * 6.5 * GRAVITY, 5000 * GRAVITY])
    height = found.path.tangents[0, 0, 2] - found.path.tangents[0, 1, 2]
    assert found.tension[0, 0] - found.tension[0, 1] == pytest.approx(6.5 * GRAVITY * height)
    tension = estimate(falls(16)).tension
    on_the_block = [tension[2 * k + 1, 1] + tension[2 * k + 2, 0] for k in range(8)]
    assert sum(on_the_block) == pytest.approx(50e3 * GRAVITY, rel=1e-9)
    exact = catenary(10.0, 0.0, 10.0, 8.0e7, 6.5 * GRAVITY)
    assert estimate(fixed_rope()).tension[0] == pytest.approx(np.linalg.norm(exact.end_forces, axis=1), rel=0.01)


def test_the_bounce_is_that_of_the_load_on_the_whole_rope():
    of = falls(4)
    found = estimate(of)
    stiffness = 16 * of.rope.axial_stiffness / found.path.length
    mass = 50e3 + 6.5 * sum(span.length for span in found.path.spans[1:]) / 3.0
    assert found.frequency == pytest.approx(math.sqrt(stiffness / mass) / (2.0 * math.pi), rel=1e-6)
    light = [1e3 + 6.5 * found_length(elevator(), k) / 3.0 for k in (0, 1)]
    light[1] += 100.0
    wanted = math.sqrt(8.0e7 / estimate(elevator()).path.length * sum(1.0 / m for m in light)) / (2.0 * math.pi)
    assert estimate(elevator()).frequency == pytest.approx(wanted)
    assert estimate(fixed_rope()).frequency is None


def found_length(of, k):
    return estimate(of).path.spans[k].length


def test_a_fixed_step_is_held_against_the_bounce_and_a_controlled_one_is_not():
    fixed = {"step": "50 ms", "control": "fixed"}
    assert "Fewer than 10 steps" in only(one_fall(solver=fixed), "solver.step")
    assert told(one_fall(solver={"step": "50 ms"}), "solver.step") == []
    assert told(one_fall(solver=fixed | {"step": "10 ms"}), "solver.step") == []


def test_frames_too_few_to_see_the_bounce_are_told():
    assert "fewer than 4 frames" in only(one_fall(interval=0.2), "output.interval")
    assert told(one_fall(interval=0.05), "output.interval") == []


def test_rk4_is_told_its_step_at_the_start_and_when_the_spans_are_short():
    hoisting = [winch(pay_out={"ramp": {"to": -2.0, "over": 1.0}}), TIP, HOOK]
    text = only(one_fall(path=hoisting, solver={"method": "rk4"}), "solver.step")
    assert "0.0012 s here" in text and "when the spans are shortest" in text and "5" in text
    assert told(one_fall(solver={"method": "rk4", "step": "0.1 ms"}), "solver.step") == []
    assert "rk4 takes steps" in only(one_fall(solver={"method": "rk4", "step": "auto"}), "solver.method")


def test_the_step_of_rk4_is_that_of_an_element_and_less_where_damping_rules():
    plain = one_fall()
    wave = math.sqrt(plain.rope.axial_stiffness / plain.rope.mass_per_length)
    assert rk4_limit(plain, 6.25, 0.0) == pytest.approx(math.sqrt(2.0 / 3.0) * 6.25 / wave)
    damped = one_fall(rope={"damping": 0.05})
    assert rk4_limit(damped, 0.1, damped.rope.damping) < 0.1 * rk4_limit(plain, 0.1, 0.0)


def test_the_step_of_rk4_is_that_of_a_light_drum_on_its_brake_where_that_is_less():
    light = {"drum": {k: x for k, x in WINCH["drum"].items() if k != "pay_out"} | {"torque": 0.0, "inertia": 5.0}}
    held = {"drum": light["drum"] | {"brake": {"torque": "1 MN m"}}}
    text = only(one_fall(path=[held, TIP, HOOK], solver={"method": "rk4", "step": "1 ms"}), "solver.step")
    assert f"as long as {light['drum']['name']} is held by its brake or friction: 0.001 s will be unstable" in text
    step = float(re.search(r"no more than about ([\d.e-]+) s", text)[1])
    mass = 5.0 / 0.5**2 + 6.5 * 8.1 / 3.0
    assert step == pytest.approx(2.83 * math.sqrt(mass * 0.5 / (1.0e3 * 8.0e7)), rel=0.05)
    free = one_fall(path=[light, TIP, HOOK], solver={"method": "rk4", "step": "auto"})
    assert "the time of a wave of tension" in only(free, "solver.method")


@pytest.mark.parametrize(
    ("inertia", "rope", "friction"), [(0.01, 500.0, 0.0), (200.0, 500.0, 0.0), (200.0, 50.0, 0.0), (200.0, 500.0, 6e4)]
)
def test_the_step_of_rk4_by_a_held_drum_is_that_up_to_which_a_run_is_stable(inertia, rope, friction):
    """The rope on a drum turns with it; brake and friction have a spring each."""
    own = {"torque": 0.0, "inertia": inertia, "rope_on_drum": rope, "brake": {"torque": "60 kN m"}}
    own |= {"friction_torque": friction} if friction else {}
    drum = {"drum": {k: x for k, x in WINCH["drum"].items() if k != "pay_out"} | own}

    def fitting(step):
        """Steps are cut to fit an interval of the output: ten of them fit."""
        return one_fall(
            path=[drum, TIP, HOOK], interval=10.0 * step, solver={"method": "rk4", "step": step, "end": 50.0 * step}
        )

    drawn = fitting(1e-5)
    limit = held_limit(drawn, drawn.drums[0], 8.1)
    assert any("held by its brake or friction" in text for text in told(fitting(1.02 * limit), "solver.step"))
    assert not any("rk4 takes" in text for text in told(fitting(0.98 * limit), "solver.step"))

    assert tautline.simulate(fitting(0.98 * limit)).attributes["status"] == "done"
    with pytest.raises(StoppedEarly, match="the explicit method is unstable"):
        tautline.simulate(fitting(1.02 * limit))


def test_what_is_to_happen_after_the_run_has_ended_is_told_with_both_times():
    dropped = one_fall(bodies=[LOAD | {"release": {"at": 60.0, "remaining": "1 t"}}], solver={"end": 50.0})
    assert "60 s: the load never drops, because the run ends at 50 s" in only(dropped, "bodies[0].release.at")
    sooner = one_fall(bodies=[LOAD | {"release": {"at": 49.0, "remaining": "1 t"}}], solver={"end": 50.0})
    assert told(sooner, "bodies[0].release.at") == []
    drum = {k: x for k, x in WINCH["drum"].items() if k != "pay_out"} | {"torque": 0.0, "inertia": 500.0}
    braked = {"drum": drum | {"brake": {"torque": "1 MN m", "until": 60.0}}}
    text = only(one_fall(path=[braked, TIP, HOOK], solver={"end": 50.0}), "path[0].drum.brake.until")
    assert "the brake never opens, because the run ends at 50 s" in text
    ramps = {"sum": [{"ramp": {"to": 1.0, "over": 1.0}}, {"ramp": {"to": -1.0, "over": 1.0, "at": 60.0}}]}
    text = only(one_fall(path=[winch(pay_out=ramps), TIP, HOOK], solver={"end": 50.0}), "path[0].drum.pay_out")
    assert text.startswith("a ramp at 60 s never begins, because the run ends at 50 s")


def test_a_body_that_drops_mass_and_keeps_its_inertia_is_told():
    turns = LOAD | {"inertia": [900, 900, 400]}
    kept = one_fall(bodies=[turns | {"release": {"at": 0.1, "remaining": "1 t"}}])
    assert "payload keeps the moments of inertia of all its 5000 kg" in only(kept, "bodies[0].release")
    given = {"at": 0.1, "remaining": "1 t", "inertia": [200, 200, 80]}
    assert told(one_fall(bodies=[turns | {"release": given}]), "bodies[0].release") == []


def test_elements_long_for_a_sagging_rope_are_told_span_by_span():
    level = [{"anchor": {"name": "pole", "position": [-200, 0, 30]}}, tip(radius=0.6), HOOK]
    slack = one_fall(path=level, bodies=[LOAD | {"mass": "300 kg", "position": [12.6, 0, 5]}])
    assert "sags by about" in only(slack, "mesh.elements_per_span") and "pole to boom tip" in only(
        slack, "mesh.elements_per_span"
    )


def test_elastic_compression_and_friction_that_cannot_act_are_told():
    assert "never goes slack" in only(
        one_fall(rope={"compression": "elastic", "bending_stiffness": 10.0}), "rope.compression"
    )
    free = [WINCH, tip(law="capstan", friction=0.1), HOOK]
    assert "never acts" in only(one_fall(path=free), "path[1].sheave.law")
    for more in ({"inertia": 10.0}, {"locked": True}):
        assert told(one_fall(path=[WINCH, tip(law="capstan", friction=0.1, **more), HOOK]), "path[1].sheave.law") == []


def test_what_is_said_to_be_written_of_a_sheave_that_is_locked_is_taken():
    path = Path(__file__).parents[2] / "data" / "hoist.yaml"
    text = path.read_text(encoding="utf-8")
    old = "inertia: 20, law: no_slip, bearing: {friction: 0.005, radius: 0.06}"
    assert old in text
    free = CraneScene.parse(text.replace(old, "law: capstan, friction: 0.1"))
    said = only(free, "path[1].sheave.law")
    (written,) = re.findall(r"locked: \w+", said)
    assert (
        told(CraneScene.parse(text.replace(old, f"law: capstan, friction: 0.1, {written}")), "path[1].sheave.law") == []
    )


def test_a_winch_that_begins_with_a_jump_is_told_the_front_it_sends():
    sudden = one_fall(path=[winch(pay_out=-1.0), TIP, HOOK])
    wave = math.sqrt(8.0e7 * 6.5)
    assert f"a tension wave of {1e-3 * wave:.3g} kN" in only(sudden, "path[0].drum.pay_out")
    table = {"table": {"time": [0, 1, 9, 10], "value": [0, -1, -1, 0]}}
    assert told(one_fall(path=[winch(pay_out=table), TIP, HOOK]), "path[0].drum.pay_out") == []
    drum = {key: value for key, value in WINCH["drum"].items() if key != "pay_out"} | {"speed": 2.0}
    assert "jumps to 1 m/s" in only(one_fall(path=[{"drum": drum}, TIP, HOOK]), "path[0].drum.speed")


def swung(count, jump):
    """A load of 50 t on one fall or some, light sheaves: the winch or the tip begins to move at 0.2 m/s of rope."""
    more = {"solver": {"end": "2 s"}, "interval": 0.01}
    if count > 1:
        text = yaml.safe_load(falls(count, **more).document.text)
    else:
        text = yaml.safe_load(one_fall(bodies=[LOAD | {"mass": "50 t"}], **more).document.text)
    for item in text["path"]:
        item.get("sheave", {})["inertia"] = 0.01
    if jump == "winch":
        text["path"][0]["drum"]["pay_out"] = -0.2
    else:
        heave = {"harmonic": {"amplitude": 0.2 / (2.0 * math.pi / 8.0), "period": 8}}
        text["path"] = [{"anchor": {"name": "tip", "position": [12.4, 0, 30]}}, HOOK]
        text["vessel"] = {"reference": [0, 0, 0], "motion": {"heave": heave}}
    return CraneScene.parse(yaml.safe_dump(text))


@pytest.mark.parametrize(("count", "jump"), [(1, "winch"), (2, "winch"), (4, "winch"), (1, "tip")])
def test_a_jump_is_told_the_tension_of_the_loads_bounce_that_it_causes(count, jump):
    # a mass on a spring whose end starts at v is swung with v sqrt(k M), and M/n^2 takes part on n falls; the sheaves'
    # and the front's waves add, which the rise of the first bounce tells: 22.3 and 10.5 kN on two and four falls
    of = swung(count, jump)
    closed = 0.2 * math.sqrt(8.0e7 / estimate(of).path.length * 50_000.0) / count
    text = only(of, "vessel.motion" if jump == "tip" else "path[0].drum.pay_out")
    (said,) = forces_in(text, "with FORCE")
    assert said == pytest.approx(closed, rel=0.02)
    assert "ignore" not in text
    (rise,) = forces_in(text, "the tension is up to FORCE more")
    tension = np.array(tautline.simulate(of)["tension"])
    assert (tension - tension[0]).max() == pytest.approx(rise, rel=0.03)


def between_drums(*speeds):
    """A block in two falls of 25 m between two drums."""
    path = []
    for k, (speed, x, way) in enumerate(zip(speeds, (0.0, 1.6), (-10.0, 10.0), strict=True)):
        drum = {**winch(pay_out={"ramp": {"to": speed, "over": 1.0}})["drum"], "name": f"w{k + 1}"}
        path.append([{"drum": drum | {"center": [x + way, 0, 0]}}, tip(name=f"s{k + 1}", center=[x, 0, 30])])
    block = {"sheave": {"name": "block", "body": "payload", "radius": 0.4, "axis": [0, 1, 0], "wrap": "under"}}
    return one_fall(path=[*path[0], block, *path[1][::-1]], bodies=[LOAD | {"position": [0.8, 0, 5]}])


def rise_of(of):
    """Largest tension of a run above that at its start, N."""
    tension = np.array(tautline.simulate(of)["tension"])
    return tension.max() - tension[0].max()


def jumping(of):
    """Front and bounce, N, that the one warning of all jumps tells; no bounce is None."""
    (text,) = (warning.text for warning in warnings(of) if "a tension wave of" in warning.text)
    (front,) = forces_in(text, "a tension wave of FORCE")
    bounce = forces_in(text, "with FORCE more and less")
    return front, bounce[0] if bounce else None


def heaving(compensation=None, pay_out=0.0, **phase):
    """A load of 50 t below a tip that heaves with 0.4 m/s at t = 0."""
    heave = {"harmonic": {"amplitude": 0.4 / (2.0 * math.pi / 8.0), "period": 8, **phase}}
    more = {} if compensation is None else {"heave_compensation": compensation}
    return one_fall(
        path=[winch(pay_out=pay_out), tip(inertia=0.01), HOOK],
        bodies=[LOAD | {"mass": "50 t"}],
        vessel={"reference": [0, 0, 0], "motion": {"heave": heave}},
        solver={"end": "4 s"}, interval=0.01, **more,
    )  # fmt: skip


def suspended(*speeds):
    """A block of 50 t between two drums."""
    text = yaml.safe_load(between_drums(*speeds).document.text)
    for k, speed in zip((0, -1), speeds, strict=True):
        text["path"][k]["drum"]["pay_out"] = speed
    for item in text["path"]:
        item.get("sheave", {})["inertia"] = 0.01
    text["bodies"][0]["mass"] = 50_000.0
    text["solver"]["end"], text["output"]["interval"] = 2.0, 0.01
    return CraneScene.parse(yaml.safe_dump(text))


AS_IT_HEAVES = {"harmonic": {"amplitude": 0.4, "period": 8, "phase": "90 deg"}}


@pytest.mark.parametrize(
    "of",
    [heaving({"gain": 1.0}), heaving(pay_out=AS_IT_HEAVES), suspended(0.4, -0.4)],
    ids=["compensated", "winch pays out the heave", "opposed winches"],
)
def test_jumps_that_cancel_are_told_once_with_their_front_and_without_a_bounce(of):
    front, bounce = jumping(of)
    assert bounce is None
    assert rise_of(of) < front


@pytest.mark.parametrize(
    ("of", "heave", "winches"),
    [
        (heaving(), 0.4, 0.0),
        (heaving({"gain": 0.5}), 0.2, 0.0),
        (heaving(pay_out=-0.2), 0.4, 0.2),
        (suspended(-0.4, -0.1), 0.0, 0.5),
        (suspended(0.4, -0.1), 0.0, 0.3),
    ],
    ids=["heave", "half compensated", "heave and winch", "two winches", "winches partly opposed"],
)
def test_jumps_are_told_once_with_the_bounce_of_their_signed_sum(of, heave, winches):
    # a spring whose end heaves with v cos(w t) leaves its mass the free bounce of a jump of v / (1 - (w / W)^2)
    falls_of = sum(isinstance(item, Drum) for item in of.path)
    stiffness = 8.0e7 / estimate(of).path.length
    rate = winches + heave / (1.0 - (2.0 * math.pi / 8.0) ** 2 / (stiffness / 50_000.0))
    closed = rate * math.sqrt(stiffness * 50_000.0) / falls_of
    _, bounce = jumping(of)
    assert bounce == pytest.approx(closed, rel=0.02)
    assert 0.9 * rise_of(of) < bounce < 1.15 * rise_of(of)


@pytest.mark.parametrize(
    ("gain", "delay", "limits"),
    [*studies((0.95, 0.05, {}), (0.95, 0.2, {}), (0.6, 0.2, {})), (0.95, 0.5, {}), (0.95, 0.2, {"speed": 0.5})],
)
def test_a_compensator_that_starts_late_is_told_with_the_bounce_of_both_starts(gain, delay, limits):
    of = heaving({"gain": gain, "delay": delay, "limits": limits})
    _, bounce = jumping(of)
    assert 0.9 * rise_of(of) < bounce < 1.15 * rise_of(of)
    assert "Heave compensation does not move at t = 0, and has to catch up" in only(of, "vessel.motion")


def test_a_late_compensator_of_a_heave_that_rests_at_its_crest_is_told_no_jump():
    crest = heaving({"gain": 0.95, "delay": 0.2}, phase="90 deg")
    assert not any("a tension wave of" in warning.text for warning in warnings(crest))
    grows = heaving({"gain": 0.95, "limits": {"stroke": 0.05}}, pay_out=0.4, ramp=1)
    assert "catch up" not in only(grows, "path[0].drum.pay_out")


def test_a_jump_of_a_crane_that_starts_as_drawn_is_told_without_the_heave():
    still = heaving({"gain": 1.0}).model_copy(update={"start": "as drawn"})
    assert not any("a tension wave of" in warning.text for warning in warnings(still))


def test_a_drum_that_runs_out_and_a_load_hoisted_too_high_are_told_with_the_time():
    out = winch(pay_out={"ramp": {"to": 1.0, "over": 1.0}}, rope_on_drum="5 m")
    assert "t = 5.5 s" in only(one_fall(path=[out, TIP, HOOK]), "path[0].drum.rope_on_drum")
    enough = winch(pay_out={"ramp": {"to": 1.0, "over": 1.0}}, rope_on_drum="50 m")
    assert told(one_fall(path=[enough, TIP, HOOK]), "path[0].drum.rope_on_drum") == []
    up = winch(pay_out={"ramp": {"to": -4.0, "over": 1.0}})
    assert "t = 6.75 s" in only(one_fall(path=[up, TIP, HOOK]), "path[0].drum.pay_out")


def test_two_drums_that_hoist_one_block_too_high_are_told_together():
    """2 m/s each take 2 (t - 0.5) m: both together the 50 m of two falls at t = 13 s, one alone at 25.5 s."""
    of = between_drums(-2.0, -2.0)
    of = of.model_copy(update={"solver": of.solver.model_copy(update={"end": 16.0})})
    text = only(of, "path[0].drum.pay_out")
    assert "w1 and w2 together reel 62 m in, and there are 50 m" in text and "t = 13 s" in text
    passed_on = between_drums(-6.0, 6.0)
    assert told(passed_on, "path[0].drum.pay_out") == told(passed_on, "path[4].drum.pay_out") == []


def test_a_load_that_no_rope_of_that_stiffness_bears_is_told_with_its_strain():
    """5000 t weigh 49.05 MN, and the rope down to the load 1.6 kN."""
    text = only(one_fall(rope={"breaking_load": None}, bodies=[LOAD | {"mass": "5000 t"}]), "rope.axial_stiffness")
    assert "49.1 MN, is 61.3 % of EA = 80 MN" in text
    assert told(one_fall(rope={"breaking_load": None}), "rope.axial_stiffness") == []


@pytest.mark.parametrize(("rope", "bound"), [({}, 0.02), ({"diameter": None}, 0.05)], ids=["of steel", "of any kind"])
def test_a_strain_at_rest_is_told_from_the_limit_on_that_a_run_is_judged_by(rope, bound):
    """EA is 80 MN; the rope down to the load weighs 1.6 kN. With its diameter the rope has 79 GPa."""

    def strained(share):
        mass = (share * 8.0e7 - 1.6e3) / GRAVITY
        return one_fall(rope={"breaking_load": None, **rope}, bodies=[LOAD | {"mass": mass}])

    assert told(strained(0.99 * bound), "rope.axial_stiffness") == []
    text = only(strained(1.01 * bound), "rope.axial_stiffness")
    assert f"is {101.0 * bound:.3g} % of EA" in text and f"The limit of a run is {100.0 * bound:g} %" in text
    assert strain_bound(strained(1.0)) == bound


def test_layers_of_an_unknown_amount_of_rope_are_told_to_count_nothing():
    layers = {"turns": 40, "core_radius": 0.48}
    text = only(one_fall(path=[winch(layers=layers), TIP, HOOK]), "path[0].drum.layers")
    assert "drum_rotation and winch_torque go by the drum's radius. Give rope_on_drum" in text
    assert "as if it had begun empty" in only(layered(), "path[0].drum.layers")
    assert told(one_fall(path=[winch(layers=layers, rope_on_drum="50 m"), TIP, HOOK]), "path[0].drum.layers") == []


def test_motion_that_begins_at_once_is_told_and_motion_that_grows_is_not():
    sudden = {"reference": [0, 0, 0], "motion": {"heave": {"harmonic": {"amplitude": 0.5, "period": 8}}}}
    text = only(one_fall(vessel=sudden), "vessel.motion")
    assert "moves at 0.39 m/s at t = 0" in text and "`ramp`" in text
    sudden["motion"]["heave"]["harmonic"]["ramp"] = 8
    assert told(one_fall(vessel=sudden), "vessel.motion") == []
    rolling = {"reference": [0, 0, 0], "motion": {"roll": {"harmonic": {"amplitude": 0.1, "period": 8}}}}
    speed = 0.1 * 2.0 * math.pi / 8.0 * 30.0
    assert f"boom tip moves at {speed:.2g} m/s" in only(one_fall(vessel=rolling), "vessel.motion")
    slewing = [{"name": "boom", "pivot": [0, 0, 0], "slew": {"harmonic": {"amplitude": 0.1, "period": 8}}}]
    path = [winch(frame="boom"), tip(frame="boom"), HOOK]
    assert "boom tip moves at 0.94 m/s" in only(one_fall(path=path, frames=slewing), "frames")


def test_limits_that_hold_the_actuator_back_are_told_with_their_share():
    heave = {"harmonic": {"amplitude": 1.0, "period": 8, "ramp": 8}}
    vessel = {"reference": [0, 0, 0], "motion": {"heave": heave}}
    short = one_fall(vessel=vessel, heave_compensation={"gain": 1.0, "limits": {"stroke": "0.5 m"}}, solver={"end": 40})
    assert "its stroke limit is reached" in only(short, "heave_compensation.limits")
    ample = one_fall(vessel=vessel, heave_compensation={"gain": 1.0, "limits": {"stroke": "2 m"}}, solver={"end": 40})
    assert told(ample, "heave_compensation.limits") == []


def test_a_late_answer_to_a_heave_that_moves_at_once_is_told_as_that_and_not_as_a_limit():
    heave = {"harmonic": {"amplitude": 1.0, "period": 8}}

    def held_back(limits, **more):
        vessel = {"reference": [0, 0, 0], "motion": {"heave": {"harmonic": {**heave["harmonic"], **more}}}}
        compensation = {"gain": 0.9, "delay": "0.3 s", "limits": limits}
        return one_fall(vessel=vessel, heave_compensation=compensation, solver={"end": 30})

    text = only(held_back({}), "heave_compensation.delay")
    assert "heaves already at t = 0" in text and "`ramp`" in text and "wider limits" not in text
    assert told(held_back({}), "heave_compensation.limits") == []
    assert told(held_back({}, ramp=8), "heave_compensation.delay") == []
    both = held_back({"stroke": "0.5 m"})
    assert only(both, "heave_compensation.delay") and "stroke" in only(both, "heave_compensation.limits")


@pytest.mark.parametrize("driven", ["pay_out", "torque"])
@pytest.mark.parametrize("motion", ["pitch", "heave"])
def test_two_drums_of_which_one_tip_heaves_otherwise_than_that_which_is_answered_are_told_of_it(motion, driven):
    """The tips are 1.6 m apart: with a pitch of 3 deg the other heaves 1.6 sin(3 deg) otherwise."""
    text = yaml.safe_load(between_drums(0.0, 0.0).document.text)
    amplitude = "3 deg" if motion == "pitch" else "0.5 m"
    swing = {"harmonic": {"amplitude": amplitude, "period": 8, "ramp": 8}}
    text |= {"vessel": {"reference": [-10, 0, 0], "motion": {motion: swing}}, "heave_compensation": {"gain": 1.0}}
    if driven == "torque":
        last = text["path"][-1]["drum"]
        del last["pay_out"]
        last |= {"inertia": 100.0, "torque": "12 kN m"}
    text["solver"]["end"] = 40.0
    found = told(CraneScene.parse(yaml.safe_dump(text)), "heave_compensation")
    if motion == "heave" or driven == "torque":
        assert found == []
        return
    (one,) = found
    assert "both drums pay out by the heave of s1. That of s2 differs by up to" in one
    off = float(re.search(r"by up to ([0-9.]+) m", one)[1])
    assert off == pytest.approx(1.6 * math.sin(math.radians(3.0)), rel=5e-3)


@pytest.mark.parametrize("grounded", ["second", "first"])
def test_of_two_drums_of_which_one_side_rides_on_the_ground_all_that_is_answered_is_wrong_there(grounded):
    text = yaml.safe_load(between_drums(0.0, 0.0).document.text)
    swing = {"harmonic": {"amplitude": "1 m", "period": 8, "ramp": 8}}
    text |= {"vessel": {"reference": [-10, 0, 0], "motion": {"heave": swing}}, "heave_compensation": {"gain": 1.0}}
    loads = [k for k, item in enumerate(text["path"]) if "body" in next(iter(item.values()))]
    for item in text["path"][loads[-1] + 1 :] if grounded == "second" else text["path"][: loads[0]]:
        next(iter(item.values()))["frame"] = "ground"
    text["solver"]["end"] = 40.0
    (one,) = told(CraneScene.parse(yaml.safe_dump(text)), "heave_compensation")
    drum = text["path"][-1 if grounded == "second" else 0]["drum"]["name"]
    answered = "s1" if grounded == "second" else "s2"
    assert f"both drums pay out by the heave of {answered}. What {drum} leads over stands on the ground" in one
    assert float(re.search(r"by up to ([0-9.]+) m", one)[1]) == pytest.approx(1.0, rel=5e-3)
    assert "Expect it at the load" in one


def test_two_drums_with_no_load_between_them_are_told_to_expect_the_heave_at_the_rope():
    text = yaml.safe_load(between_drums(0.0, 0.0).document.text)
    swing = {"harmonic": {"amplitude": "3 deg", "period": 8, "ramp": 8}}
    text |= {"vessel": {"reference": [-10, 0, 0], "motion": {"pitch": swing}}, "heave_compensation": {"gain": 1.0}}
    del text["bodies"]
    text["path"] = [item for item in text["path"] if "body" not in next(iter(item.values()))]
    text["solver"]["end"] = 40.0
    (one,) = told(CraneScene.parse(yaml.safe_dump(text)), "heave_compensation")
    assert "Expect it at the rope between them" in one and "load" not in one


def layered(**more):
    return one_fall(path=[winch(layers={"turns": 5, "core_radius": 0.48, "count": 2}, **more), TIP, HOOK])


def test_more_rope_than_a_drum_holds_is_refused_with_the_time_it_is_full():
    drum = layered().drums[0]
    capacity = drum.layers.capacity(0.036)
    hoisting = {"ramp": {"to": -3.0, "over": 1.0}}
    full = 0.5 + (capacity - 10.0) / 3.0
    with pytest.raises(SceneError) as refused:
        check_drums(layered(rope_on_drum="10 m", pay_out=hoisting))
    (problem,) = refused.value.problems
    assert problem.key == "path[0].drum.layers" and "2 layers of 5 turns hold" in problem.cause
    assert float(problem.cause.split("t = ")[1].split()[0]) == pytest.approx(full, abs=0.01)
    with pytest.raises(SceneError, match="beginning empty, as no rope_on_drum is given"):
        check_drums(layered(pay_out={"ramp": {"to": -5.0, "over": 1.0}}))
    with pytest.raises(SceneError, match="5 turns hold"):
        warnings(layered(rope_on_drum="10 m", pay_out=hoisting))
    check_drums(layered(rope_on_drum="3 m", pay_out={"ramp": {"to": -1.0, "over": 1.0}}))
    check_drums(layered(rope_on_drum="10 m", pay_out={"ramp": {"to": 1.0, "over": 1.0}}))


def test_the_supply_of_a_drum_is_the_integral_of_its_speed():
    driven = one_fall(path=[winch(pay_out={"ramp": {"to": -2.0, "over": 1.0}}), TIP, HOOK])
    supply = supply_of(driven, driven.drums[0])
    assert supply.paid_out[-1] == pytest.approx(-19.0) and supply.speed[-1] == pytest.approx(-2.0)
    torque = {key: value for key, value in WINCH["drum"].items() if key != "pay_out"}
    free = one_fall(path=[{"drum": torque | {"torque": 24e3, "inertia": 500.0}}, TIP, HOOK])
    assert supply_of(free, free.drums[0]) is None and told(free, "path[0].drum.torque") == []


def test_figures_are_those_that_check_promises_and_read_as_a_table():
    found = figures(falls(2))
    assert found.keys() == {"spans", "wraps", "fleet_angles", "path_length", "damping", "printed_in"}
    assert [(span["from"], span["to"]) for span in found["spans"]] == [
        ("winch", "head 1"), ("head 1", "block 1"), ("block 1", "dead end"),
    ]  # fmt: skip
    assert [wrap["sheave"] for wrap in found["wraps"]] == ["head 1", "block 1"]
    assert found["wraps"][1]["angle"] == pytest.approx(math.pi)
    arcs = 0.4 * sum(wrap["angle"] for wrap in found["wraps"])
    assert found["path_length"] == pytest.approx(sum(span["length"] for span in found["spans"]) + arcs)
    rows = dict(describe(found))
    assert rows["head 1 to block 1"] == "25 m" and rows["around block 1"] == "180 deg, fleet angle 0 deg"
    fixed = describe(figures(fixed_rope()))
    assert fixed[:2] == [("one to other", "10 m"), ("length of the path", "10 m")]
    assert all(name == "damping of the rope" for name, _ in fixed[2:])


def test_the_fleet_angle_is_the_larger_of_both_sides():
    bent = one_fall(path=[WINCH, tip(center=[12, 1.0, 30]), HOOK], bodies=[LOAD | {"position": [12.4, 4.0, 5]}])
    (angle,) = figures(bent)["fleet_angles"]
    assert angle["sheave"] == "boom tip" and angle["angle"] == pytest.approx(
        math.asin(3.0 / math.hypot(3.0, 25.0)), rel=1e-3
    )


@pytest.mark.parametrize("of", [falls(4), fixed_rope(), *studies(one_fall(), elevator())], ids=lambda of: of.title)
def test_a_scene_is_drawn_before_it_runs(of, tmp_path):
    assert draw_scene(of, tmp_path / "scene.png").stat().st_size > 5000


def test_a_scene_that_no_rope_can_take_is_refused():
    with pytest.raises(SceneError, match="boom tip"):
        warnings(scene(path=[WINCH, tip(center=[0.2, 0, 0.1]), HOOK]))
    assert isinstance(one_fall(), CraneScene)
