"""What the pages repeat of the program is what the program says."""

import re
import shlex
from pathlib import Path

import pytest

import tautline
from tautline.application.installed import Installed
from tautline.cli.run import run
from tautline.cli.verbs import make_app

ROOT = Path(__file__).parents[2]


def test_the_table_of_statuses_in_the_docs_is_the_programs():
    from benchmarks.pages import statuses

    assert statuses.statuses() in (ROOT / "docs" / "solver.md").read_text(encoding="utf8")


def test_the_table_of_plausible_ranges_in_the_docs_is_the_programs():
    from benchmarks.pages import plausible_ranges

    assert plausible_ranges.ranges() in (ROOT / "docs" / "ranges.md").read_text(encoding="utf8")


def test_the_python_of_the_page_on_scenes_runs_as_it_stands(monkeypatch, capsys):
    text = (ROOT / "docs" / "python.md").read_text(encoding="utf8")
    monkeypatch.chdir(ROOT)
    space = {}
    for block in re.findall(r"^```python\n(.*?)^```", text, re.M | re.S):
        exec(block, space)
    assert (space["heavy"].bodies[0].mass, space["heavy"].solver.step) == (6000.0, 0.002)
    assert space["fast"].drums[0].pay_out.to == -1.0
    assert "solver.step 'm' is not the unit of a time" in capsys.readouterr().out
    with pytest.raises(tautline.SceneError) as error:
        space["scene"].replace({"bodies[0].mas": "6 t"})
    assert f"\n    {error.value}\n" in text


def test_the_commands_of_the_page_on_scenes_run_as_they_stand(monkeypatch, tmp_path, capsys):
    text = (ROOT / "docs" / "python.md").read_text(encoding="utf8")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "data").symlink_to(ROOT / "data")
    (shell,) = re.findall(r"^```sh\n(.*?)^```", text, re.M | re.S)
    for line in shell.splitlines():
        name, *words = shlex.split(line)
        more = ["--set", "solver.end=0.1 s"] if "simulate" in words else []
        application = next(one for one in Installed().all() if one.name == name)
        with pytest.raises(SystemExit) as left:
            run(make_app(application, words), [*words, *more])
        assert not left.value.code, (line, capsys.readouterr().err)


@pytest.mark.parametrize("name", ["stepping", "control", "linearisation", "cosimulation", "sweep"])
def test_the_python_of_a_page_on_live_simulations_runs_and_is_what_its_notebook_holds(name, monkeypatch):
    if name == "cosimulation":
        pytest.importorskip("pythonfmu", reason="PythonFMU is not installed")
    from benchmarks.pages import notebooks

    assert notebooks.place(name).read_text(encoding="utf8") == notebooks.notebook(name)
    monkeypatch.chdir(ROOT)
    space = {}
    for block in re.findall(
        r"^```python\n(.*?)^```", (ROOT / "docs" / f"{name}.md").read_text(encoding="utf8"), re.M | re.S
    ):
        exec(block, space)
