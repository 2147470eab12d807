"""What cannot be asked of a simulation is refused by a sentence, and the simulation is left where it was."""

import copy
import math
import pickle
from pathlib import Path

import numpy as np
import pytest

import tautline
from tautline.live.errors import SimulationError

HOIST = Path(__file__).parents[2] / "data" / "hoist.yaml"


@pytest.fixture(scope="module")
def sim():
    made = tautline.Simulation(tautline.read(HOIST))
    made.advance(0.2)
    return made


@pytest.mark.parametrize("duration", [np.array([0.1]), np.array([0.1, 0.2]), 1j, "1", None, math.nan, math.inf, [0.1]])
def test_what_is_no_time_is_refused(sim, duration):
    for ask in (sim.advance, sim.advance_to):
        with pytest.raises(SimulationError):
            ask(duration)
    assert sim.time == pytest.approx(0.2)


@pytest.mark.parametrize("number", [10**400, -(10**5000)], ids=["400 digits", "5000 digits"])
def test_a_whole_number_beyond_a_float_is_refused_everywhere_and_nothing_changes(sim, number):
    # Python raised an OverflowError, and writes no number of more than 4300 digits
    one = sim.copy()
    before = one.save().block
    asks = {
        "advance": lambda: one.advance(number),
        "advance to": lambda: one.advance_to(number),
        "rollout": lambda: tautline.rollout([one], until=number),
        "input": lambda: one.inputs.__setitem__("winch.pay_out_speed", number),
        "rate": lambda: one.inputs.__setitem__("winch.pay_out_speed", (0.0, number)),
        "parameter": lambda: one.parameters.__setitem__("payload.mass", number),
        "blow": lambda: one.displace("payload.velocity", [0.0, 0.0, number]),
        "equations": lambda: one.equations.mass(one.equations.state()[1], number),
        "keep": lambda: tautline.Simulation(one.scene, keep=number),
        "initial": lambda: tautline.Simulation(one.scene, initial={"winch.pay_out_speed": number}),
        "parameters": lambda: tautline.Simulation(one.scene, parameters={"payload.mass": number}),
    }
    for what, ask in asks.items():
        with pytest.raises(SimulationError) as refused:
            ask()
            pytest.fail(what)
        assert refused.value.cure and len(refused.value.cause) < 200
    assert np.array_equal(one.save().block, before) and not one.inputs.driven


@pytest.mark.parametrize("duration", [1e-300, 1e-17, 1e-12])
def test_an_advance_that_is_rounding_is_told_by_its_own_length(sim, duration):
    with pytest.raises(SimulationError, match=f"{duration:.3g} s is too short to go on by.*at least"):
        sim.advance(duration)


@pytest.mark.parametrize("text", ["1 m", "abc", "-1 s", ""])
def test_a_text_that_is_no_time_ahead_is_refused(sim, text):
    for ask in (sim.advance, sim.advance_to, lambda text: tautline.rollout([sim], text)):
        with pytest.raises(SimulationError):
            ask(text)
    assert sim.time == pytest.approx(0.2)


def test_a_time_may_be_a_text_with_its_unit(sim):
    one, other = sim.copy(), sim.copy()
    one.advance("100 ms")
    one.advance_to("0.4 s")
    other.advance(0.1)
    other.advance_to(0.4)
    assert one.time == other.time and one["winch.tension"] == other["winch.tension"]
    tautline.rollout([one], "500 ms")
    assert one.time == pytest.approx(0.5)


def test_a_rollout_to_a_time_before_all_simulations_is_refused_and_one_that_is_beyond_it_stays(sim):
    late = sim.copy()
    late.advance(0.2)
    for until in (-1, 0.1):
        with pytest.raises(SimulationError, match="give a later time"):
            tautline.rollout([sim, late], until=until)
    early = sim.copy()
    tautline.rollout([early, late], until=0.3)
    assert (early.time, late.time) == (pytest.approx(0.3), pytest.approx(0.4))


@pytest.mark.parametrize("keep", [-1, math.nan, "abc", None, [1.0]])
def test_what_is_no_span_of_frames_is_refused(keep):
    with pytest.raises(SimulationError, match="give True, False"):
        tautline.Simulation(tautline.read(HOIST), keep=keep)


@pytest.mark.parametrize("inputs", [[1], 5, [None]])
def test_what_is_no_name_of_an_input_is_refused(inputs):
    with pytest.raises(SimulationError, match="is no name of an input"):
        tautline.Simulation(tautline.read(HOIST), inputs)


def test_a_list_is_no_name(sim):
    for ask in (sim.outputs, sim.inputs, sim.parameters):
        with pytest.raises(SimulationError, match="there is no"):
            ask[["x"]]


@pytest.mark.parametrize(("until", "workers"), [(math.nan, None), ("5", None), ([3], None), (math.inf, None), (1.0, 0)])
def test_a_rollout_without_a_time_or_without_threads_is_refused(sim, until, workers):
    with pytest.raises(SimulationError):
        tautline.rollout([sim], until, workers)
    assert sim.time == pytest.approx(0.2)


def test_a_simulation_that_is_given_twice_to_a_rollout_is_refused_and_stays_and_its_copy_is_not(sim):
    other = sim.copy()
    with pytest.raises(SimulationError, match=r"simulations\[2\] is the same simulation as simulations\[0\].*copy"):
        tautline.rollout([sim, other, sim], until=0.4)
    assert sim.time == other.time == pytest.approx(0.2)
    tautline.rollout([other, other.copy()], until=0.4)
    assert other.time == pytest.approx(0.4)


