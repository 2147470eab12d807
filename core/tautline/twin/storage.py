"""The state of a twin in a file: killed at any moment and started again, it goes on with the same estimates.

The file is NumPy's .npz without objects: nothing in it can be run. It is written beside its place and then renamed, so
that there is a whole one at every moment.
"""

from __future__ import annotations

import json
import zipfile
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tautline.live.memory import State
from tautline.results.disk import cure_of
from tautline.results.errors import ResultError
from tautline.twin.estimation.horizon import Sample
from tautline.twin.memory import Memory, memory_of
from tautline.twin.sources.stated_units import Stated
from tautline.twin.watch import Watched
from tautline.whole_file import whole_file

if TYPE_CHECKING:
    from tautline.twin.twin import Twin

FORMAT = 5
CURE = "give the state that a twin of the same scene and map wrote, or remove the file to begin anew"
WORDS = frozenset({
    "format", "scene", "layout", "times", "unknowns", "channels", "origin", "now", "unsettled", "restarts", "zeros",
    "rows", "tracks", "health", "alarms", "blows_due", "paused",
})  # fmt: skip
ARRAYS = frozenset({
    "blocks", "at", "apart", "theta0", "mean", "prior", "prior_mean", "numbers", "spread", "correlation", "variance",
    "alike", "learned", "covariance", "rough", "largest", "missed", "told", "missed_at", "sample_time", "sample_y",
    "sample_y0", "sample_J", "sample_use", "sample_rows",
})  # fmt: skip
"""What every state of that format has."""


@dataclass
class Packed:
    """The state of a twin at one moment, apart from the twin, which may go on.

    Attributes
    ----------
    words : dict
        What is text and single numbers, for JSON.
    arrays : dict
        Name -> array.
    """

    words: dict[str, Any]
    arrays: dict[str, np.ndarray]

    def heard(self, more: Mapping[str, Any]) -> None:
        """Add to what is known of the rows of the source."""
        self.words["heard"] = {**self.words["heard"], **more}


def save(twin: Twin, path: Path) -> None:
    """Write the state of a twin; raises ResultError where that is not possible."""
    write(packed(twin), path)


def packed(twin: Twin) -> Packed:
    """The state of a twin as it is now."""
    estimate, readings = twin.estimate, twin.readings
    states = estimate.family.save()
    h = estimate.horizon
    words = {
        "format": FORMAT, "scene": states[0].scene, "layout": states[0].layout, "times": [s.time for s in states],
        "unknowns": [one.name for one in h.unknowns], "channels": [one.column for one in twin.plan.channels],
        "names": [one.name for one in twin.plan.channels],
        "origin": estimate.log.origin, "now": twin.now, "unsettled": twin.unsettled, "restarts": twin.restarts,
        "zeros": {str(k): v for k, v in readings.zeros.items()}, "rows": readings.rows.memory(),
        "tracks": [one.memory() for one in readings.tracks], "health": [one.memory() for one in readings.health],
        "alarms": twin.watch.alarms.memory(), "blows_due": estimate.family.blows_due,
        "operation": twin.operation.memory() if twin.operation else {}, "paused": twin.paused,
        "settling": twin.settling.memory(), "far": readings.far, "heard": twin.heard,
        "stepped": sorted(readings.stepped), "watch": twin.watch.watched(), "mark": twin.mark,
        "found": [h.found, h.begun], "stated": [[*place, names] for place, names in twin.stated.items()],
    }  # fmt: skip
    samples = list(h.samples)
    arrays = {
        "blocks": np.array([s.block for s in states]), "at": estimate.family.at, "apart": estimate.family.apart,
        "theta0": h.theta0, "mean": h.mean, "prior": h.prior, "prior_mean": h.prior_mean,
        "numbers": np.array([h.prior_time, h.released, h.since, h.changed]),
        "spread": h.spread, "correlation": h.correlation,
        "variance": h.variance, "alike": h.alike, "learned": h.learned, "covariance": h.covariance,
        "rough": h.rough, "largest": h.largest,
        "missed": h.missed, "told": h.told, "missed_at": np.array(h.missed_at),
        "sample_time": np.array([s.time for s in samples]), "sample_y": np.array([s.y for s in samples]),
        "sample_y0": np.array([s.y0 for s in samples]), "sample_J": np.array([s.J for s in samples]),
        "sample_use": np.array([s.use for s in samples]),
        "sample_rows": np.array([s.rows for s in samples]),
    }  # fmt: skip
    for name, waves in readings.waves.items():
        arrays[f"waves {name}"] = waves.memory()
    # What stands above is what programs of the same format have always read; this is all.
    arrays["held"], arrays["held_data"] = memory_of(twin)
    return Packed(json.loads(json.dumps(words)), {name: np.array(one) for name, one in arrays.items()})


