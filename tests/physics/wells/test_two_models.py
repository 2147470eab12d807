"""The string as lumps and as an ALE-ANCF beam: each beside what is known, and beside the other."""

from dataclasses import replace

import numpy as np
import pytest
from physics.wells.strings import (
    COLLAR,
    DENSITY,
    GRAVITY,
    Balance,
    E,
    G,
    area,
    mass_per_length,
    run,
    shipped,
    straight_hole,
)

from drillstring.groups.beam_contact import BeamContact
from drillstring.groups.sliding import SLIDING, Sliding
from drillstring.model.build import build
from drillstring.statics.form import at_rest
from drillstring.statics.statics import Statics
from tautline.integrators.state import new_state
from tautline.integrators.statics.equilibrium import find_equilibrium
from tautline.integrators.time_loop import new_frames
from tautline.system.records import records

BEAM = "ale-ancf"


def beam(name, elements, **changes):
    return shipped(name, model__kind=BEAM, model__elements=elements, **changes)


@pytest.mark.parametrize("elements", [2, 5, 12])
def test_a_hanging_beam_is_as_long_as_the_closed_form_says_for_any_number_of_elements(elements):
    # the closed form of stretch: 0.376529 m, two sections of two cross-sections.
    form = at_rest(beam("hanging", elements))
    assert form.stretch == pytest.approx(0.376529, abs=5e-7)
    assert form.position[-1, 2] - form.unstretched[-1] == pytest.approx(0.376529, abs=5e-7)
    assert form.offset.max() == 0.0


@pytest.mark.parametrize("force", [-2.0e4, 0.0, 3.0e4])
@pytest.mark.parametrize("kind", ["lumped", BEAM])
def test_potential_energy_of_a_hanging_string_has_the_work_of_the_bits_force_from_the_unstretched_string(kind, force):
    """Both in closed form: u(s) = (F s + w (L s - s^2/2)) / EA, and U = -w int u ds - F u(L).

    Lumps have the weight of half a link at either end, whose string there is no stretch of: they err by 1/n^2.
    """
    length, n = 1000.0, 40
    result = run(
        straight_hole(0.0, length=length, elements=n, well__wall="none", bit={"force": force}, model__kind=kind)
    )
    w, stiffness = mass_per_length() * GRAVITY, E * area(*COLLAR)
    lowered = (force * length**2 / 2.0 + w * length**3 / 3.0) / stiffness
    at_bit = (force * length + w * length**2 / 2.0) / stiffness
    exact = -w * lowered - force * at_bit
    assert result["potential_energy"] == pytest.approx(exact, rel=1e-6 if kind == BEAM else 1e-3)


def test_the_models_agree_on_potential_energy_of_the_j_well_with_a_force_on_the_bit_within_half_a_percent():
    bit = {"force": -2.0e4}
    lumps, of_beam = (
        run(shipped("jwell", bit=bit, model__kind=kind, model__elements=48, solver__end=0.1))["potential_energy"][0]
        for kind in ("lumped", BEAM)
    )
    assert of_beam == pytest.approx(lumps, rel=5e-3)


SAGS = {
    "configuration_a": (3.278958, 506.7),
    "configuration_b": (233.5539, 506.0),
    "configuration_c": (24.735459, 532.0),
}
"""Largest sag m of the exact extensible rod and where, in unstretched length (docs/lumped_string.md)."""
ENDS = {"configuration_b": (-149.31423, 2e-5), "configuration_c": (0.108223, 1e-5)}
"""How far the guided end goes along the hole, m, and how near the beam of 50 elements comes to it."""


@pytest.mark.parametrize("name", SAGS)
def test_a_beam_of_fifty_elements_lies_as_the_exact_rod_does(name):
    form = at_rest(beam(name, 50))
    sag, place = SAGS[name]
    near = int(np.argmin(np.abs(form.unstretched - place)))
    curve = np.polynomial.Polynomial.fit(form.unstretched[near - 2 : near + 3], form.offset[near - 2 : near + 3], 4)
    found = max(curve(np.linspace(place - 20.0, place + 20.0, 401)))
    # Where the section changes the rod's curvature jumps within a metre, which an element of 20 m does not see.
    assert found == pytest.approx(sag, rel=3e-5 if name == "configuration_c" else 1e-6)
    if name in ENDS:
        end, tolerance = ENDS[name]
        assert form.moved[-1, 0] == pytest.approx(end, abs=tolerance)


