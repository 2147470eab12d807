"""Reading a result: quickly by name, or all of it as an xarray data set."""

from __future__ import annotations

import functools
import math
import os
import time
from collections.abc import Iterator, KeysView, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from stat import S_ISREG
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from tautline.errors import ArgumentTypeError
from tautline.results.attributes import attributes_of, mark_of
from tautline.results.errors import ResultError
from tautline.results.headline import plain
from tautline.results.layout import FORMAT, Coordinate, as_number, decoded, encoded
from tautline.results.on_demand import OnDemand
from tautline.results.output_path import SIGNATURE
from tautline.results.packed import values_of
from tautline.results.variable import Variable, listed

if TYPE_CHECKING:
    import xarray

Contents = tuple[Sequence[Variable], Mapping[str, np.ndarray], Mapping[str, Coordinate], dict[str, Any], dict[str, Any]]
"""A run kept in memory: variables, their arrays, coordinates, attributes, restart."""

ATTEMPTS, PAUSE = 10, 0.02

LARGE = 1_000_000_000
"""Bytes of a file that are not taken into memory unasked; to read so many takes a second or two."""
LAZILY = "tautline.results.large"
"""The module that opens larger ones. It imports xarray when it is imported, which only a data set needs."""
PICTURES, SPACE = "tautline.application.pictures", "tautline.application.space"
"""Modules that draw results. They know the applications and stand above this one, so they are named here and looked up
when a picture is asked for; nothing here imports them."""


