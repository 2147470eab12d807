"""A file that grew after its twin was stopped: what is said of it in the end is what one twin says that was not."""

import json

import numpy as np
import pytest
from cli.in_process import commands_of

from crane.application import Crane
from tautline.results.result import Result

MAP = """
sensors:
  - {column: winch_pos, unit: m, input: winch.pay_out}
  - {column: heave, unit: m, input: vessel.heave}
  - {column: rope_tension, unit: kN, output: winch.tension, sd: 0.5 kN}
estimate:
  - {parameter: payload.mass, start: 7 t, sd: 2 t, range: [0.5 t, 20 t]}
ahead: 0 s
"""
CUTS = {"within a ramp of the winch": 22, "before any row was answered": 2}
"""Rows of the file when the twin ends for the first time."""


@pytest.fixture(scope="module")
def rows():
    """Lines of a file with a header: a winch that sets off after a second, at 10 Hz."""
    names = ("winch_pos", "heave", "rope_tension")
    found = ["time," + ",".join(names) + "\n"]
    for k in range(41):
        t = 0.1 * k
        ramp = max(0.0, t - 1.0)
        pay_out = -0.25 * ramp**2
        found.append(f"{t:.1f},{pay_out:.6f},{0.1 * np.sin(t):.6f},{49.05 + 2.0 * np.sin(5.0 * t):.4f}\n")
    return found


@pytest.fixture
def twin(tmp_path, capsys):
    """The command on the first lines of the file, as JSON by time; where told so, gone on with."""
    command = commands_of(Crane(), capsys)
    (tmp_path / "map.yaml").write_text(MAP)

    def run(lines, *more):
        (tmp_path / "r.csv").write_text("".join(lines))
        words = ["twin", "data/hoist.yaml", "--map", tmp_path / "map.yaml", "--source", tmp_path / "r.csv", "--json"]
        code, out, told = command(*words, *more)
        assert code == 0, told
        read = [json.loads(line) for line in out.splitlines()]
        return {line["time"]: line | {"lag": 0.0} for line in read if "estimates" in line}, told

    return run


@pytest.mark.parametrize("cut", CUTS.values(), ids=CUTS)
def test_a_twin_that_goes_on_in_a_file_that_grew_says_to_the_digit_what_one_says_that_was_not_stopped(
    twin, rows, tmp_path, cut
):
    whole, _ = twin(rows, "-o", tmp_path / "whole.nc")
    goes_on = ("--resume", tmp_path / "st", "-o", tmp_path / "parts.nc")
    first, _ = twin(rows[: 1 + cut], *goes_on)
    rest, told = twin(rows, *goes_on)
    assert len(first) == cut and first.keys() & rest.keys(), "the last rows are answered anew"
    assert "waited for others and are answered now" in " ".join(told.split())
    answered = {time: line for time, line in first.items() if time < min(rest)}
    assert answered | rest == whole
    parts, once = Result.read(tmp_path / "parts.nc"), Result.read(tmp_path / "whole.nc")
    for name in set(once.variables) - {"lag"}:
        assert np.array_equal(parts[name], once[name], equal_nan=once[name].dtype.kind == "f"), name
