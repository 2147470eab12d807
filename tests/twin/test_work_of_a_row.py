"""What a row costs a twin: nothing is done twice, and Ctrl-C is heard though it is listened for once."""

import signal

import numpy as np
import pytest
from twin.rehearsal import calm_rows, weight_twin

from tautline.integrators.status import Interrupted
from tautline.live.errors import real
from tautline.live.inputs import Inputs
from tautline.live.simulation import Simulation
from tautline.twin.signals.inputs import _median


def rows_until(end):
    return [row for row in calm_rows() if row[0] < end]


def test_a_row_is_observed_once_of_all_simulations_together(monkeypatch):
    alone = []
    monkeypatch.setattr(Simulation, "_observe", lambda sim: alone.append(sim.time) or sim.model.seen(sim._frames))
    twin, lines = weight_twin(start="5 t"), []
    for row in rows_until(4.0):
        if len(lines) < 5:
            alone.clear()  # the first row looks how a load bounces
        lines += twin.add(*row)
    assert len(lines) > 10 and alone == []


def test_an_input_of_one_function_is_evaluated_once_an_advance(monkeypatch):
    twin = weight_twin(start="5 t")
    for row in rows_until(2.0):
        twin.add(*row)
    written, evaluated = [], []
    write, now = Inputs._write, Inputs._now
    monkeypatch.setattr(Inputs, "_write", lambda self, *given: written.append(given) or write(self, *given))
    monkeypatch.setattr(Inputs, "_now", lambda self, function: evaluated.append(function) or now(self, function))
    family = twin.estimate.family
    inputs = twin.estimate.log.rows[-1].inputs
    family.advance(family.time + 0.1, inputs)
    assert len(evaluated) == len(written) == len(inputs) * len(family.simulations)


@pytest.mark.parametrize("last", [False, True])
def test_ctrl_c_while_a_family_goes_on_is_heard_in_whichever_of_its_simulations(monkeypatch, last):
    twin = weight_twin(start="5 t")
    for row in rows_until(2.0):
        twin.add(*row)
    family, came = twin.estimate.family, []
    advance = Simulation.advance_heard

    def pressed(sim, time, ear):
        came.append(sim)
        if sim is family.simulations[-1 if last else 0]:
            if last:
                advance(sim, time, ear)
            signal.raise_signal(signal.SIGINT)
        if not (last and ear.heard):
            advance(sim, time, ear)

    monkeypatch.setattr(Simulation, "advance_heard", pressed)
    with pytest.raises((KeyboardInterrupt, Interrupted)):
        family.advance(family.time + 0.1, twin.estimate.log.rows[-1].inputs)
    assert len(came) == (len(family.simulations) if last else 1)


@pytest.mark.parametrize("count", [1, 2, 5, 100, 101])
def test_the_median_of_plain_floats_is_that_of_an_array_to_the_bit(count):
    values = np.random.default_rng(count).normal(size=count).tolist()
    assert _median(values) == float(np.median(values))


def test_a_float_is_given_back_as_it_is_and_no_number_is_still_refused():
    assert real(0.1, "number", "") == 0.1
    for bad in (True, "1", None, [1.0], 1j):
        with pytest.raises(Exception, match="is no number"):
            real(bad, "number", "")
