"""The journal of a sweep: a line for each case that is done, so that no finished case is run again.

Lines are appended and handed to the operating system one by one: when the process is killed, they are there. They are
forced to the disk every second, and at the end: of a power cut the last second may be lost, and is then run again. A
line that was cut off in its middle is removed when the journal is gone on with.
"""

from __future__ import annotations

import json
import os
import re
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, fields
from itertools import count
from pathlib import Path
from typing import IO, Any

from tautline.results.disk import Lock
from tautline.results.errors import ResultError, WriteError
from tautline.results.output_path import check_folder, make_folder
from tautline.results.tables.finding import Finding
from tautline.sweeps.cases import UNFINISHED, Row, program
from tautline.sweeps.inputs import hash_of
from tautline.sweeps.table import DATASET, RANKED, TABLE

NAME = "journal.ndjson"
FORMAT = "tautline sweep 1"
FORCED = 1.0
"""Longest time, s, between a line and its being forced to the disk."""


class Journal:
    """The journal in a folder.

    Parameters
    ----------
    folder : Path
        Made when it is claimed.
    mark : str
        Hash of what the sweep is.
    cases : int
    resume : bool
        Whether to go on with the journal that is there.
    files : mapping, optional
        Path -> hash of the files that the sweep reads, to tell which of them is another one.
    about : mapping, optional
        Key -> what the sweep's file says of it, to tell which of them is another one.

    Raises
    ------
    ResultError
        For a journal that cannot be gone on with, and one that would be lost.
    """

    def __init__(
        self, folder: Path, mark: str, cases: int, resume: bool, files: Mapping[str, str] | None = None,
        about: Mapping[str, Any] | None = None,
    ) -> None:  # fmt: skip
        self.path, self.mark, self.cases, self.files = folder / NAME, mark, cases, dict(files or {})
        # As it is read again: of tuples lists.
        self.about = json.loads(json.dumps(dict(about or {}), default=str))
        self._resume = resume
        self._file: IO[bytes] | None = None
        self._forced = 0.0
        self._lock = Lock(self.path)
        self._made = False
        self._look()

    def _look(self) -> None:
        """Read what is in the folder, and refuse what this sweep cannot follow or go on with."""
        folder = self.path.parent
        self.done: set[int] = set()
        self.columns: dict[str, Finding] | None = None
        self.figures: list[str] = []
        self.aside: Path | None = None
        """Folder into which the files of a finished sweep that this one follows were moved; None for no such."""
        self._moved: list[str] = []
        if folder.exists() and not folder.is_dir():
            raise ResultError(folder, "is a file, and the results of a sweep go into a folder", "name another with -o")
        check_folder(folder)
        if not os.access(folder if folder.exists() else folder.parent, os.W_OK):
            raise ResultError(folder, "cannot be written to", "name another with -o")
        # What is there grows while it is read, and to go on with it would be no cure.
        self._refuse_writer(self._lock.holder())
        if not self.path.exists():
            if folder.is_dir() and any(not _is_own(one.name) for one in folder.iterdir()):
                raise ResultError(folder, "exists and holds other files", "name another folder with -o")
            return
        head = self._read()
        if not self._resume:
            if len(self.done) < int(head.get("cases", 0)):
                cause = f"holds {len(self.done)} finished cases of {head.get('cases')}: they would be lost"
                same = head.get("sweep") == self.mark
                cure = "go on with --resume" if same else "put the sweep back as it was and go on with --resume"
                raise ResultError(folder, cause, f"{cure}, or name another folder with -o")
            self.done, self.columns, self.aside, self._moved = set(), None, None, []
            return
        _check_program(folder, head.get("version"), head.get("sources"))
        if head.get("sweep") != self.mark:
            self._refuse(folder, head.get("files"), head.get("about"), int(head.get("cases", 0)))

    def _refuse(self, folder: Path, before: Any, about: Any, cases: int) -> None:
        """Raise ResultError for the journal of another sweep, and name the files or keys that make it another one."""
        before = before if isinstance(before, dict) else {}
        changed = [path for path, found in self.files.items() if before.get(path, found) != found]
        # A file by which no scene can be read any more is not among those that are read now.
        changed += [path for path, found in before.items() if path not in self.files and hash_of(path) != found]
        if changed:
            cause = f"belongs to another sweep: {', '.join(changed)} has been changed since it began"
            raise ResultError(folder, cause, "put the file back as it was, or name another folder with -o")
        other = "its scene, of which the title counts too, or the order of the keys under `vary`, is another one"
        told = ("; ".join(_differences(about, self.about)) or other) if isinstance(about, dict) else other
        cure = "name another folder with -o"
        # Without --resume an unfinished sweep is not written over.
        cure += ", or leave out --resume" if len(self.done) >= cases else ", or go on with the sweep as it was"
        raise ResultError(folder, f"belongs to another sweep: {told}", cure)

    def _read(self) -> dict[str, Any]:
        head: dict[str, Any] = {}
        for line in _lines(self.path):
            if "format" in line:
                head = line
                self._moved = [str(name) for name in line.get("moved") or ()]
                self.aside = self.path.parent / Path(str(line.get("aside"))).name if self._moved else None
            elif "columns" in line:
                self.columns = {name: Finding(None, *about) for name, about in line["columns"].items()}
            elif "figures" in line:
                self.figures = line["figures"]
            else:
                self.done.add(int(line["case"]))
        if head.get("format") != FORMAT:
            raise ResultError(self.path, "is no journal of a sweep that this version reads", "name another with -o")
        return head

    def claim(self) -> None:
        """Take the folder for this sweep alone, before its first case: hours may pass until that has ended.

        Another sweep may have come to it since it was looked into, so it is looked into again.

        Raises
        ------
        ResultError
            If another process writes to the folder, or has left there what is not to be written over.
        WriteError
            If nothing can be written there.
        """
        folder = self.path.parent
        self._made = not folder.exists()
        make_folder(folder)
        self._refuse_writer(self._guarded(self._lock.take))
        self._look()

    def _refuse_writer(self, writer: int | None) -> None:
        """Raise ResultError for a process that writes to the folder, 0 where its number is not known."""
        if writer is not None:
            who = f"process {writer}" if writer else "another process"
            raise ResultError(self.path, f"{who} is writing this sweep", "wait until it has ended, or name another")

    def begin(self) -> None:
        """Open the journal of a folder that was claimed; what is there is kept where it is gone on with.

        Raises
        ------
        WriteError
            If the journal cannot be written.
        """
        goes_on = self._resume and self.path.exists()
        if goes_on:
            _cut(self.path)
        else:
            self._guarded(self._set_aside)
        self._file = self._guarded(lambda: self.path.open("ab" if goes_on else "wb", buffering=0))
        if not goes_on:
            version, sources = program()
            head = {"format": FORMAT, "sweep": self.mark, "cases": self.cases, "version": version, "sources": sources}
            moved = {"aside": self.aside.name, "moved": self._moved} if self.aside is not None else {}
            self._write(head | {"files": self.files, "about": self.about} | moved)

    def _set_aside(self) -> None:
        """Move the files of the finished sweep that is there into a folder of their own.

        This sweep may stop early: they would stand beside its journal as if they were its own results.
        """
        folder, self.figures, figures = self.path.parent, [], self.figures
        names = [name for name in (*TABLES, *filter(_is_picture, figures), NAME) if (folder / name).is_file()]
        if NAME not in names:
            return
        self.aside = next(one for one in map(folder.joinpath, _names_aside()) if not one.exists())
        self.aside.mkdir()
        for name in names:
            (folder / name).rename(self.aside / name)
        self._moved = names

    def replace(self) -> None:
        """Remove what was set aside: this sweep has come to its end, and takes the place of the other."""
        if self.aside is None:
            return
        aside, moved = self.aside, self._moved

        def remove() -> None:
            for name in moved:
                if name in (*TABLES, NAME) or _is_picture(name):
                    (aside / name).unlink(missing_ok=True)
            if aside.is_dir() and not any(aside.iterdir()):
                aside.rmdir()

        self._guarded(remove)
        self.aside = None

    @property
    def begun(self) -> bool:
        """Whether lines can be written."""
        return self._file is not None

    def describe(self, columns: dict[str, Finding]) -> None:
        """Write what the columns are."""
        self.columns = columns
        self._write({"columns": {name: [one.unit, one.text, one.along] for name, one in columns.items()}})

    def add(self, row: Row) -> None:
        """Write a row; one of a case that was lost, or met a fault of the program, is not finished, and is left out."""
        if row.status in UNFINISHED:
            return
        if row.case in self.done:
            raise ValueError(f"case {row.case} is in the journal already")
        self._write(asdict(row))
        self.done.add(row.case)
        now = time.monotonic()
        if now - self._forced > FORCED:
            self.force()
            self._forced = now

    def _write(self, line: dict[str, Any]) -> None:
        text = json.dumps(line, ensure_ascii=False, allow_nan=False, separators=(",", ":")) + "\n"
        assert self._file is not None
        file = self._file
        self._guarded(lambda: file.write(text.encode()))

    def force(self) -> None:
        """Have all lines on the disk."""
        if self._file is not None:
            number = self._file.fileno()
            self._guarded(lambda: os.fsync(number))

    def _guarded(self, act: Any) -> Any:
        try:
            return act()
        except OSError as error:
            cause = f"cannot be written: {error.strerror or error}"
            raise WriteError(self.path, cause, "make room, and go on with --resume") from None

    def rows(self) -> Iterator[Row]:
        """All rows, as they stand in the file."""
        if self.path.exists():
            for line in _lines(self.path):
                if "case" in line:
                    yield Row(**line)

    def close(self) -> None:
        """Close the file, with all lines on the disk, and let others have the folder; an empty one is not left."""
        if self._file is not None:
            try:
                self.force()
            finally:
                file, self._file = self._file, None
                try:
                    file.close()
                finally:
                    self._leave()
        else:
            self._leave()

    def _leave(self) -> None:
        """Let others have the folder; one that was made for the sweep and is empty goes again."""
        self._lock.give_back()
        if self._made:
            # One with anything in it, such as a sweep that has claimed it by now, is not removed.
            with suppress(OSError):
                self.path.parent.rmdir()
            self._made = False


