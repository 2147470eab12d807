"""Commands run in this process, as the console scripts do."""

import json
from pathlib import Path

import pytest
from figures.pages import FEW_DOTS
from matplotlib.figure import Figure

from tautline.cli.run import run
from tautline.cli.verbs import make_app


def commands_of(application, capsys):
    """A function that runs a command of an application: exit code, standard output, standard error.

    Pictures have few dots: that they are written is asked of a command, and more dots take longer.
    """

    def command(*arguments):
        words = [str(argument) for argument in arguments]
        with FEW_DOTS, pytest.raises(SystemExit) as left:
            run(make_app(application, words), words)
        captured = capsys.readouterr()
        return left.value.code or 0, captured.out, captured.err

    return command


def leave_out_pixels(monkeypatch):
    """PNG files of figures are named and empty: to draw one takes longer than most commands. Other files are whole."""
    drawn = Figure.savefig

    def savefig(figure, path):
        Path(path).touch() if Path(path).suffix == ".png" else drawn(figure, path)

    monkeypatch.setattr(Figure, "savefig", savefig)


def only_object(out):
    """The one JSON object of a command; NaN and infinity are none of JSON's."""
    return json.loads(out, parse_constant=lambda word: pytest.fail(f"{word} in JSON"))


def files(folder):
    """Contents of the files of a folder, by name."""
    return {file.name: file.read_bytes() for file in folder.iterdir()}
