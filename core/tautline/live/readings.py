"""Outputs and parameters of a simulation by name."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import replace
from typing import Any

import numpy as np

from tautline.integrators.time_loop import frames_of, new_frames
from tautline.live.errors import SimulationError, UnknownName, Unpickled, real, unknown
from tautline.live.turn import Turn
from tautline.system.handles import Handles, Output, Parameter, output_named, outputs_of
from tautline.system.model import Model

ROUNDING = 1e-12
"""Share by which two values that are equal may differ."""


def with_shapes(outputs: dict[str, Output], model: Model) -> dict[str, Output]:
    """Outputs of a model with the shapes that a frame shows, where its coordinates do not tell them.

    An application need not name the places of its variables: ``coordinates={}``.
    """
    if all(all(one.shape) for one in outputs.values()):
        return outputs
    frames = new_frames(1, model.system.q.size, model.own)
    frames.q[:], frames.v[:] = model.system.q, model.system.v
    with np.errstate(all="ignore"):  # forces and energies of this frame are none
        seen = model.observe(frames)
        return {
            name: one if all(one.shape) else replace(one, shape=np.shape(one.value(seen)))
            for name, one in outputs.items()
        }


def handles_of(model: Model) -> Handles:
    """What can be driven, read and changed of a model: what its application says, or its variables."""
    if model.handles is not None:
        handles = model.handles()
    else:
        handles = Handles(outputs=outputs_of(model.variables, model.coordinates))
    return replace(handles, outputs=with_shapes(handles.outputs, model))


def read_frames(model: Any, outputs: Mapping[str, Output], rows: np.ndarray, names: Sequence[str]) -> list[np.ndarray]:
    """Outputs of many frames of one model, observed together: what a call costs is paid once for all of them.

    Parameters
    ----------
    model : Model
    outputs : mapping of str to Output
    rows : (m, width) array
        Frames, as the loop leaves them.
    names : sequence of str

    Returns
    -------
    list of (m, ...) array
        For each name.
    """
    frames = frames_of(rows, model.system.q.size)
    vectors = {"q": frames.q, "v": frames.v}
    wanted = [output_named(outputs, name) or outputs[name] for name in names]
    needed = any(one.places is None for one in wanted)
    observed = model.seen(frames) if needed else {}
    found = []
    for one in wanted:
        if one.places is not None:
            found.append(vectors[one.places[0]][:, one.places[1]])
        else:
            found.append(one.one_by_one(observed, len(rows)))
    return found


class Outputs(Unpickled, Mapping[str, Any]):
    """What can be read of a simulation: ``sim.outputs["payload.position"]``, or ``sim["payload.position"]``.

    One number of an array is read by its place: ``sim["payload.position[2]"]``.

    Parameters
    ----------
    outputs : dict of str to Output
    observe : callable
        -> the variables of the frame that the simulation stands at.
    seen : callable
        -> the same where they were made already, else None.
    vectors : dict of str to array
        The state's full vectors ``q`` and ``v``.
    turn : Turn
        Taken where one is read.
    """

    def __init__(
        self,
        outputs: dict[str, Output],
        observe: Callable[[], Mapping[str, np.ndarray]],
        seen: Callable[[], Mapping[str, np.ndarray] | None],
        vectors: Mapping[str, np.ndarray],
        turn: Turn,
    ) -> None:
        self._outputs, self._observe, self._seen = outputs, observe, seen
        self._vectors, self._turn = vectors, turn

    def __iter__(self) -> Iterator[str]:
        return iter(self._outputs)

    def __len__(self) -> int:
        return len(self._outputs)

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and name in self._outputs

    @property
    def handles(self) -> Mapping[str, Output]:
        """All that is known of outputs, by name."""
        return self._outputs

    def handle(self, name: str) -> Output:
        """What is known of an output, or of one of its numbers: ``payload.position[2]``; raises UnknownName."""
        if not isinstance(name, str):  # a list is no name either
            raise unknown("output", name, self._outputs)
        try:
            found = output_named(self._outputs, name)
        except IndexError as error:
            raise UnknownName(f"there is no output '{name}'", str(error)) from None
        if found is None:
            raise unknown("output", name, self._outputs)
        return found

    def __getitem__(self, name: str) -> Any:
        """A float, or a copy of an array; raises UnknownName."""
        output = self.handle(name)
        turn = self._turn
        before = turn.version
        if not before & 1:
            # One copy of what has not changed meanwhile is of a whole state: it needs no lock.
            if output.places is not None:
                found = self._at(output)
                if turn.version == before:
                    return found
            elif (seen := self._seen()) is not None:
                found = _copied(output.value(seen))
                if turn.version == before:
                    return found
        turn.read()
        try:
            return self._at(output) if output.places is not None else _copied(output.value(self._observe()))
        finally:
            turn.lock.release()

    def _at(self, output: Output) -> Any:
        """An output that is a part of the state."""
        vector, places = output.places  # type: ignore[misc]
        return self._vectors[vector][places] if places.ndim else float(self._vectors[vector][places])

    def describe(self) -> dict[str, dict[str, Any]]:
        """Unit, shape and meaning of every output."""
        return {name: {"unit": o.unit, "shape": o.shape, "text": o.text} for name, o in self._outputs.items()}


def _copied(value: Any) -> Any:
    """A float, or an array of its own."""
    return np.array(value) if np.ndim(value) else float(value)


class Parameters(Unpickled, Mapping[str, Any]):
    """Numbers of the scene that can be changed: ``sim.parameters["payload.mass"] = 5200.0``.

    Parameters
    ----------
    parameters : dict of str to Parameter
    changes : callable
        Name -> what is entered while that parameter changes.
    lacking : mapping of str to str
        Parameters that the scene has not, and why.
    """

    def __init__(
        self,
        parameters: dict[str, Parameter],
        changes: Callable[[str], AbstractContextManager[None]],
        lacking: Mapping[str, str] | None = None,
    ) -> None:
        self._parameters, self._changes, self.lacking = parameters, changes, dict(lacking or {})
        self._pairs = [(name, one.not_below) for name, one in parameters.items() if one.not_below in parameters]
        self._anew = False

    def __iter__(self) -> Iterator[str]:
        return iter(self._parameters)

    def __len__(self) -> int:
        return len(self._parameters)

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and name in self._parameters

    def handle(self, name: str) -> Parameter:
        """What is known of a parameter; raises UnknownName."""
        try:
            return self._parameters[name]
        except (KeyError, TypeError):  # a list is no name either
            raise unknown("parameter", name, self._parameters, self.lacking.get(str(name), "")) from None

    def __getitem__(self, name: str) -> Any:
        """Its value; raises UnknownName."""
        return self.handle(name).get()

    def __setitem__(self, name: str, value: Any) -> None:
        """Change it, from the next step on.

        Raises
        ------
        UnknownName
            For a name that is none of the parameters.
        SimulationError
            For what is no number that it may have.
        """
        given = self.checked(name, value)
        with self._changes(name):
            self._parameters[name].set(given)
        self._anew = True

    def recalled(self) -> None:
        """Take note that a state has brought values, which may be such as a step refuses."""
        self._anew = True

    def check(self) -> None:
        """Refuse values that cannot be beside one another, once all are given; raises SimulationError."""
        if not self._anew:
            return
        for name, other in self._pairs:
            value, least = self[name], self[other]
            if value < least * (1.0 - ROUNDING):
                cause = f"{name} = {value:g} is less than {other} = {least:g}"
                raise SimulationError(cause, f"give a larger {name}, or a smaller {other}")
        self._anew = False

    def checked(self, name: str, value: Any) -> float:
        """What a parameter would become; it is not changed. Raises as changing it does."""
        parameter = self.handle(name)
        unit = parameter.unit or "no unit"
        try:
            # An array of one number stands for the number.
            given = real(value.item() if isinstance(value, np.ndarray) and value.size == 1 else value, "number", "")
        except SimulationError:
            raise SimulationError(f"{name} = {value!r} is no number", f"give one in SI ({unit})") from None
        if not parameter.bounds.hold(given):
            raise SimulationError(f"{name} = {given:g} cannot be", f"give {parameter.bounds.told(parameter.unit)}")
        return given

    def describe(self) -> dict[str, dict[str, Any]]:
        """Unit, shape and meaning of every parameter."""
        return {name: {"unit": p.unit, "shape": (), "text": p.text} for name, p in self._parameters.items()}
