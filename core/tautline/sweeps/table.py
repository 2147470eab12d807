"""The rows of a sweep as named arrays, and as files: NetCDF and CSV, each whole or not there.

xarray is imported only where its dataset is asked for: that takes a second with what it imports itself, as long as
100 short cases take beside their loops.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tautline.results.errors import WriteError
from tautline.results.tables.finding import Finding
from tautline.results.tables.netcdf import Column, columns_of, write_columns
from tautline.results.tables.rows import heads_of, write_rows
from tautline.sweeps.cases import Row
from tautline.sweeps.plans import CASE, COUNTED, PERCENTILES, SAMPLED, Cases, word_of
from tautline.version import __version__

if TYPE_CHECKING:
    import xarray

NOT_RUN = "not run"
RANKS = (10.0, 50.0, 90.0)
"""Percentiles over the cases of a plan that samples."""
ENDLESS = 1.0e300
"""In place of what has no end, where ranks are interpolated; no number of a scene comes near its root."""
PERCENTILE = "percentile"
"""Their dimension."""
TIMES = {
    "case_wall_time": ("wall_time", "run time of the case"),
    "case_cpu_time": ("cpu_time", "processor time of the case"),
}
"""Times of a case: variable -> field of its row, and text. A run's own, of its loop alone, have other names."""
NOT_SATISFIED = "limits_not_satisfied"
"""Names of the limits that a case fails, with semicolons; a table of which no case fails any has no such column."""
CURE = "make room, and go on with --resume"
"""What helps where one of the files of a sweep cannot be written."""
DATASET, TABLE, RANKED = "sweep.nc", "sweep.csv", "percentiles.csv"


@dataclass
class Variables:
    """What a sweep has collected, as the variables of an ``xarray.Dataset``, which is made of it where one is wanted.

    Attributes
    ----------
    data_vars, coords : dict of Column
        By name.
    attrs : dict
    """

    data_vars: dict[str, Column]
    coords: dict[str, Column]
    attrs: dict[str, Any]

    @classmethod
    def of(cls, entries: Mapping[str, Any], coordinates: Mapping[str, Any], attributes: Mapping[str, Any]) -> Variables:
        """Of variables and coordinates as xarray takes them: name -> (dimension or dimensions, values, attributes)."""
        return cls(columns_of(entries), columns_of(coordinates), dict(attributes))

    def __getitem__(self, name: str) -> Column:
        """A variable or a coordinate."""
        return self.data_vars[name] if name in self.data_vars else self.coords[name]

    def __contains__(self, name: str) -> bool:
        """Whether there is one of that name."""
        return name in self.data_vars or name in self.coords

    def with_variables(self, other: Variables) -> Variables:
        """This table with the variables and coordinates of another one."""
        return Variables(self.data_vars | other.data_vars, self.coords | other.coords, {**other.attrs, **self.attrs})

    def to_xarray(self) -> xarray.Dataset:
        """The same as a dataset of xarray's."""
        import xarray

        made = ({name: tuple(one) for name, one in part.items()} for part in (self.data_vars, self.coords))
        return xarray.Dataset(*made, self.attrs)


