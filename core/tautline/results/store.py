"""Writing a run's frames so that the file is whole at every moment.

HDF5, which NetCDF-4 is, is not safe against a crash: a file that was being written when its process was killed may be
unreadable. Its single-writer-multiple-reader mode keeps the contents in order, but leaves a mark in the file that
plain readers refuse until a tool has cleared it, while running too. A journal beside the file is safe, but a plain
reader would miss what is only in the journal.

So there are two copies, hidden beside the result and written in turn. A batch goes, together with the one before,
into the copy that is not published; that file is closed and then takes the result's name by a hard link and a
rename, which is atomic. The name therefore always leads to a closed file with all earlier batches, whatever happens to
the writer, and another process may open it at any time without a special mode. It costs every frame being written
twice, in large batches, and needs no cooperation from any reader.

A reader may still hold the copy that is due next. The writer asks for it (`results/disk.py`), leaves that copy to its
reader and makes a new one. All this is about killed processes: against a power cut no file is flushed to the disk
before the operating system does so.

A result that is named by a link is written where the link leads, with its copies beside it; the link stays.

The result's name is not touched before the first batch is there: an earlier result survives a run that never starts.
"""

from __future__ import annotations

import itertools
import os
import platform
import re
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol, Self

import h5py
import numpy as np

from tautline.errors import ArgumentError
from tautline.results import disk, layout
from tautline.results.errors import ResultError, WriteError
from tautline.results.output_path import check_target
from tautline.results.result import Result
from tautline.results.variable import Variable
from tautline.whole_file import for_hidden, place_of

TIME = Variable("time", ("time",), "s", "simulated time")

_numbers = itertools.count()


class FrameStore(Protocol):
    """What a run gives its frames to: `Store`, and `tautline.results.brief_store.BriefStore`."""

    attributes: dict[str, Any]
    """What is known of the run: numbers and texts, and what is told as dicts and lists."""

    @property
    def result(self) -> Result | None:
        """What was stored so far; None before the first batch."""

    def append(
        self,
        frames: Mapping[str, np.ndarray],
        restart: Mapping[str, np.ndarray] | None = None,
        attributes: Mapping[str, Any] | None = None,
    ) -> None:
        """Add a batch of frames, see `Store.append`."""

    def finish(
        self, attributes: Mapping[str, Any] | None = None, restart: Mapping[str, np.ndarray] | None = None
    ) -> Result | None:
        """Add what is known only at the end, see `Store.finish`."""

    def __enter__(self) -> Self: ...

    def __exit__(self, *exception: object) -> None: ...


