"""What runs inside an FMU, whatever the version of the standard: a simulation that waits for its parameters."""

from __future__ import annotations

import json
import math
import zlib
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from tautline.errors import TautlineError
from tautline.live.errors import SimulationError
from tautline.live.fmu.needs import check_packages
from tautline.live.memory import State, damaged, number_of, read_exactly, state_of, word_of
from tautline.live.simulation import SHORTEST, Simulation
from tautline.system.handles import PART, Output

SCENE, DESCRIPTION = "scene", "unit.json"
"""Names of the scene's own folder, and of what tells its file and what goes in and out, among the resources."""
BASE = {
    "m": {"m": 1}, "m/s": {"m": 1, "s": -1}, "m/s^2": {"m": 1, "s": -2}, "rad": {"rad": 1},
    "rad/s": {"rad": 1, "s": -1}, "N": {"kg": 1, "m": 1, "s": -2}, "N m": {"kg": 1, "m": 2, "s": -2}, "kg": {"kg": 1},
    "s": {"s": 1}, "1/s": {"s": -1}, "W": {"kg": 1, "m": 2, "s": -3}, "J": {"kg": 1, "m": 2, "s": -2},
    "kg m^2": {"kg": 1, "m": 2}, "1/m": {"m": -1}, "N s/m": {"kg": 1, "s": -1}, "N s^2/m^2": {"kg": 1, "m": -1},
    "N m^2": {"kg": 1, "m": 3, "s": -2}, "kg/m": {"kg": 1, "m": -1}, "m/s^3": {"m": 1, "s": -3},
    "rad/s^2": {"rad": 1, "s": -2}, "rad/s^3": {"rad": 1, "s": -3}, "N/s": {"kg": 1, "m": 1, "s": -3},
    "N/s^2": {"kg": 1, "m": 1, "s": -4}, "N m/s": {"kg": 1, "m": 2, "s": -3}, "N m/s^2": {"kg": 1, "m": 2, "s": -4},
    "1/s^2": {"s": -2},
}  # fmt: skip
"""Units that are written, by their base units."""
RATES = ".rate", ".second_rate"
"""What stands behind the name of an input in those of its rates, which a host may give beside its value."""
WORDS = "rate", "second rate"
DERIVED = ("m", "m/s", "m/s^2", "m/s^3"), ("rad", "rad/s", "rad/s^2", "rad/s^3")
"""Units of what is derived by time, one after another."""
NEAR = 1.0e-9
"""Difference of the host's time and ours that is rounding, s, beside that of the times themselves."""
ROUNDED = 4.0
"""Units in the last place of the largest time by which sums of times differ that are meant to be the same."""


def parts_of(output: Output) -> list[tuple[str, tuple[int, ...]]]:
    """Names of the numbers of an output, and their places in it: one, or one for each of an array."""
    if output.shape == ():
        return [(output.name, ())]
    return [(f"{output.name}[{','.join(map(str, at))}]", at) for at in np.ndindex(*output.shape)]


def actual_of(name: str, inputs: Sequence[str]) -> str:
    """The name of an output in an FMU: its own, or with ``.actual`` where an input has it, such as a winch's tension.

    An FMU has each name once, for what is asked for or for what is.
    """
    found = PART.fullmatch(name)
    thing, index = (found[1], name[len(found[1]) :]) if found else (name, "")
    driven = {match[1] if (match := PART.fullmatch(one)) else one for one in inputs}
    return f"{thing}.actual{index}" if thing in driven else name


def rate_unit(unit: str, order: int) -> str:
    """Unit of the first or second rate (``order``) of what has a unit."""
    known = next((row[row.index(unit) + order] for row in DERIVED if unit in row[: -len(WORDS)]), "")
    return known or f"{unit or 1}/s{'^2' if order == 2 else ''}"


def rates_of(inputs: Sequence[str]) -> tuple[list[str], dict[str, list[str]]]:
    """Names of inputs apart from those of their rates, such as ``vessel.heave.rate`` beside ``vessel.heave``.

    Returns
    -------
    values : list of str
    rates : dict of str to list of str
        Input -> the names of its rate and second rate, as far as they are asked for.

    Raises
    ------
    SimulationError
        For a second rate without the rate.
    """
    rates: dict[str, list[str]] = {}
    for name in sorted(dict.fromkeys(inputs), key=len):
        end = next((end for end in RATES if name.endswith(end)), "")
        if end and name.removesuffix(end) in rates:
            rates[name.removesuffix(end)].append(name)
        else:
            rates[name] = []
    for name, found in rates.items():
        if found and found[0] != name + RATES[0]:
            raise SimulationError(f"the second rate of {name} says nothing without its rate", f"name {name}.rate too")
    return [name for name in inputs if name in rates], {name: found for name, found in rates.items() if found}


