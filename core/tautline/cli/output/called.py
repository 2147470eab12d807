"""How a person calls the command of this process: what it prints as the next command has to run as it stands."""

from __future__ import annotations

import os
import shlex
import sys

from tautline.application.installed import has_command

_script = ""


def begin(of_process: bool, name: str) -> None:
    """Look how the process was started, where it serves this command only; else the command goes by its name."""
    global _script
    script = sys.argv[0] if of_process and sys.argv else ""
    # With `python -m` the first argument is a file too, which is not what was written; an installed name is shorter.
    by_file = script.endswith(".py") and getattr(sys.modules.get("__main__"), "__spec__", None) is None
    _script = script if by_file and not has_command(name) else ""


def typed(name: str, *words: object) -> str:
    """A command line that runs as it stands: blanks in names of files are quoted."""
    return " ".join((called(name), *(quoted(str(word)) for word in words)))


def quoted(word: str) -> str:
    """A word for a shell; one of bytes that are no UTF-8, as a name of a file may be, as bash and zsh read it."""
    if word.isascii() or word == os.fsencode(word).decode(errors="ignore"):
        return shlex.quote(word)
    letters = (f"\\x{one:02x}" if one > 126 or one < 32 or one in b"'\\" else chr(one) for one in os.fsencode(word))
    return f"$'{''.join(letters)}'"


def called(name: str) -> str:
    """The words for a shell: ``python script.py`` for a command that is a script, else its name."""
    return f"python {quoted(_script)}" if _script else name
