"""What a scene asks to be kept in place of every frame, read by what its model stores."""

from __future__ import annotations

from typing import Any

from tautline.results.assessment.balance import ENERGIES
from tautline.scene.errors import SceneError
from tautline.scene.refusal import nearest
from tautline.statistics.store import Keep
from tautline.system.model import Model


def keep_of(model: Model, scene: Any) -> Keep:
    """The statistics that the ``output`` of a scene asks for.

    Variables that are watched where it names none are the application's; else those of one number a frame.

    Raises
    ------
    SceneError
        For the name of a variable that there is not.
    """
    output, own = scene.output, dict(model.statistics)
    known = {variable.name: variable for variable in model.variables}
    problems = [
        scene.problem(("output", "of", i), "is no variable of this scene's results", nearest(name, list(known)))
        for i, name in enumerate(output.of)
        if name not in known
    ]
    if problems:
        raise SceneError(problems)
    single = [name for name, one in known.items() if one.dims == ("time",) and name not in (*ENERGIES, "time")]
    watched = output.of or tuple(name for name in own.pop("watched", single) if name in known)
    fatigue = tuple(name for name in own.pop("fatigue", ()) if name in watched)
    own.pop("watched", None)
    if not set(own.pop("needs", ())) <= set(watched):
        own["of_turns"] = None
    return Keep(output.windows, output.block, output.begin, watched, fatigue, **own)
