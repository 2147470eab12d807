"""What a run says of its energy is what its method made or destroyed, and nothing else."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from physics.cables.rope_text import PINNED, chain, scene
from scipy.special import j1, jn_zeros

import tautline
from tautline.cable.input.scene import parse
from tautline.cable.model.build import build
from tautline.integrators.status import Status, StoppedEarly
from tautline.results.assessment.balance import Balance
from tautline.simulation import simulate

DATA = Path(__file__).parents[2] / "data"
LENGTH, ANGLE, G = 10.0, 0.02, 9.81


def hanging(damping, step, rho_inf, end=6.0, elements=10):
    """A rope that is let go unstretched, along a line that leans by `ANGLE`: it stretches at once, and swings."""
    along = np.array([np.sin(ANGLE), 0.0, -np.cos(ANGLE)])
    p = np.linspace(0.0, LENGTH, elements + 1)
    items = chain(p[:, None] * along, p, {0: PINNED}, EA=1.0e6, damping=damping)
    settings = {"rho_inf": rho_inf, "time_step": step, "time_end": end, "eps_energy": 1e-10, "plotpoints": 20}
    return simulate(build(parse(scene(items, maxIter=30, **settings))))


def swings(times):
    """Tip of a chain let go from a straight line, m: 8 theta L / (j^3 J1(j)) cos(j/2 sqrt(g/L) t), J0(j) = 0."""
    roots = jn_zeros(0, 60)
    amplitudes = 8.0 * ANGLE * LENGTH / (roots**3 * j1(roots))
    return amplitudes @ np.cos(0.5 * np.sqrt(G / LENGTH) * np.outer(roots, times))


@pytest.mark.parametrize("rho_inf", [0.5, 0.8, 1.0])
@pytest.mark.parametrize("step", [0.01, 0.03])
def test_a_rope_whose_release_rings_faster_than_the_step_is_not_called_wrong(step, rho_inf):
    # the stretch rings at 25 Hz and above; the swing, of 0.19 Hz, is right
    result = hanging(1.0e-3, step, rho_inf)
    times = np.asarray(result["time"])
    np.testing.assert_allclose(result["position"][:, -1, 0], swings(times), atol=0.04 * ANGLE * LENGTH)
    released = float(result["strain_energy"].max())
    lost = float(result["dissipated_energy"][-1] + result.attributes["numerical_dissipation"])
    # what the stretch sets free, rhoA^2 g^2 L^3 / (6 EA), is lost: to the damper, or to the method
    assert lost == pytest.approx(G**2 * LENGTH**3 / 6.0e6, rel=0.02) and released > lost
    assert result.attributes["energy_error"] < 0.1


@pytest.mark.parametrize(("damping", "step"), [(1e-4, 0.002), (1e-3, 0.01), (1e-3, 0.03), (1e-2, 0.03)])
def test_the_average_acceleration_neither_makes_nor_destroys_energy_of_a_damped_rope(damping, step):
    # for linear forces M dv.v = dq.F holds to rounding with the mean of the forces at both ends; the rope is nearly so
    result = hanging(damping, step, 1.0)
    assert abs(result.attributes["numerical_dissipation"]) < 2e-3 * float(result["dissipated_energy"][-1])


def test_energy_that_a_method_does_create_still_stops_the_run():
    # undamped, and twice too long a step for the average acceleration of a rope that turns: it explodes
    with pytest.raises(StoppedEarly) as stop:
        hanging(0.0, 0.02, 1.0, end=6.0)
    assert stop.value.status == Status.IMBALANCE


def test_a_damper_that_gives_energy_back_is_energy_from_nowhere():
    # kinetic, strain, potential, work, loss: the loss falls from 4 J to 1 J while the kinetic energy rises by 3 J
    balance = Balance(1.0, 0.0)
    balance.add(np.array([[5.0, 0, 0, 0, 0], [1.0, 0, 0, 0, 4.0], [4.0, 0, 0, 0, 1.0]]))
    assert balance.missing() == pytest.approx(3.0)
    assert balance.gained(0.0) > 0.05


def test_what_the_method_set_aside_at_the_start_is_not_from_nowhere():
    balance = Balance(0.0, 0.0)
    balance.add(np.array([[1.0, 0, 0, 0, 0], [1.5, 0, 0, 0, 0]]))
    assert balance.gained(8.5) == pytest.approx(0.5 / 9.5, rel=1e-5)
    assert balance.gained(8.5, aside=0.4) == pytest.approx(0.1 / 9.5, rel=1e-5)
    assert balance.gained(8.5, aside=0.6) == 0.0


def test_energy_that_a_run_says_was_created_is_the_error_of_its_balance_also_where_the_method_had_set_it_aside():
    """A bar drawn 5 % too long and let go: what its E gained of what it had, 131 J, by the stored energies."""
    stretch, n, length = 1.05, 10, 10.0
    p = np.linspace(0.0, length, n + 1)
    held = {i: (0, 1, 1, 0, 1, 1, 1) for i in range(n + 1)} | {0: (1, 1, 1, 0, 1, 1, 1)}
    items = chain(np.outer(p, (stretch, 0.0, 0.0)), p, held, EA=1.0e4, damping=2.0e-3)
    settings = {"rho_inf": 0.8, "time_step": 2e-3, "time_end": 2.0, "eps_energy": 1e-10, "plotpoints": 500}
    run = simulate(build(parse(scene(items, gravity=(0.0, 0.0, 0.0), maxIter=30, **settings))))
    energy = sum(run[name] for name in ("kinetic_energy", "strain_energy", "potential_energy", "dissipated_energy"))
    gained = float((energy - run["external_work"])[-1] - energy[0])
    assert gained > 1e-4 * energy[0]
    assert run.attributes["numerical_dissipation"] == pytest.approx(-gained, rel=1e-6)
    # What went through is at least what was there and at most four times of that: lost, moved and stretched.
    assert gained / (4.0 * energy[0]) < run.attributes["energy_error"] < gained / energy[0] * 1.5


SHIPPED = [("jwell", 3.0), ("hoist", 3.0), ("hose", 1.0), ("drilling", 2.0), ("reeled_span", 3.0), ("slewing", 3.0)]
OTHERS = [("tripping", 3.0), ("landing", 8.0), ("hookblock", 5.0), ("sixteen_falls", 2.0), ("whirl", 2.0)]


@pytest.mark.parametrize("factor", [0.1, 4.0])
@pytest.mark.parametrize(("name", "end"), [*SHIPPED, *(pytest.param(*c, marks=pytest.mark.study) for c in OTHERS)])
def test_no_shipped_scene_is_called_wrong_at_a_tenth_or_four_times_its_step(name, end, factor, tmp_path):
    text = (DATA / f"{name}.yaml").read_text(encoding="utf8")
    here = tmp_path / f"{name}.yaml"
    here.write_text(text, encoding="utf8")
    scene = tautline.read(here)
    step = factor * scene.solver.step
    for key, value in (("step", step), ("end", end * min(1.0, 5.0 * factor)), ("time_step", step), ("time_end", end)):
        text = re.sub(rf"\b{key}: [0-9.e+-]+( m?s\b)?", f"{key}: {value!r}", text)
    text = re.sub(r"\binterval: [0-9.e+-]+( m?s\b)?", f"interval: {max(step, 0.05)!r}", text)
    here.write_text(text, encoding="utf8")
    assert tautline.read(here).solver.step == pytest.approx(step)
    result = tautline.simulate(here)
    assert result.attributes["status"] == "done" and result.attributes["energy_error"] < 0.05


def tube(speed, **changes):
    """A tube between two clamps that falls into its sag, with steps that do not follow its first mode of 34 Hz."""
    solver = {"step": "5 ms", "end": "0.5 s", "rho_inf": 0.5, **changes.pop("solver", {})}
    hose = {
        "length": 1.0, "elements": 16, "axial_stiffness": 1.003e6, "bending_stiffness": 7.26,
        "mass_per_length": 0.043, "end": "clamped", **changes.pop("hose", {}),
    }  # fmt: skip
    water = {"mass_per_length": 0.0407, "speed": speed}
    given = {"hose": hose, "water": water, "gravity": 9.81, "solver": solver, "output": {"interval": "5 ms"}}
    return tautline.read(given | changes)


def test_the_energy_of_a_tube_is_judged_alike_at_a_creeping_and_at_a_fast_flow():
    # 3 m/s is a twenty-eighth of the speed at which the tube buckles, 2 pi sqrt(EJ / M) / L: it moves alike
    creeping, flowing = (tautline.simulate(tube(speed)).attributes["energy_error"] for speed in (1.0e-6, 3.0))
    assert creeping > 0.1 and flowing == pytest.approx(creeping, rel=0.05)


def test_numerical_dissipation_of_a_tube_is_told_though_the_water_has_far_more_kinetic_energy():
    result = tautline.simulate(tube(10.0))
    # 1/2 M U^2 L of the water, over two thousand times the energy of the fall into the sag
    assert float(result["kinetic_energy"][0]) == pytest.approx(0.5 * 0.0407 * 10.0**2, rel=1e-9)
    assert float(np.ptp(result["strain_energy"])) < 1e-3
    assert any("of the energy is unaccounted for" in one for one in result.attributes["warnings"])


@pytest.mark.parametrize("speed", [1.0e-6, 3.0, 1.0e3, {"ramp": {"to": 3.0, "over": 0.1}}])
def test_water_that_flows_through_a_tube_at_rest_is_no_false_alarm(speed):
    result = tautline.simulate(tube(speed, gravity=0))
    assert result.attributes["status"] == "done" and result.attributes["energy_error"] < 1e-2
    assert not [one for one in result.attributes["warnings"] if "energy" in one]


def ringing(speed):
    """A tube of which axial waves of some kHz, in steps of 2 ms, become noise with the energy of its bending."""
    hose = {"length": 0.508, "elements": 10, "axial_stiffness": 1e9, "bending_stiffness": 0.00108}
    scene = tube(speed, hose=hose | {"mass_per_length": 0.003125}, solver={"step": "2 ms", "rho_inf": 1.0})
    return scene.replace({"water.mass_per_length": 0.3})


def test_energy_that_is_created_in_a_tube_stops_its_run():
    with pytest.raises(StoppedEarly) as stop:
        tautline.simulate(ringing(1.0e-6))
    assert stop.value.status == Status.IMBALANCE and stop.value.result.attributes["energy_error"] > 0.1


def test_energy_that_is_created_beside_a_fast_flow_is_warned_of():
    result = tautline.simulate(ringing(3.0))
    assert result.attributes["status"] == "done" and result.attributes["energy_error"] > 0.1
    assert any("of the energy is unaccounted for" in one for one in result.attributes["warnings"])


def thrown(velocity, rho_inf=1.0):
    """A straight rope in space without gravity, each node of which begins with a velocity of its place (n, 3)."""
    p = np.linspace(-0.5, 0.5, 11)
    items = chain(p[:, None] * np.array([1.0, 0.0, 0.0]), p, {}, EA=1.0e4)
    settings = {"rho_inf": rho_inf, "time_step": 1e-3, "time_end": 1.0, "eps_energy": 1e-10, "plotpoints": 50}
    model = build(parse(scene(items, gravity=(0.0, 0.0, 0.0), **settings)))
    nodes = model.system.q.reshape(-1, 7)
    model.system.v.reshape(-1, 7)[:, :6] = velocity(nodes)
    return simulate(model)


def test_a_rope_that_flies_or_turns_steadily_is_no_false_alarm():
    def flies(nodes):
        return np.tile([3.0, -4.0, 12.0, 0.0, 0.0, 0.0], (len(nodes), 1))

    def turns(nodes):
        v = np.zeros((len(nodes), 6))
        v[:, 1], v[:, 4] = 10.0 * nodes[:, 0], 10.0 * nodes[:, 3]
        return v

    for start, energy in ((flies, 0.5 * 13.0**2), (turns, 0.5 * 10.0**2 / 12.0)):
        result = thrown(start)
        assert float(result["kinetic_energy"][0]) == pytest.approx(energy, rel=1e-9)
        assert result.attributes["status"] == "done" and result.attributes["energy_error"] < 1e-3


def test_what_was_gained_is_found_anew_when_frames_or_what_went_through_are_others():
    balance = Balance(1.0, 0.0)
    balance.add(np.array([[0.0, 0.0, 10.0, 0.0, 0.0], [11.0, 0.0, 0.0, 0.0, 0.0]]))
    first = balance.gained(20.0)
    assert balance.gained(20.0) == first > 0.0
    assert balance.gained(40.0) < first and balance.gained(20.0, 0.5) < first
    balance.add(np.array([[14.0, 0.0, 0.0, 0.0, 0.0]]))
    assert balance.gained(20.0) > first
