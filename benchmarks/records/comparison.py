"""Records that others made, beside the twin and the model: writes docs/records.md.

A published torsional start-up is in data/records. The measured stick-slip rig of UFRJ is not, as it has no licence:

    python -m benchmarks.records.comparison                             the start-up
    python -m benchmarks.records.comparison --rig 175_completo.mat      also the rig: a CSV, and what the bit did
    python -m benchmarks.records.comparison --rig 175_completo.mat --scene rig.yaml --top TORQUE SPEED
                                                                    and the twin's severity from the top beside it
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import tautline
from benchmarks import ROOT
from benchmarks.page import table
from benchmarks.records import torsional_reference, torsional_start_up, ufrj_rig
from drillstring.twin.torsional_line import line_of
from tautline.twin.sources.opening import open_source

START_UP = ROOT / "data" / "records" / "torsional_start_up.csv"
PAGE = ROOT / "docs" / "records.md"
BREAK_OFF, TWIST = 5.85930522141777 / (1.0 - 2.0 * (1.0 - torsional_start_up.RATIO)), 27.432806491615665
"""Published with the curve: torque of all static friction, kN m, from their least torque, and its twist, rad."""
WEAKENING = {"law": "regularised", "slip_velocity": 0.002, "decay_velocity": 0.11}
"""Friction that falls to the kinetic one about the published 1.5 rad/s, at the pipe's surface, m/s."""
SPANS = ((0.0, 2.0), (2.0, 4.0), (4.0, 8.0), (8.0, 13.0))
"""Stretches over which deviations are told, s."""


class Extreme(NamedTuple):
    """A torque of the drive, kN m, and its time, s."""

    value: float
    time: float

    def __str__(self) -> str:
        return f"{self.value:.2f} at {self.time:.2f} s"


class StartUp(NamedTuple):
    """Extremes of a start-up, largest twist between top and bit, rad (None of a curve), deviations, kN m, by span."""

    name: str
    first: Extreme
    low: Extreme
    peak: Extreme
    least: Extreme | None
    twist: float | None
    rms: tuple[float, ...]


def published() -> tuple[np.ndarray, np.ndarray]:
    """Times (n,) s and torques of the drive (n,) kN m of the published start-up, by the twin's own reader."""
    source = open_source(str(START_UP), ["drive_torque"])
    rows = []
    while not source.ended:
        record = source.poll(0.0)
        if record is not None:
            rows.append((record.time, record.values["drive_torque"]))
    source.close()
    time, torque = np.array(rows).T
    return time, torque


def features(name: str, time: np.ndarray, torque: np.ndarray, twist: float | None, rms: tuple[float, ...]) -> StartUp:
    """The extremes of a curve (n,) s and kN m."""

    def extreme(begin: float, end: float, largest: bool) -> Extreme:
        part = np.flatnonzero((time >= begin) & (time <= end))
        k = part[(np.argmax if largest else np.argmin)(torque[part])]
        return Extreme(float(torque[k]), float(time[k]))

    least = extreme(9.0, 13.0, False) if time[-1] >= 13.0 - 1e-9 else None
    return StartUp(name, extreme(0, 1, True), extreme(0.5, 3, False), extreme(5, 10, True), least, twist, rms)


def compared(result: Any, name: str, time: np.ndarray, torque: np.ndarray) -> StartUp:
    """A run beside a curve at times (n,) s with torques (n,) kN m."""
    twist = float((result["rotation"][:, 0] - result["rotation"][:, -1]).max())
    curve = torsional_reference.Curve(result.time, result["drive_torque"] / 1e3, twist)
    return beside(curve, name, time, torque)


def beside(curve: torsional_reference.Curve, name: str, time: np.ndarray, torque: np.ndarray) -> StartUp:
    """A curve beside another at times (n,) s with torques (n,) kN m."""
    kept = time <= curve.time[-1] + 1e-9
    t, reference = time[kept], torque[kept]
    own = np.interp(t, curve.time, curve.torque)
    rms = tuple(
        float(np.sqrt(np.mean((own - reference)[(t >= a) & (t <= b)] ** 2))) for a, b in SPANS if t[-1] >= b - 1e-9
    )
    return features(name, t, own, curve.twist, rms)


def start_ups(elements: int = 60, step: float = 2e-3) -> list[StartUp]:
    """The published start-up; those of the model, by two friction laws; and the published equations by themselves."""
    time, torque = published()
    found = [features("published", time, torque, None, ())]
    scenes = (
        ("`drillstring`, friction falls at once (default)", torsional_start_up.scene(elements, step)),
        ("`drillstring`, friction falls by 1.5 rad/s", torsional_start_up.scene(elements, step, law=WEAKENING)),
        ("`drillstring`, likewise, the well as it lies", torsional_start_up.as_it_lies(elements, step, WEAKENING)),
    )
    for name, document in scenes:
        found.append(compared(tautline.simulate(tautline.read(document)), name, time, torque))
    for name, factor in (
        ("line alone, friction falls by 1.5 rad/s", torsional_reference.faded),
        ("line alone, published friction law", torsional_reference.switched),
    ):
        found.append(beside(torsional_reference.start_up(factor), name, time, torque))
    return found


