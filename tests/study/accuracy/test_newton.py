"""Newton's iteration in full, as eq. 2.87 has it, beside the one that keeps old factors."""

import pytest
from study.oscillators import bar, subject

from tautline.study.accuracy.grid import settings
from tautline.study.accuracy.precision import Grid
from tautline.study.trials.trial import Setting

STRETCHED = bar(4, EA=10.0, start=0.1, time_step=0.02, time_end=2.0, eps_energy=1e-12)


@pytest.fixture(scope="module")
def runs():
    return {newton: subject(STRETCHED).run(Setting(newton=newton)) for newton in ("modified", "full")}


def test_full_newton_makes_a_tangent_in_every_iteration_and_the_modified_one_hardly_any(runs):
    full, modified = runs["full"], runs["modified"]
    assert full.attribute("factorisations") == full.attribute("newton_iterations") > full.attribute("steps")
    assert modified.attribute("factorisations") < 0.1 * modified.attribute("newton_iterations")


def test_full_newton_needs_fewer_iterations(runs):
    """Quadratic convergence with exact tangents: the strain of a tenth is far from linear."""
    assert runs["full"].attribute("newton_iterations") < 0.8 * runs["modified"].attribute("newton_iterations")


def test_both_iterations_solve_the_same_equations(runs):
    one, other = (runs[newton].result["position"] for newton in ("modified", "full"))
    assert other == pytest.approx(one, rel=0.0, abs=1e-9)


def test_full_newton_is_the_scene_s_choice_as_well():
    chosen = subject(STRETCHED.replace("rho_inf", "newton: full, rho_inf")).run(Setting())
    assert chosen.attribute("factorisations") == chosen.attribute("newton_iterations")


def test_a_study_runs_implicit_methods_both_ways_and_rk4_once():
    grid = Grid(("rk4", "newmark"), (0.01,), newton=("modified", "full"))
    found = settings(subject(STRETCHED), grid, 0.01, 1.0, False)
    assert [(each.method, each.newton) for each in found] == [
        ("rk4", None),
        ("newmark", "modified"),
        ("newmark", "full"),
    ]
    assert len({str(each) for each in found}) == 3
