"""Sobol' indices: which share of the variance of a result each parameter causes, by SALib."""

from __future__ import annotations

import numpy as np

from tautline.results.errors import ResultError
from tautline.sweeps.plans import Cases
from tautline.sweeps.table import TIMES, Column, Variables

PARAMETER = "parameter"
RESAMPLES, CONFIDENCE = 200, 0.95
"""Resamples of the confidence interval, and its probability."""


def sobol_indices(data: Variables, cases: Cases) -> Variables:
    """First-order and total indices of every number that was collected.

    Samples of which one case has failed are left out as a whole, for the indices compare the cases of a sample.

    Returns
    -------
    Variables
        ``NAME_first``, ``NAME_total`` and the half widths of their 95 % intervals, along ``parameter``.

    Raises
    ------
    ResultError
        If SALib is not installed.
    """
    try:
        from SALib.analyze import sobol
    except ImportError:
        cure = "install it: pip install 'tautline[cluster]'"
        raise ResultError("indices", "needs SALib, which is not installed", cure) from None
    keys = [one.key for one in cases.parameters]
    problem = {"num_vars": len(keys), "names": keys, "bounds": [[0.0, 1.0]] * len(keys)}
    entries: dict[str, Column] = {}
    for name, one in data.data_vars.items():
        if one.dims != cases.dims or one.values.dtype.kind != "f" or name in TIMES:
            continue
        samples = one.values.reshape(-1, len(keys) + 2)
        samples = samples[np.isfinite(samples).all(axis=1)]
        if len(samples) < 2 or not np.ptp(samples) > 0.0:
            continue
        found = sobol.analyze(
            problem, samples.ravel(), calc_second_order=False, num_resamples=RESAMPLES, conf_level=CONFIDENCE,
            seed=cases.plan.seed,
        )  # fmt: skip
        what = {"S1": ("first", "first-order index"), "ST": ("total", "total index")}
        for letter, (word, text) in what.items():
            about = {"units": "", "long_name": f"{text} of {one.attrs.get('long_name', name)}"}
            entries[f"{name}_{word}"] = Column((PARAMETER,), np.asarray(found[letter], float), about)
            half = {"units": "", "long_name": f"half width of the 95 % interval of {name}_{word}"}
            entries[f"{name}_{word}_interval"] = Column((PARAMETER,), np.asarray(found[f"{letter}_conf"], float), half)
    return Variables(entries, {PARAMETER: Column((PARAMETER,), np.array(keys, object), {})}, {})