def write(state: Packed, path: Path) -> None:
    """Write a state; raises ResultError where that is not possible."""
    arrays = {"words": np.frombuffer(json.dumps(state.words).encode(), np.uint8), **state.arrays}
    try:
        with whole_file(path) as waiting, waiting.open("wb") as file:
            np.savez(file, **arrays)  # type: ignore[arg-type]
    except OSError as error:
        cure = cure_of(path, "free some space, or give another --state")
        raise ResultError(path, f"the twin's state cannot be written: {error.strerror}", cure) from None


def load(twin: Twin, path: Path) -> float:
    """Let a twin go on from a file; gives the time of the data that it goes on from, s.

    Where another version of the program wrote it, whose simulations hold other things, the twin keeps the estimates and
    what alarms are judged by, and begins again from rest, as behind a long gap.

    Raises
    ------
    ResultError
        For what is no state of this scene and this map; the twin is as before then.
    """
    arrays, words = _read(path, CURE)
    mine, blocks = twin.estimate.family.save(), arrays["blocks"]
    foreign = ResultError(path, "belongs to another scene or another map", CURE)
    if len(blocks) != len(mine) or _is_of_another_map(twin, words):
        raise foreign
    try:
        memory = Memory(twin, arrays["held"], arrays["held_data"]) if "held" in arrays else None
        # States of earlier versions do not say what they watched: all goes on then.
        watched = {name: Watched(*one) for name, one in words.get("watch", {}).items()}
    except (ValueError, TypeError, KeyError, IndexError, AttributeError):
        why = "is no state of a twin, or was written by another version of the program"
        raise ResultError(path, why, "begin the twin anew, without --resume") from None
    own = words.get("operation")
    if twin.operation is not None and own:
        # What the machine has become meanwhile, such as a string with more stands, is another scene.
        grown = twin.operation.recall(own)
        if grown is not None:
            twin.become(grown)
            mine = twin.estimate.family.save()
    if words["scene"] != mine[0].scene:
        raise foreign
    if words["layout"] != mine[0].layout:
        _recall(twin, words, arrays)
        if memory is not None:
            memory.put_watch(twin)
        twin.notes += twin.watch.go_on_from(watched)
        twin.loss.begun = bool(np.isfinite(words["origin"]))
        twin.go_on_from_rest()
        return float(words["now"])
    twin.estimate.family.restore([
        State(time, words["scene"], words["layout"], block, 0)
        for time, block in zip(words["times"], blocks, strict=True)
    ])  # fmt: skip
    _recall(twin, words, arrays)
    if memory is not None:
        memory.put(twin)
    twin.notes += twin.watch.go_on_from(watched)
    return float(words["now"])


def stated_in(path: Path) -> Stated:
    """Units that were stated to the twin of a state, which a source is to know before it reads anything.

    Raises
    ------
    ResultError
        For what is no state.
    """
    try:
        return _stated(_read(path, CURE)[1])
    except (ValueError, TypeError):
        raise ResultError(path, "is no state of a twin", CURE) from None


