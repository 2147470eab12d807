"""What was read from a scene stays as it is: other values are had from `replace`."""

from __future__ import annotations

from typing import Any

import pydantic

from tautline.scene.errors import Problem, SceneError


class Frozen(pydantic.BaseModel):
    """A model of which no field can be set; whoever tries is told what to do in its place."""

    def __setattr__(self, name: str, value: Any) -> None:
        """Set what is private; raises SceneError for a field."""
        field = type(self).model_fields.get(name)
        if field is not None:
            cure = "make another scene: scene.replace({key: value}) with the key of the file, such as 'solver.step'"
            what = Problem("scene", None, field.alias or name, repr(value), "a scene cannot be changed", cure)
            raise SceneError([what])
        super().__setattr__(name, value)
