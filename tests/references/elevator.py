"""Two masses over one sheave that hangs on a roof spring, after the elevator of J. L. Escalona (reference [11] of the
thesis: Mechanism and Machine Theory 112 (2017) 1-21): frequencies, and the motion after a release.

Weightless elastic ropes of unstretched lengths L_1, L_2 from the masses to where the sheave holds the rope; Green's law
N = EA eps lambda.  Downwards positive: z_1, z_2 of the masses, y of the sheave; s = rim travel towards side 2.
The rope does not slip: material p = s/lambda_0 passes to side 2, lambda_0 a constant stretch.
Linear: T_i' = k_i (z_1 - y + s), k_2 (z_2 - y - s), k_i = EA (3 lambda_i^2 - 1)/(2 L_i).
`roof` is the spring's stiffness [N/m].
"""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import eigh, expm

from .crane import stretch_under, tangent_stiffness


@dataclass(frozen=True)
class Elevator:
    """Masses [kg], inertia [kg m^2], radius and lengths [m], roof and axial stiffness [N/m, N]."""

    mass_1: float = 1000.0
    mass_2: float = 1000.0
    length_1: float = 20.0
    length_2: float = 10.0
    sheave_mass: float = 200.0
    inertia: float = 12.0
    radius: float = 0.35
    roof: float = 2.0e6
    axial_stiffness: float = 1.0e7
    gravity: float = 9.81

    @property
    def stretches(self):
        """Stretch of either side at rest under its own mass."""
        weights = np.array([self.mass_1, self.mass_2]) * self.gravity
        return stretch_under(weights, self.axial_stiffness)

    @property
    def stiffnesses(self):
        """k_1, k_2 [N/m] at those stretches."""
        return tangent_stiffness(self.stretches, self.axial_stiffness) / np.array([self.length_1, self.length_2])

    def matrices(self):
        """Mass (diagonal, (4,)) and stiffness (4, 4) of (z_1, z_2, y, s)."""
        g = np.array([[1, 0, -1, 1], [0, 1, -1, -1]])  # rope extensions
        stiffness = g.T @ np.diag(self.stiffnesses) @ g
        stiffness[2, 2] += self.roof
        mass = np.array([self.mass_1, self.mass_2, self.sheave_mass, self.inertia / self.radius**2])
        return mass, stiffness

    def frequencies(self):
        """The four frequencies [Hz], ascending; the first is 0, the drift of the rope round the sheave."""
        mass, stiffness = self.matrices()
        scale = 1 / np.sqrt(mass)
        return np.sqrt(np.maximum(eigh(scale[:, None] * stiffness * scale)[0], 0)) / (2 * np.pi)

    def at_rest(self):
        """z_1, z_2, y [m] below the sheave's place with the roof spring unstretched, s = 0; the masses must balance."""
        lambdas = self.stretches
        y = (self.mass_1 + self.mass_2 + self.sheave_mass) * self.gravity / self.roof
        return np.array([y + self.length_1 * lambdas[0], y + self.length_2 * lambdas[1], y, 0.0])

    def released(self, times, offset, velocity=(0.0, 0.0, 0.0, 0.0)):
        """Small motion about rest by the matrix exponential: (z_1, z_2, y, s) - rest, (n, 4), from offset and velocity.

        Unequal masses: about the rest each side has on its own; the surplus weight then pulls as a constant force on s.
        """
        mass, stiffness = self.matrices()
        push = np.array([0, 0, 0, (self.mass_2 - self.mass_1) * self.gravity]) / mass
        generator = np.zeros((9, 9))
        generator[:4, 4:8], generator[4:8, :4], generator[4:8, 8] = np.eye(4), -stiffness / mass[:, None], push
        start = np.concatenate([offset, velocity, [1.0]])
        return np.array([(expm(generator * t) @ start)[:4] for t in times])

    def finite(self, times, offset, velocity=(0.0, 0.0, 0.0, 0.0), held=None):
        """The same motion with Green's law and the lengths as they change, to 1e-11; (n, 4) less rest, and the energy.

        V = (L_1 - p) W(lambda_1) + (L_2 + p) W(lambda_2), W = EA eps^2/2, p = s/held: the force on p is
        (N lambda - W) of side 2 less that of side 1, and the rim's inertia I held^2/R^2 on p.  `held`: the constant
        stretch of rope on the rim, lambda_0; None: the mean of both sides at rest.
        """
        held = self.stretches.mean() if held is None else held
        rest, EA, g = self.at_rest(), self.axial_stiffness, self.gravity
        mass = self.matrices()[0]
        lengths = np.array([self.length_1, self.length_2])

        def ropes(q):
            free = lengths + np.array([-1, 1]) * q[3] / held
            stretch = (q[:2] - q[2]) / free
            strain = (stretch**2 - 1) / 2
            return free, stretch, EA * strain, EA * strain**2 / 2

        def rate(_, y):
            _, stretch, stress, stored = ropes(y[:4])
            force, pull = stress * stretch, (stress * stretch**2 - stored) / held
            return np.append(
                y[4:],
                np.array(
                    [
                        mass[0] * g - force[0],
                        mass[1] * g - force[1],
                        mass[2] * g - self.roof * y[2] + force.sum(),
                        pull[1] - pull[0],
                    ]
                )
                / mass,
            )

        start = np.concatenate([rest + np.asarray(offset), velocity])
        done = solve_ivp(rate, (0, times[-1]), start, "DOP853", t_eval=times, rtol=1e-11, atol=1e-13)
        energy = []
        for y in done.y.T:
            free, _, _, stored = ropes(y[:4])
            energy.append(mass @ y[4:] ** 2 / 2 - g * mass[:3] @ y[:3] + self.roof * y[2] ** 2 / 2 + free @ stored)
        return SimpleNamespace(q=done.y[:4].T - rest, energy=np.array(energy))


