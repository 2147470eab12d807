"""The console script ``crane``."""

from __future__ import annotations

import sys

from crane.application import Crane
from tautline.cli.run import run
from tautline.cli.verbs import make_app


def main() -> None:
    """Run the command of the process's arguments; leaves through SystemExit."""
    run(make_app(Crane(), sys.argv[1:]))


if __name__ == "__main__":
    main()
