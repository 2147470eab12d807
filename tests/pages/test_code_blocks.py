"""Every code block of the pages runs, or says why it cannot.

Blocks of a page run in their order, in a folder of their own beside ``data``. Runs are shortened, and otherwise as the
page has them. A comment before a block says more:

- ``<!-- not run: reason -->``;
- ``<!-- before: ... -->``, ``<!-- after: ... -->``: commands that come before or after it, one a line;
- ``<!-- file: name -->``: the block is this file; a YAML block may say so by its first line, ``# name.yaml``;
- ``<!-- part of: scene -->``: YAML that takes the place of the same keys of a scene.
"""

import re
import shlex
import shutil
from pathlib import Path
from typing import NamedTuple

import pytest
import typer
import yaml
from cli.in_process import leave_out_pixels

import tautline
from tautline.application.installed import Installed
from tautline.cli.run import run
from tautline.cli.verbs import make_app

ROOT = Path(__file__).parents[2]
BLOCK = re.compile(
    r"(?:<!--(?P<mark>[^>]*?)-->\n)?^(?P<indent> *)```(?P<kind>\w*)\n(?P<text>.*?)^ *```$", flags=re.M | re.S
)
OUTSIDE = ("README.md", "CONTRIBUTING.md", "data/README.md")
PAGES = sorted(
    str(path.relative_to(ROOT))
    for path in (*(ROOT / name for name in OUTSIDE), *(ROOT / "docs").rglob("*.md"))
    if BLOCK.search(path.read_text(encoding="utf8"))
)
ELSEWHERE = {
    "docs/extending.md": "test_extending.py",
    "docs/gallery.md": "benchmarks/pages/gallery.py, which writes the page by these commands and which .ci/run runs",
    "docs/control.md": "test_docs.py",
    "docs/linearisation.md": "test_docs.py",
    "docs/python.md": "test_docs.py",
    "docs/stepping.md": "test_docs.py",
}
"""Pages whose blocks others run."""
SHORT = {
    "simulate": ("--end", "0.2 s"), "stick-slip": ("--speed", "120", "--weight", "1e5", "--end", "1 s"),
    "record": ("--end", "2 s"), "flutter": ("--speed", "12:15:1"),
}  # fmt: skip
"""Options that shorten a verb; they take the place of the same options of the page."""
PARSED = ("study", "stability")
"""Verbs that .ci/reduced.py runs on every scene: here their scene and their options are read."""
WITH_PIXELS = "docs/tutorials/first_run.md"
"""The page whose figures are drawn to their pixels; those of the others are made, and their files are empty."""
FILMS = ("--rate", "1", "--size", "320x180")
STILLS = ("--size", "320x180")
LATER = "0.4 s"
"""Where a page goes on from a result."""


class Block(NamedTuple):
    """A block: its line, kind, text, and what the comment before it says."""

    line: int
    kind: str
    text: str
    mark: str
    told: str


def blocks(page):
    text = (ROOT / page).read_text(encoding="utf8")
    for found in BLOCK.finditer(text):
        mark, _, told = (found["mark"] or "").strip().partition(":")
        width = len(found["indent"])
        inside = "".join(line[width:] for line in found["text"].splitlines(keepends=True))
        yield Block(text[: found.start("kind")].count("\n") + 1, found["kind"], inside, mark.strip(), told.strip())


