"""Material that runs through taut elements faster than waves along them: how short waves grow, and who tells of it.

The reference is a closed ring of rope in which N = |r'| rhoA v^2 at any speed: nothing acts on it, so that it keeps its
energy whatever the mesh does. How fast waves grow is found from the polynomials of the elements on an endless chain.
"""

import numpy as np
import pytest
from rope_text import element, node, scene
from scipy.optimize import brentq

import tautline
from tautline.cable import short_waves
from tautline.cable.application import Cable
from tautline.cable.input.scene import parse
from tautline.cable.short_waves import curves_of, growth, may_be_overtaken
from tautline.cable.warnings import fast_material

EA, SPEED = 2000.0, 6.0
"""Stiffness, N, and speed of waves, m/s, of a ring of 1 kg/m and 1 m radius."""


def ring(factor=1.3, n=32, linear=False, EJ=0.0, extra="", end=0.2):
    """A ring that runs at its waves' speed; p of its nodes goes from that to `factor` times it in 0.1 s."""
    stretch = brentq(lambda x: EA * (x * x - 1.0) / 2.0 - SPEED**2, 1.0, 2.0)
    # Linear elements are chords: what they are stretched by is shorter.
    total = float(2.0 * n * np.sin(np.pi / n) if linear else 2.0 * np.pi) / stretch
    items, held = "", (0, 0, 0, 1) if linear else (0, 0, 0, 0, 0, 0, 1)
    for i in range(n + 1):
        angle, p = 2.0 * np.pi * (i % n) / n, total * i / n
        slope = None if linear else [-stretch * np.sin(angle), 0.0, stretch * np.cos(angle)]
        follows = [0] * (len(held) - 1) + [i + 1]
        items += node(i, [np.cos(angle), 0.0, np.sin(angle)], slope, held, p, follows)
        speeds = f"timeList: [0, 0.1], velocityList: [{SPEED}, {SPEED * factor}]"
        items += f"  - Function_VelocityDefined: {{id: {i + 1}, pos0: {p!r}, {speeds}}}\n"
    for i in range(n):
        items += element(i, i, i + 1, EA, EJ, linear=linear, extra=extra)
    for d in range(1, 4 if linear else 7):
        joined = f"sNode: {n}, sDof: {d}, f0: 0, masters: [{{mNode: 0, mDof: {d}, factor: 1}}]"
        items += f"  - LinearCoupl: {{id: {d}, {joined}}}\n"
    return scene(items, (0.0, 0.0, 0.0), time_step=2.5e-4, time_end=end, plotpoints=200, rho_inf=0.9)


def told(texts):
    return [str(text) for text in texts if "faster than waves" in str(text)]


def checked(text):
    return told(Cable().warnings(parse(text)))


@pytest.mark.parametrize("linear", [False, True])
def test_check_and_run_tell_of_material_faster_than_waves(linear):
    # Elements without curvature start a true wave less exactly, but grow more slowly.
    text = ring(linear=linear, end=0.4 if linear else 0.2)
    result = tautline.simulate(text)
    assert abs(result["external_work"][-1]) > 1.0  # J, of which a true ring takes none
    (run,), (check,) = told(result.warnings), checked(text)
    assert "7.8 m/s" in run and "7.8 m/s" in check
    assert "EJ = " in run and ("lobatto" in run) != linear


def test_nothing_is_told_below_the_speed_of_waves():
    text = ring(0.95)
    result = tautline.simulate(text)
    assert abs(result["external_work"][-1]) < 1.0e-6
    assert not told(result.warnings) and not checked(text)


def test_what_is_told_to_do_keeps_the_energy():
    (text,) = told(tautline.simulate(ring()).warnings)
    stiff = float(text.split("EJ = ")[1].split()[0])
    for cured in ({"EJ": stiff}, {"extra": ", quadrature: lobatto"}):
        result = tautline.simulate(ring(**cured))
        assert abs(result["external_work"][-1]) < 2.0e-2
        assert not told(result.warnings) and not checked(ring(**cured))


def test_slack_and_slow_ropes_are_told_nothing():
    curve = curves_of(parse(ring(n=3)), range(4))[0]
    speed, tension = np.array([7.0, 7.0, 5.0, 0.0]), np.array([0.0, 1.0e-3, 36.0, 36.0])
    assert not growth(curve, speed, tension, np.full(4, 0.1)).any()


