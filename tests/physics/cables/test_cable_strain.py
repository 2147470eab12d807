"""Green against engineering strain of the cable elements: thesis section 2.5.2, Figs 2.24 and 2.25.

With the stretch lambda the axial force is EA lambda (lambda^2 - 1)/2 by Green's strain (eq. 2.52), EA (lambda - 1) by
engineering strain (eq. 2.154); what a small stretch more takes is EA (3 lambda^2 - 1)/2 and EA. All else here follows
from that, by tests/references/cables.py or by hand.
"""

import numpy as np
import pytest
from numpy.polynomial import Legendre
from numpy.polynomial.legendre import leggauss
from physics.cables.tied_cables import at_rest, element, node, of_nodes, run, scene
from references.cables import force_of, hanging_rope, hermite_bar_frequencies, stretch_of
from scipy.linalg import eigh

from tautline.integrators.vibration.modes import modes

G = 9.81
STRAINS = ("green", "engineering")
BOTH_STRAINS = pytest.mark.parametrize("strain", STRAINS)
BOTH_KINDS = pytest.mark.parametrize("kind", ["cubic", "linear"])
DOWN = (0, 0, -1)
IMPLICIT = {"type": "G-alpha", "rho_inf": 1.0, "time_step": 1e-3, "eps_energy": 1e-10}


def tangent(stretch, EA, strain):
    """Force per strain, N, of a small stretch more."""
    return EA * (3 * np.asarray(stretch) ** 2 - 1) / 2 if strain == "green" else EA + 0 * np.asarray(stretch)


def line(kind, strain, EA, rhoA, *items, length=1.0, gravity=0.0, end_held=0, start=0.0, more="", **solver):
    """One element that hangs down from the origin to a node 1 at ``start`` + length, moving along the vertical only."""
    place = -(start or length)
    material = f"EA: {EA}, rhoA: {rhoA}, strain: {strain}{more}"
    if kind == "linear":
        parts = [
            "Node4Dof: {id: 0, xyz: [0, 0, 0], BC: [1, 1, 1, 1], p: 0}",
            f"Node4Dof: {{id: 1, xyz: [0, 0, {place}], BC: [1, 1, {end_held}, 1], p: {length}}}",
            f"CableALEelementLin: {{id: 0, nodes4: [0, 1], {material}}}",
        ]
    else:
        slope, BC = f"[0, 0, {place / length}]", [1, 1, end_held, 1, 1, 0, 1]
        parts = [
            f"Node7Dof: {{id: 0, xyz: [0, 0, 0], xyz_d: {slope}, BC: [1, 1, 1, 1, 1, 0, 1], p: 0}}",
            f"Node7Dof: {{id: 1, xyz: [0, 0, {place}], xyz_d: {slope}, BC: {BC}, p: {length}}}",
            f"CableALEelement: {{id: 0, nodes7: [0, 1], {material}}}",
        ]
    return scene([*parts, *items], (0, 0, -gravity), **IMPLICIT | solver)


BESIDE = (
    "Node4Dof: {id: 8, xyz: [1, 0, 0], BC: [1, 1, 1, 1]}",
    "Node4Dof: {id: 9, xyz: [1, 0, -1], BC: [1, 1, 0, 1]}",
    "CableALEelementLin: {id: 9, nodes4: [8, 9], EA: 1, rhoA: 1}",
)
"""An element by itself that rests, for scenes in which nothing else is free."""


def on(kind):
    """Key of the nodes of a kind of element."""
    return "nodes7" if kind == "cubic" else "nodes4"


def vertical(model, state, kind):
    """Depth of node 1, m, in a state."""
    return -state.full_q[9 if kind == "cubic" else 6]


# Fig. 2.24
MASS, LIGHT = 1.0, 1e-6


