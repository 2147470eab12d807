"""Options that are numbers: nan and inf are bad input, and are said to be. A comparison with nan refuses nothing."""

from __future__ import annotations

from typing import get_args, get_type_hints

import pytest
import typer
from cli.in_process import commands_of

from crane.application import Crane
from drillstring.application import Drillstring
from gardenhose.application import Gardenhose
from tautline.cable.application import Cable
from tautline.cli.verbs import SHARED, make_app

APPLICATIONS = (Crane(), Drillstring(), Gardenhose(), Cable())


def float_options():
    """Application, verb, command and option, of all options that typer reads as a float; a shared verb once."""
    found = {}
    for application in APPLICATIONS:
        commands = typer.main.get_command(make_app(application)).commands
        for verb in (*SHARED, *getattr(application, "verbs", ())):
            for hint in get_type_hints(verb, include_extras=True).values():
                kind, *marks = get_args(hint) or (hint,)
                if float in (kind, *get_args(kind)) and marks:
                    name = verb.__name__.replace("_", "-")
                    option = (marks[0].param_decls or [marks[0].default])[0]
                    found.setdefault((name, option), (application, name, commands[name], option))
    return list(found.values())


def needed(command):
    """Something for each argument and option that a command cannot do without."""
    required = [one for one in command.params if one.required]
    options = [one for one in required if one.opts[0].startswith("-")]
    return ["some.yaml" for one in required if one not in options] + [
        word for one in options for word in (one.opts[0], "some")
    ]


@pytest.mark.parametrize("number", ["nan", "inf", "-inf"])
def test_a_number_of_an_option_that_is_not_finite_is_bad_input_of_every_command(number, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    known = float_options()
    assert {option for *_, option in known} >= {
        "--radius",
        "--exaggerate",
        "--rate",
        "--speed",
        "--budget",
        "--rho-inf",
    }
    for application, verb, command, option in known:
        if (option, number) == ("--budget", "inf"):
            continue  # as in Python, a run may take as long as it needs
        code, out, err = commands_of(application, capsys)(verb, *needed(command), option, number)
        told = " ".join(err.split())
        assert (code, out) == (2, ""), (verb, option, told)
        # Some versions of typer refuse nan and -inf by their own bounds.
        said = any(words in told for words in ("is not finite", "is not in the range", "must be at least"))
        assert option in told and said, (verb, option, told)
    assert not list(tmp_path.iterdir())
