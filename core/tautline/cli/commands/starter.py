"""The verbs ``new`` and ``schema``: where to begin."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tautline.application.installed import Catalogue
from tautline.cli.output.called import typed
from tautline.cli.output.console import print_text, say
from tautline.scene.errors import Problem, SceneError
from tautline.whole_file import whole_file

SCHEMA = frozenset({"$schema", "$defs", "properties"})
"""Keys by one of which a JSON schema is known."""
DEFINITIONS = "#/$defs/"
"""Where a JSON schema refers to its definitions."""


def _refuse(where: str, cause: str, cure: str) -> SceneError:
    return SceneError([Problem(where, None, "", None, cause, cure)])


def new(catalogue: Catalogue, template: str | None, output: Path | None, listed: bool, force: bool) -> None:
    """Write a commented starter scene, or list those there are.

    Raises
    ------
    SceneError
        If the template is unknown, the file exists and `force` is false, or it cannot be written; also for what says
        which file is written, beside a list.
    """
    templates = {name: text for application in catalogue.all() for name, text in application.templates.items()}
    if listed:
        for option, given in (("TEMPLATE", template), ("-o", output), ("--force", force or None)):
            if given is not None:
                raise _refuse(option, "has no effect beside --list, which writes nothing", "leave one of them out")
        for name, text in templates.items():
            print_text(f"{name:<20} {_first_comment(text)}".rstrip() + "\n")
        return
    if not templates:
        raise _refuse("new", "there are no templates", "write a scene by hand; `schema` says what it may hold")
    name = next(iter(templates)) if template is None else template
    if name not in templates:
        raise _refuse("new", f"there is no template '{name}'", f"known: {', '.join(templates)}")
    if output is not None and str(output) == "-":
        print_text(templates[name])
        return
    path = Path(f"{name}.yaml") if output is None else output
    write(path, templates[name], force)
    say(f"wrote {path}. Next: {typed(catalogue.name, 'simulate', path)}", "green")


def schema(catalogue: Catalogue, output: Path | None) -> None:
    """Print the JSON schema of a scene; of several applications, one of a scene of any of them."""
    schemas: dict[str, Any] = {application.name: application.schema() for application in catalogue.all()}
    text = json.dumps(next(iter(schemas.values())) if len(schemas) == 1 else of_any(schemas), indent=2) + "\n"
    if output is None or str(output) == "-":
        print_text(text)
        return
    # A schema is made anew with every version: an earlier one is simply replaced, anything else is not.
    earlier = _is_schema(output)
    if output.is_file() and not earlier:
        raise _refuse(str(output), "exists and is no schema: it would be lost", "name another with -o")
    write(output, text, force=earlier)
    say(f"wrote {output}", "green")


def of_any(schemas: Mapping[str, Any]) -> dict[str, Any]:
    """One schema of what any of some by name allows; each is a definition, with those of its own below it."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "anyOf": [{"$ref": f"{DEFINITIONS}{name}"} for name in schemas],
        "$defs": {name: _below(schema, f"{DEFINITIONS}{name}/$defs/") for name, schema in schemas.items()},
    }


def _below(part: Any, place: str) -> Any:
    """A part of a schema whose definitions stand at another place."""
    if isinstance(part, dict):
        return {key: _below(value, place) for key, value in part.items()}
    if isinstance(part, list):
        return [_below(value, place) for value in part]
    refers = isinstance(part, str) and part.startswith(DEFINITIONS)
    return part.replace(DEFINITIONS, place, 1) if refers else part


def _is_schema(path: Path) -> bool:
    """Whether a file is a JSON schema, or an object of some by name."""
    try:
        found = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else None
    except (OSError, ValueError):
        return False
    parts = [found, *found.values()] if isinstance(found, dict) else []
    return any(isinstance(part, dict) and not SCHEMA.isdisjoint(part) for part in parts)


def write(path: Path, text: str, force: bool) -> None:
    """Write a text file.

    Raises
    ------
    SceneError
        If the file exists and `force` is false, or it cannot be written.
    """
    try:
        if path.is_dir():
            raise _refuse(str(path), "is a folder", f"name a file in it: -o {path / 'scene.yaml'}")
        if path.exists() and not force:
            raise FileExistsError
        with whole_file(path) as waiting:
            waiting.write_text(text, encoding="utf-8")
    except FileExistsError:
        raise _refuse(str(path), "exists", "name another with -o, or overwrite it with --force") from None
    except FileNotFoundError:
        raise _refuse(str(path), f"there is no folder {path.parent}", "make it, or name another with -o") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise _refuse(str(path), f"cannot be written: {reason}", "name another with -o") from None


def _first_comment(text: str) -> str:
    """Take the first line of a scene as what it is about."""
    first = text.lstrip().partition("\n")[0]
    return first.lstrip("# ").strip() if first.startswith("#") else ""
