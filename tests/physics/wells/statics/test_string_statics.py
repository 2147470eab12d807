"""The string at rest against exact solutions (tests/references/extensible_rod.py)."""

import numpy as np
import pytest
from physics.wells.strings import DATA, Balance, area, mass_per_length, shipped, straight_hole
from references import extensible_rod as rod
from references import planar_well_dynamics as planar
from scipy.interpolate import CubicSpline

from drillstring.model.build import build
from tautline.simulation import simulate

MUD = 1840.0


@pytest.mark.parametrize("elements", [2, 5, 12, 50])
def test_hanging_string_stretches_by_0_376529_m_whatever_the_number_of_elements(elements):
    # exact: sum of (weight below + own weight / 2) length / EA; the tolerance is the issue's, rounding is 1e-13
    balance = Balance(shipped("hanging", model__elements=elements))
    stretch = balance["bit_depth"] - 1000.0
    assert stretch == pytest.approx(0.376529, abs=1e-6)
    assert stretch == pytest.approx(rod.hanging_elongation(), abs=1e-10)


@pytest.fixture(scope="module")
def shape():
    """Configurations at n = 50: x from the pin, y up, at the lumps, and a cubic through them.

    The beam between lumps is as smooth as a cubic spline (continuous slope and moment, no moment at either pin), which
    is what y(440) is read from: 440 m falls between two lumps.
    """
    known = {}

    def of(case):
        if case not in known:
            balance = Balance(shipped(f"configuration_{case.lower()}"))
            assert balance.unstretched_depth.size == 51
            x, y = balance["position"][:, 0], -balance["position"][:, 2]
            assert np.abs(balance["position"][:, 1]).max() < 1e-9, "it stays in the vertical plane"
            known[case] = x, y, CubicSpline(balance.unstretched_depth, y, bc_type="natural")
        return known[case]

    return of


@pytest.mark.parametrize("case", ["A", "B", "C"])
def test_level_string_sags_as_the_extensible_elastica_within_a_thousandth(shape, case):
    _, y, spline = shape(case)
    exact = rod.solve(case)
    assert y.min() == pytest.approx(exact.sag, rel=1e-3)
    assert spline(np.linspace(300.0, 700.0, 4001)).min() == pytest.approx(exact.sag, rel=1e-3)


@pytest.mark.parametrize("case", ["A", "C"])
def test_level_string_is_at_440_m_where_the_extensible_elastica_is_within_a_thousandth(shape, case):
    assert shape(case)[2](440.0) == pytest.approx(rod.solve(case).at(440.0)[1], rel=1e-3)


def test_free_end_of_configuration_b_moves_in_by_149_314_m_within_a_thousandth(shape):
    x, _, _ = shape("B")
    assert x[-1] - 1000.0 == pytest.approx(-149.31423, rel=1e-3)


def test_free_end_of_configuration_c_moves_out_by_0_108223_m_within_2_5_mm(shape):
    x, _, _ = shape("C")
    assert x[-1] - 1000.0 == pytest.approx(0.108223, abs=2.5e-3)


def test_end_of_configuration_c_converges_to_the_exact_one_at_second_order():
    # measured errors 2.13, 0.523, 0.128 mm at n = 50, 100, 200: orders 2.02, 2.03
    exact = rod.solve("C").end_displacement
    ends = [Balance(shipped("configuration_c", model__elements=n))["position"][-1, 0] for n in (50, 100, 200)]
    error = [end - 1000.0 - exact for end in ends]
    assert np.log2(error[0] / error[1]) == pytest.approx(2.0, abs=0.15)
    assert np.log2(error[1] / error[2]) == pytest.approx(2.0, abs=0.15)


REST = [
    (321.28020804, 0.0044367586), (642.53004407, 0.0093751942), (963.74950808, 0.0149433689),
    (1284.93860008, 0.0213255393), (1606.09732004, 0.0288006971), (1927.22566796, 0.0381075815),
    (2248.32548638, 0.0381409571), (2569.40537060, 0.0381327433), (2890.44467859, -0.0381122061),
    (3211.44833476, -0.0381466364), (3532.43889808, -0.0192730095), (3772.43423761, -0.0194486248),
]  # fmt: skip
"""Measured depth and offset of 12 lumps by planar_well_dynamics.static_start, whose compilation takes seconds."""


@pytest.mark.study
def test_table_of_the_jwell_at_rest_is_the_independent_solution():
    # itself checked against the table in jwell_bit_history.csv
    y, _ = planar.static_start(*planar.jwell())
    assert y[:2].T == pytest.approx(np.array(REST), abs=1e-8)


