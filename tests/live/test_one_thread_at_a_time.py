"""A simulation is worked with by one thread at a time: what two made of it were positions of neither."""

import copy
import threading
from pathlib import Path

import numpy as np
import pytest

import tautline

HOIST = Path(__file__).parents[2] / "data" / "hoist.yaml"
ACTS = {
    "advance": lambda sim: sim.advance(0.05),
    "advance to": lambda sim: sim.advance_to(9.0),
    "save": lambda sim: sim.save(),
    "restore": lambda sim: sim.restore(sim.before),
    "copy": lambda sim: copy.deepcopy(sim),
    "result": lambda sim: sim.result,
    "read": lambda sim: sim["payload.position"],
    "read what is computed": lambda sim: sim["winch.tension"],
    "input": lambda sim: sim.inputs.__setitem__("winch.pay_out_speed", -0.1),
    "parameter": lambda sim: sim.parameters.__setitem__("payload.mass", 8000.0),
    "blow": lambda sim: sim.displace("payload.velocity", [0.0, 0.0, 0.1]),
    "force": lambda sim: sim.add_force(lambda t, q, v: [0.0, 0.0, 0.0], on="payload.position"),
}


@pytest.fixture(scope="module")
def whole():
    sim = tautline.Simulation(HOIST)
    sim.before = sim.save()
    sim.advance(1.0)
    return sim


@pytest.fixture
def halted():
    """A simulation that another thread advances to 1 s, and is in the middle of it, in a force, until `go` is set."""
    sim, inside, go = tautline.Simulation(HOIST), threading.Event(), threading.Event()

    def force(t, q, v):
        if t > 0.5:
            inside.set()
            assert go.wait(60.0)
        return [0.0, 0.0, 0.0]

    sim.add_force(force, on="payload.position")
    sim.before = sim.save()
    thread = threading.Thread(target=lambda: sim.advance(1.0))
    thread.start()
    assert inside.wait(60.0)
    yield sim, lambda: (go.set(), thread.join())
    go.set()
    thread.join()


def test_a_second_thread_is_refused_whatever_it_asks_and_the_first_one_comes_to_where_it_would_alone(halted, whole):
    sim, finish = halted
    for what, act in ACTS.items():
        with pytest.raises(tautline.SimulationError, match=r"by another thread.*its own: sim\.copy"):
            act(sim)
            pytest.fail(what)
    finish()
    assert sim.time == 1.0 and sim.parameters["payload.mass"] == 5000.0 and not sim.inputs.driven
    assert np.array_equal(sim["payload.position"], whole["payload.position"])
    assert sim["winch.tension"] == whole["winch.tension"]
    for act in ACTS.values():
        act(sim.copy()) if act is not ACTS["restore"] else sim.restore(sim.before)


@pytest.mark.parametrize("what", [what for what in ACTS if "read" not in what and what != "input"])
def test_a_force_cannot_go_on_with_the_simulation_that_asks_for_it(what):
    sim = tautline.Simulation(HOIST)

    def force(t, q, v):
        ACTS[what](sim)
        return [0.0, 0.0, 0.0]

    sim.add_force(force, on="payload.position")
    sim.before = sim.save()
    with pytest.raises(tautline.SimulationError, match="in the middle of an advance"):
        sim.advance(1.0)
    assert "a force raised" in sim.stopped


def test_a_force_may_read_the_simulation_and_what_it_reads_is_not_told_after_the_advance(whole):
    sim, read = tautline.Simulation(HOIST), []

    def force(t, q, v):
        read.append(sim["winch.tension"])
        return [0.0, 0.0, 0.0]

    sim.add_force(force, on="payload.position")
    sim.advance(1.0)
    assert read and sim["winch.tension"] == whole["winch.tension"] != read[-1]


def test_threads_that_advance_one_simulation_after_one_another_make_no_difference(whole):
    sim = tautline.Simulation(HOIST)
    for time in (0.3, 0.6, 1.0):
        thread = threading.Thread(target=sim.advance_to, args=(time,))
        thread.start()
        thread.join()
    assert np.array_equal(sim.result["position"][-1], whole.result["position"][-1])
