"""Sweeps of wells: percentiles against a closed form, bars against single runs, where a bit sticks."""

from pathlib import Path

import numpy as np
import pytest
from scipy.stats import truncnorm

import tautline
from drillstring.statics.torque_drag import torque_drag
from drillstring.twin.sticking_limit import sticking_limit
from drillstring.twin.torsional_line import line_of
from tautline.sweeps.execution import Execution
from tautline.sweeps.table import RANKS

SPREAD = [0.28, 0.05, 0.1, 0.5]
"""Of friction: mean and deviation of the normal distribution, and its bounds."""

LOCKED = ("lock_ups", "locked", "lock_up")


@pytest.fixture
def slant(tmp_path):
    """A straight well at 45 deg, without steps of diameter."""
    (tmp_path / "survey.csv").write_text(
        "md [m],inc [deg],azi [deg]\n0,45,0\n500,45,0\n1000,45,0\n1500,45,0\n2000,45,0\n"
    )
    (tmp_path / "slant.yaml").write_text(
        """
title: Slant
well: {survey: survey.csv, diameter: 8.5 in, wall: {stiffness: 1.0e8, damping: 1.0e6, friction: 0.2}}
string: [{name: pipe, length: rest, od: 5 in, id: 4.276 in}]
material: {youngs_modulus: 206 GPa, shear_modulus: 79 GPa, density: 7850}
mud: {density: 1200}
top: {block: {constant: 0 m}, rotation: {constant: 0 rpm}}
model: {kind: lumped, elements: 20}
solver: {step: 5 ms, end: 1 s}
output: {interval: 0.1 s}
"""
    )
    return tmp_path / "slant.yaml"


def test_percentiles_of_the_hook_load_are_those_of_friction_in_closed_form(slant, tmp_path):
    """A straight string slides with w L (cos i + mu sin i); so do its percentiles."""
    samples = 20
    data = tautline.sweep(
        slant, {"well.wall.friction": {"truncated_normal": SPREAD}},
        plan={"latin_hypercube": {"samples": samples, "seed": 1}}, collect=["pick_up", "slack_off", "rotating"],
        verb="torque-drag", options={"depth": "1000:2000:1000"}, folder=tmp_path / "out", jobs=1,
    )  # fmt: skip
    assert set(data["status"].values.tolist()) == {"done"}, data["message"].values[0]
    # One sample is in each twentieth of the distribution: a percentile is within one twentieth of its rank.
    mean, sd, low, high = SPREAD
    quantile = truncnorm((low - mean) / sd, (high - mean) / sd, mean, sd).ppf
    ranks, friction = np.array(RANKS) / 100.0, np.percentile(data["well.wall.friction"].values, RANKS)
    assert np.all((quantile(ranks - 1.0 / samples) < friction) & (friction < quantile(ranks + 1.0 / samples)))
    # The load grows with friction, and so the percentiles of one are at those of the other, but for 20 lumps.
    still = data["rotating"].values.mean(axis=0)
    up, down = data["pick_up_percentiles"].values, data["slack_off_percentiles"].values[::-1]
    assert up / still - 1.0 == pytest.approx(np.tile(friction[:, None], 2), abs=0.005)
    assert 1.0 - down / still == pytest.approx(np.tile(friction[:, None], 2), abs=0.005)
    assert data["depth"].values.tolist() == [1000.0, 2000.0]
    table = (tmp_path / "out" / "percentiles.csv").read_text().splitlines()
    assert table[0] == "quantity,unit,along,at,P10,P50,P90,cases"
    row = next(line for line in table if line.startswith("pick_up,N,depth,2000"))
    assert [float(cell) for cell in row.split(",")[4:]] == pytest.approx([*up[:, 1].tolist(), float(samples)])


def test_a_tornado_of_numbers_along_depth_is_said_not_to_be_made(slant, tmp_path):
    from tautline.cli.commands.sweep import _left_out
    from tautline.sweeps.file import read_sweep
    from tautline.sweeps.sweep import run_sweep

    sweep = {"scene": "s", "verb": "torque-drag", "vary": {"well.wall.friction": [0.2, 0.4]}, "plan": "one_at_a_time"}
    read = read_sweep(sweep | {"collect": ["pick_up", "failures"], "options": {"depth": "1000,2000"}})
    scene = tautline.read(slant)
    outcome = run_sweep(read, tautline._installed().of(scene), scene, Execution(jobs=1, folder=tmp_path / "out"))
    assert _left_out(outcome) == ["pick_up: numbers along depth, of which no tornado is made; give one depth"]


