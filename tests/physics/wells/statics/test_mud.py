"""What the mud does: added mass, inside fluid, drag, viscous damping; against closed forms."""

import numpy as np
import pytest
from physics.wells.strings import GRAVITY, Balance, E, run, straight_hole
from physics.wells.strings import mass_per_length as steel

from drillstring.model.prepared import tubes_of, well_of
from drillstring.warnings import warnings
from tautline.integrators.linearise import matrices
from tautline.scene.errors import SceneError

MUD, HOLE, OD, ID = 1500.0, 0.3, 0.165, 0.0572
OUTER, BORE = np.pi / 4 * OD**2, np.pi / 4 * ID**2


def masses(mud):
    """Mass of the second of four lumps of 25 m: along the hole, sideways twice, about the axis."""
    changes = {} if mud is None else {"mud": {"density": MUD, "drag": 0.0} | mud}
    balance = Balance(straight_hole(0.0, elements=4, diameter=HOLE, **changes))
    mass, _, _ = matrices(balance.model.system, balance.state)
    assert np.abs(mass - np.diag(np.diag(mass))).max() == 0.0
    return [np.diag(mass)[balance.rows(d)[1]] for d in ("along the hole", "north side", "east side", "rotation")]


ANNULAR = (HOLE**2 + OD**2) / (HOLE**2 - OD**2)


@pytest.mark.parametrize(
    ("mud", "outside", "inside"),
    [
        (None, 0.0, 0.0),
        ({"added_mass": 0.0, "inside": False}, 0.0, 0.0),
        ({"added_mass": 1.0, "inside": False}, 1.0, 0.0),
        ({"added_mass": 2.5, "inside": True}, 2.5, 1.0),
        ({"added_mass": "annular", "inside": True}, ANNULAR, 1.0),
        ({"added_mass": "annular", "inside": True, "inside_density": 900.0}, ANNULAR, 900.0 / MUD),
    ],
)
def test_mud_adds_mass_sideways_only(mud, outside, inside):
    # C_a rho_m pi d^2/4 outside, Blevins' (D^2 + d^2)/(D^2 - d^2) for an annulus; rho_m pi d_i^2/4 inside; exact
    along, north, east, about = masses(mud)
    sideways = 25.0 * (steel() + MUD * (outside * OUTER + inside * BORE))
    assert along == pytest.approx(25.0 * steel(), rel=1e-12)
    assert (north, east) == pytest.approx((sideways, sideways), rel=1e-12)
    assert about == pytest.approx(25.0 * 7850.0 * np.pi / 32 * (OD**4 - ID**4), rel=1e-12)


def string_of_two(mud, pipe):
    """So many metres of drill pipe, 5 by 4.276 in, above so many of the collar, in 100 m of hole."""
    sections = [
        {"name": "pipe", "length": pipe, "od": 0.127, "id": 0.1086},
        {"name": "collar", "length": 100.0 - pipe, "od": OD, "id": ID},
    ]
    return straight_hole(0.0, elements=4, diameter=HOLE, string=sections, mud=mud)


# Archimedes, kg/m: the pipe has 26.73 of steel and displaces 12.668e-3 m^2, the collar 147.7 and 21.38e-3 m^2
@pytest.mark.parametrize(
    ("mud", "floats"),
    [
        ({"density": 2200.0, "inside": False}, ["pipe"]),  # 26.73 against 27.87
        ({"density": 2100.0, "inside": False}, []),  # 26.73 against 26.60
        ({"density": 2200.0}, []),
        ({"density": 1200.0, "inside_density": 9000.0}, []),  # what is inside makes it heavier
        ({"density": 2200.0, "inside_density": 50.0}, ["pipe"]),
    ],
)
def test_a_section_floats_where_its_steel_and_contents_are_lighter_than_the_mud_it_displaces(mud, floats):
    told = [warning.text.split()[0] for warning in warnings(string_of_two(mud, 50.0)) if "floats" in warning.text]
    assert told == floats


def test_a_string_that_floats_as_a_whole_is_refused():
    # empty pipe, 100 m of it: 26.73 kg/m against 2200 kg/m^3 times 12.668e-3 m^2
    pipe_alone = straight_hole(
        0.0, diameter=HOLE, string=[{"name": "pipe", "length": 100.0, "od": 0.127, "id": 0.1086}],
        mud={"density": 2200.0, "inside": False},
    )  # fmt: skip
    with pytest.raises(SceneError, match=r"114\.2 kg lighter"):
        tubes_of(pipe_alone, well_of(pipe_alone).length)


@pytest.mark.parametrize("length", [50.0, 70.0, 90.0])
def test_a_string_as_heavy_as_the_mud_it_displaces_is_refused_whatever_rounding_leaves_of_it(length):
    made = string_of_two({"density": 7850.0}, length)
    with pytest.raises(SceneError, match="it is as heavy as the mud"):
        tubes_of(made, well_of(made).length)


def test_what_is_inside_an_empty_string_is_a_contradiction():
    with pytest.raises(SceneError, match="leaves the string empty"):
        string_of_two({"density": 1200.0, "inside": False, "inside_density": 500.0}, 50.0)


def test_a_lump_falling_sideways_in_mud_nears_the_terminal_speed_of_morisons_drag():
    # half rho_m C_d d v^2 = buoyed weight per metre; level hole, 400 m wide, the steel so soft that lumps are free
    result = run(
        straight_hole(
            np.pi / 2, diameter=400.0, elements=2, start="straight", solver__end=12.0, material__youngs_modulus=1.0,
            mud={"density": MUD, "drag": 1.0}, model__bending="stiff",
        )
    )  # fmt: skip
    buoyed = steel() * GRAVITY * (1 - MUD / 7850.0)
    speed = result["velocity"][-1, -1, 2]
    assert speed == pytest.approx(np.sqrt(2 * buoyed / (MUD * OD)), rel=1e-3)


def test_structural_damping_takes_the_decrement_of_kelvin_and_voigt():
    # one lump, omega^2 = (EA/L)/m, damping ratio zeta = eta omega / 2: amplitude falls by exp(-zeta omega t)
    eta = 5e-4
    stopped = {"velocity": {"ramp": {"from": 0.1, "to": 0.0, "over": 0.01}}}
    result = run(
        straight_hole(
            0.0, top__block=stopped, damping={"structural": eta}, solver__end=0.6, solver__rho_inf=1.0,
            solver__step=1e-4, output__interval=1e-3,
        )
    )  # fmt: skip
    omega = np.sqrt(E * steel() / 7850.0 / 100.0 / (steel() * 50.0))
    x, t = result["bit_speed"][20:], result.time[20:]
    peaks = np.flatnonzero((np.abs(x[1:-1]) > np.abs(x[:-2])) & (np.abs(x[1:-1]) >= np.abs(x[2:]))) + 1
    rate = -np.polyfit(t[peaks], np.log(np.abs(x[peaks])), 1)[0]
    assert rate == pytest.approx(0.5 * eta * omega**2, rel=2e-2)