@BOTH_KINDS
@BOTH_STRAINS
@pytest.mark.parametrize("EA", [1.0, 10.0, 100.0, 1e3, 1e4, 1e5])
def test_a_mass_hangs_and_vibrates_on_a_light_cable_as_on_its_spring(kind, strain, EA):
    # (m + half the cable) g = N(lambda); omega^2 = N'(lambda) / (L (m + a third of the cable)). Of the cable's share,
    # 1e-6, nothing but squares is left out: measured 1e-15 of the length, 4e-9 of the frequency (rounding of a matrix
    # whose highest mode is 1e4 times as fast)
    length = 1.5
    mass = f"PointMass: {{id: 0, {on(kind)}: [1], mass: {MASS}}}"
    model, state = at_rest(line(kind, strain, EA, LIGHT / length, mass, length=length, gravity=G))
    stretch = float(stretch_of((MASS + LIGHT / 2) * G, EA, strain))
    assert vertical(model, state, kind) == pytest.approx(stretch * length, rel=1e-11)
    omega = np.sqrt(tangent(stretch, EA, strain) / (length * (MASS + LIGHT / 3)))
    assert modes(model.system, state).omega[0] == pytest.approx(omega, rel=1e-7)


def hanging(elements, EA, strain, length=1.0, rhoA=1.0, gravity=G):
    """A cable of cubic elements that hangs under its own weight, moving along the vertical only."""
    nodes = [
        node(i, (0, 0, -i * length / elements), (1, 1, int(i == 0), 1, 1, 0, 1), DOWN) for i in range(elements + 1)
    ]
    parts = [element(i, i, i + 1, EA=EA, rhoA=rhoA, strain=strain) for i in range(elements)]
    return scene([*nodes, *parts], (0, 0, -gravity), **IMPLICIT)


def hanging_frequency(EA, strain, terms=20):
    """First axial frequency, rad/s, about equilibrium of 1 m of 1 kg/m under its own weight: Rayleigh-Ritz.

    Of (T u')' + rhoA omega^2 u = 0, u(0) = 0, T u'(1) = 0 with the tangent T at the stretch below which the rest hangs.
    """
    x, weight = leggauss(60)
    s, weight = (1 + x) / 2, weight / 2
    shapes = [Legendre.basis(k, domain=[0, 1]) for k in range(terms)]
    u = np.array([s * shape(s) for shape in shapes])
    u_s = np.array([shape(s) + s * shape.deriv()(s) for shape in shapes])
    stiffness = (u_s * weight * tangent(stretch_of(G * (1 - s), EA, strain), EA, strain)) @ u_s.T
    return np.sqrt(eigh(stiffness, (u * weight) @ u.T, eigvals_only=True)[0])


@BOTH_STRAINS
@pytest.mark.parametrize("EA", [1.0, 10.0, 100.0, 1e4])
def test_first_axial_frequency_of_a_hanging_cable_converges_to_that_of_the_continuum(strain, EA):
    # measured with 8 elements: 5e-6, 9e-8, 4e-10, 8e-10 (Green), 8e-10 (engineering); from above
    exact = hanging_frequency(EA, strain)
    errors = []
    for elements in (1, 2, 8):
        model, state = at_rest(hanging(elements, EA, strain))
        errors.append(modes(model.system, state).omega[0] / exact - 1)
    assert 0 < errors[2] < errors[1] < errors[0] < 1e-3
    assert errors[2] < 1e-5
    assert strain == "green" or errors[2] < 2e-9


def test_green_strain_stiffens_a_soft_hanging_cable_and_engineering_strain_does_not():
    # Fig. 2.24, one element, rhoA = L = 1: over the frequency sqrt(EA/L / rhoA L) of a lumped model the cable has
    # pi/2 (its mass is not at the end), whatever EA by engineering strain. By Green's strain that is 2.9 times as much
    # at EA = 1 (thesis: "over 2 times"), 1.0 % more at the bound of eq. 2.156, rhoA L = EA/1000, and 0.1 % at EA/10 000
    ratio = {}
    for strain in STRAINS:
        for EA in (1.0, 10.0, 100.0, 1e3, 1e4):
            model, state = at_rest(hanging(1, EA, strain))
            ratio[strain, EA] = modes(model.system, state).omega[0] / np.sqrt(EA)
    one = 2 * np.pi * hermite_bar_frequencies(1, 1.0, 1.0, 1.0)[0]
    for EA in (1.0, 10.0, 100.0, 1e3, 1e4):
        assert ratio["engineering", EA] == pytest.approx(one, rel=1e-9)
    green = np.array([ratio["green", EA] for EA in (1.0, 10.0, 100.0, 1e3, 1e4)]) / one
    assert np.all(np.diff(green) < 0)
    assert green[0] > 2.0
    assert green[3] == pytest.approx(1.0, abs=0.011)
    assert green[4] == pytest.approx(1.0, abs=0.0011)


