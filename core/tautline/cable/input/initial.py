"""The value with which a function of time begins."""

from __future__ import annotations

from typing import Any

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
    import numpy as np

    from tautline.kernels.time_function import sample
    from tautline.system.time_functions import FunctionRequest, compile_functions

    return float(sample(compile_functions([FunctionRequest(function)]), 0, np.zeros(1))[0, 0])
