"""Copies of a simulation share nothing that a run writes to, and the books do not depend on which frames are kept."""

from pathlib import Path

import numpy as np
import pytest

import tautline
from tautline.integrators.status import StoppedEarly

HOIST = Path(__file__).parents[2] / "data" / "hoist.yaml"


def stiff(t, q, v):
    """A spring and a damper at the load."""
    return -2.0e5 * (q - np.array([12.4, 0.0, -15.0])) - 500.0 * v


def with_force():
    sim = tautline.Simulation(tautline.read(HOIST))
    sim.add_force(stiff, on="payload.position")
    sim.advance(0.2)
    return sim


def test_a_copy_has_scratch_of_its_own_for_each_force():
    sim = with_force()
    other = sim.copy()
    for one, two in zip(sim.model.system.groups, other.model.system.groups, strict=True):
        if type(one).__name__ == "OutsideForces":
            assert not any(np.shares_memory(getattr(one, name), getattr(two, name)) for name in "qvfg")
    assert sim._forces[0] is not other._forces[0]


@pytest.mark.parametrize("of", [lambda sim: sim.copy(), lambda sim: with_force(), lambda sim: sim])
def test_a_force_is_called_by_its_own_simulation_also_behind_a_state_of_another(of):
    # the state held where the function of the other stood: it was called instead, also where there was none any more
    sim = with_force()
    other = of(sim)
    calls, state = [force.calls for force in (sim._forces[0], other._forces[0])], sim.save()
    other.restore(state)
    other.advance(0.01)
    assert other._forces[0].calls > calls[1] and (sim is other or sim._forces[0].calls == calls[0])


def test_copies_with_a_force_run_on_threads_as_they_do_one_after_the_other():
    sims = [with_force() for _ in range(2)]
    sims[1].displace("payload.velocity", [0.1, 0.0, 0.0])
    alone = [sim.copy() for sim in sims]
    for sim in alone:
        sim.advance_to(1.0)
    pairs = [sims[0].copy(), sims[1].copy(), sims[0].copy(), sims[1].copy()]
    tautline.rollout(pairs, until=1.0, workers=2)
    for k, sim in enumerate(pairs):
        assert np.array_equal(sim["payload.position"], alone[k % 2]["payload.position"])


@pytest.mark.parametrize("keep", [0.2, 1.0])
def test_the_energy_balance_of_the_frames_that_are_kept_is_theirs(keep):
    sim = tautline.Simulation(tautline.read(HOIST), keep=keep)
    sim.advance(3.0)
    assert sim.result.attributes["energy_error"] < 1e-4
    assert not any("unaccounted" in text for text in sim.result.warnings)


def test_a_parameter_that_changes_is_booked_whatever_is_kept():
    works = []
    for keep in (True, 0.2, False):
        sim = tautline.Simulation(tautline.read(HOIST), keep=keep)
        sim.advance(0.5)
        sim.parameters["payload.mass"] = 8000.0
        sim.advance(0.5)
        works.append(sim["external_work"])
    assert works[1:] == [works[0], works[0]]


def test_a_state_far_behind_the_end_of_the_scene_is_restored_at_once():
    sim = tautline.Simulation(tautline.read(HOIST), keep=False)
    sim.advance(1.0)
    state = sim.save()
    late = state.__class__(1.0e7 + 0.01, *[getattr(state, name) for name in list(state.__dataclass_fields__)[1:]])
    sim.restore(late)
    assert 0.0 < sim._frame_clock.next - late.time <= sim.model.solver.interval + 1e-6


def test_a_compiled_force_that_raises_stops_the_run():
    numba = pytest.importorskip("numba")

    @numba.njit
    def broken(t, q, v, force):
        if t > 0.1:
            raise ValueError("no")
        force[:] = 0.0

    sim = tautline.Simulation(tautline.read(HOIST))
    sim.add_force(broken, on="payload.position")
    with pytest.raises(StoppedEarly):
        sim.advance(0.3)
