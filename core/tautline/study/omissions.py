"""What a quick look leaves out, in words: nobody should take it for the whole."""

from __future__ import annotations

from tautline.scene.errors import SceneError
from tautline.study.trial import Setting, Subject
from tautline.study.variants import Change, changes


def of_stability(subject: Subject) -> tuple[str, ...]:
    """What a quick look at stability does not try: time, variants that the scene has, and the second judge."""
    method = subject.model(Setting()).solver.method
    tried = set(changes(quick=True))
    names = [c.name for c in changes(quick=False) if c not in tried and _has(subject, c, method)]
    left_out = [*_of_time(subject)]
    if names:
        left_out.append(f"not tried: {', '.join(names)}")
    left_out.append("variants are judged by a quarter of their step alone")
    return tuple(left_out)


def of_study(subject: Subject, named_steps: bool) -> tuple[str, ...]:
    """What a quick study does not try: time, every other step of the usual grid, and repetitions."""
    steps = [] if named_steps else ["every other step of the usual grid is left out"]
    return (*_of_time(subject), *steps, "each setting is run once: its time is no median")


def _of_time(subject: Subject) -> list[str]:
    if subject.whole is None or subject.end is None or subject.end >= subject.whole:
        return []
    return [f"the first {subject.end:.4g} s of {subject.whole:.4g} s"]


def _has(subject: Subject, change: Change, method: str) -> bool:
    """Whether a scene has what a change varies; what it refuses it has."""
    if change.rho_inf is not None:
        return method == "generalized-alpha"
    try:
        return not change.what or subject.varied(change.what, change.value) is not None
    except SceneError:
        return True
