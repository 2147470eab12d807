"""Single masses and bars in the thesis' syntax, and what a step of a method does to an oscillation, in closed form.

A mass of one kilogram on a straight spring without mass moves along x alone, which is linear to the last digit where
the strain is the engineer's: x.. + 2 zeta omega x. + omega^2 x = 0.
"""

import math
from pathlib import Path

import numpy as np

from tautline.cable.application import Cable
from tautline.cable.input.scene import parse
from tautline.cable.model.build import build
from tautline.simulation import simulate
from tautline.study.trials.trial import Setting, Subject

OMEGA, START = 10.0, 0.01
"""Angular frequency, rad/s, and displacement at t = 0, m, of the oscillator unless a test says else."""
LIMIT, REAL_LIMIT = 2.0 * 2.0**0.5, 2.785293563405282
"""How far RK4's region of stability reaches: |R(iy)|^2 = 1 - y^6/72 + y^8/576 is one at 2 sqrt 2, and on the real axis
R(x) = 1 + x + x^2/2 + x^3/6 + x^4/24 is one at 0 and at -2.7853 (root of x^3/24 + x^2/6 + x/2 + 1)."""
IMPLICIT = {"type": "G-alpha", "rho_inf": 0.8, "time_step": 0.01, "time_end": 5.0, "plotpoints": 25}
ALONG_X = (0, 1, 1, 1)
"""BC of a node of linear elements that moves along x only."""


# scenes
def text_of(items, gravity=(0, 0, 0), **solver):
    """Text of a scene; the solver is generalized-alpha as in `IMPLICIT`, but for what is given."""
    settings = {key: value for key, value in (IMPLICIT | solver).items() if value is not None}
    written = ", ".join(f"{key}: {value}" for key, value in settings.items())
    listed = "".join(f"  - {item}\n" for item in items)
    return f"CableModelMaterial: {{Gravity: {list(gravity)}}}\nCableModel:\n{listed}GeneralizedAlpha: {{{written}}}\n"


def rk4(**solver):
    """Settings of a scene that RK4 runs."""
    return {"type": "RK4", "rho_inf": None, "time_step": 0.001} | solver


def node(number, x, p, BC=ALONG_X):
    return f"Node4Dof: {{id: {number}, xyz: [{x}, 0, 0], BC: {list(BC)}, p: {p}}}"


def spring(number, nodes, EA, damping=0.0, **more):
    """A massless linear element: of one metre it has the stiffness EA and the damping coefficient EA cDamp."""
    further = "".join(f", {key}: {value}" for key, value in more.items())
    kept = f"EA: {EA}, EJ: 0, rhoA: 0, cDamp: {damping}, strain: engineering"
    return f"CableALEelementLin: {{id: {number}, nodes4: {list(nodes)}, {kept}{further}}}"


def oscillator(omega=OMEGA, start=START, zeta=0.0, items=(), **solver):
    """Text of one mass of 1 kg on one spring, let go at ``start`` m from where it rests; more items may be added."""
    held = node(0, 0.0, 0.0, (1, 1, 1, 1))
    parts = [held, node(1, 1.0 + start, 1.0), spring(0, (0, 1), omega**2, 2.0 * zeta / omega)]
    return text_of([*parts, "PointMass: {id: 0, nodes4: [1], mass: 1.0}", *items], **solver)


def chain(stiffness=100.0, first=0.01, tie="LagMultipl4", more="", **solver):
    """Text of two masses of 1 kg that a tie makes one, on a spring: omega^2 = stiffness / 2."""
    beside = "".join(node_item + "\n  - " for node_item in (node(0, 0.0, 0.0, (1, 1, 1, 1)), node(1, 1.0 + first, 1.0)))
    # The second mass hangs on a spring of its own from the other side, with nothing to pull.
    parts = [
        beside + node(2, 1.0 + first, 0.0), node(3, 2.0 + first, 1.0),
        spring(0, (0, 1), stiffness), spring(1, (2, 3), stiffness),
        f"{tie}: {{id: 0, nodes4: [1, 2], constr: 0{more}}}",
        "PointMass: {id: 0, nodes4: [1, 2, 3], mass: 1.0}",
    ]  # fmt: skip
    return text_of(parts, **solver)


