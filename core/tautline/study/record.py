"""A study as rows: for JSON, CSV and NetCDF."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tautline.results.tables.netcdf import write_dataset
from tautline.results.tables.rows import heads_of, write_rows

if TYPE_CHECKING:
    from tautline.study.accuracy.precision import Row, Study
    from tautline.study.robustness.stability import Stability
    from tautline.study.robustness.variants import Variant

UNITS = {
    "step": "s", "step_error": "m", "step_taken": "s", "rmse": "m",
    "cpu_time": "s", "wall_time": "s", "wall_time_spread": "s", "phase_error": "rad", "phase_lag": "rad",
}  # fmt: skip
"""Units of the columns that have one; the other errors are relative."""


def run_record(row: Row) -> dict[str, Any]:
    """Keys of one run; None where it has no number."""
    trial, setting, errors = row.trial, row.trial.setting, row.errors
    return {
        "method": setting.method or trial.attribute("method"),
        "step": trial.attribute("step") if trial.result is not None else setting.step,
        "step_error": setting.step_error,
        "step_taken": row.step_taken,
        "elements": setting.elements,
        "constraint": setting.constraint,
        "newton": setting.newton,
        "position_error": errors and errors.position,
        "force_error": errors and errors.force,
        "twist_error": errors and errors.twist,
        "phase_error": errors and errors.phase,
        "rmse": errors and errors.rmse,
        "cpu_time": trial.cpu_time,
        "wall_time": trial.wall_time,
        "wall_time_spread": max(trial.wall) - min(trial.wall) if trial.wall else None,
        "repetitions": len(trial.wall),
        "real_time_factor": row.factor,
        "steps": trial.attribute("steps"),
        "newton_iterations": trial.attribute("newton_iterations"),
        "status": trial.status,
        "sentence": trial.sentence,
    }


def study_record(study: Study) -> dict[str, Any]:
    """Keys of ``study --json``."""
    found = study.reference
    reference = None
    if found is not None:
        reference = {
            "method": found.setting.method,
            "step": found.step,
            "elements": found.setting.elements,
            "converged": found.converged,
            "observed_order": found.observed_order,
            "error": found.error,
            "mesh_error": found.mesh_error,
            "differences": [{"step": step, "difference": difference} for step, difference in found.differences],
            "why": found.why,
        }
    return {
        "runs": [run_record(row) for row in study.rows],
        "reference": reference,
        "advice": study.advice,
        "point": str(study.watched.point),
        "force": None if study.watched.force is None else str(study.watched.force),
        "twist": study.watched.twist_said or None,
        "tolerance": study.tolerance,
        "tangent_error": study.tangent,
        "load": list(study.load),
        "warnings": list(study.warnings),
        "left_out": list(study.left_out),
        "unseen": study.unseen,
    }


def write_csv(records: Sequence[Mapping[str, Any]], path: Path) -> Path:
    """Write rows with a header that names the units; raises ResultError if the file cannot be written."""
    names = list(records[0]) if records else []
    return write_rows(heads_of(names, UNITS), ([record[name] for name in names] for record in records), path)


def write_netcdf(records: Sequence[Mapping[str, Any]], attributes: Mapping[str, Any], path: Path) -> Path:
    """Write rows along the dimension ``run``; a number that is lacking is NaN, as NetCDF has no other word for it.

    Raises
    ------
    ResultError
        If the file cannot be written.
    """
    columns: dict[str, Any] = {}
    for name in records[0] if records else ():
        values = [record[name] for record in records]
        if any(isinstance(value, str) for value in values):
            data: Any = np.array(["" if value is None else str(value) for value in values], dtype=object)
        else:
            data = np.array([np.nan if value is None else float(value) for value in values])
        columns[name] = ("run", data, {"units": UNITS[name]} if name in UNITS else {})
    return write_dataset(columns, {}, attributes, path)


def stability_record(found: Stability) -> dict[str, Any]:
    """Keys of ``stability --json``."""
    c = found.critical
    return {
        "critical_step": {
            "effective_length": c.effective_length,
            "eigenvalue": c.eigenvalue,
            "bisection": None if c.bisection is None else c.bisection[0],
            "unstable_from": None if c.bisection is None else c.bisection[1],
            "eigenvalue_at_start": c.at_start,
        },
        "omega_max": c.omega_max,
        "set_by": c.set_by,
        "at": c.at,
        "shortest_element": c.shortest,
        "why": c.why,
        "stiffnesses": [entry._asdict() for entry in found.penalties],
        "conditioning": [entry._asdict() for entry in found.conditions],
        "energy_drift": found.energy_drift,
        "constraint_drift": found.constraint_drift,
        "tangent_error": found.tangent,
        "variants": [variant_record(variant) for variant in found.variants],
        "warnings": list(found.warnings),
        "left_out": list(found.left_out),
    }


def variant_record(variant: Variant) -> dict[str, Any]:
    """Keys of one variant."""
    return {
        "name": variant.name,
        "outcome": variant.outcome,
        "error": variant.error,
        "status": variant.status,
        "silent": variant.silent,
        "phase_lag": variant.lag,
        "energy_error": variant.energy_error,
        "stated_error": variant.stated,
        "warned": "; ".join(variant.warnings),
        "wall_time": variant.wall_time,
    }