def _stated(words: dict[str, Any]) -> Stated:
    """The same of its words; states of earlier versions have none."""
    return {(column, where): tuple(names) for column, where, names in words.get("stated", [])}


def _is_of_another_map(twin: Twin, words: dict[str, Any]) -> bool:
    """Whether the words of a state show that its map has other unknowns, columns or inputs than a twin's."""
    channels = twin.plan.channels
    names = [one.name for one in channels]
    return bool(
        words["unknowns"] != [one.name for one in twin.estimate.horizon.unknowns]
        or words["channels"] != [one.column for one in channels]
        # States of earlier versions do not say what the columns are.
        or words.get("names", names) != names or len(words["tracks"]) != len(twin.readings.tracks)
    )  # fmt: skip


def _read(path: Path, cure: str) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """Arrays of a state, and its words; refuses what is none, or one that lacks something."""
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        words = dict(json.loads(arrays["words"].tobytes()))
    except FileNotFoundError:
        raise ResultError(path, "there is no such file", cure) from None
    except (OSError, ValueError, KeyError, EOFError, TypeError, zipfile.BadZipFile):
        raise ResultError(path, "is no state of a twin", cure) from None
    if words.get("format", FORMAT) != FORMAT:
        raise ResultError(
            path, "was written by another version of the program", "begin the twin anew, without --resume"
        )
    if not (words.keys() >= WORDS and arrays.keys() >= ARRAYS):
        raise ResultError(path, "is no state of a twin", cure)
    return arrays, words


def _recall(twin: Twin, words: dict[str, Any], arrays: dict[str, np.ndarray]) -> None:
    estimate, readings = twin.estimate, twin.readings
    family, h = estimate.family, estimate.horizon
    family.at, family.apart = arrays["at"], arrays["apart"]
    family.set_parameters()
    family.blows_due = [(float(t), int(k)) for t, k in words["blows_due"]]
    for name in ("theta0", "mean", "prior", "prior_mean", "spread", "correlation", "covariance", "rough", "largest"):
        setattr(h, name, arrays[name])
    h.variance, h.alike, h.learned = arrays["variance"], arrays["alike"], arrays["learned"]
    h.missed, h.told, h.missed_at = arrays["missed"], arrays["told"], float(arrays["missed_at"])
    h.prior_time, h.released, h.since, h.changed = (float(x) for x in arrays["numbers"])
    if "found" in words:  # states of earlier versions have it in the deviations alone
        h.found, h.begun = bool(words["found"][0]), float(words["found"][1])
    h.samples = deque(
        Sample(float(arrays["sample_time"][i]), *(arrays[f"sample_{x}"][i] for x in ("y", "y0", "J", "use", "rows")))
        for i in range(len(arrays["sample_time"]))
    )
    if "found" not in words and h.samples:
        h.begun = h.samples[0].time
    estimate.log.origin, twin.now = float(words["origin"]), float(words["now"])
    twin.paused = bool(words["paused"])
    twin.unsettled, twin.restarts = float(words["unsettled"]), int(words["restarts"])
    twin.heard = dict(words.get("heard", {}))
    twin.stated = _stated(words)
    twin.mark = str(words.get("mark", ""))  # states of earlier versions have none, nor have results beside them
    readings.far, readings.stepped = dict(words.get("far", {})), set(words.get("stepped", []))
    twin.settling.recall(words.get("settling", twin.settling.memory()))
    readings.zeros = {int(k): float(v) for k, v in words["zeros"].items()}
    readings.rows.recall(words["rows"])
    for track, memory in zip(readings.tracks, words["tracks"], strict=True):
        track.recall(memory)
    for health, memory in zip(readings.health, words["health"], strict=True):
        health.recall(memory)
    twin.watch.alarms.recall(words["alarms"])
    for name, waves in readings.waves.items():
        waves.recall(arrays[f"waves {name}"])
    estimate.log.keep(twin.now, family.save())
