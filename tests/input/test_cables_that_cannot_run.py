"""Cable scenes that are refused, or warned of, for what no run can be right of, and that their cures work."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import fsolve

import tautline
from tautline.application.installed import Installed
from tautline.cable.model.build import build
from tautline.scene.errors import SceneError

HELD, FREE = [1, 1, 1, 0, 0, 0, 1], [0, 0, 0, 0, 0, 0, 1]
CORNERS = np.array([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [4.0, 8.0, 1.0]])
STIFFNESS, LOAD, MIDDLE = np.array([1e4, 2e4, 3e4]), np.array([5.0, -20.0, -300.0]), [4.0, 3.0, -3.0]


def node(number, place, held=FREE, slope=None):
    return {"Node7Dof": {"id": number, "xyz": list(place), "BC": held} | ({"xyz_d": slope} if slope else {})}


def element(number, ends, **more):
    return {"CableALEelement": {"id": number, "nodes7": list(ends), "EA": 1000.0, "EJ": 0.5, "rhoA": 1.0} | more}


def scene(*items, **solver):
    chosen = {"type": "G-alpha", "rho_inf": 0.8, "time_step": 0.001, "time_end": 0.001}
    return {
        "CableModelMaterial": {"Gravity": [0, 0, 0]},
        "CableModel": list(items),
        "GeneralizedAlpha": chosen | solver,
    }


def refused(items):
    with pytest.raises(SceneError) as raised:
        build(tautline.read(scene(*items)))
    return raised.value.problems


def three_ropes(own):
    """Three ropes of four elements from a point that a force pulls to three that are held."""
    ends = [3, *([4, 5] if own else [3, 3])]
    nodes = [node(i, place, HELD) for i, place in enumerate(CORNERS)]
    nodes += [node(i, MIDDLE) for i in dict.fromkeys(ends)]
    ropes = [
        {"CableLine": {"id": 10 * i, "nodes7": [i, ends[i]], "elements": 4, "EA": EA, "rhoA": 0.1}}
        for i, EA in enumerate(STIFFNESS.tolist())
    ]
    ties = [{"LagMultipl7": {"id": k, "nodes7": [k, 3], "constr": 0}} for k in (4, 5)] if own else []
    return [*nodes, *ropes, *ties, {"PointForce": {"id": 0, "nodes7": [3], "force": LOAD.tolist()}}]


def test_three_cubic_ropes_that_end_at_one_node_are_refused_with_their_cure():
    (problem,) = refused(three_ropes(own=False))
    assert "CableModel[6].CableLine.nodes7" in str(problem)
    assert "3 cubic elements, 3, 13 and 23, end at node 3 and share its slope" in problem.cause
    assert "nodes of their own" in problem.cure and "LagMultipl7 with constr: 0" in problem.cure


def test_three_ropes_that_end_at_nodes_of_their_own_tied_in_r_balance_their_load():
    """Ropes without weight are straight: EA (lambda^2 - 1) lambda / 2 along each of them balances the load."""
    rest = np.linalg.norm(np.array(MIDDLE) - CORNERS, axis=1)

    def unbalanced(place):
        way = CORNERS - place
        stretch = np.linalg.norm(way, axis=1) / rest
        pull = STIFFNESS * 0.5 * (stretch**2 - 1.0) * stretch
        return LOAD + (pull[:, None] * way / (stretch * rest)[:, None]).sum(axis=0)

    result = tautline.simulate(scene(*three_ropes(own=True), start="static", eps_energy=1e-12))
    place = np.asarray(result["position"])[0, list(result["node"]).index(3)]
    assert place == pytest.approx(fsolve(unbalanced, MIDDLE, xtol=1e-12), abs=1e-5)


def laid_over(load):
    """A bar of two spans clamped at one end: elements of two kinds lie over each other on the same nodes."""
    nodes = [node(i, [float(i), 0, 0], [1] * 3 + [0] + [1] * 3 if i == 0 else FREE, [1.0, 0, 0]) for i in range(3)]
    kinds = {"EA": 1e4, "EJ": 1.0}, {"EA": 3e3, "EJ": 2.0}
    parts = [element(10 * k + i, (i, i + 1), **kinds[k]) for i in range(2) for k in range(2)]
    items = [*nodes, *parts, {"PointForce": {"id": 0, "nodes7": [2], "force": load}}]
    return tautline.simulate(scene(*items, start="static", eps_energy=1e-13))


def test_ropes_laid_over_each_other_on_the_same_nodes_share_a_pull_by_their_stiffnesses():
    result = laid_over([100.0, 0.0, 0.0])
    assert result["axial_force"][0] == pytest.approx(100.0 * np.array([10, 3, 10, 3]) / 13, rel=1e-7)


def test_bars_laid_over_each_other_on_the_same_nodes_bend_by_the_sum_of_their_stiffnesses():
    result = laid_over([0.0, 0.0, 1e-3])
    assert result["position"][0, 2, 2] == pytest.approx(1e-3 * 2.0**3 / (3 * (1.0 + 2.0)), rel=1e-4)


@pytest.mark.parametrize(
    ("rhoA", "held", "what"),
    [((0, 1), HELD, "the slope of node 0"), ((0, 0), HELD, "the slope of node 0"), ((0, 0), [1] * 7, "of node 1")],
)
def test_what_is_free_and_has_no_mass_is_refused(rhoA, held, what):
    nodes = node(0, [0, 0, 0], held), node(1, [1, 0, 0]), node(2, [2, 0, 0], HELD)
    parts = [element(i, (i, i + 1), rhoA=float(each)) for i, each in enumerate(rhoA)]
    (problem,) = refused([*nodes, *parts])
    assert "CableALEelement.rhoA" in str(problem) and what in problem.cause and "has no mass" in problem.cause


def test_a_rope_without_mass_between_what_has_mass_runs():
    """Its ends take their place and slope from heavy ropes: nothing is left without inertia."""
    nodes = [node(i, [float(i), 0, 0], [1] * 7 if i in (0, 3) else FREE) for i in range(4)]
    parts = [element(i, (i, i + 1), rhoA=float(i != 1)) for i in range(3)]
    assert tautline.simulate(scene(*nodes, *parts)).attributes["status"] == "done"


def ring(closed):
    """A rod of eight elements along a circle, that ends at its first node or at one of its own."""
    angles = 2.0 * np.pi * np.arange(8 if closed else 9) / 8
    slopes = [[-float(np.sin(a)), float(np.cos(a)), 0.0] for a in angles]
    places = [[float(np.cos(a)), float(np.sin(a)), 0.0] for a in angles]
    nodes = [node(i, place, HELD if i == 0 else FREE, slopes[i]) for i, place in enumerate(places)]
    parts = [element(i, (i, (i + 1) % len(nodes))) for i in range(8)]
    ties = [] if closed else [{"LagMultipl7": {"id": k, "nodes7": [8, 0], "constr": k}} for k in (0, 2)]
    return [*nodes, *parts, *ties]


def test_a_ring_that_ends_at_its_first_node_is_told_to_end_at_one_of_its_own_which_runs():
    (problem,) = refused(ring(closed=True))
    assert "the cable is a ring" in problem.cause and "swap" not in problem.cure
    assert "a new node" in problem.cure and "constr: 0" in problem.cure and "constr: 2" in problem.cure
    assert tautline.simulate(scene(*ring(closed=False))).attributes["status"] == "done"


@pytest.mark.parametrize(
    ("held", "force", "told"),
    [
        (HELD, [0, 0, -5], "z"),
        (HELD, [1, 0, 2], "x and z"),
        ([0, 1, 1, 0, 0, 0, 1], [1, 0, 2], None),
        (HELD, [0] * 3, None),
    ],
)  # fmt: skip
def test_a_force_along_which_its_node_is_held_is_warned_of(held, force, told):
    nodes = node(0, [0, 0, 0], held), node(1, [1, 0, 0])
    made = tautline.read(
        scene(*nodes, element(0, (0, 1)), {"PointForce": {"id": 0, "nodes7": [0], "force": [float(x) for x in force]}})
    )
    texts = [one.text for one in Installed().of(made).warnings(made) if "the force moves nothing" in one.text]
    assert len(texts) == (told is not None) and (told is None or f"held along {told} (BC)" in texts[0])
