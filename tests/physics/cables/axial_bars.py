"""Straight bars of cubic elements along x that only stretch: scenes, and what to ask of their motions."""

import numpy as np
from references import cables
from scipy.linalg import eigh
from scipy.optimize import least_squares

from tautline.cable.input.scene import parse
from tautline.cable.model.build import build
from tautline.integrators.linearise import start_moving
from tautline.integrators.method import METHODS
from tautline.integrators.state import new_state
from tautline.integrators.time_loop import new_frames, run_steps
from tautline.integrators.vibration.modes import modes
from tautline.simulation import simulate

BC = {"free": (0, 1, 1, 0, 1, 1, 1), "pinned": (1, 1, 1, 0, 1, 1, 1), "flowing": (1, 1, 1, 0, 1, 1, 0)}
"""What a node may do: move with its particle, do nothing, let material through. The slope r'x is always free."""


JOINTS = {"coupling": "LinearCoupl", "multiplier": "LagMultipl7", "augmented": "AugLagrange7", "penalty": "Penalty7"}
"""Ways to make two nodes one, and their keys."""


# scenes
def node(number, x, end, slope=1.0, p=0.0):
    """Item of a node at x [m] that does what `BC` says."""
    place = f"xyz: [{float(x)}, 0, 0], xyz_d: [{float(slope)}, 0, 0]"
    return f"Node7Dof: {{id: {number}, {place}, BC: {list(BC[end])}, p: {float(p)}}}"


def element(number, nodes, EA=1000.0, rhoA=1.0, strain="green"):
    """Item of an element that does not bend and loses nothing."""
    material = f"EA: {EA}, EJ: 0, rhoA: {rhoA}, cDamp: 0, strain: {strain}"
    return f"CableALEelement: {{id: {number}, nodes7: {list(nodes)}, {material}}}"


def coupling(number, slave, master, factor=1.0, f0=0.0):
    """Item that makes slave = f0 + factor master, each a (node, degree of freedom from 1)."""
    masters = f"[{{mNode: {master[0]}, mDof: {master[1]}, factor: {factor}}}]"
    return f"LinearCoupl: {{id: {number}, sNode: {slave[0]}, sDof: {slave[1]}, f0: {f0}, masters: {masters}}}"


def model_of(items, **solver):
    """Model of a scene without gravity; the solver is RK4 with steps of 0.1 ms to 1 s unless it says else."""
    settings = {"type": "RK4", "time_step": 1e-4, "time_end": 1.0} | solver
    written = ", ".join(f"{key}: {value}" for key, value in settings.items())
    listed = "".join(f"  - {item}\n" for item in items)
    heading = "CableModelMaterial: {Gravity: [0, 0, 0]}"
    return build(parse(f"{heading}\nCableModel:\n{listed}GeneralizedAlpha: {{{written}}}\n"))


def run(items, **solver):
    """Result of a scene; see `model_of`."""
    return simulate(model_of(items, **solver))


def bar(ends, slopes=None, positions=None, length=1.0, EA=1000.0, **more):
    """Items of a bar of equal elements.

    `ends` names what each node does (keys of `BC`); slopes and positions [m] are those of the nodes at t = 0, by
    default those of the bar at rest; `more` goes to the elements.
    """
    count = len(ends) - 1
    rest = np.linspace(0.0, length, count + 1)
    slopes = np.ones(count + 1) if slopes is None else slopes
    positions = rest if positions is None else positions
    nodes = [
        node(i, x, end, slope, p)
        for i, (end, x, slope, p) in enumerate(zip(ends, positions, slopes, rest, strict=True))
    ]
    return [*nodes, *(element(i, (i, i + 1), EA, **more) for i in range(count))]


def cantilever(count, **more):
    """Items of a bar that is pinned at x = 0."""
    return bar(["pinned"] + count * ["free"], **more)


