"""Broken scenes and tables without end: case `n` of a kind is the same today and tomorrow, on any machine.

A case begins with a scene that ships, or with a table that one of them may name, and is changed in one to four places:
in the tree of its values, and at times in its text. What is in a case is told by its `story`.
"""

from __future__ import annotations

import copy
import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import yaml
from extremes.spellings import SPELLINGS

from tautline.scene.reading.document import Document
from tautline.scene.values.quantity import NUMBER

SEED = 22
ROOT = Path(__file__).parents[2]
FOLDERS = {
    "drillstring": ("data", "apps/drillstring/templates"),
    "crane": ("data", "apps/crane/templates"),
    "gardenhose": ("data", "apps/gardenhose/templates"),
    "cable": ("data", "core/tautline/cable/templates"),
}
MARKS = {"drillstring": "well", "crane": "path", "gardenhose": "hose", "cable": "CableModel"}
SLOW = ("landing", "sixteen_falls")
"""Scenes that are checked in a second and more; they are taken a tenth as often as others."""

NUMBERS = (
    0, -1, 1, 2, 5, 1.0e-308, 1.0e308, -1.0e308, 5e-324, 1.0e300, 1.0e-300, 1.0e155, -1.0e155, 1.0e-15, 1.0e15, 1.0e7,
    3000, 1.0e30, -1.0e30, 1.0e-30, 1.0e29, -1.0e20, 1.0e20, 1.0e-20, 2**31,
    2**63, 10**30, -0.0, float("nan"), float("inf"), float("-inf"), 0.5, 1.0e-3,
)  # fmt: skip
FACTORS = (
    -1.0, 1.0e-300, 1.0e300, 1.0e-25, 1.0e25, 1.0e-6, 1.0e6, 1.0e-2, 1.0e2, 0.5, 2.0, 1.0e-12, 1.0e12, 1.0 + 1.0e-9,
)  # fmt: skip
MILD = (-1.0, 0.0, 0.5, 0.9, 1.1, 2.0, 1.0e-1, 1.0e1, 1.0e-2, 1.0e2, 1.0e-4, 1.0e4)
"""Factors that most often leave a scene that can be run."""
TEXTS = (
    "", " ", "nan", "inf", "12", "1e5", "5 parsec", "3 kg", "2 m", "1e400 m", "1e-400 s", "4 m m", "90 deg", "10 kN",
    "1 s", "-3 rpm", "1/2", "1_000", "٣ m", "５ m", "none", "rest", "auto", "static", "no", "~", "true", "missing",
    "x" * 5000, "Ω≈ç√", "\u202egnp.exe", "a\tb", "é", "🛢", "[1, 2", "{a: b}",
    "!!python/object:os.system", "*a", "&a b", "<<", "%",
    "5 %", "../../etc/passwd", "/dev/null", ".",
    "missing.csv", "\u0000", "\u0085", "__class__", "{0}", "%s",
    "0x1F", "1.",
)  # fmt: skip
KEYS = (
    "", "x", "lenght", "LENGTH", "0", "name", "file", "time", "value", "velocity", "constant", "ramp", "sum", "table",
    "é", "a b", "~", "true", "<<", "units", "length", "elements", "mass", "position", "kind", "self", "model_config",
)  # fmt: skip


@dataclass(frozen=True)
class Case:
    """A scene in a folder of its own: `files` by name, of which `scene.yaml` is what is checked."""

    kind: str
    number: int
    application: str
    story: str
    files: dict[str, bytes | None] = field(repr=False)
    """Contents; None is a folder in the place of a file."""

    def write(self, folder: Path) -> Path:
        """Put it into a folder; returns the scene's path."""
        folder.mkdir(parents=True, exist_ok=True)
        for name, content in self.files.items():
            if content is None:
                (folder / name).mkdir()
            else:
                (folder / name).write_bytes(content)
        return folder / "scene.yaml"