def test_a_simulation_is_copied_by_whatever_copies_and_says_how_it_is_pickled(sim):
    for other in (copy.copy(sim), copy.deepcopy(sim)):
        other.advance(0.1)
        assert other.time == pytest.approx(0.3) and sim.time == pytest.approx(0.2)
        assert not np.shares_memory(other._state.q, sim._state.q)
    with pytest.raises(SimulationError, match="save"):
        pickle.dumps(sim)


def test_a_blow_is_booked_as_work_that_is_done_from_outside():
    sim = tautline.Simulation(tautline.read(HOIST))
    sim.advance(0.2)
    sim.displace("payload.velocity", [1.0, 0.0, 0.5])
    sim.advance(0.5)
    assert sim.result.attributes["energy_error"] < 1e-3
    with pytest.raises(SimulationError, match="no displacement"):
        sim.displace("payload.velocity", [0.0, "a", 0.1])


def test_one_name_may_stand_alone_where_names_are_asked_for():
    sim = tautline.Simulation(tautline.read(HOIST), inputs="winch.pay_out_speed")
    sim.advance(0.1)
    alone = sim.linearise("winch.pay_out_speed", "winch.tension")
    listed = sim.linearise(["winch.pay_out_speed"], ["winch.tension"])
    assert np.array_equal(alone.A, listed.A) and alone.C.shape == listed.C.shape


def test_a_state_that_was_damaged_on_its_way_is_refused(sim):
    sent = bytearray(pickle.dumps(sim.save()))
    sent[len(sent) // 2] ^= 0xFF
    with pytest.raises(SimulationError, match="is damaged"):
        pickle.loads(bytes(sent))
    state = sim.save()
    other = pickle.loads(pickle.dumps(state))
    assert np.array_equal(other.block, state.block) and other.time == state.time
    early = type(state)(-5.0, state.scene, state.layout, state.block, state.frames)
    with pytest.raises(SimulationError, match="no time"):
        sim.restore(early)


@pytest.mark.parametrize("value", [True, False, np.True_])
def test_true_and_false_are_no_mass_and_no_time(value):
    sim = tautline.Simulation(HOIST, keep=False)
    with pytest.raises(SimulationError, match="is no number"):
        sim.parameters["payload.mass"] = value
    with pytest.raises(SimulationError, match="is no time"):
        sim.advance(value)
    assert sim.time == 0.0 and sim.parameters["payload.mass"] == 5000.0


@pytest.mark.parametrize("value", [True, False, np.True_, (0.0, True), [np.False_, 0.0], np.array([True])])
def test_true_and_false_are_no_value_of_an_input(value):
    sim = tautline.Simulation(HOIST, keep=False)
    before = sim.inputs["winch.pay_out_speed"]
    with pytest.raises(SimulationError, match=r"winch.pay_out_speed = .* is neither a finite number"):
        sim.inputs["winch.pay_out_speed"] = value
    with pytest.raises(SimulationError, match=r"winch.pay_out_speed = .* is neither a finite number"):
        tautline.Simulation(HOIST, keep=False, initial={"winch.pay_out_speed": value})
    assert sim.inputs["winch.pay_out_speed"] == before


@pytest.mark.parametrize("what", ["parameters", "initial"])
@pytest.mark.parametrize("given", [[1], "x", 0, ["winch.pay_out"], ()])
def test_values_that_have_no_names_are_refused(what, given):
    with pytest.raises(tautline.ArgumentTypeError, match=f"{what} = .* is no mapping; give values by name"):
        tautline.Simulation(HOIST, **{what: given})


TEXTS = ["0.1", b"0.1", np.array("0.1"), np.array(True)]


@pytest.mark.parametrize("value", [*TEXTS, ("0.1", 0.0), np.array(["0.1"]), [[0.1], 0.0]])
def test_a_text_is_no_number_to_an_input_as_it_is_no_time(sim, value):
    before = sim.inputs["winch.pay_out_speed"]
    with pytest.raises(SimulationError, match=r"winch.pay_out_speed = .* is neither a finite number"):
        sim.inputs["winch.pay_out_speed"] = value
    assert sim.inputs["winch.pay_out_speed"] == before


@pytest.mark.parametrize("value", TEXTS)
def test_a_text_is_no_number_to_a_parameter_as_it_is_no_time(sim, value):
    with pytest.raises(SimulationError, match=r"payload.mass = .* is no number; give one in SI"):
        sim.parameters["payload.mass"] = value
    with pytest.raises(SimulationError, match="is no time"):
        sim.advance(value)
    assert sim.parameters["payload.mass"] == 5000.0


def test_an_array_without_a_dimension_is_the_number_in_it_to_all_that_take_numbers(sim):
    one = sim.copy()
    one.inputs["winch.pay_out_speed"] = np.array(0.1)
    one.parameters["payload.mass"] = np.array(5100.0)
    one.advance(np.array(0.1))
    assert one.inputs["winch.pay_out_speed"] == pytest.approx(0.1) and one.parameters["payload.mass"] == 5100.0
    assert one.time == pytest.approx(0.3)


def test_a_vector_of_inputs_is_read_as_it_is_written():
    sim = tautline.Simulation(HOIST, inputs=["payload.force"], keep=False)
    assert "payload.force" in sim.inputs and list(sim.inputs["payload.force"]) == [0.0, 0.0, 0.0]
    sim.inputs["payload.force"] = [(10.0, 1.0), 20.0, 30.0]
    assert list(sim.inputs["payload.force"]) == [10.0, 20.0, 30.0]
    assert [sim.inputs[f"payload.force[{k}]"] for k in range(3)] == [10.0, 20.0, 30.0]
    sim.advance(0.1)
    assert sim.inputs["payload.force"] == pytest.approx([10.0, 20.0, 30.0])
    with pytest.raises(SimulationError, match="is no vector; give 3 numbers"):
        sim.inputs["payload.force"] = np.array(1.0)