def test_the_tension_of_a_bent_beam_is_that_of_the_rod_and_not_its_strain_alone():
    # Horizontal force is zero between a pin and a guide along the hole: where the rod is level its tension is zero.
    form = at_rest(beam("configuration_b", 50))
    level = int(np.argmax(form.offset))
    assert abs(form.tension[level]) < 0.02 * form.tension.max()
    lumps = at_rest(shipped("configuration_b"))
    assert form.tension == pytest.approx(lumps.tension, abs=3e-3 * lumps.tension.max())


def test_ten_elements_of_the_beam_are_nearer_to_the_rod_than_fifty_lumps():
    end, _ = ENDS["configuration_b"]
    ten, fifty = at_rest(beam("configuration_b", 10)), at_rest(shipped("configuration_b"))
    assert abs(ten.moved[-1, 0] - end) < 0.5 * abs(fifty.moved[-1, 0] - end)


@pytest.fixture(scope="module")
def jwells():
    """The J-well at rest without friction, as 96 lumps and as a beam of 48 elements."""
    return Balance(shipped("jwell", model__elements=96)), Balance(beam("jwell", 48))


def test_the_models_agree_on_hook_load_stretch_and_side_forces_of_the_j_well(jwells):
    lumps, of_beam = jwells
    assert of_beam["hook_load"] == pytest.approx(lumps["hook_load"], rel=5e-4)
    assert of_beam["bit_depth"] == pytest.approx(lumps["bit_depth"], abs=2e-3)
    # Without friction the wall takes no part in what happens along the hole: the tension at the table is the buoyed
    # weight per metre times vertical depth, summed over the sections.
    per_metre = of_beam.model.observe.__self__.per_metre
    assert of_beam["hook_load"] == pytest.approx(per_metre @ np.diff(of_beam["position"][:, 2]), rel=1e-3)


REGIONS = {"vertical": (0.0, 2190.0), "build, upper": (2190.0, 2700.0), "build, lower": (2800.0, 3500.0)}


def pressed(balance, top, bottom):
    """Side force of all that touches between two measured depths, N: of the wall's springs, from the offsets."""
    wall = balance.model.system.groups
    contact = next(g for g in wall if hasattr(g, "springs") and "clearance" in g.springs.dtype.names)
    if hasattr(contact, "hole"):
        from drillstring.results.beam_observe import nearest

        points = contact.hole.points
        q = balance.state.full_q
        place = np.array([sum(p.weight[k] * q[p.place[k] : p.place[k] + 3] for k in range(p.vectors)) for p in points])
        depth = np.interp(np.arange(len(points)), [0, len(points) - 1], [0.0, 3770.0])
        well = balance.model.observe.__self__.well
        s, u, v = nearest(well, place, depth)
    else:
        q = balance.state.full_q.reshape(-1, 4)[contact.springs.body]
        s, u, v = balance["measured_depth"][contact.springs.body], q[:, 1], q[:, 2]
    force = contact.springs.stiffness * np.maximum(0.0, np.hypot(u, v) - contact.springs.clearance)
    return float(force[(s >= top) & (s < bottom)].sum())


def test_the_models_agree_on_where_the_j_well_carries_the_string(jwells):
    lumps, of_beam = jwells
    total = pressed(lumps, 0.0, 4000.0)
    assert pressed(of_beam, 0.0, 4000.0) == pytest.approx(total, rel=5e-3)
    for top, bottom in REGIONS.values():
        assert pressed(of_beam, top, bottom) == pytest.approx(pressed(lumps, top, bottom), abs=1e-2 * total)


