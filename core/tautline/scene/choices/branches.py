"""Branches of a key: the ways in which its value may be written, each a mapping of a single key."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from tautline.scene.model import MARK, Model
from tautline.scene.reading.slips import decimal_comma, run_together
from tautline.scene.refusal import nearest, nearest_key, refusal


class Branch:
    """One way to write a value: its type, what to make of it (by default, the value itself), and an example.

    `without` says where else to write what people give it as a key, where its value has none.
    """

    def __init__(
        self, kind: Any, make: Callable[[Any], Any] | None = None, example: str = "", without: str = ""
    ) -> None:
        self.kind, self.make, self.example, self.without = kind, make, example, without

    @property
    def has_keys(self) -> bool:
        """Whether its value is a mapping of keys, not a number or a list."""
        return isinstance(self.kind, type) and issubclass(self.kind, Model)

    def schema(self, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Schema of the value, made into what it stands for."""
        schema = handler.generate_schema(self.kind)
        return core_schema.no_info_after_validator_function(self.make, schema) if self.make else schema


class OneOf:
    """Annotation of a value that can be written in several ways, each a mapping of a single key.

    ``{ramp: {to: 2.0, over: 1.0}}`` goes to the branch `ramp`, and errors are those of that branch alone.

    Parameters
    ----------
    what : str
        What is to be given, for messages: ``a function of time``.
    keyed : dict
        Key -> `Branch`.
    plain : Branch, optional
        For anything that is not a mapping: a bare number, a word.
    whole : Branch, optional
        For a mapping whose keys are none of `keyed`.
    example : str
        How it can be written.
    """

    def __init__(
        self,
        what: str,
        keyed: dict[str, Branch],
        plain: Branch | None = None,
        whole: Branch | None = None,
        example: str = "",
    ) -> None:
        self.what, self.keyed, self.plain, self.whole = what, keyed, plain, whole
        self.example = example or f"{{{next(iter(keyed), what)}: ...}}"

    def select(self, value: Any) -> str:
        """Tag of the branch that a value goes to.

        Raises
        ------
        PydanticCustomError, ValidationError
            If it is none of them, or more than one.
        """
        cure = f"give {self.what} such as {self.example}"
        if not isinstance(value, dict):
            if self.plain is None or value is None:
                raise refusal("is empty" if value is None else f"is not {self.what}", cure)
            return f"{MARK}plain"
        chosen = [key for key in value if key in self.keyed]
        if len(value) == 1 and chosen:
            return f"{MARK}{chosen[0]}"
        if self.whole is not None and not chosen:
            return f"{MARK}whole"
        if len(chosen) > 1:
            raise refusal(f"gives both {chosen[0]} and {chosen[1]}", f"keep one: {cure}")
        if chosen:
            odd = next(key for key in value if key not in self.keyed)
            comma, _ = decimal_comma(value, str(odd))
            if comma:
                raise refusal(f"'{odd}' stands beside {chosen[0]}", comma)
            meant = nearest(str(odd), chosen) if str(odd).lower() != chosen[0] else ""
            cure = meant if meant.startswith("did") else self._inside(chosen[0])
            raise refusal(f"'{odd}' stands beside {chosen[0]}", cure)
        if not value:
            raise refusal("is an empty mapping", cure)
        odd = next(iter(value))
        run_in = run_together(list(self.keyed), value, str(odd))[1]
        raise refusal(f"unknown key '{odd}'", run_in or nearest_key(str(odd), self.keyed))

    def _inside(self, chosen: str) -> str:
        """What to do with a key that stands beside the chosen one."""
        branch = self.keyed[chosen]
        if not branch.has_keys:
            return f"remove it, because {chosen} has no keys" + (f": {branch.without}" if branch.without else "")
        if branch.example:
            return f"{chosen} holds its keys in braces: write {chosen}: {branch.example}"
        return f"make it a key of {chosen}, or remove it"

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        choices: dict[Any, CoreSchema] = {}
        for key, branch in self.keyed.items():
            only = {key: core_schema.typed_dict_field(branch.schema(handler), required=True)}
            mapping = core_schema.typed_dict_schema(only, extra_behavior="forbid")
            choices[f"{MARK}{key}"] = core_schema.no_info_after_validator_function(_Content(key), mapping)
        if self.plain:
            choices[f"{MARK}plain"] = self.plain.schema(handler)
        if self.whole:
            choices[f"{MARK}whole"] = self.whole.schema(handler)
        union = core_schema.tagged_union_schema(choices, discriminator=self.select)

        def enter(value: Any, inner: core_schema.ValidatorFunctionWrapHandler) -> Any:
            return value if isinstance(value, Model) else inner(value)

        def dump(value: Any) -> Any:
            return value.model_dump() if isinstance(value, Model) else value

        plain = core_schema.plain_serializer_function_ser_schema(dump)
        return core_schema.no_info_wrap_validator_function(enter, union, serialization=plain)


class _Content:
    """Takes the value out of its one-key mapping."""

    def __init__(self, key: str) -> None:
        self.key = key

    def __call__(self, mapping: dict[str, Any]) -> Any:
        return mapping[self.key]