def _differences(before: Mapping[str, Any], now: Mapping[str, Any]) -> Iterator[str]:
    """In which keys two sweeps differ; of a list what only one of them has."""
    for key in dict.fromkeys([*before, *now]):
        old, new = before.get(key), now.get(key)
        if old == new:
            continue
        if isinstance(old, list) and isinstance(new, list):
            only = [[_word(one) for one in a if one not in b] for a, b in ((old, new), (new, old))]
            words = [
                f"{verb} {', '.join(names)}" for verb, names in zip(("had", "now has"), only, strict=True) if names
            ]
            yield f"`{key}` {' and '.join(words) or 'has another order'}"
        elif isinstance(old, dict) and isinstance(new, dict):
            yield from (f"in `{key}`, {text}" for text in _differences(old, new))
        elif isinstance(old, (dict, list)) or isinstance(new, (dict, list)):
            yield f"`{key}` is another one"
        else:
            yield f"`{key}` was {_word(old)} and is {_word(new)}"


def _word(value: Any) -> str:
    """A value of a sweep's file in a sentence."""
    if value is None:
        return "not given"
    if isinstance(value, dict):
        return " ".join(str(one) for one in value.values())
    return str(value)


def _check_program(folder: Path, version: Any, sources: Any) -> None:
    """Raise ResultError for a journal that another program has begun: its rows would stand beside those of this one.

    The number alone does not tell: a version that is worked on keeps it while its sources change.
    """
    here, of_here = program()
    if version == here and sources == of_here:
        return
    if version == here:
        cause = f"was begun with Tautline {here} of other sources than those that are here now"
        cure = "run with the sources that began it, or name another folder with -o"
        raise ResultError(folder, f"{cause}: one table would hold rows of two programs", cure)
    if isinstance(version, str):
        cause = f"was begun with Tautline {version}, and this is Tautline {here}"
        cure = f"run with Tautline {version}, or name another folder with -o"
    else:
        cause = f"was begun with an older Tautline that did not note its version, and this is Tautline {here}"
        cure = "run with the Tautline that began it, or name another folder with -o"
    raise ResultError(folder, f"{cause}: one table would hold rows of two versions", cure)