def rig(file: Path, scene: Any, top: tuple[str, str] | tuple[()], csv: Path) -> list[ufrj_rig.Compared]:
    """Make a CSV of the rig's record; with the top's variables and a scene of the rig, also severities from the top."""
    ufrj_rig.convert(file, csv, top)
    if not top:
        return []
    titles = [title.split(" ")[0] for title in csv.open(encoding="utf8").readline().strip().split(",")]
    rows = np.loadtxt(csv, delimiter=",", skiprows=1)
    bit, torque, speed = (rows[:, titles.index(name)] for name in ("bit_speed", "torque", "speed"))
    return ufrj_rig.severities(rows[:, 0], bit, torque, speed, line_of(tautline.read(scene)))


def _start_up_part(found: list[StartUp]) -> str:
    rows = []
    for one in found:
        deviations = [f"{value:.2f}" for value in one.rms] or ["–"] * len(SPANS)
        twist = f"{TWIST:.2f} (closed form)" if one.twist is None else f"{one.twist:.2f}"
        rows.append([one.name, one.first, one.low, one.peak, one.least, twist, *deviations])
    head = ["", "first peak", "low after it", "break-off peak", "least after it", "twist, rad"]
    return table([*head, *(f"rms {a:g} to {b:g} s" for a, b in SPANS)], rows)


def _relative(found: list[StartUp]) -> str:
    reference = found[0]
    rows = []
    for one in found[1:]:
        pairs = [(getattr(one, key), getattr(reference, key)) for key in ("first", "low", "peak", "least")]
        cells = [f"{100.0 * (a.value / b.value - 1.0):+.1f} %, {a.time - b.time:+.2f} s" for a, b in pairs]
        rows.append(
            [
                one.name,
                *cells,
                f"{100.0 * (one.peak.value / BREAK_OFF - 1.0):+.1f} %",
                f"{100.0 * (one.twist / TWIST - 1.0):+.1f} %",
            ]
        )
    return table(
        [
            "deviation",
            "first peak",
            "low after it",
            "break-off peak",
            "least after it",
            "peak from the closed form",
            "twist from the closed form",
        ],
        rows,
    )


def _rig_part(file: Path | None, found: list[ufrj_rig.Compared], csv: Path | None) -> str:
    if file is None or csv is None:
        return "Not run here: the file has to be downloaded by whoever runs it.\n"
    text = f"`{file.name}`, SHA-256 `{ufrj_rig.checksum(file)}`.\n\n"
    titles = [title.split(" ")[0] for title in csv.open(encoding="utf8").readline().strip().split(",")]
    rows = np.loadtxt(csv, delimiter=",", skiprows=1)
    time, bit = rows[:, 0], rows[:, titles.index("bit_speed")]
    own = ufrj_rig.measured_severity(time, bit)
    text += (
        f"{time.size} rows over {time[-1] - time[0]:.1f} s. Severity of the measured bit speed over all: {own:.2f}.\n"
    )
    if not found:
        return f"{text}\nNo torque and speed of the top were named (--top): the twin's severity is not judged.\n"
    lines = [
        (f"{c.time:.1f}", f"{c.measured:.2f}", f"{c.told:.2f}", f"{c.sd:.2f}", f"{c.frequency:.3f}") for c in found
    ]
    head = ("time, s", "measured at the bit", "told from the top", "its deviation", "frequency, Hz")
    return f"{text}\n{table(head, lines)}"


def page(found: list[StartUp], rig_text: str) -> str:
    """The page."""
    template = (ROOT / "benchmarks" / "records" / "page.md").read_text(encoding="utf8")
    return (
        template.replace("{start_up}", _start_up_part(found))
        .replace("{deviations}", _relative(found))
        .replace("{rig}", rig_text)
        .replace("{url}", ufrj_rig.URL)
        .replace("{commit}", ufrj_rig.COMMIT)
        .replace("{break_off}", f"{BREAK_OFF:.3f}")
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rig", type=Path, help=f"the record of UFRJ, from {ufrj_rig.URL}")
    parser.add_argument(
        "--scene", type=Path, help="a drillstring scene of that rig: its shaft, and its disc as a short section"
    )
    parser.add_argument(
        "--top", nargs=2, metavar=("TORQUE", "SPEED"), help="variables of the file: N m and rpm at the top"
    )
    parser.add_argument("--csv", type=Path, default=Path("ufrj_rig.csv"), help="what the rig's record becomes")
    given = parser.parse_args()
    if bool(given.top) != bool(given.scene) or (given.top and not given.rig):
        parser.error("--top and --scene belong together, and need --rig")
    text = _rig_part(None, [], None)
    if given.rig:
        try:
            told = rig(given.rig, given.scene, tuple(given.top or ()), given.csv)
        except ufrj_rig.NoRecord as refused:
            parser.error(str(refused))
        text = _rig_part(given.rig, told, given.csv)
    written = page(start_ups(), text)
    print(written)
    PAGE.write_text(written, encoding="utf8")


if __name__ == "__main__":
    main()