class Result:
    """A stored run, finished or not; make one with ``Result.read(path)``.

    ``result["hook_load"]`` is the array of a variable, read when asked for, without loading xarray.

    Attributes
    ----------
    path : Path or None
        The file; None if the run was kept in memory.
    """

    def __init__(
        self, path: str | Path | None, contents: Contents | None = None, known: dict[str, Variable] | None = None,
        held: Mapping[str, np.ndarray] | None = None, start: Mapping[str, np.ndarray] | None = None,
    ) -> None:  # fmt: skip
        """Of a run in memory, or of a file.

        Whoever makes this and has written the file gives ``known``, its variables, and ``held``, what of their values
        is still in memory and need not be read. Of a part of a run ``start`` is the frame at the start of the run, with
        a leading axis of one; `tautline.results.variable.at_start` reads it.
        """
        self.path = None if path is None else Path(path)
        self._contents = contents
        self._known = known
        self._held = held or {}
        self.start = start or {}

    @classmethod
    def read(cls, path: str | Path) -> Result:
        """Open a result.

        Raises
        ------
        ResultError
            If there is no such file, or it is no NetCDF-4 file, not one of ours, damaged, or has no frame.
        ArgumentTypeError
            For what is no path.
        """
        if not isinstance(path, (str, os.PathLike)):
            raise ArgumentTypeError(f"the path of a result is wanted, not {type(path).__name__}")
        path = Path(path)
        _check_file(path)
        result = cls(path)
        with result._open() as file:
            mark = mark_of(file)
            if not mark.startswith(FORMAT.split()[0]) or "time" not in file:
                raise ResultError(path, "is a NetCDF file, but not a Tautline result", "name one that `simulate` wrote")
            if mark != FORMAT:
                raise ResultError(path, f"has format '{mark}', and this version reads '{FORMAT}'", "update Tautline")
            if file["time"].shape[0] == 0:
                raise ResultError(path, "has no frame", "run the scene again")
            _check_order(path, values_of(file["time"]))
        return result

    def from_time(self, begin: float, until: float = math.inf) -> Result:
        """The same run without its frames before a time, s, and from another on; its first tells of the start.

        All of it where no frame lies between them. Variables are read when they are asked for.
        """
        # The rounding of a sum of steps must not leave out the frame at `begin` itself.
        first, last = (int(one) for one in np.searchsorted(self.time, np.array([begin, until]) * (1.0 - 1e-12)))
        if not first < last or (first, last) == (0, len(self.time)):
            return self
        moving, fixed = self._parted()
        arrays, start = (
            OnDemand({one.name: functools.partial(_between, self, one.name, some) for one in moving})
            for some in (slice(first, last), slice(0, 1))
        )
        return Result(None, (moving, arrays, fixed, self.attributes, {}), start=self.start or start)

    def of_frames(self, which: np.ndarray) -> Result:
        """The same run with some of its frames, kept in memory; their numbers are ``which`` (m,) int."""
        moving, fixed = self._parted()
        arrays = {one.name: self[one.name][which] for one in moving}
        return Result(None, (moving, arrays, fixed, self.attributes, {}), start=self.start)

    def _parted(self) -> tuple[list[Variable], dict[str, Coordinate]]:
        """The variables that change from frame to frame, and the others with their values."""
        of_frames = {name for name, one in self.variables.items() if one.dims[:1] == ("time",)}
        fixed = {
            name: (one.dims, self[name], one.units, one.long_name)
            for name, one in self.variables.items()
            if name not in of_frames
        }
        return [one for name, one in self.variables.items() if name in of_frames], fixed

    @functools.cached_property
    def attributes(self) -> dict[str, Any]:
        """Attributes of the run: scene, method, step, wall_time, status and so on.

        Numbers and texts, and dicts and lists for those of `tautline.results.layout.STRUCTURED`. They are the same
        whether the run was kept in memory or is read from a file.
        """
        return decoded(self._encoded)

    @property
    def _encoded(self) -> dict[str, Any]:
        """The attributes as a file holds them."""
        if self._contents is not None:
            return encoded({"format": FORMAT, **self._contents[3]})
        with self._open() as file:
            return attributes_of(file)

    @property
    def warnings(self) -> list[str]:
        """What a reader should know of the result's accuracy."""
        return self._structured("warnings", [])

    @property
    def step_error(self) -> dict[str, Any] | None:
        """The error estimated from runs with other steps, see `tautline.study.trials.step_error`; None if none."""
        return self._structured("step_error", None)

    @property
    def between_frames(self) -> dict[str, Any] | None:
        """What lies between the stored frames, see `tautline.study.trials.between_frames`; None if nobody looked."""
        return self._structured("between_frames", None)

    @property
    def accuracy(self) -> dict[str, Any] | None:
        """What was asked and reached where method and step were chosen (`tautline.study.accuracy.choice`), or None."""
        return self._structured("accuracy", None)

    @property
    def limits(self) -> list[dict[str, Any]]:
        """What the run is judged by, passed or not, with time and place: see `tautline.results.assessment.limits`."""
        return self._structured("limits", [])

    @property
    def headline(self) -> dict[str, dict[str, Any]]:
        """The application's figures: name -> {value, unit, text}.

        Of a run that stopped early they are those of the frames until then. They are empty while a run goes on, and
        where its process was killed.
        """
        return self._structured("headline", {})

    def _structured(self, name: str, otherwise: Any) -> Any:
        """An attribute, which whoever asks may change without changing the result."""
        return plain(self.attributes.get(name, otherwise))

    @functools.cached_property
    def variables(self) -> dict[str, Variable]:
        """What the file holds, by name; coordinates too."""
        if self._known is not None:
            return dict(self._known)
        if self._contents is not None:
            fixed = {key: Variable(key, dims, units, text) for key, (dims, _, units, text) in self._contents[2].items()}
            return {variable.name: variable for variable in self._contents[0]} | fixed
        with self._open() as file:
            return {name: _variable(name, data) for name, data in file.items() if _is_variable(data)}

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and name in self.variables

    def __iter__(self) -> Iterator[str]:
        """Names of `variables`. Without it Python would ask for the variables 0, 1, 2 and so on."""
        return iter(self.variables)

    def __len__(self) -> int:
        return len(self.variables)

    def __bool__(self) -> bool:
        """True: a result has a frame. Without it Python would ask for the length, and so read the variables."""
        return True

    def keys(self) -> KeysView[str]:
        """Names of `variables`; with them ``dict(result)`` holds the arrays of all."""
        return self.variables.keys()

    def __getitem__(self, name: str) -> np.ndarray:
        """Array of a variable, shape as its dimensions say, SI units; it cannot be written to, a copy can.

        Raises
        ------
        ResultError
            If there is no such variable.
        """
        name = name if isinstance(name, str) else str(name)  # no other can be one: the refusal tells it
        if self._contents is not None:
            _, arrays, coordinates, *_ = self._contents
            if name in coordinates:
                return _read_only(coordinates[name][1])
            if name in arrays:
                return _read_only(arrays[name])
        elif name in self._held:
            return _read_only(self._held[name])
        else:
            with self._open() as file:
                if name in file and _is_variable(file[name]):
                    return _read_only(values_of(file[name]))
        known = ", ".join(self.variables)
        raise ResultError(self.path or "result", f"has no variable '{name}'", f"it has {known}")

    @property
    def time(self) -> np.ndarray:
        """Simulated times of the frames, shape (frames,), s."""
        return self["time"]

    @property
    def restart(self) -> dict[str, np.ndarray]:
        """The raw state to go on from, that of the time in the attribute ``restart_time``.

        A run that stopped early, or was killed, has one too. It is empty where statistics were kept in place of
        frames, and of a run in memory that is one of many.
        """
        if self._contents is not None:
            return {name: _read_only(as_number(np.asarray(values))) for name, values in self._contents[4].items()}
        with self._open() as file:
            group = file.get("restart", {})
            return {name: _read_only(values_of(group[name])) for name in group if _is_variable(group[name])}

    @functools.cached_property
    def data(self) -> xarray.Dataset:
        """Everything as an ``xarray.Dataset``, fit for ``to_netcdf``: dicts and lists of its attributes are JSON texts.

        Of a file above `LARGE` bytes arrays are read when they are used; a smaller one is read at once and closed, so
        that it may be written over. Arrays of a run in memory cannot be written to.
        """
        import xarray

        if self._contents is None:
            assert self.path is not None
            if self.path.stat().st_size > LARGE:
                return import_module(LAZILY).lazy(self.path)
            with self._open() as file:
                held = {
                    name: (one.dims, values_of(file[name]), _described(one)) for name, one in self.variables.items()
                }
            return xarray.Dataset(held, attrs=self._encoded)
        variables, arrays, coordinates, *_ = self._contents
        entries: dict[str, Any] = {
            variable.name: (variable.dims, _read_only(arrays[variable.name]), _described(variable))
            for variable in variables
        }
        for name, (dims, values, units, long_name) in coordinates.items():
            entries[name] = (dims, _read_only(values), _described(Variable(name, dims, units, long_name)))
        return xarray.Dataset(entries, attrs=self._encoded)

    @property
    def plot(self) -> Any:
        """Figures: ``result.plot.overview()``, ``result.plot("hook_load", vs="block_position")``.

        See `tautline.application.pictures.Plots`; ``dir(result.plot)`` lists the figures that there are.
        """
        return import_module(PICTURES).Plots(self)

    def render(self, **asked: Any) -> Any:
        """Put the result into a ``pyvista.Plotter``; `tautline.application.space.in_space` says what may be asked."""
        return import_module(SPACE).in_space(self, **asked)

    def __repr__(self) -> str:
        head = f"Result({str(self.path)!r})" if self.path else "Result(in memory)"
        try:
            status, frames = self.attributes.get("status", "not known"), len(self["time"])
            lines = [f"status: {status}, {frames} frames", *listed(self.variables.values())]
        except ResultError:  # a file that cannot be read any more still has a name
            return head
        return "\n  ".join([head, *lines])

    def _open(self) -> h5py.File:
        """Open the file for reading; a run that is just writing this copy has moved on after a moment."""
        for attempt in range(ATTEMPTS):
            try:
                return h5py.File(self.path, "r")
            except FileNotFoundError:
                raise ResultError(self.path or "", "there is no such file", "check the name") from None
            except OSError as error:
                if attempt == ATTEMPTS - 1 or "lock" not in str(error):
                    raise ResultError(self.path or "", f"is damaged: {error}", "run the scene again") from None
            time.sleep(PAUSE)
        raise AssertionError("unreachable")


