"""A linear system, and what is asked of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from tautline.live.errors import SimulationError, plain_numbers


@dataclass(frozen=True, eq=False)
class Plant:
    """A linear system with the names of its parts, in SI.

    Attributes
    ----------
    A, B, C, D : float arrays
        ``x. = A x + B u``, ``y = C x + D u``; x, u and y are changes from where the simulation stood.
    E : float array
        Of inputs that are speeds: what their rates add to the outputs at once, by the inertia of what is moved. It is
        small, and no part of A, B, C, D: ``y = C x + D u + E u.``.
    states, inputs, outputs : tuple of str
    units : dict of str to str
        Of inputs and outputs.
    time : float
        When, s.
    held : tuple of str
        What goes on in a run and is held still here, such as the bottom of a hole.
    stuck : tuple of str
        What sticks, and so moves in no answer: what it is, what holds it, and the force or torque at which a run lets
        it go.
    near : tuple of str
        What only just touches or is taut, or is about to: a small motion the other way finds another stiffness.
    """

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray
    E: np.ndarray
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    units: dict[str, str]
    time: float
    held: tuple[str, ...] = ()
    stuck: tuple[str, ...] = ()
    near: tuple[str, ...] = ()

    def to_scipy(self) -> Any:
        """A, B, C and D as `scipy.signal.StateSpace`; E has no place there."""
        from scipy.signal import StateSpace

        return StateSpace(self.A, self.B, self.C, self.D)

    @property
    def eigenvalues(self) -> np.ndarray:
        """Of A, 1/s."""
        return np.linalg.eigvals(self.A)

    def response(self, frequency: np.ndarray) -> np.ndarray:
        """Frequency response ``C (i w - A)^-1 B + D + i w E``, (frequencies, outputs, inputs).

        Parameters
        ----------
        frequency : float or float (k,)
            Hz.

        Raises
        ------
        SimulationError
            For what is no finite number or list of these, at a frequency at which the response is infinite: 0 Hz
            where an input is a speed, which goes on for ever, and at one so large that it is no finite number.
        """
        frequencies = _frequencies(frequency)
        found = [self._response(f) for f in frequencies]
        return np.array(found, dtype=complex).reshape(frequencies.size, *self.D.shape)

    def _response(self, frequency: float) -> np.ndarray:
        """Response at one frequency, Hz."""
        try:
            with np.errstate(all="ignore"):  # what is not finite is refused below
                s = 2.0j * np.pi * frequency
                found = self.C @ np.linalg.solve(s * np.eye(len(self.A)) - self.A, self.B) + self.D + s * self.E
        except np.linalg.LinAlgError:
            cause = f"the response at {frequency:g} Hz is infinite: an input that is a speed moves on for ever, or an "
            cause += "oscillation there has no damping"
            raise SimulationError(cause, "give another frequency") from None
        if not np.isfinite(found).all():
            cause = f"the response at {frequency:g} Hz is no finite number: what it is found from is too large for one"
            raise SimulationError(cause, "give a frequency nearer to those at which the scene moves")
        return np.asarray(found)


def _frequencies(given: Any) -> np.ndarray:
    """Frequencies as a vector, Hz; raises SimulationError."""
    cure = "give a finite number in Hz, or a list of these"
    try:
        found = np.atleast_1d(plain_numbers(np.asarray(given)))
    except (TypeError, ValueError):  # rows of different lengths
        raise SimulationError("what is given is no list of frequencies", cure) from None
    if found.dtype.kind not in "iuf" or found.ndim != 1 or not np.isfinite(found).all():
        raise SimulationError(f"{given!r} is no frequency and no list of frequencies", cure)
    return found.astype(float)