def first_mode(count, springs=None):
    """First mode of a cantilever of `count` elements, EA = 1000 N, one metre, one kilogram, from `hermite_bar`.

    With `springs` (N/m and N m) the bar is two halves, its middle node doubled, that these join.

    Returns
    -------
    frequency [Hz], displacements and slopes of the nodes, scaled to one at the tip
    """
    if springs is None:
        stiffness, mass = cables.hermite_bar(count, 1000.0, 1.0, 1.0)
    else:
        stiffness, mass = (np.kron(np.eye(2), half) for half in cables.hermite_bar(count // 2, 1000.0, 1.0, 0.5))
        for left in (count, count + 1):
            joint = np.zeros(len(mass))
            joint[[left, left + 2]] = 1, -1
            stiffness += springs * np.outer(joint, joint)
    squares, shapes = eigh(stiffness[1:, 1:], mass[1:, 1:])
    shape = np.concatenate([[0.0], shapes[:, 0]]).reshape(-1, 2) / shapes[-2, 0]
    return np.sqrt(squares[0]) / (2 * np.pi), shape[:, 0], shape[:, 1]


def split_cantilever(count, way, stiffness, amplitude=0.0):
    """Items of the cantilever of `first_mode` whose middle node stands there twice, joined in one of `JOINTS`.

    The penalty springs have the stiffness given. It is at rest, displaced by its first mode times an amplitude [m].
    """
    half = count // 2
    p = np.insert(np.linspace(0.0, 1.0, count + 1), half, 0.5)
    _, u, slope = first_mode(count, stiffness if way == "penalty" else None)
    if way != "penalty":
        u, slope = (np.insert(part, half, part[half]) for part in (u, slope))
    nodes = [
        node(i, p[i] + amplitude * u[i], "free" if i else "pinned", 1 + amplitude * slope[i], p[i])
        for i in range(count + 2)
    ]
    elements = [element(i, (i, i + 1)) for i in range(count + 1) if i != half]
    if way == "coupling":
        joint = [coupling(dof, (half + 1, dof), (half, dof)) for dof in (1, 4)]
    else:
        spring = f", p_spring: {stiffness}" if way in ("penalty", "augmented") else ""
        pair = f"nodes7: [{half}, {half + 1}]"
        joint = [f"{JOINTS[way]}: {{id: {what}, {pair}, constr: {what}{spring}}}" for what in (0, 2)]
    return [*nodes, *elements, *joint]


def natural_frequencies(items):
    """Frequencies [Hz] of a scene as it stands, ascending."""
    model = model_of(items)
    return modes(model.system, new_state(model.system)).frequency


def march_unchecked(items, step, steps):
    """Run RK4 however long its step is; returns status, and of all steps made the positions and the energies [J]."""
    model = model_of(items, time_step=float(step), time_end=float(steps * step))
    method, state = METHODS["rk4"](model.system, model.solver), new_state(model.system)
    start_moving(model.system, state, step)
    frames = new_frames(steps + 1, model.system.q.size, model.own)
    ends, each = step * np.arange(steps + 1.0), np.minimum(np.arange(steps + 1), 1)
    status, made, _ = run_steps(method, model.system, state, ends, each, 0.0, frames)
    return status, frames.q[:made], frames.energy[:made, :2].sum(axis=1)


# what to expect of an integrator, and what to see in its results
def rk4_factor(y):
    """Growth per step of a vibration with omega h = y: the Taylor polynomial of order four."""
    z = 1j * y
    return 1 + z + z**2 / 2 + z**3 / 6 + z**4 / 24


def period_of(method, omega, step, alpha_m=0.0, alpha_f=0.0):
    """Period [s] with which a method makes a vibration of omega [rad/s].

    RK4 from its growth factor; the others from the matrix that takes (x, v, auxiliary acceleration) over one step of
    Arnold and Bruels' algorithm (2007) for x.. = -omega^2 x; Newmark's average acceleration has both alphas zero.
    """
    if method == "RK4":
        return 2 * np.pi * step / np.angle(rk4_factor(omega * step))
    gamma = 0.5 - alpha_m + alpha_f
    beta = (gamma + 0.5) ** 2 / 4
    new = [[1, 0, -(step**2) * beta], [0, 1, -step * gamma], [(1 - alpha_f) * omega**2, 0, 1 - alpha_m]]
    old = [[1, step, step**2 * (0.5 - beta)], [0, 1, step * (1 - gamma)], [-alpha_f * omega**2, 0, -alpha_m]]
    factors = np.linalg.eigvals(np.linalg.solve(new, old))
    principal = factors[np.argmin(np.abs(factors - np.exp(1j * omega * step)))]
    return 2 * np.pi * step / np.angle(principal)


def fitted_frequency(t, signal, guess):
    """Frequency [Hz] of the best fit A cos(w t) + B sin(w t) + C."""
    signal = signal / np.abs(signal).max()

    def miss(ratio):
        angle = 2 * np.pi * guess * ratio[0] * t
        waves = np.column_stack([np.cos(angle), np.sin(angle), np.ones_like(t)])
        return waves @ np.linalg.lstsq(waves, signal, rcond=None)[0] - signal

    return guess * least_squares(miss, [1.0], xtol=1e-15, ftol=1e-15, gtol=1e-15).x[0]


def highest_peaks(t, signal, count):
    """Frequencies [Hz], ascending, of the highest peaks of the spectrum under a Hann window."""
    spectrum = np.abs(np.fft.rfft((signal - signal.mean()) * np.hanning(signal.size)))
    inner = spectrum[1:-1]
    peaks = 1 + np.flatnonzero((inner > spectrum[:-2]) & (inner > spectrum[2:]))
    strongest = peaks[np.argsort(-spectrum[peaks])[:count]]
    return np.sort(np.fft.rfftfreq(signal.size, t[1] - t[0])[strongest])
