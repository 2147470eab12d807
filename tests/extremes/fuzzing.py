"""Runs a case as the console scripts do, and says what is wrong with how it ended.

Good is: exit code 0, 2 or 3; one JSON object, in which no number is NaN or infinite; no traceback, no warning of
NumPy's; bad input named with its file, once, and nothing written for it; finite numbers in results; within a limit.
"""

from __future__ import annotations

import json
import re
import shutil
import signal
import sys
import tempfile
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from functools import cache
from io import StringIO
from pathlib import Path
from typing import Any
from unittest import mock

import h5py
import numpy as np
import typer
from extremes.mutations import Case, run_case, scene_case
from extremes.tables import table_case

from crane.application import Crane
from drillstring.application import Drillstring
from gardenhose.application import Gardenhose
from tautline.cable.application import Cable
from tautline.cli.output import console
from tautline.cli.run import run
from tautline.cli.verbs import make_app

APPLICATIONS = {"drillstring": Drillstring, "crane": Crane, "gardenhose": Gardenhose, "cable": Cable}
NOT_A_NUMBER = re.compile(r"(?<![\w.'\"-])[-+]?(nan|inf)(?![\w'\"-])", re.IGNORECASE)
CODES = {"check": (0, 2), "simulate": (0, 2, 3)}
MAKERS = {"check": scene_case, "table": table_case, "simulate": run_case}
LIMITS = {"check": 60.0, "table": 60.0, "simulate": 300.0}
"""Time that a case may take, s; a run may have to be compiled for."""


class TooLong(BaseException):
    """The limit has passed; not an Exception, which a command would report as its own fault."""


@cache
def command(application: str) -> typer.Typer:
    """The commands of an application, as its console script has them."""
    return make_app(APPLICATIONS[application]())


@contextmanager
def _limit(seconds: float) -> Iterator[None]:
    def stop(*_: Any) -> None:
        raise TooLong

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def _odd_numbers(value: Any, key: str = "") -> list[str]:
    """Keys of numbers that are not finite, before they are made null for JSON."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, float):
        return [] if np.isfinite(value) else [key]
    pairs = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, (list, tuple)) else ()
    return [odd for name, item in pairs for odd in _odd_numbers(item, f"{key}.{name}")]


@dataclass(frozen=True)
class Outcome:
    """How a command ended: exit code, or -1 where it did not; both outputs; warnings; numbers of its JSON object."""

    scene: Path
    code: int
    said: str
    printed: str
    warned: list[str]
    odd: list[str]
    failure: str
    written: list[Path]


def outcome(case: Case, verb: str, folder: Path, options: tuple[str, ...] = (), limit: float = 60.0) -> Outcome:
    """Write a case into a folder and run a verb on it."""
    scene = case.write(folder)
    before = sorted(folder.iterdir())
    said, printed, odd = StringIO(), StringIO(), []
    finite = console.finite

    def looked_at(value: Any) -> Any:
        odd.extend(_odd_numbers(value))
        return finite(value)

    begun, code, failure = time.perf_counter(), -1, ""
    with warnings.catch_warnings(record=True) as warned, mock.patch.object(console, "finite", looked_at):
        warnings.simplefilter("always")
        try:
            with redirect_stdout(printed), redirect_stderr(said), _limit(limit):
                run(command(case.application), [verb, str(scene), *options])
        except SystemExit as left:
            code = int(left.code or 0)
        except TooLong:
            failure = f"takes more than {limit:g} s"
        except BaseException as error:
            failure = f"raised {type(error).__name__}: {error}"
    if time.perf_counter() - begun > limit:
        failure = f"takes more than {limit:g} s"
    told = [f"{w.category.__name__}: {w.message} ({Path(w.filename).name}:{w.lineno})" for w in warned]
    written = [path for path in sorted(folder.iterdir()) if path not in before]
    return Outcome(scene, code, said.getvalue(), printed.getvalue(), told, odd, failure, written)


def faults(case: Case, verb: str, folder: Path, options: tuple[str, ...] = (), limit: float = 60.0) -> list[str]:
    """Run a case; what is wrong with how that ended, empty if nothing."""
    as_json = case.number % 8 < 6
    end = outcome(case, verb, folder, (*options, *(["--json"] if as_json else [])), limit)
    if end.failure:
        return [end.failure]
    found = [] if end.code in CODES[verb] else [f"exit code {end.code}: {end.said[-400:].strip()}"]
    found += end.warned + _in_text(end.said)
    found += [f"not finite in the JSON object: {', '.join(sorted(set(end.odd))[:5])}"] if end.odd else []
    if as_json:
        found += _in_object(end.printed, end.code, end.said)
    if end.written and (end.code == 2 or verb == "check"):
        found.append(f"wrote {', '.join(path.name for path in end.written)}")
    for path in end.written:
        found += _in_result(path) if path.suffix == ".nc" else []
    return list(dict.fromkeys(found))


def _in_text(text: str) -> list[str]:
    """What is wrong with what was said."""
    found = ["a traceback"] if "Traceback" in text else []
    for line in text.splitlines():
        # What stands in the file may be told: by its key, within marks, or as what is refused.
        told = " = " in line or "'" in line or "is not a finite number" in line
        if NOT_A_NUMBER.search(line) and not told:
            found.append(f"says {line[:160]}")
        if len(line) > 2000:
            found.append(f"a line of {len(line)} characters: {line[:80]}")
    return found


def _in_object(printed: str, code: int, text: str) -> list[str]:
    """What is wrong with the JSON object."""
    try:
        report = json.loads(printed)
    except ValueError:
        return ["no JSON object" if not printed else "more or less than one JSON object"]
    if code != 2:
        return []
    problems = report.get("problems") or []
    found = [] if problems else ["bad input without a problem"]
    for problem in problems:
        if not (problem["file"] and problem["cause"]):
            found.append(f"a problem without file or cause: {problem}")
    lines = [line for line in text.splitlines() if not line.startswith(("warning:", "note:", "  "))]
    shown = [json.dumps(problem) for problem in problems]
    if len(set(shown)) < len(shown):
        found.append(f"says it twice: {lines[0][:120] if lines else ''}")
    return found


def _in_result(path: Path) -> list[str]:
    """What is wrong with what was stored."""
    # Without xarray, which takes several times as long for a result of many variables as the run that is looked at.
    with h5py.File(path) as file:
        return [
            f"stored {name} is not finite" for name, item in file.items()
            if isinstance(item, h5py.Dataset) and item.dtype.kind == "f" and not np.isfinite(item[()]).all()
        ]  # fmt: skip


def looked_at(kind: str, number: int, folder: Path) -> str:
    """Make and run a case; a sentence on what is wrong, and its files stay in the folder; empty if nothing."""
    case, place = MAKERS[kind](kind, number), folder / f"{kind}{number}"
    verb = "simulate" if kind == "simulate" else "check"
    options = ("-o", str(place / "result.nc"), "--no-verify", "--quiet") if verb == "simulate" else ()
    found = faults(case, verb, place, options, LIMITS[kind])
    if not found:
        shutil.rmtree(place)
        return ""
    return f"{kind} {number} ({case.application}; {case.story}), in {place}: {'; '.join(found)}"


if __name__ == "__main__":
    again, which = sys.argv[1], int(sys.argv[2])
    print(looked_at(again, which, Path(tempfile.mkdtemp())) or f"{again} {which} ends well")
