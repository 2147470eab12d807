"""The value, and the rate, with which a function of time begins."""

from __future__ import annotations

from typing import Any

import numpy as np

from tautline.cable.input.parts import Motion
from tautline.scene.functions import Chirp, Constant, Ramp, Sum


def initial_value(function: Any) -> float:
    """Value at t = 0 of a model of `tautline.scene.functions`; what is not plain is compiled and sampled."""
    if isinstance(function, Constant):
        return function.value
    if isinstance(function, Ramp) and function.at >= 0.0:
        return function.from_
    if isinstance(function, Chirp):
        return 0.0
    if isinstance(function, Sum):
        return sum(initial_value(term) for term in function.terms)
    return _sampled(function)[0]


def initial_rate(motion: Motion) -> float:
    """Rate at t = 0 of what a held degree of freedom follows, m/s."""
    if motion.function is not None:
        return 0.0 if isinstance(motion.function, Constant) else _sampled(motion.function)[1]
    if motion.rate is not None:
        return motion.factor * initial_value(motion.rate)
    return float(np.interp(0.0, motion.times, motion.velocities))


def _sampled(function: Any) -> tuple[float, float]:
    """Value and rate of a function at t = 0, as a run takes them."""
    from tautline.kernels.time_function import sample
    from tautline.system.time_functions import FunctionRequest, compile_functions

    value, rate, _ = sample(compile_functions([FunctionRequest(function)]), 0, np.zeros(1))[0]
    return float(value), float(rate)
