"""Commands of an application, run in the process of the tests."""

import sys

import pytest

from tautline.cli.run import run as command_line
from tautline.cli.verbs import make_app


def command_of(application, monkeypatch, capsys):
    """A function that runs a command of an application: its exit code, and what it wrote to either stream."""

    def command(*arguments):
        monkeypatch.setattr(sys, "argv", [application.name, *arguments])
        with pytest.raises(SystemExit) as left:
            command_line(make_app(application, arguments))
        captured = capsys.readouterr()
        return left.value.code or 0, captured.out, captured.err

    return command
