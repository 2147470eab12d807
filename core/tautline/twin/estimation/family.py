"""Simulations side by side: one at the estimate, and one for each number that is not known, a little off in it.

Not known are parameters, and the free motion that the machine has at the begin of a window: a load bounces on its rope
for minutes, by blows that no sensor saw. The neighbour of a free motion gets a blow at the begin.

Their differences are the derivatives of everything that is computed. A neighbour has always had its own parameter, and
its state is not that of the first: a simulation whose mass is changed alone, in the middle of a run, bounces, and what
sticks comes loose. When the estimate moves, the first simulation is put to the new one by the differences, its state
included.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from tautline.interruption import listening
from tautline.live.readings import read_frames

if TYPE_CHECKING:
    from tautline.live.memory import State
    from tautline.live.simulation import Simulation

FEWEST = 12
"""Rows in which free motion can be told from what is steady."""
ROUGH = 1.0
"""Scatter of a derivative, over its size, from which on only its steady part is believed."""
STEADY = 3
"""Terms of what moves slowly, beside a free motion."""
LONGEST = 0.5
"""Longest advance at a time, s."""


class Family:
    """A simulation and its neighbours.

    Parameters
    ----------
    simulations : sequence of Simulation
        The one at the parameters, then one for each parameter.
    names : sequence of str
        Parameters (p,).
    blows : sequence of Blow
        Free motions (b,).

    Attributes
    ----------
    at : (p,)
        Parameters of the first.
    apart : (p + b,)
        How far each neighbour is off in its own; of free motions in blows of the usual size.
    mixed : (b, p)
        Free motion that is in the difference of each parameter's neighbour, a unit of the parameter. It depends on
        where the window begins, and by the difference of frequencies it would grow: derivatives are given without it.
    blows_due : list of (float, int)
        Times, s, at which blows are still to fall, and their numbers; the next one first.
    """

    def __init__(self, simulations: Sequence[Simulation], names: Sequence[str], blows: Sequence[Blow] = ()) -> None:
        self.simulations, self.names, self.blows = list(simulations), list(names), list(blows)
        self.at, self.apart = np.zeros(len(names)), np.ones(len(names) + len(blows))
        self.mixed = np.zeros((len(blows), len(names)))
        self.trust: np.ndarray | None = None
        self.steady, self.rough = np.zeros(0), np.zeros(0)
        self.blows_due: list[tuple[float, int]] = []

    @property
    def time(self) -> float:
        """Where they all stand, s."""
        return self.simulations[0].time

    def parameters_of(self, i: int) -> np.ndarray:
        """Parameters (p,) of the i-th simulation."""
        theta = self.at.copy()
        if 0 < i <= theta.size:
            theta[i - 1] += self.apart[i - 1]
        return theta

    def set_parameters(self) -> None:
        """Give every simulation its parameters."""
        for i, sim in enumerate(self.simulations):
            for name, value in zip(self.names, self.parameters_of(i), strict=True):
                sim.parameters[name] = value

    def advance(self, time: float, inputs: Sequence[tuple[str, np.ndarray]]) -> None:
        """Go on to a time with inputs that are reached there: name, (value, rate, second rate)."""
        while self.blows_due and self.blows_due[0][0] <= self.time + 1e-9:
            k = self.blows_due.pop(0)[1]
            self.simulations[1 + len(self.names) + k].displace(self.blows[k].output, self.blows[k].by)
        given = [(name, self.simulations[0].inputs.within(name, state)) for name, state in inputs]
        with listening(patient=True) as ear:
            for sim in self.simulations:
                for name, state in given:
                    sim.inputs[name] = state
                sim.advance_heard(time, ear)
            ear.check()

    def frames(self) -> np.ndarray:
        """Frames (1 + p + b, width) of all, as they stand."""
        return np.concatenate([sim.parts.frames.rows for sim in self.simulations])

    def read(self, names: Sequence[str]) -> list[np.ndarray]:
        """Outputs of all: one array (1 + p + b, ...) for each name."""
        return self.read_frames(self.frames(), names)

    def read_frames(self, frames: np.ndarray, names: Sequence[str]) -> list[np.ndarray]:
        """Outputs of frames (..., 1 + p + b, width) of all: for each name (..., 1 + p + b, shape of the output).

        Where what a parameter changes is in the frames, the first member's model observes those of all.
        """
        if self.simulations[0].model.frames_tell_all:
            return _read(self.simulations[0], frames, names)
        each = [_read(sim, frames[..., i, :], names) for i, sim in enumerate(self.simulations)]
        return [np.stack(of_all, axis=frames.ndim - 2) for of_all in zip(*each, strict=True)]

    def derivatives(self, values: np.ndarray) -> np.ndarray:
        """(..., p + b) of what `read` gave."""
        if len(values) == 1:
            return np.zeros((*values.shape[1:], 0))
        apart = values[1:] - values[0]
        found = (apart.T if apart.ndim <= 2 else np.moveaxis(apart, 0, -1)) / self.apart
        if self.blows:
            p = len(self.names)
            found[..., :p] -= found[..., p:] @ self.mixed
        return found

    def unmix(self, J: np.ndarray, sd: np.ndarray) -> np.ndarray:
        """Find the free motion in the derivatives of a window, and take it out of them, now and from now on.

        Of a derivative that still scatters, only what is steady is believed: near a slip a neighbour takes other turns
        than the first, and their difference is no derivative.

        Parameters
        ----------
        J : (n, m, p + b)
            Of n rows and m sensors.
        sd : (m,)
            By which sensors are weighed.
        """
        p, b = len(self.names), len(self.blows)
        n, m = J.shape[:2]
        if not b or not p or n < FEWEST:
            return J
        # Beside the free motion there is, in each sensor, what is steady, or moves with the machine.
        slow = np.linspace(-1.0, 1.0, n)[:, None] ** np.arange(STEADY)
        scale = np.abs(J[..., p:] / sd[:, None]).max(axis=(0, 1), initial=1e-12)
        left = np.zeros((n, m, b + m * STEADY))
        left[..., :b] = J[..., p:] / sd[:, None] / scale
        for i in range(m):
            left[:, i, b + i * STEADY : b + (i + 1) * STEADY] = slow
        right = J[..., :p] / sd[:, None]
        found = np.linalg.lstsq(left.reshape(n * m, -1), right.reshape(n * m, p), rcond=1e-6)[0]
        more = found[:b] / scale[:, None]
        self.mixed = self.mixed + more
        clean = J[..., :p] - J[..., p:] @ more
        steady = np.einsum("nr,mrp->nmp", slow, found[b:].reshape(m, STEADY, p)) * sd[:, None]
        rough = np.sqrt(np.mean((clean - steady) ** 2, axis=0))
        usual = np.abs(steady).mean(axis=0)
        self.rough = rough
        self.trust = 1.0 / (1.0 + (rough / (ROUGH * usual + 1e-300)) ** 4)
        self.steady = steady[-1]
        return np.concatenate([self.trust * clean + (1.0 - self.trust) * steady, J[..., p:]], axis=-1)

    def believed(self, J: np.ndarray) -> np.ndarray:
        """Derivatives (m, p + b) of the sensors, as far as they are believed."""
        if self.trust is None:
            return J
        p = len(self.names)
        return np.concatenate([self.trust * J[:, :p] + (1.0 - self.trust) * self.steady, J[:, p:]], axis=-1)

    def save(self) -> list[State]:
        """States of all."""
        return [sim.save() for sim in self.simulations]

    def restore(self, states: Sequence[State]) -> None:
        """Stand where states were saved; parameters are those of the states."""
        for sim, state in zip(self.simulations, states, strict=True):
            sim.restore(state)

    def stand(
        self, states: Sequence[State], of: Family, shift: np.ndarray, apart: np.ndarray, late: float,
        fresh: np.ndarray, plain: bool = False,
    ) -> None:  # fmt: skip
        """Stand where another family was saved, at other numbers; the blows are given anew.

        Parameters
        ----------
        states : sequence of State
            Of all of the other family.
        of : Family
            The other family, of which ``at`` and ``apart`` tell what its states differ in.
        shift : (p + b,)
            Of the first simulation from the other's first.
        apart : (p,)
            How far the neighbours shall be off in their parameters.
        late : float
            How long after that late blows come, s.
        fresh : (p,) of bool
            Which neighbours begin in the state of the first: those of which the difference has grown wild.
        plain : bool
            Whether the first keeps the state as it is, and only its parameters are moved.
        """
        base, others = states[0], [state.block for state in states[1:]]
        p, memory = len(self.names), self.simulations[0].parts.memory
        moved = shift.copy()
        moved[p:] -= of.mixed @ shift[:p]
        at = of.at + shift[:p]
        for i, sim in enumerate(self.simulations):
            weights = (0.0 if plain else 1.0) * moved / of.apart
            if 0 < i <= p and not fresh[i - 1]:
                weights[i - 1] += apart[i - 1] / of.apart[i - 1]
                weights[p:] -= apart[i - 1] * of.mixed[:, i - 1] / of.apart[p:]
            block = memory.combine(base.block, others, weights) if others else base.block
            sim.restore(replace(base, block=block))
        self.at, self.apart = at, np.append(apart, np.ones(len(self.blows)))
        self.mixed, self.trust = np.zeros_like(self.mixed), None
        self.set_parameters()
        self.strike(late)

    def strike(self, late: float) -> None:
        """Give the neighbours of free motions their blows: now, or a time later, s, where a blow comes late."""
        due = [(self.time + (late if blow.late else 0.0), k) for k, blow in enumerate(self.blows)]
        self.blows_due = sorted(due)


@dataclass(frozen=True)
class Blow:
    """What sets a free motion off.

    Attributes
    ----------
    output : str
        A velocity of a thing.
    by : (3,)
        What is added to it: as much as is usual.
    late : bool
        Whether it comes a quarter of the motion's period later: two blows make any amplitude and phase.
    """

    output: str
    by: tuple[float, ...]
    late: bool = False


def _read(sim: Simulation, frames: np.ndarray, names: Sequence[str]) -> list[np.ndarray]:
    """Outputs of frames (..., width), observed by one simulation's model."""
    found = read_frames(sim.model, sim.outputs.handles, frames.reshape(-1, frames.shape[-1]), names)
    return [one.reshape((*frames.shape[:-1], *one.shape[1:])) for one in found]


def steps_to(begin: float, end: float) -> list[float]:
    """Times of advances that are not too long, s."""
    n = max(1, int(np.ceil((end - begin) / LONGEST - 1e-9)))
    return [begin + (end - begin) * (k + 1) / n for k in range(n)]
