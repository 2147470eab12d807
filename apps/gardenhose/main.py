"""The console script ``gardenhose``."""

from __future__ import annotations

from typing import Any

from tautline.cli.entry import command


def main() -> None:
    """Run the command of the process's arguments; leaves through SystemExit."""

    def made() -> Any:
        from gardenhose.application import Gardenhose

        return Gardenhose()

    command(made)


if __name__ == "__main__":
    main()
