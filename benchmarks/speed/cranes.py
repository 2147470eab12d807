"""Real-time factor of cranes: the shipped scenes, sixteen falls, a load that is lost, and cost against elements."""

from __future__ import annotations

from statistics import median
from typing import Any

from benchmarks import jwell
from benchmarks.page import Section, number, show, table
from crane.model.build import build
from crane.scene.scene import CraneScene
from tautline.scene.model import validate
from tautline.scene.reading.document import Document
from tautline.simulation import simulate

DATA = jwell.ROOT / "data"
SCENES = ("hoist", "hookblock", "slewing", "landing")
FALLS = "sixteen_falls"
ELEMENTS = (3, 12, 48)
ASKED = {
    "hoist": 0.01,
    "hookblock": 0.01,
    "slewing": 0.01,
    "landing": 0.01,
    "16 falls": 0.04,
    "16 falls, all capstan": 0.06,
    "load lost from one fall": 0.05,
    "load lost from 16 falls": 0.5,
    "load lost from 16 falls, all capstan": 0.5,
}
"""Real-time factors asked of this version."""
ONE_FALL = """
rope: {mass_per_length: 6.5, axial_stiffness: 8.0e7, damping: 1.0e-4}
bodies: [{name: load, mass: 5 t, position: [12.4, 0, 5], release: {at: 1, remaining: 0}}]
path:
  - drum: {name: winch, center: [0, 0, 0], radius: 0.5, axis: [0, 1, 0], wrap: over, pay_out: 0}
  - sheave: {name: tip, center: [12, 0, 30], radius: 0.4, axis: [0, 1, 0], wrap: over, inertia: 20}
  - end: {name: hook, body: load}
solver: {method: generalized-alpha, rho_inf: 0.6, step: 5 ms, end: 5 s}
output: {interval: 50 ms}
"""


def _text(name: str) -> str:
    return (DATA / f"{name}.yaml").read_text(encoding="utf8")


def _falls(capstan: bool, released: bool, elements: int = 3) -> str:
    """Sixteen falls, as shipped or with another law; with a load that drops while nothing else moves."""
    text = _text(FALLS).replace("elements_per_span: 3", f"elements_per_span: {elements}")
    if capstan:
        text = text.replace("law: no_slip", "law: capstan, friction: 0.1")
    if released:
        begin = text.index("vessel:")
        text = text[:begin] + text[text.index("solver:") :]
        text = text.replace("pay_out: {ramp: {to: -1.0, over: 2.0}}", "pay_out: 0")
        text = text.replace("mass: 80 t,", "mass: 80 t, release: {at: 1 s, remaining: 2 t},")
    return text


def _cases() -> dict[str, str]:
    return {name: _text(name) for name in SCENES} | {
        "16 falls": _falls(False, False),
        "16 falls, all capstan": _falls(True, False),
        "load lost from one fall": ONE_FALL,
        "load lost from 16 falls": _falls(False, True),
        "load lost from 16 falls, all capstan": _falls(True, True),
    }


def _run(text: str, repeats: int, end: float | None = None) -> tuple[list[float], dict[str, Any]]:
    document = Document.parse(text)
    if end is not None:
        document = document.replaced({("solver", "end"): (end, "end")})
    scene, factors, attributes = validate(CraneScene, document), [], {}
    for _ in range(repeats + 1):
        attributes = simulate(build(scene)).attributes
        factors.append(attributes["real_time_factor"])
    return factors[1:], attributes


def measure(quick: bool) -> Section:
    """Every scene several times after one that warms up, and sixteen falls with more and more elements."""
    repeats, end = (1, 1.5) if quick else (5, None)
    rows, headline = [], []
    for name, text in _cases().items():
        factors, one = _run(text, repeats, end)
        spread = f"{number(min(factors))} to {number(max(factors))}"
        each = one["newton_iterations"] / one["steps"]
        rows.append(
            (name, number(median(factors)), spread, f"{ASKED[name]:g}", f"{one['steps']}", number(each, 3),
             f"{one['factorisations']}", f"{one['halvings']}", number(one["energy_error"]))
        )  # fmt: skip
        if name in ("hoist", "16 falls"):
            headline.append((f"crane: {name}, real-time factor", number(median(factors)), "real time: 1"))
    header = (
        "scene", "real-time factor, median", "spread", "asked", "steps", "iterations per step", "factorisations",
        "halvings", "energy error",
    )  # fmt: skip
    growth = []
    for count in ELEMENTS:
        factors, one = _run(_falls(False, False, count), repeats, 0.5 if quick else 5.0)
        total = 17 * count
        per = 1e6 * median(factors) * (0.5 if quick else 5.0) / one["steps"] / total
        each = one["newton_iterations"] / one["steps"]
        growth.append((f"{total}", number(median(factors)), number(per, 3), number(each, 3)))
    text = (
        f"Generalized-alpha (rho_inf 0.6) with the steps of the scenes, their error controlled; {repeats} repetitions "
        "after one that warms up.\n\n" + table(header, rows) + "\nSixteen falls with more elements:\n\n"
        + table(("elements", "real-time factor", "µs per element and step", "iterations per step"), growth)
    )  # fmt: skip
    return Section("Cranes", text, headline)


if __name__ == "__main__":
    show(measure, __doc__)
