"""The console script ``gardenhose``."""

from __future__ import annotations

import sys

from tautline.kernels.machine.gc_tuning import collected_rarely


def main() -> None:
    """Run the command of the process's arguments; leaves through SystemExit."""
    # What a command imports makes a hundred thousand objects, none of which is garbage.
    with collected_rarely():
        from gardenhose.application import Gardenhose
        from tautline.cli.run import run
        from tautline.cli.verbs import make_app

        run(make_app(Gardenhose(), sys.argv[1:]))


if __name__ == "__main__":
    main()
