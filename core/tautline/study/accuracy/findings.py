"""What a study has found, and which setting to take, in a sentence."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from statistics import median

from tautline.integrators.status import StoppedEarly
from tautline.study.accuracy.reference import Reference
from tautline.study.trials.errors import Errors
from tautline.study.trials.history import Watched
from tautline.study.trials.trial import Trial

SHORTER = 0.95
"""Mean step over the one asked for below which a run took shorter steps by itself."""
STALLED = 0.8
"""Share of the error with the next larger step above which an error has stopped falling."""


@dataclass(frozen=True)
class Row:
    """A run and how far it is off; no errors where it did not come to its end."""

    trial: Trial
    errors: Errors | None

    @property
    def factor(self) -> float | None:
        """Real-time factor."""
        reached = None if self.trial.result is None else float(self.trial.result.time[-1])
        return None if not reached or self.trial.wall_time is None else self.trial.wall_time / reached

    @property
    def excess(self) -> float:
        """How much too long the processor time may be, s: what disturbs a run only makes it longer."""
        return median(self.trial.cpu) - min(self.trial.cpu) if self.trial.cpu else 0.0

    @property
    def step_taken(self) -> float | None:
        """Mean step, s; None without a run."""
        if self.trial.result is None or not self.trial.attribute("steps"):
            return None
        time = self.trial.result.time
        return float(time[-1] - time[0]) / int(self.trial.attribute("steps"))

    @property
    def shortened(self) -> bool:
        """Whether a run took shorter steps than the fixed one that it was asked for, as where iterations failed."""
        asked, taken = self.trial.setting.step, self.step_taken
        if self.trial.setting.step_error is not None or asked is None or taken is None:
            return False
        # The last step before a frame may be cut.
        return taken < SHORTER * asked


@dataclass(frozen=True)
class Study:
    """What a study has found.

    Attributes
    ----------
    rows : tuple of Row
    reference : Reference or None
        None where no four runs of it came to their end.
    watched : Watched
    tolerance : float
    tangent : float or None
        Largest relative error of the tangent along a run, of the scene or of its implicit form; None if it has none.
    load : tuple of float
        Mean number of processes that wanted a processor in the last minute, before and after.
    left_out : tuple of str
        What a quick look has not tried.
    stop : StoppedEarly or None
        How the scene as it stands stopped, if it did; other settings have come to their end then.
    unseen : str
        Which part of the run was not looked at, and what happens there; empty where all was.
    """

    rows: tuple[Row, ...]
    reference: Reference | None
    watched: Watched
    tolerance: float
    tangent: float | None
    load: tuple[float, float]
    warnings: tuple[str, ...] = field(default=())
    left_out: tuple[str, ...] = ()
    interrupted: bool = False
    stop: StoppedEarly | None = None
    unseen: str = ""

    @property
    def advice(self) -> str:
        """One sentence: which setting to take."""
        return advice(self)


def good_enough(study: Study) -> list[Row]:
    """Runs whose errors, with those of the reference, are below the tolerance, the cheapest first.

    It is processor time that is paid: wall time is also that of others on the machine. Of runs whose times differ by
    less than their repetitions do, that with the longest step is the cheapest.
    """
    left = sorted(filter(lambda row: _is_enough(study, row), study.rows), key=_price)
    found = []
    while left:
        alike = [row for row in left if _price(row) - _price(left[0]) <= max(row.excess, left[0].excess)]
        found.append(max(alike, key=lambda row: row.step_taken or 0.0))
        left.remove(found[-1])
    return found


def _is_enough(study: Study, row: Row) -> bool:
    return row.errors is not None and row.trial.cpu_time is not None and _judged(study, row) <= study.tolerance


def _price(row: Row) -> float:
    return row.trial.cpu_time or 0.0


def real_time(study: Study) -> list[Row]:
    """Runs that are faster than real time, the most accurate first."""
    rows = [row for row in study.rows if row.errors is not None and row.factor is not None and row.factor < 1.0]
    return sorted(rows, key=lambda row: _largest(study, row))


def doubts(study: Study) -> dict[str, float]:
    """By how much the reference's force and twist may be off themselves, relative; zero where that is not known."""
    found = study.reference
    return {"force": (found and found.force_error) or 0.0, "twist": (found and found.twist_error) or 0.0}


def _not_judged(study: Study) -> list[str]:
    """What does not count, of force and twist: what the reference does not know to the tolerance itself."""
    return [kind for kind, doubt in doubts(study).items() if doubt > study.tolerance]


def _further(study: Study, row: Row) -> dict[str, float]:
    """Errors of a run in force and twist, those that count."""
    assert row.errors is not None
    found = {"force": row.errors.force, "twist": row.errors.twist}
    return {kind: x for kind, x in found.items() if x is not None and kind not in _not_judged(study)}


