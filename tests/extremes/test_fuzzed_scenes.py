"""Broken scenes and tables by the thousand: each is run, or refused with one message; see `fuzzing` for what is good.

The suite looks at the first fifty. ``pytest -m study tests/extremes`` looks at all: 10,000 scenes and 1,000
tables through `check`, 1,000 scenes through `simulate`. A case is made from its number alone. Files of one that fails
stay; ``cd tests && python -m extremes.fuzzing check 574`` makes and runs it again.
"""

import subprocess
import sys
from pathlib import Path

import pytest
from extremes import fuzzing
from extremes.mutations import Case
from extremes.tables import table_case
from of_the_suite import studies

FULL = {"check": 10_000, "table": 1_000, "simulate": 1_000}
REDUCED = {"check": 50, "table": 20}
BLOCKS = 20
"""Parts of the full study, so that several processes can share it."""
QUICK_RUNS = (0, 4, 6, 14, 19, 28, 29, 32)
"""Runs of the reduced study, for which no other groups are compiled than those of the shipped scenes."""


def look(kind, numbers, folder):
    """Run cases; fails with a line for each that did not end well."""
    failed = [line for number in numbers if (line := fuzzing.looked_at(kind, number, folder))]
    assert not failed, "\n".join(failed)


@pytest.mark.parametrize("kind", REDUCED)
@pytest.mark.parametrize("block", range(4))
def test_some_dozens_of_mutated_scenes_and_tables_are_checked_or_refused_with_one_message(kind, block, tmp_path):
    look(kind, range(block, REDUCED[kind], 4), tmp_path)


def test_some_mutated_scenes_run_or_stop_by_name_and_store_finite_numbers(tmp_path):
    look("simulate", QUICK_RUNS, tmp_path)


@pytest.mark.study
@pytest.mark.parametrize("kind", FULL)
@pytest.mark.parametrize("block", range(BLOCKS))
def test_thousands_of_mutated_scenes_and_tables(kind, block, tmp_path):
    look(kind, range(block, FULL[kind], BLOCKS), tmp_path)


@pytest.mark.parametrize(
    ("kind", "number"), [("check", 0), ("table", 5), *studies(("check", 1), ("check", 2), ("check", 3))]
)
def test_a_process_of_its_own_ends_as_the_command_does_in_this_one(kind, number, tmp_path):
    case = fuzzing.MAKERS[kind](kind, number)
    scene = case.write(tmp_path / "case")
    code = (
        "import sys; from extremes import fuzzing; from tautline.cli.run import run; "
        "run(fuzzing.command(sys.argv[1]), sys.argv[2:])"
    )
    tests = Path(__file__).parents[1]
    done = subprocess.run(
        [sys.executable, "-c", code, case.application, "check", str(scene)],
        capture_output=True, text=True, cwd=tests, timeout=120, check=False,
    )  # fmt: skip
    here = fuzzing.outcome(case, "check", tmp_path / "here")
    assert done.returncode == here.code and done.returncode in (0, 2)
    # A slow machine is told of what takes long, by a process of its own too.
    said = "".join(line for line in done.stderr.splitlines(keepends=True) if not line.startswith("preparing "))
    assert said.replace(str(scene), "") == here.said.replace(str(here.scene), "")


def test_a_case_is_the_same_whenever_it_is_made():
    for kind, make in fuzzing.MAKERS.items():
        one, other = make(kind, 7), make(kind, 7)
        assert one.files == other.files and one.story == other.story
        assert make(kind, 8).files != one.files


@pytest.mark.parametrize("rows", [12_000, pytest.param(1_000_000, marks=pytest.mark.study)])
@pytest.mark.parametrize("number", range(4))
def test_a_table_of_a_million_rows_is_read_in_seconds(number, rows, tmp_path):
    """A function of time or a vessel's motion of all zeros; 20 to 50 s of processor time for a million rows."""
    case = table_case("table", number)
    files = dict(case.files)
    (name,) = (name for name in files if name != "scene.yaml")
    head = {
        "table.csv": "time,value",
        "survey.csv": "md [m],inc [deg],azi [deg]",
        "motion.csv": "t,surge,sway,heave,roll [deg],pitch [deg],yaw [deg]",
    }[name]
    zeros = ",0" * head.count(",")
    files[name] = "\n".join([head, *(f"{1e-3 * i:.4f}{zeros}" for i in range(rows))]).encode()
    many = Case("table", number, case.application, f"{rows} rows", files)
    assert fuzzing.faults(many, "check", tmp_path / "case", limit=6e-4 * rows + 10.0) == []