def test_jwell_string_rests_where_an_independent_solution_has_every_lump():
    depth, offset = np.array(REST).T
    balance = Balance(shipped("jwell"))
    assert balance["measured_depth"][1:] == pytest.approx(depth, abs=1e-6)
    assert balance["lateral_displacement"][1:, 0] == pytest.approx(offset, abs=1e-6)
    assert np.abs(balance["lateral_displacement"][:, 1]).max() < 1e-9


def test_jwell_bit_hangs_1_64_m_past_the_end_of_the_hole():
    # elastic stretch (docs/lumped_string.md)
    assert Balance(shipped("jwell"))["bit_depth"] - 3770.796327 == pytest.approx(1.64, abs=0.005)


def test_jwell_statics_converge_as_the_lumps_are_refined_to_200():
    # the bit to 0.2 mm; the effective tension in the top link plus half the link is the weight of the string hung below
    bits, loads = [], []
    for n in (50, 100, 200):
        balance = Balance(shipped("jwell", model__elements=n, model__bending="soft"))
        weight = (7850.0 - MUD) * 9.81 * area(0.127, 0.1086) * balance.model.coordinates["link_length"][1][0] / 2
        bits.append(balance["bit_depth"])
        loads.append(balance["tension"][0] + weight)
    assert abs(bits[2] - bits[1]) < 2e-4
    assert abs(loads[2] / loads[1] - 1) < 2e-4
    # frictionless soft string (exact): weight times vertical extent, less what the stretch of 1.65 m carries into the
    # curve: the arc's string turns by 1.65 mrad, w R per radian for the pipe plus (w_bha - w_pipe) 240 m (sin near 1)
    pipe, bha = ((7850.0 - MUD) * 9.81 * area(*tube) for tube in ((0.127, 0.1086), (0.165, 0.0572)))
    exact = pipe * (2200.0 + 1000.0) + (bha - pipe) * 1000.0 * (1 - np.cos(0.24))
    lost = 1.652e-3 * (pipe * 1000.0 + (bha - pipe) * 1000.0 * np.sin(0.24))
    assert loads[2] == pytest.approx(exact - lost, rel=2e-4)


def test_bending_energy_of_the_string_laid_in_the_arc_is_half_ei_over_r_squared():
    # sum of EI L / (2 R^2) over pipe and BHA in the arc of R = 1000 m, without the half link at the bit, which ends in
    # no joint; n = 200; within 2 %, because the free end lifts off the wall and straightens
    energy, brief = {}, {"solver__end": 1e-3, "output__interval": 1e-3}
    for bending in ("stiff", "soft"):
        model = build(shipped("jwell", model__elements=200, model__bending=bending, top__block=0.0, **brief))
        energy[bending] = simulate(model)["strain_energy"][0]
    ei = [200e9 * np.pi / 64 * (od**4 - bore**4) for od, bore in ((0.127, 0.1086), (0.165, 0.0572))]
    half = model.coordinates["link_length"][1][-1] / 2
    exact = (ei[0] * (500 * np.pi - 240.0) + ei[1] * (240.0 - half)) / 2e6
    assert energy["stiff"] - energy["soft"] == pytest.approx(exact, rel=0.02)


def test_without_bending_the_jwell_string_rests_as_a_soft_one():
    # EI = 1.2 MN m^2 over links of 300 m: a part in a million of the tension's effect
    soft, none = (Balance(shipped("jwell", model__bending=b)) for b in ("soft", "none"))
    assert soft["tension"] == pytest.approx(none["tension"], rel=1e-6)
    assert soft["bit_depth"] == pytest.approx(none["bit_depth"], abs=1e-6)


@pytest.mark.parametrize(
    ("mud", "load"),
    [
        (None, 1.0),
        ({"density": 1840.0}, 1 - 1840.0 / 7850.0),
        ({"density": 1840.0, "inside_density": 1000.0}, "tube"),
    ],
)
def test_a_vertical_string_hangs_in_its_buoyed_weight(mud, load):
    # closed form: the same mud inside and out takes rho_m/rho_s; else w = rho_s A + rho_i A_i - rho_o A_o
    changes = {} if mud is None else {"mud": mud | {"drag": 0.0}}
    balance = Balance(straight_hole(0.0, elements=5, **changes))
    if load == "tube":
        bore, outer = np.pi / 4 * 0.0572**2, np.pi / 4 * 0.165**2
        load = 1 + (1000.0 * bore - 1840.0 * outer) / mass_per_length()
    weight = mass_per_length() * 9.81 * 100.0 * load
    # the top link carries all but the half element that belongs to the top lump
    assert balance["tension"][0] == pytest.approx(0.9 * weight, rel=1e-9)


def test_the_statics_scenes_are_those_of_the_thesis():
    for name in ("hanging", "configuration_a", "configuration_b", "configuration_c"):
        assert (DATA / f"{name}.yaml").exists()
