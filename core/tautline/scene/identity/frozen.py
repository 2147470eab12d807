"""What was read from a scene stays as it is: other values are had from `replace`."""

from __future__ import annotations

from typing import Any, NoReturn, TypeVar

import pydantic

from tautline.scene.errors import Problem, SceneError

Class = TypeVar("Class")


class Frozen(pydantic.BaseModel):
    """A model of which only what is private can be set, and nothing deleted; who tries is told what to do instead."""

    def __setattr__(self, name: str, value: Any) -> None:
        """Set what is private; raises SceneError for anything else."""
        if not name.startswith("_"):
            _refuse(_key(type(self), name), repr(value))
        super().__setattr__(name, value)

    def __delattr__(self, name: str) -> NoReturn:
        """Refuse with a SceneError."""
        _refuse(_key(type(self), name), None)


def says_what_to_do(cls: type[Class]) -> type[Class]:
    """Have a frozen dataclass refuse changes as `Frozen` does; it stands above ``@dataclass``, which has its own."""

    def refuse_to_set(_: Class, name: str, value: Any) -> NoReturn:
        _refuse(name, repr(value))

    def refuse_to_delete(_: Class, name: str) -> NoReturn:
        _refuse(name, None)

    # mypy takes methods that are assigned for faults.
    for name, method in (("__setattr__", refuse_to_set), ("__delattr__", refuse_to_delete)):
        setattr(cls, name, method)
    return cls


def _key(model: type[Frozen], name: str) -> str:
    """The key of the file for a field; another name as it is."""
    field = model.model_fields.get(name)
    return name if field is None else field.alias or name


def _refuse(key: str, value: str | None) -> NoReturn:
    cure = "make another scene: scene.replace({key: value}), with key and value as you would write them in its file"
    raise SceneError([Problem("scene", None, key, value, "a scene cannot be changed", cure)])
