"""The state of a twin in a file: killed at any moment and started again, it goes on with the same estimates.

The file is NumPy's .npz without objects: nothing in it can be run. It is written beside its place and then renamed, so
that there is a whole one at every moment.
"""

from __future__ import annotations

import json
import zipfile
from collections import deque
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tautline.live.memory import State
from tautline.results.disk import cure_of
from tautline.results.errors import ResultError
from tautline.twin.estimation.horizon import Sample
from tautline.twin.memory import Memory, memory_of
from tautline.whole_file import whole_file

if TYPE_CHECKING:
    from tautline.twin.twin import Twin

FORMAT = 5


def save(twin: Twin, path: Path) -> None:
    """Write the state of a twin; raises ResultError where that is not possible."""
    estimate, readings = twin.estimate, twin.readings
    states = estimate.family.save()
    h = estimate.horizon
    words = {
        "format": FORMAT, "scene": states[0].scene, "layout": states[0].layout, "times": [s.time for s in states],
        "unknowns": [one.name for one in h.unknowns], "channels": [one.column for one in twin.plan.channels],
        "origin": estimate.log.origin, "now": twin.now, "unsettled": twin.unsettled, "restarts": twin.restarts,
        "zeros": {str(k): v for k, v in readings.zeros.items()}, "rows": readings.rows.memory(),
        "tracks": [one.memory() for one in readings.tracks], "health": [one.memory() for one in readings.health],
        "alarms": twin.watch.alarms.memory(), "blows_due": estimate.family.blows_due,
        "operation": twin.operation.memory() if twin.operation else {}, "paused": twin.paused,
        "settling": twin.settling.memory(), "far": readings.far, "heard": twin.heard,
        "stepped": sorted(readings.stepped),
    }  # fmt: skip
    samples = list(h.samples)
    arrays = {
        "words": np.frombuffer(json.dumps(words).encode(), np.uint8),
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
    try:
        with whole_file(path) as waiting, waiting.open("wb") as file:
            np.savez(file, **arrays)  # type: ignore[arg-type]
    except OSError as error:
        cure = cure_of(path, "free some space, or give another --state")
        raise ResultError(path, f"the twin's state cannot be written: {error.strerror}", cure) from None


def load(twin: Twin, path: Path) -> float:
    """Let a twin go on from a file; gives the time of the data that it goes on from, s.

    Raises
    ------
    ResultError
        For what is no state of this scene and this map; the twin is as before then.
    """
    cure = "give the state that a twin of the same scene and map wrote, or remove the file to begin anew"
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        words = json.loads(arrays["words"].tobytes())
        blocks = arrays["blocks"]
    except FileNotFoundError:
        raise ResultError(path, "there is no such file", cure) from None
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        raise ResultError(path, "is no state of a twin", cure) from None
    unknowns = twin.estimate.horizon.unknowns
    own = words.get("operation")
    if twin.operation is not None and own and words.get("unknowns") == [one.name for one in unknowns]:
        # What the machine has become meanwhile, such as a string with more stands, is another scene.
        grown = twin.operation.recall(own)
        if grown is not None:
            twin.become(grown)
    mine = twin.estimate.family.save()
    same = (
        words["scene"] == mine[0].scene and words["layout"] == mine[0].layout
        and words["unknowns"] == [one.name for one in unknowns]
        and words["channels"] == [one.column for one in twin.plan.channels] and len(blocks) == len(mine)
    )  # fmt: skip
    if words["format"] != FORMAT:
        raise ResultError(
            path, "was written by another version of the program", "begin the twin anew, without --resume"
        )
    if not same:
        raise ResultError(path, "belongs to another scene or another map", cure)
    try:
        memory = Memory(twin, arrays["held"], arrays["held_data"]) if "held" in arrays else None
    except (ValueError, TypeError, KeyError, IndexError):
        raise ResultError(path, "is no state of a twin", cure) from None
    twin.estimate.family.restore([
        State(time, words["scene"], words["layout"], block, 0)
        for time, block in zip(words["times"], blocks, strict=True)
    ])  # fmt: skip
    _recall(twin, words, arrays)
    if memory is not None:
        memory.put(twin)
    return float(words["now"])


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
    h.samples = deque(
        Sample(float(arrays["sample_time"][i]), *(arrays[f"sample_{x}"][i] for x in ("y", "y0", "J", "use", "rows")))
        for i in range(len(arrays["sample_time"]))
    )
    estimate.log.origin, twin.now = float(words["origin"]), float(words["now"])
    twin.paused = bool(words["paused"])
    twin.unsettled, twin.restarts = float(words["unsettled"]), int(words["restarts"])
    twin.heard = dict(words.get("heard", {}))
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