def symmetric_frequencies(mass, stiffness, sheave_mass, inertia, radius, roof):
    """Equal masses on equal ropes k: closed form of the three frequencies that are not 0 [Hz].

    Together: m z'' = -k (z - y), m_s y'' = -roof y + 2 k (z - y), a quadratic in omega^2.  Against each other
    (y at rest): omega^2 = k/m + 2 k R^2/I.

    Returns
    -------
    array (3,) : the two of the masses moving together, ascending; the one against each other
    """
    b = stiffness / mass + (roof + 2 * stiffness) / sheave_mass
    c = stiffness * roof / (mass * sheave_mass)
    root = np.sqrt(b * b - 4 * c)
    squares = np.array([2 * c / (b + root), (b + root) / 2, stiffness / mass + 2 * stiffness * radius**2 / inertia])
    return np.sqrt(squares) / (2 * np.pi)


def spring_frequencies(mass_1, mass_2, stiffness_1, stiffness_2, sheave_mass, inertia, radius, roof):
    """The three frequencies that are not 0 [Hz], ascending: the roots of the cubic in omega^2 of `Elevator`.

    The rope extensions a = z_1 - y + s, b = z_2 - y - s and y have no zero mode; with J = I/R^2
    a'' = -k_1 a (1/m_1 + 1/J) + k_2 b/J - y'', b'' = k_1 a/J - k_2 b (1/m_2 + 1/J) - y'',
    m_s y'' = k_1 a + k_2 b - roof y.
    """
    J, k1, k2, ms = inertia / radius**2, stiffness_1, stiffness_2, sheave_mass
    a = np.array([k1 * (1 / mass_1 + 1 / J + 1 / ms), -k2 / J + k2 / ms, -roof / ms])
    b = np.array([-k1 / J + k1 / ms, k2 * (1 / mass_2 + 1 / J + 1 / ms), -roof / ms])
    y = np.array([-k1 / ms, -k2 / ms, roof / ms])
    matrix = np.array([a, b, y])
    minors = sum(matrix[i, i] * matrix[j, j] - matrix[i, j] * matrix[j, i] for i, j in ((0, 1), (0, 2), (1, 2)))
    squares = np.sort(np.roots([1, -np.trace(matrix), minors, -np.linalg.det(matrix)]).real)
    return np.sqrt(squares) / (2 * np.pi)


def stiff_rope_frequency(mass_1, mass_2, sheave_mass, inertia, radius, roof):
    """Inextensible rope: omega^2 = roof/(m_s + m_1 + m_2 - (m_2 - m_1)^2/(m_1 + m_2 + I/R^2)) [Hz].

    Travel x of the rope and y: T = m_1 (y' - x')^2/2 + m_2 (y' + x')^2/2 + m_s y'^2/2 + I x'^2/(2 R^2); x has no
    stiffness.  Without the sheave's mass and inertia the masses count 4 m_1 m_2/(m_1 + m_2).
    """
    total = mass_1 + mass_2
    moved = sheave_mass + total - (mass_2 - mass_1) ** 2 / (total + inertia / radius**2)
    return np.sqrt(roof / moved) / (2 * np.pi)


def frictionless_frequencies(mass_1, mass_2, stiffness, sheave_mass, roof):
    """Sheave without friction and inertia: one tension k q all along, q = z_1 + z_2 - 2 y, k = EA/(L_1 + L_2) [Hz].

    q'' = -k q (1/m_1 + 1/m_2) - 2 y'', m_s y'' = 2 k q - roof y; the two frequencies that are not 0, ascending.
    """
    b = stiffness * (1 / mass_1 + 1 / mass_2 + 4 / sheave_mass) + roof / sheave_mass
    c = stiffness * (1 / mass_1 + 1 / mass_2) * roof / sheave_mass
    root = np.sqrt(b * b - 4 * c)
    return np.sqrt([2 * c / (b + root), (b + root) / 2]) / (2 * np.pi)