def straight(speeds, n=8, gravity=0.0, tension=36.0):
    """10 m of straight rope of 1 kg/m, bowed by 1 um at its middle; p of all nodes runs at `speeds` at 0 and 0.05 s."""
    stretch, items = float(np.sqrt(1.0 + 2.0 * tension / EA)), ""
    for i in range(n + 1):
        x, held = 10.0 * i / n, [1, 1, 1, 0, 0, 0, 1] if i in (0, n) else [0] * 6 + [1]
        items += node(i, [x, 0, 1e-6 if i == n // 2 else 0], [stretch, 0, 0], held, x / stretch, [0] * 6 + [i + 1])
        rates = f"timeList: [0, 0.05], velocityList: {list(speeds)}"
        items += f"  - Function_VelocityDefined: {{id: {i + 1}, pos0: {x / stretch!r}, {rates}}}\n"
    for i in range(n):
        items += element(i, i, i + 1, EA)
    return scene(items, (0.0, 0.0, -gravity), time_step=1e-4, time_end=0.05, plotpoints=20, rho_inf=0.9)


@pytest.mark.parametrize("speed", [59.0, 61.0, 100.0])
def test_material_is_told_of_however_much_faster_than_waves_it_is(speed):
    text = straight((speed, speed))
    result = tautline.simulate(text)
    # A true rope keeps the micrometre of its bow.
    assert np.abs(np.asarray(result["position"])[-1, :, 2]).max() > 1.0e-4
    (run,), (check,) = told(result.warnings), checked(text)
    assert f"{speed:.4g} m/s against 6 m/s" in run and f"{speed:.4g} m/s against 6 m/s" in check


def test_the_time_told_ends_when_material_is_slow_again_and_not_when_it_is_fastest():
    (text,) = checked(straight((0.0, 200.0)))
    assert "to 0.05 s" in text and "200 m/s against 6 m/s" in text


def test_an_element_with_less_tension_than_weight_is_slack():
    curve = curves_of(parse(straight((7.0, 7.0), gravity=9.81)), range(9))[0]
    speed, length, weight = np.full(2, 7.0), np.full(2, 0.5), 0.5 * 9.81
    assert (growth(curve, speed, np.array([0.99, 1.01]) * weight, length) > 0.0).tolist() == [False, True]


def test_a_run_with_slow_material_is_not_looked_through(monkeypatch):
    """Neither too slow for the slowest wave of a taut rope nor too slow to make any wave grow in time."""
    curve = curves_of(parse(straight((7.0, 7.0), gravity=9.81)), range(9))[0]
    slow, fast = 0.99 * np.sqrt(9.81 * 0.5), 1.01 * np.sqrt(9.81 * 0.5)
    asked = [(slow, 100.0), (fast, 100.0), (fast, 0.2)]
    assert [may_be_overtaken(curve, np.array([0.0, end]), speed, 0.5) for speed, end in asked] == [False, True, False]
    seen = []
    monkeypatch.setattr(short_waves, "growth", lambda *asked: seen.append(asked))
    tautline.simulate(straight((0.01, 0.01)))
    assert not seen


def test_check_asks_nothing_of_a_line_of_which_one_end_is_driven(monkeypatch):
    held = "BC: [1, 1, 1, 0, 0, 0, 1]"
    text = scene(
        f"""  - Node7Dof: {{id: 0, xyz: [0, 0, 0], {held}}}
  - Node7Dof: {{id: 1, xyz: [10, 0, 0], {held}, BC_functions: [0, 0, 0, 0, 0, 0, 1]}}
  - CableLine: {{id: 0, nodes7: [0, 1], elements: 100, length: 10.1, EA: 1.0e5, EJ: 0, rhoA: 1}}
  - Function: {{id: 1, value: {{ramp: {{from: 10.1, to: 10.09, over: 1}}}}}}
"""
    )
    parsed, asked = parse(text), []
    monkeypatch.setattr(fast_material, "known_by", lambda scene: asked.append(scene))
    assert not list(fast_material._fast_material(parsed)) and not asked


def unit_matrices(kind):
    """M, C, E, K (by its own quadrature) and B of an element of unit length, from its polynomials."""
    if kind == "linear":
        shapes = [np.polynomial.Polynomial(c) for c in ([1, -1], [0, 1])]
    else:
        shapes = [np.polynomial.Polynomial(c) for c in ([1, 0, -3, 2], [0, 1, -2, 1], [0, 0, 3, -2], [0, 0, -1, 1])]

    def over(i, j):
        return np.array([[(a.deriv(i) * b.deriv(j)).integ()(1.0) for b in shapes] for a in shapes])

    simpson = sum(
        w * np.outer([a.deriv()(x) for a in shapes], [a.deriv()(x) for a in shapes])
        for x, w in ((0.0, 1 / 6), (0.5, 2 / 3), (1.0, 1 / 6))
    )
    return over(0, 0), over(0, 1), over(1, 1), simpson if kind == "lobatto" else over(1, 1), over(2, 2)


def fastest(kind, ratio, bending=0.0):
    """Largest real part of the exponents of Bloch waves, with c = L = 1."""
    made, most = unit_matrices(kind), 0.0
    for phase in np.linspace(1.0e-4, np.pi, 400):
        half = len(made[0]) // 2
        joined = np.vstack([np.eye(half), np.exp(1j * phase) * np.eye(half)])
        m, c, e, k, b = (joined.conj().T @ each @ joined for each in made)
        stiff = k + bending * b - ratio**2 * e
        whole = np.block(
            [[np.zeros_like(m), np.eye(half)], [-np.linalg.solve(m, stiff), np.linalg.solve(m, 2.0 * ratio * c)]]
        )
        most = max(most, np.linalg.eigvals(whole).real.max())
    return most


@pytest.mark.parametrize(
    ("kind", "ratio", "bending"),
    [
        ("linear", 1.3, 0.0), ("gauss", 1.05, 0.0), ("gauss", 2.0, 0.0), ("gauss", 0.99, 0.0), ("lobatto", 1.05, 0.0),
        ("lobatto", 1.3, 0.0), ("lobatto", 2.0, 0.0), ("lobatto", 3.0, 0.03), ("lobatto", 5.0, 0.1),
    ],
)  # fmt: skip
def test_short_waves_grow_as_bloch_waves_of_the_elements_do(kind, ratio, bending):
    length, wave = 0.2, 6.0
    tension = wave**2
    extra = "" if kind == "linear" else f", quadrature: {kind}"
    text = ring(n=3, linear=kind == "linear", EJ=bending * tension * length**2, extra=extra)
    curve = curves_of(parse(text), range(4))[0]
    one = np.ones(1)
    found = growth(curve, ratio * wave * one, tension * one, length * one)[0] * length / wave
    assert found == pytest.approx(fastest(kind, ratio, bending), rel=0.02, abs=2e-3)