def list_figures(folder: Path, written: Sequence[Path]) -> None:
    """Note in the journal which figures of a folder are the sweep's, and remove those that it had before and no more.

    What the journal does not list is somebody else's and is left alone.

    Raises
    ------
    ResultError
        For a journal that is damaged, or cannot be written.
    """
    path, names = folder / NAME, [one.name for one in written]
    if not path.exists():
        return
    earlier: list[str] = []
    for line in _lines(path):
        earlier = line.get("figures", earlier)
    if earlier == names:
        return
    try:
        with path.open("ab") as file:
            file.write((json.dumps({"figures": names}, ensure_ascii=False) + "\n").encode())
        _remove(folder, [name for name in earlier if name not in names])
    except OSError as error:
        raise WriteError(path, f"cannot be written: {error.strerror or error}", "make room") from None


def _remove(folder: Path, figures: Sequence[str]) -> None:
    """Remove pictures by their names, in the folder itself only."""
    for name in filter(_is_picture, figures):
        (folder / name).unlink(missing_ok=True)


def _is_picture(name: str) -> bool:
    """Whether a name is that of a picture in the folder itself."""
    return Path(name).name == name and Path(name).suffix in PICTURES


def _is_own(name: str) -> bool:
    """Whether a folder without a journal may hold this: a sweep that was killed as it began leaves it."""
    return name in OWN or re.fullmatch(rf"{ASIDE}(-\d+)?", name) is not None


