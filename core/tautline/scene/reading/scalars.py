"""How a plain scalar is told from a text, by the core schema of YAML 1.2, and plain values written so that it holds."""

from __future__ import annotations

import re
from typing import Any

import yaml

NULL = re.compile(r"|~|null|Null|NULL")
BOOLEAN = re.compile(r"true|True|TRUE|false|False|FALSE")
INTEGER = re.compile(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+")
FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
NOT_FINITE = re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")
NO_TEXT = re.compile("|".join(f"(?:{kind.pattern})" for kind in (NULL, BOOLEAN, INTEGER, FLOAT, NOT_FINITE)))
"""What a plain scalar is that is read as something else than a text."""
LONGEST_INTEGER = 300
WIDEST = 110
"""Letters of a line, about."""


def written_out(root: Any) -> str:
    """YAML of plain values, which `tautline.scene.reading.document` reads as the same values."""
    return yaml.dump(
        root, Dumper=_Dumper, sort_keys=False, allow_unicode=True, default_flow_style=None, width=WIDEST
    )  # fmt: skip


class _Dumper(getattr(yaml, "CSafeDumper", yaml.SafeDumper)):  # type: ignore[misc]
    """Writes values out each time they stand, and texts in quotes where they would be read as something else."""

    def ignore_aliases(self, data: Any) -> bool:
        """Whatever stands twice is written twice."""
        return True


def _text(dumper: Any, text: str) -> Any:
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style='"' if NO_TEXT.fullmatch(text) else None)


_Dumper.add_representer(str, _text)