def _largest(study: Study, row: Row) -> float:
    """The largest error of a run: of position, of the force's amplitude, of twist, and of phase in rad.

    A phase of so many radians moves an oscillation by as large a share of its amplitude. Where a slow motion carries a
    small oscillation, the position does not show that.
    """
    assert row.errors is not None
    return max(row.errors.position, row.errors.phase or 0.0, *_further(study, row).values())


def _judged(study: Study, row: Row) -> float:
    """The largest error of a run together with that of the reference."""
    assert row.errors is not None
    own, doubt = _own(study), doubts(study)
    further = [error + doubt[kind] for kind, error in _further(study, row).items()]
    return max(row.errors.position + own, (row.errors.phase or 0.0) + own, *further)


def advice(study: Study) -> str:
    """The cheapest setting below the error that is asked for, and what is best in real time.

    Of a part of a run nothing is advised for the whole: what comes later may need another step.
    """
    found = _advice(study)
    if not study.unseen or found.startswith("no advice"):
        return found
    return f"no advice for the whole run: {study.unseen}; in what was looked at: {found}"


def _advice(study: Study) -> str:
    asked = f"an error below {100.0 * study.tolerance:.3g} %"
    if left_out := _not_judged(study):
        twists = any(row.errors is not None and row.errors.twist is not None for row in study.rows)
        kinds = ["position", "force", *(["twist"] if twists else []), "phase"]
        *judged, last = [kind for kind in kinds if kind not in left_out]
        unknown = " and the ".join(left_out)
        asked += f" in {', '.join(judged)} and {last} (the reference does not know the {unknown} so well)"
    if study.reference is None:
        return "no advice: there is no reference to judge by"
    enough, live = good_enough(study), real_time(study)
    if not enough:
        best = min((r for r in study.rows if r.errors is not None), key=lambda r: _largest(study, r), default=None)
        if best is None:
            return "no advice: no run came to its end"
        return f"no run has {asked}: the best is {_described(best)}{_uncertainty(study, best)}; {_cure(study, best)}"
    first = f"cheapest with {asked}: {_described(enough[0])}"
    cheap = enough[0].factor or 0.0
    if not live:
        return f"{first}; none is faster than real time"
    if cheap < 1.0 and live[0] is enough[0]:
        return f"{first}, and it is the most accurate in real time as well"
    second = f"most accurate in real time: {_described(live[0])}"
    return f"{first}; {second}" if cheap < 1.0 else f"{first}, which is not real time; {second}"


def _uncertainty(study: Study, best: Row) -> str:
    """What is unknown of a run that would be good enough if its reference were right."""
    if study.reference is None or best.errors is None or _largest(study, best) > study.tolerance:
        return ""
    own = max([_own(study), *(doubts(study)[kind] for kind in _further(study, best))])
    return f", beside a reference that may be off by {100.0 * own:.2g} % itself"


def _own(study: Study) -> float:
    return study.reference.error + study.reference.mesh_error if study.reference is not None else 0.0


def _cure(study: Study, best: Row) -> str:
    """What would make the best run better: smaller steps, unless its error has stopped falling with them."""
    own = study.reference.mesh_error if study.reference is not None else 0.0
    if own > 0.5 * study.tolerance:
        return f"the reference's mesh alone is {100.0 * own:.2g} % off: take more elements with --elements"
    assert best.errors is not None
    least = _largest(study, best)
    if least <= max(study.tolerance, study.reference.error if study.reference is not None else 0.0):
        return "let it be judged by a finer reference: leave --reference-step out, or give a larger --budget"
    coarser = [_largest(study, row) for row in study.rows if _like(row, best) and row.errors is not None]
    if coarser and least > STALLED * min(coarser):
        return "smaller steps do not help it any more: its mesh, its constraints or its laws of friction differ"
    return "take smaller steps with --steps"


def _like(row: Row, best: Row) -> bool:
    """Whether a run differs from the best by a larger step alone."""
    one, two = row.trial.setting, best.trial.setting
    return one.kind == two.kind and one.step is not None and two.step is not None and one.step > 1.01 * two.step


def _described(row: Row) -> str:
    assert row.errors is not None
    taken = row.trial.attribute("step")
    setting = row.trial.setting if row.trial.setting.step_error is not None else replace(row.trial.setting, step=taken)
    error = f"error {100.0 * row.errors.position:.2g} %"
    if row.errors.force is not None:
        error += f", of the force {100.0 * row.errors.force:.2g} %"
    if row.errors.twist is not None:
        error += f", of the twist {100.0 * row.errors.twist:.2g} %"
    if row.errors.phase is not None:
        error += f", phase {row.errors.phase:.2g} rad"
    return f"{setting} ({error}, real-time factor {row.factor:.2g})"