NO_STATE, AGAIN = "no state", "initialised again"
"""Keys under which it stands why bytes are no state, and that the unit was to be initialised twice."""


class Core:
    """The simulation of an FMU.

    Parameters
    ----------
    resources : path
        Folder of the scene and of the description.
    """

    def __init__(self, resources: str | Path) -> None:
        folder = Path(resources)
        self.told: dict[str, Any] = json.loads((folder / DESCRIPTION).read_text(encoding="utf8"))
        if "scene" not in self.told:
            raise SimulationError("the FMU was written by an earlier build of Tautline", "write it anew")
        self.scene = folder / SCENE / self.told["scene"]
        check_packages(self.told["packages"])
        self.changed: dict[str, float] = {}
        self.given: dict[str, float] = {}
        self.held: dict[str, float] = {}
        self.refused: dict[str, str] = {}
        self.fault = ""
        self.begin, self.timed = 0.0, False
        self.stale, self.initialised = False, False
        self.running, self.terminated = False, False
        self.sim = Simulation(self.scene, inputs=self.told["inputs"], keep=False)
        parts = (name for asked in self.told["inputs"] for name in self.sim.inputs.parts_of(asked))
        self.inputs = list(dict.fromkeys(parts))
        self.ways = {part: [part] for part in self.inputs}
        for name, rates in self.told.get("rates", {}).items():
            for part in self.sim.inputs.parts_of(name):
                self.ways[part] += [part + end for end in RATES[: len(rates)]]
        self.rates = {rate: (part, k + 1) for part, (_, *some) in self.ways.items() for k, rate in enumerate(some)}
        self.sent: dict[str, float] = {}
        self.outputs = {
            actual_of(part, self.told["inputs"]): (name, at)
            for name in self.told["outputs"]
            for part, at in parts_of(self.sim.outputs.handle(name))
        }

    def signals(self) -> list[tuple[str, str, str, str]]:
        """Name, unit, meaning and kind (``input``, ``output``, ``parameter``) of all that goes in and out."""
        sim, found = self.sim, []
        for name in self.inputs:
            one = sim.inputs.handle(name).steering
            found.append((name, one.unit, one.text, "input"))
        for rate, (part, order) in self.rates.items():
            one = sim.inputs.handle(part).steering
            found.append((rate, rate_unit(one.unit, order), f"{WORDS[order - 1]} of {part}", "input"))
        for name, (output, _) in self.outputs.items():
            read = sim.outputs.handle(output)
            found.append((name, read.unit, read.text, "output"))
        taken = {name for name, *_ in found}
        for name, told in sim.parameters.describe().items():
            if name not in taken:
                found.append((name, told["unit"], told["text"], "parameter"))
        return found

    def begun(self) -> Simulation:
        """The simulation with the parameters and inputs that were set before it began.

        Raises
        ------
        SimulationError
            Where no start is found with them. The last start that was found stays.
        """
        if self.stale:
            if self.fault:
                raise SimulationError(self.fault)
            told = self.told["inputs"]
            try:
                self.sim = Simulation(self.scene, told, keep=False, parameters=self.changed, initial=self.held)
            except TautlineError as error:
                self.fault = f"no start is found with what was set: {error}; the outputs are those of the start before"
                raise SimulationError(self.fault) from None
            self.sent = dict(self.held)
            self.stale = False
        return self.sim

    def start_at(self, time: float) -> None:
        """Take the host's time of the start, s. Where no host says it, the first step does."""
        self.begin, self.timed = float(time), True

    def initialise(self) -> None:
        """Find the start, after which inputs are reached in steps and parameters count from then on.

        Where none is found, or a value was refused, what is set next is still of the start.

        Raises
        ------
        SimulationError
            Where no start is found, and where one was found before: a host that goes on as if the unit began anew would
            take what follows for another experiment. No step is made then until a state is set.
        """
        if self.initialised:
            cause = "the unit is initialised already, and stands at its time"
            error = SimulationError(cause, "reset it, or set a state that was saved before")
            self.refused[AGAIN] = str(error)
            raise error
        self.running = True
        self.begun()
        self.initialised = not self.refused

    def terminate(self) -> None:
        """Take no further step, until a state is set that was saved while steps were made."""
        self.running, self.terminated = False, True

    def asked_step(self, time: float, length: float) -> None:
        """One communication step that a host asks for; raises as `step` does, and where none may be asked for."""
        if not self.running and not self.refused:  # which would have a cause of its own
            if self.terminated:
                raise SimulationError("the unit was terminated", "reset it, or set a state that was saved before")
            raise SimulationError("the unit is not initialised", "leave the initialisation mode before the first step")
        self.step(time, length)

    def get(self, name: str) -> float:
        """An input, an output or a parameter. Of a start that is not found it is what the start before has."""
        if name in self.rates and name not in self.given:
            # In a step for which nothing was set an input comes to rest, whatever rate it had.
            part, order = self.rates[name]
            return self.sim.inputs.motion(part)[order] + 0.0
        if name in self.inputs or name in self.rates:
            for known in (self.given, self.held if self.stale else self.sent):
                if name in known:
                    return known[name]
            return float(self.sim.inputs[name]) + 0.0  # minus zero, of a winch at rest, becomes zero
        if name in self.outputs:
            output, at = self.outputs[name]
            with suppress(SimulationError):
                self.begun()
            value = self.sim[output]
            return float(value[at] if at else value) + 0.0
        with suppress(SimulationError):
            # Of two that set the same, such as both friction factors and one of them, the later one counts for both.
            return float(self.begun().parameters[name])
        return float(self.changed.get(name, self.sim.parameters[name]))

    def set(self, name: str, value: float) -> None:
        """An input, held from the start on, or reached at the end of the next communication step; or a parameter.

        A parameter is one of the start until this is found for good, and changes the simulation as it stands after it.

        Raises
        ------
        SimulationError
            For a value that it cannot have. It stays as it was, and no step is made until it is set to one it can have.
        """
        value = float(value)
        try:
            if name in self.inputs:
                self.sim.inputs.checked(name, value)
            elif name in self.rates:
                if not math.isfinite(value):
                    raise SimulationError(f"{name} = {value} is no finite number", "give a number")
            elif self.initialised:
                self.sim.parameters[name] = value
            else:
                self.sim.parameters.checked(name, value)
        except SimulationError as error:
            self.refused[name] = str(error)
            raise
        self.refused.pop(name, None)
        if name in self.rates or (name in self.inputs and self.initialised):
            self.given[name] = value
            return
        self.given.pop(name, None)
        kept = self.held if name in self.inputs else self.changed
        # One that is set again is the last one: a start is found with parameters in the order in which they were set.
        kept.pop(name, None)
        kept[name] = value
        if not self.initialised:
            self.stale, self.fault = True, ""

    def step(self, time: float, length: float) -> None:
        """One communication step; raises what the simulation raises, and where a value that was set is refused.

        One so short that it is rounding beside the scene's output is no advance, and succeeds: hosts of variable step
        make such ones. Outputs stay, and inputs wait for the next step, which may begin before or behind it.
        """
        if self.refused:
            raise SimulationError("; ".join(self.refused.values()))
        sim = self.begun()
        self.initialised = True  # also where what was set after the initialisation made a start of it
        if sim.stopped:
            # Before the time, which a host that goes on after a failure has no longer from here.
            cure = "set a state that was saved before"
            raise SimulationError(f"the simulation has stopped: {sim.stopped}{self._clock()}", cure)
        if not self.timed:
            self.start_at(time)
        rounding = SHORTEST * sim.model.solver.interval
        largest = max(abs(time), abs(self.begin), sim.time)
        off = time - self.begin - sim.time
        if abs(off) > max(NEAR, rounding) + ROUNDED * math.ulp(largest):
            # At epoch times the two may be alike in all digits that are told.
            side = "earlier" if off > 0.0 else "later"
            stands = f"{self.begin + sim.time:.15g} s, {abs(off):.3g} s {side}"
            cause = f"the host steps from {time:.15g} s, and the unit stands at {stands}"
            raise SimulationError(cause, "set the state that was saved there")
        if not 0.0 < length < math.inf:
            raise SimulationError(f"a communication step of {length:g} s", "give one above zero")
        end = time - self.begin + length
        if end - sim.time < rounding:
            return
        for name, way in self._given_ways().items():
            sim.inputs[name] = way
        self.sent.update(self.given)
        self.given.clear()
        try:
            sim.advance_to(end)
        except TautlineError as error:
            if not self.begin:
                raise
            raise SimulationError(f"{error}{self._clock()}") from error

    def _clock(self) -> str:
        """Whose time is told by what the simulation says; nothing where the host counts from the scene's start."""
        if not self.begin:
            return ""
        side = "less" if self.begin > 0.0 else "more"
        return f" (by the scene's time, which is {abs(self.begin):.15g} s {side} than the host's)"

    def _given_ways(self) -> dict[str, float | tuple[float, ...]]:
        """What inputs are to have at the end of the next step: a value, with rates where the host gives them.

        What was given before and stays as it is needs no way to it, unless it has a rate there. What was never given
        still goes by the scene.
        """
        ways: dict[str, float | tuple[float, ...]] = {}
        for part, names in self.ways.items():
            if not any(name in self.given for name in names):
                continue
            value, *rates = (self.given.get(name, self.sent.get(name)) for name in names)
            if value is None:
                continue
            # A second rate without the rate says nothing.
            given = rates[: rates.index(None)] if None in rates else rates
            known = tuple(rate for rate in given if rate is not None)
            if any(known) or any(name in self.given and self.given[name] != self.sent.get(name) for name in names):
                ways[part] = (value, *known) if known else value
        return ways

    # -- state ---------------------------------------------------------------------------------------------------------

    def save(self) -> dict[str, Any]:
        """All that a state of the FMU is; raises SimulationError where no start is found with what was set."""
        return {
            "state": self.begun().save(), "sent": dict(self.sent), "given": dict(self.given),
            "held": dict(self.held), "changed": dict(self.changed), "begin": self.begin, "timed": self.timed,
            "initialised": self.initialised, "running": self.running,
        }  # fmt: skip

    def refuse_output(self, name: str) -> None:
        """Say that an output cannot be set; raises SimulationError. It stays what is computed, and steps go on."""
        raise SimulationError(f"{name} is an output: it is computed, and cannot be set", "set an input or a parameter")

    def refuse_time(self) -> None:
        """Say that the time cannot be set; raises SimulationError. It stays what it is, and steps go on."""
        raise SimulationError("time is what steps have come to: it cannot be set", "take a step")

    def restore(self, saved: dict[str, Any]) -> None:
        """Stand where a state was saved.

        Raises
        ------
        SimulationError
            For what is no state of this FMU. No step is made then until one is set that is.
        """
        try:
            if NO_STATE in saved:
                raise SimulationError(saved[NO_STATE])
            self.sim.restore(saved["state"])
        except SimulationError as error:
            self.refused[NO_STATE] = str(error)
            raise
        self.stale, self.fault = False, ""
        self.refused.clear()
        self.sent, self.given = dict(saved["sent"]), dict(saved["given"])
        self.held, self.changed = dict(saved["held"]), dict(saved["changed"])
        self.begin, self.timed = saved["begin"], saved["timed"]
        # Else an input that is set next would be taken for one of a start that is still to be found, or the reverse.
        self.initialised, self.running = saved["initialised"], saved["running"]