@BOTH_STRAINS
@pytest.mark.parametrize(("EA", "tolerance"), [(10.0, 1e-5), (1e3, 1e-10), (1e5, 1e-13)])
def test_a_hanging_cable_has_the_elongation_of_the_closed_form(strain, EA, tolerance):
    # engineering: s + w (L s - s^2/2)/EA, which one cubic element holds exactly; Green: integral of the stretch, with 8
    # elements, measured 1.8e-6, 7e-12, 2e-16 m
    elements = 1 if strain == "engineering" else 8
    _, state = at_rest(hanging(elements, EA, strain))
    exact, _ = hanging_rope(np.linspace(0, 1, elements + 1), 1.0, EA, G, strain=strain)
    found = -state.full_q[2 : 7 * (elements + 1) : 7]
    assert found == pytest.approx(exact, rel=1e-13 if strain == "engineering" else tolerance)


@BOTH_KINDS
@BOTH_STRAINS
def test_a_mass_bounces_on_its_cable_at_the_frequency_of_the_modes(kind, strain):
    # 40 small bounces about equilibrium of a soft, far stretched cable: a period of 100 steps, which the average
    # acceleration makes longer by (omega h)^2/12 = 3.2899e-4; measured 3.2891e-4
    EA = 20.0
    stretch = float(stretch_of(MASS * G, EA, strain))
    omega = float(np.sqrt(tangent(stretch, EA, strain) / MASS))
    step = 2 * np.pi / omega / 100
    mass = f"PointMass: {{id: 0, {on(kind)}: [1], mass: {MASS}}}"
    text = line(kind, strain, EA, 1e-9, mass, gravity=G, start=stretch * 1.0001, type="Newmark", time_step=step,
                time_end=40 * 100 * step)  # fmt: skip
    result = run(text)
    z = of_nodes(result, "position", (1,))[:, 0, 2] + stretch
    crossings = np.flatnonzero((z[:-1] < 0) & (z[1:] >= 0))
    times = crossings + z[crossings] / (z[crossings] - z[crossings + 1])
    assert crossings.size == 40
    period = (times[-1] - times[0]) / 39 * step
    assert period == pytest.approx(2 * np.pi / omega * (1 + (omega * step) ** 2 / 12), rel=1e-6)


# Fig. 2.25
@BOTH_KINDS
@BOTH_STRAINS
@pytest.mark.parametrize("stretch", [0.65, 0.8, 0.98, 1.02, 1.2, 1.5])
def test_a_force_stretches_an_element_by_the_closed_form(kind, strain, stretch):
    # Fig. 2.25 by its inverse: cubic by Green's strain, linear by the other; measured 5e-13
    EA = 7.0
    force = float(force_of(stretch, EA, strain))
    pull = f"PointForce: {{id: 0, {on(kind)}: [1], force: [0, 0, {-force!r}]}}"
    model, state = at_rest(line(kind, strain, EA, 1.0, pull))
    assert vertical(model, state, kind) == pytest.approx(stretch, rel=1e-11)


@BOTH_KINDS
@BOTH_STRAINS
@pytest.mark.parametrize("stretch", [0.5, 0.75, 1.0, 1.25, 1.5])
def test_an_element_held_at_a_length_has_the_force_and_energy_of_the_closed_form(kind, strain, stretch):
    # Fig. 2.25 with r_2 from 0.5 to 1.5: beyond 1/sqrt(3) Green's strain has no stable force to push it with
    EA = 7.0
    result = run(line(kind, strain, EA, 1.0, *BESIDE, end_held=1, start=stretch, time_end=1e-3))
    force = float(force_of(stretch, EA, strain))
    energy = EA / 2 * ((stretch**2 - 1) / 2 if strain == "green" else stretch - 1) ** 2
    assert np.array(result["axial_force"])[0, 0] == pytest.approx(force, rel=1e-12, abs=1e-13)
    assert np.array(result["strain_energy"])[0] == pytest.approx(energy, rel=1e-12, abs=1e-13)