@pytest.mark.parametrize(("direction", "along"), [("pick_up", 1.0), ("slack_off", -1.0)])
def test_the_models_agree_on_hook_loads_under_friction_all_one_way(direction, along):
    # Coulomb's friction 0.25 on every point of the beam that touches, as torque-drag has it on every lump.
    model = build(beam("jwell", 48))
    system, state = model.system, new_state(model.system)
    contact = next(g for g in system.groups if isinstance(g, BeamContact))
    rows = records(contact.springs.size, SLIDING, factor=0.0, along=along)
    slides = tuple(g._replace(law=Sliding(rows)) if g is contact else g for g in system.groups)
    sliding = replace(system, groups=slides, linked={})
    for factor in (0.0, 0.1, 0.25):
        rows.factor = factor
        find_equilibrium(sliding, state, model.step_limit)
    frames = new_frames(1, system.q.size, model.own)
    frames.q[0], frames.residual[0] = state.full_q, state.residual
    seen = model.observe(frames)
    # The beam hangs by its stretch past the end of the level hole, which moves the hook load by a thousandth.
    lumps = Statics(shipped("jwell"), 3770.7, 96).solve(0.25, direction)
    assert seen["hook_load"][0] == pytest.approx(lumps.hook_load, rel=5e-3)


def test_under_heave_the_bit_of_the_beam_moves_as_that_of_the_lumps():
    # Friction 0.3 and 0.2, 20 s, half a stuck phase and more: 2 % of the way that the bit goes is asked, 0.2 % is seen.
    changes = {"solver__end": 20.0, "solver__step": 4e-3}
    lumps = run(shipped("jwell", model__elements=96, **changes))
    of_beam = run(beam("jwell", 48, **changes))
    way = np.ptp(lumps["bit_depth"])
    assert way > 1.5
    assert np.abs(of_beam["bit_depth"] - lumps["bit_depth"]).max() < 0.01 * way
    hook = np.ptp(lumps["hook_load"])
    assert np.sqrt(np.mean((of_beam["hook_load"] - lumps["hook_load"]) ** 2)) < 0.02 * hook


def test_a_bit_on_bottom_is_the_same_to_both_models():
    changes = {"solver__end": 4.0, "solver__step": 5e-3, "output__interval": 0.1}
    lumps, of_beam = run(shipped("drilling", **changes)), run(shipped("drilling", model__kind=BEAM, **changes))
    for name in ("weight_on_bit", "torque_on_bit", "hook_load", "surface_torque"):
        assert np.abs(of_beam[name] - lumps[name]).max() < 2e-3 * np.abs(lumps[name]).max(), name


def test_an_unbalanced_beam_bows_out_as_the_rotating_shaft_of_the_closed_form():
    # E I y'''' = m Omega^2 (y + e) between two pins: in the middle y / e = (1 / cos(b) + 1 / cosh(b)) / 2 - 1 with
    # b = L / 2 (m Omega^2 / E I)^(1/4). Half of the critical speed, slight damping, no weight.
    length, off = 20.0, 1e-3
    second = np.pi / 64 * (COLLAR[0] ** 4 - COLLAR[1] ** 4)
    critical = (np.pi / length) ** 2 * np.sqrt(E * second / mass_per_length())
    speed = 0.5 * critical
    scene = straight_hole(
        0.0, length, 16, well__wall="none", gravity=0.0, model__kind=BEAM, model__bending="stiff", start="straight",
        bit={"lateral": "pinned"}, top__rotation={"ramp": {"to": float(speed), "over": 20.0}},
        damping={"translation": 60.0, "structural": 0.01}, string__0__eccentricity=[off, 0.0],
        solver__step=0.01, solver__end=60.0, output__interval=0.1,
    )  # fmt: skip
    result = run(scene)
    b = 0.5 * length * (mass_per_length() * speed**2 / (E * second)) ** 0.25
    exact = off * (0.5 * (1.0 / np.cos(b) + 1.0 / np.cosh(b)) - 1.0)
    middle = np.hypot(*result["lateral_displacement"][-50:, 8].T)
    assert middle.mean() == pytest.approx(exact, rel=1e-2)
    assert np.ptp(middle) < 0.02 * exact


def test_a_stuck_beam_does_not_creep():
    result = run(beam("jwell", 24, solver__end=3.0, solver__step=5e-3))
    # The string starts with the block's 18 mm/s; friction stops the bit at once.
    stuck = (result["time"] > 0.1) & (result["time"] < 2.5)
    assert np.abs(result["bit_speed"][stuck]).max() < 1e-9
    assert np.ptp(result["bit_depth"][stuck]) < 1e-9


