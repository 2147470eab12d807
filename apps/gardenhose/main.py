"""The console script ``gardenhose``."""

from __future__ import annotations

import sys

from gardenhose.application import Gardenhose
from tautline.cli.run import run
from tautline.cli.verbs import make_app


def main() -> None:
    """Run the command of the process's arguments; leaves through SystemExit."""
    run(make_app(Gardenhose(), sys.argv[1:]))


if __name__ == "__main__":
    main()
