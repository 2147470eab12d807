"""Friction of a string that slides in a given direction: torque and drag without a motion.

A string that is pulled, lowered or turned slowly slips at every contact, and friction is all of Coulomb's, against the
slip: ``lambda = mu N d`` with a direction d that is known beforehand. At rest no slip velocity tells it, so the other
laws of friction.py give no force there, and this one does. N and lambda are found together: friction changes the
tension, the tension the side force. In a string that turns, friction around the hole pushes the pipe up the wall, until
N is the side force over sqrt(1 + mu^2).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.kernels.jit import kernel

SLIDING = np.dtype([(name, np.float64) for name in ("factor", "along", "around")])
"""Sliding friction at a contact: friction factor, and the unit direction of the friction force on the pipe, along the
hole (positive downhole) and around it (positive clockwise, looking downhole)."""


class Sliding(NamedTuple):
    """Friction in a given direction: ``rows`` (n,) of ``SLIDING``, which may be changed between two solutions."""

    rows: np.recarray


@kernel
def prepare_sliding(law, i, h, beta, gamma, touch, along_rate, around_rate):
    """Nothing depends on the step."""
    return


@kernel
def status_sliding(law, i, touch, converged):
    """The contact always slips."""
    return 0


@kernel
def act_sliding(law, i, touch):
    """Force mu N d, N; of its derivatives only that with respect to N is not zero."""
    f = law.rows[i]
    x, y = f.factor * f.along, f.factor * f.around
    return x * touch.normal, y * touch.normal, 0.0, 0.0, 0.0, 0.0, x, y


@kernel
def commit_sliding(law, i, touch):
    """Nothing is remembered."""
    return


@kernel
def force_sliding(law, i, touch):
    """The force of the accepted state, N."""
    f = law.rows[i]
    return f.factor * f.along * touch.normal, f.factor * f.around * touch.normal