def bar(count=1, ends=("pinned", "free"), EA=1.0, length=1.0, bends=False, kind="cubic", start=0.0, **solver):
    """Text of a bar of equal elements along x, 1 kg/m, that only stretches; at t = 0 by ``start`` of its length.

    Bending stiffness, if it has any, is tiny: it only makes elements take Lobatto points for their axial force.
    """
    items = []
    for i in range(count + 1):
        end = ends[0] if i == 0 else ends[1] if i == count else "free"
        hold = 1 if end == "pinned" else 0
        x, p = length * i / count * (1.0 + start), length * i / count
        if kind == "cubic":
            BC = [hold, 1, 1, 0, 1, 1, 1]
            items.append(f"Node7Dof: {{id: {i}, xyz: [{x}, 0, 0], xyz_d: [{1.0 + start}, 0, 0], BC: {BC}, p: {p}}}")
        else:
            items.append(node(i, x, p, (hold, 1, 1, 1)))
    key, nodes = ("CableALEelement", "nodes7") if kind == "cubic" else ("CableALEelementLin", "nodes4")
    material = f"EA: {EA}, EJ: {1e-12 if bends else 0}, rhoA: 1.0, cDamp: 0"
    items += [f"{key}: {{id: {i}, {nodes}: [{i}, {i + 1}], {material}}}" for i in range(count)]
    return text_of(items, **solver)


# what to do with them
def subject(text, **more):
    """The scene under study."""
    return Subject(Cable(), parse(text), **more)


def run(text, **more):
    """Result of a scene."""
    return simulate(build(parse(text)), **more)


def trial(text, **setting):
    """A run of a scene with a setting."""
    return subject(text).run(Setting(**setting))


def written(text, folder, name="scene.yaml"):
    """The scene as a file."""
    path = Path(folder) / name
    path.write_text(text, encoding="utf8")
    return path


# what to expect of a step, derived apart: Chung and Hulbert (1993) for x.. + omega^2 x = 0
def alphas_of(rho):
    """alpha_m and alpha_f of a spectral radius at infinity, their eqs 25."""
    return (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)


def amplification(turn, rho=None):
    """Matrix that takes (x, h v, h^2 a) over a step with omega h = ``turn``; without rho the average acceleration.

    From x1 = x0 + v0 + (1/2 - beta) a0 + beta a1, v1 = v0 + (1 - gamma) a0 + gamma a1 and
    (1 - alpha_m) a1 + alpha_m a0 + turn^2 ((1 - alpha_f) x1 + alpha_f x0) = 0.
    """
    alpha_m, alpha_f = (0.0, 0.0) if rho is None else alphas_of(rho)
    gamma = 0.5 - alpha_m + alpha_f
    beta = (0.5 + gamma) ** 2 / 4.0
    new = np.array([[1, 0, -beta], [0, 1, -gamma], [turn**2 * (1 - alpha_f), 0, 1 - alpha_m]])
    old = np.array([[1, 1, 0.5 - beta], [0, 1, 1 - gamma], [-(turn**2) * alpha_f, 0, -alpha_m]])
    return np.linalg.solve(new, old)


def principal(turn, rho=None):
    """What a step multiplies the oscillation by: the eigenvalue that belongs to exp(i turn)."""
    found = np.linalg.eigvals(amplification(turn, rho))
    return complex(found[np.argmin(np.abs(found - np.exp(1j * turn)))])


def lag_constant(rho=None):
    """c of the lag c turn^3 of a step: the characteristic polynomial with exp(i (turn - c turn^3)) inserted.

    1/12 for the average acceleration and for rho 1; (11 rho^2 - 14 rho + 11) / (24 (1 + rho)^2) else.
    """
    return 1.0 / 12.0 if rho is None else (11 * rho**2 - 14 * rho + 11) / (24 * (1 + rho) ** 2)


def decay_constant(rho):
    """d of the decay exp(-d turn^4) of an amplitude in a step, from the next power of the same series."""
    return ((1 - rho) / (1 + rho)) ** 3 / 2


def rk4_factor(z):
    """What a step of RK4 multiplies exp(lambda t) by, z = h lambda: the exponential series cut off after z^4."""
    return sum(z**k / math.factorial(k) for k in range(5))
