"""What is doubtful of a sea: waves steeper than waves are, too few of them, phases that can be read in two ways."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from crane.sea.frames import MOTIONS
from crane.sea.vessel import Response
from crane.sea.waves import sines
from tautline.scene.functions import Harmonic, Spectrum, terms_of
from tautline.scene.vector import EARTH_GRAVITY
from tautline.system.time_functions import jonswap
from tautline.system.waves import Waves, wave_number

STEEP = ((8.0, 1.0 / 15.0), (15.0, 1.0 / 25.0))
"""Peak period, s, and the largest wave steepness 2 pi Hs / (g Tp^2) there; DNV-RP-C205, section 3.5.4."""
BREAKS = 0.142
"""Height over length of a regular wave in deep water that breaks; times tanh(k d) in water of a depth d."""
SHALLOW = 0.6
"""Significant height over depth of a sea that breaks: root-mean-square waves are 0.42 of the depth then."""
FEWEST_WAVES = 5.0
"""Number of equal waves below which a sum of sines looks like no sea at all, whatever is asked of it."""
AMBIGUOUS = math.radians(150.0)
"""Step of a phase from row to row, to the near side, from which on the far side may be meant."""
FELT = 0.02
"""Share of the largest response from which on a phase counts."""
LARGEST_TURN = math.radians(20.0)
"""Half of the turn from crest to trough in the significant wave beyond which no vessel works: the largest in three
hours is about twice that."""
TURN = 2.0 * math.pi
FULL = math.radians(0.05)
"""Angle that a step may lack of a whole or half a turn and count as one."""
ROUNDED = 1e-9
"""Share by which a number may be above a bound and not pass it: degrees are rounded as they become radians."""


def highest(period: float, gravity: float = EARTH_GRAVITY) -> float:
    """Largest significant height, m, of a peak period, s, by the limit of steepness."""
    steepness = float(np.interp(period, [one[0] for one in STEEP], [one[1] for one in STEEP]))
    return steepness * gravity * period**2 / TURN


def equal_waves(sea: Spectrum) -> float:
    """Number of equal waves whose sum has a tail as short as that of the components; infinite without any energy."""
    energy = jonswap(sea)[0] ** 2
    return float(energy.sum() ** 2 / (energy**2).sum()) if energy.any() else math.inf


def doubts_of_sea(sea: Spectrum, gravity: float) -> Iterator[tuple[str, str]]:
    """Keys of a spectrum and sentences."""
    most = highest(sea.peak_period, gravity)
    if sea.significant_height > most * (1.0 + ROUNDED):
        text = (
            f"waves of a peak period of {sea.peak_period:g} s are {most:.3g} m high at most, for steeper ones break "
            f"(DNV-RP-C205, 3.5.4). These are {sea.significant_height:g} m. Give lower waves or a longer period"
        )
        yield "significant_height", text
    number = equal_waves(sea)
    if number < FEWEST_WAVES:
        text = (
            f"the sea has few components, no more than {number:.2g} if all were of one size. That is a swing of a few "
            "periods, and no sea: its period and its extremes depend on the seed. Give `components: 200` or more"
        )
        yield "components", text


def doubts_of_depth(height: float, depth: float) -> Iterator[str]:
    """A sentence on a sea whose significant height, m, is more than water of a depth, m, lets it have."""
    if height > SHALLOW * depth:
        yield (
            f"significant waves over {depth:.3g} m of water are {SHALLOW * depth:.3g} m high at most, for higher ones "
            f"break (Thornton and Guza, 1983). These are {height:.4g} m. Give lower waves, or see whether ground.level "
            "is the sea bed"
        )


def doubts_of_waves(elevation: Any, waves: Waves) -> Iterator[tuple[str, str]]:
    """Keys below the elevation of waves of their own, and sentences.

    Seas of a sum are judged alone, and then together unless one of them breaks alone.
    """
    terms = list(terms_of(elevation))
    seas = {key: term for key, term in terms if isinstance(term, Spectrum)}
    alone: list[tuple[str, str]] = []
    for key, sea in seas.items():
        alone += ((f"{key}spectrum.{name}", text) for name, text in doubts_of_sea(sea, waves.gravity))
        high = doubts_of_depth(sea.significant_height, waves.depth)
        alone += ((f"{key}spectrum.significant_height", text) for text in high)
    yield from alone
    if len(seas) > 1 and not any(key.endswith("significant_height") for key, _ in alone):
        yield from (("sum", text) for text in _together(list(seas.values()), waves))
    yield from _doubts_of_regular({key: term for key, term in terms if isinstance(term, Harmonic)}, waves)
    if waves.ramp == 0.0:
        text = (
            "the waves have their full height at t = 0, and what is in them is at rest then: the water meets it at "
            "once. Give a `ramp`, such as two periods"
        )
        yield "ramp", text


def _together(seas: Sequence[Spectrum], waves: Waves) -> Iterator[str]:
    """Sentences on seas that break as one: their energies add up, and at their mean period they are too high.

    Spectra that differ in nothing but their height are the same waves, whose heights add up.
    """
    same: dict[str, list[Spectrum]] = {}
    for sea in seas:
        same.setdefault(repr(sea.model_copy(update={"significant_height": 0.0})), []).append(sea)
    rows = [(sum(one.significant_height for one in group), group[0].peak_period) for group in same.values()]
    height = math.hypot(*(one for one, _ in rows))
    if height == 0.0:
        return
    # The mean square of the frequency, by energy: so is the period of a sea's zero crossings found.
    period = height / math.hypot(*(one / time for one, time in rows))
    most = highest(period, waves.gravity)
    if height > most * (1.0 + ROUNDED):
        yield (
            f"these {len(seas)} seas together have a significant height of {height:.3g} m and a mean peak period of "
            f"{period:.3g} s. Waves of that period are {most:.3g} m high at most, for steeper ones break (DNV-RP-C205, "
            "3.5.4). Give lower waves or longer periods"
        )
    yield from doubts_of_depth(height, waves.depth)


def _doubts_of_regular(harmonics: dict[str, Harmonic], waves: Waves) -> Iterator[tuple[str, str]]:
    """Keys and sentences of regular waves that break; those of one period are one wave, by their phases."""
    groups: dict[str, list[str]] = {}
    parts = {key: next(sines(term)) for key, term in harmonics.items()}
    for key, (_, frequency, _) in parts.items():
        groups.setdefault(f"{float(frequency[0]):.9g}", []).append(key)
    for keys in groups.values():
        frequency = parts[keys[0]][1]
        size = abs(sum(complex(parts[key][0][0] * np.exp(1j * parts[key][2][0])) for key in keys))
        number = float(wave_number(frequency, waves.depth, waves.gravity)[0])
        most = BREAKS * TURN / number * math.tanh(min(number * waves.depth, 30.0))
        if 2.0 * size > most * (1.0 + ROUNDED):
            what = "This one is" if len(keys) == 1 else f"The {len(keys)} of this period are one wave,"
            text = (
                f"waves of a period of {TURN / float(frequency[0]):.4g} s are {most:.3g} m high at most, for higher "
                f"ones break (Miche, 1944). {what} {2.0 * size:.4g} m high, from trough to crest"
            )
            yield f"{keys[0]}harmonic.amplitude", text


def doubts_of_turns(sea: Spectrum, name: str) -> Iterator[tuple[str, str]]:
    """Key and sentence of a rotation that goes with a sea, and that the vessel would hardly survive."""
    angle = 0.5 * abs(sea.rao) * sea.significant_height
    if angle > LARGEST_TURN * (1.0 + ROUNDED):
        degrees = math.degrees(sea.rao)
        text = (
            f"{sea.rao:.4g} rad/m is {degrees:.3g} deg per metre of wave. In a sea of {sea.significant_height:g} m the "
            f"{name} is then {math.degrees(angle):.3g} deg to either side in the significant wave, and up to about "
            f"twice that. A bare number is in rad/m: write its unit if it is in deg/m"
        )
        yield "rao", text


def doubts_of_phases(response: Response, direction: float | None = None) -> Iterator[str]:
    """Motions whose phase steps so far from row to row that between them it may go the other way round.

    Phases within a turn are wrapped, and the near side is meant. Those that run on beyond a turn are written out, and
    then a step of more than half a turn is one. The direction of the sea, rad, is that of the rows, where there is one.
    """
    of = "" if direction is None else f" at direction {math.degrees(direction):.6g} deg"
    for name in MOTIONS:
        if name not in response.written:
            continue
        size, written, used = response.amplitude[name], response.written[name], response.phase[name]
        felt = np.minimum(size[1:], size[:-1]) > FELT * float(size.max(initial=0.0))
        far = np.abs(np.diff(used)) > AMBIGUOUS * (1.0 + ROUNDED)
        if float(np.ptp(written)) > TURN * (1.0 + ROUNDED):
            far |= np.abs(np.diff(written)) > 0.5 * TURN * (1.0 + ROUNDED)
        if (at := np.flatnonzero(far & felt)).size:
            k = int(at[0])
            low, high = response.frequency[k], response.frequency[k + 1]
            step, cure = _step(float(used[k + 1] - used[k]))
            yield (
                f"{response.path}: the phase of {name}{of} goes from {math.degrees(written[k]):.4g} to "
                f"{math.degrees(written[k + 1]):.4g} deg between {low:.4g} and {high:.4g} rad/s. {step}. {cure}"
            )


def _step(used: float) -> tuple[str, str]:
    """How a step of a phase, rad, is taken, and what to do where another is meant."""
    wrong = "If another way is meant, motions between these rows are wrong"
    if abs(used) < FULL:
        cure = "Write both phases within one turn, or add rows if the phase turns between them"
        return f"That is a whole turn, and is taken as no step. {wrong}", cure
    if abs(used) > 0.5 * TURN - FULL:
        cure = (
            "Add rows, so that no phase steps by more than 150 deg. If the response goes through zero and changes its "
            "sign there, add a row with the amplitude 0 at that frequency"
        )
        return f"That is half a turn: both ways are as long. {wrong}", cure
    cure = "Add rows, so that no phase steps by more than 150 deg"
    if abs(used) <= AMBIGUOUS * (1.0 + ROUNDED):
        cure += ", or write the phases within one turn"
    return f"It is taken the short way, by {math.degrees(used):.4g} deg. {wrong}", cure