def dataset(
    cases: Cases, columns: Mapping[str, Finding], rows: Iterable[Row], attributes: Mapping[str, Any]
) -> Variables:
    """The result of a sweep.

    Parameters
    ----------
    cases : Cases
    columns : mapping
        Unit, text and axis of what was collected, by name.
    rows : iterable of Row
        In any order; a case without one has the status ``not run``.
    attributes : mapping

    Returns
    -------
    Variables
        With a dimension a parameter for a grid, ``case`` else; of a list, with the dimension that it runs along.
    """
    count = len(cases)
    status, message = np.full(count, NOT_RUN, object), np.full(count, "", object)
    times, failed = {name: np.full(count, np.nan) for name in TIMES}, np.full(count, "", object)
    values: dict[str, list[Any]] = {name: [None] * count for name in columns}
    for row in rows:
        status[row.case], message[row.case], failed[row.case] = row.status, row.message, "; ".join(row.limits)
        for name, array in times.items():
            array[row.case] = getattr(row, TIMES[name][0])
        for name, value in row.values.items():
            if name in values:
                values[name][row.case] = value
    axes = {one.along for one in columns.values() if one.along}
    entries: dict[str, Any] = {}
    coordinates = _coordinates(cases)
    arrays = {name: _array(values[name]) for name in columns}
    # Cases may have other places along an axis: speeds up to that of the scene, depths down to that of the well.
    apart = {name for name in axes if name in arrays and arrays[name][1] and not _shared(arrays[name][0])}
    for name, one in columns.items():
        about = {"units": one.unit, "long_name": one.text or name}
        array, own = arrays[name]
        if own and name in axes and name not in apart:
            coordinates[name] = (name, _common(array), about)
            continue
        axis = name if name in axes else one.along
        along = (f"{axis or name} number" if not axis or axis in apart else axis,) if own else ()
        entries[name] = ((*cases.dims, *along), array.reshape(*cases.shape, *array.shape[1:]), about)
    for name, array in times.items():
        entries[name] = (cases.dims, array.reshape(cases.shape), {"units": "s", "long_name": TIMES[name][1]})
    entries["status"] = (cases.dims, status.reshape(cases.shape), {"long_name": "how the case ended"})
    if failed.any():
        about = {"long_name": "limits of the run that are not satisfied"}
        entries[NOT_SATISFIED] = (cases.dims, failed.reshape(cases.shape), about)
    entries["message"] = (cases.dims, message.reshape(cases.shape), {"long_name": "why it ended early"})
    for name in [name for name in coordinates if name in entries]:
        del entries[name]
    if cases.plan.name in SAMPLED and not cases.indices:
        # Of places that differ from case to case the n-th have nothing in common.
        ranked = [name for name, one in columns.items() if name in entries and not {name, one.along} & apart]
        entries |= _percentiles({name: entries[name] for name in ranked})
        coordinates[PERCENTILE] = (PERCENTILE, np.array(RANKS), {"units": "%", "long_name": "cases with at most this"})
    return Variables.of(entries, coordinates, {**attributes, "version": __version__})


def _percentiles(entries: Mapping[str, Any]) -> dict[str, Any]:
    """Percentiles over the cases that came to their end, of everything that is a number, place by place."""
    found = {}
    for name, (dims, array, about) in entries.items():
        if array.dtype.kind == "f" and not np.isnan(array).all():
            # Places that no case reached stay empty. Between a number and one without end there is nothing to
            # interpolate: the percentile has no end then.
            known = ~np.isnan(array).all(axis=0)
            ranked = np.full((len(RANKS), *array.shape[1:]), np.nan)
            bounded = np.clip(array[:, known], -ENDLESS, ENDLESS)
            ranked[:, known] = np.nanpercentile(bounded, RANKS, axis=0)
            ranked = np.where(np.abs(ranked) > math.sqrt(ENDLESS), np.copysign(np.inf, ranked), ranked)
            text = f"percentiles of {about['long_name']}"
            found[name + PERCENTILES] = ((PERCENTILE, *dims[1:]), ranked, {**about, "long_name": text})
            text = f"cases that have a number, of which are the percentiles of {about['long_name']}"
            counts = np.asarray((~np.isnan(array)).sum(axis=0), float)
            found[name + COUNTED] = (dims[1:], counts, {"units": "", "long_name": text})
    return found


def percentiles_of(data: Variables) -> dict[str, tuple[Column, Column]]:
    """Percentiles of each number that has some, and how many cases have it, by its name.

    They are known by their dimension: a name that was given may end as theirs do.
    """
    made = [name for name, one in data.data_vars.items() if one.dims[:1] == (PERCENTILE,)]
    names = [name.removesuffix(PERCENTILES) for name in made]
    return {name: (data[name + PERCENTILES], data[name + COUNTED]) for name in names}


