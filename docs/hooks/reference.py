"""Pages of reference that nobody writes: keys from the schema, verbs from the command line, Python from `__all__`."""

from __future__ import annotations

import html
import re
import sys
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File

sys.path.insert(0, str(Path(__file__).parent))
from meanings import MEANINGS

COMMANDS = ("drillstring", "crane", "gardenhose", "tautline")
KINDS = ("constant", "ramp", "table", "harmonic", "chirp", "spectrum", "sum")


def on_files(files, config):
    """Add all of them."""
    from tautline.application.installed import Installed

    catalogue = Installed()
    for application in catalogue.all():
        page = f"reference/keys_{application.name}.md"
        files.append(File.generated(config, page, content=Keys(application).page()))
    by_name = {one.name: one for one in [*catalogue.all(), catalogue]}
    for name in COMMANDS:
        files.append(File.generated(config, f"reference/verbs_{name}.md", content=verbs(name, by_name[name])))
    files.append(File.generated(config, "reference/python_api.md", content=python_api()))
    return files


class Keys:
    """Every key of an application's scenes, part by part, from its JSON schema."""

    def __init__(self, application: Any) -> None:
        self.application = application
        self.schema = application.schema()
        self.parts: dict[str, Any] = self.schema.get("$defs", {})
        self.asked = [name for name in self.parts if not self._function(name)]

    def page(self) -> str:
        """The whole page."""
        name = self.application.name
        command = "tautline" if name == "cable" else name
        head = [
            f"# Keys of a scene: {name}",
            f"{self.application.title} Written from the schema, which `{command} schema` prints. Units are SI; any "
            "number may be a text with its unit, such as `5 in`. A key without a default must be given.",
            "## The scene",
            self._table(self.schema),
        ]
        for part in self.asked:
            head += [f"## {self._title(part)}", self._lead(self.parts[part]), self._table(self.parts[part])]
        if any(self._function(part) for part in self.parts):
            head += self._functions()
        return "\n\n".join(piece for piece in head if piece) + "\n"

    def _functions(self) -> list[str]:
        """Functions of time stand in the schema once for each unit: here once."""
        pieces = [
            "## Functions of time",
            "A key that is a function of time takes a number, for a constant, or one of "
            + ", ".join(f"`{kind}`" for kind in KINDS)
            + ". The unit of its values is that of the key; `sum` takes a list of the others.",
        ]
        for kind in ("Ramp", "Table", "Harmonic", "Chirp"):
            first = next((name for name in self.parts if re.search(rf"__{kind}(__\d+)?$", name)), None)
            first = first or (kind if kind in self.parts else None)
            if first is not None:
                part = self.parts[first]
                pieces += [f"### {kind.lower()}", self._lead(part), self._table(part, "that of the key")]
        spectrum = next((part for name, part in self.parts.items() if self._spectrum(name)), None)
        if spectrum is not None:
            table = re.sub(
                r"(`rao` \| )number, [^ ]*", r"\1number, that of the key a metre of wave", self._table(spectrum)
            )
            pieces += ["### spectrum", self._lead(spectrum), table]
        return pieces

    @staticmethod
    def _spectrum(name: str) -> bool:
        """Whether a part is a random sea, which stands in the schema once for each unit of its response."""
        return re.search(r"(^|__)Spectrum(__\d+)?$", name) is not None

    @staticmethod
    def _function(name: str) -> bool:
        return "__functions__" in name or name in ("Ramp", "Table", "Harmonic", "Chirp")

    def _title(self, name: str) -> str:
        return self.parts[name].get("title", name)

    @staticmethod
    def _lead(part: dict[str, Any]) -> str:
        """What the docstring says before its list of attributes."""
        return _plain(re.split(r"\nAttributes\n-+\n", part.get("description", ""))[0])

    def _table(self, part: dict[str, Any], unit: str | None = None) -> str:
        title = f"Scene.{self.application.name}" if part is self.schema else part.get("title", "")
        told = _attributes(part.get("description", ""))
        rows = ["| key | value | default | meaning |", "| --- | --- | --- | --- |"]
        for key, value in part.get("properties", {}).items():
            kind = self._kind(value)
            if unit is not None:
                kind = re.sub(r"\d.*?unless.*", unit, re.sub(r"number, (?!s\b|Hz\b|rad\b).*", f"number, {unit}", kind))
            needed = key in part.get("required", [])
            default = "" if needed else self._default(value)
            meaning = told.get(key) or told.get(key + "_") or value.get("quantity") or ""
            if not meaning:
                meaning = self._of_part(value) or _quantity(value)
            if not meaning:
                meaning = MEANINGS.get(f"{title}.{key}") or MEANINGS.get(key, "")
            rows.append(f"| `{key}` | {kind} | {default} | {_cell(meaning)} |")
        return "\n".join(rows) if len(rows) > 2 else ""

    def _of_part(self, value: dict[str, Any]) -> str:
        """The first sentence of the part that a key leads to, where it is one part."""
        inside = value.get("items", value)
        choices = [one for one in inside.get("anyOf", [inside]) if "$ref" in one]
        name = choices[0]["$ref"].rsplit("/", 1)[-1] if len(choices) == 1 else ""
        if not name or (self._function(name) and not self._spectrum(name)):
            return ""
        return re.split(r"(?<=[.:;])\s", " ".join(self._lead(self.parts[name]).split()))[0].rstrip(":;")

    @staticmethod
    def _default(value: dict[str, Any]) -> str:
        default = value.get("default")
        if default is None:
            return "none"
        text = str(default).lower() if isinstance(default, bool) else str(default)
        return f"`{text}`".replace("|", "\\|")

    def _kind(self, value: dict[str, Any]) -> str:
        """What may stand there, in words."""
        if "$ref" in value:
            name = value["$ref"].rsplit("/", 1)[-1]
            if self._spectrum(name):
                return "[spectrum](#spectrum)"
            if self._function(name):
                return "function of time"
            return f"[{self._title(name)}](#{self._title(name).lower()})"
        if "const" in value:
            return f"`{value['const']}`"
        if "enum" in value:
            return " or ".join(f"`{one}`" for one in value["enum"])
        choices = value.get("anyOf") or value.get("oneOf")
        if choices and (over_time := self._over_time(choices)):
            return over_time
        if choices:
            return self._choice(value, choices)
        if value.get("type") == "array":
            items = value.get("items") or value.get("prefixItems", [{}])[0]
            return f"list of: {self._kind(items)}"
        if value.get("type") == "object":
            return ", ".join(f"`{key}`: {self._kind(inner)}" for key, inner in value.get("properties", {}).items()) or (
                "keys and values"
            )
        word = {"string": "text", "integer": "whole number", "number": "number", "boolean": "`true` or `false`"}
        return word.get(value.get("type", ""), "any value") + _bounds(value)

    def _over_time(self, choices: list[dict[str, Any]]) -> str | None:
        """Whether these are the kinds of function of time, and the unit of their values."""
        found = [choice for choice in choices if "oneOf" in choice] + [{"oneOf": choices}]
        for choice in found:
            for one in choice["oneOf"]:
                if "constant" in one.get("properties", {}):
                    unit = _unit(one["properties"]["constant"])
                    return f"[function of time](#functions-of-time){', ' + unit if unit else ''}"
        return None

    def _choice(self, value: dict[str, Any], choices: list[dict[str, Any]]) -> str:
        unit = _unit(value)
        if any(choice.get("description") == "a number with its unit" for choice in choices) or unit:
            number = next((one for one in choices if one.get("type") == "number"), {})
            words = [f"`{one}`" for choice in choices for one in choice.get("enum", [])]
            text = "number" + (f", {unit}" if unit else "") + _bounds(number)
            return " or ".join([text, *words])
        kinds = []
        # Beside words other spellings of them are no other kind.
        words = any("enum" in choice for choice in choices)
        for choice in (choice for choice in choices if not (words and "pattern" in choice)):
            kind = None if choice.get("type") == "null" else self._kind(choice)
            if kind and kind not in kinds:
                kinds.append(kind)
        return " or ".join(kinds)