@cache
def scenes(application: str) -> tuple[tuple[str, dict[str, Any]], ...]:
    """Scenes that ship, of an application, by name."""
    found = []
    for folder in FOLDERS[application]:
        for path in sorted((ROOT / folder).glob("*.yaml")):
            root = Document.read(path).root
            if MARKS[application] in root:
                found.append((path.stem, root))
    return tuple(found)


@cache
def tables() -> dict[str, str]:
    """Tables that a scene may name: a function of time, a vessel's motion, a survey."""
    from math import sin

    table = "time [s],value\n" + "".join(f"{0.5 * i},{0.1 * sin(i)}\n" for i in range(60))
    motion = "t,surge,sway,heave,roll [deg],pitch [deg],yaw [deg]\n" + "".join(
        f"{0.5 * i - 1.0},{0.1 * sin(i / 5)},0,{0.5 * sin(i / 4)},{sin(i / 6)},{0.5 * sin(i / 3)},0\n"
        for i in range(300)
    )
    survey = "md [m],inc [deg],azi [deg]\n0,0,0\n" + "".join(f"{300 + 30 * i},{i},{0.5 * i}\n" for i in range(80))
    return {"table.csv": table, "motion.csv": motion, "survey.csv": survey}


def run_case(kind: str, number: int) -> Case:
    """A mutated scene whose form stands, over some steps, now and then of odd length."""
    return scene_case(kind, number, some_steps=True)


def _in_some_steps(tree: dict[str, Any], chance: random.Random) -> None:
    """A handful of steps, whatever has become of the solver's times."""
    steps = chance.choice((1, 2, 5, 10))
    step = chance.choice((None, None, None, None, 1.0e-9, 1.0e-5, 0.1, 10.0))
    if isinstance(solver := tree.get("GeneralizedAlpha"), dict):
        step = step or 0.005
        solver |= {"time_step": step, "time_end": steps * step, "plotpoints": 0}
        return
    if isinstance(solver := tree.get("solver"), dict):
        if step is None:
            step = 0.001 if MARKS["gardenhose"] in tree or MARKS["drillstring"] in tree else 0.005
        solver |= {"step": step, "end": steps * step}
        tree["output"] = {"interval": step}


def scene_case(kind: str, number: int, some_steps: bool = False) -> Case:
    """A mutated scene; the application goes round with the number."""
    chance = random.Random(f"{SEED} {kind} {number}")
    application = tuple(FOLDERS)[number % len(FOLDERS)]
    choice = scenes(application)
    name, root = chance.choices(choice, [0.1 if n in SLOW else 1.0 for n, _ in choice])[0]
    tree, story = copy.deepcopy(root), [name]
    donor = chance.choice(scenes(application))[1]
    # Half of all cases keep their form, so that they get beyond the reader.
    only_numbers = some_steps or chance.random() < 0.5
    for _ in range(chance.choices((1, 2, 3, 4), (6, 3, 2, 1))[0]):
        mild = some_steps and chance.random() < 0.8
        story.append(_change(tree, donor, chance, only_numbers, MILD if mild else FACTORS))
    if some_steps:
        _in_some_steps(tree, chance)
    text = yaml.safe_dump(tree, allow_unicode=True, sort_keys=False, default_flow_style=chance.random() < 0.5)
    data = text.encode("utf8", "surrogatepass")
    if chance.random() < 0.2 and not only_numbers:
        done = chance.choice(SPELLINGS)
        data = done(text, chance)
        story.append(done.__name__.strip("_"))
    files = {"scene.yaml": data} | {name: table.encode() for name, table in tables().items()}
    survey = (ROOT / "data/iscwsa_reference.csv").read_bytes()
    return Case(kind, number, application, "; ".join(story), files | {"iscwsa_reference.csv": survey})