def write_percentiles(data: Variables, path: Path) -> Path | None:
    """Write percentiles as a table: a row for each number, or for each of its places; None where there are none.

    A table that another sweep left there is removed then: it would be taken for one of this sweep.
    """
    heads, rows = ["quantity", "unit", "along", "at", *(f"P{rank:g}" for rank in RANKS), "cases"], []
    for name, (one, cases) in percentiles_of(data).items():
        about, counts = [name, str(one.attrs.get("units") or "")], cases.values
        if one.dims == (PERCENTILE,):
            rows.append([*about, "", "", *one.values.tolist(), int(counts)])
            continue
        along = one.dims[1]
        places = data[along].values if along in data.coords else range(one.values.shape[1])
        rows += [
            [*about, along, float(at), *column, int(count)]
            for at, column, count in zip(places, one.values.T.tolist(), counts, strict=True)
        ]
    if not rows:
        path.unlink(missing_ok=True)
        return None
    return write_rows(heads, rows, path, CURE, WriteError)


def _coordinates(cases: Cases) -> dict[str, Any]:
    made: dict[str, Any] = {}
    for one in cases.parameters:
        about = {"units": one.unit, "long_name": one.key}
        if one.numeric:
            of_list, of_cases = np.array(one.numbers, float), cases.numbers[one.key]
        else:
            of_list = np.array([word_of(value) for value in one.values], object)
            of_cases = np.array([word_of(value) for value in cases.values[one.key]], object)
        if cases.dims == (CASE,):
            made[one.key] = (CASE, of_cases, about)
        else:
            made[one.key] = (one.key, of_list, about)
    if cases.dims == (CASE,):
        made[CASE] = (CASE, np.arange(len(cases)), {"long_name": "number of the case"})
    return made


def _array(values: list[Any]) -> tuple[np.ndarray, bool]:
    """Values of all cases as an array, and whether they are lists; what is lacking is NaN, or an empty text."""
    lists = [value for value in values if isinstance(value, list)]
    if lists:
        flat = [value if isinstance(value, list) else [] for value in values]
        longest = max(len(value) for value in flat)
        found = np.full((len(values), longest), np.nan)
        for row, value in zip(found, flat, strict=True):
            row[: len(value)] = [np.nan if each is None or isinstance(each, (str, list)) else each for each in value]
        return found, True
    if any(isinstance(value, str) for value in values):
        return np.array(["" if value is None else str(value) for value in values], object), False
    return np.array([np.nan if value is None else float(value) for value in values]), False


def _common(array: np.ndarray) -> np.ndarray:
    """Places along a dimension, which all cases that were run share: those of the case that has most of them."""
    return array[int(np.isfinite(array).sum(axis=1).argmax())]


def _shared(array: np.ndarray) -> bool:
    """Whether all cases have the same places (cases, places), some of them fewer than others."""
    known = np.isfinite(array)
    return bool(((array == _common(array)) | ~known).all())


def write_netcdf(data: Variables, path: Path) -> Path:
    """Write a table; the file is whole or as it was before.

    Raises
    ------
    WriteError
        If it cannot be written.
    """
    return write_columns(data.data_vars, data.coords, data.attrs, path, CURE, WriteError)


def write_csv(data: Variables, cases: Cases, path: Path) -> Path:
    """Write a row for each case; a list has a column for each of its places."""
    units = {one.key: one.unit for one in cases.parameters if one.unit}
    heads = heads_of([CASE, *keys_of(cases)], units)
    columns: list[list[Any]] = [list(range(len(cases)))]
    columns += [_cells(cases, one) for one in cases.parameters]
    # Indices are not of cases.
    of_cases = [name for name, one in data.data_vars.items() if one.dims[: len(cases.dims)] == cases.dims]
    for name in ("status", *(name for name in of_cases if name not in ("status", "message")), "message"):
        one = data[name]
        unit = f" [{one.attrs['units']}]" if one.attrs.get("units") else ""
        further = one.dims[len(cases.dims) :]
        array = one.values.reshape(len(cases), -1)
        if not further:
            heads.append(f"{name}{unit}")
        else:
            places = data[further[0]].values if further[0] in data.coords else range(array.shape[1])
            heads += [f"{name} at {further[0]} {place:g}{unit}" for place in places]
        columns += [column.tolist() for column in array.T]
    return write_rows(heads, zip(*columns, strict=True), path, CURE, WriteError)


def keys_of(cases: Cases) -> list[str]:
    """Keys of the parameters, in their order."""
    return [one.key for one in cases.parameters]


def _cells(cases: Cases, one: Any) -> list[Any]:
    return cases.numbers[one.key].tolist() if one.numeric else [word_of(value) for value in cases.values[one.key]]
