"""A sweep is the same one whether its file writes a default or leaves it out, and whoever goes on with it."""

import json

import pytest
from cli.in_process import commands_of
from sweep.short_hoist import MASS, write_sweep

import tautline
from crane.application import Crane
from tautline.sweeps.file import read_sweep

VARY = {MASS: [2000.0, 4000.0]}
TENSION = {"output": "winch.tension", "statistic": "max"}


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ({}, {"verb": "simulate", "plan": "grid", "collect": [], "options": {}}),
        ({"plan": "one_at_a_time"}, {"plan": "One at a time"}),
        ({"plan": {"latin_hypercube": {"samples": 4}}}, {"plan": {"latin_hypercube": {"seed": 0, "samples": 4}}}),
        ({"collect": "rise"}, {"collect": ["rise"]}),
        ({"collect": [{"output": "winch.tension"}]}, {"collect": [TENSION | {"name": "winch.tension max"}]}),
    ],
)
def test_what_two_sweeps_say_is_the_same_where_only_one_writes_a_default(one, other):
    said = [read_sweep({"scene": "scene", "vary": VARY} | each).said() for each in (one, other)]
    assert said[0] == said[1]


@pytest.mark.parametrize("other", [{"plan": "zip"}, {"verb": "static"}, {"collect": ["rise"]}, {"vary": {MASS: [1.0]}}])
def test_what_two_sweeps_say_differs_where_a_number_would(other):
    plain = {"scene": "scene", "vary": VARY}
    assert read_sweep(plain).said() != read_sweep(plain | other).said()


def test_what_the_command_began_goes_on_in_python_and_the_reverse(tmp_path, capsys):
    write_sweep(tmp_path, f"vary: {{'{MASS}': [2000.0, 4000.0]}}\ncollect: [rise]", "100 ms")
    file, command = tmp_path / "limits.yaml", commands_of(Crane(), capsys)
    scene = tmp_path / "hoist.yaml"

    def by_command(folder, *words):
        code, out, said = command("sweep", file, "-o", folder, "-q", "-j", "1", "--json", *words)
        assert code == 0, said
        return json.loads(out)

    def in_python(folder, resume):
        return tautline.sweep(scene, VARY, collect=["rise"], jobs=1, folder=folder, resume=resume)

    by_command(tmp_path / "one")
    assert (in_python(tmp_path / "one", True)["status"].values == "done").all()
    in_python(tmp_path / "two", False)
    assert by_command(tmp_path / "two", "--resume")["earlier"] == 2
