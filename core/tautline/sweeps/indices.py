"""Sobol' indices: which share of the variance of a result each parameter causes, by SALib."""

from __future__ import annotations

import numpy as np

from tautline.results.errors import ResultError
from tautline.results.tables.netcdf import Column
from tautline.sweeps.plans import LEFT, Cases
from tautline.sweeps.table import TIMES, Variables

PARAMETER = "parameter"
MADE = "samples_made"
"""Attribute of the number of samples of which a result has its indices: those of the plan."""
RESAMPLES, CONFIDENCE = 200, 0.95
"""Resamples of the confidence interval, and its probability."""


def samples_left(data: Variables, name: str) -> tuple[int, int] | None:
    """Samples that are left for the indices of a result, and those of the plan; None of what has no indices."""
    one = data.data_vars.get(name + LEFT)
    return None if one is None or MADE not in one.attrs else (int(one.values), int(one.attrs[MADE]))


def has_indices(data: Variables, name: str) -> bool:
    """Whether a result has indices: one that is the same in all samples has none."""
    one = data.data_vars.get(f"{name}_first")
    return one is not None and one.dims == (PARAMETER,)


def sobol_indices(data: Variables, cases: Cases) -> Variables:
    """First-order and total indices of every number that was collected.

    Samples of which one case has failed are left out as a whole, for the indices compare the cases of a sample.

    Returns
    -------
    Variables
        ``NAME_first``, ``NAME_total`` and the half widths of their 95 % intervals, along ``parameter``. And
        ``NAME_indices_of``: the samples that are left, also where they are too few for indices, or all the same.

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
        made = len(samples)
        samples = samples[np.isfinite(samples).all(axis=1)]
        text = f"samples of which {name} has its indices: those without a case that failed or has no number"
        left = {"units": "", "long_name": text, MADE: str(made)}
        entries[name + LEFT] = Column((), np.array(len(samples)), left)
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
