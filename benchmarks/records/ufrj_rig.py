"""The measured stick-slip rig of UFRJ: its MATLAB file made a CSV that the twin reads, and the twin's severity.

The file is `175_completo.mat` of https://github.com/thiagoritto/drillstring (Real, Lobo, Ritto and Pinto, J. Petroleum
Science and Engineering 170 (2018) 755-762): 1 kHz, with speed (rpm), torque (N m) and weight (N) at the bit. The
repository states no licence: nobody but its authors may pass the file on, so a user downloads it himself.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from math import pi
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from drillstring.twin.severity import Settings, Severity
from drillstring.twin.torsional_line import TorsionalLine

COMMIT = "cdd65e27d7a69a849e3961e275804f4347fb79c0"
URL = f"https://raw.githubusercontent.com/thiagoritto/drillstring/{COMMIT}/175_completo.mat"
RPM = pi / 30.0
COLUMNS = {
    "Time_Sample_175_complete": ("time [s]", 1.0),
    "Bit_Speed_Sample_175_complete": ("bit_speed [rad/s]", RPM),
    "Bit_Torque_Sample_175_complete": ("torque_on_bit [N m]", 1.0),
    "WOB_Sample_175_complete": ("weight_on_bit [N]", 1.0),
}
"""Variables of the file, as the authors' script names them: heading of the CSV, and what makes SI of the values."""
BLOCK = 0.02
"""Time over which measured samples are averaged, s: the authors look at what is slower than 10 Hz."""


class NoRecord(ValueError):
    """A file that is not the rig's record; the text says what is missing, and the cure."""


def checksum(file: Path) -> str:
    """SHA-256 of a file."""
    return hashlib.sha256(file.read_bytes()).hexdigest()


def convert(file: Path, csv: Path, top: Sequence[str] = ()) -> int:
    """Write the record as a CSV file with one row a sample; return the number of rows.

    Parameters
    ----------
    file, csv : Path
        MATLAB file up to version 7, and what is written.
    top : sequence of str
        Names of the variables of torque (N m) and speed (rpm) at the top, where the file has them.

    Raises
    ------
    NoRecord
        Where the file cannot be read, lacks a variable, or has variables of different lengths.
    """
    wanted = dict(COLUMNS)
    if top:
        torque, speed = top
        wanted |= {torque: ("torque [N m]", 1.0), speed: ("speed [rad/s]", RPM)}
    held = _read(file)
    missing = [name for name in wanted if name not in held]
    if missing:
        there = ", ".join(name for name in held if not name.startswith("__"))
        raise NoRecord(f"{file}: has no variable {', '.join(missing)}; it has {there}: name those of the top by --top")
    columns = {title: np.ravel(held[name]).astype(float) * factor for name, (title, factor) in wanted.items()}
    if len({values.size for values in columns.values()}) != 1:
        sizes = ", ".join(f"{title}: {values.size}" for title, values in columns.items())
        raise NoRecord(f"{file}: its variables have different lengths ({sizes}): take the file as it was published")
    rows = np.stack(list(columns.values()), axis=1)
    np.savetxt(csv, rows, fmt="%.9g", delimiter=",", header=",".join(columns), comments="")
    return len(rows)


def _read(file: Path) -> dict[str, Any]:
    from scipy.io import loadmat

    try:
        return dict(loadmat(file))
    except NotImplementedError:
        raise NoRecord(f"{file}: is of MATLAB 7.3, which is not read: save it in MATLAB by `save -v7`") from None
    except (OSError, ValueError) as cause:
        raise NoRecord(f"{file}: cannot be read as a MATLAB file ({cause}): download it from {URL}") from None


class Compared(NamedTuple):
    """At the end of a window, s: severity measured at the bit, and that told from the top with its deviation."""

    time: float
    measured: float
    told: float
    sd: float
    frequency: float


def measured_severity(time: np.ndarray, speed: np.ndarray) -> float:
    """(max - min) / (2 mean) of a measured rotary speed (n,) at times (n,) s, after averages over `BLOCK`."""
    smooth = _averaged(time, speed)
    return float((smooth.max() - smooth.min()) / (2.0 * abs(smooth.mean())))


def severities(
    time: np.ndarray, bit: np.ndarray, torque: np.ndarray, speed: np.ndarray, line: TorsionalLine
) -> list[Compared]:
    """Severity by the bit's own sensor and by torque and speed at the top, once a window of the twin."""
    twin = Severity(line, Settings(torque_of_drive=False))
    t, signals = _averaged(time, time), [_averaged(time, values) for values in (bit, torque, speed)]
    found, due = [], t[0] + twin.span
    for k, now in enumerate(t):
        twin.add(float(now), float(signals[1][k]), float(signals[2][k]))
        if now < due:
            continue
        due += twin.span
        told = twin.stick_slip()
        if told is not None:
            # Whole periods: the mean of a part of one is not that of the rotation.
            whole = int(twin.span * told.frequency) / told.frequency
            window = (t > now - whole) & (t <= now)
            own = measured_severity(t[window], signals[0][window])
            found.append(Compared(float(now), own, told.severity, told.sd, told.frequency))
    return found


def _averaged(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Means over blocks of `BLOCK`; as they are, where the samples are as far apart."""
    count = max(1, round(BLOCK / float(np.median(np.diff(time)))))
    whole = values.size // count * count
    return values[:whole].reshape(-1, count).mean(axis=1)
