"""The console script ``tautline``: the same verbs for any scene of any installed application."""

from __future__ import annotations

import sys

from tautline.application.installed import Installed
from tautline.cli.run import run
from tautline.cli.verbs import make_app


def main() -> None:
    """Run the command of the process's arguments; leaves through SystemExit."""
    run(make_app(Installed(), sys.argv[1:]))


if __name__ == "__main__":
    main()