def _unit(value: dict[str, Any]) -> str | None:
    found = re.search(r"in (\S.*?) unless a unit", value.get("description", ""))
    return found[1].replace("|", "\\|") if found else None


def _quantity(value: Any) -> str:
    """The quantity that a schema names, however deep."""
    if isinstance(value, dict):
        if "quantity" in value:
            return str(value["quantity"])
        value = list(value.values())
    if isinstance(value, list):
        return next((found for inner in value if (found := _quantity(inner))), "")
    return ""


def _bounds(value: dict[str, Any]) -> str:
    words = {"exclusiveMinimum": "above", "minimum": "from", "exclusiveMaximum": "below", "maximum": "to"}
    said = [f"{word} {value[name]:g}" for name, word in words.items() if name in value]
    return f", {' '.join(said)}" if said else ""


def _attributes(text: str) -> dict[str, str]:
    """Names and meanings of the section Attributes of a docstring in NumPy's style."""
    parts = re.split(r"\nAttributes\n-+\n", text)
    told: dict[str, str] = {}
    for names, meaning in re.findall(r"^(\w.*)\n((?:    .*\n?)*)", parts[1], re.M) if len(parts) > 1 else []:
        meaning = " ".join(meaning.split())
        keys = [one.strip() for one in names.split(" : ")[0].split(",")]
        shares = meaning.split("; ")
        for k, key in enumerate(keys):
            told[key] = shares[k] if len(shares) == len(keys) else meaning
    return told


