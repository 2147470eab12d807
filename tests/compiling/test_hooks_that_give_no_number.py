"""Hooks of others that give nan: what they spoil is told with their name, be it the motion or the energy alone."""

import os
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

import tautline
from tautline.cable.input.scene import parse
from tautline.cable.model.build import build
from tautline.integrators.status import Status, StoppedEarly
from tautline.kernels import groups
from tautline.kernels.dofs import add_entry
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel
from tautline.results.naming import shortfall
from tautline.simulation import simulate

pytestmark = pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="is about what is compiled")

LAMP = """
title: A lamp on a spring
CableModelMaterial: {{Gravity: [0, 0, 0]}}
CableModel:
  - Node4Dof: {{id: 0, xyz: [0, 0, 0], BC: [1, 1, 1, 1]}}
  - Node4Dof: {{id: 1, xyz: [1, 0, 0], BC: [0, 1, 1, 1]}}
  - CableALEelementLin: {{id: 0, nodes4: [0, 1], EA: 100, rhoA: 0, strain: engineering}}
  - PointMass: {{id: 0, nodes4: [1], mass: 1}}
{solver}
"""
IMPLICIT = "GeneralizedAlpha: {type: G-alpha, rho_inf: 0.8, time_step: 0.01, time_end: 0.1}"
EXPLICIT = "GeneralizedAlpha: {type: RK4, time_step: 0.01, time_end: 0.1}"
X = 4
"""The place of the lamp's x."""
RESIDUAL, TANGENT, ENERGY, SUPPLY, DISSIPATION, NOWHERE = range(6)


class Spoiling(NamedTuple):
    """A constant push, N, and a negative damper, N s^3/m^3; hook number ``where`` gives nan from ``since`` s on."""

    push: float
    gain: float
    where: int
    since: float


@kernel
def spoiled(g, where, t):
    return np.nan if where == g.where and t > g.since else 0.0


@kernel
def residual(g, t, q, v, a, r):
    r[X] -= g.push + g.gain * v[X] * v[X] * v[X] + spoiled(g, RESIDUAL, t)


@kernel
def tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    add_entry(matrix, dofs, X, X, spoiled(g, TANGENT, t))


@kernel
def energy(g, t, q, v, e):
    e[2] += spoiled(g, ENERGY, t)


@kernel
def supply(g, t, q, v, p):
    p[0] += (g.push + g.gain * v[X] * v[X] * v[X]) * v[X] + spoiled(g, SUPPLY, t)


@kernel
def dissipation(g, t, q, v, p):
    p[0] += spoiled(g, DISSIPATION, t)


HOOKS = {"residual": residual, "tangent": tangent, "energy": energy, "supply": supply, "dissipation": dissipation}


@pytest.fixture(autouse=True)
def _spoiling_is_known():
    register(Spoiling, **HOOKS)
    yield
    groups.KINDS.pop(Spoiling, None)
    groups._forget(Spoiling)


def run(where, since=0.042, gain=0.0, solver=IMPLICIT):
    model = build(parse(LAMP.format(solver=solver)))
    further = Spoiling(1.0, gain, where, since)
    return simulate(replace(model, system=replace(model.system, groups=(*model.system.groups, further), linked={})))


@pytest.mark.parametrize(
    ("where", "hook", "column"),
    [
        (ENERGY, "energy", "potential_energy"),
        (SUPPLY, "supply", "external_work"),
        (DISSIPATION, "dissipation", "dissipated_energy"),
    ],
)
def test_an_energy_that_has_no_value_is_no_energy_that_balances(where, hook, column):
    # every comparison with nan is false: nothing was "created", and the run was "done" without a word
    with pytest.raises(StoppedEarly) as stop:
        run(where)
    result = stop.value.result
    assert stop.value.status == Status.NO_BALANCE and result.attributes["status"] == "no balance"
    assert f"hook '{hook}' of kind Spoiling ({__name__}.{hook})" in stop.value.sentence
    assert f"{column} is no finite number from 0.05 s on" in stop.value.sentence
    assert any(f"hook '{hook}'" in warning for warning in result.attributes["warnings"])
    assert shortfall(result) == "the energy of the run has no value"
    # 1 kg on 100 N/m that 1 N pushes: x = 1 + 0.01 (1 - cos 10 t), and all of it is there
    assert result["position"][-1, 1, 0] == pytest.approx(1.0 + 0.01 * (1.0 - np.cos(1.0)), rel=1e-4)


def test_an_energy_without_value_is_told_without_a_word_of_numpy(recwarn):
    with pytest.raises(StoppedEarly):
        run(SUPPLY)
    assert not [one for one in recwarn if issubclass(one.category, RuntimeWarning)]


@pytest.mark.parametrize("solver", [IMPLICIT, EXPLICIT])
@pytest.mark.parametrize("since", [-1.0, 0.042])
def test_a_force_of_an_extension_that_has_no_value_is_no_motion_that_overflows(since, solver):
    with pytest.raises(StoppedEarly) as stop:
        run(RESIDUAL, since, solver=solver)
    assert stop.value.status == Status.NO_FORCE and stop.value.part == "kind Spoiling"
    assert f"hook 'residual' of kind Spoiling ({__name__}.residual)" in stop.value.sentence
    assert "overflowed" not in stop.value.sentence
    if since < 0.0:
        # an explicit method left a frame of zeros behind that it had never filled
        assert stop.value.result is None


def test_a_tangent_of_an_extension_that_has_no_value_is_named():
    with pytest.raises(StoppedEarly, match=r"NO_FORCE.*hook 'tangent' of kind Spoiling"):
        run(TANGENT, -1.0)


def test_an_energy_of_an_extension_that_has_no_value_at_the_start_is_named():
    with pytest.raises(StoppedEarly, match=r"NO_FORCE at t = 0 s, the state at the start.*hook 'energy' of kind Spo"):
        run(ENERGY, -1.0)


def test_a_motion_that_does_overflow_is_not_laid_to_an_extension():
    # v' = 1e6 v^3 is infinite in a finite time, and the force is a number at all numbers before
    with pytest.raises(StoppedEarly) as stop:
        run(NOWHERE, gain=1.0e6, solver=EXPLICIT)
    assert stop.value.status in (Status.NOT_FINITE, Status.UNSTABLE)


def test_a_group_without_value_that_was_added_to_a_simulation_is_named():
    sim = tautline.Simulation(parse(LAMP.format(solver=IMPLICIT)))
    sim.add_force(Spoiling(1.0, 0.0, RESIDUAL, 0.042))
    with pytest.raises(StoppedEarly, match=r"NO_FORCE.*hook 'residual' of kind Spoiling"):
        sim.advance_to(0.1)
    assert sim.result.attributes["status"] == "no force"