def _names_aside() -> Iterator[str]:
    yield ASIDE
    yield from (f"{ASIDE}-{k}" for k in count(2))


TABLES = (DATASET, TABLE, RANKED)
ASIDE = "earlier"
"""Folder for the files of a sweep that another one follows."""
PICTURES = (".png", ".svg", ".pdf")
ROW = {one.name for one in fields(Row)}
OWN = (f".{NAME}.lock", NAME)
"""Files of ours that a folder without a journal may hold."""


def _lines(path: Path) -> Iterator[dict[str, Any]]:
    """Whole lines of a journal."""
    cases: Any = None
    try:
        with path.open("rb") as file:
            for number, text in enumerate(file, start=1):
                if not text.endswith(b"\n"):
                    return
                line = _line(text)
                damage = "" if line is not None else "is none of a sweep"
                if line is not None and isinstance(cases, int) and "case" in line and not 0 <= line["case"] < cases:
                    damage = f"has case {line['case']}, and the sweep only {cases} cases, from 0 on"
                if damage or line is None:
                    raise ResultError(path, f"is damaged: line {number} {damage}", "name another folder with -o")
                cases = line.get("cases", cases)
                yield line
    except OSError as error:
        raise ResultError(path, f"cannot be read: {error}", "name another folder with -o") from None


def _line(text: bytes) -> dict[str, Any] | None:
    """What a line of a journal says; None for anything else."""
    try:
        line = json.loads(text.decode("utf8"))
    except (ValueError, RecursionError):
        # Brackets within brackets without end are damage as well.
        return None
    return line if _is_line(line) else None


def _is_line(line: Any) -> bool:
    """Whether a line is one that a journal writes: its head, its columns, its figures, or a row."""
    if not isinstance(line, dict):
        return False
    if "format" in line or isinstance(line.get("columns"), dict):
        return True
    if "figures" in line:
        names = line["figures"]
        return isinstance(names, list) and all(isinstance(name, str) for name in names)
    return isinstance(line.get("case"), int) and line.keys() <= ROW and "status" in line


def _cut(path: Path) -> None:
    """Remove a last line that was cut off."""
    with path.open("rb+") as file:
        whole = 0
        for text in file:
            if text.endswith(b"\n"):
                whole += len(text)
        file.truncate(whole)
