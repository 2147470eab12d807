"""The console script ``crane``."""

from __future__ import annotations

from typing import Any

from tautline.cli.entry import command


def main() -> None:
    """Run the command of the process's arguments; leaves through SystemExit."""

    def made() -> Any:
        from crane.application import Crane

        return Crane()

    command(made)


if __name__ == "__main__":
    main()