def test_cases_in_which_the_string_locks_up_are_said_to_be_missing_from_percentiles(tmp_path):
    from tautline.cli.commands.sweep import _left_out
    from tautline.sweeps.file import read_sweep
    from tautline.sweeps.sweep import run_sweep

    scene = tautline.read(Path(__file__).parents[2] / "data" / "iscwsa.yaml")
    sweep = {"scene": "s", "verb": "torque-drag", "vary": {"well.wall.friction": {"uniform": [0.4, 0.7]}}}
    sweep |= {"plan": {"latin_hypercube": {"samples": 6, "seed": 1}}, "collect": ["slack_off", "pick_up", *LOCKED]}
    sweep |= {"options": {"elements": 12}}
    read = read_sweep(sweep)
    outcome = run_sweep(read, tautline._installed().of(scene), scene, Execution(jobs=1, folder=tmp_path / "out"))
    loads, locked = outcome.data["slack_off"].values, outcome.data["lock_ups"].values
    assert outcome.done == 6 and 0 < locked.sum() < 6
    assert (np.isnan(loads) == (locked == 1.0)).all()
    assert (outcome.data["locked"].values == ~(loads > 0.0)).all(), "by a helix, or for the friction of what lies flat"
    assert (np.isnan(loads) == (outcome.data["lock_up"].values > 0.0)).all()
    left = 6 - int(locked.sum())
    text, *_ = _left_out(outcome)
    assert text.startswith(f"slack_off: {6 - left} of 6 cases have no number; its percentiles are those of the others")
    rows = (tmp_path / "out" / "percentiles.csv").read_text().splitlines()[1:]
    counted = {row.split(",")[0]: int(row.split(",")[-1]) for row in rows}
    assert counted == {"slack_off": left, "pick_up": 6, "lock_ups": 6, "locked": 6, "lock_up": 6 - left}


def test_bars_of_what_matters_are_differences_of_single_runs():
    vary = {"well.wall.friction": {"normal": [0.25, 0.05]}, "mud.density": ["1150 kg/m^3", "1250 kg/m^3"]}
    data = tautline.sweep(
        "data/field_well.yaml", vary, plan="one_at_a_time", collect=["pick_up"], verb="torque-drag",
        options={"depth": "2000", "elements": 12},
    )  # fmt: skip
    scene = tautline.read("data/field_well.yaml")

    def alone(**changes):
        (case,) = torque_drag(scene.replace({k.replace("__", "."): v for k, v in changes.items()}), None, [2000.0], 12)
        return case.hook_loads("pick_up")[0]

    found = data["pick_up"].values
    tenth = 0.05 * 1.2815515655446004
    right = [
        alone(), alone(well__wall__friction=0.25 - tenth), alone(well__wall__friction=0.25 + tenth),
        alone(mud__density=1150.0), alone(mud__density=1250.0),
    ]  # fmt: skip
    assert found == pytest.approx(right, rel=1e-12)


def test_a_map_of_stick_slip_sticks_below_the_limit_in_closed_form_and_not_above_it():
    """Speeds at 0.6 and at 1.4 times the limit of harmonic balance, which runs hold to 7 % from above and below."""
    scene = tautline.read("data/drilling.yaml")
    limit = sticking_limit(scene, line_of(scene), 100e3, 10.0)
    speeds = [0.6 * limit.speed_needed, 1.4 * limit.speed_needed]
    data = tautline.sweep(
        "data/drilling.yaml",
        {"top.rotation.controller.speed": speeds, "bit.weight": ["100 kN", "60 kN"], "bit.torque.weight": ["100 kN"]},
        plan="grid", collect=["stick_slip_severity"], jobs=1,
    )  # fmt: skip
    severity = data["stick_slip_severity"].values[..., 0]
    assert severity[0, 0] > 1.0 > 0.1 > severity[1].max()
    # Less weight sticks less.
    assert severity[0, 1] < severity[0, 0]


def test_a_string_that_friction_holds_is_counted_as_locked_though_no_helix_locks_it(slant):
    """A straight string at 45 deg goes down by its weight where friction is less than 1/tan 45 deg, one."""
    data = tautline.sweep(
        slant, {"well.wall.friction": [0.3, 0.9, 1.1]}, plan="grid", collect=["slack_off", *LOCKED],
        verb="torque-drag", options={"elements": 12}, jobs=1,
    )  # fmt: skip
    assert data["locked"].values.tolist() == [0.0, 0.0, 1.0]
    assert (data["slack_off"].values > 0.0).tolist() == [True, True, False]
    assert data["lock_ups"].values.tolist() == [0.0] * 3 and np.isnan(data["lock_up"].values).all()
