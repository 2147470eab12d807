"""Axial and torsional natural frequencies of a two-section string, fixed at the top and free at the bit: exact.

Section j: stiffness k_j (EA [N] or GJ [N m^2]), inertia per length i_j (rho A [kg/m] or rho J [kg m]), length L_j,
wave speed c_j = sqrt(k_j/i_j), impedance z_j = sqrt(k_j i_j).  With b_j = w L_j/c_j the free end and continuity of
displacement and force give (any text on waves in rods, e.g. Graff, Wave Motion in Elastic Solids, ch. 2)

    F(w) = z_1 cos b_1 cos b_2 - z_2 sin b_1 sin b_2 = 0.

No root is missed: with tan psi = (z_2/z_1) tan b_2, psi continued over the half turns, F = 0 is
b_1 + psi = (r - 1/2) pi; the left side grows strictly with w, so each r has exactly one root, and psi is within pi/2
of b_2, which brackets it.
SI units, frequencies in Hz.
"""

import numpy as np
from scipy.optimize import brentq

TABLE_2_3 = [(880.0, 0.127, 0.1086), (120.0, 0.165, 0.0572)]
JWELL = [(1960.0 + 500.0 * np.pi, 0.127, 0.1086), (240.0, 0.165, 0.0572)]
E, G, DENSITY, MUD = 200e9, 79e9, 7850.0, 1840.0


def frequencies(lengths, stiffness, inertia, count=5):
    """The first `count` natural frequencies [Hz] of a two-section string."""
    (l1, l2), k, i = lengths, np.asarray(stiffness, float), np.asarray(inertia, float)
    slowness, (z1, z2) = np.sqrt(i / k), np.sqrt(k * i)
    travel1, travel2 = l1 * slowness[0], l2 * slowness[1]

    def phase(w):
        b = w * travel2
        turns = np.round(b / np.pi)
        return w * travel1 + turns * np.pi + np.arctan2(z2 * np.sin(b - turns * np.pi), z1 * np.cos(b - turns * np.pi))

    roots = []
    for r in range(1, count + 1):
        target = (r - 0.5) * np.pi
        high = (target + np.pi / 2) / (travel1 + travel2)
        low = max(target - np.pi / 2, 0.0) / (travel1 + travel2)
        roots.append(brentq(lambda w, target=target: phase(w) - target, low, high, xtol=1e-15, rtol=1e-14))
    return np.array(roots) / (2 * np.pi)


def axial(string, count=5, added=(0.0, 0.0)):
    """Axial frequencies [Hz]; string: (length, od, id) twice from the top; added: mass moving along [kg/m]."""
    area = [np.pi / 4 * (od**2 - bore**2) for _, od, bore in string]
    mass = [DENSITY * a + m for a, m in zip(area, added, strict=True)]
    return frequencies([x[0] for x in string], [E * a for a in area], mass, count)


def torsional(string, count=5):
    """Torsional frequencies [Hz], J = pi/32 (od^4 - id^4)."""
    j = [np.pi / 32 * (od**4 - bore**4) for _, od, bore in string]
    return frequencies([x[0] for x in string], [G * x for x in j], [DENSITY * x for x in j], count)


def mud_inside(string):
    """Mass per length of the mud in the bore [kg/m], for an axial inertia that carries it along."""
    return [MUD * np.pi / 4 * bore**2 for _, _, bore in string]