# the tree
def _paths(tree: Any, above: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    children = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, child in children:
        yield (*above, key)
        yield from _paths(child, (*above, key))


def _at(tree: Any, path: tuple[Any, ...]) -> Any:
    for key in path:
        tree = tree[key]
    return tree


def _change(
    tree: dict[str, Any], donor: dict[str, Any], chance: random.Random, only_numbers: bool, factors: tuple[float, ...]
) -> str:
    """Change one thing of a tree in its place, and say what."""
    paths = list(_paths(tree))
    if only_numbers:
        paths = [path for path in paths if _measure(_at(tree, path)) is not None or _is_function(_at(tree, path))]
    if not paths:
        return "nothing is left"
    path = chance.choice(paths)
    parent, key, value = _at(tree, path[:-1]), path[-1], _at(tree, path)
    shown = ".".join(map(str, path))
    measure = _measure(value)
    if measure is not None and (only_numbers or chance.random() < 0.5):
        number = measure[0] * chance.choice(MILD) if factors is MILD else _number(measure[0], chance)
        parent[key] = f"{number} {measure[1]}" if measure[1] else number
        return f"{shown} = {parent[key]!r}"[:90]
    if only_numbers:
        parent[key] = _function(chance)
        return f"play {shown}"
    change = chance.choice(CHANGES)
    change(parent, key, chance, donor)
    return f"{change.__name__.strip('_')} {shown}"


def _measure(value: Any) -> tuple[float, str] | None:
    """Number and unit of a value; None if it is neither a number nor one with a unit."""
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return float(value), ""
    match = NUMBER.fullmatch(value) if isinstance(value, str) else None
    return (float(match["number"]), match["unit"]) if match and match["unit"] and len(match["unit"]) < 15 else None


def _is_function(value: Any) -> bool:
    kinds = {"constant", "ramp", "table", "harmonic", "chirp", "spectrum", "sum"}
    return isinstance(value, dict) and len(value) == 1 and bool(kinds & set(value))


def _number(value: float, chance: random.Random) -> Any:
    if chance.random() < 0.4:
        try:
            return float(value) * chance.choice(FACTORS)
        except OverflowError:
            return 0
    return chance.choice(NUMBERS)


def _delete(parent: Any, key: Any, chance: random.Random, donor: Any) -> None:
    del parent[key]


def _rename(parent: Any, key: Any, chance: random.Random, donor: Any) -> None:
    value = parent[key]
    if isinstance(parent, dict):
        del parent[key]
        word = str(key)
        at = chance.randrange(len(word) + 1)
        parent[chance.choice((*KEYS, word.upper(), word[:at] + word[at + 1 :], word[:at] + "_" + word[at:]))] = value
    else:
        parent.insert(0, parent.pop(key))


def _retype(parent: Any, key: Any, chance: random.Random, donor: Any) -> None:
    value = parent[key]
    others = (None, True, False, [], {}, [value], {"value": value}, str(value), [[]], "word", 0, -1.5)
    parent[key] = chance.choice(others)


def _text(parent: Any, key: Any, chance: random.Random, donor: Any) -> None:
    parent[key] = chance.choice(TEXTS)


def _unit(parent: Any, key: Any, chance: random.Random, donor: Any) -> None:
    """The number that stands there, in any unit."""
    value = parent[key]
    number = str(value).split()[0] if str(value).split() else "1"
    units = ("m", "mm", "in", "s", "kg", "N", "rpm", "deg", "Pa", "psi", "ppg", "kN m", "1/s", "%", "GPa", "degC")
    parent[key] = f"{chance.choice((number, '0', '-1', '1e308', '1e-308'))} {chance.choice(units)}"


def _repeat(parent: Any, key: Any, chance: random.Random, donor: Any) -> None:
    """One more of it, or some hundreds."""
    if isinstance(parent, list):
        parent[key:key] = [copy.deepcopy(parent[key]) for _ in range(chance.choice((1, 1, 2, 300)))]
    else:
        parent[key] = [copy.deepcopy(parent[key]) for _ in range(chance.choice((1, 2, 300)))]


def _reverse(parent: Any, key: Any, chance: random.Random, donor: Any) -> None:
    value = parent[key]
    if isinstance(value, list):
        value.reverse()
    elif isinstance(parent, list):
        chance.shuffle(parent)
    else:
        parent[key] = _function(chance)


def _nest(parent: Any, key: Any, chance: random.Random, donor: Any) -> None:
    for _ in range(chance.choice((1, 5, 45, 60))):
        parent[key] = {"sum": [parent[key]]} if chance.random() < 0.5 else [parent[key]]


def _graft(parent: Any, key: Any, chance: random.Random, donor: Any) -> None:
    """What stands elsewhere, in this or another scene of the application."""
    parent[key] = copy.deepcopy(_at(donor, chance.choice(list(_paths(donor)))))


def _transplant(parent: Any, key: Any, chance: random.Random, donor: Any) -> None:
    """A key of another scene beside this one, with what it holds."""
    path = chance.choice([path for path in _paths(donor) if isinstance(path[-1], str)])
    if isinstance(parent, dict):
        parent[path[-1]] = copy.deepcopy(_at(donor, path))
    else:
        parent.append(copy.deepcopy(_at(donor, path)))


def _add(parent: Any, key: Any, chance: random.Random, donor: Any) -> None:
    value = chance.choice((None, 1, [], {}, "word", {"a": 1}, parent[key]))
    if isinstance(parent, dict):
        parent[chance.choice(KEYS)] = copy.deepcopy(value)
    else:
        parent.append(copy.deepcopy(value))


def _play(parent: Any, key: Any, chance: random.Random, donor: Any) -> None:
    """A function of time in its place."""
    parent[key] = _function(chance)


CHANGES: tuple[Callable[[Any, Any, random.Random, Any], None], ...] = (
    _delete, _rename, _retype, _text, _unit, _repeat, _reverse, _nest, _graft, _transplant, _add, _play,
)  # fmt: skip


def _function(chance: random.Random, deep: int = 0) -> Any:
    """A function of time of any kind whose numbers may be extreme."""

    def n(*usual: float) -> Any:
        return chance.choice(usual) if chance.random() < 0.6 else chance.choice(NUMBERS)

    kinds: tuple[Callable[[], Any], ...] = (
        lambda: n(0.0, 1.0, -0.5),
        lambda: {"constant": n(0.0, 1.0)},
        lambda: {"ramp": {chance.choice(("to", "rate")): n(1.0, -2.0), "over": n(1.0, 0.1), "at": n(0.0, 0.5)}},
        lambda: {"ramp": {"to": n(1.0), "from": n(0.5), "over": n(1.0)}},
        lambda: {"table": _inline(n, chance)},
        lambda: {"table": {"file": chance.choice(("table.csv", "missing.csv", ".", "motion.csv", "scene.yaml"))}},
        lambda: {"harmonic": {"amplitude": n(0.5), chance.choice(("period", "frequency")): n(8.0), "ramp": n(0.0)}},
        lambda: {"harmonic": {"amplitude": n(0.5), "period": n(8.0), "phase": n(0.0), "mean": n(0.0)}},
        lambda: {"chirp": {"amplitude": n(1.0), "period": n(20.0), "rate": n(0.0025), "shift": n(5.0)}},
        lambda: {"spectrum": {"significant_height": n(2.5), "peak_period": n(9.0), "gamma": n(2.0), "seed": n(7)}},
        lambda: {"spectrum": {"significant_height": n(1.0), "peak_period": n(9.0), "components": n(10, 5000)}},
        lambda: {"sum": [_function(chance, deep + 1) for _ in range(chance.randrange(4 if deep < 3 else 1))]},
        lambda: {"velocity": _function(chance, deep + 1) if deep < 3 else 0.0},
    )
    return chance.choice(kinds)()


def _inline(n: Callable[..., Any], chance: random.Random) -> dict[str, Any]:
    count = chance.choice((0, 1, 2, 3, 5, 400))
    time = [float(i) for i in range(count)]
    value = [n(0.0, 1.0, -1.0) for _ in range(count if chance.random() < 0.9 else 2)]
    if count and chance.random() < 0.4:
        time[chance.randrange(count)] = n(0.5)
    if chance.random() < 0.3:
        time = [t * chance.choice((1.0e-307, 1.0e-3, 1.0e305)) for t in time]
    interpolation = {} if chance.random() < 0.5 else {"interpolation": chance.choice(("linear", "cubic", "quintic"))}
    return {"time": time, "value": value} | interpolation
