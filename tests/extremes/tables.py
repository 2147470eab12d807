"""Tables without end: case `n` is the same today and tomorrow, on any machine.

A scene that ships names a table of a function of time, a vessel's motion or a survey, which is broken in one to three
places, and at times in its text.
"""

from __future__ import annotations

import copy
import random
from collections.abc import Callable
from typing import Any

import yaml
from extremes.mutations import FACTORS, FOLDERS, NUMBERS, SEED, TEXTS, Case, scenes, tables
from extremes.spellings import SPELLINGS


def _with_table(application: str, place: int) -> tuple[dict[str, Any], str]:
    """A scene that names a table, and which."""
    roots = {name: copy.deepcopy(root) for name, root in scenes(application)}
    drawn = {"table": {"file": "table.csv"}}
    if application == "drillstring":
        root = roots[("jwell", "vertical", "jwell", "iscwsa")[place]]
        if place < 2:
            root["top"]["block"] = [drawn, {"velocity": drawn}][place]
            return root, "table.csv"
        if place == 3:
            root["well"]["survey"] = "survey.csv"
        else:
            del root["well"]["sections"]
            root["well"]["survey"] = "survey.csv"
        return root, "survey.csv"
    if application == "crane":
        root = roots[("lift", "hoist", "hoist", "slewing")[place]]
        if place in (1, 2):
            root["vessel"]["motion"] = {"file": "motion.csv"}
            return root, "motion.csv"
        if place == 3:
            root["frames"][0]["slew"] = drawn
        else:
            root["path"][0]["drum"]["pay_out"] = drawn
        return root, "table.csv"
    if application == "gardenhose":
        root = roots[("hose", "supported", "riser", "hose")[place]]
        root["water"]["speed"] = drawn
        return root, "table.csv"
    root = roots["reeled_span"]
    played = {"Function": {"id": 1, "value": drawn if place % 2 else {"velocity": drawn}}}
    root["CableModel"] = [played if "Function_VelocityDefined" in item else item for item in root["CableModel"]]
    return root, "table.csv"


def table_case(kind: str, number: int) -> Case:
    """A scene that ships, and names a table that is broken."""
    chance = random.Random(f"{SEED} {kind} {number}")
    application = tuple(FOLDERS)[number % len(FOLDERS)]
    root, name = _with_table(application, chance.randrange(4))
    rows = [line.split(",") for line in tables()[name].splitlines()]
    story = [name]
    data: bytes | None = b""
    for _ in range(chance.choices((1, 2, 3), (5, 2, 1))[0]):
        done = chance.choice(ROWS)
        rows = done(rows, chance)
        story.append(done.__name__.strip("_"))
    text = "\n".join(",".join(row) for row in rows) + "\n"
    data = text.encode("utf8", "surrogatepass")
    files: dict[str, bytes | None] = {}
    if chance.random() < 0.25:
        spelt = chance.choice((*SPELLINGS[:4], *SPELLINGS[4:6], *SPELLINGS[7:8], SPELLINGS[-1]))
        data = spelt(text, chance)
        story.append(spelt.__name__.strip("_"))
    files[name] = data
    odd = chance.random()
    if odd < 0.02:
        files[name] = None
        story = ["a folder in its place"]
    elif odd < 0.04:
        del files[name]
        story = ["missing"]
    scene = yaml.safe_dump(root, allow_unicode=True, sort_keys=False).encode()
    return Case(kind, number, application, "; ".join(story), {"scene.yaml": scene} | files)


Rows = list[list[str]]


def _cell(rows: Rows, chance: random.Random) -> Rows:
    row = chance.choice(rows[1:] or rows or [[""]])
    short = (text for text in TEXTS if len(text) < 50)
    words = [*map(repr, NUMBERS), *short, "1,5", "1;5", '"', "-", "#", "1e999", "1d5"]
    if row:
        row[chance.randrange(len(row))] = chance.choice(words)
    return rows


def _column(rows: Rows, chance: random.Random) -> Rows:
    """A whole column times something, or all alike."""
    at = chance.randrange(len(rows[0]) if rows and rows[0] else 1)
    factor = chance.choice((*FACTORS, 0.0, 1.0e308, 1.0e-308))
    for row in rows[1:]:
        try:
            row[at] = repr(float(row[at]) * factor)
        except (ValueError, IndexError):
            continue
    return rows


def _head(rows: Rows, chance: random.Random) -> Rows:
    if rows and rows[0]:
        words = ("", "time", "t", "value", "md", "inc [rad]", "azi", "heave [ft]", "roll", "x [kg]", "value [s]", "x [")
        rows[0][chance.randrange(len(rows[0]))] = chance.choice(words)
    return rows


def _no_head(rows: Rows, chance: random.Random) -> Rows:
    return rows[1:]


def _only_head(rows: Rows, chance: random.Random) -> Rows:
    return rows[: chance.choice((1, 2, 3, 4))]


def _no_column(rows: Rows, chance: random.Random) -> Rows:
    at = chance.randrange(len(rows[0]) if rows and rows[0] else 1)
    return [row[:at] + row[at + 1 :] for row in rows]


def _short_row(rows: Rows, chance: random.Random) -> Rows:
    at = chance.randrange(len(rows) or 1)
    return [row[: chance.randrange(len(row) + 1)] if i == at else row for i, row in enumerate(rows)]


def _shuffled(rows: Rows, chance: random.Random) -> Rows:
    body = rows[1:]
    chance.shuffle(body)
    return rows[:1] + body


def _swapped(rows: Rows, chance: random.Random) -> Rows:
    at = chance.randrange(1, max(2, len(rows) - 1))
    return [*rows[:at], *rows[at : at + 2][::-1], *rows[at + 2 :]]


def _upside_down(rows: Rows, chance: random.Random) -> Rows:
    return rows[:1] + rows[:0:-1]


def _row_twice(rows: Rows, chance: random.Random) -> Rows:
    at = chance.randrange(len(rows) or 1)
    return rows[: at + 1] + [list(row) for row in rows[at : at + 1]] + rows[at + 1 :]


def _gap(rows: Rows, chance: random.Random) -> Rows:
    at = chance.randrange(1, max(2, len(rows)))
    return rows[:at] + rows[at + chance.choice((1, 5, 40)) :]


def _blank_lines(rows: Rows, chance: random.Random) -> Rows:
    at = chance.randrange(len(rows) + 1)
    return [*rows[:at], [""], ["# word"], ["", ""], *rows[at:]]


ROWS: tuple[Callable[[Rows, random.Random], Rows], ...] = (
    _cell, _cell, _cell, _column, _column, _head, _no_head, _only_head, _no_column, _short_row, _shuffled, _swapped,
    _upside_down, _row_twice, _gap, _blank_lines,
)  # fmt: skip