def _plain(text: str) -> str:
    return re.sub(r"``(.*?)``", r"`\1`", text).strip()


def _cell(text: str) -> str:
    return " ".join(_plain(text).split()).replace("|", "\\|").replace("<", "&lt;")


def verbs(name: str, catalogue: Any) -> str:
    """Every verb of a command with its arguments and options, from the command line itself."""
    import typer

    from tautline.cli.verbs import make_app

    command = typer.main.get_command(make_app(catalogue))
    pieces = [f"# `{name}`", catalogue.title, f"Written from the command line; `{name} VERB --help` shows the same."]
    for verb, one in sorted(command.commands.items()):
        arguments = [each for each in one.params if each.param_type_name == "argument"]
        options = [each for each in one.params if each.param_type_name == "option" and not each.hidden]
        usage = " ".join([name, verb, *(each.metavar or each.name.upper() for each in arguments), "[OPTIONS]"])
        pieces += [f"## {verb}", f"```text\n{usage}\n```", _markup(one.help or "")]
        rows = ["| option | meaning |", "| --- | --- |"]
        for each in [*arguments, *options]:
            names = each.metavar or each.name.upper()
            if each in options:
                given = "" if each.is_flag else f" {each.metavar or each.name.upper()}"
                names = ", ".join([*each.opts, *each.secondary_opts]) + given
            default = _default_of(each) if each in options else ""
            rows.append(f"| `{names}`".replace("|-", "\\|-") + f" | {_cell(_markup(each.help or ''))}{default} |")
        pieces.append("\n".join(_unsplit(row) for row in rows))
    return "\n\n".join(pieces) + "\n"


def _default_of(option: Any) -> str:
    value = option.default
    if option.is_flag or value is None or callable(value) or value in ((), [], ""):
        return ""
    return f" [default: {value}]"


def _unsplit(row: str) -> str:
    """A bar within a name does not end the cell."""
    if row.count("|") <= 3:
        return row
    return re.sub(r"`[^`]*`", _code, row)


def _code(found: re.Match[str]) -> str:
    """Code in a table: a bar in it would end the cell, and with a backslash before it both would be shown."""
    text = found[0].replace("\\|", "|")
    return f"<code>{html.escape(text.strip('`')).replace('|', '&#124;')}</code>" if "|" in text else text


def _markup(text: str) -> str:
    """Rich's marks for the terminal are left out."""
    return re.sub(r"(?<!\\)\[/?(dim|bold|italic)?\]", "", text).replace("\\[", "[")


def python_api() -> str:
    """The public names of `tautline`, each by its docstring."""
    import inspect

    import tautline

    groups: dict[str, list[str]] = {"Functions": [], "Classes": [], "Exceptions": []}
    for name in tautline.__all__:
        thing = getattr(tautline, name)
        if inspect.isclass(thing):
            groups["Exceptions" if issubclass(thing, BaseException) else "Classes"].append(name)
        elif callable(thing):
            groups["Functions"].append(name)
    pieces = [
        "# Python",
        "What a program needs to read, run, step and vary scenes stands in `tautline`; it is imported when it is "
        "asked for. "
        "How to use it is in [Change scenes from Python](../python.md) and [Step and drive a simulation]"
        "(../stepping.md). What an application and an extension may name is in [Add a force, a method, an "
        "application](../extending.md).",
    ]
    for heading, names in groups.items():
        pieces.append(f"## {heading}")
        for name in names:
            place = tautline._PLACES.get(name, "tautline")
            pieces.append(f"::: {place}.{name}")
    pieces += ["## Statistics of extremes", "::: tautline.statistics.gumbel", "::: tautline.statistics.peaks"]
    return "\n\n".join(pieces) + "\n"
