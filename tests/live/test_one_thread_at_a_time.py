"""Any thread reads a simulation; what two made of it that changed it were positions of neither."""

import copy
import faulthandler
import os
import signal
import sys
import threading
import time as clock
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from results.forked import Forked

import tautline
from tautline.live import turn

DATA = Path(__file__).parents[2] / "data"
HOIST = DATA / "hoist.yaml"
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
READS = ("save", "copy", "result", "read", "read what is computed", "linearise", "read an input")
ACTS |= {
    "linearise": lambda sim: sim.linearise(["winch.pay_out"], ["payload.position"]),
    "read an input": lambda sim: sim.inputs["winch.pay_out"],
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


def test_a_second_thread_that_changes_is_refused_in_the_middle_of_an_advance_which_comes_to_where_it_would_alone(
    halted, whole
):
    sim, finish = halted
    for what in ACTS.keys() - set(READS):
        with pytest.raises(tautline.SimulationError, match=r"being advanced by another thread.*its own: sim\.copy"):
            ACTS[what](sim)
            pytest.fail(what)
    finish()
    assert sim.time == 1.0 and sim.parameters["payload.mass"] == 5000.0 and not sim.inputs.driven
    # behind a force that is added accelerations are found anew: they are rounded otherwise
    assert np.asarray(sim["payload.position"]) == pytest.approx(np.asarray(whole["payload.position"]), abs=1e-9)
    assert sim["winch.tension"] == pytest.approx(whole["winch.tension"], rel=1e-9)
    for act in ACTS.values():
        act(sim.copy()) if act is not ACTS["restore"] else sim.restore(sim.before)


@pytest.mark.parametrize("what", READS)
def test_a_thread_that_reads_in_the_middle_of_an_advance_reads_what_is_at_its_end(what, halted):
    sim, finish = halted
    with ThreadPoolExecutor(1) as pool:
        found = pool.submit(ACTS[what], sim)
        with pytest.raises(TimeoutError):
            found.result(0.2)
        finish()
        found = found.result(60.0)
    assert sim.time == 1.0
    if what in ("save", "copy"):
        assert found.time == 1.0
    elif what == "result":
        assert found["time"][-1] == 1.0
    elif what != "linearise":
        assert np.array_equal(found, ACTS[what](sim))


@pytest.mark.parametrize("what", READS)
def test_a_force_that_waits_for_a_thread_that_reads_is_told_so_and_does_not_hang(what, monkeypatch):
    # The force is called again with each halving of the step, and waits as long each time.
    monkeypatch.setattr(turn, "PATIENCE", 0.02)
    monkeypatch.setattr(turn, "LOOK", 0.005)
    sim = tautline.Simulation(HOIST)
    with ThreadPoolExecutor(1) as pool:

        def force(t, q, v):
            pool.submit(ACTS[what], sim).result(60.0)
            return [0.0, 0.0, 0.0]

        sim.add_force(force, on="payload.position")
        with pytest.raises(tautline.SimulationError, match=r"by another thread\. A force of it has not returned for"):
            sim.advance(1.0)
    assert "a force raised SimulationError" in sim.stopped


@pytest.mark.parametrize("what", ["read", "read what is computed", "read an input", "input", "save"])
def test_forces_of_two_simulations_on_two_threads_that_ask_for_one_another_are_refused_at_once(what):
    # each waited 5 s for the other, twelve times, and did not hear Ctrl-C
    sims, both, met = [tautline.Simulation(HOIST) for _ in range(2)], threading.Barrier(2), set()

    def asks(other):
        def force(t, q, v):
            if other not in met:
                met.add(other)
                both.wait(60.0)
            ACTS[what](other)
            return [0.0, 0.0, 0.0]

        return force

    for one, other in zip(sims, reversed(sims), strict=True):
        one.add_force(asks(other), on="payload.position")
    before = clock.monotonic()
    with ThreadPoolExecutor(2) as pool:
        runs = [pool.submit(sim.advance, 0.05) for sim in sims]
        errors = [run.exception(60.0) for run in runs]
    told = [str(error) for error in errors if error is not None]
    assert told and clock.monotonic() - before < turn.PATIENCE
    assert all("a force asks for another simulation" in one and "in one thread, by turns" in one for one in told)


def test_threads_that_read_a_simulation_at_rest_all_read_it(whole):
    sim = whole.copy()

    def read(_):
        for _ in range(300):
            assert np.array_equal(sim["payload.position"], whole["payload.position"])
            assert sim["winch.tension"] == whole["winch.tension"]
            assert sim.inputs["winch.pay_out"] == whole.inputs["winch.pay_out"]
        assert sim.result["time"][-1] == sim.save().time == 1.0

    with ThreadPoolExecutor(3) as pool:
        list(pool.map(read, range(3)))


def test_threads_that_each_advance_a_copy_of_one_simulation_come_to_the_same(whole):
    def branch(_):
        other = whole.copy()
        other.advance(0.05)
        return other["payload.position"]

    alone = branch(0)
    with ThreadPoolExecutor(2) as pool:
        assert all(np.array_equal(alone, found) for found in pool.map(branch, range(6)))


@pytest.fixture
def switched_often():
    """Threads that take turns at the interpreter some hundred times as often as they do."""
    usual = sys.getswitchinterval()
    sys.setswitchinterval(2e-5)
    yield
    sys.setswitchinterval(usual)


def test_an_advance_is_never_refused_beside_threads_that_read_and_these_read_whole_states(switched_often):
    alone, sim, done = tautline.Simulation(HOIST), tautline.Simulation(HOIST), threading.Event()
    states = [alone["position"]]
    for _ in range(200):
        alone.inputs["winch.pay_out_speed"] = 0.1
        alone.advance(0.005)
        states.append(alone["position"])
    known, read = {state.tobytes() for state in states}, []

    def poll(_):
        while not done.is_set():
            read.append(sim["position"].tobytes())
            assert sim["winch.tension"] > 0.0 and sim.result["time"][0] == 0.0

    with ThreadPoolExecutor(2) as pool:
        polls = [pool.submit(poll, k) for k in range(2)]
        try:
            for _ in range(200):
                sim.inputs["winch.pay_out_speed"] = 0.1
                sim.advance(0.005)
        finally:
            done.set()
        for one in polls:
            one.result(60.0)
    assert np.array_equal(sim["position"], alone["position"]) and sim["winch.tension"] == alone["winch.tension"]
    assert len(set(read)) > 2 and set(read) <= known


def test_a_part_of_the_state_is_read_at_rest_without_the_lock(whole, monkeypatch):
    def taken(self):
        raise AssertionError("the lock is taken")

    sim = whole.copy()
    before = sim["winch.tension"]
    monkeypatch.setattr(turn.Turn, "read", taken)
    assert np.array_equal(sim["payload.position"], whole["payload.position"]) and sim["winch.tension"] == before


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
    assert (
        read
        and sim["winch.tension"] == pytest.approx(whole["winch.tension"], rel=1e-9)
        and sim["winch.tension"] != read[-1]
    )


def in_child_of_a_fork(ask):
    """What ``ask`` gives there, as text."""

    def tell():
        faulthandler.dump_traceback_later(20.0, exit=True)
        print(ask())

    child = Forked(tell)
    out, errors = child.communicate()
    assert child.returncode == 0, errors
    return out.strip()


def refusal_of(act):
    try:
        return repr(act())
    except tautline.SimulationError as error:
        return str(error)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no forks here")
def test_a_child_forked_in_the_middle_of_another_threads_advance_is_refused_the_simulation_in_true_words(halted, whole):
    sim, finish = halted
    told = in_child_of_a_fork(lambda: "\n".join(refusal_of(lambda act=act: act(sim)) for act in ACTS.values()))
    told = told.splitlines()
    assert len(told) == len(ACTS) and len(set(told)) == 1
    assert "was forked while another thread advanced or changed the simulation" in told[0]
    assert "restore the state in the child in a new simulation" in told[0] and "being advanced" not in told[0]

    def restored():
        new = tautline.Simulation(HOIST)
        new.restore(whole.before)
        new.advance(1.0)
        return new["winch.tension"]

    assert float(in_child_of_a_fork(restored)) == whole["winch.tension"]
    finish()
    assert sim.time == 1.0 and np.isfinite(sim["winch.tension"])


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no forks here")
def test_a_child_forked_while_another_thread_only_reads_goes_on_as_the_parent_does(whole):
    sim, reading, go = tautline.Simulation(HOIST), threading.Event(), threading.Event()
    sim.advance(0.5)

    def reads():
        with sim._turn.look:
            reading.set()
            assert go.wait(60.0)

    def waits():
        assert reading.wait(60.0)
        sim.save()  # waits, and lets others wait behind it

    threads = [threading.Thread(target=one) for one in (reads, waits)]
    for thread in threads:
        thread.start()
    assert reading.wait(60.0)
    while not sim._turn._waiting:
        clock.sleep(0.001)

    def goes_on():
        sim.advance(0.5)
        return sim["winch.tension"]

    assert float(in_child_of_a_fork(goes_on)) == pytest.approx(whole["winch.tension"], rel=1e-9)
    go.set()
    for thread in threads:
        thread.join()
    assert sim.time == 0.5


def test_threads_that_advance_one_simulation_after_one_another_make_no_difference(whole):
    sim = tautline.Simulation(HOIST)
    for time in (0.3, 0.6, 1.0):
        thread = threading.Thread(target=sim.advance_to, args=(time,))
        thread.start()
        thread.join()
    assert np.array_equal(sim.result["position"][-1], whole.result["position"][-1])


@pytest.mark.parametrize("own", [False, True])
def test_ctrl_c_leaves_all_simulations_of_a_rollout_between_two_steps_and_is_told_as_of_one(own):
    def raises(number, frame):
        raise KeyboardInterrupt

    scene = tautline.read(HOIST).replace({"solver.step": "10 us"})
    sims = [tautline.Simulation(scene, keep=1.0) for _ in range(3)]
    other = sims[0].copy()
    before = signal.signal(signal.SIGINT, raises) if own else signal.getsignal(signal.SIGINT)
    timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    try:
        with pytest.raises(tautline.Interrupted) as stop:
            tautline.rollout(sims, until=8.0, workers=2)
    finally:
        timer.join()
        signal.signal(signal.SIGINT, before)
    times = [sim.time for sim in sims]
    # Two threads for three: the last was not begun, or not long ago.
    assert max(times) > 0.0 and max(times) < 8.0 and stop.value.time in times
    assert stop.value.result["time"][-1] <= stop.value.time
    clock.sleep(0.3)
    assert [sim.time for sim in sims] == times
    tautline.rollout([*sims, other], until=max(times) + 0.02)
    assert all(np.abs(sim["payload.position"] - other["payload.position"]).max() < 1e-6 for sim in sims)
