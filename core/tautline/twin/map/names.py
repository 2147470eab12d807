"""Names and units of a simulation, as a map refers to them."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

import pydantic

from tautline.live.simulation import Simulation
from tautline.system.handles import PART, Bounds
from tautline.twin.map.file import TwinMap, Watch


class Names(pydantic.BaseModel):
    """Names and units of a simulation: all that a map can refer to.

    Attributes
    ----------
    limits : tuple of Watch
        Limits that the scene gives itself, as far as a twin can watch them.
    unwatched : tuple of str
        Names of those that it cannot: of figures of a whole run, and of single numbers of an array.
    rivals : dict of str to list of str
        Inputs that drive the same as another one does, as a winch's place and its speed, by its name.
    judged_by : dict of str to (str, str)
        Outputs that are watched in place of others, above and below a bound, as the limits of a scene are judged.
    bounds : dict of str to Bounds
        What parameters may be, by their names.
    lacking : dict of str to str
        Parameters that the scene has not, and why.
    """

    inputs: dict[str, str]
    outputs: dict[str, str]
    shapes: dict[str, tuple[int, ...]]
    parameters: dict[str, str]
    limits: tuple[Watch, ...] = ()
    unwatched: tuple[str, ...] = ()
    rivals: dict[str, list[str]] = {}
    judged_by: dict[str, tuple[str, str]] = {}
    bounds: dict[str, Bounds] = {}
    lacking: dict[str, str] = {}

    def elements(self, read: TwinMap) -> dict[str, str]:
        """Units of the single numbers of arrays that a map names, such as ``tip.position[0]``, by name."""
        outputs = [*(one.output for one in read.sensors), *(one.output for one in read.watch), *read.keep]
        found = {}
        for name in outputs:
            parts = PART.fullmatch(name or "")
            shape = self.shapes.get(parts[1], ()) if parts else ()
            at = [int(place) for place in parts[2].split(",")] if parts else []
            if parts and len(at) == len(shape) and all(place < size for place, size in zip(at, shape, strict=True)):
                found[parts[0]] = self.outputs[parts[1]]
        return found


def watches_of(bounds: Sequence[Any], outputs: Collection[str]) -> tuple[list[Watch], list[str]]:
    """Limits of a scene as entries of ``watch``, and the names of those that no twin can watch.

    Parameters
    ----------
    bounds : sequence of tautline.results.assessment.bounds.Bound
    outputs : collection of str
        Names of what can be read while a simulation runs.
    """
    from tautline.results.assessment.limits import AT_MOST

    entries = [
        Watch.model_validate({
            "output": one.output, "above" if one.sense == AT_MOST else "below": one.limit, "for": one.lasting,
            "name": one.name,
        })
        for one in bounds if one.of_frames and one.output in outputs
    ]  # fmt: skip
    kept = {one.name for one in entries}
    return entries, [one.name for one in bounds if one.name not in kept]


def names_of(sim: Simulation) -> Names:
    """Names and units of what a simulation has."""

    def units(told: Mapping[str, Any]) -> dict[str, str]:
        return {name: one["unit"] for name, one in told.items()}

    outputs = sim.outputs.describe()
    limits, unwatched = watches_of(sim.model.bounds, outputs)
    return Names(
        limits=tuple(limits),
        unwatched=tuple(unwatched),
        inputs=units(sim.inputs.describe()),
        rivals={name: others for name in sim.inputs if (others := sim.inputs.rivals(name))},
        outputs=units(outputs),
        parameters=units(sim.parameters.describe()),
        shapes={name: tuple(one["shape"]) for name, one in outputs.items()},
        judged_by={name: one.judged_by for name, one in sim.outputs.handles.items() if all(one.judged_by)},
        bounds={name: sim.parameters.handle(name).bounds for name in sim.parameters},
        lacking=sim.parameters.lacking,
    )