@pytest.mark.parametrize("page", PAGES)
def test_every_block_of_a_page_runs_or_says_why_it_does_not(page, tmp_path, monkeypatch, capsys):
    if page in ELSEWHERE:
        pytest.skip(f"run by {ELSEWHERE[page]}")
    for name in ("data", "examples"):
        (tmp_path / name).symlink_to(ROOT / name)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")
    if page != WITH_PIXELS:
        leave_out_pixels(monkeypatch)
    space = {}
    for block in blocks(page):
        where = f"{page}:{block.line}"
        if block.mark == "not run":
            assert len(block.told) > 10, f"{where}: why is it not run?"
            continue
        if block.mark in ("main command", "test command"):
            continue  # .ci/run takes them from the page
        if block.mark == "before":
            for line in block.told.splitlines():
                _command(line, where, capsys, as_it_stands=True)
        if block.kind == "python":
            exec(compile(block.text, where, "exec"), space)
        elif block.kind == "sh":
            for line in block.text.splitlines():
                _command(line, where, capsys)
        elif block.kind in ("yaml", "csv", "toml"):
            _text(block, where)
        else:
            assert block.kind in ("text", ""), f"{where}: nobody knows how to run {block.kind!r}: mark it"
        if block.mark == "after":
            for line in block.told.splitlines():
                _command(line, where, capsys)


def _text(block, where):
    """A file, or a part of a scene."""
    named = re.match(r"# ([\w-]+\.\w+)\n", block.text)
    if block.mark == "part of":
        scene = tautline.read(ROOT / block.told)
        changed = scene.replace({key: value for key, value in yaml.safe_load(block.text).items()})
        assert changed is not scene
        return
    name = block.told if block.mark == "file" else named and named[1]
    assert name, f"{where}: neither a file nor a part of a scene: mark it"
    Path(name).write_text(block.text, encoding="utf8")


def _command(line, where, capsys, as_it_stands=False):
    """A line of a shell: one of our commands, in this process."""
    words = shlex.split(line, comments=True)
    if not words:
        return
    name, verb, *more = words
    if name == "cp":
        shutil.copy(verb, more[0])
        return
    assert name in ("tautline", "crane", "drillstring", "gardenhose"), f"{where}: {name} is no command of ours: mark it"
    if verb == "render" and not {"--image", "--movie", "--html"} & set(more):
        return  # a window, which needs a screen
    application = next(one for one in (*Installed().all(), Installed()) if one.name == name)
    if verb in PARSED:
        typer.main.get_command(make_app(application)).commands[verb].make_context(verb, list(more))
        verb, more = "check", more[:1]
    if verb == "sweep":
        more[0] = _fewer_cases(Path(more[0]))
        more += ["--set", "solver.end=0.5 s"]
    with pytest.raises(SystemExit) as left:
        run(make_app(application, [verb]), [verb, *(more if as_it_stands else _shortened(verb, more))])
    assert not left.value.code, f"{where}: {' '.join(words)}\n{capsys.readouterr().err}"


def _fewer_cases(path):
    """A sweep with the same keys and two values of each."""
    sweep = yaml.safe_load(path.read_text(encoding="utf8"))
    sweep["scene"] = str((path.parent / sweep["scene"]).resolve())
    for key, values in sweep["vary"].items():
        if isinstance(values, list):
            sweep["vary"][key] = values[:2]
        elif "linspace" in values:
            values["linspace"][2] = 2
    for plan in sweep["plan"].values() if isinstance(sweep["plan"], dict) else ():
        plan["samples"] = 2
    if "depth" in sweep.get("options", {}):
        sweep["options"]["depth"] = "2500"
    Path(path.name).write_text(yaml.safe_dump(sweep), encoding="utf8")
    return path.name


def _shortened(verb, words):
    options = list(SHORT.get(verb, ()))
    if "--resume" in words and "--end" in options:
        options[options.index("--end") + 1] = LATER
    if "--movie" in words:
        options += FILMS
    elif "--image" in words:
        options += STILLS
    kept, names = [], {option for option in options if option.startswith("--")}
    skip = False
    for word in words:
        if skip:
            skip = False
        elif word in names:
            skip = True
        else:
            kept.append(word)
    return kept + options


def test_a_command_that_there_is_not_and_one_that_fails_are_found(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(AssertionError, match="no command of ours"):
        _command("make all", "page:1", capsys)
    with pytest.raises(AssertionError, match="no-such"):
        _command("crane check no-such.yaml", "page:1", capsys)
