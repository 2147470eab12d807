"""What an application knows of the work that its machine is at, beside the simulation of it.

A drill string hangs in slips for minutes, gets longer by a stand and goes on. It is on bottom, where the weight on the
bit is not known, or off bottom, where the hook load shows the friction. The twin asks such an operation of every row.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Protocol

import numpy as np


@dataclass(frozen=True)
class Guidance:
    """How a row is to be taken.

    Attributes
    ----------
    use : bool
        Whether what is measured says something of what is estimated.
    paused : bool
        Whether the machine is apart from its scene, so that the simulation waits. It begins from rest after that.
    scene : scene or None
        What the machine has become, such as a string that is a stand longer.
    rests : bool
        Whether the machine is at rest with what friction holds in it, which only what is measured shows.
    """

    use: bool = True
    paused: bool = False
    scene: Any = None
    rests: bool = False


@dataclass(frozen=True)
class Blur:
    """What moves the machine that no sensor shows and no estimate finds, such as waves of phases that nobody measures.

    Attributes
    ----------
    sds : (m,)
        Standard deviations of what is computed of the sensors by it, SI.
    lasts : float
        How long it stays alike, s: rows within that time tell no more than one.
    why : str
        Why what is computed is in doubt by it; a sentence without a full stop.
    suspect : str
        What in the scene may be otherwise there, one word or two; empty where nothing further is suspected.
    """

    sds: np.ndarray
    lasts: float = 0.0
    why: str = ""
    suspect: str = ""


def findings(operation: Operation | None) -> dict[str, str]:
    """Outputs that an operation finds: name -> what to give so that it does, empty where nothing is lacking."""
    return {} if operation is None else {**operation.elsewhere, **dict.fromkeys(operation.outputs, "")}


class Operation(Protocol):
    """What a twin asks of an application's operation.

    A class that derives from this one writes what it knows. All else is answered here, as an operation would that has
    nothing further to say: every row counts, every sensor tells something, and nothing is kept.

    Attributes
    ----------
    outputs, signals : mapping
        Name -> unit: of what it finds, and of what it asks for, beside outputs and inputs of the simulation.
    elsewhere : mapping
        Outputs that it would find if more were given: name -> what to give. A map that keeps them is refused with that.
    reads : sequence of str
        Outputs of the simulations that `counts`, `blurred`, `put_down` and `found` want.
    window : float or None
        Of the estimate where the map gives none, s: the longest time from one rest to the next. None for the usual one.
    mean : float
        Time over which rows are averaged before they are compared, s: several periods of what swings in the machine in
        a phase that nobody knows. A window is gone through anew from rest then. 0 for rows one by one.
    anywhere : bool
        Whether positions with ``zero: first`` count from where the machine stands whenever it begins anew.
    pulled : collection of str
        Outputs that are never negative: tensions of what cannot push.
    records : collection of type
        Classes of records that are in what `kept` gives (`tautline.twin.packing`).
    """

    outputs: Mapping[str, str] = MappingProxyType({})
    signals: Mapping[str, str] = MappingProxyType({})
    elsewhere: Mapping[str, str] = MappingProxyType({})
    reads: Sequence[str] = ()
    window: float | None = None
    mean: float = 0.0
    anywhere: bool = False
    pulled: Collection[str] = ()
    records: Collection[type] = ()

    def built(self, sim: Any) -> None:
        """Take notice of the simulation that stands for the machine from now on, at its start."""

    def sizes(self) -> Mapping[str, float]:
        """Sizes that outputs usually have, SI by name: noise that is a share of them is known before they show any."""
        return {}

    def doubts(self, plan: Any) -> list[str]:
        """What in the map, as it was checked, is likely not meant so: sentences with cause and cure."""
        return []

    def before(self, time: float, values: Mapping[str, float]) -> Guidance:
        """Take the values of a row in SI, by names of the map, before the simulation goes on to it."""
        return Guidance()

    def remarks(self) -> list[str]:
        """What rows have shown, such as that they come too slowly: sentences, each of them given once."""
        return []

    def counts(self, read: Mapping[str, np.ndarray], sensors: Sequence[str]) -> np.ndarray:
        """Which sensors (m,) tell something: all simulations (n, ...) do then what the machine does."""
        return np.ones(len(sensors), bool)

    def blurred(self, read: Mapping[str, np.ndarray], sensors: Mapping[str, str]) -> Blur:
        """What nobody measures makes of sensors, output -> SI unit, where the simulations (n, ...) are."""
        return Blur(np.zeros(len(sensors)))

    def put_down(self, read: Mapping[str, np.ndarray]) -> bool:
        """Whether in all simulations (n, ...) every load stands on the ground: nothing is left of how it bounced."""
        return False

    def found(
        self, time: float, measured: Mapping[str, tuple[float, float]], outputs: Mapping[str, tuple[Any, Any]],
        estimates: Mapping[str, tuple[float, float]], sim: Any,
    ) -> dict[str, tuple[float, float]]:  # fmt: skip
        """Further estimates of a row: name -> value and standard deviation.

        Parameters
        ----------
        measured : mapping
            Output of a sensor -> value, NaN where it is not believed, and standard deviation.
        outputs : mapping
            Computed at the estimate: value and standard deviation; of the sensors' outputs and of `reads`.
        estimates : mapping
            Parameter or offset of the map -> value and standard deviation.
        sim : Simulation
            The simulation itself, near the estimate.
        """
        return {}

    def simulated(self, sim: Any) -> dict[str, float]:
        """Signals that a simulation knows, for a record of it."""
        return {}

    def contradicted(self) -> Mapping[str, str]:
        """Sensors that cannot be right by what the machine does, while nothing is compared: output -> why."""
        return {}

    def told(self) -> dict[str, Any]:
        """Further keys of a line."""
        return {}

    def summary(self) -> list[tuple[str, str]]:
        """What the summary says at the end of the rows, beside the last estimates: a name and words of each."""
        return []

    def alarms(self) -> Iterator[tuple[str, bool, str, float]]:
        """Further alarms: name, whether it holds, text, and how long it has to hold, s.

        Each of them comes every time, whether it holds or not, from the start of the operation on.
        """
        return iter(())

    def save(self) -> None:
        """Write what is kept over operations; raises ResultError where that is not possible."""

    def memory(self) -> dict[str, Any]:
        """What a later process needs to go on, for JSON."""
        return {}

    def recall(self, memory: Mapping[str, Any]) -> Any:
        """Go on from what an earlier process kept; gives the scene that the machine had become, or None."""
        return None

    def kept(self) -> dict[str, Any]:
        """Things, by name, of which a later process needs all that they hold, to go on to the bit."""
        return {}
