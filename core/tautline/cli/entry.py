"""What a console script runs: from its first import on, Ctrl-C ends it with a word and a code and no traceback.

Nothing but what comes with the interpreter is imported here before somebody listens.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, NoReturn

if TYPE_CHECKING:
    from tautline.application.installed import Catalogue
    from tautline.application.protocol import Application

CODE = 130
"""What the process exits with, as `tautline.cli.run.ExitCode.INTERRUPTED`, which is not imported yet."""


def command(make: Callable[[], Application | Catalogue]) -> NoReturn:
    """Run the command of the process's arguments.

    Parameters
    ----------
    make : callable
        Imports and makes the application, or the catalogue of them.

    Raises
    ------
    SystemExit
        Always.
    """
    with interrupted_while_it_starts():
        from tautline.kernels.machine.gc_tuning import collected_rarely

        # What a command imports makes a hundred thousand objects, none of which is garbage.
        with collected_rarely():
            from tautline.cli.run import run
            from tautline.cli.verbs import make_app

            run(make_app(make(), sys.argv[1:]))


@contextmanager
def interrupted_while_it_starts() -> Iterator[None]:
    """Say that Ctrl-C was heard where `tautline.cli.run.run` does not do so yet; raises SystemExit then.

    It imports nothing: what was interrupted may be half imported.
    """
    try:
        yield
    except KeyboardInterrupt:
        _say(sys.stderr, "\ninterrupted\n")
        if "--json" in sys.argv:
            _say(sys.stdout, '{"status": "interrupted"}\n')
        # Not from the interruption, of which Python would say more.
        raise SystemExit(CODE) from None


def _say(stream: Any, text: str) -> None:
    """Write to a stream that may be closed."""
    try:
        stream.write(text)
        stream.flush()
    except (AttributeError, OSError, ValueError):
        return
