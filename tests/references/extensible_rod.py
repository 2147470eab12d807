"""Exact statics of the thesis' horizontal configurations A, B, C and of its hanging string (section 2.9.4, Table 2.3).

Geometrically exact extensible Euler-Bernoulli rod (extensible elastica; e.g. Antman, Nonlinear Problems of
Elasticity, ch. 4) in the unstretched arc length S from the pinned end, x along the rod, y up, theta = slope:

    x' = (1 + e) cos(theta),  y' = (1 + e) sin(theta),  theta' = M/EI,  M' = (1 + e)(H sin(theta) - V cos(theta)),
    V' = w,  e = (H cos(theta) + V sin(theta))/EA,  H = the end force (constant),  w = rho A g
    x = y = M = 0 at S = 0;  y = M = 0 at S = L;  all continuous at the change from pipe (880 m) to collar (120 m).

The end at S = L moves freely in x under the force H.  SI units.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.integrate import solve_bvp
from scipy.optimize import minimize_scalar

SECTIONS = ((880.0, 0.127, 0.1086), (120.0, 0.165, 0.0572))  # length, od, id from the pinned end or the top
E, DENSITY, GRAVITY = 200e9, 7850.0, 9.81
TABLE_I = (0.0594e-4, 0.3595e-4)  # second moments as printed in Table 2.3; OD and ID give 0.0594189e-4 and 0.358581e-4
OD_ID_I = tuple(np.pi / 64 * (od**4 - bore**4) for _, od, bore in SECTIONS)
CASES = {"A": (9.81e-6, 0.0), "B": (9.81e-4, 0.0), "C": (9.81, 1.5e6)}  # gravity [m/s^2], end force [N]


def area(od, bore):
    """Cross-section of steel [m^2]."""
    return np.pi / 4 * (od**2 - bore**2)


@dataclass
class Shape:
    """A solution: y(S), x(S) as a callable, largest sag and where, x displacement of the free end, residual."""

    at: callable
    sag: float
    sag_at: float
    end_displacement: float
    residual: float


@lru_cache
def solve(case, second_moments=TABLE_I, tol=1e-8):
    """Shape of configuration 'A', 'B' or 'C' with the second moments of pipe and collar [m^4]."""
    gravity, force = CASES[case]
    length = np.array([s[0] for s in SECTIONS])
    a = np.array([area(*s[1:]) for s in SECTIONS])
    ei = E * np.array(second_moments)
    total = length.sum()
    w = DENSITY * a * gravity
    shear = w @ length  # scales: length `total`, force `shear`, moment shear*total/10
    couple = shear * total / (1000 if force else 10)

    def section(j, z, part):
        _, _, theta, m, v = z
        weight, h = part * w[j] / shear, part * force / shear
        stretch = 1 + shear * (h * np.cos(theta) + v * np.sin(theta)) / (E * a[j])
        d = np.array(
            [
                stretch * np.cos(theta),
                stretch * np.sin(theta),
                m * couple * total / ei[j],
                stretch * (h * np.sin(theta) - v * np.cos(theta)) * shear * total / couple,
                np.full_like(theta, weight * total),
            ]
        )
        return d * length[j] / total

    def boundary(p, q):
        return np.concatenate([[p[0], p[1], p[3]], q[:5] - p[5:], [q[6], q[8]]])

    mesh = 0.5 * (1 - np.cos(np.pi * np.linspace(0, 1, 401)))
    s = np.concatenate([[mesh * length[0]], [length[0] + mesh * length[1]]]) / total
    z = np.zeros((10, mesh.size))
    z[0], z[5] = s
    z[4], z[9] = s - 0.5
    for part in (0.05, 0.2, 0.5, 1.0) if not force else (0.02, 0.1, 0.3, 1.0):
        run = solve_bvp(
            lambda _, z, part=part: np.vstack([section(0, z[:5], part), section(1, z[5:], part)]),
            boundary,
            mesh,
            z,
            tol=tol if part == 1.0 else 1e-4,
            max_nodes=200000,
        )
        if not run.success:
            raise RuntimeError(f"{case}: {run.message}")
        mesh, z = run.x, run.y

    def at(where):
        j = int(where > length[0])
        return run.sol((where - j * length[0]) / length[j])[5 * j : 5 * j + 2] * total

    best = minimize_scalar(lambda x: at(x)[1], bounds=(300.0, 700.0), method="bounded", options={"xatol": 1e-6})
    return Shape(at, best.fun, best.x, z[5, -1] * total - total, run.rms_residuals.max())


def hanging_elongation():
    """Elongation of the string hanging by its top in its dry weight [m]: sum of (W_below + w L/2) L/EA."""
    below = total = 0.0
    for length, od, bore in reversed(SECTIONS):
        w, ea = DENSITY * area(od, bore) * GRAVITY, E * area(od, bore)
        total += (below + w * length / 2) * length / ea
        below += w * length
    return total