def test_a_rotating_beam_takes_the_torque_that_friction_around_it_needs():
    # A collar in a slant hole that turns steadily climbs the wall: torque sum(N) R mu / sqrt(1 + mu^2), mu = 0.2.
    inclination, length, mu = 0.9, 300.0, 0.2
    scene = straight_hole(
        inclination,
        length,
        6,
        friction=mu,
        model__kind=BEAM,
        top__rotation={"ramp": {"to": 6.0, "over": 2.0}},
        damping={"structural": 0.02},
        solver__end=12.0,
        solver__step=2e-3,
        output__interval=0.1,
    )
    result = run(scene)
    late = result["time"] > 10.0
    pressed = result["contact_force"][late].sum(axis=1).mean()
    assert result["surface_torque"][late].mean() == pytest.approx(mu * 0.5 * COLLAR[0] * pressed, rel=1e-3)
    # The drive carries the first eighth of an element: half of what lies above the first point of contact.
    side = mass_per_length() * 9.81 * (length - length / 6 / 8) * np.sin(inclination)
    assert pressed == pytest.approx(side / np.sqrt(1.0 + mu**2), rel=5e-3)
    assert result["rotation_rate"][-1] == pytest.approx(6.0, rel=1e-2)


def test_a_beam_twists_as_the_closed_form_says():
    # Turned at the top by a prescribed angle while the wall holds nothing: the free bit follows; with viscous drag c
    # per metre at the rate Omega the torque at the top is c Omega L, and the twist c Omega L^2 / (2 G J).
    length, rate = 200.0, 3.0
    scene = straight_hole(
        0.0,
        length,
        8,
        well__wall="none",
        model__kind=BEAM,
        top__rotation=rate,
        damping={"rotation": 30.0},
        solver__end=20.0,
        solver__step=5e-3,
        output__interval=1.0,
    )
    result = run(scene)
    drag = 30.0 * 12.0 / length
    polar = np.pi / 32 * (COLLAR[0] ** 4 - COLLAR[1] ** 4)
    torque = drag * rate * length
    assert result["surface_torque"][-1] == pytest.approx(torque, rel=1e-4)
    assert result["rotation"][-1, 0] - result["rotation"][-1, -1] == pytest.approx(
        drag * rate * length**2 / (2.0 * G * polar), rel=2e-3
    )


def test_an_explicit_method_gives_the_beams_motion_too():
    changes = {
        "model__kind": BEAM,
        "solver__end": 0.4,
        "output__interval": 0.02,
        "top__block": {
            "harmonic": {
                "amplitude": 0.2,
                "period": 1.0,
                "ramp": 0.5,
            }
        },
    }
    implicit = run(straight_hole(0.3, 200.0, 4, friction=0.0, solver__rho_inf=1.0, solver__step=5e-4, **changes))
    explicit = run(straight_hole(0.3, 200.0, 4, friction=0.0, solver__method="rk4", solver__step=2e-5, **changes))
    way = np.ptp(explicit["bit_depth"])
    assert np.abs(implicit["bit_depth"] - explicit["bit_depth"]).max() < 2e-3 * way


def test_elastic_and_inertial_properties_of_a_beam_are_those_of_its_tube():
    scene = straight_hole(
        0.5 * np.pi,
        30.0,
        3,
        well__wall="none",
        model__kind=BEAM,
        model__bending="stiff",
        bit={"lateral": "pinned"},
        gravity=1e-3,
    )
    form = at_rest(scene)
    second = np.pi / 64 * (COLLAR[0] ** 4 - COLLAR[1] ** 4)
    weight = DENSITY * area(*COLLAR) * 1e-3
    # A pinned beam under its own weight: 5 w L^4 / (384 E I) in the middle; nodes are at the thirds.
    x = form.unstretched[1] / 30.0
    exact = weight * 30.0**4 / (24 * E * second) * (x - 2 * x**3 + x**4)
    assert form.offset[1] == pytest.approx(exact, rel=1e-6)