def test_a_scene_in_which_nothing_is_free_can_be_run():
    result = run(line("linear", "green", 7.0, 1.0, end_held=1, start=1.5, time_end=1e-3))
    assert np.array(result["axial_force"])[-1, 0] == pytest.approx(float(force_of(1.5, 7.0, "green")), rel=1e-12)


# a rope that carries no compression
SLACK = ", compression: false"


@BOTH_KINDS
@BOTH_STRAINS
def test_a_pushed_rope_has_no_force_and_no_energy(kind, strain):
    held = [run(line(kind, strain, 50.0, 1.0, *BESIDE, end_held=1, start=0.8, more=more)) for more in (SLACK, "")]
    assert np.array(held[1]["axial_force"])[:, 0].max() < -1.0
    assert np.array(held[1]["strain_energy"]).min() > 0.1
    assert np.all(np.array(held[0]["axial_force"])[:, 0] == 0.0)
    assert np.all(np.array(held[0]["strain_energy"]) == 0.0)
    # nothing pushes it back: a weightless end stays where it is, while one that resists compression leaves
    assert np.ptp(np.array(run(line(kind, strain, 50.0, 1.0, start=0.8, more=SLACK))["position"]), axis=0).max() == 0.0
    assert np.ptp(np.array(run(line(kind, strain, 50.0, 1.0, start=0.8))["position"]), axis=0).max() > 0.05


@BOTH_KINDS
@BOTH_STRAINS
def test_a_pulled_rope_does_not_know_that_it_could_go_slack(kind, strain):
    text = [line(kind, strain, 50.0, 1.0, gravity=G, start=1.3, more=more) for more in (SLACK, "")]
    slack, other = (np.array(run(one)["axial_force"]) for one in text)
    assert slack[slack > 0.0].size > 10
    assert slack[:10] == pytest.approx(other[:10], rel=1e-12)


def test_a_mass_that_falls_into_its_rope_is_caught_and_thrown_back_to_where_it_fell_from():
    # light linear element, engineering strain: free fall to the length L, then a spring k = EA/L about its own
    # equilibrium. Closed form: falls t_1 = sqrt(2 h/g), lowest at e + sqrt(e^2 + v^2/omega^2) with e = m g/k, and in
    # the rope for t_2 = 2 (pi - atan(v/(omega e)))/omega. Measured to 2e-10 m.
    EA, drop = 400.0, 0.2
    text = line("linear", "engineering", EA, 1e-9, f"PointMass: {{id: 0, nodes4: [1], mass: {MASS}}}", gravity=G,
                start=1.0 - drop, more=SLACK, type="RK4", time_step=1e-5, time_end=0.78, plotpoints=1000)  # fmt: skip
    result = run(text)
    t, depth = np.array(result["time"]), -of_nodes(result, "position", (1,))[:, 0, 2]
    omega, sag, fall = np.sqrt(EA / MASS), MASS * G / EA, np.sqrt(2 * drop / G)
    speed = G * fall
    caught = 2 * (np.pi - np.arctan(speed / (omega * sag))) / omega
    free = 1.0 - drop + G * t**2 / 2
    later = t - fall
    spring = 1.0 + sag - sag * np.cos(omega * later) + speed / omega * np.sin(omega * later)
    up = t - fall - caught
    thrown = 1.0 - speed * up + G * up**2 / 2
    exact = np.where(later < 0, free, np.where(up < 0, spring, thrown))
    assert t[-1] < 3 * fall + caught  # one bounce
    assert depth == pytest.approx(exact, abs=1e-8)
    assert depth.max() == pytest.approx(1.0 + sag + np.hypot(sag, speed / omega), abs=1e-5)  # frames of 1 ms
    assert np.all(np.array(result["axial_force"])[:, 0][later < -1e-3] == 0.0)
    assert result.attributes["energy_error"] < 1e-6
