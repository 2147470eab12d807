"""The console script ``tautline``: the same verbs for any scene of any installed application."""

from __future__ import annotations

from typing import Any

from tautline.cli.entry import command


def main() -> None:
    """Run the command of the process's arguments; leaves through SystemExit."""

    def made() -> Any:
        from tautline.application.installed import Installed

        return Installed()

    command(made)


if __name__ == "__main__":
    main()