def no_state(cause: str) -> dict[str, Any]:
    """What a host, which would die of an error, is given for a state where there is none: it is refused where set."""
    return {NO_STATE: cause}


def to_bytes(saved: dict[str, Any]) -> bytes:
    """A state as bytes: a sum of all the rest, numbers as JSON, then the block."""
    if NO_STATE in saved:
        return b""
    state: State = saved["state"]
    rest = json.dumps({**saved, "state": state.told}).encode("utf8") + b"\0" + state.block.tobytes()
    return _sum_of(rest) + rest


def state_from_bytes(data: bytes) -> dict[str, Any]:
    """The same for a host: other bytes are no state."""
    try:
        return from_bytes(data)
    except SimulationError as error:
        return no_state(str(error))


def from_bytes(data: bytes) -> dict[str, Any]:
    """What `to_bytes` wrote; raises SimulationError for anything else."""
    data = bytes(data)
    rest = data[len(_sum_of(b"")) :]
    head, _, block = rest.partition(b"\0")
    try:
        told = json.loads(head)
    except (ValueError, RecursionError):
        raise SimulationError("the bytes are no state of this FMU", "give those that it was serialised to") from None
    if not data.startswith(_sum_of(rest)):
        raise damaged()
    return read_exactly(READ | {"state": lambda told: state_of(told, np.frombuffer(block, np.uint8))}, told)


def _sum_of(rest: bytes) -> bytes:
    """A sum of bytes that hardly any damage leaves as it is, as letters."""
    return f"{zlib.crc32(rest):08x}".encode("ascii")


def _values(told: Any) -> dict[str, float]:
    if not isinstance(told, dict):
        raise TypeError(told)
    return {word_of(name): _finite(value) for name, value in told.items()}


def _finite(told: Any) -> float:
    if not math.isfinite(number_of(told)):
        raise ValueError(told)
    return float(told)


def _switch(told: Any) -> bool:
    if not isinstance(told, bool):
        raise TypeError(told)
    return told


READ: dict[str, Callable[[Any], Any]] = {
    "sent": _values, "given": _values, "held": _values, "changed": _values, "begin": _finite,
    "timed": _switch, "initialised": _switch, "running": _switch,
}  # fmt: skip
"""What a state of an FMU holds beside that of its simulation, and how it is read of bytes."""