def _check_order(path: Path, time: np.ndarray) -> None:
    """Raise ResultError where times go back: no run writes such frames. Of those that are no number see the verbs."""
    known = np.flatnonzero(np.isfinite(time))
    if not known.size:
        raise ResultError(path, "is damaged: none of its times is a number", "run the scene again")
    back = np.flatnonzero(np.diff(time[known]) < 0.0)
    if back.size:
        before, frame = known[back[0] : back[0] + 2]
        cause = f"is damaged: its time goes from {time[before]:g} s to {time[frame]:g} s at frame {frame + 1}"
        raise ResultError(path, cause, "run the scene again")


def _check_file(path: Path) -> None:
    try:
        if path.is_dir():
            raise ResultError(path, "is a folder", "name a result in it, such as jwell.nc")
        if not S_ISREG(path.stat().st_mode):  # a pipe would wait for a writer
            raise ResultError(path, "is not a regular file", "name a result, which `simulate` writes")
        with path.open("rb") as file:
            start = file.read(len(SIGNATURE))
    except FileNotFoundError:
        raise ResultError(path, "there is no such file", "check the name, or make it with `simulate`") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise ResultError(path, f"cannot be read: {reason}", "check the name and its permissions") from None
    if not start:
        raise ResultError(path, "is empty", "run the scene again")
    if start != SIGNATURE:
        raise ResultError(path, "is not a NetCDF-4 file", "name a result, which `simulate` writes: not a scene")


def _is_variable(data: Any) -> bool:
    """Whether an HDF5 object is a NetCDF variable: not a group, not the mark of a bare dimension."""
    if not isinstance(data, h5py.Dataset):
        return False
    name = data.attrs.get("NAME", b"")
    return not (name if isinstance(name, bytes) else str(name).encode()).startswith(b"This is a netCDF dimension but")


def _variable(name: str, data: h5py.Dataset) -> Variable:
    if data.is_scale:
        dims: tuple[str, ...] = (name,)
    else:
        dims = tuple(axis[0].name.split("/")[-1] if len(axis) else "" for axis in data.dims)
    said = attributes_of(data)
    return Variable(name, dims, str(said.get("units", "")), str(said.get("long_name", "")))


def _between(result: Result, name: str, some: slice) -> np.ndarray:
    """Some frames of a variable."""
    return result[name][some]


def _read_only(values: np.ndarray) -> np.ndarray:
    """The same values for somebody who must not change them."""
    view = np.asarray(values).view()
    view.flags.writeable = False
    return view


def _described(variable: Variable) -> dict[str, str]:
    """What a file says of a variable."""
    return {key: text for key, text in (("units", variable.units), ("long_name", variable.long_name)) if text}