class Store:
    """Takes batches of frames and keeps them in a NetCDF-4 file.

    Parameters
    ----------
    path : Path or None
        The result; None keeps everything in memory.
    variables : list of Variable
        What every frame holds; ``time`` is added if it is not among them.
    coordinates : dict
        Name -> (dimension name or names, array, unit, long name) of what does not change with time; a bare
        one-dimensional array is taken as the coordinate of the dimension of that name.
    attributes : dict
        Numbers and texts known at the start, ``scene`` among them; ``status`` is ``running`` until ``finish``.
    resumable : bool
        Whether the result is what the verb that writes it takes under ``--resume``, so that this is a cure.

    Attributes
    ----------
    frames : int
        Number of frames appended.

    Raises
    ------
    ResultError
        If the path cannot be written to, or another run is writing there. Nothing is written before the first batch.
    """

    def __init__(
        self,
        path: str | Path | None,
        variables: Sequence[Variable],
        coordinates: Mapping[str, Any] | None = None,
        attributes: Mapping[str, Any] | None = None,
        resumable: bool = True,
    ) -> None:
        self.resumable = resumable
        self.path = None if path is None else check_target(path)
        named = {variable.name: variable for variable in (TIME, *variables)}
        self.variables = list(named.values())
        self.coordinates = {name: coordinate(name, given) for name, given in (coordinates or {}).items()}
        self.attributes: dict[str, Any] = {"status": "running", **(attributes or {})}
        self.frames = 0
        self._batches: list[tuple[int, dict[str, np.ndarray]]] = []
        self._copies = None if self.path is None else _Copies(self.path)
        self._restart: Mapping[str, np.ndarray] = {}
        self._now: dict[str, Any] = {}
        self.start: Mapping[str, np.ndarray] = {}
        """The frame at the start of the run, where it is not among those that are stored; see `Result`."""

    def append(
        self,
        frames: Mapping[str, np.ndarray],
        restart: Mapping[str, np.ndarray] | None = None,
        attributes: Mapping[str, Any] | None = None,
    ) -> None:
        """Add a batch of frames; on return it is safe from anything that befalls this process.

        Parameters
        ----------
        frames : dict of str to (n, ...) array
            Every variable, ``time`` among them, with time as the leading axis. n = 0 does nothing.
        restart : dict of str to array, optional
            The raw state to go on from, kept in the group ``restart`` until the next is given: names and shapes stay.
        attributes : dict, optional
            What is known of the run so far, such as the time of that state.

        Raises
        ------
        ArgumentError
            If a variable is missing or unknown, or has another shape than before.
        WriteError
            If the file cannot be written. What was stored before is kept.
        """
        batch = self._checked(frames)
        if len(batch["time"]) == 0:
            return
        if self.frames == 0:
            layout.dimensions(self.variables, self.coordinates, batch)
        self._batches.append((self.frames, batch))
        self.frames += len(batch["time"])
        self._restart, self._now = restart or self._restart, self._now | dict(attributes or {})
        if self._copies is not None:
            self._write(self._copies)
            self._copies.publish()

    def finish(
        self, attributes: Mapping[str, Any] | None = None, restart: Mapping[str, np.ndarray] | None = None
    ) -> Result | None:
        """Add what is known only at the end, and remove the hidden copies.

        Parameters
        ----------
        attributes : dict
            Such as status, wall_time, headline (dicts are stored as JSON).
        restart : dict of str to array
            The raw final state, kept in the group ``restart``.

        Returns
        -------
        Result or None
            None if there was no frame: then no file is written.
        """
        self.attributes |= {"status": "done", **(attributes or {})}
        if self.frames == 0:
            self.close()
            return None
        if self._copies is None:
            return self._in_memory(self._restart if restart is None else restart)
        try:
            if restart is not None:
                self._restart = {}  # the final state takes its place below
            copy = self._write(self._copies)
            disk.reserve(copy, layout.bytes_needed([]) + layout.size(self.attributes) + layout.size(restart or {}))
            with h5py.File(copy, "r+", libver=("earliest", "v110")) as file:
                layout.write_attributes(file, self.attributes)
                if restart is not None:
                    layout.write_restart(file, restart)
            self._copies.publish()
        except (OSError, RuntimeError) as error:
            raise self._failure(self._copies, error) from error
        finally:
            self.close()
        return Result(self._copies.path, known=self._described, start=self.start)

    @property
    def result(self) -> Result | None:
        """What was stored so far; None before the first batch."""
        if self.frames == 0:
            return None
        if self.path is None:
            return self._in_memory(self._restart)
        return Result(self.path, known=self._described, held=self._held, start=self.start)

    @property
    def _held(self) -> dict[str, np.ndarray]:
        """What the file holds and is still in memory, as it would be read: each of a file is opened for by itself."""
        held = {name: values for name, (_, values, *_) in self.coordinates.items() if values.dtype.kind not in "US"}
        whole = bool(self._batches) and self._batches[0][0] == 0
        return held | (self._joined() if whole else {})

    def _joined(self) -> dict[str, np.ndarray]:
        """The frames of the batches that are held, one array a variable."""
        names = (variable.name for variable in self.variables)
        return {name: np.concatenate([batch[name] for _, batch in self._batches]) for name in names}

    @property
    def _described(self) -> dict[str, Variable]:
        """What the file holds, as `Result.variables` would read it: that takes as long as a short run."""
        fixed = {name: Variable(name, dims, units, text) for name, (dims, _, units, text) in self.coordinates.items()}
        return fixed | {variable.name: variable for variable in self.variables}

    def close(self) -> None:
        """Remove the hidden copies without finishing; what was published stays."""
        if self._copies is not None:
            self._copies.remove()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def _write(self, copies: _Copies) -> Path:
        """Bring the copy that is due up to date and return it, closed."""
        try:
            if not copies.begun:
                disk.reserve(copies.due, layout.bytes_needed([self._batches[0][1]]) + layout.size(self.attributes))
                layout.create(copies.due, self.variables, self.coordinates, self.attributes, self._batches[0][1])
            copies.append(self._batches, self.frames)
            if self._restart or self._now:
                disk.reserve(copies.due, layout.bytes_needed([]) + layout.size(self._restart) + layout.size(self._now))
                with h5py.File(copies.due, "r+", libver=("earliest", "v110")) as file:
                    layout.write_restart(file, self._restart)
                    layout.write_attributes(file, self._now)
        except (OSError, RuntimeError) as error:
            copies.discard()
            raise self._failure(copies, error) from error
        self._batches = [(start, batch) for start, batch in self._batches if start >= copies.least]
        return copies.due

    def _failure(self, copies: _Copies, error: Exception) -> WriteError:
        reason = os.strerror(error.errno) if isinstance(error, OSError) and error.errno else str(error)
        kept = max(copies.held) if copies.place.parent.is_dir() else 0
        left = f"; {kept} frames are kept in it" if kept else "; nothing was stored"
        cure = disk.cure_of(copies.place, "free some space, or name another folder with -o")
        cure += f"; then go on with --resume {copies.path}" if kept and self.resumable else ""
        return WriteError(copies.path, f"cannot be written any more: {reason}{left}", cure)

    def _checked(self, frames: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
        names = {variable.name for variable in self.variables}
        if frames.keys() != names:
            wrong = sorted(names - frames.keys()) or sorted(frames.keys() - names)
            verb = "missing" if names - frames.keys() else "unknown"
            raise ArgumentError(f"frames: {verb} {', '.join(wrong)}")
        batch = {name: _array(values) for name, values in frames.items()}
        count = len(np.atleast_1d(batch["time"]))
        before = self._batches[-1][1] if self._batches else batch
        for name, values in batch.items():
            if values.ndim == 0 or len(values) != count or values.shape[1:] != before[name].shape[1:]:
                raise ArgumentError(f"{name}: shape {values.shape}, not {(count, *before[name].shape[1:])}")
            if values.dtype != before[name].dtype:
                batch[name] = values.astype(before[name].dtype)
        return batch

    def _in_memory(self, restart: Mapping[str, np.ndarray]) -> Result:
        return Result(
            None, (self.variables, self._joined(), self.coordinates, self._now | self.attributes, dict(restart)),
            start=self.start,
        )  # fmt: skip


class _Copies:
    """The two hidden copies of a result, and which of them is due.

    Attributes
    ----------
    path, place : Path
        The result as it was named, and where it is.
    """

    def __init__(self, path: Path) -> None:
        self.path, self.place = path, place_of(path)
        host = re.sub(r"\W", "_", platform.node())[:32]
        self.prefix = f".{for_hidden(self.place.name)}.{host}."
        stem = f"{self.prefix}{os.getpid()}-{next(_numbers)}"
        self.files = [self.place.parent / f"{stem}{letter}.part" for letter in "ab"]
        self.link = self.place.parent / f"{stem}n.part"
        self.held = [0, 0]
        self.turn = 0
        self.lock = disk.Lock(self.place)
        writer = self.lock.take()
        if writer is not None:
            who = f"process {writer}" if writer else "another process"
            raise ResultError(path, f"{who} is writing this result", "wait until it has ended, or name another with -o")
        self._remove_stale()

    @property
    def begun(self) -> bool:
        """Whether anything was published yet."""
        return any(self.held)

    @property
    def due(self) -> Path:
        """The copy to be written next; the other one is published."""
        return self.files[self.turn]

    @property
    def least(self) -> int:
        """Number of frames that both copies hold."""
        return min(self.held)

    def append(self, batches: list[tuple[int, dict[str, np.ndarray]]], frames: int) -> None:
        """Bring the due copy up to `frames` frames; replaced by a fresh one if it is missing or someone reads it."""
        missing = [(start, batch) for start, batch in batches if start >= self.held[self.turn]]
        try:
            if missing:
                self._add(missing)
        except (BlockingIOError, FileNotFoundError):
            if not any(self.held):
                raise
            self.discard()
            self._renew()
            missing = [(start, batch) for start, batch in batches if start >= self.held[self.turn]]
            if missing:
                self._add(missing)
        self.held[self.turn] = frames

    def _add(self, batches: list[tuple[int, dict[str, np.ndarray]]]) -> None:
        """Append to the due copy, if nobody has it open and the disk has room."""
        if disk.is_open_elsewhere(self.due):
            raise BlockingIOError
        disk.reserve(self.due, layout.bytes_needed([batch for _, batch in batches]))
        layout.append(self.due, batches)

    def _renew(self) -> None:
        """Copy the published file over the due one."""
        shutil.copyfile(self.files[1 - self.turn], self.due)
        self.held[self.turn] = self.held[1 - self.turn]

    def discard(self) -> None:
        """Drop the due copy; whoever has it open keeps it."""
        self.due.unlink(missing_ok=True)
        self.held[self.turn] = 0

    def publish(self) -> None:
        """Give the due copy the result's name, and take turns."""
        self.link.unlink(missing_ok=True)
        try:
            os.link(self.due, self.link)
        except OSError:
            shutil.copyfile(self.due, self.link)  # a file system without hard links
        os.replace(self.link, self.place)
        self.turn = 1 - self.turn

    def remove(self) -> None:
        """Delete the hidden names."""
        for file in (*self.files, self.link):
            file.unlink(missing_ok=True)
        self.lock.give_back()

    def _remove_stale(self) -> None:
        """Delete what runs of this machine that were killed have left for the same result."""
        pattern = re.compile(re.escape(self.prefix) + r"(\d+)-\d+[abn]\.part")
        for file in self.place.parent.iterdir():
            match = pattern.fullmatch(file.name)
            if match and not _alive(int(match[1])):
                file.unlink(missing_ok=True)


def _alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True


def _array(values: Any) -> np.ndarray:
    array = np.asarray(values)
    if array.dtype.kind == "b":
        return array.astype(np.int8)
    if array.dtype.kind == "f":
        array = array.astype(np.float64, copy=False)
    # A batch is held until both copies have it: the caller may use its arrays again meanwhile.
    return np.array(array, order="C")


def coordinate(name: str, given: Any) -> layout.Coordinate:
    """Dimensions, values, unit and long name of a coordinate, as `Store` is given it."""
    if isinstance(given, tuple):
        dims, values, units, long_name = given
        return (dims,) if isinstance(dims, str) else tuple(dims), np.asarray(values), units, long_name
    return (name,), np.asarray(given), "", ""
